/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The distinct model files of a plant. All files are hashed first. A file is parsed and in memory only while its assets are
 * extracted. Call from one thread only. */
#ifndef PREPROCESS_MODEL_FILES_H
#define PREPROCESS_MODEL_FILES_H
#include "plant/plant.h"
#include "preprocess/model/gltf_shim.h"

struct model_file {
    const char *path; /* path of the model file; the string belongs to the plant */
    int line;         /* line in the plant file of the first asset with this model */
    bool good;        /* true: the file can be read; false: `why` says why not */
    char why[MODEL_WHY_BYTES];
    uint64_t hash;            /* hash of the file and of the files it refers to by URI */
    uint64_t file_hash;       /* hash of the model file alone, without the files it refers to */
    struct gltf_model parsed; /* valid between model_file_parse() and model_file_release() */
    bool is_parsed, was_parsed;
    double parse_s;
    /* at the model's last parse, valid if was_parsed: numbers of skipped primitives, of rotations scaled to unit length, and of
     * texts in left_out */
    uint32_t skipped_lines, skipped_points, scaled_rotations, left_out_textures;
    /* texts for the report, one for each ignored texture and extension */
    char **left_out;
};

struct model_files {
    struct model_file *at;
    size_t count, capacity;
};

/* Adds the asset's model file to the list; reads and hashes it if it is new. Returns its index in the list; at[index].good says whether it
 * could be read. */
size_t model_files_add(struct model_files *files, const struct plant_asset *asset);
/* Frees the parsed models and the list of files. */
void model_files_finish(struct model_files *files);

/* Parses the file into file->parsed, which stays valid until model_file_release(). Returns false with the reason in file->why;
   a change of the file since it was hashed is an error too. */
bool model_file_parse(struct model_file *file);
/* Frees the parsed model. Does nothing if the file is not parsed. */
void model_file_release(struct model_file *file);

#endif
