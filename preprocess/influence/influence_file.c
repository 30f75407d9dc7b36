/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Group by group, interpolation by interpolation; then all in one file. */
#include "preprocess/influence/influence_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/cache_file.h"
#include "base/mem.h"
#include "plant/influence.h"
#include "preprocess/cache/folder.h"
#include "preprocess/influence/influence.h"
#include "protocol/influence_format.h"

struct making {
    struct log *log;
    struct workers *workers;
    const struct influence_input *input;
    struct vertex_embedding *embedding;
    struct influence_header header;
    struct influence_entry *entries;
    struct influence *found; /* of each entry */
    size_t capacity, found_capacity;
};

/* The sensors of a group whose place is known, in their order; *places_m: the caller frees it (mem_free). */
static size_t places_of(const struct influence_input *input, int group, double (**places_m)[3])
{
    size_t count = 0;
    *places_m = mem_array(input->sensor_count, sizeof(**places_m));
    for (size_t i = 0; i < input->sensor_count; i++) {
        const struct plant_tag *tag = &input->plant->tags[input->sensors[i].tag];
        if (tag->group == group && !tag->place_assumed)
            memcpy((*places_m)[count++], input->places_m[i], sizeof(**places_m));
    }
    return count;
}

bool influence_is_wanted(const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count)
{
    for (size_t i = 0; i < sensor_count; i++)
        if (!plant->tags[sensors[i].tag].place_assumed && plant_prepares_any(&plant->groups[plant->tags[sensors[i].tag].group]))
            return true;
    return false;
}

static bool add_entry(struct making *making, int group, enum interpolation interpolation, const struct influence_mesh *mesh,
                      const struct influence_anchor *anchors)
{
    const struct influence_input *input = making->input;
    const struct plant_asset *asset = &input->plant->assets[input->plant->tags[input->sensors[0].tag].asset];
    double decay_m = interpolation == INTERPOLATION_FIN ? plant_decay_m(asset) : (double)INFINITY;
    uint32_t at = making->header.entry_count;
    mem_grow(&making->entries, &making->capacity, at + 1, sizeof(*making->entries));
    mem_grow(&making->found, &making->found_capacity, at + 1, sizeof(*making->found));
    making->entries[at] = (struct influence_entry){ .group = (uint32_t)group,
                                                    .interpolation = interpolation,
                                                    .sensor_count = (uint32_t)mesh->source_count,
                                                    .disc_m = input->plant->groups[group].disc_m,
                                                    .decay_m = isfinite(decay_m) ? decay_m : 0 };
    making->header.entry_count++;
    return influence_conduct(&making->found[at], making->log, making->workers, mesh, decay_m, anchors, input->vertex_count);
}

static bool add_group(struct making *making, int group)
{
    const struct influence_input *input = making->input;
    const struct plant_group *of = &input->plant->groups[group];
    struct influence_mesh mesh = { 0 };
    double(*places_m)[3];
    size_t count = places_of(input, group, &places_m);
    bool good = true;
    if (count > 0 && plant_prepares_any(of)) {
        struct influence_anchor *anchors = mem_try_array(input->vertex_count, sizeof(*anchors));
        good = anchors && influence_mesh_init(&mesh, input->surface, (const double(*)[3])places_m, count, of->disc_m);
        if (good)
            influence_mesh_anchors(&mesh, making->embedding, input->vertex_count, anchors);
        for (int i = INTERPOLATION_HARMONIC; good && i < INTERPOLATIONS; i++)
            if (plant_prepares(of, (enum interpolation)i))
                good = add_entry(making, group, (enum interpolation)i, &mesh, anchors);
        mem_free(anchors);
        influence_mesh_finish(&mesh);
    }
    mem_free(places_m);
    return good;
}

static uint64_t padded(uint64_t bytes)
{
    return (bytes + 7) / 8 * 8;
}

/* One array after the other, each padded. Returns 0 or -errno. */
static int write_file(struct making *making)
{
    static const char zeros[8];
    const struct influence_input *input = making->input;
    struct atomic_file_part *parts = mem_array(2 + 3 * making->header.entry_count, sizeof(*parts));
    size_t count = 0;
    uint64_t at = sizeof(making->header) + making->header.entry_count * sizeof(*making->entries);
    parts[count++] = (struct atomic_file_part){ &making->header, sizeof(making->header) };
    parts[count++] = (struct atomic_file_part){ making->entries, making->header.entry_count * sizeof(*making->entries) };
    for (uint32_t i = 0; i < making->header.entry_count; i++) {
        struct influence_entry *entry = &making->entries[i];
        const uint64_t sensors = entry->sensor_count, squares = 8 * sensors * sensors, shares = 4 * sensors * input->vertex_count;
        entry->precision = at;
        entry->shares = at + squares;
        at += squares + padded(shares);
        parts[count++] = (struct atomic_file_part){ making->found[i].precision, squares };
        parts[count++] = (struct atomic_file_part){ making->found[i].shares, shares };
        parts[count++] = (struct atomic_file_part){ zeros, padded(shares) - shares };
    }
    char *path = folder_influence_path(input->folder, input->key);
    int status = cache_file_write_parts(path, INFLUENCE_MAGIC, input->key, parts, count);
    mem_free(path);
    mem_free(parts);
    return status;
}

bool influence_file_make(struct log *log, struct workers *workers, const struct influence_input *input, char why[200])
{
    struct making making = { .log = log, .workers = workers, .input = input };
    making.header.vertex_count = (uint32_t)input->vertex_count;
    making.embedding = vertex_embedding_create(input->surface, input->positions_m, input->normals, input->vertex_count, input->triangles,
                                               input->triangle_count);
    bool good = making.embedding;
    for (size_t g = 0; good && g < input->plant->group_count; g++)
        good = add_group(&making, (int)g);
    int status = good ? write_file(&making) : 0;
    if (!good)
        snprintf(why, 200, "the influence of %zu sensors at %zu vertices cannot be computed: see above", input->sensor_count,
                 input->vertex_count);
    else if (status != 0)
        snprintf(why, 200, "the influence of its sensors cannot be written into %.80s: %s", input->folder, strerror(-status));
    for (uint32_t i = 0; i < making.header.entry_count; i++)
        influence_finish(&making.found[i]);
    vertex_embedding_destroy(&making.embedding);
    mem_free(making.entries);
    mem_free(making.found);
    return good && status == 0;
}

bool influence_file_good(const char *folder, uint64_t key)
{
    struct cache_file file;
    char *path = folder_influence_path(folder, key);
    bool good = cache_file_open(&file, path, INFLUENCE_MAGIC, key);
    if (good)
        cache_file_close(&file);
    mem_free(path);
    return good;
}
