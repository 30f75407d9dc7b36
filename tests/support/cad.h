/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes like those of CAD exporters for tests: clean ones with random triangles, and copies with faults that exports have. */
#ifndef TESTS_CAD_H
#define TESTS_CAD_H
#include <stddef.h>
#include <stdint.h>

struct cad {
    float (*positions)[3];
    uint32_t *triangles; /* indices of the vertices, three per triangle */
    size_t vertex_count, triangle_count, position_capacity, index_capacity;
};

struct cad_random {
    uint64_t state;
};
/* takes the seed from the environment variable PLANTCAST_SEED, or else from the clock, and prints it, so that a failure can be
   repeated */
void cad_random_start(struct cad_random *random);
double cad_random(struct cad_random *random);     /* returns a random number from 0 (included) to 1 (excluded) */

void cad_finish(struct cad *cad);
struct cad *test_cad(void); /* returns an empty shape, which is freed automatically after the test (tests/support/owned.h) */

/* Adds a plate divided into across x up cells, each of two triangles with a random diagonal. Inner vertices are moved randomly
   by up to jitter / 2 times the size of a cell. */
void cad_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, double jitter);
/* Adds a plate like cad_plate() without jitter and with a slot: the cells in columns first..first + wide - 1 and rows 0..high -
   1 are missing. */
void cad_slotted_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, int first, int wide,
                       int high);
/* Adds a sphere of radius 1 that is made from a cube with cells x cells squares per side, so it has 6 * cells^2 + 2 vertices.
   */
void cad_sphere(struct cad *cad, struct cad_random *random, int cells);
/* Adds a cylinder surface of radius 1 with open ends, with `around` cells around the axis and `along` cells along it. */
void cad_cylinder(struct cad *cad, struct cad_random *random, int around, int along, double length, double jitter);
/* Adds a torus whose tube's centre line has radius 1; around, tube: number of cells around the torus and around the tube. */
void cad_torus(struct cad *cad, struct cad_random *random, int around, int tube, double tube_radius, double jitter);
/* Adds a pipe with open ends and two bends of 135 degrees in opposite directions, whose centre line has a bend radius of 1. */
void cad_bent_pipe(struct cad *cad, struct cad_random *random, int along, int around, double pipe_radius, double jitter);
/* Adds a box without a lid whose outer size is x, y and z cells; its walls and bottom are one cell thick. */
void cad_thin_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell);
/* Adds a closed box of x * y * z cells whose lowest corner is at the origin. */
void cad_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell);
/* Adds a closed tube along a horizontal figure eight that is 2 wide; the tube intersects itself at the crossing. half: 1 or 2:
   only the branch that rises or falls from the left end to the right end, with closed ends; 0: the whole eight. */
void cad_eight(struct cad *cad, struct cad_random *random, int along, int around, double tube_radius, int half);
/* Adds a cylinder with closed ends. Its axis goes through `centre` and is rotated by turn_rad from z towards x. */
void cad_closed_pipe(struct cad *cad, struct cad_random *random, double radius, double length, int around, int along, int rings,
                     double turn_rad, const double centre[3]);

void cad_append(struct cad *cad, const struct cad *other, const double move[3]); /* appends a moved copy */

enum cad_fault { CAD_CLEAN, CAD_SOUP, CAD_GAPS, CAD_REPEATED, CAD_HANGING, CAD_FINS, CAD_FAULTS };
extern const char *const cad_fault_names[CAD_FAULTS];
/* Copies a clean shape with one kind of fault. vertex_of[vertex of the clean shape] receives a vertex of the copy at the same
   position (GAPS: near it). SOUP: no two triangles share a vertex. GAPS: the shape is cut into 14 patches that are moved apart
   by up to 1e-4 of its size. REPEATED: a third of the triangles are reversed, and a third are present twice, partly reversed.
   HANGING: about every seventh triangle has an additional vertex on one edge. FINS: on an edge of every twentieth triangle
   stands a further triangle. */
void cad_break(struct cad *broken, const struct cad *clean, enum cad_fault fault, struct cad_random *random, uint32_t *vertex_of);

/* A random rotation, scale and translation for cad_put(). Use the same struct to move several shapes together. */
struct cad_place {
    double rotation[9], scale, move[3];
};
void cad_random_place(struct cad_place *place, struct cad_random *random);
void cad_put(struct cad *cad, const struct cad_place *place);
void cad_put_point(const struct cad_place *place, const double p[3], double out[3]);

#endif
