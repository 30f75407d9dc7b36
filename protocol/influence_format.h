/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The influence of an asset's sensors, in the file KEY.influence next to the asset file. Layout: ASSET.md. Little-endian; no I/O here. */
#ifndef PROTOCOL_INFLUENCE_FORMAT_H
#define PROTOCOL_INFLUENCE_FORMAT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define INFLUENCE_MAGIC "PLCINFL3" /* includes the format's version */

struct influence_header {
    uint32_t entry_count, vertex_count;
};
/* Pseudo-interpolation: the entry's `shares` are distances by the heat method on a point cloud, in metres, INFINITY where there is no path;
 * the precision matrix is 0. */
#define INFLUENCE_HEAT 1000
/* Pseudo-interpolation: the entry's `shares` are angles of a tangent vector transported from the sensor to each vertex, in radians, from
 * the first to the second axis of vec_frame() of its normal; INFINITY where there is no path; the precision matrix is 0. Only differences
 * between two vertices have a meaning. */
#define INFLUENCE_TRANSPORT 1001
/* Entry of one group and one interpolation. Offsets of arrays are in bytes from the header and multiples of 8. */
struct influence_entry {
    uint32_t group, interpolation; /* group: index in the plant file; interpolation: enum interpolation, or a pseudo-interpolation above */
    uint32_t sensor_count;         /* count of the group's sensors with a known position; arrays have them in the order of the asset file */
    uint32_t zero;
    uint64_t precision, shares; /* offsets of double[sensor][sensor] and float[sensor][vertex] */
    uint64_t deviations;        /* gp: offset of float[2][vertex], standard errors with all sensors and without any; others: 0 */
    /* offset of float[vertex]: largest error in the triangles at the vertex, relative to the spread of readings; offset 0: unknown */
    uint64_t errors;
    double disc_m, decay_m;           /* disc_m: radius of a sensor's disc, metres; decay_m: fin: decay length, metres; others: 0 */
    double range_m, noise, deviation; /* gp: parameters, stated in the plant file or fitted; others: 0 */
};

/* A checked file in memory. The bytes must outlive the view. */
struct influence_view {
    const struct influence_header *header;
    const struct influence_entry *entries;
};
/* Checks the bytes (lengths, offsets, counts, finiteness) and makes a view of the file. vertex_count: vertex count of the asset file.
 * Returns false if the bytes are invalid, with the reason in `why`. */
bool influence_view_init(struct influence_view *view, const void *bytes, size_t size, uint32_t vertex_count, char why[200]);
/* Returns the entry of a group and an interpolation. NULL: there is none. Owned by the view. */
const struct influence_entry *influence_find(const struct influence_view *view, uint32_t group, uint32_t interpolation);
/* Returns an array of an entry: converts its offset to a pointer. */
const void *influence_array(const struct influence_view *view, uint64_t offset);

#endif
