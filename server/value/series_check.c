/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that the files of replay sources contain the series that the tags replay. */
#include "value/series_check.h"

#include <string.h>

#include "plant/parse/suggest.h"
#include "value/series.h"

static bool has_name(const struct series_names *names, const char *name)
{
    size_t i = 0;
    while (i < names->count && strcmp(names->at[i], name) != 0)
        i++;
    return i < names->count;
}

static void check_tag(const struct plant *plant, const struct plant_tag *tag, const struct series_names *names, struct diag *diag)
{
    const char *name = tag->signal.address && *tag->signal.address ? tag->signal.address : tag->name,
               *file = plant->sources[tag->source].file;
    if (has_name(names, name))
        return;
    const char *near = suggest_nearest(name, names->at, names->count, sizeof(*names->at));
    if (near)
        diag_error(diag, plant->files.tags_path, tag->line, tag->column, "%s: %s has no series '%.80s'; did you mean '%.80s'?", tag->name,
                   file, name, near);
    else
        diag_error(diag, plant->files.tags_path, tag->line, tag->column, "%s: %s has no series '%.80s'", tag->name, file, name);
}

void series_check(const struct plant *plant, struct diag *diag)
{
    for (size_t s = 0; s < plant->source_count; s++) {
        struct series_names names;
        char why[200];
        if (!plant->sources[s].file)
            continue;
        if (!series_list(&names, plant->sources[s].file, why)) {
            diag_error(diag, plant->files.path, plant->sources[s].line, 0, "source %s: %s", plant->sources[s].id, why);
            continue;
        }
        for (size_t i = 0; i < plant->tag_count && names.whole; i++)
            if (plant->tags[i].source == (int)s)
                check_tag(plant, &plant->tags[i], &names, diag);
        series_names_finish(&names);
    }
}
