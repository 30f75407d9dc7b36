/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geodesic distances on CAD surfaces as they really are. Layer: after base and plant; used by plantcast-prep, and by the daemon
   when a sensor moves.

   The paper (Kim & Suh 2025, section 3.3) throws the mesh away: samples and vertices become a point cloud, kNN joins them, and the
   heat method runs on that graph. On clean CAD this loses what the mesh knows (neighbours reach through thin walls and across
   narrow slots); on broken CAD it is what still works. So here:
     1. what the mesh knows is kept: vertices at one place are welded, repeated faces dropped (trimesh.h);
     2. what is broken is bridged: open borders and parts that touch or cross, also themselves, are joined within one tolerance.
        Candidates on open borders come from the point cloud, by kNN (point_cloud.h, repair.h); what lies inside another closed part, or
        between two that touch face to face, leaves (parts.h, interior.h);
     3. the surface is sampled evenly: long edges are split until no edge is longer than the spacing (trimesh.h);
     4. the heat method (Crane, Weischedel, Wardetzky 2013) with the cotangent Laplacian of the intrinsic Delaunay triangulation, which
        has no negative weights inside a patch (intrinsic.h, heat.h). Diffusion time: 3 times the mean edge squared, more where the
        surface is so long that the heat would fall below the smallest number. The gradient is taken of the logarithm of heat: that
        is nearly linear in a triangle, heat itself is not;
     5. the heat method still errs by 0.05 to 0.4 % on average and up to 4 % at borders and ridges (measured on planes, spheres and
        cylinders of 30,000 points; with t = h^2 it is 0.7 % and 3 %). So the distances handed out are unfolded over the same
        triangulation, from the source outwards (propagation.h): 0.01 to 0.12 % on average. The heat method is what some of them are held
        against (surface_check): two methods that share nothing but the mesh. Where they differ by more than some percent the report
        says so.
   Distances are kept at the model's own vertices. */
#ifndef SURFACE_SURFACE_H
#define SURFACE_SURFACE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/workers.h"

struct surface;

struct surface_params { /* zero: chosen from the model */
    double tolerance_m; /* gaps up to this are closed; if it is chosen, at thin parts smaller ones (parts.h) */
    double spacing_m;   /* longest edge of the sampled surface */
    char *why;          /* NULL, or SURFACE_WHY_BYTES: takes what was wrong where there is no surface */
};
#define SURFACE_WHY_BYTES 160

struct surface_report {
    double size_m;                          /* diagonal of the main part (gap_split.h) */
    double tolerance_m, spacing_m, time_m2; /* as chosen; time_m2: the heat method's t */
    size_t triangles, welded_vertices, degenerate_triangles, repeated_triangles;
    size_t border_edges, border_edges_after; /* edges with one face, before and after bridging */
    size_t components, components_after;     /* pieces of surface that hang together, before and after bridging */
    size_t bridges;                          /* vertices joined to another place of the surface */
    double longest_bridge_m;
    int k;                    /* neighbours asked for; 0: nothing to bridge */
    size_t samples;           /* points added */
    size_t hidden_vertices;   /* of the model: inside another closed part, or covered by one */
    double heat_disagreement; /* root mean square difference to the heat method, as a share of the largest distance; worst source checked.
                                 NaN, as time_m2, until surface_check() */
    double weld_s, bridge_s, sample_s, laplacian_s, factor_s, check_s;
};

/* Builds a surface from a model's triangles (positions in metres, 3 indices per triangle; all copied): welds, repairs, samples. workers may
   be NULL, else they must outlive the surface. Returns NULL if no triangle has an area or memory runs out: logged, unless params->why takes
   the reason. Thread: one call at a time per surface; surfaces are independent. */
struct surface *surface_create(struct log *log, struct workers *workers, const float (*positions_m)[3], size_t vertex_count,
                               const uint32_t *triangles, size_t triangle_count, const struct surface_params *params);
/* Frees the surface. &NULL is fine; leaves NULL. */
void surface_destroy(struct surface **surface);
/* Returns counts and times of the steps. Belongs to the surface. */
const struct surface_report *surface_report(const struct surface *surface);

/* The surface as distances are found on it, to be looked at. Belongs to the surface. */
struct crack_bridge;
struct surface_debug_mesh {
    const double (*points_m)[3];
    const uint32_t (*tris)[3]; /* the visible ones first */
    size_t point_count, tri_count, visible_count;
    const uint32_t *vertex_point; /* of the model's vertices; other points are samples */
    size_t vertex_count;
    const struct crack_bridge *bridges; /* repair.h */
    size_t bridge_count;
};
/* Fills *look with the mesh that distances are computed on, for debug views. Belongs to the surface. */
void surface_debug_mesh(const struct surface *surface, struct surface_debug_mesh *look);

/* The result of projecting a point onto the surface. */
struct surface_place {
    double position_m[3]; /* on the surface */
    double distance_m;    /* from the point asked for */
    uint32_t vertex;      /* the model's vertex nearest to it, along straight lines */
};
/* Projects a point onto the nearest place of the surface, and finds the model's vertex nearest to it. */
void surface_nearest(const struct surface *surface, const double point_m[3], struct surface_place *place);

/* A point on the surface, by triangle and barycentric weights. */
struct surface_point {
    uint32_t tri;                              /* of the sampled surface */
    double weights[3], point_m[3], distance_m; /* weights: of tri's corners; distance_m: from the point asked for */
};
/* Finds the surface point nearest to point_m. With `normal`, prefers, among about equally near ones, a triangle that faces along it, so
   that the far side of a thin wall is not taken (NULL: no preference). */
void surface_find_point(const struct surface *surface, const double point_m[3], const double normal[3], struct surface_point *hit);
/* As surface_find_point(), but searches only within limit_m. Returns false if there is nothing. */
bool surface_find_point_within(const struct surface *surface, const double point_m[3], const double normal[3], double limit_m,
                               struct surface_point *hit);
/* Finds the nearest surface point within limit_m that belongs to one of two triangles of the model (which may be equal). Returns false if
   there is none that is visible. */
bool surface_find_point_on(const struct surface *surface, const double point_m[3], double limit_m, const uint32_t triangles[2],
                           struct surface_point *hit);
/* Finds the nearest surface point within limit_m that belongs to a triangle of the model for which allowed(arg, triangle) returns true.
   Returns false if there is none that is visible. */
bool surface_find_point_among(const struct surface *surface, const double point_m[3], double limit_m,
                              bool (*allowed)(const void *arg, uint32_t triangle), const void *arg, struct surface_point *hit);

/* Finds the point nearest to point_m on one triangle `tri` of the sampled surface; gives the same result as the search that found this
   triangle. Returns false if there is no such triangle or it is farther than limit_m. */
bool surface_point_on(const struct surface *surface, const double point_m[3], double limit_m, uint32_t tri, struct surface_point *hit);

/* Computes the geodesic distance in metres from each point (projected onto the surface) to every vertex of the model: out[point *
   vertex_count + vertex], INFINITY where the surface does not connect them. Spread over the workers. Returns false if out of memory,
   logged. Thread: any number of calls at a time; so for all functions below. */
bool surface_distances(const struct surface *surface, const double (*points_m)[3], size_t point_count, float *out);

/* Distances from a set of sources at every point of the sampled surface, from which those at any place follow. */
struct surface_field {
    size_t source_count;
    struct surface_point *sources;
    uint32_t *source_tris; /* theirs, side by side */
    float *distances_m;    /* [point of the sampled surface][source] */
};
/* Access to a cache of distances: a column is the distances of all points of the sampled surface from one source. Both callbacks run on any
   thread. */
struct surface_columns {
    bool (*fetch)(void *arg, size_t source, float *distances_m); /* false: not known */
    void (*keep)(void *arg, size_t source, float *distances_m);  /* one that was not known; rounded to what fetch() would give */
    void *arg;
};
/* Returns the number of points of the sampled surface, the length of a column. */
size_t surface_column_length(const struct surface *surface);
/* Computes the field of these source points, fetching known columns from the cache and storing new ones in it (columns NULL: no cache).
   Returns false if out of memory, logged, and then there is nothing to finish. */
bool surface_field_init(struct surface_field *field, const struct surface *surface, const double (*points_m)[3], size_t point_count,
                        const struct surface_columns *columns);
/* Frees the field. */
void surface_field_finish(struct surface_field *field);
/* Writes the distances of a vertex of the model from every source: out[source]. */
void surface_field_at_vertex(const struct surface_field *field, const struct surface *surface, uint32_t vertex, float *out);
/* Writes the distances of a surface point from every source: out[source]. */
void surface_field_at_point(const struct surface_field *field, const struct surface *surface, const struct surface_point *hit, float *out);

/* Compares the field with the heat method's distances for some of its sources, and fills the report's heat_disagreement, time_m2 and
   factor_s. Returns false if out of memory, logged. Thread: one at a time, beside calls that do not read the report. */
bool surface_check(struct surface *surface, const struct surface_field *field);

#endif
