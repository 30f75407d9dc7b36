/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parallel transport of vectors along surfaces, which gives the directions of arrows away from sensors, compared with formulas
   for planes, spheres and boxes. */
#include "tests/support/test.h"

#include "base/math/vec.h"
#include "preprocess/influence/transport.h"
#include "tests/support/surface_case.h"

struct carried {
    struct cad shape;
    float (*normals)[3];
    struct influence influence;
};

/* Transports the vector of one sensor, which is placed at this vertex, to all vertices of the shape. */
static void carry(struct carried *c, size_t vertex)
{
    const size_t count = c->shape.vertex_count;
    const float *at = c->shape.positions[vertex];
    const double place_m[1][3] = { { (double)at[0], (double)at[1], (double)at[2] } };
    struct surface *surface = surface_of(&c->shape);
    struct influence_anchor *anchors = mem_array(count, sizeof(*anchors));
    struct influence_mesh mesh;
    struct vertex_embedding *embedding =
        vertex_embedding_create(surface, (const float(*)[3])c->shape.positions, (const float(*)[3])c->normals, count, c->shape.triangles,
                                c->shape.triangle_count);
    assert_true(influence_mesh_init(&mesh, surface, place_m, 1, 0.02, INFINITY));
    influence_mesh_anchors(&mesh, embedding, count, anchors);
    assert_true(transport_angles(&c->influence, the_log, workers, &mesh, anchors, (const float(*)[3])c->normals, count));
    influence_mesh_finish(&mesh);
    mem_free(anchors);
    vertex_embedding_destroy(&embedding);
}

static void finish(struct carried *c)
{
    influence_finish(&c->influence);
    cad_finish(&c->shape);
    mem_free(c->normals);
}

static void normal_of(const struct carried *c, size_t vertex, double normal[3])
{
    for (int i = 0; i < 3; i++)
        normal[i] = (double)c->normals[vertex][i];
}

/* Computes the vector in the plant's axes that arrives at a vertex. */
static void vector_at(const struct carried *c, size_t vertex, double out[3])
{
    double normal[3], x[3], y[3], angle = (double)c->influence.shares[vertex];
    assert_true(isfinite(angle));
    normal_of(c, vertex, normal);
    vec_frame(normal, x, y);
    for (int i = 0; i < 3; i++)
        out[i] = cos(angle) * x[i] + sin(angle) * y[i];
}

static size_t nearest_vertex(const struct cad *shape, const double point[3])
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t v = 0; v < shape->vertex_count; v++) {
        double at[3] = { (double)shape->positions[v][0], (double)shape->positions[v][1], (double)shape->positions[v][2] };
        double away = vec_distance(at, point);
        best = away < least ? v : best;
        least = fmin(away, least);
    }
    return best;
}

/* On a plate the vector must stay the same everywhere, also behind slots; on a separate plate it must be unknown. */
TEST(test_plane)
{
    struct carried c = { 0 };
    cad_slotted_plate(&c.shape, &chance, 24, 18, 1.2, 0.9, 11, 2, 15);
    size_t plate = c.shape.vertex_count;
    cad_plate(&c.shape, &chance, 4, 4, 0.2, 0.2, 0);
    for (size_t v = plate; v < c.shape.vertex_count; v++)
        c.shape.positions[v][2] += 2;
    c.normals = mem_array(c.shape.vertex_count, sizeof(*c.normals));
    for (size_t v = 0; v < c.shape.vertex_count; v++)
        c.normals[v][2] = 1;
    carry(&c, 0);
    double first[3], here[3], worst = 0;
    vector_at(&c, 0, first);
    for (size_t v = 1; v < plate; v++) {
        vector_at(&c, v, here);
        worst = fmax(worst, vec_distance(first, here));
    }
    printf("# slotted plate: worst %.2g rad\n", worst);
    assert_true(worst < 1e-5);
    for (size_t v = plate; v < c.shape.vertex_count; v++)
        assert_true(isinf((double)c.influence.shares[v]));
    finish(&c);
}

/* A strip of 40 m folded like an accordion within 2.3 m. Since the strip can be unfolded, the vector's component across the
   strip must stay the same along its whole length. */
TEST(test_accordion)
{
    const double length_m = 40, forth = 0.05, up = sqrt(1 - forth * forth);
    struct carried c = { 0 };
    cad_plate(&c.shape, &chance, 1600, 3, length_m, 0.06, 0);
    c.normals = mem_array(c.shape.vertex_count, sizeof(*c.normals));
    double least_m = INFINITY;
    for (size_t v = 0; v < c.shape.vertex_count; v++)
        least_m = fmin(least_m, (double)c.shape.positions[v][0]);
    for (size_t v = 0; v < c.shape.vertex_count; v++) {
        double along_m = (double)c.shape.positions[v][0] - least_m, leg = fmod(along_m, 2);
        c.normals[v][0] = (float)(leg < 1 ? -up : up);
        c.normals[v][2] = (float)forth;
        c.shape.positions[v][0] = (float)(forth * along_m);
        c.shape.positions[v][2] = (float)(up * (leg < 1 ? leg : 2 - leg));
    }
    carry(&c, 0);
    double first[3], here[3], worst = 0;
    vector_at(&c, 0, first);
    for (size_t v = 1; v < c.shape.vertex_count; v++) {
        vector_at(&c, v, here); /* vector_at() fails the test if the vector at this vertex is unknown */
        worst = fmax(worst, fabs(first[1] - here[1]));
    }
    printf("# accordion: worst %.2g\n", worst);
    assert_true(worst < 0.02);
    finish(&c);
}

/* On a sphere, vectors are transported along great circles from the sensor. They are compared up to points close to the
   opposite point, where all great circles meet. */
TEST(test_sphere)
{
    struct carried c = { 0 };
    cad_sphere(&c.shape, &chance, 20);
    c.normals = mem_array(c.shape.vertex_count, sizeof(*c.normals));
    for (size_t v = 0; v < c.shape.vertex_count; v++)
        for (int i = 0; i < 3; i++)
            c.normals[v][i] = c.shape.positions[v][i];
    size_t source = nearest_vertex(&c.shape, (const double[3]){ 0.3, 0.5, 0.8 });
    carry(&c, source);
    double from[3], first[3], worst = 0, near = 0, sum = 0;
    size_t count = 0;
    normal_of(&c, source, from);
    vector_at(&c, source, first);
    for (size_t v = 0; v < c.shape.vertex_count; v++) {
        double to[3], here[3], axis[3], want[3], turned[3];
        normal_of(&c, v, to);
        double cosine = vec_dot(from, to);
        vec_cross(from, to, axis);
        double sine = vec_normalize(axis);
        if (cosine < cos(0.9 * M_PI) || sine < 1e-6)
            continue;
        vec_cross(axis, first, turned);
        for (int i = 0; i < 3; i++) /* exact vector: Rodrigues' rotation formula about the axis of the great circle */
            want[i] = cosine * first[i] + sine * turned[i] + (1 - cosine) * vec_dot(axis, first) * axis[i];
        vector_at(&c, v, here);
        double error = 2 * asin(fmin(1, 0.5 * vec_distance(want, here)));
        near = cosine >= 0 ? fmax(near, error) : near;
        worst = fmax(worst, error);
        sum += error;
        count++;
    }
    printf("# sphere: mean %.4f rad, worst %.4f, of the nearer half %.4f, at %zu vertices\n", sum / (double)count, worst, near, count);
    assert_true(sum / (double)count < 0.02 && near < 0.03 && worst < 0.25);
    finish(&c);
}

/* Across an edge, the vector continues as if the two faces were unfolded. On a box, a vector in the middle of the top that
   points to one side must point downwards on that side. */
TEST(test_box)
{
    static const double middles[4][3] = { { 1, 0.5, 0.5 }, { 0.5, 1, 0.5 }, { 0, 0.5, 0.5 }, { 0.5, 0, 0.5 } };
    struct carried c = { 0 };
    cad_box(&c.shape, &chance, 10, 10, 10, 0.1);
    c.normals = mem_array(c.shape.vertex_count, sizeof(*c.normals));
    for (size_t v = 0; v < c.shape.vertex_count; v++) {
        int axis = 0;
        for (int i = 1; i < 3; i++)
            axis = fabsf(c.shape.positions[v][i] - 0.5f) > fabsf(c.shape.positions[v][axis] - 0.5f) ? i : axis;
        c.normals[v][axis] = c.shape.positions[v][axis] > 0.5f ? 1 : -1;
    }
    size_t top = nearest_vertex(&c.shape, (const double[3]){ 0.5, 0.5, 1 });
    carry(&c, top);
    double first[3];
    vector_at(&c, top, first);
    for (int side = 0; side < 4; side++) {
        double out[3] = { 2 * middles[side][0] - 1, 2 * middles[side][1] - 1, 0 }, here[3], want[3];
        double outward = vec_dot(first, out);
        for (int i = 0; i < 3; i++)
            want[i] = first[i] - outward * out[i] - (i == 2 ? outward : 0);
        vector_at(&c, nearest_vertex(&c.shape, middles[side]), here);
        printf("# box, side %d: %.4f rad\n", side, vec_distance(want, here));
        assert_true(vec_distance(want, here) < 0.05);
    }
    finish(&c);
}

/* A sphere from which two in five triangles are missing and some corners are moved at random. At borders and at edges with more
   than two triangles, weights may be negative, and rotations around a triangle do not cancel. The transported directions must
   be known nevertheless. */
TEST(test_tangle)
{
    struct carried c = { 0 };
    cad_sphere(&c.shape, &chance, 8);
    size_t kept = 0;
    for (size_t t = 0; t < c.shape.triangle_count; t++) {
        uint32_t *corners = &c.shape.triangles[3 * t];
        if (cad_random(&chance) < 0.4)
            continue;
        if (cad_random(&chance) < 0.3)
            corners[2] = (uint32_t)(cad_random(&chance) * (double)c.shape.vertex_count);
        for (int i = 0; i < 3; i++)
            c.shape.triangles[3 * kept + (size_t)i] = corners[i];
        kept++;
    }
    c.shape.triangle_count = kept;
    c.normals = mem_array(c.shape.vertex_count, sizeof(*c.normals));
    for (size_t v = 0; v < c.shape.vertex_count; v++)
        for (int i = 0; i < 3; i++)
            c.normals[v][i] = c.shape.positions[v][i];
    carry(&c, c.shape.triangles[0]);
    size_t known = 0;
    for (size_t v = 0; v < c.shape.vertex_count; v++)
        known += isfinite((double)c.influence.shares[v]);
    printf("# tangle: %zu of %zu vertices\n", known, c.shape.vertex_count);
    assert_true(10 * known > 9 * c.shape.vertex_count);
    finish(&c);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)
