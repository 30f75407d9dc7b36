/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From `welcome` to the structs that overlays are drawn from. */
#include "model_plant.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "field/colormap.h"
#include "message/names.h"

static char *text_of(const json_t *o, const char *name)
{
    const char *text = json_string_value(json_object_get(o, name));
    return (char *)(text ? text : ""); /* nobody writes to it */
}

static double number_or(const json_t *o, const char *name, double otherwise)
{
    const json_t *value = json_object_get(o, name);
    return json_is_number(value) ? json_number_value(value) : otherwise;
}

static bool read_vector(const json_t *list, double out[3])
{
    for (size_t i = 0; i < 3; i++)
        out[i] = json_number_value(json_array_get(list, i));
    return json_array_size(list) == 3;
}

static void read_bounds(const json_t *o, double min_m[3], double max_m[3])
{
    const json_t *bounds = json_object_get(o, "bounds");
    read_vector(json_object_get(bounds, "min"), min_m);
    read_vector(json_object_get(bounds, "max"), max_m);
}

static void read_limits(const json_t *o, double limits[LIMIT_COUNT])
{
    const json_t *given = json_object_get(o, "limits");
    for (int i = 0; i < LIMIT_COUNT; i++)
        limits[i] = number_or(given, plant_limit_names[i], NAN);
}

static int read_numbers(const json_t *list, double *out, int most)
{
    int count = 0;
    for (size_t i = 0; i < json_array_size(list) && count < most; i++)
        out[count++] = json_number_value(json_array_get(list, i));
    return count;
}

static void read_group(const json_t *o, struct plant_group *group)
{
    const char *distance = text_of(o, "distance");
    *group = (struct plant_group){ .id = text_of(o, "id"), .quantity = text_of(o, "quantity"), .unit = text_of(o, "unit") };
    group->min = number_or(o, "min", 0);
    group->max = number_or(o, "max", 1);
    read_limits(o, group->limits);
    for (const struct name *name = names_interpolation; name->text; name++)
        if (!strcmp(name->text, text_of(o, "interpolation")))
            group->interpolation = (enum interpolation)name->value;
    group->prepared = ~0u; /* the server knows, and has judged */
    group->distance = !strcmp(distance, "euclidean") ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC;
    group->fill = !strcmp(text_of(o, "fill"), "neighbours") ? FILL_NEIGHBOURS : FILL_NONE;
    group->strength = group->decay = 1;
    group->power = number_or(o, "power", 2);
    group->radius_m = number_or(o, "radius_m", 0);
    group->reach_m = number_or(o, "reach_m", INFINITY);
    group->cuts_singles = !strcmp(text_of(o, "singles"), "cut");
    group->directed = json_is_true(json_object_get(o, "directed"));
    group->log = !strcmp(text_of(o, "scale"), "log") && group->min > 0;
    group->break_count = read_numbers(json_object_get(o, "breaks"), group->breaks, PLANT_BREAKS);
    group->isoline_count = read_numbers(json_object_get(o, "isolines"), group->isolines, PLANT_ISOLINES);
}

static void read_asset(const json_t *o, struct plant_asset *asset, struct scene_asset *place)
{
    const char *start = text_of(o, "start");
    *asset = (struct plant_asset){ .id = text_of(o, "id"), .tag = text_of(o, "tag"), .description = text_of(o, "description") };
    asset->start = !strcmp(start, "ghost") ? PLANT_START_GHOST : !strcmp(start, "hidden") ? PLANT_START_HIDDEN : PLANT_START_SHOWN;
    read_bounds(o, place->bounds_min_m, place->bounds_max_m);
}

static void read_tag(const struct plant *plant, const json_t *o, struct plant_tag *tag)
{
    *tag = (struct plant_tag){ .name = text_of(o, "name"), .description = text_of(o, "description"), .source = -1, .suppressed_by = -1 };
    tag->group = plant_find_group(plant, text_of(o, "group"));
    tag->asset = plant_find_asset(plant, text_of(o, "asset"));
    tag->unit = text_of(o, "unit");
    if (!tag->unit[0] && tag->group >= 0)
        tag->unit = plant->groups[tag->group].unit;
    tag->has_position = read_vector(json_object_get(o, "position"), tag->position_m);
    tag->place_assumed = !strcmp(text_of(o, "place"), "equipment");
    read_limits(o, tag->limits);
    tag->mirror.tag = -1;
    tag->line = 1;
}

static void place_sensors(struct plant *plant, struct scene *scene)
{
    for (size_t a = 0; a < scene->asset_count; a++) {
        struct scene_asset *asset = &scene->assets[a];
        asset->plant = &plant->assets[a];
        for (size_t i = 0; i < plant->tag_count; i++)
            asset->sensor_count += plant->tags[i].asset == (int)a && plant->tags[i].has_position;
        asset->sensors = mem_array(asset->sensor_count + 1, sizeof(*asset->sensors));
        asset->sensor_count = 0;
        for (size_t i = 0; i < plant->tag_count; i++) {
            if (plant->tags[i].asset != (int)a || !plant->tags[i].has_position)
                continue;
            struct scene_sensor *sensor = &asset->sensors[asset->sensor_count++];
            sensor->tag = (int)i;
            memcpy(sensor->position_m, plant->tags[i].position_m, sizeof(sensor->position_m));
            memcpy(sensor->surface_m, plant->tags[i].position_m, sizeof(sensor->surface_m));
        }
    }
}

static int by_name(const void *a, const void *b, void *arg)
{
    const struct plant *plant = arg;
    return strcmp(plant->tags[*(const int *)a].name, plant->tags[*(const int *)b].name);
}

static void sort_tags(struct plant *plant)
{
    plant->tags_by_name = mem_array(plant->tag_count + 1, sizeof(*plant->tags_by_name));
    for (size_t i = 0; i < plant->tag_count; i++)
        plant->tags_by_name[i] = (int)i;
    qsort_r(plant->tags_by_name, plant->tag_count, sizeof(*plant->tags_by_name), by_name, plant);
}

static void read_place(const json_t *o, struct plant *plant, struct scene *scene)
{
    const json_t *home = json_object_get(o, "home"), *outline = json_object_get(o, "outline");
    double up[3] = { 0, 0, 1 };
    read_bounds(o, scene->bounds_min_m, scene->bounds_max_m);
    plant->view.set = json_is_true(json_object_get(home, "given"));
    read_vector(json_object_get(home, "eye"), plant->view.eye_m);
    read_vector(json_object_get(home, "target"), plant->view.target_m);
    plant->view.fov_deg = number_or(home, "fov", 45);
    read_vector(json_object_get(home, "up"), up);
    plant->up = fabs(up[1]) > fabs(up[2]) ? AXIS_Y : AXIS_Z;
    scene->extremes_m = mem_array(json_array_size(outline) + 1, sizeof(*scene->extremes_m));
    for (size_t i = 0; i < json_array_size(outline); i++)
        scene->extreme_count += read_vector(json_array_get(outline, i), scene->extremes_m[scene->extreme_count]);
}

/* The plant's own, which the program does not know. */
static void add_colormaps(const json_t *list)
{
    if (!colormap_count()) /* it reads its own first */
        return;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *o = json_array_get(list, i);
        const char *base64 = text_of(o, "rgb");
        uint8_t rgb[256][3], *out = &rgb[0][0];
        size_t length = strlen(base64), count = 0;
        uint32_t bits = 0;
        if (colormap_find(text_of(o, "name")) >= 0 || length != 1024)
            continue;
        for (size_t k = 0; k < length; k++) {
            static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
            const char *at = strchr(letters, base64[k]);
            bits = bits << 6 | (uint32_t)(at ? at - letters : 0);
            if (k % 4 == 3)
                for (int shift = 16; shift >= 0; shift -= 8)
                    out[count++] = (uint8_t)(bits >> shift);
        }
        colormap_add(text_of(o, "name"), (const uint8_t(*)[3])rgb);
    }
}

static void read_environments(const json_t *list, struct plant *plant)
{
    for (size_t i = 1; i < json_array_size(list) && plant->environment_count < PLANT_ENVIRONMENTS; i++) { /* the first is the sky */
        const char *name = json_string_value(json_array_get(list, i));
        plant->environments[plant->environment_count++].name = (char *)(name ? name : "");
    }
}

bool model_plant_init(struct plant *plant, struct scene *scene, const json_t *welcome)
{
    const json_t *o = json_object_get(welcome, "plant"), *groups = json_object_get(welcome, "groups"),
                 *assets = json_object_get(welcome, "assets"), *tags = json_object_get(welcome, "tags");
    *plant = (struct plant){ .name = text_of(o, "name"), .time_zone = text_of(o, "time_zone") };
    *scene = (struct scene){ .plant = plant };
    plant->group_count = json_array_size(groups);
    plant->asset_count = scene->asset_count = json_array_size(assets);
    plant->tag_count = json_array_size(tags);
    plant->groups = mem_array(plant->group_count + 1, sizeof(*plant->groups));
    plant->assets = mem_array(plant->asset_count + 1, sizeof(*plant->assets));
    scene->assets = mem_array(plant->asset_count + 1, sizeof(*scene->assets));
    plant->tags = mem_array(plant->tag_count + 1, sizeof(*plant->tags));
    for (size_t i = 0; i < plant->group_count; i++)
        read_group(json_array_get(groups, i), &plant->groups[i]);
    for (size_t i = 0; i < plant->asset_count; i++)
        read_asset(json_array_get(assets, i), &plant->assets[i], &scene->assets[i]);
    for (size_t i = 0; i < plant->tag_count; i++)
        read_tag(plant, json_array_get(tags, i), &plant->tags[i]);
    sort_tags(plant);
    place_sensors(plant, scene);
    read_place(o, plant, scene);
    add_colormaps(json_object_get(welcome, "colormaps"));
    read_environments(json_object_get(welcome, "environments"), plant);
    if (plant->group_count > 0 && json_is_object(o))
        return true;
    model_plant_finish(plant, scene);
    return false;
}

void model_plant_finish(struct plant *plant, struct scene *scene)
{
    for (size_t i = 0; i < scene->asset_count; i++)
        mem_free(scene->assets[i].sensors);
    mem_free(scene->assets);
    mem_free(scene->extremes_m);
    mem_free(plant->groups);
    mem_free(plant->assets);
    mem_free(plant->tags);
    mem_free(plant->tags_by_name);
    *plant = (struct plant){ 0 };
    *scene = (struct scene){ 0 };
}
