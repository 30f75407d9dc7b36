/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Live sensor relocation: distances of a sensor that is added to a loaded asset, or moved on it, while the plant is running. Straight-line
   distances are computed at once, geodesic ones in the background. */
#ifndef SURFACE_RELOCATION_H
#define SURFACE_RELOCATION_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/workers.h"

struct relocation;

/* An asset's finest level. The arrays must outlive the relocation object. */
struct relocation_shape {
    const float (*positions_m)[3];
    /* vertex normals, which decide on which side of a wall vertices of coarser levels lie; NULL: the nearest face decides */
    const float (*normals)[3];
    size_t vertex_count;
    const uint32_t *triangles; /* three vertex indices each */
    size_t triangle_count;
    double tolerance_m; /* tolerance for gaps, as in the plant file, so that relocation bridges the same gaps; 0: chosen from the model */
    /* The surface that plantcast-prep stored for the asset (surface_store.h). With it, distances equal those that plantcast-prep would
     * store (except for a few vertices where coincident faces belong to two parts), and warm-up is faster. Without it the surface is built
     * from the triangles: where parts are within the tolerance of each other, the asset's triangles have more vertices than the model,
     * which causes more bridges. Distances then differ by 0.03 % of the largest on average, by a few percent at single points. */
    const char *surface_path; /* path of the stored surface; NULL: none. Only read during relocation_create() */
    uint64_t surface_key;
};
/* Starts to build the asset's surface on a worker (seconds for a large asset, and a few hundred bytes per triangle); requests wait until it
   is built. Never NULL. Thread: create and destroy from one thread, all other functions from any. */
struct relocation *relocation_create(struct log *log, struct workers *workers, const struct relocation_shape *shape);
/* Cancels waiting requests, waits for those under way, and frees everything. Must not be called from a `done` callback. &NULL is fine; sets
   it to NULL. */
void relocation_destroy(struct relocation **relocation);

enum relocation_state {
    RELOCATION_WARMING,
    RELOCATION_WARM,
    RELOCATION_BROKEN
}; /* RELOCATION_BROKEN: no triangle has an area, or out of memory; logged */
/* Returns the state of the surface: being built, ready, or impossible to build. */
enum relocation_state relocation_state(struct relocation *relocation);

/* Position of a sensor on the asset. */
struct relocation_place {
    double surface_m[3]; /* nearest point on the asset; once the surface is built, only on surfaces not hidden inside another part */
    double distance_m;   /* distance from the requested point to surface_m, metres */
    uint32_t vertex;     /* index of a vertex near surface_m; once the surface is built, the nearest vertex */
};

enum relocation_status {
    RELOCATION_DONE,
    RELOCATION_CANCELLED,
    RELOCATION_NO_SURFACE, /* the state is RELOCATION_BROKEN */
    RELOCATION_NO_MEMORY,
};
struct relocation_result {
    enum relocation_status status;
    uint64_t ticket;
    struct relocation_place place;
    /* geodesic distance of each vertex, INFINITY where no path exists; set with RELOCATION_DONE, else NULL. The receiver owns it
       (mem_free) */
    float *geodesic_m;
};

/* Projects a point onto the asset into *place and, unless euclidean_m is NULL, writes the straight-line distance from there to each vertex.
   Returns at once; false if the point is not finite, farther from the asset than the asset's size, or the asset has no triangle. */
bool relocation_place(struct relocation *relocation, const double point_m[3], struct relocation_place *place, float *euclidean_m);

/* Requests the geodesic distances of every vertex from a point. done(arg, result) is called exactly once, on a worker, or with
   RELOCATION_CANCELLED by relocation_cancel() or relocation_destroy() on their caller's thread; never under a lock. Returns the request's
   ticket, or 0 if relocation_place() refuses the point: then done is not called. */
uint64_t relocation_request(struct relocation *relocation, const double point_m[3],
                            void (*done)(void *arg, struct relocation_result *result), void *arg);
/* Cancels the request of this ticket: at once if it waits, or after its computation if it is being processed. Ignores a finished ticket.
 * While a sensor is dragged, each request is cancelled before the next. */
void relocation_cancel(struct relocation *relocation, uint64_t ticket);

#endif
