/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The influence file of an asset, KEY.influence next to the asset file: for each group and interpolation, the weight of each sensor at
   each vertex. Layout: ASSET.md. Little-endian; no I/O here. */
#ifndef PROTOCOL_INFLUENCE_FORMAT_H
#define PROTOCOL_INFLUENCE_FORMAT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define INFLUENCE_MAGIC "PLCINFL4" /* includes the format's version */

struct influence_header {
    uint32_t entry_count, vertex_count;
};
/* Value of influence_entry.interpolation for an entry without weights: its `shares` are distances by the heat method on a point
   cloud, in metres, INFINITY where there is no path. Its precision matrix is 0. */
#define INFLUENCE_HEAT 1000
/* Value of influence_entry.interpolation for an entry without weights: its `shares` are angles in radians, one for each sensor
   and vertex. The angle is the direction that results from carrying a fixed direction along the surface from the sensor to the
   vertex. It is measured from the first to the second axis that vec_frame() gives for the vertex's normal; INFINITY where there
   is no path. The precision matrix is 0. Only differences between two vertices have a meaning. */
#define INFLUENCE_TRANSPORT 1001
/* Entry of an influence file: the weights of the sensors of one group for one interpolation. Offsets of arrays are in bytes from the start
   of the file and multiples of 8. */
struct influence_entry {
    /* group: index of the group in the plant file; interpolation: enum interpolation, INFLUENCE_HEAT or INFLUENCE_TRANSPORT */
    uint32_t group, interpolation;
    /* number of the group's sensors with a known position; the arrays of this struct have them in the order of the asset file */
    uint32_t sensor_count;
    uint32_t columns_hash; /* influence_columns_hash() of these sensors */
    /* offsets of the arrays double[sensor][sensor] (precision) and float[sensor][vertex] (shares: the weights) */
    uint64_t precision, shares;
    /* for interpolation gp: offset of float[2][vertex], the standard deviations of the interpolated values, with all sensors and without
       any; other interpolations: 0 */
    uint64_t deviations;
    /* offset of float[vertex]: largest error in the triangles at the vertex, compared with the exact solution. Unit: difference
       between the largest and the smallest reading; 1 means unknown. Offset 0: the entry has no such array */
    uint64_t errors;
    /* disc_m: radius in metres of the disc on the surface that represents a sensor; decay_m: for interpolation fin, decay
       length in metres of the temperature along the metal; other interpolations: 0 */
    double disc_m, decay_m;
    /* for interpolation gp, from the plant file or fitted to readings: range_m: correlation length in metres; noise, deviation:
       standard deviations in the unit of the readings. Other interpolations: 0 */
    double range_m, noise, deviation;
};

/* A checked influence file in memory. The bytes must outlive the view. */
struct influence_view {
    const struct influence_header *header;
    const struct influence_entry *entries;
};
/* Checks the bytes of an influence file (lengths, offsets, counts, finiteness) and makes a view. vertex_count: number of vertices
 * of the asset file. Returns false if the bytes are invalid, with the reason in `why`. */
bool influence_view_init(struct influence_view *view, const void *bytes, size_t size, uint32_t vertex_count, char why[200]);
/* Returns the entry of a group and an interpolation, owned by the view. NULL: the file has none. */
const struct influence_entry *influence_find(const struct influence_view *view, uint32_t group, uint32_t interpolation);
/* Returns a hash of the indices that an entry's sensors have in the asset file. Other sensors have another hash, even if they are as
   many. */
uint32_t influence_columns_hash(const uint32_t *columns, size_t count);
/* Returns a pointer to an array of an entry; offset: the member of the entry that says where the array is. */
const void *influence_array(const struct influence_view *view, uint64_t offset);

#endif
