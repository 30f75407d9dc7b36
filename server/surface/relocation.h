/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances of a sensor that is added to a loaded asset, or moved on it, while the plant is shown. Straight ones come at once; those along
   the surface when they are ready. */
#ifndef SURFACE_RELOCATION_H
#define SURFACE_RELOCATION_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/workers.h"

struct relocation;

struct relocation_shape { /* an asset's finest level; what it points to must outlive the mover */
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
/* Never NULL. The surface is made in the background, on a worker: seconds for a large asset, and some hundred bytes a triangle. Until
   then what is asked for waits. Thread: create and destroy from one thread; all else from any. */
struct relocation *relocation_create(struct log *log, struct workers *workers, const struct relocation_shape *shape);
/* Cancels what waits, and returns when all of it is done with. &NULL is fine; leaves NULL. Not from a `done`. */
void relocation_destroy(struct relocation **relocation);

enum relocation_state {
    RELOCATION_WARMING,
    RELOCATION_WARM,
    RELOCATION_BROKEN
}; /* broken: no triangle has an area, or out of memory; logged */
enum relocation_state relocation_state(struct relocation *relocation);

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

/* Where the sensor would be, and the straight-line distance of each vertex from there (euclidean_m may be NULL): at once. False: the point
   is not finite, or farther from the asset than the asset is large, or there is no triangle. */
bool relocation_place(struct relocation *relocation, const double point_m[3], struct relocation_place *place, float *euclidean_m);

/* Distances along the surface. done(arg, result) is called exactly once, on a worker (or in relocation_destroy and relocation_cancel, by their
   caller, with RELOCATION_CANCELLED), never under a lock of the mover. The ticket, or 0: the point is refused by relocation_place, and done is not
   called. */
uint64_t relocation_request(struct relocation *relocation, const double point_m[3],
                            void (*done)(void *arg, struct relocation_result *result), void *arg);
/* What waits is cancelled at once, what is under way when it is through. Of a ticket that is done with: nothing. A sensor that is dragged
   cancels its last ticket before it asks again. */
void relocation_cancel(struct relocation *relocation, uint64_t ticket);

#endif
