/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh that is cut until it shows a field, linear or quadratic over its triangles: for an experiment (field_degree.c). Thread: one. */
#ifndef TESTS_BENCH_CUT_MESH_H
#define TESTS_BENCH_CUT_MESH_H
#include "preprocess/subdivision/subdivide.h"
#include "surface/mesh/trimesh.h"

#define CUT_AIM (0.9 * SUBDIV_ERROR)
#define CUT_CHOICES 4
#define NO_VERTEX UINT32_MAX
#define NO_ORIGIN UINT32_MAX

struct truth {
    const struct surface *surface;
    const struct surface_field *field;
    struct linear_error linear;
    size_t sensors, numbers; /* numbers: of a sample */
    size_t evaluations;
    double limit_m; /* places farther from the surface are inside something */
};

struct vertex {
    double at[3];
    float *sample, *geodesic_m; /* NULL: hidden, or out of reach */
};

struct edge {
    uint32_t a, b, middle; /* middle: a vertex, made when the edge was measured */
    double linear, quadratic; /* how much the field errs along it, without and with its middle */
    double aim;            /* the share of its length at which a flat triangle's corner is beside it; 0: none is */
    bool measured, curved, barred, cut;
};

struct tri {
    uint32_t v[3], e[3]; /* e[i]: from v[i] to v[i + 1] */
    uint32_t origin;     /* the model's triangle that it is a piece of; NO_ORIGIN: a level's */
    bool gone, done;
};

struct cut_mesh {
    struct truth *truth;
    struct vertex *vertices;
    struct edge *edges;
    struct tri *tris;
    size_t vertex_count, vertex_capacity, edge_count, edge_capacity, tri_count, tri_capacity;
    struct edge_table table;
    bool quadratic;
    double limit, shortest_m, jump_m;
    double stage; /* errors above are mended for now: the worst first, as the mesh may only grow so far */
    size_t live;  /* triangles */
};

/* Where on the surface a place is: on its own triangle, or the nearest that faces that way. */
struct facing {
    double normal[3];
    uint32_t origin;
};

/* Adds a vertex and computes the field there. Returns its number. */
uint32_t cut_mesh_add_vertex(struct cut_mesh *mesh, const double at[3], const struct facing *facing);
/* Adds a triangle, and edges that are not there. */
void cut_mesh_add_tri(struct cut_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t origin);
/* Returns where a triangle's places are on the surface. */
struct facing cut_mesh_facing(const struct cut_mesh *mesh, const struct tri *tri);
/* Returns the error at a place within a triangle (barycentric weights), of one of a client's choices or, if it is CUT_CHOICES, the largest
   of all; less than 0 if nothing is known there. room: truth's numbers and sensors; `evaluated`: what is true there is in it already. */
double cut_mesh_error(struct cut_mesh *mesh, const struct tri *tri, const double w[3], float *room, int choice, bool evaluated);
/* Measures edges that are new, and cuts those that err by more than mesh->stage; once that is down to the limit, also those of triangles
   that err inside. Returns whether any was cut. */
bool cut_mesh_round(struct cut_mesh *mesh, float *room);
/* Frees the mesh. */
void cut_mesh_finish(struct cut_mesh *mesh);

#endif
