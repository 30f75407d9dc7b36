/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geodesic distances on CAD surfaces as they are in practice. Layer: after base and plant; used by plantcast-prep, and by the daemon when a
   sensor moves. The paper (Kim & Suh 2025, section 3.3) discards the mesh: samples and vertices become a point cloud, kNN connects them,
   and the heat method runs on that graph. On clean CAD this loses the mesh's connectivity (neighbours reach through thin walls and across
   narrow slots); on broken CAD it still works. This folder does the following instead:
   1. The mesh's connectivity is kept: vertices at one position are welded, repeated faces dropped (trimesh.h). Points at short sides of
   needle-shaped triangles are merged (short_sides.h).
   2. Defects are bridged: borders are joined within one tolerance, and so are parts that touch or cross each other or themselves. Pairs of
   border points to join come from a kNN search in the point cloud (point_cloud.h, repair.h). Triangles inside another closed part, or
   between two parts that touch face to face, are hidden (parts.h, interior.h).
   3. The surface is sampled evenly: edges are split until none is longer than the spacing (trimesh.h).
   4. The heat method (Crane, Weischedel, Wardetzky 2013) runs with the cotangent Laplacian of the intrinsic Delaunay triangulation, which
   has no negative weights inside a patch (intrinsic.h, heat.h). Diffusion time: 3 times the mean edge squared, more where the surface is so
   long that the heat would underflow. The gradient is taken of the logarithm of heat, which is nearly linear within a triangle, unlike
   heat.
   5. The heat method errs by 0.05 to 0.4 % on average and up to 4 % at borders and ridges. So the distances returned come from propagation
   over the same triangulation (propagation.h), with errors of 0.01 to 0.12 % on average. surface_check() compares some distances with the
   heat method, which has only the mesh in common with propagation; the report states differences of more than a few percent. Distances are
   stored at the model's own vertices. */
#ifndef SURFACE_SURFACE_H
#define SURFACE_SURFACE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/workers.h"

struct surface;

struct surface_params { /* all zero: the program chooses the values from the model */
    /* largest gap between faces, in metres, that repair closes; if the program chooses the limit, it is smaller at thin parts
       (parts.h) */
    double tolerance_m;
    double spacing_m;   /* length in metres above which sampling splits an edge of the surface */
    char *why;          /* buffer of SURFACE_WHY_BYTES for the reason if no surface can be built; NULL: the reason is logged instead */
};
#define SURFACE_WHY_BYTES 160

struct surface_report {
    double size_m; /* size of the model: length in metres of the diagonal of its main part (base/math/gap_split.h) */
    double tolerance_m, spacing_m, time_m2; /* tolerance and spacing that were used; time_m2: diffusion time t of the heat method */
    size_t triangles, welded_vertices, degenerate_triangles, repeated_triangles;
    /* number of edges with only one face, before and after repair bridged the gaps between the model's faces */
    size_t border_edges, border_edges_after;
    /* number of connected components of the surface, before and after repair bridged the gaps between the model's faces */
    size_t components, components_after;
    /* number of points that repair joined to another point of the surface, to close a crack or a contact between parts */
    size_t bridges;
    double longest_bridge_m;
    /* largest number of neighbours per point that the search for gaps requested (point_cloud.h); 0: no search was needed */
    int k;
    size_t samples;         /* points added */
    size_t hidden_vertices; /* number of model vertices inside another closed part, or covered by one */
    /* root mean square difference between the distances and those of the heat method, relative to the largest distance. It is
       that of the checked source with the largest difference. heat_disagreement and time_m2 are NaN until surface_check() */
    double heat_disagreement;
    double weld_s, bridge_s, sample_s, laplacian_s, factor_s, check_s;
};

/* Builds a surface from a model's triangles (positions in metres, 3 indices per triangle; all copied): welds, repairs, samples.
   workers may be NULL, else they must outlive the surface. Returns NULL if no triangle has an area or memory runs out; the
   reason is logged, or stored in params->why if that is set. One call at a time per surface; surfaces are
   independent. */
struct surface *surface_create(struct log *log, struct workers *workers, const float (*positions_m)[3], size_t vertex_count,
                               const uint32_t *triangles, size_t triangle_count, const struct surface_params *params);
/* Frees the surface and sets *surface to NULL. *surface may be NULL. */
void surface_destroy(struct surface **surface);
/* Returns the report: counts and durations of the steps. Owned by the surface. */
const struct surface_report *surface_report(const struct surface *surface);

struct crack_bridge;
/* The mesh used to compute distances, for debug views. The surface owns the arrays. */
struct surface_debug_mesh {
    const double (*points_m)[3];
    const uint32_t (*tris)[3]; /* visible triangles first */
    size_t point_count, tri_count, visible_count;
    const uint32_t *vertex_point; /* by model vertex: index of its point in the mesh; all other points are samples */
    size_t vertex_count;
    const struct crack_bridge *bridges; /* repair.h */
    size_t bridge_count;
};
/* Fills *look with the mesh used to compute distances. The surface owns its arrays. */
void surface_debug_mesh(const struct surface *surface, struct surface_debug_mesh *look);

/* result of projecting a point onto the surface */
struct surface_place {
    double position_m[3]; /* nearest point on the surface */
    double distance_m;    /* from the requested point */
    uint32_t vertex;      /* index of the model's vertex that has the smallest straight-line distance from position_m */
};
/* Projects a point onto the surface. The result includes the model vertex nearest to the projection. */
void surface_nearest(const struct surface *surface, const double point_m[3], struct surface_place *place);

/* point on the surface, given by a triangle and its barycentric weights there */
struct surface_point {
    uint32_t tri; /* of the sampled surface */
    /* weights: barycentric, of the triangle's corners; distance_m: distance from the point that was projected */
    double weights[3], point_m[3], distance_m;
};
/* Finds the surface point nearest to point_m. Among triangles about equally near, prefers one whose normal is close to
 * `normal`, so that the far side of a thin wall is not taken (NULL: no preference). */
void surface_find_point(const struct surface *surface, const double point_m[3], const double normal[3], struct surface_point *hit);
/* Finds the surface point nearest to point_m within limit_m, like surface_find_point(). Returns false if no point is that near. */
bool surface_find_point_within(const struct surface *surface, const double point_m[3], const double normal[3], double limit_m,
                               struct surface_point *hit);
/* Finds the nearest visible surface point within limit_m on one of two model triangles (which may be the same), or on a
   coplanar one merged with them. Returns false if there is none. */
bool surface_find_point_on(const struct surface *surface, const double point_m[3], double limit_m, const uint32_t triangles[2],
                           struct surface_point *hit);
/* Finds the nearest visible surface point within limit_m that is on a model triangle for which allowed(arg, triangle) returns true. Returns
   false if there is none. */
bool surface_find_point_among(const struct surface *surface, const double point_m[3], double limit_m,
                              bool (*allowed)(const void *arg, uint32_t triangle), const void *arg, struct surface_point *hit);

/* Finds the point of triangle `tri` of the sampled surface nearest to point_m. If an earlier search found this triangle, the
   result equals that of the search. Returns false if there is no such triangle, or the point is farther than limit_m. */
bool surface_point_on(const struct surface *surface, const double point_m[3], double limit_m, uint32_t tri, struct surface_point *hit);

/* Computes the geodesic distance in metres from each point (projected onto the surface) to every model vertex: out[point *
 * vertex_count + vertex]. It is INFINITY where the surface does not connect them. Runs on all workers. Logs and returns false
 * when out of memory. Any number of threads may call at the same time, of this and all functions below, unless their comment
 * says otherwise. */
bool surface_distances(const struct surface *surface, const double (*points_m)[3], size_t point_count, float *out);

/* Distances of every point of the sampled surface from a set of sources. Distances of other surface points are interpolated from these. */
struct surface_field {
    size_t source_count;
    struct surface_point *sources;
    uint32_t *source_tris; /* triangles of the sources, contiguous */
    float *distances_m;    /* [point of the sampled surface][source] */
};
/* Access to a cache of distances: a column holds the distances of all points of the sampled surface from one source. Both callbacks run on
   any thread. */
struct surface_columns {
    bool (*fetch)(void *arg, size_t source, float *distances_m); /* false: not cached */
    /* stores a newly computed column (distances from one source), after rounding it in place to the values that fetch() will return */
    void (*keep)(void *arg, size_t source, float *distances_m);
    void *arg;
};
/* Returns the number of points of the sampled surface, which is the length of a column (distances from one source). */
size_t surface_column_length(const struct surface *surface);
/* Computes the field of these sources. Columns (distances from one source) that the cache contains are fetched; computed
 * columns are stored in the cache (columns NULL: no cache). Returns false when out of memory (logged); nothing needs freeing
 * then. */
bool surface_field_init(struct surface_field *field, const struct surface *surface, const double (*points_m)[3], size_t point_count,
                        const struct surface_columns *columns);
/* Frees the field. */
void surface_field_finish(struct surface_field *field);
/* Writes the distance of a model vertex from every source: out[source]. */
void surface_field_at_vertex(const struct surface_field *field, const struct surface *surface, uint32_t vertex, float *out);
/* Writes the distance of a surface point from every source: out[source]. */
void surface_field_at_point(const struct surface_field *field, const struct surface *surface, const struct surface_point *hit, float *out);

/* Compares the field with the heat method for some of its sources, and fills heat_disagreement, time_m2 and factor_s of the
 * report. Logs and returns false when out of memory. One call at a time; other functions may run
 * concurrently, except those that read the report. */
bool surface_check(struct surface *surface, const struct surface_field *field);

#endif
