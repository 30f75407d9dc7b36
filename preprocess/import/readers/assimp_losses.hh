/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints shapes that Assimp leaves out of a model, as report lines (format: findings.h). Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_ASSIMP_LOSSES_HH
#define PREPROCESS_IMPORT_READERS_ASSIMP_LOSSES_HH
#include <assimp/LogStream.hpp>

#include <map>
#include <string>

/* Counts the errors that Assimp logs, and those of its warnings that report a lost shape, by their text. */
struct assimp_log : Assimp::LogStream {
    std::map<std::string, size_t> &counts;

    explicit assimp_log(std::map<std::string, size_t> &into) : counts(into)
    {
    }
    void write(const char *message) override;
};

/* Prints the number of free-form curves and surfaces of an OBJ file, which Assimp skips without a message. */
void assimp_losses_of_obj(const std::string &text);

/* Prints the geometries of a COLLADA file that have no polygons: convex hulls, splines, boundary representations. */
void assimp_losses_of_dae(const std::string &text);

/* Replaces numbers that are not finite in the spelling of Windows (-1.#IND, 1.#INF), which Assimp reads as 1, by "nan". */
void assimp_plain_numbers(std::string *text);

/* Prints the shapes of an FBX file that Assimp skips, NURBS and patches, by the names of their FBX models. */
void assimp_losses_of_fbx(const std::string &bytes);

/* Keeps only the last of several statements of a property in an FBX file in text form. say: also prints these properties, models with more
 * than one parent, and models that are not connected with the scene. */
void assimp_mend_fbx(std::string *text, bool say);

#endif
