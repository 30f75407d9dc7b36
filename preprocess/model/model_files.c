/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the list of a plant's model files and parses one at a time. */
#include "preprocess/model/model_files.h"

#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "plant/recipe.h"

static bool read_hashes(struct model_file *file)
{
    struct model_source source;
    if (!model_source_open(&source, file->path, file->why))
        return false;
    file->hash = source.hash;
    model_source_finish(&source);
    return plant_model_hash(file->path, &file->file_hash) || wrong(file->why, "%s", strerror(errno));
}

size_t model_files_add(struct model_files *files, const struct plant_asset *asset)
{
    for (size_t i = 0; i < files->count; i++)
        if (strcmp(files->at[i].path, asset->model) == 0)
            return i;
    mem_grow(&files->at, &files->capacity, files->count + 1, sizeof(*files->at));
    struct model_file *file = &files->at[files->count];
    *file = (struct model_file){ .path = asset->model, .line = asset->line };
    file->good = read_hashes(file);
    return files->count++;
}

static void free_left_out(struct model_file *file)
{
    for (uint32_t i = 0; i < file->left_out_textures; i++)
        mem_free(file->left_out[i]);
    mem_free(file->left_out);
    file->left_out = NULL;
    file->left_out_textures = 0;
}

static void take_left_out(struct model_file *file)
{
    free_left_out(file);
    file->left_out = file->parsed.left_out;
    file->left_out_textures = file->parsed.left_out_textures;
    file->parsed.left_out = NULL;
    file->parsed.left_out_textures = 0;
}

void model_files_finish(struct model_files *files)
{
    for (size_t i = 0; i < files->count; i++) {
        model_file_release(&files->at[i]);
        free_left_out(&files->at[i]);
    }
    mem_free(files->at);
    *files = (struct model_files){ 0 };
}

bool model_file_parse(struct model_file *file)
{
    struct model_source source;
    int64_t start_ns = clock_mono_ns();
    if (!model_source_open(&source, file->path, file->why))
        return false;
    bool good = source.hash == file->hash || wrong(file->why, "the model was changed while plantcast-prep was reading the file: run "
                                                              "plantcast-prep again");
    good = good && gltf_load(&file->parsed, &source, file->why);
    model_source_finish(&source);
    if (!good)
        return false;
    file->is_parsed = file->was_parsed = true;
    file->parse_s = (double)(clock_mono_ns() - start_ns) / NS_PER_S;
    file->skipped_lines = file->parsed.skipped_lines;
    file->scaled_rotations = file->parsed.scaled_rotations;
    file->skipped_points = file->parsed.skipped_points;
    take_left_out(file);
    return true;
}

void model_file_release(struct model_file *file)
{
    gltf_free(&file->parsed);
    file->is_parsed = false;
}
