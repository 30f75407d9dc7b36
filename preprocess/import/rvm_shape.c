/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tessellates the primitives of RVM files: surfaces of revolution ring by ring, flat primitives face by face, polygons with
 * holes with GLU's tessellator. */
#include "preprocess/import/rvm_shape.h"

#include <GL/glu.h>
#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

enum { MIN_CORNERS = 8, MAX_CORNERS = 256 };

const int rvm_numbers[RVM_FACETS + 1] = {
    [RVM_PYRAMID] = 7,        [RVM_BOX] = 3,   [RVM_RECTANGULAR_TORUS] = 4, [RVM_CIRCULAR_TORUS] = 3, [RVM_ELLIPTICAL_DISH] = 2,
    [RVM_SPHERICAL_DISH] = 2, [RVM_SNOUT] = 9, [RVM_CYLINDER] = 2,          [RVM_SPHERE] = 1,         [RVM_LINE] = 2
};

struct primitive_frame { /* transform from an RVM primitive's frame to the plant's frame */
    const double *m;
    double normal_of[9]; /* transforms normals: inverse transpose of the linear part, up to a factor; by columns */
    double scale;        /* largest factor by which the transform scales a length along an axis */
    bool mirrored;
};

static bool frame_of(const double m[12], struct primitive_frame *frame)
{
    *frame = (struct primitive_frame){ .m = m };
    vec_cross(m + 3, m + 6, frame->normal_of);
    vec_cross(m + 6, m, frame->normal_of + 3);
    vec_cross(m, m + 3, frame->normal_of + 6);
    double volume = vec_dot(m, frame->normal_of);
    for (int column = 0; column < 3; column++)
        frame->scale = fmax(frame->scale, vec_length(m + 3 * column));
    for (int i = 0; i < 12; i++)
        if (!isfinite(m[i]))
            return false;
    frame->mirrored = volume < 0;
    if (frame->mirrored)
        for (int i = 0; i < 9; i++)
            frame->normal_of[i] = -frame->normal_of[i];
    return isfinite(volume) && volume != 0;
}

static void apply(const double columns[9], const double v[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = columns[axis] * v[0] + columns[3 + axis] * v[1] + columns[6 + axis] * v[2];
}

static void to_plant(const struct primitive_frame *frame, const double local[3], double out[3])
{
    apply(frame->m, local, out);
    for (int axis = 0; axis < 3; axis++)
        out[axis] += frame->m[9 + axis];
}

static uint32_t add_vertex(struct cad_node *node, const struct primitive_frame *frame, const double local[3], const double normal[3])
{
    double position[3], direction[3];
    to_plant(frame, local, position);
    apply(frame->normal_of, normal, direction);
    return cad_node_add_vertex(node, position, direction);
}

static void add_triangle(struct cad_node *node, const struct primitive_frame *frame, uint32_t a, uint32_t b, uint32_t c)
{
    if (frame->mirrored)
        cad_node_add_triangle(node, a, c, b);
    else
        cad_node_add_triangle(node, a, b, c);
}

static void add_quad(struct cad_node *node, const struct primitive_frame *frame, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    add_triangle(node, frame, a, b, c);
    add_triangle(node, frame, a, c, d);
}

/* Returns the number of corners that approximate a full circle. The number is a multiple of 4, so that corners lie on both axes
 * of the section. Therefore the corners of two adjoining primitives coincide even if one section is mirrored. */
static int corners_of(double radius_m, double chord_m)
{
    double cosine = radius_m > 0 ? 1 - chord_m / radius_m : -1;
    double corners = cosine <= -1 ? MIN_CORNERS : ceil(M_PI / acos(fmin(cosine, 1 - 1e-9)) - 1e-3);
    return (int)fmin(MAX_CORNERS, fmax(MIN_CORNERS, 4 * ceil(corners / 4)));
}

/* Returns the angle of a round section's first corner, measured from direction `x` to direction `y` of the primitive's frame.
 * The corner is chosen so that its direction in the plant's frame depends only on the section's plane. */
static double phase_of(const struct primitive_frame *frame, const double x[3], const double y[3])
{
    double u[3], v[3], n[3];
    apply(frame->m, x, u);
    apply(frame->m, y, v);
    if (!(vec_normalize(u) > 0) || !(vec_normalize(v) > 0))
        return 0;
    vec_cross(u, v, n);
    if (!(vec_normalize(n) > 0))
        return 0;
    const double up[3] = { 0, 0, 1 }, east[3] = { 1, 0, 0 };
    const double *reference = fabs(n[2]) < 0.9 ? up : east;
    return atan2(vec_dot(reference, v), vec_dot(reference, u));
}

/* --- rings ------------------------------------------------------------------------------------------------------------------------ */

/* A circle or ellipse on which corners are placed, in the primitive's frame. The corner at an angle t is centre + cos(t) * x +
   sin(t) * y; phase: angle of the first corner. */
struct corner_ring {
    double centre[3], x[3], y[3], phase;
};

static void corner_of(const struct corner_ring *ring, int corner, int corners, double out[3], double spoke[3])
{
    double angle = ring->phase + 2 * M_PI * corner / corners, c = cos(angle), s = sin(angle);
    for (int axis = 0; axis < 3; axis++) {
        double along = c * ring->x[axis] + s * ring->y[axis];
        out[axis] = ring->centre[axis] + along;
        if (spoke)
            spoke[axis] = along;
    }
}

static void add_cap(struct cad_node *node, const struct primitive_frame *frame, const struct corner_ring *ring, int corners,
                    bool towards_axis)
{
    double n[3], at[3];
    vec_cross(ring->x, ring->y, n);
    for (int axis = 0; axis < 3 && towards_axis; axis++)
        n[axis] = -n[axis];
    uint32_t first = (uint32_t)node->vertex_count;
    for (int i = 0; i < corners; i++) {
        corner_of(ring, i, corners, at, NULL);
        add_vertex(node, frame, at, n);
    }
    for (uint32_t i = 1; i + 1 < (uint32_t)corners; i++)
        if (towards_axis)
            add_triangle(node, frame, first, first + i + 1, first + i);
        else
            add_triangle(node, frame, first, first + i, first + i + 1);
}

/* Joins two rows of `corners` vertices around a closed cross-section with triangles; row `high` lies farther along the axis
 * than row `low`. */
static void join_rows(struct cad_node *node, const struct primitive_frame *frame, uint32_t low, uint32_t high, uint32_t corners)
{
    for (uint32_t i = 0; i < corners; i++) {
        uint32_t next = (i + 1) % corners;
        add_quad(node, frame, low + i, low + next, high + next, high + i);
    }
}

/* --- the primitives --------------------------------------------------------------------------------------------------------------- */

/* Adds the six faces of a prism between two rectangles, one above the other. */
static void add_prism(struct cad_node *node, const struct primitive_frame *frame, const double corners[8][3], uint32_t open_faces)
{
    static const int faces[RVM_MAX_FACES][4] = { { 0, 3, 2, 1 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 },
                                                 { 1, 2, 6, 5 }, { 2, 3, 7, 6 }, { 3, 0, 4, 7 } };
    for (int f = 0; f < RVM_MAX_FACES; f++) {
        const double *p[4];
        double u[3], v[3], n[3];
        for (int i = 0; i < 4; i++)
            p[i] = corners[faces[f][i]];
        vec_sub(p[2], p[0], u); /* take the normal from the quadrilateral's diagonals: it is then right even if a side has zero length */
        vec_sub(p[3], p[1], v);
        vec_cross(u, v, n);
        if (vec_dot(n, n) == 0 || (open_faces >> f & 1))
            continue;
        uint32_t at[4];
        for (int i = 0; i < 4; i++)
            at[i] = add_vertex(node, frame, p[i], n);
        add_quad(node, frame, at[0], at[1], at[2], at[3]);
    }
}

static void add_pyramid(struct cad_node *node, const struct primitive_frame *frame, const double *n, uint32_t open_faces)
{
    double corners[8][3];
    for (int i = 0; i < 8; i++) {
        bool top = i >= 4;
        double sx = i % 4 == 1 || i % 4 == 2 ? 0.5 : -0.5, sy = i % 4 >= 2 ? 0.5 : -0.5, side = top ? 0.5 : -0.5;
        corners[i][0] = sx * n[top ? 2 : 0] + side * n[4];
        corners[i][1] = sy * n[top ? 3 : 1] + side * n[5];
        corners[i][2] = side * n[6];
    }
    add_prism(node, frame, corners, open_faces);
}

static void add_box(struct cad_node *node, const struct primitive_frame *frame, const double *n, uint32_t open_faces)
{
    add_pyramid(node, frame, (double[7]){ n[0], n[1], n[0], n[1], 0, 0, n[2] }, open_faces);
}

static int steps_of(double angle, double radius_m, double chord_m)
{
    return (int)fmax(1, ceil(corners_of(radius_m, chord_m) * fabs(angle) / (2 * M_PI) - 1e-6));
}

static void add_rectangular_torus(struct cad_node *node, const struct primitive_frame *frame, const double *n, double chord_m,
                                  uint32_t open_faces)
{
    double inner = n[0], outer = n[1], half = n[2] / 2, angle = n[3];
    int steps = steps_of(angle, outer * frame->scale, chord_m);
    const double section[4][2] = { { inner, -half }, { outer, -half }, { outer, half }, { inner, half } };
    /* the four sides of the torus's rectangular section: bottom, outside, top, inside of the bend */
    for (int side = 0; side < 4; side++) {
        const double *from = section[side], *to = section[(side + 1) % 4];
        double radial = to[1] - from[1], vertical = from[0] - to[0];
        if (radial == 0 && vertical == 0)
            continue;
        uint32_t first = (uint32_t)node->vertex_count;
        for (int i = 0; i <= steps; i++) {
            double c = cos(angle * i / steps), s = sin(angle * i / steps);
            add_vertex(node, frame, (double[3]){ from[0] * c, from[0] * s, from[1] }, (double[3]){ radial * c, radial * s, vertical });
            add_vertex(node, frame, (double[3]){ to[0] * c, to[0] * s, to[1] }, (double[3]){ radial * c, radial * s, vertical });
        }
        for (uint32_t i = 0; i < (uint32_t)steps; i++)
            add_quad(node, frame, first + 2 * i, first + 2 * i + 2, first + 2 * i + 3, first + 2 * i + 1);
    }
    if (fabs(angle) > 2 * M_PI - 1e-3)
        return;
    for (int end = 0; end < 2; end++) {
        if (open_faces >> end & 1)
            continue;
        double c = cos(end ? angle : 0), s = sin(end ? angle : 0), sign = (end ? 1 : -1) * (angle < 0 ? -1 : 1);
        uint32_t at[4];
        for (int i = 0; i < 4; i++)
            at[i] = add_vertex(node, frame, (double[3]){ section[i][0] * c, section[i][0] * s, section[i][1] },
                               (double[3]){ -sign * s, sign * c, 0 });
        if (sign < 0)
            add_quad(node, frame, at[0], at[1], at[2], at[3]);
        else
            add_quad(node, frame, at[3], at[2], at[1], at[0]);
    }
}

static struct corner_ring torus_ring(double offset, double radius, double angle)
{
    double c = cos(angle), s = sin(angle);
    return (struct corner_ring){ .centre = { offset * c, offset * s, 0 }, .x = { radius * c, radius * s, 0 }, .y = { 0, 0, radius } };
}

/* Adds a circular torus. If the first corners of the two ends have different angles (phase_of()), the corners rotate gradually along the
 * bend. The total rotation is at most half the angle between two corners. */
static void add_circular_torus(struct cad_node *node, const struct primitive_frame *frame, const double *n, double chord_m,
                               uint32_t open_faces)
{
    double offset = n[0], radius = n[1], angle = n[2];
    int corners = corners_of(radius * frame->scale, chord_m), steps = steps_of(angle, (offset + radius) * frame->scale, chord_m);
    struct corner_ring ends[2] = { torus_ring(offset, radius, 0), torus_ring(offset, radius, angle) };
    double each = 2 * M_PI / corners;
    for (int end = 0; end < 2; end++)
        ends[end].phase = phase_of(frame, ends[end].x, ends[end].y);
    double turn = remainder(ends[1].phase - ends[0].phase, each);
    uint32_t before = 0;
    for (int i = 0; i <= steps; i++) {
        struct corner_ring ring = torus_ring(offset, radius, angle * i / steps);
        ring.phase = ends[0].phase + turn * i / steps;
        uint32_t row = (uint32_t)node->vertex_count;
        for (int k = 0; k < corners; k++) {
            double at[3], spoke[3];
            corner_of(&ring, k, corners, at, spoke);
            add_vertex(node, frame, at, spoke);
        }
        if (i > 0 && angle < 0)
            join_rows(node, frame, before, row, (uint32_t)corners);
        else if (i > 0)
            join_rows(node, frame, row, before, (uint32_t)corners);
        before = row;
    }
    ends[1].phase = ends[0].phase + turn;
    if (fabs(angle) > 2 * M_PI - 1e-3)
        return;
    /* add_cap() reverses the normal (x cross y) if its last argument is true: at the second end of a bend with a positive angle,
       at the first end of one with a negative angle */
    for (int end = 0; end < 2; end++)
        if (!(open_faces >> end & 1))
            add_cap(node, frame, &ends[end], corners, (end == 1) == (angle > 0));
}

struct dome {          /* part of an ellipsoid of revolution about the Z axis: from the angle `low` above the equator to the pole */
    double across, up; /* across: radius of the ellipsoid in X and Y; up: its radius along Z */
    double centre_z, low, phase;
    int corners;
};

static void add_dome(struct cad_node *node, const struct primitive_frame *frame, const struct dome *dome)
{
    const int corners = dome->corners;
    const double low = dome->low, across = dome->across, up = dome->up;
    int rows = (int)fmax(2, ceil(corners * (M_PI / 2 - low) / (2 * M_PI)));
    uint32_t before = 0;
    for (int i = 0; i < rows; i++) {
        double t = low + (M_PI / 2 - low) * i / rows;
        uint32_t row = (uint32_t)node->vertex_count;
        for (int k = 0; k < corners; k++) {
            double angle = dome->phase + 2 * M_PI * k / corners, c = cos(angle), s = sin(angle);
            add_vertex(node, frame, (double[3]){ across * cos(t) * c, across * cos(t) * s, dome->centre_z + up * sin(t) },
                       (double[3]){ up * cos(t) * c, up * cos(t) * s, across * sin(t) });
        }
        if (i > 0)
            join_rows(node, frame, before, row, (uint32_t)corners);
        before = row;
    }
    uint32_t pole = add_vertex(node, frame, (double[3]){ 0, 0, dome->centre_z + up }, (double[3]){ 0, 0, 1 });
    for (uint32_t k = 0; k < (uint32_t)corners; k++)
        add_triangle(node, frame, before + k, before + (k + 1) % (uint32_t)corners, pole);
}

static struct corner_ring level_ring(double radius, double z)
{
    return (struct corner_ring){ .centre = { 0, 0, z }, .x = { radius, 0, 0 }, .y = { 0, radius, 0 } };
}

/* Adds a dish: a spherical cap of radius (r^2 + h^2) / 2h, or half an ellipsoid. */
static void add_dish(struct cad_node *node, const struct primitive_frame *frame, const double *n, bool spherical, double chord_m,
                     uint32_t open_faces)
{
    double radius = n[0], height = n[1], across = radius, up = height, centre = 0, low = 0;
    if (spherical) {
        across = up = (radius * radius + height * height) / (2 * height);
        centre = height - up;
        low = asin(fmax(-1, fmin(1, -centre / up)));
    }
    struct corner_ring base = level_ring(radius, 0);
    base.phase = phase_of(frame, base.x, base.y);
    int corners = corners_of(radius * frame->scale, chord_m);
    add_dome(node, frame, &(struct dome){ across, up, centre, low, base.phase, corners });
    if (!(open_faces & 1))
        add_cap(node, frame, &base, corners, true);
}

static void add_sphere(struct cad_node *node, const struct primitive_frame *frame, const double *n, double chord_m)
{
    double radius = n[0] / 2;
    int corners = corners_of(radius * frame->scale, chord_m), rows = corners / 2;
    for (int i = 0; i <= rows; i++) {
        double t = M_PI * i / rows - M_PI / 2;
        uint32_t row = (uint32_t)node->vertex_count;
        for (int k = 0; k < corners; k++) {
            double angle = 2 * M_PI * k / corners;
            double spoke[3] = { radius * cos(t) * cos(angle), radius * cos(t) * sin(angle), radius * sin(t) };
            add_vertex(node, frame, spoke, spoke);
        }
        for (uint32_t k = 0; i > 0 && k < (uint32_t)corners; k++) {
            uint32_t next = (k + 1) % (uint32_t)corners, below = row - (uint32_t)corners;
            if (i > 1)
                add_triangle(node, frame, below + k, below + next, row + next);
            if (i < rows)
                add_triangle(node, frame, below + k, row + next, row + k);
        }
    }
}

/* Joins two rings with triangles. The rings may have different numbers of corners: each triangle advances on the ring whose
 * next corner has the smaller angle. A ring of radius 0 is a single point and contributes no edges. */
static void join_rings(struct cad_node *node, const struct primitive_frame *frame, const uint32_t rows[2], const int corners[2],
                       const double radii[2])
{
    for (int low = 0, high = 0; low < corners[0] || high < corners[1];) {
        uint32_t a = rows[0] + (uint32_t)(low % corners[0]), b = rows[1] + (uint32_t)(high % corners[1]);
        if (high == corners[1] || (low < corners[0] && (low + 1) * corners[1] <= (high + 1) * corners[0])) {
            low++;
            if (radii[0] > 0)
                add_triangle(node, frame, a, rows[0] + (uint32_t)(low % corners[0]), b);
        } else {
            high++;
            if (radii[1] > 0)
                add_triangle(node, frame, a, rows[1] + (uint32_t)(high % corners[1]), b);
        }
    }
}

/* Adds the side of a snout: a cone between two circles that may be offset and tilted. A circle of radius 0 gets as many corners
 * as the other one, all at the same point. */
static void add_snout(struct cad_node *node, const struct primitive_frame *frame, const double *n, double chord_m, uint32_t open_faces)
{
    double height = n[2], radii[2] = { n[0], n[1] };
    double phase = phase_of(frame, (double[3]){ 1, 0, 0 }, (double[3]){ 0, 1, 0 });
    int corners[2];
    uint32_t rows[2];
    for (int end = 0; end < 2; end++) {
        double side = end ? 0.5 : -0.5, mx = tan(n[end ? 7 : 5]), my = tan(n[end ? 8 : 6]), r = radii[end];
        corners[end] = corners_of((r > 0 ? r : radii[!end]) * frame->scale, chord_m);
        rows[end] = (uint32_t)node->vertex_count;
        for (int k = 0; k < corners[end]; k++) {
            double angle = phase + 2 * M_PI * k / corners[end], c = cos(angle), s = sin(angle);
            double slope = height != 0 ? (n[0] - n[1] - n[3] * c - n[4] * s) / height : 0;
            add_vertex(node, frame, (double[3]){ r * c + side * n[3], r * s + side * n[4], side * height + r * (mx * c + my * s) },
                       (double[3]){ c, s, slope });
        }
    }
    join_rings(node, frame, rows, corners, radii);
    for (int end = 0; end < 2; end++) {
        double side = end ? 0.5 : -0.5, r = radii[end];
        struct corner_ring ring = { .centre = { side * n[3], side * n[4], side * height },
                                    .x = { r, 0, r * tan(n[end ? 7 : 5]) },
                                    .y = { 0, r, r * tan(n[end ? 8 : 6]) },
                                    .phase = phase };
        if (r != 0 && !(open_faces >> end & 1))
            add_cap(node, frame, &ring, corners[end], end == 0);
    }
}

static void add_line(struct cad_node *node, const struct primitive_frame *frame, const double *n)
{
    double from[3], to[3];
    to_plant(frame, (double[3]){ n[0], 0, 0 }, from);
    to_plant(frame, (double[3]){ n[1], 0, 0 }, to);
    cad_node_add_line(node, from, to);
}

/* --- polygons --------------------------------------------------------------------------------------------------------------------- */

struct tessellated_polygon { /* state shared by GLU's callbacks */
    struct cad_node *node;
    const struct primitive_frame *frame;
    double normal[3];
    const double (*corner)[3];
    uint32_t three[3];
    int count;
    double (*made)[3]; /* additional vertices that were made because GLU's tessellator needs them where edges of the polygon cross */
    size_t made_count;
};

static void on_vertex(void *vertex, void *user)
{
    struct tessellated_polygon *polygon = user;
    polygon->three[polygon->count++] = add_vertex(polygon->node, polygon->frame, vertex, polygon->normal);
    if (polygon->count == 3) {
        add_triangle(polygon->node, polygon->frame, polygon->three[0], polygon->three[1], polygon->three[2]);
        polygon->count = 0;
    }
}

/* with this callback registered, GLU's tessellator emits only separate triangles, no fans or strips */
static void on_edge_flag(GLboolean flag)
{
    (void)flag;
}

enum { MAX_CROSSINGS = 4096 };

static void on_combine(GLdouble at[3], void *of[4], GLfloat weight[4], void **out, void *user)
{
    (void)of;
    (void)weight;
    struct tessellated_polygon *polygon = user;
    if (polygon->made_count == MAX_CROSSINGS) { /* does not enlarge the array polygon->made, because GLU keeps pointers to its elements */
        *out = polygon->made[MAX_CROSSINGS - 1];
        return;
    }
    memcpy(polygon->made[polygon->made_count], at, sizeof(polygon->made[0]));
    *out = polygon->made[polygon->made_count++];
}

/* Computes the normal of a contour by Newell's method, which works for contours that are not planar or convex. */
static void contour_normal(const double (*points)[3], const struct rvm_contour *contour, double out[3])
{
    memset(out, 0, 3 * sizeof(*out));
    for (size_t i = 0; i < contour->count; i++) {
        const double *a = points[contour->first + i], *b = points[contour->first + (i + 1) % contour->count];
        for (int axis = 0; axis < 3; axis++) {
            int y = (axis + 1) % 3, z = (axis + 2) % 3;
            out[axis] += (a[y] - b[y]) * (a[z] + b[z]);
        }
    }
}

static const char *add_facets(struct cad_node *node, const struct primitive_frame *frame, const struct rvm_shape *shape)
{
    size_t before = node->triangle_count;
    GLUtesselator *tess = gluNewTess();
    if (!tess)
        return "out of memory for the primitive's polygons";
    struct tessellated_polygon polygon = { .node = node, .frame = frame, .made = mem_array(MAX_CROSSINGS, sizeof(*polygon.made)) };
    gluTessCallback(tess, GLU_TESS_VERTEX_DATA, (_GLUfuncptr)on_vertex);
    gluTessCallback(tess, GLU_TESS_EDGE_FLAG, (_GLUfuncptr)on_edge_flag);
    gluTessCallback(tess, GLU_TESS_COMBINE_DATA, (_GLUfuncptr)on_combine);
    gluTessProperty(tess, GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_ODD);
    for (size_t c = 0; c < shape->contour_count;) {
        contour_normal(shape->points, &shape->contours[c], polygon.normal);
        polygon.count = 0;
        polygon.made_count = 0;
        bool empty = !(vec_normalize(polygon.normal) > 0);
        gluTessNormal(tess, polygon.normal[0], polygon.normal[1], polygon.normal[2]);
        gluTessBeginPolygon(tess, &polygon);
        do {
            const struct rvm_contour *contour = &shape->contours[c++];
            gluTessBeginContour(tess);
            for (size_t i = 0; !empty && i < contour->count; i++) {
                void *corner = (void *)(uintptr_t)shape->points[contour->first + i];
                gluTessVertex(tess, corner, corner);
            }
            gluTessEndContour(tess);
        } while (c < shape->contour_count && !shape->contours[c].begins_polygon);
        gluTessEndPolygon(tess);
    }
    gluDeleteTess(tess);
    mem_free(polygon.made);
    return node->triangle_count > before ? NULL : "none of the primitive's polygons has an area";
}

/* --- public functions ------------------------------------------------------------------------------------------------------------- */

static bool is_turn(double angle)
{
    return angle != 0 && fabs(angle) <= 2 * M_PI + 1e-3;
}

static bool has_extent(const struct rvm_shape *shape)
{
    const double *n = shape->numbers;
    switch (shape->kind) {
    case RVM_PYRAMID: return n[0] >= 0 && n[1] >= 0 && n[2] >= 0 && n[3] >= 0 && n[0] + n[2] > 0 && n[1] + n[3] > 0;
    case RVM_BOX: return n[0] >= 0 && n[1] >= 0 && n[2] >= 0;
    case RVM_RECTANGULAR_TORUS: return n[0] >= 0 && n[1] > n[0] && n[2] >= 0 && is_turn(n[3]);
    case RVM_CIRCULAR_TORUS: return n[0] >= 0 && n[1] > 0 && is_turn(n[2]);
    case RVM_ELLIPTICAL_DISH:
    case RVM_SPHERICAL_DISH: return n[0] > 0 && n[1] > 0;
    case RVM_SNOUT: return n[0] >= 0 && n[1] >= 0 && n[0] + n[1] > 0 && fabs(cos(n[5]) * cos(n[6]) * cos(n[7]) * cos(n[8])) > 1e-3;
    case RVM_CYLINDER: return n[0] > 0 && n[1] >= 0;
    case RVM_SPHERE: return n[0] > 0;
    case RVM_LINE:
    case RVM_FACETS: return true;
    }
    return false;
}

static bool is_finite(const struct rvm_shape *shape)
{
    for (int i = 0; i < rvm_numbers[shape->kind]; i++)
        if (!isfinite(shape->numbers[i]))
            return false;
    size_t points = 0;
    for (size_t c = 0; c < shape->contour_count; c++)
        points = shape->contours[c].first + shape->contours[c].count;
    for (size_t i = 0; i < points; i++)
        for (int axis = 0; axis < 3; axis++)
            if (!isfinite(shape->points[i][axis]))
                return false;
    return true;
}

const char *rvm_shape_tessellate(const struct rvm_shape *shape, double chord_m, struct cad_node *node)
{
    struct primitive_frame frame;
    const double *n = shape->numbers;
    if (!is_finite(shape))
        return "the primitive's numbers in the RVM file are infinite, or not numbers";
    if (!frame_of(shape->to_plant, &frame))
        return "the primitive's matrix in the RVM file flattens the shape, or has invalid numbers";
    if (!has_extent(shape))
        return "the primitive's dimensions in the RVM file are zero, negative or contradictory";
    switch (shape->kind) {
    case RVM_PYRAMID: add_pyramid(node, &frame, n, shape->open_faces); break;
    case RVM_BOX: add_box(node, &frame, n, shape->open_faces); break;
    case RVM_RECTANGULAR_TORUS: add_rectangular_torus(node, &frame, n, chord_m, shape->open_faces); break;
    case RVM_CIRCULAR_TORUS: add_circular_torus(node, &frame, n, chord_m, shape->open_faces); break;
    case RVM_ELLIPTICAL_DISH:
    case RVM_SPHERICAL_DISH: add_dish(node, &frame, n, shape->kind == RVM_SPHERICAL_DISH, chord_m, shape->open_faces); break;
    case RVM_SNOUT: add_snout(node, &frame, n, chord_m, shape->open_faces); break;
    case RVM_CYLINDER: add_snout(node, &frame, (double[9]){ n[0], n[0], n[1] }, chord_m, shape->open_faces); break;
    case RVM_SPHERE: add_sphere(node, &frame, n, chord_m); break;
    case RVM_LINE: add_line(node, &frame, n); break;
    case RVM_FACETS: return add_facets(node, &frame, shape);
    }
    return NULL;
}

static void circle_of(const struct primitive_frame *frame, const double centre[3], const double outward[3], double radius,
                      struct rvm_face *face)
{
    *face = (struct rvm_face){ .radius_m = radius * frame->scale };
    to_plant(frame, centre, face->centre_m);
    apply(frame->normal_of, outward, face->outward);
    vec_normalize(face->outward);
}

/* Computes the rectangular face of a primitive. u, v: half sides as vectors in the primitive's frame. */
static void rectangle_of(const struct primitive_frame *frame, const double centre[3], const double outward[3], const double u[3],
                         const double v[3], struct rvm_face *face)
{
    circle_of(frame, centre, outward, 0, face);
    const double *sides[2] = { u, v };
    for (int i = 0; i < 2; i++) {
        apply(frame->m, sides[i], face->directions[i]);
        face->half_m[i] = vec_normalize(face->directions[i]);
    }
}

static int prism_faces(const struct primitive_frame *frame, const struct rvm_shape *shape, struct rvm_face *faces)
{
    const double *n = shape->numbers;
    bool box = shape->kind == RVM_BOX;
    double bx = n[0] / 2, by = n[1] / 2, tx = box ? bx : n[2] / 2, ty = box ? by : n[3] / 2, ox = box ? 0 : n[4] / 2,
           oy = box ? 0 : n[5] / 2;
    double h = (box ? n[2] : n[6]) / 2;
    rectangle_of(frame, (double[3]){ -ox, -oy, -h }, (double[3]){ 0, 0, -1 }, (double[3]){ bx, 0, 0 }, (double[3]){ 0, by, 0 }, &faces[0]);
    rectangle_of(frame, (double[3]){ ox, oy, h }, (double[3]){ 0, 0, 1 }, (double[3]){ tx, 0, 0 }, (double[3]){ 0, ty, 0 }, &faces[1]);
    for (int i = 2; box && i < RVM_MAX_FACES; i++) { /* the side faces, in the order of add_prism(): -y, +x, +y, -x */
        double x = i == 3 ? 1 : i == 5 ? -1 : 0, y = i == 4 ? 1 : i == 2 ? -1 : 0;
        rectangle_of(frame, (double[3]){ x * bx, y * by, 0 }, (double[3]){ x, y, 0 }, (double[3]){ y * bx, x * by, 0 },
                     (double[3]){ 0, 0, h }, &faces[i]);
    }
    return box ? RVM_MAX_FACES : 2;
}

static int bend_faces(const struct primitive_frame *frame, const struct rvm_shape *shape, struct rvm_face *faces)
{
    const double *n = shape->numbers;
    bool round = shape->kind == RVM_CIRCULAR_TORUS;
    double angle = round ? n[2] : n[3], middle = round ? n[0] : (n[0] + n[1]) / 2, half = (n[1] - n[0]) / 2;
    for (int end = 0; end < 2; end++) {
        double c = cos(end ? angle : 0), s = sin(end ? angle : 0), sign = (angle < 0) == (end == 1) ? -1 : 1;
        double centre[3] = { middle * c, middle * s, 0 }, outward[3] = { -sign * s, sign * c, 0 };
        if (round)
            circle_of(frame, centre, outward, n[1], &faces[end]);
        else
            rectangle_of(frame, centre, outward, (double[3]){ half * c, half * s, 0 }, (double[3]){ 0, 0, n[2] / 2 }, &faces[end]);
    }
    return fabs(angle) > 2 * M_PI - 1e-3 ? 0 : 2;
}

int rvm_shape_faces(const struct rvm_shape *shape, struct rvm_face faces[RVM_MAX_FACES])
{
    static const double down[3] = { 0, 0, -1 }, up[3] = { 0, 0, 1 };
    struct primitive_frame frame;
    const double *n = shape->numbers;
    if (!frame_of(shape->to_plant, &frame) || !is_finite(shape) || !has_extent(shape))
        return 0;
    switch (shape->kind) {
    case RVM_BOX:
    case RVM_PYRAMID: return prism_faces(&frame, shape, faces);
    case RVM_CIRCULAR_TORUS:
    case RVM_RECTANGULAR_TORUS: return bend_faces(&frame, shape, faces);
    case RVM_ELLIPTICAL_DISH:
    case RVM_SPHERICAL_DISH: circle_of(&frame, (double[3]){ 0, 0, 0 }, down, n[0], &faces[0]); return 1;
    case RVM_SNOUT:
        if (n[5] != 0 || n[6] != 0 || n[7] != 0 || n[8] != 0)
            return 0;
        circle_of(&frame, (double[3]){ -n[3] / 2, -n[4] / 2, -n[2] / 2 }, down, n[0], &faces[0]);
        circle_of(&frame, (double[3]){ n[3] / 2, n[4] / 2, n[2] / 2 }, up, n[1], &faces[1]);
        return 2;
    case RVM_CYLINDER:
        circle_of(&frame, (double[3]){ 0, 0, -n[1] / 2 }, down, n[0], &faces[0]);
        circle_of(&frame, (double[3]){ 0, 0, n[1] / 2 }, up, n[0], &faces[1]);
        return 2;
    default: return 0;
    }
}
