/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads each model's header once, and checks all assets and tags against it. */
#include "plant/models/model_check.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/system/memory.h"
#include "plant/models/asset_size.h"
#include "plant/models/model_header.h"
#include "plant/sensors.h"

#define SAME_PLACE_M 1e-3 /* distance in metres below which positions of model nodes count as equal; the same value as in plantcast-prep */
/* tolerated distance of a sensor from its asset's bounding box in metres, in addition to a fraction of the box's diagonal */
#define SLACK_M 0.5
#define SLACK 0.05
enum { WHY_BYTES = 400, SHOWN_NODES = 6 };
/* Memory in bytes needed to serve a plant: TRIANGLE_BYTES for each triangle, plus BASE_BYTES. Measured with 20 million
   triangles in 3,040 assets: 3.1 GB. */
enum { TRIANGLE_BYTES = 150, BASE_BYTES = 350 << 20 };

struct plant_models_check {
    const struct plant *plant;
    struct diag *diag;
    struct model_header header; /* header of the model file that is being checked */
    bool *taken;                /* by model node: true: the node belongs to the asset being checked */
    bool *counted;              /* by model node: true: the node belongs to an asset checked so far, so its triangles are already counted */
    uint64_t triangles;         /* number of triangles of all models; a model shared by several assets counts once */
    uint32_t *found;
};

/* --- boxes ---------------------------------------------------------------------------------------------------------------------- */

/* Converts a bounding box from model units and axes to metres, Z up. */
static struct model_box in_asset(const struct model_box *box, double unit_m, enum axis up)
{
    struct model_box out;
    for (int axis = 0; axis < 3; axis++) {
        out.low[axis] = box->low[axis] * unit_m;
        out.high[axis] = box->high[axis] * unit_m;
    }
    if (up == AXIS_Z)
        return out;
    return (struct model_box){ { out.low[0], -out.high[2], out.low[1] }, { out.high[0], -out.low[2], out.high[1] } };
}

static bool is_within(const struct model_box *box, const double place_m[3])
{
    double diagonal2 = 0;
    for (int axis = 0; axis < 3; axis++)
        diagonal2 += (box->high[axis] - box->low[axis]) * (box->high[axis] - box->low[axis]);
    double slack_m = SLACK_M + SLACK * sqrt(diagonal2);
    for (int axis = 0; axis < 3; axis++)
        if (!(place_m[axis] >= box->low[axis] - slack_m && place_m[axis] <= box->high[axis] + slack_m))
            return false;
    return true;
}

static size_t count_within(const struct model_box *box, const struct plant_sensor *sensors, size_t count, size_t *placed)
{
    size_t within = 0;
    *placed = 0;
    for (size_t i = 0; i < count; i++) {
        *placed += !sensors[i].node;
        within += !sensors[i].node && is_within(box, sensors[i].position_m);
    }
    return within;
}

/* --- sensors -------------------------------------------------------------------------------------------------------------------- */

/* Looks for other units, or another upward axis, with which at least 90 % of the sensors would be within the asset's bounding
   box. Returns whether it found any. */
static bool find_better(const struct plant_asset *asset, const struct model_box *box, const struct plant_sensor *sensors, size_t count,
                        size_t within, char *out, size_t bytes)
{
    static const struct {
        const char *name;
        double m;
        /* units in ascending order, so that the smallest unit that fits is chosen */
    } units[] = { { "mm", 1e-3 }, { "cm", 1e-2 }, { "in", 0.0254 }, { "ft", 0.3048 }, { "m", 1 } };
    size_t best = within, placed;
    for (int pass = 0; pass < 3; pass++) /* pass 0: tries the other upward axis; 1: other units; 2: both */
        for (int u = pass ? 0 : -1; u < (pass ? 5 : 0); u++) {
            bool turn = pass != 1;
            enum axis up = turn ? (asset->up == AXIS_Y ? AXIS_Z : AXIS_Y) : asset->up;
            struct model_box other = in_asset(box, u < 0 ? asset->unit_m : units[u].m, up);
            size_t now = count_within(&other, sensors, count, &placed);
            if (now <= best || now * 10 < placed * 9)
                continue;
            best = now;
            snprintf(out, bytes, "%s%s%s%s%s", turn ? (up == AXIS_Z ? "`up: z`" : "`up: y`") : "", turn && u >= 0 ? " and " : "",
                     u >= 0 ? "`units: " : "", u >= 0 ? units[u].name : "", u >= 0 ? "`" : "");
        }
    return best > within;
}

static void check_places(struct plant_models_check *check, size_t asset_index, const struct model_box *box)
{
    const struct plant_asset *asset = &check->plant->assets[asset_index];
    struct plant_sensor *sensors;
    size_t count = plant_sensors(check->plant, (int)asset_index, &sensors), placed;
    struct model_box own = in_asset(box, asset->unit_m, asset->up);
    size_t within = count_within(&own, sensors, count, &placed);
    char better[60];
    if (!check->header.partial && placed - within > placed / 2) {
        if (find_better(asset, box, sensors, count, within, better, sizeof(better)))
            diag_warning(
                check->diag, check->plant->files.path, asset->line, 0,
                "asset %s: %zu of the %zu sensors with X, Y, Z are far from the asset; with %s in the plant file, they would be on it",
                asset->id, placed - within, placed, better);
        else
            diag_warning(
                check->diag, check->plant->files.path, asset->line, 0,
                "asset %s: %zu of the %zu sensors with X, Y, Z are far from the asset: check units, up, placement and sensor_frame",
                asset->id, placed - within, placed);
    }
    mem_free(sensors);
}

/* Computes the place of a node as plantcast-prep does: the middle of its triangles, or the origin of its coordinate frame if it has no
   triangles. */
static void place_of(const struct model_header *header, uint32_t node, double out[3])
{
    struct model_box box = model_box_empty;
    for (uint32_t i = node; i < header->nodes[node].end; i++)
        model_box_add(&box, &header->boxes[i]);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = box.low[axis] <= box.high[axis] ? (box.low[axis] + box.high[axis]) / 2 : header->origins[node][axis];
}

/* Returns whether all nodes of the model with a certain name have the same position. If nodes of that name belong to the asset,
   compares only these. *count receives the number of nodes compared. Returns true if the header lacks some positions, because
   plantcast-prep compares them later. */
static bool is_one_place(const struct plant_models_check *check, const struct plant_asset *asset, size_t *count)
{
    size_t own = 0;
    double first[3], other[3];
    for (size_t i = 0; i < *count; i++)
        if (check->taken[check->found[i]])
            check->found[own++] = check->found[i];
    *count = own ? own : *count;
    if (check->header.partial)
        return true;
    place_of(&check->header, check->found[0], first);
    for (size_t i = 1; i < *count; i++) {
        place_of(&check->header, check->found[i], other);
        for (int axis = 0; axis < 3; axis++)
            if (!(fabs(other[axis] - first[axis]) * asset->unit_m <= SAME_PLACE_M))
                return false;
    }
    return true;
}

static void check_node(struct plant_models_check *check, const struct plant_asset *asset, const struct plant_tag *tag)
{
    char why[WHY_BYTES], numbers[120] = "";
    size_t count = nodes_find(tag->place.node, check->header.nodes, check->header.count, check->found, why, sizeof(why));
    if (count == 0) {
        diag_error(check->diag, check->plant->files.tags_path, tag->line, tag->column, "tag %s: asset %s: %s", tag->name, asset->id, why);
        return;
    }
    if (is_one_place(check, asset, &count))
        return;
    for (size_t i = 0, length = 0; i < count && i < SHOWN_NODES; i++)
        length += (size_t)snprintf(numbers + length, sizeof(numbers) - length, "%s#%u", i ? ", " : "",
                                   check->header.nodes[check->found[i]].number);
    diag_error(check->diag, check->plant->files.tags_path, tag->line, tag->column,
               "tag %s: asset %s: the model has %zu nodes '%.120s', in different places (%s%s): name one node by its number or its path",
               tag->name, asset->id, count, tag->place.node, numbers, count > SHOWN_NODES ? ", ..." : "");
}

/* --- assets --------------------------------------------------------------------------------------------------------------------- */

/* Checks one asset against its model: size, nodes and sensors. Returns false if its size is unknown. */
static bool check_asset(struct plant_models_check *check, size_t index, double size_m[3])
{
    const struct plant_asset *asset = &check->plant->assets[index];
    const struct plant *plant = check->plant;
    struct model_box box = model_box_empty;
    char why[WHY_BYTES];
    if (!nodes_take(asset->nodes, check->header.nodes, check->header.count, check->taken, why, sizeof(why))) {
        diag_error(check->diag, plant->files.path, asset->line, 0, "asset %s: nodes: %s", asset->id, why);
        return false;
    }
    for (size_t i = 0; i < check->header.count; i++)
        if (check->taken[i]) {
            model_box_add(&box, &check->header.boxes[i]);
            check->triangles += check->counted[i] ? 0 : model_header_triangles(&check->header, i);
            check->counted[i] = true;
        }
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].asset == (int)index && plant->tags[i].group >= 0 && plant->tags[i].place.node &&
            !plant->tags[i].place.has_position)
            check_node(check, asset, &plant->tags[i]);
    if (!(box.low[0] <= box.high[0])) {
        if (!check->header.partial)
            diag_error(check->diag, plant->files.path, asset->line, 0, "asset %s: the model nodes selected by `nodes` have no triangles",
                       asset->id);
        return false;
    }
    check_places(check, index, &box);
    struct model_box own = in_asset(&box, asset->unit_m, asset->up);
    for (int axis = 0; axis < 3; axis++)
        size_m[axis] = own.high[axis] - own.low[axis];
    return true;
}

/* Checks all assets of one model; `first` is the index of the model's first asset. */
static void check_model(struct plant_models_check *check, size_t first, bool *done, double (*sizes_m)[3])
{
    const struct plant *plant = check->plant;
    const char *path = plant->assets[first].model;
    char why[WHY_BYTES];
    bool good = model_header_read(&check->header, path, why, sizeof(why));
    if (!good)
        diag_error(check->diag, plant->files.path, plant->assets[first].line, 0, "asset %s: model '%s' %s", plant->assets[first].id, path,
                   why);
    check->taken = mem_array(check->header.count + 1, sizeof(*check->taken));
    check->counted = mem_array(check->header.count + 1, sizeof(*check->counted));
    check->found = mem_array(check->header.count + 1, sizeof(*check->found));
    for (size_t i = first; i < plant->asset_count; i++) {
        if (done[i] || !plant->assets[i].model || strcmp(plant->assets[i].model, path) != 0)
            continue;
        done[i] = true;
        if (!good || !check_asset(check, i, sizes_m[i]))
            sizes_m[i][0] = NAN;
    }
    mem_free(check->taken);
    mem_free(check->counted);
    mem_free(check->found);
    if (good)
        model_header_finish(&check->header);
}

static void check_sizes(const struct plant_models_check *check, const double (*sizes_m)[3], FILE *out)
{
    const struct plant *plant = check->plant;
    double *longest_m = mem_array(plant->asset_count, sizeof(*longest_m));
    size_t count = 0;
    for (size_t i = 0; i < plant->asset_count; i++)
        if (!isnan(sizes_m[i][0]))
            longest_m[count++] = asset_longest_m(sizes_m[i]);
    double median_m = asset_median_m(longest_m, count);
    for (size_t i = 0; i < plant->asset_count; i++) {
        char text[SIZE_TEXT_BYTES], why[SIZE_WHY_BYTES];
        if (isnan(sizes_m[i][0]))
            continue;
        if (out)
            fprintf(out, "asset %s: %s\n", plant->assets[i].id, asset_size_text(sizes_m[i], text));
        if (asset_size_doubtful(&plant->assets[i], sizes_m[i], median_m, why))
            diag_warning(check->diag, plant->files.path, plant->assets[i].line, 0, "asset %s: %s", plant->assets[i].id, why);
    }
    mem_free(longest_m);
}

static bool check_memory(const struct plant_models_check *check, size_t machine)
{
    uint64_t most = machine > BASE_BYTES ? (machine - BASE_BYTES) / TRIANGLE_BYTES : 0;
    if (check->triangles <= most)
        return true;
    diag_error(check->diag, check->plant->files.path, 0, 0,
               "%.2f million triangles are too many: %.2f GB of memory hold at most %.2f million. Leave parts of the plant out, or import "
               "it with a larger --chord",
               (double)check->triangles / 1e6, (double)machine / 1e9, (double)most / 1e6);
    return false;
}

bool models_check(const struct plant *plant, size_t memory_bytes, struct diag *diag, FILE *out)
{
    struct plant_models_check check = { .plant = plant, .diag = diag };
    bool *done = mem_array(plant->asset_count, sizeof(*done));
    double(*sizes_m)[3] = mem_array(plant->asset_count, sizeof(*sizes_m));
    for (size_t i = 0; i < plant->asset_count; i++)
        if (!done[i])
            check_model(&check, i, done, sizes_m);
    check_sizes(&check, (const double(*)[3])sizes_m, out);
    mem_free(done);
    mem_free(sizes_m);
    return check_memory(&check, memory_bytes ? memory_bytes : memory_machine_bytes());
}
