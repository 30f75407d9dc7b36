/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the tag list: turns rows into tags and checks each row. TAGS.md describes the format. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "plant/plant_impl.h"
#include "plant/sources/address.h"
#include "plant/sections/plant_alarms.h"
#include "plant/tags/tag_columns.h"
#include "plant/tags/tag_links.h"
#include "plant/tags/tag_wire.h"

struct tag_list {
    struct plant *plant;
    struct tag_columns columns;
    struct plant_tag *tag;           /* tag that the current row of the tag list describes */
    const struct plant_group *group; /* group that the current row's tag belongs to; NULL: none */
    struct tag_links links, derived;
    size_t capacity; /* of plant->tags */
    struct alarm_references references;
};

/* --- source, group, asset --------------------------------------------------------------------------------------------------- */

static void read_source(struct tag_list *list)
{
    const struct plant *plant = list->plant;
    list->tag->source = cell_reference(&list->columns, COL_SOURCE, "source", plant->sources, plant->source_count, sizeof(*plant->sources));
    if (cell_given(&list->columns, COL_SOURCE) && tag_is_derived(&list->columns)) {
        cell_error(&list->columns, COL_SOURCE,
                   "Source: must be empty, because Address is an expression that computes the tag from other tags");
        list->tag->source = -1;
    }
    if (cell_given(&list->columns, COL_SOURCE) || tag_is_derived(&list->columns))
        return;
    if (plant->source_count == 1)
        list->tag->source = 0;
    else if (plant->source_count > 1)
        cell_error(&list->columns, COL_SOURCE, "Source: expected the id of one of the %zu sources", plant->source_count);
}

static bool is_lost(const struct tag_list *list)
{
    const char *id = cell_text(&list->columns, COL_ASSET);
    return *id && plant_find_asset(list->plant, id) < 0;
}

/* Reads group and asset of a tag's row. If the plant file has no groups or no assets at all, reports that once for the plant
   file, not for each row. */
static void read_group_and_asset(struct tag_list *list)
{
    const struct plant *plant = list->plant;
    struct plant_tag *tag = list->tag;
    tag->group = tag->asset = -1;
    if (plant->group_count > 0)
        tag->group = cell_reference(&list->columns, COL_GROUP, "group", plant->groups, plant->group_count, sizeof(*plant->groups));
    if (plant->files.keeps_orphans && is_lost(list))
        tag->place.lost_asset = mem_strdup(cell_text(&list->columns, COL_ASSET));
    else if (plant->asset_count > 0)
        tag->asset = cell_reference(&list->columns, COL_ASSET, "asset", plant->assets, plant->asset_count, sizeof(*plant->assets));
    list->group = tag->group >= 0 ? &plant->groups[tag->group] : NULL;
}

/* --- place ------------------------------------------------------------------------------------------------------------------ */

static void read_position(struct tag_list *list)
{
    static const enum tag_column axes[3] = { COL_X, COL_Y, COL_Z };
    struct plant_tag *tag = list->tag;
    int given = 0, good = 0;
    for (int i = 0; i < 3; i++) {
        given += cell_given(&list->columns, axes[i]);
        good += cell_number(&list->columns, axes[i], -PLANT_MAX_M, PLANT_MAX_M, &tag->place.position_m[i]);
    }
    tag->place.has_position = good == 3;
    for (int i = 0; i < 3 && given > 0; i++)
        if (!cell_given(&list->columns, axes[i]))
            cell_error(&list->columns, axes[i], "%s: expected a number, because a position needs X, Y and Z", tag_column_name(axes[i]));
}

static void read_place(struct tag_list *list)
{
    struct tag_columns *columns = &list->columns;
    struct plant_tag *tag = list->tag;
    const char *place = cell_text(columns, COL_PLACE);
    read_position(list);
    tag->place.assumed = !strcasecmp(place, "equipment");
    if (*place && !tag->place.assumed && strcasecmp(place, "position") != 0)
        cell_error(columns, COL_PLACE, "Place: expected position or equipment, found '%.60s'", place);
    bool has_xyz = cell_given(columns, COL_X) || cell_given(columns, COL_Y) || cell_given(columns, COL_Z);
    if (cell_given(columns, COL_NODE))
        tag->place.node = mem_strdup(cell_text(columns, COL_NODE));
    if (has_xyz && tag->place.node)
        cell_warning(columns, COL_NODE, "Node has no effect, because X, Y, Z are given");
    if (!cell_given(columns, COL_GROUP))
        return;
    if (!cell_given(columns, COL_ASSET))
        cell_warning(columns, columns->at[COL_ASSET] >= 0 ? COL_ASSET : COL_GROUP, "'%.60s' has a group but no asset, so no field uses it",
                     tag->name);
    else if (!has_xyz && !tag->place.node && !tag->place.assumed)
        cell_error(columns, columns->at[COL_NODE] >= 0 ? COL_NODE : COL_ASSET,
                   "'%.60s' has a group and an asset but no place: expected Node, or X, Y and Z, or Place: equipment", tag->name);
}

/* --- unit, limits, timing --------------------------------------------------------------------------------------------------- */

/* Reports why the unit of a row cannot be converted to the unit of its group. */
static void report_unit(struct tag_list *list, enum unit_match match, const char *text)
{
    static const char otherwise[] = "'units: as-written' in the group switches the conversion off";
    const char *of_group = list->group->unit, *kind = unit_kind(text);
    char near[UNIT_NAME_BYTES], hint[UNIT_NAME_BYTES + 40] = "";
    if (!kind && unit_suggest(text, near))
        snprintf(hint, sizeof(hint), "; did you mean '%s'?", near);
    if (match == UNITS_OTHER_KIND)
        cell_error(&list->columns, COL_ENG_UNITS, "Eng Units: '%.60s' (%s) cannot be converted to '%.60s' (%s), the unit of its group; %s",
                   text, kind, of_group, unit_kind(of_group), otherwise);
    else
        cell_error(&list->columns, COL_ENG_UNITS,
                   "Eng Units: '%.60s' cannot be converted to '%.60s', the unit of its group, since '%.60s' is not known%s; %s", text,
                   of_group, kind ? of_group : text, hint, otherwise);
}

static void read_unit(struct tag_list *list)
{
    const char *text = cell_text(&list->columns, COL_ENG_UNITS), *of_group = list->group ? list->group->unit : NULL;
    struct plant_tag *tag = list->tag;
    enum unit_match match = UNITS_SAME;
    if (*text && of_group && !*of_group)
        cell_warning(&list->columns, COL_ENG_UNITS, "Eng Units: the tag has the unit '%.60s', but its group has no unit", text);
    else if (*text && of_group && !list->group->as_written)
        match = units_compare(text, of_group, &tag->scale.change);
    tag->scale.own_unit = mem_strdup(*text || !of_group ? text : of_group);
    tag->unit = mem_strdup(match == UNITS_CONVERT ? of_group : tag->scale.own_unit);
    if (match == UNITS_OTHER_KIND || match == UNITS_UNKNOWN)
        report_unit(list, match, text);
}

/* Reads one limit of a row, given in the row's own unit; "none" drops the group's limit. Returns false if the cell is blank. */
static bool read_limit(struct tag_list *list, enum tag_column column, double *limit)
{
    bool drops = !strcasecmp(cell_text(&list->columns, column), "none");
    if (!drops && !cell_number(&list->columns, column, -PLANT_MAX_VALUE, PLANT_MAX_VALUE, limit))
        return false;
    *limit = drops ? (double)NAN : unit_change_value(&list->tag->scale.change, *limit);
    return true;
}

static void read_limits(struct tag_list *list)
{
    static const enum tag_column names[LIMIT_COUNT] = { [LIMIT_LL] = COL_LL, [LIMIT_L] = COL_L, [LIMIT_H] = COL_H, [LIMIT_HH] = COL_HH };
    struct tag_columns *columns = &list->columns;
    double *limits = list->tag->alarms.limits;
    bool own[LIMIT_COUNT], any = false;
    int lower, upper;
    for (int i = 0; i < LIMIT_COUNT; i++) {
        limits[i] = list->group ? list->group->limits[i] : NAN;
        own[i] = read_limit(list, names[i], &limits[i]);
        any |= own[i];
    }
    if (any && plant_limits_wrong(limits, &lower, &upper))
        cell_error(columns, names[own[upper] ? upper : lower], "%s%s is %.9g, but %s%s is %.9g%s%s; expected LL < L < H < HH",
                   plant_limit_names[lower], own[lower] ? "" : " of the group", limits[lower], plant_limit_names[upper],
                   own[upper] ? "" : " of the group", limits[upper], list->tag->scale.change.converts ? ", in " : "",
                   list->tag->scale.change.converts ? list->tag->unit : "");
}

static bool is_modbus(const struct plant *plant, const struct plant_tag *tag)
{
    const char *kind = tag->source >= 0 && !tag->expression ? plant->sources[tag->source].kind : NULL;
    return kind && !strcmp(kind, "modbus");
}

static void read_timing(struct tag_list *list)
{
    struct plant_tag *tag = list->tag;
    double scan_ms = 0;
    if (strcmp(cell_text(&list->columns, COL_SCAN_RATE), "0") != 0)
        cell_number(&list->columns, COL_SCAN_RATE, 10, 86400000, &scan_ms);
    tag->signal.scan_ms = (int)ceil(scan_ms);
    const double read_s = plant_tag_scan_ms(list->plant, tag) / 1000.0;
    tag->validity.stale_s = plant_tag_default_stale_s(list->plant, tag);
    tag->validity.states_stale = cell_number(&list->columns, COL_STALE, 1e-3, 1e6, &tag->validity.stale_s);
    if (tag->validity.states_stale && is_modbus(list->plant, tag) && tag->validity.stale_s <= read_s)
        cell_warning(&list->columns, COL_STALE,
                     "Stale s: '%.60s' is read every %.9g s, so each reading is stale before the next one arrives; write at least %.9g",
                     tag->name, read_s, 3 * read_s);
    cell_number(&list->columns, COL_FLATLINE, 1e-3, 1e8, &tag->validity.flatline_s);
}

static void read_deadband(struct tag_list *list)
{
    list->tag->deadband = NAN;
    if (cell_number(&list->columns, COL_DEADBAND, 0, PLANT_MAX_VALUE, &list->tag->deadband))
        list->tag->deadband = unit_change_span(&list->tag->scale.change, list->tag->deadband);
}

static void read_weights(struct tag_list *list)
{
    list->tag->strength = list->group ? list->group->strength : 1;
    list->tag->decay = list->group ? list->group->decay : 1;
    cell_number(&list->columns, COL_STRENGTH, 0, 100, &list->tag->strength);
    cell_number(&list->columns, COL_DECAY, 0, 100, &list->tag->decay);
}

static void read_row(struct tag_list *list)
{
    struct plant *plant = list->plant;
    int name = list->columns.at[COL_NAME];
    mem_grow(&plant->tags, &list->capacity, plant->tag_count + 1, sizeof(*plant->tags));
    list->tag = &plant->tags[plant->tag_count++];
    *list->tag = (struct plant_tag){
        .name = mem_strdup(cell_text(&list->columns, COL_NAME)),
        .description = mem_strdup(cell_text(&list->columns, COL_DESCRIPTION)),
        .line = csv_cell_line(&list->columns.csv, name),
        .column = csv_cell_column(&list->columns.csv, name),
        .signal.modbus_unit = -1,
        .signal.bit = -1,
        .signal.element = -1,
    };
    if (name >= 0 && !*list->tag->name)
        cell_error(&list->columns, COL_NAME, "Tag Name: expected a name, found none");
    read_source(list);
    read_group_and_asset(list);
    tag_wire_read(&list->columns, plant, list->tag);
    tag_links_add(&list->links, &list->derived, &list->columns, plant, plant->tag_count - 1);
    read_place(list);
    read_unit(list);
    read_limits(list);
    read_timing(list);
    read_weights(list);
    read_deadband(list);
    plant_alarms_read_row(&list->columns, plant, list->tag, &list->references);
}

/* --- the whole list --------------------------------------------------------------------------------------------------------- */

static int by_name(const void *pa, const void *pb, void *tags_ptr)
{
    const struct plant_tag *tags = tags_ptr;
    int a = *(const int *)pa, b = *(const int *)pb;
    int order = strcmp(tags[a].name, tags[b].name);
    return order ? order : (a > b) - (a < b);
}

static void sort_names(struct plant *plant)
{
    plant->tags_by_name = mem_array(plant->tag_count, sizeof(*plant->tags_by_name));
    for (size_t i = 0; i < plant->tag_count; i++)
        plant->tags_by_name[i] = (int)i;
    qsort_r(plant->tags_by_name, plant->tag_count, sizeof(*plant->tags_by_name), by_name, plant->tags);
}

static void check_duplicates(const struct plant *plant, struct diag *diag)
{
    size_t first = 0;
    for (size_t i = 1; i < plant->tag_count; i++) {
        const struct plant_tag *one = &plant->tags[plant->tags_by_name[first]], *two = &plant->tags[plant->tags_by_name[i]];
        if (strcmp(one->name, two->name) != 0)
            first = i;
        else if (*two->name)
            diag_error(diag, plant->files.tags_path, two->line, two->column, "Tag Name: '%.60s' is listed twice (first at line %d)",
                       two->name, one->line);
    }
}

/* Returns the number of registers that a tag reads; 0: it reads a bit, or is not a Modbus tag. */
static int registers_of(const struct plant *plant, const struct plant_tag *tag)
{
    return is_modbus(plant, tag) && tag->signal.type != DATA_BIT ? data_type_registers(tag->signal.type) : 0;
}

static int by_register(const void *pa, const void *pb, void *plant_ptr)
{
    const struct plant *plant = plant_ptr;
    const struct plant_tag *a = &plant->tags[*(const int *)pa], *b = &plant->tags[*(const int *)pb];
    const int keys[][2] = { { a->source, b->source },
                            { plant_tag_modbus_unit(plant, a), plant_tag_modbus_unit(plant, b) },
                            { (int)a->signal.table, (int)b->signal.table },
                            { a->signal.register_index, b->signal.register_index },
                            { a->line, b->line } };
    size_t i = 0;
    while (i < sizeof(keys) / sizeof(keys[0]) - 1 && keys[i][0] == keys[i][1])
        i++;
    return (keys[i][0] > keys[i][1]) - (keys[i][0] < keys[i][1]);
}

/* Warns about pairs of values that share some registers but not all: the address or the data type of one must be wrong. */
static void check_overlaps(const struct plant *plant, struct diag *diag)
{
    int *tags = mem_array(plant->tag_count + 1, sizeof(*tags));
    size_t count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (registers_of(plant, &plant->tags[i]) > 0)
            tags[count++] = (int)i;
    qsort_r(tags, count, sizeof(*tags), by_register, (void *)(uintptr_t)plant);
    const struct plant_tag *one = NULL; /* tag before `two` (sorted by register) whose registers reach farthest */
    for (size_t i = 0; i < count; i++) {
        const struct plant_tag *two = &plant->tags[tags[i]];
        bool same = one && one->source == two->source && plant_tag_modbus_unit(plant, one) == plant_tag_modbus_unit(plant, two) &&
                    one->signal.table == two->signal.table;
        int from = same ? two->signal.register_index - one->signal.register_index : 0;
        int left = same ? registers_of(plant, one) - from : 0, length = registers_of(plant, two);
        if (left > 0 && (from > 0 || left != length))
            diag_warning(diag, plant->files.tags_path, two->line, two->column,
                         "Address: '%.60s' (%s) shares a register with '%.60s' (%s, line %d): check both addresses and data types",
                         two->name, data_type_name(two->signal.type), one->name, data_type_name(one->signal.type), one->line);
        if (left < length)
            one = two;
    }
    mem_free(tags);
}

void tag_list_read(struct plant *plant, struct diag *diag)
{
    struct tag_list list = { .plant = plant };
    if (!tag_columns_open(&list.columns, plant->files.tags_path, diag))
        return;
    tag_columns_need(&list.columns, COL_NAME);
    if (plant->source_count > 0)
        tag_columns_need(&list.columns, COL_ADDRESS);
    while (csv_next(&list.columns.csv))
        read_row(&list);
    csv_close(&list.columns.csv);
    sort_names(plant);
    check_duplicates(plant, diag);
    if (!diag->errors)
        check_overlaps(plant, diag);
    tag_links_resolve(&list.links, plant, diag);
    tag_derived_resolve(&list.derived, plant, diag);
    mem_free(list.derived.at);
    plant_alarms_resolve(plant, diag, &list.references);
}
