/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes like those of CAD exporters: clean ones with random tessellation, and copies with the faults of exports. */
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
void cad_random_start(struct cad_random *random); /* seeds from PLANTCAST_SEED, or else from the clock; prints the seed */
double cad_random(struct cad_random *random);     /* returns a number in 0 <= x < 1 */

void cad_finish(struct cad *cad);

/* Adds a plate of across x up cells with a random diagonal in each cell; inner vertices are moved by up to half of `jitter` cells. */
void cad_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, double jitter);
/* Adds a plate like cad_plate(), without jitter and without these cells: columns first..first + wide - 1, rows below `high`. */
void cad_slotted_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, int first, int wide,
                       int high);
/* A sphere of radius 1 with 6 * cells^2 + 2 vertices. */
void cad_sphere(struct cad *cad, struct cad_random *random, int cells);
/* A cylinder of radius 1 with open ends. */
void cad_cylinder(struct cad *cad, struct cad_random *random, int around, int along, double length, double jitter);
/* A torus of radius 1 along the middle of its tube. */
void cad_torus(struct cad *cad, struct cad_random *random, int around, int tube, double tube_radius, double jitter);
/* An open pipe with two bends of 135 degrees and radius 1, in opposite directions. */
void cad_bent_pipe(struct cad *cad, struct cad_random *random, int along, int around, double pipe_radius, double jitter);
/* A box without a lid, x * y * z cells large; its walls and bottom are one cell thick. */
void cad_thin_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell);
/* A closed box of x * y * z cells; its lowest corner is at the origin. */
void cad_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell);
/* A closed tube along a horizontal figure eight that is 2 wide, so that it intersects itself. half: only its rising (1) or
   falling (2) branch from the left end to the right end, closed there; 0: all of it. */
void cad_eight(struct cad *cad, struct cad_random *random, int along, int around, double tube_radius, int half);
/* A closed cylinder about an axis through `centre`, rotated from z towards x. */
void cad_closed_pipe(struct cad *cad, struct cad_random *random, double radius, double length, int around, int along, int rings,
                     double turn_rad, const double centre[3]);

void cad_append(struct cad *cad, const struct cad *other, const double move[3]); /* appends a moved copy */

enum cad_fault { CAD_CLEAN, CAD_SOUP, CAD_GAPS, CAD_REPEATED, CAD_HANGING, CAD_FINS, CAD_FAULTS };
extern const char *const cad_fault_names[CAD_FAULTS];
/* Copies the clean shape and adds the fault. vertex_of[clean vertex]: a vertex of the copy at the same position (or within the
   gap). SOUP: no two triangles share a vertex. GAPS: cut into 14 patches, pulled apart by up to 1e-4 of the size. REPEATED: a
   third of the triangles are reversed, and a third duplicated, reversed or not. HANGING: about every seventh triangle has an
   edge split in two. FINS: every twentieth triangle has another triangle standing on one of its edges. */
void cad_break(struct cad *broken, const struct cad *clean, enum cad_fault fault, struct cad_random *random, uint32_t *vertex_of);

/* A random rotation, scale and translation. Reusing the struct gives several shapes the same motion. */
struct cad_place {
    double rotation[9], scale, move[3];
};
void cad_random_place(struct cad_place *place, struct cad_random *random);
void cad_put(struct cad *cad, const struct cad_place *place);
void cad_put_point(const struct cad_place *place, const double p[3], double out[3]);

#endif
