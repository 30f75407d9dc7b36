/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The influence of an asset's sensors, beside its asset file: KEY.influence. Layout: ASSET.md. Little-endian; no I/O here. */
#ifndef PROTOCOL_INFLUENCE_FORMAT_H
#define PROTOCOL_INFLUENCE_FORMAT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define INFLUENCE_MAGIC "PLCINFL3" /* with the format's version */

struct influence_header {
    uint32_t entry_count, vertex_count;
};
/* In place of an interpolation: distances by the heat method on a point cloud, metres, INFINITY where no way leads; precision is 0. */
#define INFLUENCE_HEAT 1000
/* Likewise: angles of a tangent vector carried from the sensor to each vertex, radians, from the first to the second of vec_frame() of its
   normal; INFINITY where no way leads; precision is 0. Only differences between two vertices have a meaning. */
#define INFLUENCE_TRANSPORT 1001
/* One group's sensors by one interpolation. Arrays begin at these offsets from the header; multiples of 8. */
struct influence_entry {
    uint32_t group, interpolation; /* numbers in the plant file; enum interpolation */
    uint32_t sensor_count;         /* of the group whose place is known, in the order of the asset file's */
    uint32_t zero;
    uint64_t precision, shares;       /* double[sensor][sensor]; float[sensor][vertex] */
    uint64_t deviations;              /* gp: float[2][vertex], with sensors and without; else 0 */
    uint64_t errors;                  /* float[vertex]: how far triangles may be off, in parts of the spread of readings; 0: not known */
    double disc_m, decay_m;           /* what it was computed for: radius of a sensor's disc; fin: decay length, else 0 */
    double range_m, noise, deviation; /* gp: stated or fitted; else 0 */
};

/* A checked file in memory, whose bytes must outlive it. */
struct influence_view {
    const struct influence_header *header;
    const struct influence_entry *entries;
};
/* Checks the bytes (lengths, offsets, counts, finiteness) and makes a view of them. vertex_count: of the asset file. Returns false if they
   are invalid, with the reason in why. */
bool influence_view_init(struct influence_view *view, const void *bytes, size_t size, uint32_t vertex_count, char why[200]);
/* Returns the entry of a group and an interpolation, or NULL. Belongs to the view. */
const struct influence_entry *influence_find(const struct influence_view *view, uint32_t group, uint32_t interpolation);
/* Returns an array of an entry: its offset as a pointer. */
const void *influence_array(const struct influence_view *view, uint64_t offset);

#endif
