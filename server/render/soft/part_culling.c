/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which parts of which assets a picture may show, and where in it. */
#include <float.h>
#include <math.h>

#include "base/mem.h"
#include "render/soft/tile.h"
#include "render/soft/lanes.h"
#include "render/matrix.h"
#include "render/gl/ghosts.h"

#define SLACK_PX 0.02f    /* boxes and vertices round differently */
#define SLACK_DEPTH 1e-5f /* of it */
#define BEFORE 2.0f       /* nearer than the near plane */

/* Where a box may be in the picture. False: outside. */
SOFT_INLINE bool project(const struct soft *soft, const struct soft_mesh *mesh, const float low[3], const float high[3],
                         struct soft_rect *rect, float *near)
{
    const lanes_int right = { 0, -1, 0, -1, 0, -1, 0, -1 }, upper = { 0, 0, -1, -1, 0, 0, -1, -1 }, front = { 0, 0, 0, 0, -1, -1, -1, -1 };
    lanes none = { 0 }, at[4];
    lanes x = lanes_choose(right, none + high[0], none + low[0]), y = lanes_choose(upper, none + high[1], none + low[1]);
    lanes z = lanes_choose(front, none + high[2], none + low[2]);
    for (int r = 0; r < 4; r++)
        at[r] = mesh->place[0][r] * x + mesh->place[1][r] * y + mesh->place[2][r] * z + mesh->place[3][r];
    *rect = (struct soft_rect){ 0, 0, soft->width_px - 1, soft->height_px - 1 };
    *near = BEFORE;
    if (lanes_any((at[3] <= 0.0f) | (at[2] > at[3])))
        return lanes_any((at[3] > 0.0f) & (at[2] <= at[3])) != 0;
    lanes over = 1.0f / at[3], px = at[0] * over, py = at[1] * over, depth = at[2] * over;
    float left = px[0], last = px[0], top = py[0], bottom = py[0], nearest = depth[0];
    for (int i = 1; i < LANES; i++) {
        left = px[i] < left ? px[i] : left;
        last = px[i] > last ? px[i] : last;
        top = py[i] < top ? py[i] : top;
        bottom = py[i] > bottom ? py[i] : bottom;
        nearest = depth[i] > nearest ? depth[i] : nearest;
    }
    const float slack = SLACK_PX + soft->reach_px;
    left += 0.5f - slack; /* whose middles lie within */
    top += 0.5f - slack;
    last += 0.5f + slack;
    bottom += 0.5f + slack;
    if (last < 1 || bottom < 1 || left >= (float)soft->width_px || top >= (float)soft->height_px || nearest < 0)
        return false;
    rect->left = left > 0 ? (int)left : 0;
    rect->top = top > 0 ? (int)top : 0;
    rect->right = last < (float)soft->width_px ? (int)last - 1 : rect->right;
    rect->bottom = bottom < (float)soft->height_px ? (int)bottom - 1 : rect->bottom;
    *near = nearest * (1 + SLACK_DEPTH);
    return rect->left <= rect->right && rect->top <= rect->bottom;
}

static void include(struct soft_rect *rect, const struct soft_rect *other)
{
    rect->left = other->left < rect->left ? other->left : rect->left;
    rect->top = other->top < rect->top ? other->top : rect->top;
    rect->right = other->right > rect->right ? other->right : rect->right;
    rect->bottom = other->bottom > rect->bottom ? other->bottom : rect->bottom;
}

/* Nothing of the part is left, nor does it bound what is. */
static bool is_cut_away(const struct soft *soft, const struct soft_mesh *mesh, const struct asset_cluster *box, struct soft_item *item)
{
    item->cut = item->beyond = false;
    for (int p = 0; p < soft->cut_count && mesh->cut; p++) {
        bool away = soft_cuts_box(soft, mesh, p, box->low_m, box->high_m, &item->cut);
        if (away && (p < soft->entry_count || !soft->counts_bodies))
            return true;
        item->beyond |= away;
    }
    return false;
}

SOFT_KERNEL static void find_parts(const struct soft *soft, const struct soft_mesh *mesh, struct soft_found *found)
{
    found->count = 0;
    found->rect = (struct soft_rect){ INT16_MAX, INT16_MAX, -1, -1 };
    for (uint32_t p = 0; p < found->parts->part_count; p++) {
        const struct soft_part *part = &found->parts->parts[p];
        struct soft_item *item = &found->items[found->count];
        if (!part->double_sided && !found->both_sides && !mesh->mirrored && asset_cluster_turned_away(&part->cluster, found->eye_m))
            continue;
        if (!project(soft, mesh, part->cluster.low_m, part->cluster.high_m, &item->rect, &item->near))
            continue;
        if (is_cut_away(soft, mesh, &part->cluster, item))
            continue;
        item->part = p;
        include(&found->rect, &item->rect);
        found->count++;
    }
}

static void find_meshes(void *arg, size_t begin, size_t end)
{
    struct soft *soft = arg;
    for (size_t m = begin; m < end; m++) {
        struct soft_found *found = &soft->found[m];
        mem_grow(&found->items, &found->capacity, found->parts->part_count, sizeof(*found->items));
        find_parts(soft, &soft->meshes[m], found);
    }
}

/* NULL: out of memory. */
static const struct soft_parts *parts_of(struct soft *soft, const struct model *model, const struct model_level *level)
{
    struct soft_parts **of_model = &soft->keeper->parts[model - soft->gpu_scene->models];
    if (!*of_model)
        *of_model = mem_array(model->level_count, sizeof(**of_model));
    struct soft_parts *parts = &(*of_model)[level - model->levels];
    if (!parts->parts && !soft_parts_init(parts, &model->file->view, level)) {
        soft_parts_finish(parts);
        return NULL;
    }
    return parts;
}

/* Whose side of a surface is seen. In an orthographic picture all rays are parallel: far enough away for floats not to tell. */
static void find_eye(const struct soft *soft, double eye_m[3])
{
    const struct view_constants *constants = &soft->context->constants;
    for (int c = 0; c < 3; c++)
        eye_m[c] = constants->pixel_per_metre > 0 ? soft->gpu_scene->middle_m[c] + 1e6 * soft->gpu_scene->radius_m * constants->back[c]
                                                  : constants->eye_m[c];
}

/* An asset, its vertices counted on from soft->vertex_count. */
static void fill_mesh(struct soft *soft, struct soft_mesh *mesh, int index, const struct model_level *level)
{
    const struct frame_context *context = soft->context;
    const struct scene_asset *asset = &context->gpu_scene->scene->assets[index];
    double clip[16], half[2] = { 0.5 * soft->width_px, 0.5 * soft->height_px };
    *mesh = (struct soft_mesh){
        .asset = index,
        .file = &asset->file->view,
        .has_field = context->fields[index] != NULL,
        .scalars = context->fields[index] ? context->fields[index]->shown : NULL,
        .baked = (const uint8_t(*)[4])soft->light->baked[index],
        .first_vertex = (uint32_t)soft->vertex_count,
        .vertex_count = level->vertex_count,
        .mirrored = scene_asset_mirrored(asset),
        .cut = clip_touches(&context->view->visibility.clip, asset->bounds_min_m, asset->bounds_max_m),
    };
    if (mesh->cut)
        matrix_normals(asset->placement, mesh->turn);
    matrix_multiply(context->constants.clip_from_plant, asset->placement, clip);
    view_constants_bring_forward(&context->constants, asset, clip);
    for (int c = 0; c < 4; c++) {
        mesh->place[c][0] = (float)(half[0] * (clip[4 * c + 3] + clip[4 * c]) - (double)soft->shift_px[0] * clip[4 * c + 3]);
        mesh->place[c][1] = (float)(half[1] * (clip[4 * c + 3] - clip[4 * c + 1]) - (double)soft->shift_px[1] * clip[4 * c + 3]);
        mesh->place[c][2] = (float)clip[4 * c + 2];
        mesh->place[c][3] = (float)clip[4 * c + 3];
    }
    soft->vertex_count += level->vertex_count;
}

static bool add_asset(struct soft *soft, int asset, const struct model_level *level, bool both_sides)
{
    const struct model *model = soft->gpu_scene->of_asset[asset];
    double file_from_plant[16], eye_m[3], eye[4];
    mem_grow(&soft->meshes, &soft->mesh_capacity, soft->mesh_count + 1, sizeof(*soft->meshes));
    mem_grow(&soft->found, &soft->found_capacity, soft->mesh_count + 1, sizeof(*soft->found));
    const struct soft_mesh *mesh = &soft->meshes[soft->mesh_count];
    fill_mesh(soft, &soft->meshes[soft->mesh_count], asset, level);
    struct soft_found *found = &soft->found[soft->mesh_count++];
    found->parts = parts_of(soft, model, level);
    found->material = soft->material_of_model[model - soft->gpu_scene->models];
    found->both_sides = both_sides || mesh->cut; /* the inner side of what is cut shows */
    matrix_invert(soft->gpu_scene->scene->assets[asset].placement, file_from_plant);
    find_eye(soft, eye_m);
    matrix_point(file_from_plant, eye_m, eye);
    for (int c = 0; c < 3; c++)
        found->eye_m[c] = (float)eye[c];
    soft->blends |= found->parts && found->parts->blended && !mesh->has_field;
    if (!found->parts || !mesh->cut || !soft->counts_bodies)
        return found->parts != NULL;
    return soft_parts_close(&soft->keeper->parts[model - soft->gpu_scene->models][level - model->levels], mesh->file,
                            asset_closed(model->file, (uint32_t)(level - model->levels)), level->vertex_count);
}

static void start(struct soft *soft, bool counts_bodies)
{
    soft->mesh_count = soft->vertex_count = 0;
    soft->blends = false;
    soft->counts_bodies = counts_bodies;
}

bool soft_find(struct soft *soft, bool bodies)
{
    const struct frame_context *context = soft->context;
    bool good = true;
    start(soft, bodies && soft->cut_count > 0);
    for (size_t i = 0; i < context->visible_count && good; i++)
        good = add_asset(soft, context->visible[i], frame_level(context, context->visible[i]), false);
    if (!good)
        return false;
    workers_for(soft->workers, soft->mesh_count, 1, find_meshes, soft);
    uint32_t id = 0;
    for (size_t m = 0; m < soft->mesh_count; m++) {
        soft->found[m].first_id = id;
        id += (uint32_t)soft->found[m].count * PART_TRIANGLES;
    }
    return true;
}

bool soft_find_only(struct soft *soft, int asset)
{
    start(soft, false);
    if (!add_asset(soft, asset, frame_level(soft->context, asset), true))
        return false;
    find_meshes(soft, 0, 1);
    return true;
}

bool soft_find_ghosts(struct soft *soft)
{
    start(soft, false);
    for (size_t i = 0; i < soft->gpu_scene->scene->asset_count; i++) {
        if (!ghosts_shows(soft->context, i))
            continue;
        const struct model_level *level = gpu_scene_level(soft->gpu_scene, &soft->context->constants, (int)i, 1);
        if (!add_asset(soft, (int)i, level, true))
            return false;
    }
    workers_for(soft->workers, soft->mesh_count, 1, find_meshes, soft);
    return true;
}

/* The mesh that has this id; likely: looked at first. */
static size_t mesh_of(const struct soft *soft, uint32_t id, size_t likely)
{
    const struct soft_found *found = soft->found;
    size_t low = 0, high = soft->mesh_count;
    if (found[likely].first_id <= id && (likely + 1 == high || id < found[likely + 1].first_id))
        return likely;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (found[middle].first_id <= id)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void soft_find_triangle(const struct soft *soft, uint32_t id, struct soft_triangle *triangle)
{
    uint32_t number = id & ~ID_BACK;
    size_t mesh = mesh_of(soft, number, triangle->mesh);
    const struct soft_found *found = &soft->found[mesh];
    uint32_t local = number - found->first_id;
    const struct soft_part *part = &found->parts->parts[found->items[local / PART_TRIANGLES].part];
    triangle->id = id;
    triangle->mesh = (uint32_t)mesh;
    triangle->material = found->material + part->material;
    soft_part_triangle(found->parts, part, local % PART_TRIANGLES, triangle->vertices);
}
