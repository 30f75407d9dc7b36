/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the points where triangle edges cross isolines, selects some of these points for labels, and tests their visibility. */
#include "render/pick/isolines.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "render/matrix.h"
#include "render/pick/coarse_level.h"
#include "render/pick/markers.h"

enum { POINTS_PER_LINE = 16, MAX_POINTS = 2048, MAX_LABELS = 128, MAX_ARROWS = 192, MAX_STROKES = 48 };
/* Limits of the search for points where an isoline crosses an edge of a triangle, along which the field need not be linear.
   MAX_PIECES: maximum number of pieces of an edge that are searched one by one; MAX_BISECTIONS: number of bisection steps that
   locate a crossing within a piece. */
enum { MAX_BISECTIONS = 24, MAX_PIECES = 16 };
/* minimum distance between possible label positions on isolines, as a fraction of the asset's size */
static const double SPACING = 0.1;
/* minimum distance between two labels of one isoline in a frame, as a multiple of the minimum distance between labels of
   different isolines */
static const double SAME_LINE_FACTOR = 4;

void isolines_init(struct isolines *isolines, size_t asset_count)
{
    isolines->sets = mem_array(asset_count, sizeof(*isolines->sets));
    isolines->arrows = mem_array(asset_count, sizeof(*isolines->arrows));
    isolines->strokes = mem_array(asset_count, sizeof(*isolines->strokes));
    isolines->asset_count = asset_count;
}

void isolines_finish(struct isolines *isolines)
{
    for (size_t i = 0; i < isolines->asset_count; i++) {
        mem_free(isolines->sets[i].points);
        arrows_finish(&isolines->arrows[i]);
        strokes_finish(&isolines->strokes[i]);
    }
    mem_free(isolines->sets);
    mem_free(isolines->arrows);
    mem_free(isolines->strokes);
}

/* --- points on lines --------------------------------------------------------------------------------------------------------- */

/* State of the search for points on isolines (possible label positions) in one asset. */
struct isoline_search {
    const struct scene_asset *asset;
    const struct fields_entry *field;
    struct isoline_set *set;
    double size_m;
    float slack_m;
    int counts[VIEW_ALL_LINES];
};

static bool is_apart(const struct isoline_search *search, double value, const double place_m[3])
{
    double least_m = SPACING * search->size_m;
    for (size_t i = search->set->count; i-- > 0;) {
        const struct isoline_point *point = &search->set->points[i];
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += (point->place_m[c] - place_m[c]) * (point->place_m[c] - place_m[c]);
        if (point->value == value && square < least_m * least_m)
            return false;
    }
    return true;
}

/* A piece of an edge. */
struct edge_piece {
    float ends_m[2][3]; /* positions of both ends of the piece of an edge, in coordinates of the asset file */
    double values[2];
};

static void between_ends(const struct edge_piece *piece, double part, float out_m[3])
{
    for (int c = 0; c < 3; c++)
        out_m[c] = (float)((double)piece->ends_m[0][c] + part * ((double)piece->ends_m[1][c] - (double)piece->ends_m[0][c]));
}

/* Returns where on a piece of a triangle's edge the field has this value: 0 at the first end, 1 at the second. The value must
   lie between the values at both ends. A field that is evaluated at pixels is not linear along the piece, so the position is
   found by bisection. */
static double part_of_value(const struct isoline_search *search, const struct edge_piece *piece, double value)
{
    double low = 0, high = 1;
    bool rises = piece->values[1] > piece->values[0];
    if (search->field->pixels.count == 0)
        return (value - piece->values[0]) / (piece->values[1] - piece->values[0]);
    for (int i = 0; i < MAX_BISECTIONS; i++) {
        float at_m[3];
        struct pixel_value here;
        between_ends(piece, 0.5 * (low + high), at_m);
        pixel_field_at(&search->field->pixels, at_m, &here);
        *(((double)here.value < value) == rises ? &low : &high) = 0.5 * (low + high);
    }
    return 0.5 * (low + high);
}

static void add_point(struct isoline_search *search, int line, const struct edge_piece *piece)
{
    double value = search->set->lines[line], place_m[3];
    const double *m = search->asset->placement;
    float file_m[3];
    between_ends(piece, part_of_value(search, piece, value), file_m);
    for (int c = 0; c < 3; c++)
        place_m[c] = m[c] * (double)file_m[0] + m[4 + c] * (double)file_m[1] + m[8 + c] * (double)file_m[2] + m[12 + c];
    if (!is_apart(search, value, place_m))
        return;
    struct isoline_set *set = search->set;
    mem_grow(&set->points, &set->capacity, set->count + 1, sizeof(*set->points));
    set->points[set->count++] =
        (struct isoline_point){ .value = value, .place_m = { place_m[0], place_m[1], place_m[2] }, .slack_m = search->slack_m };
    search->counts[line]++;
}

static void search_piece(struct isoline_search *search, const struct edge_piece *piece)
{
    double low = fmin(piece->values[0], piece->values[1]), high = fmax(piece->values[0], piece->values[1]);
    for (int i = 0; i < search->set->line_count; i++)
        if (search->set->lines[i] > low && search->set->lines[i] <= high && search->counts[i] < POINTS_PER_LINE)
            add_point(search, i, piece);
}

/* Searches a triangle's edge for crossings with isolines, for a field that is evaluated at pixels. An isoline may cross a long edge more
   than once, so the edge is searched piece by piece. */
static void search_evaluated(struct isoline_search *search, const struct edge_piece *edge)
{
    double length_m = (double)vecf_distance(edge->ends_m[0], edge->ends_m[1]);
    int pieces = (int)fmin(1 + length_m / (SPACING * search->size_m), MAX_PIECES);
    struct pixel_value before = { .no_data = true };
    struct edge_piece piece;
    for (int i = 0; i <= pieces; i++) {
        struct pixel_value here;
        between_ends(edge, (double)i / pieces, piece.ends_m[1]);
        pixel_field_at(&search->field->pixels, piece.ends_m[1], &here);
        piece.values[0] = (double)before.value;
        piece.values[1] = (double)here.value;
        if (!before.no_data && !here.no_data)
            search_piece(search, &piece);
        memcpy(piece.ends_m[0], piece.ends_m[1], sizeof(piece.ends_m[0]));
        before = here;
    }
}

static void search_edge(struct isoline_search *search, uint32_t a, uint32_t b)
{
    const float(*at)[3] = search->asset->file->view.positions_m;
    const struct scalar *values = search->field->shown;
    struct edge_piece edge = { .values = { (double)values[a].value, (double)values[b].value } };
    memcpy(edge.ends_m[0], at[a], sizeof(edge.ends_m[0]));
    memcpy(edge.ends_m[1], at[b], sizeof(edge.ends_m[1]));
    if (search->field->pixels.count > 0)
        search_evaluated(search, &edge);
    else if (!values[a].no_data && !values[b].no_data)
        search_piece(search, &edge);
}

size_t isolines_vertex_count(const struct scene_asset *asset)
{
    return coarse_level(asset)->vertex_count;
}

static void search_asset(struct isoline_search *search)
{
    const struct asset_view *view = &search->asset->file->view;
    search->size_m = coarse_size_m(search->asset);
    const struct asset_level *level = coarse_level(search->asset);
    search->slack_m = (float)fmax(1.5 * (double)level->error_m, 0.01 * search->size_m);
    search->set->count = 0;
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        const struct asset_primitive *primitive = &view->primitives[level->first_primitive + p];
        const uint32_t *corner = view->indices + primitive->first_index;
        for (uint32_t i = 0; i < primitive->index_count; i += 3) {
            search_edge(search, corner[i], corner[i + 1]);
            search_edge(search, corner[i + 1], corner[i + 2]);
        }
    }
}

static void update_set(struct isoline_set *set, const struct scene_asset *asset, const struct fields_entry *field, const double *lines,
                       int line_count)
{
    size_t bytes = (size_t)line_count * sizeof(*lines);
    if (set->content == field->content && set->line_count == line_count && memcmp(set->lines, lines, bytes) == 0)
        return;
    set->content = field->content;
    set->line_count = line_count;
    memcpy(set->lines, lines, bytes);
    search_asset(&(struct isoline_search){ .asset = asset, .field = field, .set = set });
}

/* --- visibility of points ---------------------------------------------------------------------------------------------------- */

static void collect_lines(struct isolines *isolines, const struct frame_context *context, struct isoline_points *out)
{
    double lines[VIEW_ALL_LINES];
    int line_count = view_lines(context->view, lines);
    for (size_t i = 0; line_count > 0 && i < context->visible_count; i++) {
        int asset = context->visible[i];
        struct isoline_set *set = &isolines->sets[asset];
        if (!context->fields[asset] || !context->fields[asset]->slice)
            continue;
        update_set(set, &context->gpu_scene->scene->assets[asset], context->fields[asset], lines, line_count);
        if (set->count == 0)
            continue;
        if (out->count + set->count > MAX_POINTS)
            break;
        mem_grow(&out->at, &out->capacity, out->count + set->count, sizeof(*out->at));
        for (size_t p = 0; p < set->count; p++)
            if (clip_keeps(&context->view->visibility.clip, set->points[p].place_m))
                out->at[out->count++] = set->points[p];
    }
}

static bool has_directions(const struct fields_entry *field)
{
    return field && field->slice && field->direction_count > 0 && field->params.show == SHOW_VALUE;
}

static void add_arrow(const struct arrow_set *set, size_t place, const struct frame_context *context, int asset, struct isoline_points *out)
{
    const struct scene_asset *of = &context->gpu_scene->scene->assets[asset];
    struct isoline_point point = { .value = arrows_value(set, place, &of->file->view, context->fields[asset]),
                                   .arrow = true,
                                   .uncertain = set->found[place].uncertain,
                                   .slack_m = (float)fmax(1.5 * (double)set->error_m, 0.01 * coarse_size_m(of)) };
    arrows_place(set, place, of, point.place_m, point.along);
    if (!isfinite(point.value) || !clip_keeps(&context->view->visibility.clip, point.place_m))
        return;
    mem_grow(&out->at, &out->capacity, out->count + 1, sizeof(*out->at));
    out->at[out->count++] = point;
}

/* Adds the points of a stroke (short streamline). Where the direction is unknown, adds an arrow instead, which is drawn as a cross. */
static void add_stroke(const struct isolines *isolines, size_t place, const struct frame_context *context, int asset,
                       struct isoline_points *out)
{
    const struct scene_asset *of = &context->gpu_scene->scene->assets[asset];
    const struct arrow_set *arrows = &isolines->arrows[asset];
    const struct stroke_set *set = &isolines->strokes[asset];
    if (place >= set->count || set->lengths[place] == 0) {
        if (!arrows->found[place].known)
            add_arrow(arrows, place, context, asset, out);
        return;
    }
    const uint16_t number = ++out->stroke_count;
    mem_grow(&out->at, &out->capacity, out->count + STROKE_POINTS, sizeof(*out->at));
    for (int n = 0; n < set->lengths[place]; n++) {
        const struct stroke_point *at = &set->points[place][n];
        struct isoline_point point = { .value = arrows_value_at(&at->place, &of->file->view, context->fields[asset]),
                                       .arrow = true,
                                       .uncertain = at->to.uncertain,
                                       .stroke = number,
                                       .slack_m = (float)fmax(1.5 * (double)arrows->error_m, 0.01 * coarse_size_m(of)) };
        arrows_place_at(&at->place, &at->to, of, point.place_m, point.along);
        if (!isfinite(point.value) || !clip_keeps(&context->view->visibility.clip, point.place_m))
            break;
        out->at[out->count++] = point;
    }
}

/* Collects up to MAX_ARROWS arrow positions: first the first position of each asset, then the second of each, and so on. The first n
   positions of an asset are evenly spread for any n (arrows.h), so arrows are spread over every asset. */
static void collect_arrows(struct isolines *isolines, const struct frame_context *context, struct isoline_points *out)
{
    const struct scene *scene = context->gpu_scene->scene;
    const size_t most = out->count + 2 * MAX_POINTS;
    size_t longest = 0;
    /* skips arrows in a view with trial sensor positions (which a user tries out): assets not affected by the trial would still
       show directions from before the trial */
    if (!isolines_has_arrows(scene, context->view))
        return;
    for (size_t i = 0; i < context->visible_count; i++) {
        int asset = context->visible[i];
        if (!has_directions(context->fields[asset]))
            continue;
        arrows_update(&isolines->arrows[asset], scene, asset, context->fields[asset]);
        if (context->view->directions == DIRECTIONS_STROKES)
            strokes_update(&isolines->strokes[asset], &isolines->arrows[asset], scene, asset, context->fields[asset]);
        longest = isolines->arrows[asset].count > longest ? isolines->arrows[asset].count : longest;
    }
    for (size_t place = 0; place < longest && out->count < most; place++)
        for (size_t i = 0; i < context->visible_count && out->count < most; i++) {
            int asset = context->visible[i];
            if (!has_directions(context->fields[asset]) || place >= isolines->arrows[asset].count)
                continue;
            if (context->view->directions == DIRECTIONS_STROKES)
                add_stroke(isolines, place, context, asset, out);
            else
                add_arrow(&isolines->arrows[asset], place, context, asset, out);
        }
}

bool isolines_has_arrows(const struct scene *scene, const struct view *view)
{
    return view->look != LOOK_MATERIALS && view->directions != DIRECTIONS_NONE && view->field.show == SHOW_VALUE && !view->field.trial &&
           scene->plant->groups[view->field.group].directed;
}

void isolines_collect(struct isolines *isolines, const struct frame_context *context, struct isoline_points *out)
{
    collect_lines(isolines, context, out);
    collect_arrows(isolines, context, out);
}

/* Writes the eye-space positions and depth tolerances of isoline points and arrows, which the visibility test reads. */
static void fill_places(const struct frame_context *context, const struct isoline_points *points, float (*places)[4])
{
    for (size_t i = 0; i < points->count; i++) {
        for (int c = 0; c < 3; c++)
            places[i][c] = (float)(points->at[i].place_m[c] - context->constants.eye_m[c]);
        places[i][3] = points->at[i].slack_m;
    }
}

bool isolines_start(struct point_visibility *queries, const struct frame_context *context, const struct isoline_points *points)
{
    size_t count = points->count;
    if (count == 0)
        return true;
    float(*places)[4] = point_visibility_reserve(queries, context->gpu_scene->gl, count);
    if (!places)
        return false;
    fill_places(context, points, places);
    return point_visibility_start(queries, context, count);
}

/* Returns whether the frame may get another label at this point. Labels are sent with each frame, so a minimum distance between
   them limits their number. It is larger between labels of one isoline. */
static bool has_room(const struct frame *frame, const float place[4], const struct isoline_point *point)
{
    double lines_px = fmax(40, frame->width_px / 32.0), arrows_px = FRAME_ARROW_PX(frame->width_px);
    int count = 0;
    for (size_t i = 0; i < frame->label_count; i++) {
        const struct frame_label *label = &frame->labels[i];
        double away_px = hypot((double)(label->x_px - place[0]), (double)(label->y_px - place[1]));
        if (label->arrow != point->arrow)
            continue;
        if (away_px < (point->arrow ? arrows_px : label->value == point->value ? SAME_LINE_FACTOR * lines_px : lines_px))
            return false;
        count++;
    }
    return count < (point->arrow ? MAX_ARROWS : MAX_LABELS);
}

/* Projects a unit vector at the point into the frame. Its length becomes 1 if it is parallel to the image plane, and less if it
   points towards or away from the viewer. */
static void project_arrow(const struct frame_context *context, const struct isoline_point *point, struct frame_label *label)
{
    const struct view_constants *constants = &context->constants;
    double from[3], to[3], from_clip[4], to_clip[4];
    vec_sub(point->place_m, constants->eye_m, from);
    double away_m = fmax(vec_length(from), 1e-6), step_m = 1e-3 * away_m;
    for (int c = 0; c < 3; c++)
        to[c] = from[c] + step_m * point->along[c];
    matrix_point(constants->clip_from_eye, from, from_clip);
    matrix_point(constants->clip_from_eye, to, to_clip);
    if (!(from_clip[3] > 0 && to_clip[3] > 0))
        return;
    double scale_px = constants->pixel_per_metre > 0 ? constants->pixel_per_metre : constants->pixel_per_radian / from_clip[3];
    double dx = 0.5 * (to_clip[0] / to_clip[3] - from_clip[0] / from_clip[3]) * context->view->width_px / (scale_px * step_m);
    double dy = -0.5 * (to_clip[1] / to_clip[3] - from_clip[1] / from_clip[3]) * context->view->height_px / (scale_px * step_m);
    double length = fmax(hypot(dx, dy), 1);
    label->dx = (float)(round(100 * dx / length) / 100);
    label->dy = (float)(round(100 * dy / length) / 100);
    /* the arrow points straight towards or away from the eye; a tiny length other than 0 shows that its direction is known */
    if (label->dx == 0 && label->dy == 0 && vec_length(point->along) > 0)
        label->dx = dx < 0 ? -0.01f : 0.01f;
}

/* State while the points of one stroke (short streamline) are added to the frame. Only the first sequence of consecutive visible points is
   drawn. */
struct emitted_stroke {
    uint16_t stroke;
    bool begun, ended;
    int count;
};

/* Returns whether this point of a stroke (short streamline) is added to the frame. The first points of strokes keep the same minimum
   distance from each other as arrows. */
static bool on_stroke(struct emitted_stroke *stroke, const struct frame *frame, const float place[4], const struct isoline_point *point)
{
    if (point->stroke != stroke->stroke)
        *stroke = (struct emitted_stroke){ .stroke = point->stroke, .count = stroke->count };
    bool hidden = place[2] >= 0.5f, begins = !stroke->begun;
    if (stroke->ended || (hidden && begins))
        return false;
    stroke->ended = hidden;
    if (hidden || !begins)
        return !hidden;
    stroke->begun = true;
    for (size_t i = 0; i < frame->label_count; i++) {
        const struct frame_label *label = &frame->labels[i];
        bool first = i == 0 || label->stroke == 0 || frame->labels[i - 1].stroke != label->stroke;
        if (label->arrow && first &&
            hypot((double)(label->x_px - place[0]), (double)(label->y_px - place[1])) < FRAME_ARROW_PX(frame->width_px))
            stroke->ended = true;
    }
    stroke->ended |= stroke->count == MAX_STROKES;
    stroke->count += !stroke->ended;
    return !stroke->ended;
}

/* Removes the last stroke (short streamline) from the frame if only one of its points is visible. */
static void drop_short_stroke(struct frame *frame, uint16_t next)
{
    const size_t count = frame->label_count;
    const struct frame_label *last = count > 0 ? &frame->labels[count - 1] : NULL;
    if (last && last->stroke != 0 && last->stroke != next && (count < 2 || frame->labels[count - 2].stroke != last->stroke))
        frame->label_count--;
}

/* Adds labels for the visible points to the frame. places: result of the visibility test, by point: x and y in pixels, then 1 if hidden,
   else 0. */
static void emit_labels(const struct frame_context *context, const struct isoline_points *points, float (*places)[4], struct frame *frame)
{
    struct emitted_stroke stroke = { 0 };
    frame->labels = mem_array(points->count, sizeof(*frame->labels));
    for (size_t i = 0; i < points->count; i++) {
        const struct isoline_point *point = &points->at[i];
        drop_short_stroke(frame, point->stroke);
        bool seen = point->stroke ? on_stroke(&stroke, frame, places[i], point) : places[i][2] < 0.5f && has_room(frame, places[i], point);
        if (!seen)
            continue;
        struct frame_label *label = &frame->labels[frame->label_count++];
        *label = (struct frame_label){ .value = point->value,
                                       .x_px = roundf(10 * places[i][0]) / 10,
                                       .y_px = roundf(10 * places[i][1]) / 10,
                                       .arrow = point->arrow,
                                       .uncertain = point->uncertain,
                                       .stroke = point->stroke };
        if (point->arrow)
            project_arrow(context, point, label);
    }
    drop_short_stroke(frame, 0);
}

void isolines_get(const struct point_visibility *queries, const struct frame_context *context, const struct isoline_points *points,
                  struct frame *frame)
{
    if (points->count > 0)
        emit_labels(context, points, queries->places, frame);
}

void isolines_find(const struct frame_context *context, const struct isoline_points *points, const float *depth, size_t pitch_px,
                   struct frame *frame)
{
    if (points->count == 0)
        return;
    float(*places)[4] = mem_array(points->count, sizeof(*places));
    fill_places(context, points, places);
    for (size_t i = 0; i < points->count; i++)
        markers_look(context, depth, pitch_px, places[i]);
    emit_labels(context, points, places, frame);
    mem_free(places);
}
