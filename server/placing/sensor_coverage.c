/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes how well sensors cover an asset's surface. In most faces (triangles of the finest level of detail), the distances of the
   corners decide: the distances of two points from a sensor differ by no more than the points are apart. All other faces are
   halved until the distances of the corners and the middle of each piece decide. */
#include "placing/sensor_coverage.h"

#include <float.h>
#include <math.h>

#include "base/mem.h"
#include "field/kernels.h"
#include "placing/face_piece.h"
#include "plant/models/transform.h"

/* A piece of a face is not halved further if its longest side is at most FINEST_PART of the asset's size. If no other sensors affect
   the border between two kinds of area in the piece, it may be longer: SHORT_PART of the distance at which the border lies. The
   border then is a straight line in the piece. */
#define SHORT_PART 0.125
#define FINEST_PART 1e-3
/* The farthest point is found up to these errors, as a part of its distance from the sensors and of the asset's size. */
#define FARTHEST_PART 1e-4
#define FARTHEST_SIZE_PART 1e-6
/* maximum number of evaluations, each of one sensor's distances from a piece of a face: half a second. FACE_WORK: minimum for a
   face, as long as evaluations are left */
enum { WORK = 4000000, FACE_WORK = 65536 };
/* A distance along the surface is at least this part of the straight line, in spite of numerical errors. */
#define STRAIGHT_PART 0.95f

static double size_of(const struct scene_asset *asset)
{
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += pow(asset->bounds_max_m[c] - asset->bounds_min_m[c], 2);
    return sqrt(square);
}

static void to_plant(const struct scene_asset *asset, const float file_m[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)file_m[c];
    transform_point(asset->placement, out, out);
}

static void find_next(const struct field_layout *layout, enum distance_mode mode, struct sensor_coverage *out)
{
    for (size_t i = 0; i < layout->sensor_count; i++) {
        double least_m = INFINITY;
        size_t next = i;
        for (size_t j = 0; j < layout->sensor_count; j++) {
            float scratch[1];
            double m = INFINITY;
            if (j != i && mode == DISTANCE_EUCLIDEAN)
                m = (double)vecf_distance(layout->sensors[i].surface_m, layout->sensors[j].surface_m);
            else if (j != i)
                m = (double)*layout_distances(layout, mode, i, layout->sensors[j].vertex, 1, scratch);
            if (m < least_m) {
                least_m = m;
                next = j;
            }
        }
        if (next == i || least_m < out->next_m)
            continue;
        out->next_m = least_m;
        out->next_tags[0] = layout->sensors[i].tag;
        out->next_tags[1] = layout->sensors[next].tag;
    }
}

/* --- pieces of faces --------------------------------------------------------------------------------------------------------- */

enum { BAD, GOOD, KINDS };                                             /* sensors without and with a usable reading */
enum { MIDDLE = 3, POINTS };                                           /* points of a piece: its corners 0, 1 and 2, and its middle */
enum { MANY = 2 };                                                     /* number of sensors: more than one, or unknown */
enum { OPEN_FAR = 1, OPEN_LOST = 2, OPEN_FARTHEST = 4, OPEN_ALL = 7 }; /* results for which a piece must still be examined */

/* Distances in metres from a piece of a face to the nearest sensor of each kind. */
struct piece_distances {
    double corners_m[KINDS][3];
    double low_m[KINDS], high_m[KINDS]; /* bounds of the distances of all points of the piece */
    double longest_m, area_m2;          /* longest side, area of the piece */
    int near[KINDS];                    /* number of sensors that may be the nearest one of a point */
};

struct coverage_search {
    const struct sensor_coverage_query *query;
    struct sensor_coverage *out;
    const struct asset_view *view;
    struct field_layout inside; /* distances of `points`: the three corners of a piece and its middle */
    struct layout_points points;
    float positions_m[POINTS][3], parts[POINTS][3], away_m[POINTS][3];
    uint32_t corners[POINTS][3];
    float (*sensors_m)[3];   /* by sensor: its position on the surface */
    float *straight_m;       /* by sensor: straight-line distance from the middle of a face */
    uint32_t *near;          /* sensors that may be the nearest one of a point of the examined piece */
    float (*near_m)[POINTS]; /* in the order of `near`: distances of the corners and the middle of the examined piece */
    float *nearest_m[KINDS]; /* by vertex: distance from the nearest sensor of each kind */
    double size_m;           /* of the asset */
    float farthest_m[3];     /* position of the farthest point, in the coordinates of the asset file */
    double all_m2, far_m2, lost_m2, unsure_far_m2, unsure_lost_m2;
    double left_m; /* upper bound of the distances in pieces that were not examined, because no work was left */
};

static double least(const double m[3])
{
    return min_of(m[0], min_of(m[1], m[2]));
}

static double most(const double m[3])
{
    return max_of(m[0], max_of(m[1], m[2]));
}

/* Returns the distance in metres of the piece's corner from its nearest sensor of any kind. */
static double nearest_at(const struct piece_distances *d, int corner)
{
    return min_of(d->corners_m[BAD][corner], d->corners_m[GOOD][corner]);
}

/* Returns the part of a triangle in which a linear function with these values at the corners is positive. */
static double positive_part(const double corners[3])
{
    double low = least(corners), high = most(corners), middle = corners[0] + corners[1] + corners[2] - low - high;
    if (low >= 0 || high <= 0)
        return high > 0;
    return middle > 0 ? 1 - low * low / ((high - low) * (middle - low)) : high * high / ((high - low) * (high - middle));
}

/* Returns the distance in metres, or a large number if it is infinite. */
static double limited(double m)
{
    return min_of(m, 1e9);
}

/* Bounds the distances of all points of a piece by those of its corners. sides_m: lengths of the piece's sides, each from a corner
   to the next. Every point is within longest / sqrt(3) of a corner (Jung's theorem). */
static void bound_by_corners(struct piece_distances *d, const double sides_m[3])
{
    d->longest_m = most(sides_m);
    for (int kind = 0; kind < KINDS; kind++) {
        d->low_m[kind] = max_of(least(d->corners_m[kind]) - d->longest_m / sqrt(3), 0);
        d->high_m[kind] = most(d->corners_m[kind]) + d->longest_m / sqrt(3);
        for (int k = 0; k < 3; k++) {
            double away_m = max_of(sides_m[k], sides_m[(k + 2) % 3]);
            d->low_m[kind] = max_of(d->low_m[kind], d->corners_m[kind][k] - away_m);
            d->high_m[kind] = min_of(d->high_m[kind], d->corners_m[kind][k] + away_m);
        }
    }
}

static void add_far(struct coverage_search *search, const struct piece_distances *d, bool is_fine)
{
    double above_m[3];
    for (int k = 0; k < 3; k++)
        above_m[k] = limited(nearest_at(d, k)) - search->out->far_m;
    search->far_m2 += d->area_m2 * positive_part(above_m);
    search->unsure_far_m2 += is_fine ? 0 : d->area_m2;
}

static void add_lost(struct coverage_search *search, const struct piece_distances *d, bool is_fine)
{
    double above_m[3];
    bool is_between = d->high_m[BAD] <= search->query->reach_m; /* reach_m does not affect the border */
    for (int k = 0; k < 3; k++) {
        double good_m = limited(d->corners_m[GOOD][k]), bad_m = limited(min_of(d->corners_m[BAD][k], search->query->reach_m));
        /* the difference of the squares of two distances is linear on a flat face */
        above_m[k] = is_between ? good_m * good_m - bad_m * bad_m : good_m - bad_m;
    }
    search->lost_m2 += d->area_m2 * positive_part(above_m);
    search->unsure_lost_m2 += is_fine ? 0 : d->area_m2;
}

/* Returns whether add_far() is accurate for this piece: it is short, and only one sensor is near. */
static bool is_fine_for_far(const struct coverage_search *search, const struct piece_distances *d)
{
    return d->near[BAD] + d->near[GOOD] < MANY && d->longest_m <= SHORT_PART * search->out->far_m;
}

/* Returns whether add_lost() is accurate for this piece: it is short, and the border is that between two sensors, or that of the
   reach of one. */
static bool is_fine_for_lost(const struct coverage_search *search, const struct piece_distances *d)
{
    double away_m = max_of(nearest_at(d, 0), max_of(nearest_at(d, 1), nearest_at(d, 2)));
    bool is_between = d->near[BAD] < MANY && d->high_m[BAD] <= search->query->reach_m;
    return d->near[GOOD] < MANY && (is_between || d->low_m[BAD] >= search->query->reach_m) && d->longest_m <= SHORT_PART * away_m;
}

static double farthest_error(const struct coverage_search *search)
{
    return max_of(FARTHEST_PART * search->out->farthest_m, FARTHEST_SIZE_PART * search->size_m);
}

/* Adds the piece's area to the results that its distances decide. Returns those that they do not decide (OPEN_...). is_last: the
   piece cannot be halved, so all results must be decided. */
static int decide(struct coverage_search *search, const struct piece_distances *d, int open, bool is_last)
{
    const double far_m = search->out->far_m, reach_m = search->query->reach_m;
    const double low_m = min_of(d->low_m[BAD], d->low_m[GOOD]), high_m = min_of(d->high_m[BAD], d->high_m[GOOD]);
    const double finest_m = FINEST_PART * search->size_m;
    if (open & OPEN_FAR) {
        bool is_far = low_m > far_m, is_near = high_m <= far_m;
        bool is_fine = d->longest_m <= finest_m || is_fine_for_far(search, d);
        if (is_far)
            search->far_m2 += d->area_m2;
        else if (!is_near && (is_fine || is_last))
            add_far(search, d, is_fine);
        open &= is_far || is_near || is_fine ? ~OPEN_FAR : ~0;
    }
    if (open & OPEN_LOST) {
        bool is_lost = d->low_m[GOOD] > min_of(reach_m, d->high_m[BAD]) || isinf(d->low_m[GOOD]);
        bool is_kept = isfinite(d->high_m[GOOD]) && d->high_m[GOOD] <= min_of(reach_m, d->low_m[BAD]);
        bool is_fine = d->longest_m <= finest_m || is_fine_for_lost(search, d);
        if (is_lost)
            search->lost_m2 += d->area_m2;
        else if (!is_kept && (is_fine || is_last))
            add_lost(search, d, is_fine);
        open &= is_lost || is_kept || is_fine ? ~OPEN_LOST : ~0;
    }
    if (open & OPEN_FARTHEST) {
        bool is_near = isinf(low_m) || high_m <= search->out->farthest_m + farthest_error(search);
        if (is_last && !is_near)
            search->left_m = max_of(search->left_m, high_m);
        open &= is_near ? ~OPEN_FARTHEST : ~0;
    }
    return is_last ? 0 : open;
}

static void take_farthest(struct coverage_search *search, double m, const float at_m[3])
{
    if (m < 1e30 && m > search->out->farthest_m) {
        search->out->farthest_m = m;
        memcpy(search->farthest_m, at_m, sizeof(search->farthest_m));
    }
}

/* Returns whether b is nowhere in a piece the nearest sensor, because a is nearer at all corners. The difference of the squares of
   two distances is linear on a flat face. */
static bool is_behind(const float a_m[POINTS], const float b_m[POINTS])
{
    return a_m[0] <= b_m[0] && a_m[1] <= b_m[1] && a_m[2] <= b_m[2];
}

static int kind_of(const struct coverage_search *search, uint32_t sensor)
{
    return search->query->good[search->inside.sensors[sensor].tag] ? GOOD : BAD;
}

/* Moves those of the first `count` sensors of search->near that are the nearest one nowhere in the piece behind the others.
   nearest: index in search->near of the sensor nearest to the middle. Returns the number of the others. */
static size_t keep_near(struct coverage_search *search, size_t count, size_t nearest, double limit_m, struct piece_distances *d)
{
    float nearest_m[POINTS];
    const uint32_t first = search->near[nearest];
    size_t kept = 0;
    memcpy(nearest_m, search->near_m[nearest], sizeof(nearest_m));
    d->near[BAD] = d->near[GOOD] = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t sensor = search->near[i];
        if (sensor != first && ((double)search->near_m[i][MIDDLE] > limit_m || is_behind(nearest_m, search->near_m[i])))
            continue;
        search->near[i] = search->near[kept];
        memcpy(search->near_m[i], search->near_m[kept], sizeof(search->near_m[i]));
        search->near[kept++] = sensor;
        d->near[kind_of(search, sensor)]++;
    }
    return kept;
}

/* Measures the distances of the piece from the first *count sensors of search->near. Moves those that are the nearest sensor
   nowhere in the piece behind the others, and reduces *count to the number of the others. Returns the piece's longest side. */
static int measure(struct coverage_search *search, const uint32_t face[3], const struct face_piece *piece, size_t *count,
                   struct piece_distances *d)
{
    double middle_m[KINDS] = { INFINITY, INFINITY }, flat_m[KINDS] = { INFINITY, INFINITY }, sides_m[3], radius_m = 0;
    float middle[3], room[POINTS];
    size_t nearest = 0;
    face_piece_middle(piece, middle);
    for (int k = 0; k < POINTS; k++)
        layout_set_point(search->view, &search->points, (size_t)k, face, k < MIDDLE ? piece->corners[k] : middle);
    for (int k = 0; k < 3; k++) {
        sides_m[k] = (double)vecf_distance(search->positions_m[k], search->positions_m[(k + 1) % 3]);
        radius_m = max_of(radius_m, (double)vecf_distance(search->positions_m[k], search->positions_m[MIDDLE]));
        d->corners_m[BAD][k] = d->corners_m[GOOD][k] = INFINITY;
    }
    for (size_t i = 0; i < *count; i++) {
        const float *m = layout_distances(&search->inside, search->query->mode, search->near[i], 0, POINTS, room);
        const int kind = kind_of(search, search->near[i]);
        memcpy(search->near_m[i], m, sizeof(search->near_m[i]));
        /* if two sensors are equally near, the one with a usable reading counts */
        if (m[MIDDLE] < search->near_m[nearest][MIDDLE] ||
            (m[MIDDLE] == search->near_m[nearest][MIDDLE] && kind > kind_of(search, search->near[nearest])))
            nearest = i;
        for (int k = 0; k < 3; k++)
            d->corners_m[kind][k] = min_of(d->corners_m[kind][k], (double)m[k]);
        middle_m[kind] = min_of(middle_m[kind], (double)m[MIDDLE]);
        /* within a triangle, no point is farther from a sensor than one of the corners */
        flat_m[kind] = min_of(flat_m[kind], max_of((double)m[0], max_of((double)m[1], (double)m[2])));
    }
    bound_by_corners(d, sides_m);
    for (int kind = 0; kind < KINDS; kind++) {
        d->low_m[kind] = max_of(d->low_m[kind], middle_m[kind] - radius_m);
        d->high_m[kind] = min_of(d->high_m[kind], min_of(middle_m[kind] + radius_m, flat_m[kind]));
    }
    for (int k = 0; k < 3; k++)
        take_farthest(search, nearest_at(d, k), search->positions_m[k]);
    take_farthest(search, min_of(middle_m[BAD], middle_m[GOOD]), search->positions_m[MIDDLE]);
    if (*count > 0)
        *count = keep_near(search, *count, nearest, radius_m + (1 + 1e-5) * min_of(d->high_m[BAD], d->high_m[GOOD]), d);
    for (int kind = 0; kind < KINDS; kind++)
        if (d->near[kind] == 0)
            d->low_m[kind] = d->high_m[kind] = d->corners_m[kind][0] = d->corners_m[kind][1] = d->corners_m[kind][2] = INFINITY;
    return sides_m[0] >= d->longest_m ? 0 : sides_m[1] >= d->longest_m ? 1 : 2;
}

/* Halves the piece until all open results are decided, or `work` evaluations are done. count: number of sensors in search->near
   that may be the nearest. Returns the number of evaluations. */
static long search_piece(struct coverage_search *search, const uint32_t face[3], const struct face_piece *piece, double area_m2, int open,
                         size_t count, long work)
{
    struct face_piece halves[2];
    struct piece_distances d = { .area_m2 = area_m2 };
    long done = (long)count + 1;
    int side = measure(search, face, piece, &count, &d);
    open = decide(search, &d, open, done >= work);
    if (!open)
        return done;
    face_piece_halve(piece, side, halves);
    done += search_piece(search, face, &halves[0], area_m2 / 2, open, count, (work - done) / 8 * 7);
    done += search_piece(search, face, &halves[1], area_m2 / 2, open, count, work - done);
    return done;
}

/* --- faces ------------------------------------------------------------------------------------------------------------------- */

struct open_face { /* face whose corners do not decide all results */
    size_t face;
    double area_m2;
    int open;
};

/* Bounds the distances in a face by those of its corners. */
static void measure_face(const struct coverage_search *search, const uint32_t face[3], struct piece_distances *d, double sides_m[3])
{
    for (int k = 0; k < 3; k++) {
        sides_m[k] = (double)vecf_distance(search->view->positions_m[face[k]], search->view->positions_m[face[(k + 1) % 3]]);
        for (int kind = 0; kind < KINDS; kind++)
            d->corners_m[kind][k] = (double)search->nearest_m[kind][face[k]];
    }
    bound_by_corners(d, sides_m);
}

static long search_face(struct coverage_search *search, const uint32_t face[3], const struct open_face *of, long work)
{
    const struct field_layout *layout = &search->inside;
    struct piece_distances d;
    float middle_m[3] = { 0 };
    double sides_m[3], high_m;
    size_t count = 0;
    measure_face(search, face, &d, sides_m);
    high_m = min_of(d.high_m[BAD], d.high_m[GOOD]) + d.longest_m;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            middle_m[c] += search->view->positions_m[face[k]][c] / 3;
    kernel_euclidean((const float(*)[3])search->sensors_m, layout->sensor_count, middle_m, search->straight_m);
    for (size_t i = 0; i < layout->sensor_count; i++)
        if ((double)(STRAIGHT_PART * search->straight_m[i]) <= high_m)
            search->near[count++] = (uint32_t)i;
    return search_piece(search, face, &face_whole, of->area_m2, of->open, count, work);
}

static void search_faces(struct coverage_search *search)
{
    size_t count, open_count = 0, capacity = 0;
    const uint32_t(*faces)[3] = face_list(search->view, &count);
    struct open_face *list = NULL;
    double open_m2 = 0;
    long work = search->query->work > 0 ? search->query->work : WORK;
    memcpy(search->farthest_m, search->view->positions_m[count > 0 ? faces[0][0] : 0], sizeof(search->farthest_m));
    for (size_t i = 0; i < 3 * count; i++) {
        uint32_t vertex = faces[i / 3][i % 3];
        take_farthest(search, (double)fminf(search->nearest_m[BAD][vertex], search->nearest_m[GOOD][vertex]),
                      search->view->positions_m[vertex]);
    }
    for (size_t i = 0; i < count; i++) {
        struct piece_distances d = { .area_m2 = face_area(search->view, faces[i]), .near = { MANY, MANY } };
        double sides_m[3];
        if (!(d.area_m2 > 0))
            continue;
        measure_face(search, faces[i], &d, sides_m);
        int open = decide(search, &d, OPEN_ALL, false);
        search->all_m2 += d.area_m2;
        if (!open)
            continue;
        mem_grow(&list, &capacity, open_count + 1, sizeof(*list));
        list[open_count++] = (struct open_face){ i, d.area_m2, open };
        open_m2 += d.area_m2;
    }
    for (size_t i = 0; i < open_count; i++) {
        long share = (long)((double)work * min_of(list[i].area_m2 / open_m2, 1));
        work -= search_face(search, faces[list[i].face], &list[i], share > FACE_WORK ? share : work < FACE_WORK ? work : FACE_WORK);
        work = work > 0 ? work : 0;
        open_m2 = max_of(open_m2 - list[i].area_m2, DBL_MIN);
    }
    mem_free(list);
}

/* --- coverage ---------------------------------------------------------------------------------------------------------------- */

/* Computes the distance of each vertex from the nearest sensor of each kind. */
static void find_nearest(const struct coverage_search *search, const struct field_layout *layout)
{
    float scratch[KERNEL_BLOCK];
    for (size_t v = 0; v < layout->vertex_count; v++)
        search->nearest_m[BAD][v] = search->nearest_m[GOOD][v] = INFINITY;
    for (size_t at = 0, count; at < layout->vertex_count; at += count) {
        count = layout->vertex_count - at < KERNEL_BLOCK ? layout->vertex_count - at : KERNEL_BLOCK;
        for (size_t i = 0; i < layout->sensor_count; i++) {
            const int kind = search->query->good[layout->sensors[i].tag] ? GOOD : BAD;
            kernel_nearest(layout_distances(layout, search->query->mode, i, at, count, scratch), count, search->nearest_m[kind] + at);
        }
    }
}

static bool search_init(struct coverage_search *search, const struct field_layout *layout)
{
    const size_t sensors = layout->sensor_count;
    search->view = &layout->file->view;
    search->points = (struct layout_points){ search->positions_m, search->corners, search->parts, search->away_m };
    search->inside = *layout;
    search->inside.points = &search->points;
    search->inside.vertex_count = POINTS;
    search->sensors_m = mem_array(sensors, sizeof(*search->sensors_m));
    search->straight_m = mem_array(sensors, sizeof(*search->straight_m));
    search->near = mem_array(sensors, sizeof(*search->near));
    search->near_m = mem_array(sensors, sizeof(*search->near_m));
    for (size_t i = 0; i < sensors; i++)
        memcpy(search->sensors_m[i], layout->sensors[i].surface_m, sizeof(search->sensors_m[i]));
    for (int kind = 0; kind < KINDS; kind++)
        search->nearest_m[kind] = mem_try_array(layout->vertex_count, sizeof(float));
    return search->nearest_m[BAD] && search->nearest_m[GOOD];
}

static void search_finish(struct coverage_search *search)
{
    mem_free(search->sensors_m);
    mem_free(search->straight_m);
    mem_free(search->near);
    mem_free(search->near_m);
    mem_free(search->nearest_m[BAD]);
    mem_free(search->nearest_m[GOOD]);
}

bool sensor_coverage_find(const struct sensor_coverage_query *order, struct sensor_coverage *out)
{
    const struct scene_asset *asset = &order->scene->assets[order->asset];
    struct field_layout *layout = layout_create(order->scene, order->asset, order->group, order->trial);
    *out = (struct sensor_coverage){ .next_tags = { -1, -1 } };
    if (!layout)
        return false;
    layout_remove_ineffective(layout, layout->group->interpolation);
    out->sensors = layout->sensor_count;
    out->assumed = layout->assumed;
    if (layout->assumed || layout->sensor_count == 0) {
        layout_destroy(&layout);
        return out->assumed;
    }
    struct coverage_search search = { .query = order, .out = out, .size_m = size_of(asset) };
    out->far_m = order->far_m > 0 ? order->far_m : isfinite(order->reach_m) ? order->reach_m / 2 : search.size_m / 5;
    bool found = search_init(&search, layout);
    if (found) {
        find_nearest(&search, layout);
        search_faces(&search);
        out->farthest_error_m = max_of(farthest_error(&search), search.left_m - out->farthest_m);
        out->far_share = search.all_m2 > 0 ? min_of(search.far_m2 / search.all_m2, 1) : 0;
        out->lost_share = search.all_m2 > 0 ? min_of(search.lost_m2 / search.all_m2, 1) : 0;
        out->unsure_share = search.all_m2 > 0 ? min_of(max_of(search.unsure_far_m2, search.unsure_lost_m2) / search.all_m2, 1) : 0;
        to_plant(asset, search.farthest_m, out->farthest_at_m);
        find_next(layout, order->mode, out);
    }
    search_finish(&search);
    layout_destroy(&layout);
    return found;
}
