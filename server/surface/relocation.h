/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Live sensor relocation: distances of a sensor that is added to a loaded asset, or moved on it, while the plant is running. Straight-line
 * distances are computed immediately, geodesic ones in the background. */
#ifndef SURFACE_RELOCATION_H
#define SURFACE_RELOCATION_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/workers.h"

struct relocation;

/* triangles of an asset's finest level; the arrays must outlive the relocation object */
struct relocation_shape {
    const float (*positions_m)[3];
    /* vertex normals, which tell on which side of a thin wall the vertices of coarser levels of detail are; NULL: such vertices
       are assigned to the nearest face */
    const float (*normals)[3];
    size_t vertex_count;
    const uint32_t *triangles; /* three vertex indices each */
    size_t triangle_count;
    /* largest gap in metres that is bridged, as in the plant file, so that relocation bridges the same gaps as plantcast-prep;
       0: chosen from the model */
    double tolerance_m;
    /* The surface that plantcast-prep stored for the asset (surface_store.h). With this file, the surface is ready sooner.
     * Distances then equal those that plantcast-prep would store, except at a few vertices where coincident faces belong to two
     * parts. Without the file, the surface is built from the asset's triangles. These have more vertices than the model, so
     * parts within the tolerance of each other are bridged at more points. Distances then differ by 0.03 % of the largest
     * distance on average, by a few percent at single points. */
    const char *surface_path; /* path of the stored surface; NULL: none. Only read during relocation_create() */
    uint64_t surface_key;
};
/* Starts to build the asset's surface on a worker; requests wait until it is built. Takes seconds for a large asset, and a few
 * hundred bytes per triangle. Never returns NULL. Create and destroy from one thread, all other functions from any. */
struct relocation *relocation_create(struct log *log, struct workers *workers, const struct relocation_shape *shape);
/* Cancels waiting requests, waits for running ones, frees everything and sets *relocation to NULL. *relocation may be NULL. Must not be
 * called from a `done` callback. */
void relocation_destroy(struct relocation **relocation);

enum relocation_state {
    RELOCATION_WARMING,
    RELOCATION_WARM,
    RELOCATION_BROKEN
}; /* RELOCATION_BROKEN: the surface cannot be built, because no triangle has an area or memory ran out; the reason was logged */
/* Returns the state of the surface: being built, ready, or impossible to build. */
enum relocation_state relocation_state(struct relocation *relocation);

/* result of relocation_place(): the surface point nearest to the requested position */
struct relocation_place {
    double surface_m[3]; /* nearest point on the asset; once the surface is built, hidden surfaces inside other parts are excluded */
    double distance_m;   /* distance from the requested point to surface_m, metres */
    uint32_t vertex;     /* index of a vertex near surface_m: a corner of its triangle; once the surface is built, the nearest vertex */
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
    /* by vertex: geodesic distance in metres, INFINITY if no path leads there; NULL unless the outcome is RELOCATION_DONE. The receiver
       owns the array (mem_free) */
    float *geodesic_m;
};

/* Projects a point onto the asset into *place and, unless euclidean_m is NULL, writes the straight-line distance from the projection to
 * each vertex. Never waits for the surface. Returns false if the point is not finite, farther from the asset than the asset's size, or the
 * asset has no triangle. */
bool relocation_place(struct relocation *relocation, const double point_m[3], struct relocation_place *place, float *euclidean_m);

/* Requests the geodesic distances of every vertex from a point. done(arg, result) is called exactly once, never under a lock: on a worker,
 * or with RELOCATION_CANCELLED on the thread that calls relocation_cancel() or relocation_destroy(). Returns the request's ticket, or 0 if
 * relocation_place() refuses the point: then done is not called. */
uint64_t relocation_request(struct relocation *relocation, const double point_m[3],
                            void (*done)(void *arg, struct relocation_result *result), void *arg);
/* Cancels the request with this ticket: immediately if it is waiting, or after its computation if it is running. Ignores the
 * ticket of a finished request. While a sensor is dragged, the caller cancels each request before it makes the next one. */
void relocation_cancel(struct relocation *relocation, uint64_t ticket);

#endif
