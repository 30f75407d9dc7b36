/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model files that a plant names, each once: hashed at first, parsed only while assets are cut out of them. Thread: one. */
#ifndef PREPROCESS_MODEL_FILES_H
#define PREPROCESS_MODEL_FILES_H
#include "plant/plant.h"
#include "preprocess/model/gltf_shim.h"

struct model_file {
    const char *path; /* the plant's */
    int line;         /* in the plant file, of the first asset that names it */
    bool good;        /* it can be read; else why */
    char why[MODEL_WHY_BYTES];
    uint64_t hash;            /* with what its URIs name */
    uint64_t file_hash;       /* of the file itself */
    struct gltf_model parsed; /* between model_file_parse and model_file_release */
    bool is_parsed, was_parsed;
    double parse_s;
    uint32_t skipped_lines, skipped_points, scaled_rotations, left_out_textures; /* where was_parsed */
    char **left_out;                                                             /* a text for each of these textures */
};

struct model_files {
    struct model_file *at;
    size_t count, capacity;
};

/* Adds the asset's model file to the list, reading and hashing it if it is new. Returns its number in the list; at[number].good says
   whether it could be read. */
size_t model_files_add(struct model_files *files, const struct plant_asset *asset);
/* Releases all models and frees the list. */
void model_files_finish(struct model_files *files);

/* Parses the file into file->parsed, until model_file_release(). Returns false with the reason in file->why, also if the file has changed
   since it was hashed. */
bool model_file_parse(struct model_file *file);
/* Frees the parsed model. One that is not parsed is fine. */
void model_file_release(struct model_file *file);

#endif
