/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes that Assimp leaves out of a model, as lines of findings.h. Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_ASSIMP_LOSSES_HH
#define PREPROCESS_IMPORT_READERS_ASSIMP_LOSSES_HH
#include <assimp/LogStream.hpp>

#include <map>
#include <string>

/* Collects the errors that Assimp logs, and those of its warnings that tell of a lost shape, with a count for each distinct text. */
struct assimp_log : Assimp::LogStream {
    std::map<std::string, size_t> &counts;

    explicit assimp_log(std::map<std::string, size_t> &into) : counts(into)
    {
    }
    void write(const char *message) override;
};

/* Prints free-form curves and surfaces of an OBJ file, which Assimp skips without a word. */
void assimp_losses_of_obj(const std::string &text);

/* Prints geometries of a COLLADA file that have no polygons: convex hulls, splines, boundary representations. */
void assimp_losses_of_dae(const std::string &text);

#endif
