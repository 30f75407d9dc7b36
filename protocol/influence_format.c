/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the bytes of an influence file and makes a struct influence_view. */
#include "protocol/influence_format.h"

#include <math.h>
#include <stdio.h>
#include <xxhash.h>

static bool fits(uint64_t offset, uint64_t bytes, size_t size)
{
    return offset % 8 == 0 && offset <= size && bytes <= size - offset;
}

static bool entry_good(const struct influence_view *view, const struct influence_entry *entry, size_t size)
{
    const uint64_t sensors = entry->sensor_count, vertices = view->header->vertex_count;
    if (sensors == 0 || sensors > UINT16_MAX || !fits(entry->precision, 8 * sensors * sensors, size) ||
        !fits(entry->shares, 4 * sensors * vertices, size) || !isfinite(entry->disc_m) || !isfinite(entry->decay_m) ||
        !isfinite(entry->range_m) || !isfinite(entry->noise) || !isfinite(entry->deviation) ||
        (entry->deviations && !fits(entry->deviations, 8 * vertices, size)) || (entry->errors && !fits(entry->errors, 4 * vertices, size)))
        return false;
    const double *precision = influence_array(view, entry->precision);
    const float *shares = influence_array(view, entry->shares);
    /* open: values may be INFINITY. Distances by the heat method and transport angles may (no path to the vertex); weights must
       be finite */
    bool good = true, open = entry->interpolation >= INFLUENCE_HEAT;
    for (uint64_t i = 0; i < sensors * sensors; i++)
        good &= isfinite(precision[i]);
    for (uint64_t i = 0; i < sensors * vertices; i++)
        good &= isfinite(shares[i]) || (open && shares[i] > 0);
    const float *deviations = influence_array(view, entry->deviations);
    for (uint64_t i = 0; entry->deviations && i < 2 * vertices; i++)
        good &= isfinite(deviations[i]) && deviations[i] >= 0;
    const float *errors = influence_array(view, entry->errors);
    for (uint64_t i = 0; entry->errors && i < vertices; i++)
        good &= isfinite(errors[i]) && errors[i] >= 0;
    return good;
}

bool influence_view_init(struct influence_view *view, const void *bytes, size_t size, uint32_t vertex_count, char why[200])
{
    const struct influence_header *header = bytes;
    *view = (struct influence_view){ .header = header, .entries = (const struct influence_entry *)(header + 1) };
    if (size < sizeof(*header) || header->entry_count > (size - sizeof(*header)) / sizeof(*view->entries)) {
        snprintf(why, 200, "truncated to %zu bytes", size);
        return false;
    }
    if (header->vertex_count != vertex_count) {
        snprintf(why, 200, "the file of sensor weights was made for %u vertices, but the asset has %u", header->vertex_count, vertex_count);
        return false;
    }
    for (uint32_t i = 0; i < header->entry_count; i++)
        if (!entry_good(view, &view->entries[i], size)) {
            snprintf(why, 200,
                     "the file of sensor weights is damaged: entry %u of %u: the weights of %u sensors are outside the file or invalid", i,
                     header->entry_count, view->entries[i].sensor_count);
            return false;
        }
    return true;
}

const struct influence_entry *influence_find(const struct influence_view *view, uint32_t group, uint32_t interpolation)
{
    for (uint32_t i = 0; view->header && i < view->header->entry_count; i++)
        if (view->entries[i].group == group && view->entries[i].interpolation == interpolation)
            return &view->entries[i];
    return NULL;
}

uint32_t influence_columns_hash(const uint32_t *columns, size_t count)
{
    return XXH32(columns, count * sizeof(*columns), 0);
}

const void *influence_array(const struct influence_view *view, uint64_t offset)
{
    return (const char *)view->header + offset;
}
