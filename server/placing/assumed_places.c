/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "placing/assumed_places.h"

#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/parse/csv.h"
#include "plant/tags/tag_edit.h"

/* --- facts about each tag's position ------------------------------------------------------------------------------------------ */

/* Returns an array by tag: distance in metres of the tag's position from its asset's surface; NaN: the tag is not on an asset. The
   caller frees the array. */
static double *surface_distances(const struct scene *scene)
{
    double *distance_m = mem_array(scene->plant->tag_count + 1, sizeof(*distance_m));
    for (size_t i = 0; i < scene->plant->tag_count; i++)
        distance_m[i] = NAN;
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t s = 0; s < scene->assets[a].sensor_count; s++)
            distance_m[scene->assets[a].sensors[s].tag] = scene->assets[a].sensors[s].surface_distance_m;
    return distance_m;
}

/* Returns an array by tag: the confidence (0..1) with which `plantcast match` assigned the tag to its asset, from matches.csv; NaN:
   unknown. The caller frees the array. */
static double *confidences(const struct plant *plant)
{
    double *confidence = mem_array(plant->tag_count + 1, sizeof(*confidence));
    const char *slash = strrchr(plant->files.tags_path, '/');
    char *path = mem_printf("%.*smatches.csv", slash ? (int)(slash + 1 - plant->files.tags_path) : 0, plant->files.tags_path);
    struct diag diag = { 0 };
    struct csv csv;
    for (size_t i = 0; i < plant->tag_count; i++)
        confidence[i] = NAN;
    if (access(path, R_OK) == 0 && csv_open(&csv, path, &diag)) {
        for (int name = csv_find(&csv, "Tag"), column = csv_find(&csv, "Confidence"); csv_next(&csv);) {
            int tag = plant_find_tag(plant, csv_text(&csv, name));
            if (tag >= 0 && csv_text(&csv, column)[0])
                confidence[tag] = strtod(csv_text(&csv, column), NULL);
        }
        csv_close(&csv);
    }
    diag_finish(&diag);
    mem_free(path);
    return confidence;
}

/* --- choosing which assumed positions of sensors to accept ----------------------------------------------------------------- */

static bool is_like(const char *pattern, const struct plant_tag *tag)
{
    if (strpbrk(pattern, "*?"))
        return fnmatch(pattern, tag->name, FNM_CASEFOLD | FNM_NOESCAPE) == 0;
    return strcasestr(tag->name, pattern) || (tag->description && strcasestr(tag->description, pattern));
}

static bool is_meant(const struct assumed_filter *filter, const struct plant_tag *tag)
{
    return tag->place.assumed && tag->asset >= 0 && (filter->asset < 0 || tag->asset == filter->asset) &&
           (filter->group < 0 || tag->group == filter->group) && (!filter->pattern[0] || is_like(filter->pattern, tag));
}

size_t assumed_places_choose(const struct scene *scene, const struct assumed_filter *filter, uint8_t *outcome)
{
    const struct plant *plant = scene->plant;
    double *distance_m = surface_distances(scene), *confidence = filter->confidence >= 0 ? confidences(plant) : NULL;
    size_t accepted = 0;
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        outcome[i] = !is_meant(filter, tag)                                      ? ASSUMED_NOT_MEANT
                     : !tag->place.has_position && !tag->place.node              ? ASSUMED_NOWHERE
                     : isnan(distance_m[i])                                      ? ASSUMED_MISSING
                     : filter->within_m >= 0 && distance_m[i] > filter->within_m ? ASSUMED_FAR
                     : confidence && !(confidence[i] >= filter->confidence)      ? ASSUMED_UNSURE
                                                                                 : ASSUMED_ACCEPTED;
        accepted += outcome[i] == ASSUMED_ACCEPTED;
    }
    mem_free(distance_m);
    mem_free(confidence);
    return accepted;
}

char *assumed_places_accept(const struct plant *plant, const char *list, const uint8_t *outcome, struct refusal *why)
{
    struct tag_edit *edits = mem_array(plant->tag_count + 1, sizeof(*edits));
    size_t count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (outcome[i] == ASSUMED_ACCEPTED)
            edits[count++] = (struct tag_edit){ .tag = plant->tags[i].name, .place_only = true };
    char *after = tag_edit(list, edits, count, why);
    mem_free(edits);
    return after;
}

void assumed_filter_text(const struct plant *plant, const struct assumed_filter *filter, char *out, size_t size)
{
    struct text text = { 0 };
    if (filter->asset >= 0)
        text_add(&text, ", asset %s", plant->assets[filter->asset].id);
    if (filter->group >= 0)
        text_add(&text, ", group %s", plant->groups[filter->group].id);
    if (filter->pattern[0])
        text_add(&text, ", tags like '%s'", filter->pattern);
    if (filter->within_m >= 0)
        text_add(&text, ", within %g m of the surface", filter->within_m);
    if (filter->confidence >= 0)
        text_add(&text, ", confidence at least %g", filter->confidence);
    snprintf(out, size, "%s", text.at ? text.at + 2 : "all");
    text_finish(&text);
}
