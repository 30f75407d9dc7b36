/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the parts (groups of triangles, soft/parts.h) of assets that a frame may show, and their rectangles in the frame. */

#include "base/math/search.h"
#include "base/mem.h"
#include "render/soft/tile.h"
#include "render/soft/lanes.h"
#include "render/matrix.h"
#include "render/gl/ghosts.h"

/* margin in pixels around the projected bounding boxes of parts (groups of triangles), because boxes and vertices round
   differently */
#define SLACK_PX 0.02f
/* fraction by which a bounding box's nearest depth is moved nearer, to absorb rounding errors */
#define SLACK_DEPTH 1e-5f
/* depth used for points in front of the near plane; larger than any real depth, so that they count as nearest */
#define IN_FRONT_OF_NEAR 2.0f

/* Projects a box into the frame: computes its bounding rectangle, in pixels, and its nearest depth. Returns false if the box is
   outside the frame. */
SOFT_INLINE bool project(const struct raster *raster, const struct soft_mesh *mesh, const float low[3], const float high[3],
                         struct soft_rect *rect, float *near)
{
    const lanes_int right = { 0, -1, 0, -1, 0, -1, 0, -1 }, upper = { 0, 0, -1, -1, 0, 0, -1, -1 }, front = { 0, 0, 0, 0, -1, -1, -1, -1 };
    lanes none = { 0 }, at[4];
    lanes x = lanes_choose(right, none + high[0], none + low[0]), y = lanes_choose(upper, none + high[1], none + low[1]);
    lanes z = lanes_choose(front, none + high[2], none + low[2]);
    for (int r = 0; r < 4; r++)
        at[r] = mesh->place[0][r] * x + mesh->place[1][r] * y + mesh->place[2][r] * z + mesh->place[3][r];
    *rect = (struct soft_rect){ 0, 0, raster->width_px - 1, raster->height_px - 1 };
    *near = IN_FRONT_OF_NEAR;
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
    const float slack = SLACK_PX + raster->reach_px;
    left += 0.5f - slack; /* from here on, left, last, top and bottom enclose the centres of all pixels that the box may cover */
    top += 0.5f - slack;
    last += 0.5f + slack;
    bottom += 0.5f + slack;
    if (last < 1 || bottom < 1 || left >= (float)raster->width_px || top >= (float)raster->height_px || nearest < 0)
        return false;
    rect->left = left > 0 ? (int)left : 0;
    rect->top = top > 0 ? (int)top : 0;
    rect->right = last < (float)raster->width_px ? (int)last - 1 : rect->right;
    rect->bottom = bottom < (float)raster->height_px ? (int)bottom - 1 : rect->bottom;
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

/* Returns true if section planes remove the whole part (group of triangles), and no triangle of the part bounds a body that is cut open. */
static bool is_cut_away(const struct raster *raster, const struct soft_mesh *mesh, const struct asset_cluster *box, struct soft_item *item)
{
    item->cut = item->beyond = false;
    for (int p = 0; p < raster->cut_count && mesh->cut; p++) {
        bool away = raster_cuts_box(raster, mesh, p, box->low_m, box->high_m, &item->cut);
        if (away && (p < raster->entry_count || !raster->counts_bodies))
            return true;
        item->beyond |= away;
    }
    return false;
}

SOFT_KERNEL static void find_parts(const struct raster *raster, const struct soft_mesh *mesh, struct soft_found *found)
{
    found->count = 0;
    found->rect = (struct soft_rect){ INT16_MAX, INT16_MAX, -1, -1 };
    for (uint32_t p = 0; p < found->parts->part_count; p++) {
        const struct soft_part *part = &found->parts->parts[p];
        struct soft_item *item = &found->items[found->count];
        if (!part->double_sided && !found->both_sides && !mesh->mirrored && asset_cluster_turned_away(&part->cluster, found->eye_m))
            continue;
        if (!project(raster, mesh, part->cluster.low_m, part->cluster.high_m, &item->rect, &item->near))
            continue;
        if (is_cut_away(raster, mesh, &part->cluster, item))
            continue;
        item->part = p;
        include(&found->rect, &item->rect);
        found->count++;
    }
}

static void find_meshes(void *arg, size_t begin, size_t end)
{
    struct raster *raster = arg;
    for (size_t m = begin; m < end; m++) {
        struct soft_found *found = &raster->found[m];
        mem_grow(&found->items, &found->capacity, found->parts->part_count, sizeof(*found->items));
        find_parts(raster, &raster->meshes[m], found);
    }
}

/* Returns the parts (groups of triangles, soft/parts.h) of a level of detail, which are made on first use. NULL: out of memory. */
static const struct soft_parts *parts_of(struct raster *raster, const struct gl_model *model, const struct model_level *level)
{
    struct soft_parts **of_model = &raster->soft->parts[model - raster->soft->gpu_scene->models];
    if (!*of_model)
        *of_model = mem_array(model->level_count, sizeof(**of_model));
    struct soft_parts *parts = &(*of_model)[level - model->levels];
    if (!parts->parts && !soft_parts_init(parts, &model->file->view, level)) {
        soft_parts_finish(parts);
        return NULL;
    }
    return parts;
}

/* Computes the eye position used to distinguish front from back faces. In an orthographic view rays are parallel, so the eye is
   put far enough away for its rays to be parallel in float precision. */
static void find_eye(const struct raster *raster, double eye_m[3])
{
    const struct view_constants *constants = &raster->context->constants;
    for (int c = 0; c < 3; c++)
        eye_m[c] = constants->pixel_per_metre > 0
                       ? raster->soft->gpu_scene->middle_m[c] + 1e6 * raster->soft->gpu_scene->radius_m * constants->back[c]
                       : constants->eye_m[c];
}

/* Adds a mesh whose field is evaluated at pixels to raster->pixels. Positions there are relative to the centre of the mesh, where 32-bit
   floats are most precise. clip: matrix from the asset file to clip space. */
static void add_pixels(struct raster *raster, struct soft_mesh *mesh, const struct pixel_field *field, const double clip[16])
{
    const struct asset_header *header = mesh->file->header;
    double from_pixel[16], pixel[16], middle[3];
    if (raster->pixels_count == 0) {
        float least = -raster->block.shade[1];
        raster->row_bias = least > 0 ? (int)least + 1 : 0;
    }
    mem_grow(&raster->pixels, &raster->pixels_capacity, raster->pixels_count + 1, sizeof(*raster->pixels));
    struct soft_pixels *to = &raster->pixels[raster->pixels_count];
    mesh->pixels = (int32_t)raster->pixels_count++;
    pixel_field_copy(&to->field, field);
    to->every = pixel_list_of_all(field);
    to->mesh = (uint32_t)(mesh - raster->meshes);
    for (int c = 0; c < 3; c++)
        middle[c] = 0.5 * ((double)header->bounds_min_m[c] + (double)header->bounds_max_m[c]);
    for (int i = 0; i < field->count; i++)
        for (int c = 0; c < 3; c++)
            to->field.sensors[i].place_m[c] = (float)((double)field->sensors[i].place_m[c] - middle[c]);
    matrix_translation(middle, pixel);
    matrix_multiply(clip, pixel, pixel);
    for (int c = 0; c < 4; c++) {
        double *column = &pixel[4 * c];
        column[0] = 0.5 * raster->width_px * (column[3] + column[0]);
        column[1] = 0.5 * raster->height_px * (column[3] - column[1]);
    }
    matrix_invert(pixel, from_pixel);
    for (int c = 0; c < 16; c++)
        to->place_from_pixel[c / 4][c % 4] = (float)from_pixel[c];
}

/* Fills *mesh with the data for drawing this asset in the frame, and adds the number of its vertices to raster->vertex_count. */
static void fill_mesh(struct raster *raster, struct soft_mesh *mesh, int index, const struct model_level *level)
{
    const struct frame_context *context = raster->context;
    const struct scene_asset *asset = &context->gpu_scene->scene->assets[index];
    double clip[16], half[2] = { 0.5 * raster->width_px, 0.5 * raster->height_px };
    *mesh = (struct soft_mesh){
        .asset = index,
        .file = &asset->file->view,
        .has_field = context->fields[index] != NULL,
        .scalars = context->fields[index] ? context->fields[index]->shown : NULL,
        .pixels = -1,
        .baked = (const uint8_t(*)[4])raster->light->baked[index],
        .first_vertex = (uint32_t)raster->vertex_count,
        .vertex_count = level->vertex_count,
        .mirrored = scene_asset_mirrored(asset),
        .cut = clip_touches(&context->view->visibility.clip, asset->bounds_min_m, asset->bounds_max_m),
    };
    if (mesh->cut)
        matrix_normals(asset->placement, mesh->turn);
    matrix_multiply(context->constants.clip_from_plant, asset->placement, clip);
    view_constants_bring_forward(&context->constants, asset, clip);
    for (int c = 0; c < 4; c++) {
        mesh->place[c][0] = (float)(half[0] * (clip[4 * c + 3] + clip[4 * c]) - (double)raster->shift_px[0] * clip[4 * c + 3]);
        mesh->place[c][1] = (float)(half[1] * (clip[4 * c + 3] - clip[4 * c + 1]) - (double)raster->shift_px[1] * clip[4 * c + 3]);
        mesh->place[c][2] = (float)clip[4 * c + 2];
        mesh->place[c][3] = (float)clip[4 * c + 3];
    }
    raster->vertex_count += level->vertex_count;
    if (context->fields[index] && context->fields[index]->pixels.count > 0)
        add_pixels(raster, mesh, &context->fields[index]->pixels, clip);
}

static bool add_asset(struct raster *raster, int asset, const struct model_level *level, bool both_sides)
{
    const struct gl_model *model = raster->soft->gpu_scene->of_asset[asset];
    double file_from_plant[16], eye_m[3], eye[4];
    mem_grow(&raster->meshes, &raster->mesh_capacity, raster->mesh_count + 1, sizeof(*raster->meshes));
    mem_grow(&raster->found, &raster->found_capacity, raster->mesh_count + 1, sizeof(*raster->found));
    const struct soft_mesh *mesh = &raster->meshes[raster->mesh_count];
    fill_mesh(raster, &raster->meshes[raster->mesh_count], asset, level);
    struct soft_found *found = &raster->found[raster->mesh_count++];
    found->parts = parts_of(raster, model, level);
    found->material = raster->soft->material_of_model[model - raster->soft->gpu_scene->models];
    found->both_sides = both_sides || mesh->cut; /* meshes that a section plane cuts show their inner side, so their back faces are drawn */
    matrix_invert(raster->soft->gpu_scene->scene->assets[asset].placement, file_from_plant);
    find_eye(raster, eye_m);
    matrix_point(file_from_plant, eye_m, eye);
    for (int c = 0; c < 3; c++)
        found->eye_m[c] = (float)eye[c];
    raster->blends |= found->parts && found->parts->blended && !mesh->has_field;
    if (!found->parts || !mesh->cut || !raster->counts_bodies)
        return found->parts != NULL;
    return soft_parts_close(&raster->soft->parts[model - raster->soft->gpu_scene->models][level - model->levels], mesh->file,
                            asset_closed(model->file, (uint32_t)(level - model->levels)), level->vertex_count);
}

static void start(struct raster *raster, bool counts_bodies)
{
    raster->mesh_count = raster->vertex_count = raster->pixels_count = 0;
    raster->blends = false;
    raster->counts_bodies = counts_bodies;
}

bool raster_find(struct raster *raster, bool bodies)
{
    const struct frame_context *context = raster->context;
    bool good = true;
    start(raster, bodies && raster->cut_count > 0);
    for (size_t i = 0; i < context->visible_count && good; i++)
        good = add_asset(raster, context->visible[i], frame_level(context, context->visible[i]), false);
    if (!good)
        return false;
    workers_for(raster->soft->workers, raster->mesh_count, 1, find_meshes, raster);
    uint32_t id = 0;
    for (size_t m = 0; m < raster->mesh_count; m++) {
        raster->found[m].first_id = id;
        id += (uint32_t)raster->found[m].count * PART_TRIANGLES;
    }
    return true;
}

bool raster_find_only(struct raster *raster, int asset)
{
    start(raster, false);
    if (!add_asset(raster, asset, frame_level(raster->context, asset), true))
        return false;
    find_meshes(raster, 0, 1);
    return true;
}

bool raster_find_ghosts(struct raster *raster)
{
    start(raster, false);
    for (size_t i = 0; i < raster->soft->gpu_scene->scene->asset_count; i++) {
        if (!ghosts_shows(raster->context, i))
            continue;
        const struct model_level *level = gpu_scene_level(raster->soft->gpu_scene, &raster->context->constants, (int)i, 1);
        if (!add_asset(raster, (int)i, level, true))
            return false;
    }
    workers_for(raster->soft->workers, raster->mesh_count, 1, find_meshes, raster);
    return true;
}

/* Returns the index, in raster->meshes, of the mesh that contains the triangle with this id. likely: index of the mesh to try first. */
static size_t mesh_of(const struct raster *raster, uint32_t id, size_t likely)
{
    const struct soft_found *found = raster->found;
    size_t after;
    if (found[likely].first_id <= id && (likely + 1 == raster->mesh_count || id < found[likely + 1].first_id))
        return likely;
    search_sorted(after, raster->mesh_count, found[after].first_id <= id);
    return after - 1;
}

void raster_find_triangle(const struct raster *raster, uint32_t id, struct soft_triangle *triangle)
{
    uint32_t number = id & ~ID_BACK;
    size_t mesh = mesh_of(raster, number, triangle->mesh);
    const struct soft_found *found = &raster->found[mesh];
    uint32_t local = number - found->first_id;
    const struct soft_part *part = &found->parts->parts[found->items[local / PART_TRIANGLES].part];
    triangle->id = id;
    triangle->mesh = (uint32_t)mesh;
    triangle->material = found->material + part->material;
    soft_part_triangle(found->parts, part, local % PART_TRIANGLES, triangle->vertices);
}
