/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks up the tags that cells of other tags name: quality tags, tags with directions, heartbeats. */
#include "plant/tags/tag_links.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plant/parse/suggest.h"

/* Parses an integer in C notation and moves *text past it. Returns false if the text does not begin with an integer. */
static bool take_number(const char **text, uint64_t *out)
{
    char *end;
    if (!strchr("0123456789", **text) || !**text)
        return false;
    *out = strtoull(*text, &end, 0);
    *text = end;
    return true;
}

/* Parses [!]NAME, NAME&MASK or NAME&MASK=VALUE. Returns the name, or NULL if the text has none of these forms. */
static char *read_form(const char *text, struct plant_quality_tag *out)
{
    bool turned = *text == '!';
    const char *name = text + turned, *mask = strrchr(name, '&');
    size_t length = mask ? (size_t)(mask - name) : strlen(name);
    while (length > 0 && name[length - 1] == ' ')
        length--;
    *out = (struct plant_quality_tag){ .tag = -1, .mask = UINT64_MAX, .negate = !turned };
    if (mask) {
        mask++;
        mask += strspn(mask, " ");
        if (!take_number(&mask, &out->mask))
            return NULL;
        mask += strspn(mask, " ");
        if (*mask == '=') {
            mask += 1 + strspn(mask + 1, " ");
            out->negate = turned;
            if (!take_number(&mask, &out->want))
                return NULL;
        }
        if (*mask || out->mask == 0 || (out->want & ~out->mask))
            return NULL;
    }
    return length > 0 ? mem_printf("%.*s", (int)length, name) : NULL;
}

static void add_link(struct tag_links *links, struct tag_columns *columns, enum tag_column cell, size_t tag, char *to)
{
    int column = columns->at[cell];
    mem_grow(&links->at, &links->capacity, links->count + 1, sizeof(*links->at));
    links->at[links->count++] = (struct tag_link){
        .tag = tag, .to = to, .line = csv_cell_line(&columns->csv, column), .column = csv_cell_column(&columns->csv, column)
    };
}

/* Records the names in a tag's column Direction, one (a bearing) or three (components), to be looked up once the whole tag list is read. */
static void add_direction(struct tag_links *links, struct tag_columns *columns, size_t tag)
{
    const char *at = cell_text(columns, COL_DIRECTION);
    int count = 0;
    for (at += strspn(at, " "); *at && count < 4; count++) {
        size_t length = strcspn(at, " ");
        add_link(links, columns, COL_DIRECTION, tag, mem_printf("%.*s", (int)length, at));
        links->at[links->count - 1].direction = true;
        at += length + strspn(at + length, " ");
    }
    if (count != 0 && count != 1 && count != 3)
        cell_error(columns, COL_DIRECTION,
                   "Direction: expected one tag (a bearing in degrees) or three tags (the components along X, Y and Z), found '%.60s'",
                   cell_text(columns, COL_DIRECTION));
}

bool tag_is_derived(const struct tag_columns *columns)
{
    return *cell_text(columns, COL_ADDRESS) == '=';
}

void tag_links_add(struct tag_links *links, struct tag_links *derived, struct tag_columns *columns, struct plant *plant, size_t tag)
{
    struct plant_quality_tag *quality = &plant->tags[tag].validity.quality;
    const char *text = cell_text(columns, COL_QUALITY_TAG);
    if (tag_is_derived(columns))
        add_link(derived, columns, COL_ADDRESS, tag, NULL);
    add_direction(links, columns, tag);
    if (!*text)
        return;
    char *name = read_form(text, quality);
    if (!name) {
        cell_error(columns, COL_QUALITY_TAG,
                   "Quality Tag: expected TAG, !TAG, TAG&MASK or TAG&MASK=VALUE, such as ST-101&0x0C=0x04, found '%.60s'", text);
        return;
    }
    add_link(links, columns, COL_QUALITY_TAG, tag, name);
}

static void report_unknown(const struct plant *plant, struct diag *diag, const char *path, int line, int column, const char *what,
                           const char *name)
{
    const char *near = suggest_nearest(name, plant->tags, plant->tag_count, sizeof(*plant->tags));
    if (near)
        diag_error(diag, path, line, column, "%s: unknown tag '%.60s'; did you mean '%s'?", what, name, near);
    else
        diag_error(diag, path, line, column, "%s: unknown tag '%.60s'", what, name);
}

static void resolve_quality(const struct tag_link *link, struct plant *plant, struct diag *diag)
{
    struct plant_tag *tag = &plant->tags[link->tag];
    tag->validity.quality.tag = plant_find_tag(plant, link->to);
    if (tag->validity.quality.tag < 0)
        report_unknown(plant, diag, plant->files.tags_path, link->line, link->column, "Quality Tag", link->to);
    else if (tag->validity.quality.tag == (int)link->tag)
        diag_error(diag, plant->files.tags_path, link->line, link->column, "Quality Tag: expected a tag other than '%.60s' itself",
                   link->to);
    else if (plant->tags[tag->validity.quality.tag].validity.quality.mask != 0)
        diag_error(diag, plant->files.tags_path, link->line, link->column,
                   "Quality Tag: '%.60s' has a quality tag of its own, which is not allowed for a quality tag", link->to);
}

static void resolve_direction(const struct tag_link *link, struct plant *plant, struct diag *diag)
{
    struct plant_tag *tag = &plant->tags[link->tag];
    int to = plant_find_tag(plant, link->to);
    if (to < 0)
        report_unknown(plant, diag, plant->files.tags_path, link->line, link->column, "Direction", link->to);
    else if (to == (int)link->tag)
        diag_error(diag, plant->files.tags_path, link->line, link->column, "Direction: expected tags other than '%.60s' itself", link->to);
    else if (tag->group < 0 || tag->asset < 0 || tag->place.assumed)
        diag_error(diag, plant->files.tags_path, link->line, link->column,
                   "Direction: '%.60s' needs a group, an asset and a position (X, Y, Z or Node), where the direction starts", tag->name);
    else if (tag->direction.count < 3)
        tag->direction.tags[tag->direction.count++] = to;
    if (tag->direction.count > 0)
        plant->groups[tag->group].directed = true;
}

static void resolve_heartbeat(struct plant_source *source, struct plant *plant, struct diag *diag)
{
    source->heartbeat_tag = plant_find_tag(plant, source->heartbeat);
    if (source->heartbeat_tag < 0)
        report_unknown(plant, diag, plant->files.path, source->line, 1, "heartbeat", source->heartbeat);
    else if (plant->tags[source->heartbeat_tag].source != source - plant->sources)
        diag_error(diag, plant->files.path, source->line, 1, "heartbeat: '%.60s' is not read from source %s", source->heartbeat,
                   source->id);
}

void tag_links_resolve(struct tag_links *links, struct plant *plant, struct diag *diag)
{
    for (size_t i = 0; i < links->count; i++) {
        (links->at[i].direction ? resolve_direction : resolve_quality)(&links->at[i], plant, diag);
        mem_free(links->at[i].to);
    }
    mem_free(links->at);
    for (size_t i = 0; i < plant->source_count; i++)
        if (plant->sources[i].heartbeat)
            resolve_heartbeat(&plant->sources[i], plant, diag);
}
