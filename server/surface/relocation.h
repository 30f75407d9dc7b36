/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Live sensor relocation: distances of a sensor that is added to a loaded asset, or moved on it, while the plant is shown. Straight-line
   distances are computed at once, geodesic ones in the background. */
#ifndef SURFACE_RELOCATION_H
#define SURFACE_RELOCATION_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/workers.h"

struct relocation;

/* An asset's finest level. What it points to must outlive the relocation object. */
struct relocation_shape {
    const float (*positions_m)[3];
    const float (*normals)[3]; /* by which vertices that only coarser levels have are told which side they are on; NULL: they are not */
    size_t vertex_count;
    const uint32_t *triangles; /* 3 each */
    size_t triangle_count;
    double tolerance_m; /* as the plant file has it, so that the same hangs together; 0: chosen from the model */
    /* The surface that plantcast-prep kept of the asset (surface_store.h). With it, distances are those that it would store (but for few
       vertices where faces of two parts lie in each other), and it is warm sooner. Else one is made from the triangles: where parts lie
       within the tolerance of each other, these have more vertices than the model's, and so more bridges. Distances then differ by 0.03 %
       of the largest on average, and by some percent at single points. */
    const char *surface_path; /* NULL: none; need only live for relocation_create */
    uint64_t surface_key;
};
/* Starts building the asset's surface on a worker (seconds for a large asset, and some hundred bytes per triangle); requests wait until it
   is built. Never NULL. Thread: create and destroy from one thread, all other functions from any. */
struct relocation *relocation_create(struct log *log, struct workers *workers, const struct relocation_shape *shape);
/* Cancels waiting requests, waits for those under way, and frees everything. Must not be called from a `done` callback. &NULL is fine;
   leaves NULL. */
void relocation_destroy(struct relocation **relocation);

enum relocation_state {
    RELOCATION_WARMING,
    RELOCATION_WARM,
    RELOCATION_BROKEN
}; /* broken: no triangle has an area, or out of memory; logged */
/* Returns whether the surface is still being built, ready, or impossible to build. */
enum relocation_state relocation_state(struct relocation *relocation);

/* Where a sensor would be. */
struct relocation_place {
    double surface_m[3]; /* on the asset, nearest to the point asked for: once warm, on what is not hidden inside another part */
    double distance_m;   /* from that point */
    uint32_t vertex;     /* near it: the nearest one, once warm */
};

enum relocation_status {
    RELOCATION_DONE,
    RELOCATION_CANCELLED,
    RELOCATION_NO_SURFACE, /* the state is broken */
    RELOCATION_NO_MEMORY,
};
struct relocation_result {
    enum relocation_status status;
    uint64_t ticket;
    struct relocation_place place;
    float *geodesic_m; /* RELOCATION_DONE: of each vertex, INFINITY where no way leads; the receiver's, mem_free. Else NULL */
};

/* Projects a point onto the asset into *place and, unless euclidean_m is NULL, writes the straight-line distance of each vertex from there.
   Returns at once; false if the point is not finite, farther from the asset than the asset is large, or the asset has no triangle. */
bool relocation_place(struct relocation *relocation, const double point_m[3], struct relocation_place *place, float *euclidean_m);

/* Requests the geodesic distances of every vertex from a point. done(arg, result) is called exactly once, on a worker, or with
   RELOCATION_CANCELLED by relocation_cancel() or relocation_destroy() on their caller's thread; never under a lock. Returns the request's
   ticket, or 0 if relocation_place() refuses the point: then done is not called. */
uint64_t relocation_request(struct relocation *relocation, const double point_m[3],
                            void (*done)(void *arg, struct relocation_result *result), void *arg);
/* Cancels the request of this ticket: at once if it waits, as soon as its computation ends if it is under way. A finished ticket is fine. A
   sensor that is dragged cancels its last request before the next one. */
void relocation_cancel(struct relocation *relocation, uint64_t ticket);

#endif
