/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads plant.yaml: has the tables of its keys, and checks keys against each other. PLANT.md describes the format. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "plant/influence.h"
#include "plant/models/transform.h"
#include "plant/parse/yaml_reader.h"
#include "plant/plant_impl.h"
#include "plant/sections/plant_alarms.h"

#define ZONE_FOLDER "/usr/share/zoneinfo"

static const struct yaml_choice up_choices[] = { { "z", AXIS_Z }, { "y", AXIS_Y }, { 0 } };
static const struct yaml_choice show_choices[] = { { "value", PLANT_SHOW_VALUE }, { "operator", PLANT_SHOW_OPERATOR }, { 0 } };
static const struct yaml_choice start_choices[] = {
    { "shown", PLANT_START_SHOWN }, { "ghost", PLANT_START_GHOST }, { "hidden", PLANT_START_HIDDEN }, { 0 }
};
static const struct yaml_choice unit_choices[] = { { "m", 1 }, { "mm", 1e-3 }, { "cm", 1e-2 }, { "in", 0.0254 }, { "ft", 0.3048 }, { 0 } };
static const struct yaml_choice reprojection_choices[] = { { "on", false }, { "off", true }, { 0 } };
static const struct yaml_choice frame_choices[] = { { "plant", 0 }, { "asset", 1 }, { 0 } };
static const struct yaml_choice interpolation_choices[] = {
    { "shepard", INTERPOLATION_SHEPARD }, { "paper", INTERPOLATION_PAPER }, { "harmonic", INTERPOLATION_HARMONIC },
    { "fin", INTERPOLATION_FIN },         { "gp", INTERPOLATION_GP },       { 0 }
};
static const struct yaml_choice geodesic_choices[] = { { "exact", false }, { "heat", true }, { 0 } };
static const struct yaml_choice distance_choices[] = { { "geodesic", DISTANCE_GEODESIC }, { "euclidean", DISTANCE_EUCLIDEAN }, { 0 } };
static const struct yaml_choice fill_choices[] = { { "none", FILL_NONE }, { "neighbours", FILL_NEIGHBOURS }, { 0 } };
static const struct yaml_choice units_choices[] = { { "convert", 0 }, { "as-written", 1 }, { 0 } };
static const struct yaml_choice singles_choices[] = { { "whole", 0 }, { "cut", 1 }, { 0 } };
static const struct yaml_choice scale_choices[] = { { "linear", 0 }, { "log", 1 }, { 0 } };

/* --- plant ------------------------------------------------------------------------------------------------------------------ */

static bool zone_known(const char *zone)
{
    char path[PATH_MAX], magic[4] = { 0 };
    if (access(ZONE_FOLDER, R_OK) != 0)
        return true;
    if (!*zone || *zone == '/' || strstr(zone, "..") || (size_t)snprintf(path, sizeof(path), ZONE_FOLDER "/%s", zone) >= sizeof(path))
        return false;
    struct stat st;
    FILE *file = stat(path, &st) == 0 && S_ISREG(st.st_mode) ? fopen(path, "rb") : NULL;
    if (!file)
        return false;
    size_t got = fread(magic, 1, sizeof(magic), file);
    fclose(file);
    return got == sizeof(magic) && !memcmp(magic, "TZif", sizeof(magic));
}

static void read_view(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = {
        { "eye", KEY_POINT, true, offsetof(struct plant_view, eye_m), -PLANT_MAX_M, PLANT_MAX_M, NULL, NULL },
        { "target", KEY_POINT, true, offsetof(struct plant_view, target_m), -PLANT_MAX_M, PLANT_MAX_M, NULL, NULL },
        { "fov", KEY_NUMBER, false, offsetof(struct plant_view, fov_deg), 1, 120, NULL, NULL },
        { 0 }
    };
    struct plant_view *view = &((struct plant *)record)->display.view;
    struct yaml_map map;
    if (!yaml_map_read(reader, node, "view", keys, view, &map) || !yaml_map_good(&map, "eye") || !yaml_map_good(&map, "target"))
        return;
    for (int i = 0; i < 3; i++)
        view->set |= fabs(view->eye_m[i] - view->target_m[i]) > 1e-3;
    if (!view->set)
        yaml_error(reader, yaml_map_place(&map, "target"), "target: must be another point than `eye`");
}

static void read_plant(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = { { "name", KEY_NAME, true, offsetof(struct plant, name), 0, 0, NULL, NULL },
                                            { "time_zone", KEY_NAME, false, offsetof(struct plant, time_zone), 0, 0, NULL, NULL },
                                            { "up", KEY_CHOICE, false, offsetof(struct plant, up), 0, 0, up_choices, NULL },
                                            { "view", KEY_CUSTOM, false, 0, 0, 0, NULL, read_view },
                                            { "show", KEY_CHOICE, false, offsetof(struct plant, display.show), 0, 0, show_choices, NULL },
                                            { "reprojection", KEY_FLAG, false, offsetof(struct plant, display.no_reprojection), 0, 0,
                                              reprojection_choices, NULL },
                                            { 0 } };
    struct plant *plant = record;
    struct yaml_map map;
    if (yaml_map_read(reader, node, "plant", keys, plant, &map) && yaml_map_good(&map, "time_zone") && !zone_known(plant->time_zone))
        yaml_error(reader, yaml_map_place(&map, "time_zone"),
                   "time_zone: unknown time zone '%.60s'; expected an IANA name such as Europe/Berlin or UTC", plant->time_zone);
}

/* --- assets ----------------------------------------------------------------------------------------------------------------- */

struct asset_record {
    struct plant_asset asset;
    double translate_m[3], rotate_deg[3], scale;
};

static void read_placement(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = {
        { "translate", KEY_POINT, false, offsetof(struct asset_record, translate_m), -PLANT_MAX_M, PLANT_MAX_M, NULL, NULL },
        { "rotate_deg", KEY_POINT, false, offsetof(struct asset_record, rotate_deg), -36000, 36000, NULL, NULL },
        { "scale", KEY_NUMBER, false, offsetof(struct asset_record, scale), 1e-6, 1e6, NULL, NULL },
        { 0 }
    };
    struct yaml_map map;
    yaml_map_read(reader, node, "placement", keys, record, &map);
}

static bool will_be_made(const struct plant *plant, const char *path)
{
    for (size_t i = 0; i < plant->conversion_count; i++)
        if (plant->conversions[i].model && !strcmp(plant->conversions[i].model, path))
            return true;
    return false;
}

static void check_model(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, const char *path)
{
    struct stat st;
    FILE *file = NULL;
    if (will_be_made(plant, path) && access(path, F_OK) != 0)
        return;
    if (stat(path, &st) != 0 || (S_ISREG(st.st_mode) && !(file = fopen(path, "rb"))))
        yaml_error(reader, yaml_map_place(map, "model"), "model: '%s' cannot be read: %s", path, strerror(errno));
    else if (!S_ISREG(st.st_mode))
        yaml_error(reader, yaml_map_place(map, "model"), "model: '%s' is not a file", path);
    if (file)
        fclose(file);
}

static void read_properties(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    plant_properties_read(reader, node, &((struct asset_record *)record)->asset);
}

static void read_nodes(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    plant_nodes_read(reader, node, &((struct asset_record *)record)->asset);
}

/* Reports an asset whose key `nodes` has no value. An unquoted `nodes: #12` is a comment in YAML, and `nodes: !base` a type tag without
   a value: both would silently select the whole model. */
static void check_nodes(struct yaml_reader *reader, const struct yaml_map *map, const struct plant_asset *asset, int errors)
{
    struct text_position at = yaml_map_place(map, "nodes");
    if (yaml_map_has(map, "nodes") && !asset->nodes && reader->diag->errors == errors)
        diag_warning(reader->diag, reader->path, at.line, at.column,
                     "nodes: has no value, so the whole model is used; put patterns with # or ! in quotes, such as \"#12\"");
}

static void read_asset(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant, struct plant_asset *asset)
{
    static const struct yaml_key keys[] = {
        { "id", KEY_NAME, true, offsetof(struct asset_record, asset.id), 0, 0, NULL, NULL },
        { "tag", KEY_TEXT, false, offsetof(struct asset_record, asset.tag), 0, 0, NULL, NULL },
        { "description", KEY_TEXT, false, offsetof(struct asset_record, asset.description), 0, 0, NULL, NULL },
        { "area", KEY_TEXT, false, offsetof(struct asset_record, asset.area), 0, 0, NULL, NULL },
        { "properties", KEY_CUSTOM, false, 0, 0, 0, NULL, read_properties },
        { "model", KEY_NAME, true, offsetof(struct asset_record, asset.model), 0, 0, NULL, NULL },
        { "nodes", KEY_CUSTOM, false, 0, 0, 0, NULL, read_nodes },
        { "units", KEY_FACTOR, false, offsetof(struct asset_record, asset.unit_m), 0, 0, unit_choices, NULL },
        { "up", KEY_CHOICE, false, offsetof(struct asset_record, asset.up), 0, 0, up_choices, NULL },
        { "placement", KEY_CUSTOM, false, 0, 0, 0, NULL, read_placement },
        { "tolerance_m", KEY_NUMBER, false, offsetof(struct asset_record, asset.tolerance_m), 1e-6, 1000, NULL, NULL },
        { "thickness_m", KEY_NUMBER, false, offsetof(struct asset_record, asset.thickness_m), 1e-5, 10, NULL, NULL },
        { "conductivity", KEY_NUMBER, false, offsetof(struct asset_record, asset.conductivity), 1e-3, 1e4, NULL, NULL },
        { "heat_transfer", KEY_NUMBER, false, offsetof(struct asset_record, asset.heat_transfer), 1e-3, 1e6, NULL, NULL },
        { "start", KEY_CHOICE, false, offsetof(struct asset_record, asset.start), 0, 0, start_choices, NULL },
        { "sensor_frame", KEY_FLAG, false, offsetof(struct asset_record, asset.sensors_in_asset_frame), 0, 0, frame_choices, NULL },
        { 0 }
    };
    struct asset_record record = { .asset = { .unit_m = 1,
                                              .up = AXIS_Y,
                                              .conductivity = PLANT_CONDUCTIVITY,
                                              .heat_transfer = PLANT_HEAT_TRANSFER,
                                              .line = yaml_place(node).line },
                                   .scale = 1 };
    struct yaml_map map;
    int errors = reader->diag->errors;
    bool is_map = yaml_map_read(reader, node, "an asset", keys, &record, &map);
    *asset = record.asset;
    /* multiplies the model's length unit (metres per unit) by the placement's scale, because distances on the asset are
       measured at its size in the plant */
    asset->unit_m *= record.scale;
    transform_compose(record.translate_m, record.rotate_deg, asset->placement);
    if (!is_map)
        return;
    check_nodes(reader, &map, asset, errors);
    if (asset->start != PLANT_START_SHOWN && plant->asset_count > PLANT_STARTS)
        yaml_error(reader, yaml_map_place(&map, "start"), "start: only the first %d assets of the plant file can be hidden or ghosts",
                   PLANT_STARTS);
    plant_resolve_path(plant, &asset->model);
    if (yaml_map_good(&map, "model") && !plant->files.without_models)
        check_model(reader, &map, plant, asset->model);
    if (!asset->tag && asset->id)
        asset->tag = mem_strdup(asset->id);
    if (!asset->description)
        asset->description = mem_strdup("");
    if (!asset->area)
        asset->area = mem_strdup("");
    plant_list_check_id(reader, &map, "asset", plant->assets, plant->asset_count, sizeof(*asset), offsetof(struct plant_asset, line));
}

static void read_assets(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    int count;
    plant->assets = plant_list_make(reader, node, "assets", 1, INT_MAX, sizeof(*plant->assets), &count);
    for (int i = 0; i < count; i++)
        read_asset(reader, yaml_list_item(reader, node, i), plant, &plant->assets[plant->asset_count++]);
}

/* Turns each asset, whose own frame is Z up, so that its Z axis points along the plant's upward axis. So in a plant with Y up,
   an asset without a rotation stands upright. */
static void stand_upright(struct plant *plant)
{
    static const double y_up_from_z_up[16] = { 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1 };
    for (size_t i = 0; plant->up == AXIS_Y && i < plant->asset_count; i++) {
        double turned[16];
        transform_multiply(plant->assets[i].placement, y_up_from_z_up, turned);
        memcpy(plant->assets[i].placement, turned, sizeof(turned));
    }
}

/* --- groups ----------------------------------------------------------------------------------------------------------------- */

static void read_limits(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = {
        { "LL", KEY_NUMBER, false, LIMIT_LL * sizeof(double), -PLANT_MAX_VALUE, PLANT_MAX_VALUE, NULL, NULL },
        { "L", KEY_NUMBER, false, LIMIT_L * sizeof(double), -PLANT_MAX_VALUE, PLANT_MAX_VALUE, NULL, NULL },
        { "H", KEY_NUMBER, false, LIMIT_H * sizeof(double), -PLANT_MAX_VALUE, PLANT_MAX_VALUE, NULL, NULL },
        { "HH", KEY_NUMBER, false, LIMIT_HH * sizeof(double), -PLANT_MAX_VALUE, PLANT_MAX_VALUE, NULL, NULL },
        { 0 }
    };
    double *limits = ((struct plant_group *)record)->limits;
    struct yaml_map map;
    int lower, upper;
    if (yaml_map_read(reader, node, "limits", keys, limits, &map) && plant_limits_wrong(limits, &lower, &upper))
        yaml_error(reader, yaml_map_place(&map, plant_limit_names[upper]),
                   "%s: expected more than %s, which is %.9g, found %.9g (LL < L < H < HH)", plant_limit_names[upper],
                   plant_limit_names[lower], limits[lower], limits[upper]);
}

static void read_radius(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant_group *group = record;
    const char *text = yaml_text(node);
    if (text && !strcmp(text, "auto"))
        group->radius_m = 0;
    else if (node->type == YAML_SCALAR_NODE)
        yaml_number(reader, node, "radius_m", 1e-3, 1e6, &group->radius_m);
    else
        yaml_expected(reader, node, "radius_m", "auto or a number");
}

/* Reads a key's value that must be a list of numbers in ascending order. */
static void read_numbers(struct yaml_reader *reader, yaml_node_t *node, const char *name, int most, double *numbers, int *count)
{
    int items = yaml_list_count(reader, node, name);
    if (items > most)
        yaml_error(reader, yaml_place(node), "%s: expected at most %d numbers, found %d", name, most, items);
    for (int i = 0; i < items && i < most; i++) {
        yaml_node_t *item = yaml_list_item(reader, node, i);
        double number;
        if (!yaml_number(reader, item, name, -PLANT_MAX_VALUE, PLANT_MAX_VALUE, &number))
            continue;
        if (*count > 0 && number <= numbers[*count - 1])
            yaml_error(reader, yaml_place(item), "%s: expected a number greater than the previous one (%.9g), found %.9g", name,
                       numbers[*count - 1], number);
        else
            numbers[(*count)++] = number;
    }
}

static void read_breaks(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant_group *group = record;
    read_numbers(reader, node, "breaks", PLANT_BREAKS, group->breaks, &group->break_count);
}

static void read_isolines(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant_group *group = record;
    read_numbers(reader, node, "isolines", PLANT_ISOLINES, group->isolines, &group->isoline_count);
}

static void read_group(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant, struct plant_group *group)
{
    static const struct yaml_key keys[] = {
        { "id", KEY_NAME, true, offsetof(struct plant_group, id), 0, 0, NULL, NULL },
        { "quantity", KEY_TEXT, false, offsetof(struct plant_group, quantity), 0, 0, NULL, NULL },
        { "unit", KEY_TEXT, true, offsetof(struct plant_group, unit), 0, 0, NULL, NULL },
        { "units", KEY_FLAG, false, offsetof(struct plant_group, as_written), 0, 0, units_choices, NULL },
        { "min", KEY_NUMBER, true, offsetof(struct plant_group, min), -PLANT_MAX_VALUE, PLANT_MAX_VALUE, NULL, NULL },
        { "max", KEY_NUMBER, true, offsetof(struct plant_group, max), -PLANT_MAX_VALUE, PLANT_MAX_VALUE, NULL, NULL },
        { "limits", KEY_CUSTOM, false, 0, 0, 0, NULL, read_limits },
        { "alarm", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_alarms_read_group },
        { "interpolation", KEY_CHOICE, false, offsetof(struct plant_group, interpolation), 0, 0, interpolation_choices, NULL },
        { "distance", KEY_CHOICE, false, offsetof(struct plant_group, distance), 0, 0, distance_choices, NULL },
        { "geodesic", KEY_FLAG, false, offsetof(struct plant_group, heat), 0, 0, geodesic_choices, NULL },
        { "strength", KEY_NUMBER, false, offsetof(struct plant_group, strength), 0, 100, NULL, NULL },
        { "decay", KEY_NUMBER, false, offsetof(struct plant_group, decay), 0, 100, NULL, NULL },
        { "power", KEY_NUMBER, false, offsetof(struct plant_group, power), 0.5, 16, NULL, NULL },
        { "radius_m", KEY_CUSTOM, false, 0, 0, 0, NULL, read_radius },
        { "reach_m", KEY_NUMBER, false, offsetof(struct plant_group, reach_m), 1e-3, 1e6, NULL, NULL },
        { "prepare", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_influence_read },
        { "disc_m", KEY_NUMBER, false, offsetof(struct plant_group, disc_m), 1e-4, 100, NULL, NULL },
        { "ambient", KEY_NUMBER, false, offsetof(struct plant_group, ambient), -PLANT_MAX_VALUE, PLANT_MAX_VALUE, NULL, NULL },
        { "hot_spot_m", KEY_NUMBER, false, offsetof(struct plant_group, hot_spot_m), 1e-3, 1e6, NULL, NULL },
        { "gp", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_gp_read },
        { "singles", KEY_FLAG, false, offsetof(struct plant_group, cuts_singles), 0, 0, singles_choices, NULL },
        { "fill", KEY_CHOICE, false, offsetof(struct plant_group, fill), 0, 0, fill_choices, NULL },
        { "scale", KEY_FLAG, false, offsetof(struct plant_group, log), 0, 0, scale_choices, NULL },
        { "breaks", KEY_CUSTOM, false, 0, 0, 0, NULL, read_breaks },
        { "isolines", KEY_CUSTOM, false, 0, 0, 0, NULL, read_isolines },
        { 0 }
    };
    struct yaml_map map;
    *group = (struct plant_group){ .limits = { NAN, NAN, NAN, NAN },
                                   .strength = 1,
                                   .decay = 1,
                                   .power = 2,
                                   .reach_m = INFINITY,
                                   .disc_m = PLANT_DISC_M,
                                   .ambient = NAN,
                                   .hot_spot_m = PLANT_HOT_SPOT_M,
                                   .gp = { NAN, NAN, NAN, NULL },
                                   .alarm_settings.priority = ALARM_PRIORITY_DEFAULT,
                                   .line = yaml_place(node).line };
    if (!yaml_map_read(reader, node, "a group", keys, group, &map))
        return;
    group->prepared |= 1u << group->interpolation;
    if (group->heat && group->distance == DISTANCE_GEODESIC)
        group->distance = DISTANCE_HEAT;
    plant_gp_check(reader, &map, plant, group);
    if (!group->quantity && group->id)
        group->quantity = mem_strdup(group->id);
    if (yaml_map_good(&map, "min") && yaml_map_good(&map, "max") && group->min >= group->max)
        yaml_error(reader, yaml_map_place(&map, "min"), "min: expected less than max, which is %.9g, found %.9g", group->max, group->min);
    else if (yaml_map_good(&map, "min") && yaml_map_good(&map, "max") && !plant_range_is_wide(group->min, group->max))
        yaml_error(reader, yaml_map_place(&map, "min"),
                   "min, max: the range from %.17g to %.17g is too narrow: max must exceed min by at least %g, and by at least %g of the "
                   "larger of their absolute values",
                   group->min, group->max, PLANT_LEAST_WIDTH, PLANT_LEAST_RELATIVE_WIDTH);
    if (group->log && yaml_map_good(&map, "min") && !(group->min >= PLANT_LEAST_LOG))
        yaml_error(reader, yaml_map_place(&map, "scale"), "scale: a logarithmic scale needs min of at least %g, found %.9g",
                   PLANT_LEAST_LOG, group->min);
    plant_list_check_id(reader, &map, "group", plant->groups, plant->group_count, sizeof(*group), offsetof(struct plant_group, line));
}

static void read_groups(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    int count;
    plant->groups = plant_list_make(reader, node, "groups", 1, INT_MAX, sizeof(*plant->groups), &count);
    for (int i = 0; i < count; i++)
        read_group(reader, yaml_list_item(reader, node, i), plant, &plant->groups[plant->group_count++]);
}

/* --- other keys ------------------------------------------------------------------------------------------------------------- */

/* Does nothing for the key `convert`, because read_conversions() has already read it. */
static void skip_conversions(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    (void)reader;
    (void)node;
    (void)record;
}

/* Reads `convert` before the assets, wherever the key is in the file: a model that a conversion will make need not exist yet. */
static void read_conversions(struct yaml_reader *reader, const yaml_node_t *root, struct plant *plant)
{
    if (!root || root->type != YAML_MAPPING_NODE)
        return;
    for (yaml_node_pair_t *pair = root->data.mapping.pairs.start; pair < root->data.mapping.pairs.top; pair++) {
        const char *key = yaml_text(yaml_document_get_node(&reader->doc, pair->key));
        yaml_node_t *value = yaml_document_get_node(&reader->doc, pair->value);
        if (key && !strcmp(key, "convert") && !yaml_is_null(value) && !plant->conversions)
            plant_conversions_read(reader, value, plant);
    }
}

static void read_history(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_choice record_choices[] = { { "yes", 0 }, { "no", 1 }, { 0 } };
    static const struct yaml_key keys[] = {
        { "record", KEY_FLAG, false, offsetof(struct plant_history, off), 0, 0, record_choices, NULL },
        { "folder", KEY_NAME, false, offsetof(struct plant_history, folder), 0, 0, NULL, NULL },
        { "keep_days", KEY_NUMBER, false, offsetof(struct plant_history, keep_days), 1, 36500, NULL, NULL },
        { "keep_gb", KEY_NUMBER, false, offsetof(struct plant_history, keep_gb), 0.01, 1e6, NULL, NULL },
        { "deadband_percent", KEY_NUMBER, false, offsetof(struct plant_history, deadband_percent), 0, 10, NULL, NULL },
        { "override_s", KEY_NUMBER, false, offsetof(struct plant_history, override_s), 1, 86400, NULL, NULL },
        { "postgres", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_postgres_read },
        { 0 }
    };
    struct plant *plant = record;
    struct yaml_map map;
    yaml_map_read(reader, node, "history", keys, &plant->history, &map);
    plant_resolve_path(plant, &plant->history.folder);
    plant_postgres_check(reader, &map, plant, &plant->history.postgres);
}

/* --- the whole file --------------------------------------------------------------------------------------------------------- */

void plant_file_read(struct plant *plant, struct diag *diag)
{
    static const struct yaml_key keys[] = { { "plant", KEY_CUSTOM, true, 0, 0, 0, NULL, read_plant },
                                            { "assets", KEY_CUSTOM, true, 0, 0, 0, NULL, read_assets },
                                            { "groups", KEY_CUSTOM, true, 0, 0, 0, NULL, read_groups },
                                            { "sources", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_sources_read },
                                            { "colormaps", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_colormaps_read },
                                            { "environment", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_environments_read },
                                            { "convert", KEY_CUSTOM, false, 0, 0, 0, NULL, skip_conversions },
                                            { "links", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_links_read },
                                            { "history", KEY_CUSTOM, false, 0, 0, 0, NULL, read_history },
                                            { "alarms", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_alarms_read_mode },
                                            { "notify", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_notify_read },
                                            { "publish", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_publish_read },
                                            { "views", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_views_read },
                                            { "tours", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_tours_read },
                                            { "other_plants", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_other_plants_read },
                                            { "walls", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_walls_read },
                                            { "tags", KEY_NAME, true, offsetof(struct plant, files.tags_path), 0, 0, NULL, NULL },
                                            { 0 } };
    struct yaml_reader reader;
    struct yaml_map map;
    plant->up = AXIS_Z;
    plant->display.view.fov_deg = 45;
    plant->history = (struct plant_history){ .keep_days = 400, .keep_gb = 20, .deadband_percent = 0.2, .override_s = 600 };
    if (!yaml_reader_open(&reader, plant->files.path, diag))
        return;
    read_conversions(&reader, yaml_document_get_root_node(&reader.doc), plant);
    yaml_map_read(&reader, yaml_document_get_root_node(&reader.doc), "the plant file", keys, plant, &map);
    plant_alarms_check(&reader, yaml_map_place(&map, "alarms"), plant);
    if (plant->notify && plant->history.off)
        yaml_error(&reader, yaml_map_place(&map, "notify"),
                   "`notify` requires `record: yes` in `history`, because sent notifications are stored there");
    if (!plant->time_zone)
        plant->time_zone = mem_strdup("UTC");
    stand_upright(plant);
    plant_resolve_path(plant, &plant->files.tags_path);
    if (plant->files.tags_path && access(plant->files.tags_path, R_OK) != 0) {
        yaml_error(&reader, yaml_map_place(&map, "tags"), "tags: the tag list '%s' cannot be read: %s", plant->files.tags_path,
                   strerror(errno));
        mem_free(plant->files.tags_path);
        plant->files.tags_path = NULL;
    }
    yaml_reader_close(&reader);
}
