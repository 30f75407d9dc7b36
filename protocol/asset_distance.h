/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geodesic distances of an asset file: codes of 16 bits (distance_code.h) in blocks of vertices, so that data used together is
   contiguous. Layout: [block][sensor][ASSET_DISTANCE_BLOCK]. Call from any thread. */
#ifndef PROTOCOL_ASSET_DISTANCE_H
#define PROTOCOL_ASSET_DISTANCE_H
#include "protocol/asset_format.h"
#include "protocol/distance_code.h"

/* Returns the coded distances from one sensor to a block of vertices. vertex: any vertex of the block. The view owns the codes. */
static inline const uint16_t *asset_distance_codes(const struct asset_view *view, size_t sensor, size_t vertex)
{
    size_t block = vertex / ASSET_DISTANCE_BLOCK;
    return view->geodesic + (block * view->header->sensor_count + sensor) * ASSET_DISTANCE_BLOCK;
}

/* Returns the distance of a vertex from a sensor in metres; INFINITY if there is no path. */
static inline float asset_distance_m(const struct asset_view *view, size_t sensor, size_t vertex)
{
    return asset_distance_of(asset_distance_codes(view, sensor, vertex)[vertex % ASSET_DISTANCE_BLOCK]);
}

#endif
