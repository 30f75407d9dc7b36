/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the fields' vertex values on the GPU up to date. Uploads only changes that are large enough to be visible. */
#include "render/plan/fields.h"

#include <math.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"
#include "plant/influence.h"
#include "render/gl/sensor_cells.h"
#include "render/reference/reference.h"

/* content hash of fields->lost, which replaces every field for which there is no memory; no other entry has this hash */
static const uint64_t LOST = 0x6c6f7374;
/* default size limit of the cache in bytes. It applies to main memory and to GPU memory separately, and is enough for about 700
   assets of 66,000 vertices */
static const size_t BOUND_BYTES = (size_t)384 << 20;

void fields_init(struct fields *fields, struct log *log, struct field *field)
{
    *fields = (struct fields){
        .log = log, .field = field, .lost = { .asset = -1, .content = LOST, .oldest_age_ns = INT64_MAX }, .bound_bytes = BOUND_BYTES
    };
    fields->pool = pool_create(log, "field", GL_RG32UI, sizeof(struct scalar), GL_DYNAMIC_STORAGE_BIT);
}

static void entry_destroy(struct fields *fields, struct fields_entry *entry)
{
    fields->bytes -= entry->count * sizeof(*entry->shown) + (entry->cells ? entry->cells->bytes : 0);
    pool_unref(&entry->slice);
    glDeleteBuffers(1, &entry->sensors);
    sensor_cells_unref(&entry->cells);
    pixel_field_finish(&entry->pixels);
    mem_free(entry->directions);
    mem_free(entry->shown);
    mem_free(entry);
}

void fields_drop(struct fields *fields)
{
    while (fields->count > 0)
        entry_destroy(fields, fields->entries[--fields->count]);
}

void fields_finish(struct fields *fields)
{
    fields_drop(fields);
    mem_free(fields->entries);
    pool_destroy(&fields->pool);
    *fields = (struct fields){ 0 };
}

static struct fields_entry *entry_find(const struct fields *fields, int asset, const struct field_params *params, double step)
{
    for (size_t i = 0; i < fields->count; i++) {
        struct fields_entry *entry = fields->entries[i];
        if (entry->asset == asset && entry->step == step && field_params_equal(&entry->params, params))
            return entry;
    }
    return NULL;
}

static struct fields_entry *entry_create(struct fields *fields, int asset, const struct field_params *params, double step, size_t count)
{
    size_t bytes = count * sizeof(struct scalar);
    struct fields_entry *entry = mem_new(sizeof(*entry));
    *entry = (struct fields_entry){ .asset = asset, .params = *params, .step = step, .count = count };
    entry->shown = mem_try_array(count, sizeof(*entry->shown));
    fields->bytes += bytes;
    if (!entry->shown) {
        log_err(fields->log, "asset number %d of the plant (counted from 0) is shown without data: out of memory for its %zu vertices",
                asset, count);
        entry_destroy(fields, entry);
        return NULL;
    }
    mem_grow(&fields->entries, &fields->capacity, fields->count + 1, sizeof(*fields->entries));
    fields->entries[fields->count++] = entry;
    return entry;
}

/* Takes a slice (range of a GPU buffer) for the entry. If no slice is free, logs that, destroys the entry and returns false. */
static bool take_slice(struct fields *fields, struct fields_entry *entry)
{
    size_t at = 0;
    if (!entry->slice)
        entry->slice = pool_take(fields->pool, entry->count);
    if (entry->slice)
        return true;
    log_err(fields->log, "asset number %d of the plant (counted from 0) is shown without data: out of GPU memory for its %zu vertices",
            entry->asset, entry->count);
    while (fields->entries[at] != entry)
        at++;
    fields->entries[at] = fields->entries[--fields->count];
    entry_destroy(fields, entry);
    return false;
}

/* Returns the largest difference between the newest and the shown value of a vertex; stops searching once it reaches `enough`. */
static double error_of(const struct fields_entry *entry, const struct scalars *now, double enough)
{
    float most = 0;
    size_t ready = entry->ready < now->ready ? entry->ready : now->ready;
    for (size_t i = 0; i < ready && (double)most < enough; i++) {
        float error = fabsf(now->at[i].value - entry->shown[i].value);
        most = error > most ? error : most;
    }
    return most;
}

/* Returns whether the newest values differ from the shown ones by at least half a colour step. An upper bound of the difference usually
   decides; otherwise all vertices are compared. */
static bool can_be_seen(struct fields_entry *entry, const struct scalars *now, const struct pixel_field *pixels)
{
    double half = 0.5 * entry->step;
    if (pixels->count > 0 || entry->pixels.count > 0)
        return (double)pixel_field_change(pixels, &entry->pixels) >= half;
    if (now->flags_version != entry->flags_version)
        return true;
    if (now->travel - entry->travel < half)
        return false;
    double error = error_of(entry, now, half);
    entry->travel = now->travel - error;
    return error >= half;
}

/* Copies the newest values of a field into its entry and hashes them. Any thread. */
static void show(struct fields_entry *entry)
{
    const struct scalars *now = entry->behind;
    if (now) {
        entry->ready = now->ready;
        if (now->ready > 0)
            memcpy(entry->shown, now->at, now->ready * sizeof(*entry->shown));
        entry->uploaded = false;
        entry->hashed = SIZE_MAX;
        entry->flags_version = now->flags_version;
        entry->travel = now->travel;
        entry->behind = NULL;
    }
    if (entry->hashed != entry->wanted) {
        entry->content = entry->pixels.count > 0 ? pixel_field_hash(&entry->pixels)
                                                 : XXH3_64bits(entry->shown, entry->wanted * sizeof(*entry->shown));
        entry->hashed = entry->wanted;
    }
}

/* Uploads the entry's values to the GPU. If a frame in progress still uses the entry's slice (range of a GPU buffer), that
   slice stays unchanged and a new one is taken. Logs and returns false when there is no room for another slice. */
static bool upload(struct fields *fields, struct fields_entry *entry)
{
    if (entry->slice->holds > 1) {
        struct pool_slice *fresh = pool_take(fields->pool, entry->count);
        pool_unref(&entry->slice);
        entry->slice = fresh;
    }
    if (!entry->slice)
        return false;
    glNamedBufferSubData(entry->slice->page->buffer, (GLintptr)pool_offset(entry->slice),
                         (GLsizeiptr)(entry->ready * sizeof(*entry->shown)), entry->shown);
    if (entry->pixels.count > 0 && !entry->sensors)
        entry->sensors = reference_pixel_sensors(fields->log, &entry->pixels);
    if (entry->pixels.count > 0 && !entry->sensors)
        return false;
    return entry->uploaded = true;
}

/* Reads the current directions of the sensors' arrows. Sensors on trial positions have no arrow, because their direction is unknown. */
static void take_directions(struct fields *fields, struct fields_entry *entry, const struct fields_ask *ask)
{
    const struct scene *scene = field_scene(fields->field);
    if (ask->params->show != SHOW_VALUE || ask->params->trial || !scene->plant->groups[ask->params->group].directed)
        return;
    mem_free(entry->directions);
    entry->direction_count = directions_read(scene, entry->asset, ask->params->group, ask->snapshot, &entry->directions);
    /* the hash includes the field parameters, because the directions of arrows depend on them, too */
    entry->directions_content = XXH3_64bits(&entry->params, sizeof(entry->params));
    for (size_t i = 0; i < entry->direction_count; i++) {
        const struct sensor_direction *d = &entry->directions[i];
        const float said[6] = { d->vector[0], d->vector[1], d->vector[2], d->configured, d->known, d->uncertain };
        entry->directions_content = XXH3_64bits_withSeed(said, sizeof(said), entry->directions_content);
    }
}

size_t fields_vertices(const struct fields *fields, int asset, const struct field_params *params, size_t count)
{
    return fields->reference ? count : field_vertices(fields->field, asset, params, count);
}

/* Deletes the GPU's copy of the entry's sensors, because they or their readings have changed. */
static void forget_sensors(struct fields *fields, struct fields_entry *entry)
{
    size_t bytes = entry->cells ? entry->cells->bytes : 0;
    glDeleteBuffers(1, &entry->sensors);
    entry->sensors = 0;
    sensor_cells_expire(&entry->cells);
    fields->bytes -= entry->cells ? 0 : bytes;
}

/* Finds or creates the cache entry of one asset. Sets entry->behind if its values are out of date. NULL: the asset shows no field. */
static struct fields_entry *look(struct fields *fields, const struct fields_ask *ask, int asset, size_t all)
{
    struct field_params room;
    const struct field_params *params = field_params_of(fields->field, asset, ask->params, &room);
    size_t count = fields_vertices(fields, asset, params, all);
    const struct scalars *scalars = field_scalars_of(fields->field, asset, params, ask->snapshot, count);
    if (!scalars && !field_covers(fields->field, asset, params))
        return NULL;
    if (!scalars) {
        log_err(fields->log, "asset number %d of the plant (counted from 0) is shown without data: out of memory", asset);
        return &fields->lost;
    }
    struct fields_entry *entry = entry_find(fields, asset, params, ask->step);
    bool fresh = !entry;
    if (fresh)
        entry = entry_create(fields, asset, params, ask->step, scalars->count);
    if (!entry)
        return &fields->lost;
    struct pixel_field pixels;
    field_pixels(fields->field, asset, params, &pixels);
    /* interpolation needs the values of all vertices: renderers do not evaluate this field at pixels, because at most one
       sensor is usable */
    if (pixels.count == 0 && count < all) {
        count = all;
        scalars = field_scalars_of(fields->field, asset, params, ask->snapshot, count);
        if (!scalars)
            return &fields->lost;
    }
    if (fresh || entry->ready < count || can_be_seen(entry, scalars, &pixels)) {
        entry->behind = scalars;
        pixel_field_finish(&entry->pixels);
        entry->pixels = pixels;
        pixels.sensors = NULL;
        if (entry->sensors)
            forget_sensors(fields, entry);
    }
    pixel_field_finish(&pixels);
    take_directions(fields, entry, ask);
    entry->wanted = count;
    entry->oldest_age_ns = scalars->oldest_age_ns;
    entry->drawn_error = scalars->drawn_error;
    entry->used = ++fields->uses;
    return entry;
}

/* Takes slices (ranges of a GPU buffer) for all entries that have none yet. First announces all these entries to the pool of slices, so
   that their slices lie next to each other. */
static void make_room(struct fields *fields, const struct fields_ask *ask, const struct fields_entry **entries)
{
    size_t texels = 0, slices = 0;
    for (size_t i = 0; i < ask->asset_count; i++) {
        const struct fields_entry *entry = entries[ask->assets[i]];
        bool without = entry && entry != &fields->lost && !entry->slice;
        texels += without ? entry->count : 0;
        slices += without;
    }
    pool_expect(fields->pool, texels, slices);
    for (size_t i = 0; i < ask->asset_count && slices > 0; i++) {
        struct fields_entry *entry = (struct fields_entry *)entries[ask->assets[i]];
        if (entry && entry != &fields->lost && !take_slice(fields, entry))
            entries[ask->assets[i]] = &fields->lost;
    }
}

struct fields_shown {
    struct fields_entry **entries;
};

static void show_some(void *arg, size_t begin, size_t end)
{
    const struct fields_shown *showing = arg;
    for (size_t i = begin; i < end; i++)
        show(showing->entries[i]);
}

/* Uploads the entry's sensors for shaders that compute the field at each fragment. Does nothing for kinds of interpolation and distance
   that the shaders do not implement. */
static void take_sensors(const struct fields *fields, struct fields_entry *entry)
{
    if (fields->reference && !entry->sensors && !interpolation_is_prepared(entry->params.interpolation) &&
        !field_params_cover(&entry->params) && entry->params.distance != DISTANCE_HEAT)
        entry->sensors = reference_sensors(fields->reference, entry->asset, &entry->params);
}

/* Looks up all entries of one parameter set before it updates their pixels. So no entry of the set evicts another, however
   small the cache is. A trial may use a parameter set per asset, so its entries are updated one by one. */
void fields_get(struct fields *fields, const struct fields_ask *ask, const struct fields_entry **entries)
{
    struct fields_entry **changed = mem_array(ask->asset_count, sizeof(*changed));
    struct fields_shown showing = { changed };
    size_t count = 0, *counts = mem_array(ask->asset_count, sizeof(*counts));
    for (size_t i = 0; i < ask->asset_count; i++)
        counts[i] = fields_vertices(fields, ask->assets[i], ask->params, ask->counts[i]);
    field_update_all(fields->field, ask->assets, counts, ask->asset_count, ask->params, ask->snapshot);
    mem_free(counts);
    for (size_t i = 0; i < ask->asset_count; i++) {
        struct fields_entry *entry = look(fields, ask, ask->assets[i], ask->counts[i]);
        entries[ask->assets[i]] = entry;
        if (!entry || entry == &fields->lost || (!entry->behind && entry->hashed == entry->wanted))
            continue;
        if (!ask->params->trial) {
            changed[count++] = entry;
            continue;
        }
        show(entry);
        if (take_slice(fields, entry))
            take_sensors(fields, entry);
        else
            entries[ask->assets[i]] = &fields->lost;
    }
    workers_for(field_workers(fields->field), count, 1, show_some, &showing);
    mem_free(changed);
    make_room(fields, ask, entries);
    for (size_t i = 0; i < ask->asset_count; i++)
        if (entries[ask->assets[i]] && entries[ask->assets[i]] != &fields->lost)
            take_sensors(fields, (struct fields_entry *)entries[ask->assets[i]]);
}

bool fields_upload(struct fields *fields, const int *assets, size_t count, const struct fields_entry **entries)
{
    bool good = true;
    for (size_t i = 0; i < count; i++) {
        struct fields_entry *entry = (struct fields_entry *)entries[assets[i]];
        if (!entry || entry == &fields->lost || entry->uploaded || upload(fields, entry))
            continue;
        entries[assets[i]] = &fields->lost;
        good = false;
    }
    return good;
}

/* Keeps entries that the last frame used, even beyond the memory limit: the next frame mostly shows the same fields. */
void fields_trim(struct fields *fields)
{
    while (fields->bytes > fields->bound_bytes && fields->count > 0) {
        size_t oldest = 0;
        for (size_t i = 1; i < fields->count; i++)
            if (fields->entries[i]->used < fields->entries[oldest]->used)
                oldest = i;
        if (fields->entries[oldest]->used > fields->trimmed)
            break;
        entry_destroy(fields, fields->entries[oldest]);
        fields->entries[oldest] = fields->entries[--fields->count];
    }
    fields->trimmed = fields->uses;
}
