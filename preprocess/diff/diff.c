/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two revisions of a plant, one asset after the other. */
#include "preprocess/diff/diff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "base/text/utf8.h"
#include "plant/models/transform.h"
#include "preprocess/diff/diff_shape.h"
#include "preprocess/pipeline/prepare.h"

#define TOLERANCE_M 0.01
#define TOLERANCE_OF_SIZE 0.01

const char *const diff_changes[DIFF_CHANGES] = { "same", "added", "removed", "moved", "changed", "unknown" };

struct pair_half { /* an asset in one of the two revisions that are compared */
    const struct diff_side_asset *asset;
    struct diff_side_shape shape;
    struct diff_shape *tree;
    double to_plant[16]; /* transform from the frame of the asset's triangles to the plant frame */
};

struct asset_pair {
    struct pair_half old_half, new_half;
    struct pair_half *former; /* old revision of the asset from which a tag last moved to another asset; asset NULL: none yet */
    struct diff_asset found;
    double tolerance_m, limit_m;
};

static void orphan(struct diff *diff, const char *tag, const char *asset, char *why)
{
    mem_grow(&diff->orphans, &diff->orphan_room, diff->orphan_count + 1, sizeof(*diff->orphans));
    diff->orphans[diff->orphan_count++] = (struct diff_orphan){ .tag = tag, .asset = asset, .why = why };
}

static void add_asset(struct diff *diff, struct diff_asset asset)
{
    mem_grow(&diff->assets, &diff->asset_room, diff->asset_count + 1, sizeof(*diff->assets));
    diff->assets[diff->asset_count++] = asset;
}

static struct diff_side_asset *find_asset(const struct diff_side *side, const char *id)
{
    for (size_t i = 0; i < side->asset_count; i++)
        if (strcmp(side->assets[i].id, id) == 0)
            return &side->assets[i];
    return NULL;
}

static int by_model(const void *a, const void *b)
{
    const struct diff_side_asset *const *p = a, *const *q = b;
    return (*p)->work != (*q)->work ? ((*p)->work < (*q)->work ? -1 : 1) : *p < *q ? -1 : *p > *q;
}

/* --- one asset ------------------------------------------------------------------------------------------------------------------- */

/* Returns false with the reason in why if the asset has no shape. If this is because a file cannot be read, adds an error to
 * diff->diag, once for each asset. */
static bool half_open(struct diff *diff, struct pair_half *half, struct diff_side *side, struct diff_side_asset *asset,
                      char why[MODEL_WHY_BYTES])
{
    half->asset = asset;
    if (!diff_side_shape(side, asset, &half->shape, why)) {
        if (half->shape.unreadable && !asset->reported)
            diag_error(diff->diag, side->path, 0, 0, "asset %s: %s", asset->id, why);
        asset->reported |= half->shape.unreadable;
        return false;
    }
    half->tree = diff_shape_create(&half->shape);
    double from_origin[16];
    memcpy(from_origin, transform_identity, sizeof(from_origin));
    memcpy(from_origin + 12, half->shape.origin_m, sizeof(half->shape.origin_m));
    transform_multiply(asset->placement, from_origin, half->to_plant);
    return true;
}

static void half_close(struct pair_half *half)
{
    diff_shape_destroy(&half->tree);
    diff_side_shape_finish(&half->shape);
}

static bool equal_shapes(const struct diff_side_shape *a, const struct diff_side_shape *b)
{
    return a->vertex_count == b->vertex_count && a->index_count == b->index_count &&
           memcmp(a->positions_m, b->positions_m, a->vertex_count * sizeof(*a->positions_m)) == 0 &&
           memcmp(a->indices, b->indices, a->index_count * sizeof(*a->indices)) == 0;
}

/* Computes the motion of the asset from its old to its new position, in the plant frame. new_to_old: motion that maps the new
 * shape to the old one, each in its own frame. */
static void plant_motion(const struct asset_pair *pair, const double new_to_old[16], double motion[16])
{
    double plant_to_old[16], old_to_new[16], step[16];
    transform_invert(pair->old_half.to_plant, plant_to_old);
    transform_invert(new_to_old, old_to_new);
    transform_multiply(pair->new_half.to_plant, old_to_new, step);
    transform_multiply(step, plant_to_old, motion);
}

/* Returns the largest movement, in metres, of a corner of the old asset's bounding box. */
static double moved_by(const struct asset_pair *pair, const double new_to_old[16], double *turned_deg)
{
    double motion[16], plant_to_old[16], step[16], local[16];
    plant_motion(pair, new_to_old, motion);
    *turned_deg = diff_turned_deg(motion);
    transform_invert(pair->old_half.to_plant, plant_to_old);
    transform_multiply(motion, pair->old_half.to_plant, step);
    transform_multiply(plant_to_old, step, local);
    return diff_shape_moved(pair->old_half.tree, local);
}

/* Returns whether the old shape and the new shape moved by new_to_old are equal: the asset is then unchanged, or only moved. */
static bool same_shape(struct asset_pair *pair, const double new_to_old[16], bool equal)
{
    if (!equal && diff_shape_apart(pair->old_half.tree, pair->new_half.tree, new_to_old, pair->tolerance_m) > pair->tolerance_m)
        return false;
    pair->found.moved_m = moved_by(pair, new_to_old, &pair->found.turned_deg);
    pair->found.change = pair->found.moved_m > pair->tolerance_m ? DIFF_MOVED : DIFF_SAME;
    return true;
}

static void compare_shapes(struct asset_pair *pair)
{
    const struct pair_half *old_half = &pair->old_half, *new_half = &pair->new_half;
    double in_place[16], plant_to_old[16], turned[16], middle_old[3], middle_new[3];
    bool equal = equal_shapes(&old_half->shape, &new_half->shape);
    transform_invert(old_half->to_plant, plant_to_old);
    /* transform from the new shape's frame to the old shape's frame, with both at their positions in the plant */
    transform_multiply(plant_to_old, new_half->to_plant, in_place);
    transform_point(old_half->to_plant, (const double[3]){ 0, 0, 0 }, middle_old);
    transform_point(new_half->to_plant, (const double[3]){ 0, 0, 0 }, middle_new);
    vec_sub(middle_new, middle_old, pair->found.move_m);
    pair->found.triangles[0] = old_half->shape.index_count / 3;
    pair->found.triangles[1] = new_half->shape.index_count / 3;
    if (same_shape(pair, transform_identity, equal) || same_shape(pair, in_place, false))
        return;
    if (diff_shape_motion(old_half->tree, new_half->tree, turned) && same_shape(pair, turned, false))
        return;
    pair->found.change = DIFF_CHANGED;
    pair->found.apart_m = min_of(diff_shape_apart(old_half->tree, new_half->tree, transform_identity, 0),
                                 diff_shape_apart(old_half->tree, new_half->tree, in_place, 0));
    pair->found.moved_m = sqrt(vec_dot(pair->found.move_m, pair->found.move_m));
}

/* --- its sensors ------------------------------------------------------------------------------------------------------------------ */

static bool has_place(const struct diff_side_shape *shape, size_t column)
{
    return column < shape->sensor_count && !isnan(shape->places_m[column][0]);
}

/* Computes the position of sensor `column` of an asset and of the surface point nearest to it, in the plant frame. Returns the distance
 * between them, metres. */
static double place_sensor(const struct pair_half *half, size_t column, double place_m[3], double surface_m[3])
{
    double nearest_m[3];
    double distance_m = diff_shape_nearest(half->tree, half->shape.places_m[column], nearest_m);
    transform_point(half->to_plant, half->shape.places_m[column], place_m);
    transform_point(half->to_plant, nearest_m, surface_m);
    return distance_m;
}

/* Returns how far the surface at a sensor moved between the revisions, metres. For a sensor on the axis of a pipe, many surface
 * points are equally near, and rounding decides which one is found. So the surface also counts as unmoved if it passes through
 * the old nearest point and that point is about as near as the new one. */
static double surface_moved(const struct asset_pair *pair, const double place_m[3], const double old_m[3], const double new_m[3])
{
    double plant_to_new[16], at[3], still_m[3], moved_m = vec_distance(old_m, new_m);
    if (moved_m <= pair->tolerance_m || !transform_invert(pair->new_half.to_plant, plant_to_new))
        return moved_m;
    transform_point(plant_to_new, old_m, at);
    diff_shape_nearest(pair->new_half.tree, at, still_m);
    transform_point(pair->new_half.to_plant, still_m, still_m);
    bool as_near = vec_distance(place_m, still_m) <= vec_distance(place_m, new_m) + pair->tolerance_m;
    return as_near ? min_of(moved_m, vec_distance(old_m, still_m)) : moved_m;
}

/* Compares a sensor's position and the surface under it. old_half: the sensor's asset in the old revision. */
static void compare_place(const struct asset_pair *pair, const struct pair_half *old_half, const struct diff_side_tag *before,
                          const double place_m[3], const double surface_m[3], struct diff_sensor *found)
{
    double old_place_m[3], old_surface_m[3];
    found->moved_m = found->place_moved_m = found->distance_m[0] = NAN;
    if (!old_half->tree || !has_place(&old_half->shape, before->column))
        return;
    found->distance_m[0] = place_sensor(old_half, before->column, old_place_m, old_surface_m);
    found->moved_m = surface_moved(pair, place_m, old_surface_m, surface_m);
    found->place_moved_m = vec_distance(old_place_m, place_m);
    found->far_moved = found->moved_m > pair->tolerance_m;
}

/* Returns the old revision of the asset from which a tag has moved to another asset. Keeps it open for the next tag. */
static const struct pair_half *open_former(struct diff *diff, struct pair_half *former, struct diff_side_asset *asset)
{
    char ignored[MODEL_WHY_BYTES];
    if (former->asset == asset)
        return former;
    half_close(former);
    *former = (struct pair_half){ 0 };
    half_open(diff, former, &diff->old_side, asset, ignored);
    return former;
}

struct placed_tag {                           /* a tag in both revisions */
    const struct diff_side_tag *tag, *before; /* before: the tag in the old revision; NULL: it was no sensor */
    struct diff_side_asset *from;             /* asset of the tag in the old revision; NULL: the same asset, or none */
};

static void compare_sensor(struct diff *diff, struct asset_pair *pair, const struct placed_tag *placed)
{
    const struct diff_side_tag *tag = placed->tag;
    const struct diff_side_shape *shape = &pair->new_half.shape;
    double place_m[3], surface_m[3];
    if (!has_place(shape, tag->column)) {
        const char *why = tag->column < shape->sensor_count ? shape->whys[tag->column] : NULL;
        orphan(diff, tag->name, tag->asset,
               mem_strdup(why ? why : "the prepared file of the asset does not contain this sensor: run plantcast-prep again"));
        return;
    }
    struct diff_sensor found = { .tag = tag->name, .asset = tag->asset, .limit_m = pair->limit_m, .tolerance_m = pair->tolerance_m };
    found.distance_m[1] = place_sensor(&pair->new_half, tag->column, place_m, surface_m);
    bool was = placed->before;
    if (was) {
        found.old_asset = placed->from ? placed->from->id : NULL;
        compare_place(pair, placed->from ? open_former(diff, pair->former, placed->from) : &pair->old_half, placed->before, place_m,
                      surface_m, &found);
        mem_grow(&diff->sensors, &diff->sensor_room, diff->sensor_count + 1, sizeof(*diff->sensors));
        diff->sensors[diff->sensor_count++] = found;
        was = !isnan(found.distance_m[0]);
    }
    if (found.distance_m[1] > found.limit_m && (!was || found.distance_m[0] <= found.limit_m))
        orphan(diff, tag->name, tag->asset,
               mem_printf("the sensor is %.3f m from the surface of its asset (limit: %.3f m)%s", found.distance_m[1], found.limit_m,
                          was ? "; before, the sensor was on the surface" : ""));
}

static int by_old_asset(const void *a, const void *b)
{
    const struct placed_tag *p = a, *q = b;
    if (p->from == q->from)
        return p->tag < q->tag ? -1 : p->tag > q->tag;
    return !p->from || !q->from ? (p->from ? 1 : -1) : by_model(&p->from, &q->from);
}

/* Compares the sensors of an asset. Sensors that come from other assets are sorted by these assets, so that this call opens each
 * old asset only once. A call for another asset opens the old assets again, except the one that was opened last. */
static void compare_sensors(struct diff *diff, struct asset_pair *pair)
{
    struct placed_tag *placed = mem_array(diff->new_side.tag_count, sizeof(*placed));
    size_t count = 0;
    for (size_t i = 0; i < diff->new_side.tag_count; i++) {
        const struct diff_side_tag *tag = &diff->new_side.tags[i], *before;
        if (!tag->is_sensor || strcmp(tag->asset, pair->found.id) != 0)
            continue;
        before = diff_side_find_tag(&diff->old_side, tag->name);
        before = before && before->is_sensor ? before : NULL;
        bool same = !before || strcmp(before->asset, tag->asset) == 0;
        placed[count++] = (struct placed_tag){ tag, before, same ? NULL : find_asset(&diff->old_side, before->asset) };
    }
    qsort(placed, count, sizeof(*placed), by_old_asset);
    for (size_t i = 0; i < count; i++)
        compare_sensor(diff, pair, &placed[i]);
    mem_free(placed);
}

/* Searches the new model for a node with another name that has the old asset's shape at the old position. If there is one,
   writes its name to `why`, in place of a guess ("did you mean ...") by similar names. Otherwise leaves `why` unchanged. */
static void find_renamed(struct diff *diff, const struct asset_pair *pair, const struct diff_side_asset *asset, double tolerance_m,
                         char *why)
{
    struct diff_side_box box;
    diff_shape_box(pair->old_half.tree, box.low_m, box.high_m);
    for (int axis = 0; axis < 3; axis++) {
        box.low_m[axis] += pair->old_half.shape.origin_m[axis];
        box.high_m[axis] += pair->old_half.shape.origin_m[axis];
    }
    double limit_m = tolerance_m > 0 ? tolerance_m : fmin(TOLERANCE_M, TOLERANCE_OF_SIZE * diff_shape_diagonal(pair->old_half.tree));
    for (uint32_t after = 0;; after++) {
        struct pair_half half = { 0 };
        char name[200], cut_why[MODEL_WHY_BYTES], *guess = strstr(why, ": did you mean ");
        if (!diff_side_node_in_box(&diff->new_side, asset, &box, limit_m, &after, name, sizeof(name)))
            return;
        bool same = diff_side_shape_of_node(&diff->new_side, asset, after, &half.shape, cut_why);
        if (same) {
            double apart[16], offset_m[3];
            half.tree = diff_shape_create(&half.shape);
            vec_sub(half.shape.origin_m, pair->old_half.shape.origin_m, offset_m);
            memcpy(apart, transform_identity, sizeof(apart));
            memcpy(apart + 12, offset_m, sizeof(offset_m));
            same = diff_shape_apart(pair->old_half.tree, half.tree, apart, limit_m) <= limit_m;
        }
        half_close(&half);
        if (!same)
            continue;
        if (guess)
            *guess = 0;
        size_t length = strlen(why);
        snprintf(why + length, MODEL_WHY_BYTES - length, ": node %s has the same shape at the same place", name);
        utf8_drop_invalid(why); /* the shortened name may end inside a character */
        return;
    }
}

/* Reports the tags whose asset is in the new plant file but missing from the new model. */
static void lose_sensors(struct diff *diff, const char *id, const char *why)
{
    for (size_t i = 0; i < diff->new_side.tag_count; i++) {
        const struct diff_side_tag *tag = &diff->new_side.tags[i];
        if (tag->is_sensor && strcmp(tag->asset, id) == 0)
            orphan(diff, tag->name, tag->asset, mem_printf("asset %s is missing: %s", id, why));
    }
}

/* Compares an asset that has a shape in the new revision. was: it also has one in the old revision. */
static void compare_present(struct diff *diff, struct asset_pair *pair, bool was, double tolerance_m)
{
    double diagonal_m = diff_shape_diagonal(pair->new_half.tree);
    pair->limit_m = prepare_far_m(diagonal_m);
    pair->tolerance_m = tolerance_m > 0 ? tolerance_m : fmin(TOLERANCE_M, TOLERANCE_OF_SIZE * diagonal_m);
    pair->found.tolerance_m = pair->tolerance_m;
    pair->found.change = DIFF_ADDED;
    pair->found.triangles[1] = pair->new_half.shape.index_count / 3;
    if (was)
        compare_shapes(pair);
    compare_sensors(diff, pair);
}

static void compare_asset(struct diff *diff, struct pair_half *former, struct diff_side_asset *new_asset, double tolerance_m)
{
    struct asset_pair pair = { .former = former, .found.id = new_asset->id };
    struct diff_side_asset *old_asset = find_asset(&diff->old_side, new_asset->id);
    char why[MODEL_WHY_BYTES], old_why[MODEL_WHY_BYTES];
    bool was = old_asset && half_open(diff, &pair.old_half, &diff->old_side, old_asset, old_why);
    bool is = half_open(diff, &pair.new_half, &diff->new_side, new_asset, why);
    bool unreadable = pair.old_half.shape.unreadable || pair.new_half.shape.unreadable;
    if (is) {
        compare_present(diff, &pair, was, tolerance_m);
    } else if (!pair.new_half.shape.unreadable) {
        if (was)
            find_renamed(diff, &pair, new_asset, tolerance_m, why);
        lose_sensors(diff, new_asset->id, why);
    }
    if (unreadable) {
        pair.found.change = DIFF_UNKNOWN;
        pair.found.why = mem_strdup(pair.new_half.shape.unreadable ? why : old_why);
    } else if (was && !is) {
        pair.found.change = DIFF_REMOVED;
        pair.found.why = mem_strdup(why);
    }
    if (was || is || unreadable)
        add_asset(diff, pair.found);
    half_close(&pair.old_half);
    half_close(&pair.new_half);
}

/* --- the comparison ---------------------------------------------------------------------------------------------------------------- */

/* Compares the new plant's assets, model by model, so that each model is parsed only once. */
static void compare_assets(struct diff *diff, double tolerance_m)
{
    const struct diff_side *now = &diff->new_side;
    struct pair_half former = { 0 };
    struct diff_side_asset **order = mem_array(now->asset_count, sizeof(*order));
    for (size_t i = 0; i < now->asset_count; i++)
        order[i] = &now->assets[i];
    qsort(order, now->asset_count, sizeof(*order), by_model);
    for (size_t i = 0; i < now->asset_count; i++)
        compare_asset(diff, &former, order[i], tolerance_m);
    mem_free(order);
    half_close(&former);
    for (size_t i = 0; i < diff->old_side.asset_count; i++)
        if (!find_asset(now, diff->old_side.assets[i].id))
            add_asset(diff, (struct diff_asset){ .id = diff->old_side.assets[i].id, .change = DIFF_REMOVED });
}

static void compare_tags(struct diff *diff)
{
    const struct diff_side *before = &diff->old_side, *now = &diff->new_side;
    for (size_t i = 0; i < now->tag_count; i++) {
        const struct diff_side_tag *tag = &now->tags[i];
        if (*tag->asset && !tag->is_sensor && !find_asset(now, tag->asset))
            orphan(diff, tag->name, tag->asset, mem_printf("asset %s is not in the plant file", tag->asset));
        const struct diff_side_tag *was = diff_side_find_tag(before, tag->name);
        if (tag->is_sensor && (!was || !was->is_sensor)) {
            mem_grow(&diff->tags_added, &diff->added_room, diff->added_count + 1, sizeof(*diff->tags_added));
            diff->tags_added[diff->added_count++] = tag->name;
        }
    }
    for (size_t i = 0; i < before->tag_count; i++) {
        const struct diff_side_tag *was = &before->tags[i], *tag = was->is_sensor ? diff_side_find_tag(now, was->name) : NULL;
        if (was->is_sensor && !tag) {
            mem_grow(&diff->tags_removed, &diff->removed_room, diff->removed_count + 1, sizeof(*diff->tags_removed));
            diff->tags_removed[diff->removed_count++] = was->name;
        } else if (tag && !tag->is_sensor && !*tag->asset) {
            orphan(diff, tag->name, was->asset, mem_printf("the tag list no longer gives an asset for this tag (before: %s)", was->asset));
        } else if (tag && !tag->is_sensor && find_asset(now, tag->asset)) {
            orphan(diff, tag->name, tag->asset, mem_strdup("the tag no longer belongs to a group"));
        }
    }
}

bool diff_run(struct diff *diff, const char *old_path, const char *new_path, double tolerance_m, struct diag *diag)
{
    *diff = (struct diff){ .diag = diag };
    bool good = diff_side_open(&diff->old_side, old_path, diag);
    good = diff_side_open(&diff->new_side, new_path, diag) && good;
    if (good) {
        compare_assets(diff, tolerance_m);
        compare_tags(diff);
    }
    return good;
}

void diff_finish(struct diff *diff)
{
    for (size_t i = 0; i < diff->asset_count; i++)
        mem_free(diff->assets[i].why);
    for (size_t i = 0; i < diff->orphan_count; i++)
        mem_free(diff->orphans[i].why);
    mem_free(diff->assets);
    mem_free(diff->sensors);
    mem_free(diff->orphans);
    mem_free(diff->tags_added);
    mem_free(diff->tags_removed);
    diff_side_finish(&diff->old_side);
    diff_side_finish(&diff->new_side);
}
