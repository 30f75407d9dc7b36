/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the report on preparing a plant as text: possible problems, then tables. */
#include "preprocess/report/report.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "plant/models/asset_size.h"
#include "preprocess/report/text_table.h"

#define ROWS_MAX 40 /* maximum number of rows per table, unless all rows are requested */
#define CONCERNS_MAX 20

struct text_report {
    const struct prepare *prepare;
    /* one entry per asset, in the order of the tables: assets with problems first, then the slowest to build; the entries'
       texts are not set */
    struct report_concern *order;
    size_t count, rows;
    FILE *out;
};

static const char *number(size_t value, struct text_table_number *room)
{
    *room = text_table_number(value);
    return room->text;
}
#define NUMBER(value) number(value, &(struct text_table_number){ 0 })

static const char *mark(const struct report_concern *order)
{
    return order->weight > 0 ? "!" : " ";
}

static void print(const struct text_report *report, const char *title, struct text_table *table)
{
    if (table->cell_count) {
        fprintf(report->out, "\n%s\n", title);
        text_table_print(table, report->rows, report->out);
    }
    text_table_finish(table);
}

static void print_assets(const struct text_report *report)
{
    static const struct text_table_column columns[] = {
        { "", false },        { "asset", false },       { "state", false }, { "nodes", true },   { "triangles", true },
        { "vertices", true }, { "added", true },        { "size", false },  { "sensors", true }, { "without area", true },
        { "repeated", true }, { "normals made", true }, { "lines", true },  { "points", true },  { "seconds", true },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    for (size_t i = 0; i < report->count; i++) {
        const struct prepare_asset *asset = report->order[i].asset;
        const struct build_report *r = &asset->report;
        text_table_add(&table, "%s", mark(&report->order[i]));
        text_table_add(&table, "%s", asset->plant->id);
        text_table_add(&table, "%s", report_states[asset->state]);
        text_table_add(&table, "%s", asset->reported ? NUMBER(r->nodes) : "");
        text_table_add(&table, "%s", NUMBER(asset->triangles));
        text_table_add(&table, "%s", NUMBER(asset->vertices));
        text_table_add(&table, "%s", asset->reported ? NUMBER(report_added(asset)) : "");
        text_table_add(&table, "%s",
                       asset_longest_m(asset->size_m) > 0 ? asset_size_text(asset->size_m, (char[SIZE_TEXT_BYTES]){ 0 }) : "");
        text_table_add(&table, "%s", NUMBER(asset->sensor_count));
        text_table_add(&table, "%s", r->degenerate_triangles ? NUMBER(r->degenerate_triangles) : "");
        text_table_add(&table, "%s", r->repeated_triangles ? NUMBER(r->repeated_triangles) : "");
        text_table_add(&table, "%s", r->computed_normals ? NUMBER(r->computed_normals) : "");
        text_table_add(&table, "%s", r->skipped_lines ? NUMBER(r->skipped_lines) : "");
        text_table_add(&table, "%s", r->skipped_points ? NUMBER(r->skipped_points) : "");
        text_table_add(&table, "%.2f", asset->seconds);
    }
    print(report, "Assets (added: vertices that plantcast-prep added; repeated: duplicate triangles; lines, points: skipped primitives)",
          &table);
}

static void print_surfaces(const struct text_report *report)
{
    static const struct text_table_column columns[] = {
        { "", false },          { "asset", false },    { "pieces", true },   { "open edges", true }, { "bridges", true },
        { "longest mm", true }, { "within mm", true }, { "k", true },        { "samples", true },    { "every mm", true },
        { "hidden", true },     { "unreached", true }, { "repeated", true }, { "differ %", true },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    for (size_t i = 0; i < report->count; i++) {
        const struct prepare_asset *asset = report->order[i].asset;
        const struct surface_report *s = &asset->report.surface;
        if (!asset->reported || s->triangles == 0)
            continue;
        text_table_add(&table, "%s", mark(&report->order[i]));
        text_table_add(&table, "%s", asset->plant->id);
        text_table_add(&table, "%s > %s", NUMBER(s->components), NUMBER(s->components_after));
        text_table_add(&table, "%s > %s", NUMBER(s->border_edges), NUMBER(s->border_edges_after));
        text_table_add(&table, "%s", NUMBER(s->bridges));
        text_table_add(&table, "%.2f", 1e3 * s->longest_bridge_m);
        text_table_add(&table, "%.2f", 1e3 * s->tolerance_m);
        text_table_add(&table, "%d", s->k);
        text_table_add(&table, "%s", NUMBER(s->samples));
        text_table_add(&table, "%.1f", 1e3 * s->spacing_m);
        text_table_add(&table, "%s", NUMBER(s->hidden_vertices));
        text_table_add(&table, "%s", NUMBER(asset->report.unreachable_vertices));
        text_table_add(&table, "%s", NUMBER(s->repeated_triangles));
        if (isnan(s->heat_disagreement))
            text_table_add(&table, "%s", "-");
        else
            text_table_add(&table, "%.2f", 100 * s->heat_disagreement);
    }
    print(report,
          "Surfaces of assets with sensors, before > after bridging gaps (differ: largest relative difference between the two distance "
          "methods; "
          "-: not compared)",
          &table);
}

static void print_clouds(const struct text_report *report)
{
    static const struct text_table_column columns[] = {
        { "", false },        { "asset", false },    { "points", true },        { "k", true },           { "every mm", true },
        { "differ %", true }, { "at most %", true }, { "reached alone", true }, { "not reached", true }, { "ours differ %", true },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    bool any = false;
    for (size_t i = 0; i < report->count; i++) {
        const struct prepare_asset *asset = report->order[i].asset;
        const struct cloud_report *cloud = &asset->report.cloud;
        if (!asset->reported || cloud->points == 0)
            continue;
        any = true;
        text_table_add(&table, "%s", mark(&report->order[i]));
        text_table_add(&table, "%s", asset->plant->id);
        text_table_add(&table, "%s", NUMBER(cloud->points));
        text_table_add(&table, "%d", cloud->k);
        text_table_add(&table, "%.1f", 1e3 * cloud->spacing_m);
        text_table_add(&table, "%.2f", 100 * cloud->mean);
        text_table_add(&table, "%.2f", 100 * cloud->worst);
        text_table_add(&table, "%s", NUMBER(cloud->reached));
        text_table_add(&table, "%s", NUMBER(cloud->unreached));
        double ours = asset->report.surface.heat_disagreement;
        text_table_add(&table, isnan(ours) ? "-" : "%.2f", 100 * ours);
    }
    if (any)
        print(report,
              "Distances by the heat method on a point cloud (differ: difference from exact distances; reached alone: vertices that "
              "only the point cloud reaches, through thin walls; ours differ: difference of exact distances from the heat method on the "
              "mesh)",
              &table);
    else
        text_table_finish(&table);
}

static void print_levels(const struct text_report *report)
{
    static const struct text_table_column columns[] = {
        { "", false },        { "asset", false },        { "level", true },      { "error mm", true },  { "triangles", true },
        { "split to", true }, { "for triangles", true }, { "for length", true }, { "for jumps", true },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    for (size_t i = 0; i < report->count; i++) {
        const struct prepare_asset *asset = report->order[i].asset;
        for (size_t l = 0; asset->reported && l < asset->report.level_count; l++) {
            const struct build_level *level = &asset->report.levels[l];
            text_table_add(&table, "%s", l ? " " : mark(&report->order[i]));
            text_table_add(&table, "%s", l ? "" : asset->plant->id);
            text_table_add(&table, "%zu", l);
            text_table_add(&table, "%.1f", 1e3 * (double)level->error_m);
            text_table_add(&table, "%s", NUMBER(level->triangles));
            text_table_add(&table, "%s", NUMBER(level->split_triangles));
            for (int limit = 0; limit < LEVEL_LIMITS; limit++)
                if (level->left[limit].edges)
                    text_table_add(&table, "%s: %.1f", NUMBER(level->left[limit].edges), (double)level->left[limit].steps);
                else
                    text_table_add(&table, "%s", "");
        }
    }
    print(report,
          "Levels of detail, before and after splitting (edges left: number of edges whose error still exceeds one step of colour, and "
          "that error in steps)",
          &table);
}

static void print_times(const struct text_report *report)
{
    static const struct text_table_column columns[] = {
        { "", false },      { "asset", false },    { "read", true },  { "weld", true },   { "bridge", true },
        { "sample", true }, { "laplacian", true }, { "solve", true }, { "levels", true }, { "split", true },
        { "factor", true }, { "check", true },     { "all", true },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    for (size_t i = 0; i < report->count; i++) {
        const struct prepare_asset *asset = report->order[i].asset;
        const struct build_report *r = &asset->report;
        const double stages[] = { r->read_s,  r->surface.weld_s, r->surface.bridge_s, r->surface.sample_s, r->surface.laplacian_s,
                                  r->solve_s, r->levels_s,       r->split_s,          r->surface.factor_s, r->surface.check_s };
        bool surface = r->surface.triangles > 0;
        if (!asset->reported)
            continue;
        text_table_add(&table, "%s", mark(&report->order[i]));
        text_table_add(&table, "%s", asset->plant->id);
        for (size_t s = 0; s < sizeof(stages) / sizeof(stages[0]); s++)
            if (surface || stages[s] > 0)
                text_table_add(&table, "%.2f", stages[s]);
            else
                text_table_add(&table, "%s", "");
        if (asset->state == PREPARE_BUILT)
            text_table_add(&table, "%.2f", asset->seconds);
        else
            text_table_add(&table, "%s", "");
    }
    print(report, "Seconds by stage of each build; some stages run in parallel", &table);
}

struct shown_sensor {
    const struct prepare_asset *asset;
    size_t number;
    double distance_m;
};

static int farthest_first(const void *a, const void *b)
{
    const struct shown_sensor *p = a, *q = b;
    double x = p->distance_m / p->asset->far_m, y = q->distance_m / q->asset->far_m;
    return x > y ? -1 : x < y;
}

static void print_sensors(const struct text_report *report)
{
    static const struct text_table_column columns[] = {
        { "", false }, { "tag", false }, { "asset", false }, { "from the surface m", true }, { "limit m", true },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    struct shown_sensor *sensors = NULL;
    size_t count = 0, capacity = 0;
    for (size_t i = 0; i < report->count; i++) {
        const struct prepare_asset *asset = report->order[i].asset;
        for (size_t s = 0; asset->surface_distances_m && s < asset->sensor_count; s++) {
            mem_grow(&sensors, &capacity, count + 1, sizeof(*sensors));
            sensors[count++] = (struct shown_sensor){ asset, s, (double)asset->surface_distances_m[s] };
        }
    }
    if (count)
        qsort(sensors, count, sizeof(*sensors), farthest_first);
    for (size_t i = 0; i < count; i++) {
        const struct prepare_asset *asset = sensors[i].asset;
        text_table_add(&table, "%s", sensors[i].distance_m > asset->far_m ? "!" : " ");
        text_table_add(&table, "%s", report->prepare->plant->tags[asset->sensors[sensors[i].number].tag].name);
        text_table_add(&table, "%s", asset->plant->id);
        text_table_add(&table, "%.4f", sensors[i].distance_m);
        text_table_add(&table, "%.3f", asset->far_m);
    }
    mem_free(sensors);
    print(report, "Sensors, sorted by distance from their surface, farthest first", &table);
}

static void print_models(const struct text_report *report)
{
    for (size_t i = 0; i < report->prepare->models.count; i++) {
        const struct model_file *model = &report->prepare->models.at[i];
        if (!model->was_parsed)
            continue;
        fprintf(report->out, "%s: read in %.2f s", model->path, model->parse_s);
        if (model->skipped_lines || model->skipped_points)
            fprintf(report->out, "; skipped: %u line primitives and %u point primitives", model->skipped_lines, model->skipped_points);
        if (model->scaled_rotations)
            fprintf(report->out, "; %u rotations were normalised to length 1", model->scaled_rotations);
        if (model->left_out_textures)
            fprintf(report->out, "; left out: %u textures or material extensions", model->left_out_textures);
        fprintf(report->out, "\n");
        for (size_t t = 0; t < model->left_out_textures && t < report->rows; t++)
            fprintf(report->out, "  left out: %s\n", model->left_out[t]);
    }
}

static void find_order(struct text_report *report, bool all, const struct report_concern *concerns, size_t concern_count)
{
    const struct prepare *prepare = report->prepare;
    report->order = mem_array(prepare->asset_count, sizeof(*report->order));
    for (size_t i = 0; i < prepare->asset_count; i++) {
        const struct prepare_asset *asset = &prepare->assets[i];
        if (asset->wanted && asset->state != PREPARE_LEFT && (all || asset->state == PREPARE_BUILT || asset->state == PREPARE_FAILED))
            report->order[report->count++] = (struct report_concern){ .asset = asset };
    }
    for (size_t c = concern_count; c-- > 0;)
        for (size_t i = 0; i < report->count; i++)
            if (report->order[i].asset == concerns[c].asset)
                report->order[i].weight = concerns[c].weight;
    qsort(report->order, report->count, sizeof(*report->order), report_concern_compare);
}

static void print_summary(const struct text_report *report)
{
    const struct prepare *prepare = report->prepare;
    size_t counts[PREPARE_BUILT + 1] = { 0 }, sensors = 0, wanted = 0;
    unsigned long long triangles = 0;
    for (size_t i = 0; i < prepare->asset_count; i++) {
        const struct prepare_asset *asset = &prepare->assets[i];
        if (!asset->wanted)
            continue;
        wanted++;
        counts[asset->state]++;
        triangles += asset->triangles;
        sensors += asset->sensor_count;
    }
    fprintf(report->out, "%s: %zu assets, %s triangles, %zu sensors: %zu built, %zu unchanged, %zu shared, %zu failed",
            prepare->plant->name, wanted, NUMBER(triangles), sensors, counts[PREPARE_BUILT], counts[PREPARE_UNCHANGED],
            counts[PREPARE_SHARED], counts[PREPARE_FAILED]);
    if (prepare->interrupted)
        fprintf(report->out, "; interrupted: %zu assets are left; run plantcast-prep again to continue", counts[PREPARE_LEFT]);
    if (prepare->removed)
        fprintf(report->out, "; %zu old files removed", prepare->removed);
    fprintf(report->out, "; %.1f s\n", prepare->seconds);
}

void report_text(const struct prepare *prepare, bool all, FILE *out)
{
    struct text_report report = { .prepare = prepare, .rows = all ? SIZE_MAX : ROWS_MAX, .out = out };
    size_t count;
    struct report_concern *concerns = report_concerns(prepare, &count);
    find_order(&report, all, concerns, count);
    print_models(&report);
    if (report.count) {
        print_assets(&report);
        print_surfaces(&report);
        print_clouds(&report);
        print_levels(&report);
        print_times(&report);
        print_sensors(&report);
        fprintf(out, "\n");
    }
    size_t shown = all || count < CONCERNS_MAX ? count : CONCERNS_MAX;
    for (size_t i = 0; i < shown; i++)
        fprintf(out, "! %s: %s\n", concerns[i].asset->plant->id, concerns[i].text);
    if (shown < count)
        fprintf(out, "... and %zu more warnings: --report text lists all warnings\n", count - shown);
    print_summary(&report);
    report_concerns_free(concerns, count);
    mem_free(report.order);
}
