/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints shapes that Assimp leaves out of a model, as report lines (format: findings.h). Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_ASSIMP_LOSSES_HH
#define PREPROCESS_IMPORT_READERS_ASSIMP_LOSSES_HH
#include <assimp/LogStream.hpp>

#include <map>
#include <string>

/* Counts the errors that Assimp logs, by text, and those of its warnings that report a lost shape. */
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

/* Prints the NURBS and patches of an FBX file, by the names of their models. */
void assimp_losses_of_fbx(const std::string &bytes);

/* Leaves the last of equal properties in an FBX file of text. say: prints these properties, models with more than one parent, and models
 * that are not connected with the scene. */
void assimp_mend_fbx(std::string *text, bool say);

#endif
