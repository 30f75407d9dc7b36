/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes as CAD exporters hand them out: clean ones, random in tessellation, and the faults that exports have. */
#ifndef TESTS_CAD_H
#define TESTS_CAD_H
#include <stddef.h>
#include <stdint.h>

struct cad {
    float (*positions)[3];
    uint32_t *triangles; /* 3 each */
    size_t vertex_count, triangle_count, position_capacity, index_capacity;
};

struct cad_random {
    uint64_t state;
};
void cad_random_start(struct cad_random *random); /* from PLANTCAST_SEED, or else the clock; says which */
double cad_random(struct cad_random *random);     /* 0 <= x < 1 */

void cad_finish(struct cad *cad);

/* Across x up vertices and a random diagonal in each cell; vertices inside are moved by up to half of `jitter` cells. */
void cad_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, double jitter);
/* The same with cells left out: columns first..first + wide - 1, rows below `high`; jitter 0. */
void cad_slotted_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, int first, int wide,
                       int high);
void cad_sphere(struct cad *cad, struct cad_random *random, int cells); /* radius 1; 6 * cells^2 + 2 vertices */
void cad_cylinder(struct cad *cad, struct cad_random *random, int around, int along, double length, double jitter);  /* radius 1, open */
void cad_torus(struct cad *cad, struct cad_random *random, int around, int tube, double tube_radius, double jitter); /* radius 1 */
/* Two bends of 135 degrees and radius 1, one way and the other; open. */
void cad_bent_pipe(struct cad *cad, struct cad_random *random, int along, int around, double pipe_radius, double jitter);
/* An open box of x * y * z cells outside, its walls and bottom one cell thick. */
void cad_thin_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell);
/* A closed box of x * y * z cells, its lowest corner at the origin. */
void cad_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell);
/* A closed tube along a lying eight that is 2 wide: it passes through itself. With half: only the ways from its left end to its right end
   that go up (1) or down (2), closed there. */
void cad_eight(struct cad *cad, struct cad_random *random, int along, int around, double tube_radius, int half);
/* A closed cylinder about an axis through `centre`, turned from z towards x. */
void cad_closed_pipe(struct cad *cad, struct cad_random *random, double radius, double length, int around, int along, int rings,
                     double turn_rad, const double centre[3]);

enum cad_fault { CAD_CLEAN, CAD_SOUP, CAD_GAPS, CAD_REPEATED, CAD_HANGING, CAD_FINS, CAD_FAULTS };
extern const char *const cad_fault_names[CAD_FAULTS];
/* A copy of the clean shape with the fault. vertex_of[clean vertex]: a vertex of the copy at its place (or within the gap).
   SOUP: no two triangles share a vertex. GAPS: cut into 14 patches, drawn back from each other by up to 1e-4 of the size.
   REPEATED: a third of the triangles turned, a third repeated, turned or not. HANGING: about every seventh triangle has a side cut in two.
   FINS: every twentieth triangle has one standing on a side of it. */
void cad_break(struct cad *broken, const struct cad *clean, enum cad_fault fault, struct cad_random *random, uint32_t *vertex_of);

/* Turned at random, scaled, moved. Both are the same motion when they are given the same place. */
struct cad_place {
    double rotation[9], scale, move[3];
};
void cad_random_place(struct cad_place *place, struct cad_random *random);
void cad_put(struct cad *cad, const struct cad_place *place);

#endif
