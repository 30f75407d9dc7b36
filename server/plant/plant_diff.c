/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two plants. */
#include "plant/plant_diff.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"
#include "plant/sources/mqtt_address.h"
#include "plant/tags/expression.h"

static void __attribute__((format(printf, 2, 3))) say(struct plant_diff *diff, const char *fmt, ...)
{
    char line[400];
    va_list ap;
    if (diff->count == PLANT_DIFF_LINES) {
        diff->more++;
        return;
    }
    va_start(ap, fmt);
    vsnprintf(line, sizeof(line), fmt, ap);
    va_end(ap);
    mem_grow(&diff->lines, &diff->capacity, diff->count + 1, sizeof(*diff->lines));
    diff->lines[diff->count++] = mem_strdup(line);
}

static bool same_text(const char *a, const char *b)
{
    return a == b || (a && b && !strcmp(a, b));
}

static bool same_number(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

/* --- tags ------------------------------------------------------------------------------------------------------------------- */

static void add_difference(char *what, size_t size, bool differs, const char *name)
{
    size_t n = strlen(what);
    if (differs)
        snprintf(what + n, size - n, "%s%s", n ? ", " : "", name);
}

static const char *group_of(const struct plant *plant, const struct plant_tag *tag)
{
    return tag->group < 0 ? "" : plant->groups[tag->group].id;
}

static const char *asset_of(const struct plant *plant, const struct plant_tag *tag)
{
    return tag->asset < 0 ? "" : plant->assets[tag->asset].id;
}

static const char *source_of(const struct plant *plant, const struct plant_tag *tag)
{
    return tag->source < 0 ? "" : plant->sources[tag->source].id;
}

/* Writes an alarm limit as text to `out`, or "none" if the limit is NaN (not set). Returns `out`. */
static const char *limit_text(double limit, char out[32])
{
    snprintf(out, 32, isnan(limit) ? "none" : "%g", limit);
    return out;
}

static void compare_limits(struct plant_diff *diff, const struct plant_tag *a, const struct plant_tag *b)
{
    char before[32], after[32];
    for (int i = 0; i < LIMIT_COUNT; i++)
        if (!same_number(a->alarms.limits[i], b->alarms.limits[i]))
            say(diff, "tag %s: %s %s > %s", b->name, plant_limit_names[i], limit_text(a->alarms.limits[i], before),
                limit_text(b->alarms.limits[i], after));
}

static bool same_place(const struct tag_place *a, const struct tag_place *b)
{
    return same_text(a->node, b->node) && memcmp(a->position_m, b->position_m, sizeof(a->position_m)) == 0 && a->assumed == b->assumed;
}

static bool same_sentinels(const struct tag_scale *a, const struct tag_scale *b)
{
    bool same = a->sentinel_count == b->sentinel_count;
    for (int i = 0; same && i < b->sentinel_count; i++) {
        const struct plant_sentinel *x = &a->sentinels[i], *y = &b->sentinels[i];
        same = x->is_bits == y->is_bits && (x->is_bits ? x->bits == y->bits : same_number(x->number, y->number));
    }
    return same;
}

static bool same_scale(const struct tag_scale *a, const struct tag_scale *b)
{
    return a->kind == b->kind && a->raw_low == b->raw_low && a->raw_high == b->raw_high && a->scaled_low == b->scaled_low &&
           a->scaled_high == b->scaled_high && a->negate == b->negate && a->ne43 == b->ne43 && same_sentinels(a, b);
}

static int modbus_unit_of(const struct plant *plant, const struct plant_tag *tag)
{
    return tag->source < 0 ? -1 : plant_tag_modbus_unit(plant, tag);
}

static const char *path_of(const struct plant *plant, const struct plant_tag *tag)
{
    return tag->source < 0 ? "" : mqtt_address_path(plant, tag);
}

/* Returns whether two tags read the same address of their source. Compares the parsed members too, because they also depend on the
   source's keys, such as `address_base`, `topic` and `value`. */
static bool same_address(const struct plant *before, const struct plant_tag *a, const struct plant *after, const struct plant_tag *b)
{
    const struct tag_signal *x = &a->signal, *y = &b->signal;
    return same_text(x->address, y->address) && same_text(x->topic, y->topic) && same_text(path_of(before, a), path_of(after, b)) &&
           x->element == y->element && modbus_unit_of(before, a) == modbus_unit_of(after, b) && x->table == y->table &&
           x->register_index == y->register_index && x->bit == y->bit && x->type == y->type && x->byte_order == y->byte_order;
}

static bool same_unit(const struct plant_tag *a, const struct plant_tag *b)
{
    struct unit_change change;
    bool changed = a->scale.change.converts != b->scale.change.converts || a->scale.change.factor != b->scale.change.factor ||
                   a->scale.change.offset != b->scale.change.offset;
    return !changed && (!a->unit || !b->unit || units_compare(a->unit, b->unit, &change) == UNITS_SAME);
}

static bool same_signal(const struct plant *before, const struct plant_tag *a, const struct plant *after, const struct plant_tag *b)
{
    return same_text(source_of(before, a), source_of(after, b)) && same_address(before, a, after, b) && same_scale(&a->scale, &b->scale) &&
           same_unit(a, b);
}

static bool keeps_signal(const struct plant *before, const struct plant *after, const struct plant_tag *tag, const bool *kept)
{
    int was = plant_find_tag(before, tag->name);
    const int *inputs = NULL;
    size_t count = tag->expression ? expression_inputs(tag->expression, &inputs) : 0;
    bool keeps = was >= 0 && same_signal(before, &before->tags[was], after, tag);
    for (size_t i = 0; keeps && i < count; i++)
        keeps = kept[inputs[i]];
    return keeps;
}

void plant_kept_signals(const struct plant *before, const struct plant *after, bool *kept)
{
    for (size_t i = 0; i < after->tag_count; i++)
        if (!after->tags[i].expression)
            kept[i] = keeps_signal(before, after, &after->tags[i], kept);
    for (size_t i = 0; i < after->derived_count; i++)
        kept[after->derived[i]] = keeps_signal(before, after, &after->tags[after->derived[i]], kept);
}

static bool same_settings(const struct plant_alarm_settings *a, const struct plant_alarm_settings *b)
{
    return a->deadband == b->deadband && a->on_delay_s == b->on_delay_s && a->off_delay_s == b->off_delay_s &&
           a->priority == b->priority && a->latch == b->latch;
}

static bool same_direction(const struct plant *before, const struct plant_tag *a, const struct plant *after, const struct plant_tag *b)
{
    bool same = a->direction.count == b->direction.count;
    for (int i = 0; i < b->direction.count && same; i++)
        same = same_text(before->tags[a->direction.tags[i]].name, after->tags[b->direction.tags[i]].name);
    return same;
}

static void compare_tags(struct plant_diff *diff, const struct plant *before, const struct plant_tag *a, const struct plant *after,
                         const struct plant_tag *b)
{
    char what[300] = "";
    compare_limits(diff, a, b);
    add_difference(what, sizeof(what), !same_address(before, a, after, b), "address");
    add_difference(what, sizeof(what), !same_text(source_of(before, a), source_of(after, b)), "source");
    add_difference(what, sizeof(what), !same_text(group_of(before, a), group_of(after, b)), "group");
    add_difference(what, sizeof(what), !same_text(asset_of(before, a), asset_of(after, b)), "asset");
    add_difference(what, sizeof(what), !same_place(&a->place, &b->place), "place");
    add_difference(what, sizeof(what), !same_direction(before, a, after, b), "direction");
    add_difference(what, sizeof(what), !same_scale(&a->scale, &b->scale), "scaling");
    add_difference(what, sizeof(what), a->signal.scan_ms != b->signal.scan_ms || a->validity.stale_s != b->validity.stale_s, "timing");
    add_difference(what, sizeof(what), a->strength != b->strength || a->decay != b->decay, "strength, decay");
    add_difference(what, sizeof(what),
                   !same_text(a->unit, b->unit) || !same_text(a->scale.own_unit, b->scale.own_unit) ||
                       !same_text(a->description, b->description),
                   "unit, description");
    const struct opcua_deadband *opc_a = &a->signal.opcua_deadband, *opc_b = &b->signal.opcua_deadband;
    add_difference(what, sizeof(what),
                   !same_number(a->deadband, b->deadband) || !same_number(opc_a->value, opc_b->value) || opc_a->percent != opc_b->percent,
                   "deadband");
    add_difference(what, sizeof(what), !same_settings(&a->alarms.settings, &b->alarms.settings), "alarming");
    if (what[0])
        say(diff, "tag %s changed: %s", b->name, what);
}

static void diff_tags(struct plant_diff *diff, const struct plant *before, const struct plant *after)
{
    for (size_t i = 0; i < before->tag_count; i++)
        if (plant_find_tag(after, before->tags[i].name) < 0)
            say(diff, "tag %s removed", before->tags[i].name);
    for (size_t i = 0; i < after->tag_count; i++) {
        int was = plant_find_tag(before, after->tags[i].name);
        if (was < 0)
            say(diff, "tag %s added", after->tags[i].name);
        else
            compare_tags(diff, before, &before->tags[was], after, &after->tags[i]);
    }
}

/* --- assets, groups, sources ------------------------------------------------------------------------------------------------ */

static void diff_assets(struct plant_diff *diff, const struct plant *before, const struct plant *after)
{
    for (size_t i = 0; i < before->asset_count; i++)
        if (plant_find_asset(after, before->assets[i].id) < 0)
            say(diff, "asset %s removed", before->assets[i].id);
    for (size_t i = 0; i < after->asset_count; i++) {
        const struct plant_asset *b = &after->assets[i];
        int was = plant_find_asset(before, b->id);
        const struct plant_asset *a = was < 0 ? NULL : &before->assets[was];
        if (!a)
            say(diff, "asset %s added", b->id);
        else if (!same_text(a->model, b->model) || !same_text(a->nodes, b->nodes) || a->unit_m != b->unit_m || a->up != b->up ||
                 memcmp(a->placement, b->placement, sizeof(a->placement)) != 0 || !same_text(a->tag, b->tag) ||
                 !same_text(a->description, b->description) || !same_text(a->area, b->area) || a->start != b->start ||
                 a->thickness_m != b->thickness_m || a->conductivity != b->conductivity || a->heat_transfer != b->heat_transfer ||
                 !plant_properties_same(a, b))
            say(diff, "asset %s changed", b->id);
    }
}

static bool same_group(const struct plant_group *a, const struct plant_group *b)
{
    bool same = same_text(a->unit, b->unit) && a->as_written == b->as_written && same_text(a->quantity, b->quantity) && a->min == b->min &&
                a->max == b->max;
    for (int i = 0; i < LIMIT_COUNT; i++)
        same = same && same_number(a->limits[i], b->limits[i]);
    return same && a->interpolation == b->interpolation && a->distance == b->distance && a->strength == b->strength &&
           a->decay == b->decay && a->power == b->power && a->radius_m == b->radius_m && a->reach_m == b->reach_m &&
           a->prepared == b->prepared && a->heat == b->heat && a->disc_m == b->disc_m && same_number(a->ambient, b->ambient) &&
           a->hot_spot_m == b->hot_spot_m && same_number(a->gp.range_m, b->gp.range_m) && same_number(a->gp.noise, b->gp.noise) &&
           same_number(a->gp.deviation, b->gp.deviation) && same_text(a->gp.fit, b->gp.fit) &&
           a->cuts_singles == b->cuts_singles && a->fill == b->fill && a->log == b->log && a->break_count == b->break_count &&
           a->isoline_count == b->isoline_count && !memcmp(a->breaks, b->breaks, sizeof(a->breaks)) &&
           !memcmp(a->isolines, b->isolines, sizeof(a->isolines)) && a->alarm_settings.deadband == b->alarm_settings.deadband &&
           a->alarm_settings.priority == b->alarm_settings.priority;
}

static void diff_groups(struct plant_diff *diff, const struct plant *before, const struct plant *after)
{
    for (size_t i = 0; i < before->group_count; i++)
        if (plant_find_group(after, before->groups[i].id) < 0)
            say(diff, "group %s removed", before->groups[i].id);
    for (size_t i = 0; i < after->group_count; i++) {
        int was = plant_find_group(before, after->groups[i].id);
        if (was < 0)
            say(diff, "group %s added", after->groups[i].id);
        else if (!same_group(&before->groups[was], &after->groups[i]))
            say(diff, "group %s changed", after->groups[i].id);
    }
}

static const struct plant_source *find_source(const struct plant *plant, const char *id)
{
    for (size_t i = 0; i < plant->source_count; i++)
        if (!strcmp(plant->sources[i].id, id))
            return &plant->sources[i];
    return NULL;
}

static void diff_sources(struct plant_diff *diff, const struct plant *before, const struct plant *after)
{
    for (size_t i = 0; i < before->source_count; i++)
        if (!find_source(after, before->sources[i].id))
            say(diff, "source %s removed", before->sources[i].id);
    for (size_t i = 0; i < after->source_count; i++)
        if (!find_source(before, after->sources[i].id))
            say(diff, "source %s added", after->sources[i].id);
}

void plant_diff(const struct plant *before, const struct plant *after, struct plant_diff *out)
{
    if (before->alarms != after->alarms)
        say(out, "the key `alarms` of the plant file (display, mirror or local) has changed");
    diff_assets(out, before, after);
    diff_groups(out, before, after);
    diff_sources(out, before, after);
    diff_tags(out, before, after);
    if (out->more > 0) {
        mem_free(out->lines[PLANT_DIFF_LINES - 1]);
        out->lines[PLANT_DIFF_LINES - 1] = mem_printf("and %zu more", out->more + 1);
    }
}

void plant_diff_finish(struct plant_diff *diff)
{
    for (size_t i = 0; i < diff->count; i++)
        mem_free(diff->lines[i]);
    mem_free(diff->lines);
    *diff = (struct plant_diff){ 0 };
}

const char *plant_needs_restart(const struct plant *before, const struct plant *after)
{
    if (strcmp(before->time_zone, after->time_zone) != 0)
        return "a changed `time_zone` in the plant file takes effect only after a restart of the daemon";
    if (before->history.off != after->history.off || !same_text(before->history.folder, after->history.folder))
        return "a changed history folder, or history switched on or off, takes effect only after a restart of the daemon";
    bool same = before->display.colormap_count == after->display.colormap_count;
    for (size_t i = 0; same && i < before->display.colormap_count; i++)
        same = !strcmp(before->display.colormaps[i].name, after->display.colormaps[i].name) &&
               !memcmp(before->display.colormaps[i].rgb, after->display.colormaps[i].rgb, sizeof(before->display.colormaps[i].rgb));
    return same ? NULL : "changed colour maps take effect only after a restart of the daemon";
}
