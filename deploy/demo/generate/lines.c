/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pipe runs, section by section. Pipe radii: 0.057 (4"), 0.084 (6"), 0.110 (8"), 0.162 (12"). */
#include "lines.h"

#include "context.h"
#include "fitting.h"
#include "pipe.h"
#include "shape.h"

#define HOT_M 0.05 /* insulation */
#define UP vec(0, 0, 1)
#define SOUTH vec(0, -1, 0)
#define WEST vec(-1, 0, 0)
#define BATTERY_LIMIT_M 19.6
#define SLEEPER_Y_M -11.3 /* low pipes along the south edge */

/* A run along the rack from x0 to x1, its underside 0.1 m above the steel, on shoes. */
static void rack_run(struct site *site, struct item *item, double y, double steel_z, double x0, double x1, double r, enum material material,
                     double insulation, double step_m)
{
    double z = steel_z + 0.1 + r + insulation;
    struct pipe pipe = pipe_from_point(site, item, vec(x0, y, z), r, material, insulation);
    pipe.step_m = step_m;
    pipe_go(&pipe, "x", vec(x1, y, z));
    pipe_blind_first(&pipe);
    pipe_blind_last(&pipe);
    pipe_end(&pipe);
    for (int i = 0; i < RACK_BENT_COUNT; i++) {
        double x = RACK_BENT_M * (i - (RACK_BENT_COUNT - 1) / 2.0);
        if (x > fmin(x0, x1) && x < fmax(x0, x1))
            fitting_pipe_shoe(&site->access, vec(x, y, z - r - insulation), vec(1, 0, 0), 0.1);
    }
}

static void posts_along(struct pipe *pipe, double first, double spacing, int count)
{
    for (int i = 0; i < count; i++)
        pipe_post(pipe, first + spacing * i);
}

static void feed_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-101", frame_at(0, 0, 0));
    struct pipe suction = pipe_from_nozzle(site, &item, "TK-101/N1", 0.084, MATERIAL_PIPE, 0);
    pipe_gate_valve(&suction, 0.42, UP);
    pipe_go(&suction, "yzx", vec(3.4, -6.2, 0.82));
    posts_along(&suction, 2.2, 2.6, 3);
    pipe_into_nozzle(&suction, "xzy", "P-101A/N1");
    pipe_gate_valve(&suction, 0.62, UP);
    pipe_end(&suction);
    struct pipe spare = pipe_from_point(site, &item, vec(5.6, -6.2, 0.82), 0.084, MATERIAL_PIPE, 0);
    pipe_into_nozzle(&spare, "xzy", "P-101B/N1");
    pipe_gate_valve(&spare, 0.62, UP);
    pipe_end(&spare);

    struct pipe header = pipe_from_nozzle(site, &item, "P-101B/N2", 0.084, MATERIAL_PIPE, 0);
    pipe_go(&header, "z", vec(0, 0, 2.5));
    pipe_gate_valve(&header, 0.62, SOUTH);
    pipe_go(&header, "yz", vec(0, SLEEPER_Y_M, 0.47));
    pipe_go(&header, "x", vec(-16.0, 0, 0));
    posts_along(&header, 1.4, 3.0, 7);
    pipe_control_valve(&header, 9.0, UP);
    pipe_into_nozzle(&header, "xyz", "E-101/N1");
    pipe_end(&header);
    struct pipe riser = pipe_from_nozzle(site, &item, "P-101A/N2", 0.084, MATERIAL_PIPE, 0);
    pipe_go(&riser, "z", vec(0, 0, 2.5));
    pipe_gate_valve(&riser, 0.62, SOUTH);
    pipe_go(&riser, "yz", vec(0, SLEEPER_Y_M, 0.47));
    pipe_end(&riser);

    struct pipe warm = pipe_from_nozzle(site, &item, "E-101/N2", 0.084, MATERIAL_PIPE, HOT_M);
    pipe_go(&warm, "zy", vec(0, 7.7, 3.3));
    posts_along(&warm, 5.6, 4.6, 2);
    pipe_go(&warm, "z", vec(0, 0, 4.53));
    pipe_into_nozzle(&warm, "xyz", "T-101/N3");
    pipe_end(&warm);
    item_end(&item);
}

static void overhead_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-102", frame_at(0, 0, 0));
    struct pipe vapour = pipe_from_nozzle(site, &item, "T-101/N1", 0.162, MATERIAL_PIPE, HOT_M);
    pipe_go(&vapour, "yzx", vec(0, 5.35, 12.0));
    pipe_go(&vapour, "x", vec(11.2, 0, 0));
    pipe_into_nozzle(&vapour, "yxz", "EA-101/N2");
    pipe_end(&vapour);
    struct pipe branch = pipe_from_point(site, &item, vec(6.8, 5.35, 12.0), 0.110, MATERIAL_PIPE, HOT_M);
    pipe_into_nozzle(&branch, "yxz", "EA-101/N1");
    pipe_end(&branch);
    struct mesh *steel = item_part(&site->access, "supports", MATERIAL_STRUCTURE);
    for (int i = 0; i < 2; i++) { /* goal posts on the structure's top floor */
        double x = i ? 4.6 : -3.0;
        shape_block(steel, frame_at(x, 5.35, 0), -0.08, 0.08, -0.45, -0.33, STRUCTURE_HIGH_M, 11.78);
        shape_block(steel, frame_at(x, 5.35, 0), -0.08, 0.08, 0.33, 0.45, STRUCTURE_HIGH_M, 11.78);
        shape_block(steel, frame_at(x, 5.35, 0), -0.09, 0.09, -0.55, 0.55, 11.64, 11.79);
    }
    for (int i = 0; i < 3; i++) /* guides on the column */
        shape_block(steel, frame_at(-8.2, 0, 14.0 + 2.6 * i), -0.3, 0.3, 4.4, 5.2, -0.06, 0.06);

    struct pipe condensed = pipe_from_nozzle(site, &item, "EA-101/N4", 0.110, MATERIAL_PIPE, 0);
    pipe_go(&condensed, "zx", vec(4.2, 0, 9.475)); /* west of the fans */
    pipe_into_nozzle(&condensed, "yxz", "E-103/N3");
    pipe_end(&condensed);
    struct pipe west = pipe_from_nozzle(site, &item, "EA-101/N3", 0.084, MATERIAL_PIPE, 0);
    pipe_go(&west, "z", vec(0, 0, 9.475));
    pipe_end(&west);
    struct pipe down = pipe_from_nozzle(site, &item, "E-103/N4", 0.110, MATERIAL_PIPE, 0);
    pipe_into_nozzle(&down, "xyz", "V-101/N1");
    pipe_end(&down);
    item_end(&item);
}

static void reflux_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-103", frame_at(0, 0, 0));
    struct pipe suction = pipe_from_nozzle(site, &item, "V-101/N2", 0.084, MATERIAL_PIPE, 0);
    pipe_go(&suction, "zy", vec(0, -2.7, 0.82));
    posts_along(&suction, 1.5, 2.2, 2);
    pipe_go(&suction, "x", vec(-1.6, 0, 0));
    pipe_into_nozzle(&suction, "xzy", "P-102A/N1");
    pipe_gate_valve(&suction, 0.45, UP);
    pipe_end(&suction);
    struct pipe spare = pipe_from_point(site, &item, vec(0.6, -2.7, 0.82), 0.084, MATERIAL_PIPE, 0);
    pipe_into_nozzle(&spare, "xzy", "P-102B/N1");
    pipe_gate_valve(&spare, 0.45, UP);
    pipe_end(&spare);

    struct pipe reflux = pipe_from_nozzle(site, &item, "P-102B/N2", 0.070, MATERIAL_PIPE, 0);
    pipe_go(&reflux, "z", vec(0, 0, 3.4));
    pipe_gate_valve(&reflux, 0.60, SOUTH);
    pipe_go(&reflux, "xy", vec(-4.9, 6.2, 0));
    posts_along(&reflux, 2.0, 3.6, 2);
    pipe_into_nozzle(&reflux, "xyz", "T-101/N2");
    pipe_end(&reflux);
    struct pipe riser = pipe_from_nozzle(site, &item, "P-102A/N2", 0.070, MATERIAL_PIPE, 0);
    pipe_go(&riser, "z", vec(0, 0, 3.4));
    pipe_gate_valve(&riser, 0.60, SOUTH);
    pipe_end(&riser);

    struct pipe product = pipe_from_point(site, &item, vec(-2.7, -4.08, 3.4), 0.057, MATERIAL_PIPE, 0);
    pipe_go(&product, "yx", vec(-8.6, -5.1, 0));
    pipe_control_valve(&product, 2.6, UP);
    pipe_into_nozzle(&product, "yxz", "E-105/N3");
    pipe_end(&product);
    struct pipe rundown = pipe_from_nozzle(site, &item, "E-105/N4", 0.057, MATERIAL_PIPE, 0);
    pipe_go(&rundown, "xy", vec(-7.3, SLEEPER_Y_M + 0.35, 0));
    pipe_go(&rundown, "x", vec(6.5, 0, 0));
    posts_along(&rundown, 2.0, 3.2, 4);
    pipe_go(&rundown, "y", vec(0, -6.75, 0));
    pipe_into_nozzle(&rundown, "xyz", "TK-102/N2");
    pipe_end(&rundown);
    item_end(&item);
}

static void bottoms_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-104", frame_at(0, 0, 0));
    struct pipe feed = pipe_from_nozzle(site, &item, "T-101/N5", 0.110, MATERIAL_PIPE, HOT_M);
    pipe_go(&feed, "zy", vec(0, 5.2, 0.27)); /* north of the kettle; its suction line leaves to the south */
    pipe_go(&feed, "x", vec(-15.65, 0, 0));
    pipe_into_nozzle(&feed, "xyz", "E-102/N4");
    pipe_end(&feed);
    struct pipe vapour = pipe_from_nozzle(site, &item, "E-102/N3", 0.162, MATERIAL_PIPE, HOT_M);
    pipe_into_nozzle(&vapour, "zyx", "T-101/N4");
    pipe_end(&vapour);
    struct pipe suction = pipe_from_nozzle(site, &item, "E-102/N5", 0.084, MATERIAL_PIPE, HOT_M);
    pipe_go(&suction, "y", vec(0, -2.7, 0));
    posts_along(&suction, 2.6, 2.4, 2);
    pipe_go(&suction, "zx", vec(-6.0, 0, 0.82));
    posts_along(&suction, 2.0, 2.6, 2);
    pipe_go(&suction, "x", vec(-3.8, 0, 0));
    pipe_into_nozzle(&suction, "xzy", "P-103B/N1");
    pipe_gate_valve(&suction, 0.45, UP);
    pipe_end(&suction);
    struct pipe spare = pipe_from_point(site, &item, vec(-6.0, -2.7, 0.82), 0.084, MATERIAL_PIPE, HOT_M);
    pipe_into_nozzle(&spare, "xzy", "P-103A/N1");
    pipe_gate_valve(&spare, 0.45, UP);
    pipe_end(&spare);

    struct pipe hot = pipe_from_nozzle(site, &item, "P-103B/N2", 0.070, MATERIAL_PIPE, HOT_M);
    pipe_go(&hot, "z", vec(0, 0, 2.85));
    pipe_gate_valve(&hot, 0.60, SOUTH);
    pipe_go(&hot, "x", vec(-16.0, 0, 0));
    posts_along(&hot, 4.6, 4.2, 2);
    pipe_into_nozzle(&hot, "yxz", "E-101/N3");
    pipe_end(&hot);
    struct pipe riser = pipe_from_nozzle(site, &item, "P-103A/N2", 0.070, MATERIAL_PIPE, HOT_M);
    pipe_go(&riser, "z", vec(0, 0, 2.85));
    pipe_gate_valve(&riser, 0.60, SOUTH);
    pipe_end(&riser);
    struct pipe cooled = pipe_from_nozzle(site, &item, "E-101/N4", 0.084, MATERIAL_PIPE, HOT_M);
    pipe_go(&cooled, "x", vec(-13.7, 0, 0));
    pipe_into_nozzle(&cooled, "zyx", "E-104/N3");
    pipe_end(&cooled);

    struct pipe product = pipe_from_nozzle(site, &item, "E-104/N4", 0.070, MATERIAL_PIPE, 0);
    pipe_go(&product, "x", vec(-10.1, 0, 0));
    pipe_go(&product, "y", vec(0, -6.0, 0));
    pipe_control_valve(&product, 1.0, UP);
    pipe_go(&product, "yxz", vec(-11.0, -3.6, 1.2)); /* over the suction and reboiler lines */
    pipe_go(&product, "y", vec(0, 8.2, 0));
    posts_along(&product, 1.6, 2.8, 3);
    pipe_go(&product, "zx", vec(-BATTERY_LIMIT_M, 0, 4.47));
    pipe_blind_last(&product);
    pipe_end(&product);
    item_end(&item);
}

static void offgas_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-105", frame_at(0, 0, 0));
    struct pipe vapour = pipe_from_nozzle(site, &item, "V-101/N3", 0.084, MATERIAL_PIPE, 0);
    pipe_go(&vapour, "x", vec(6.6, 0, 0));
    pipe_control_valve(&vapour, 1.2, SOUTH);
    pipe_go(&vapour, "z", vec(0, 0, 2.4));
    pipe_into_nozzle(&vapour, "zyx", "V-102/N1");
    pipe_end(&vapour);
    struct pipe suction = pipe_from_nozzle(site, &item, "V-102/N2", 0.084, MATERIAL_PIPE, 0);
    pipe_go(&suction, "x", vec(12.92, 0, 0));
    pipe_into_nozzle(&suction, "xyz", "K-101/N1");
    pipe_gate_valve(&suction, 1.7, SOUTH);
    pipe_end(&suction);
    struct pipe discharge = pipe_from_nozzle(site, &item, "K-101/N2", 0.070, MATERIAL_PIPE, HOT_M);
    pipe_go(&discharge, "z", vec(0, 0, 4.0));
    pipe_gate_valve(&discharge, 0.8, SOUTH);
    pipe_go(&discharge, "y", vec(0, 8.0, 0));
    pipe_go(&discharge, "zx", vec(BATTERY_LIMIT_M, 0, RACK_HIGH_M + 0.22));
    pipe_blind_last(&discharge);
    pipe_end(&discharge);
    item_end(&item);
}

/* Supply from below ground to the channel's lower nozzle, return from the upper one into the ground. */
static void water_riser(struct site *site, struct item *item, const char *supply, const char *back, double x, double y)
{
    struct pipe in = pipe_from_nozzle(site, item, supply, 0.084, MATERIAL_COOLING_WATER, 0);
    pipe_go(&in, "y", vec(0, y - 1.35, 0));
    pipe_gate_valve(&in, 0.72, UP);
    pipe_go(&in, "z", vec(0, 0, -0.2));
    pipe_end(&in);
    struct pipe out = pipe_from_nozzle(site, item, back, 0.084, MATERIAL_COOLING_WATER, 0);
    pipe_go(&out, "xz", vec(x + 0.75, 0, -0.2));
    pipe_gate_valve(&out, 0.95, vec(1, 0, 0));
    pipe_end(&out);
}

static void water_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-106", frame_at(0, 0, 0));
    rack_run(site, &item, 9.2, RACK_LOW_M, -BATTERY_LIMIT_M, 16.0, 0.162, MATERIAL_COOLING_WATER, 0, 0.8);
    rack_run(site, &item, 9.9, RACK_LOW_M, -BATTERY_LIMIT_M, 16.0, 0.162, MATERIAL_COOLING_WATER, 0, 0.8);
    water_riser(site, &item, "E-104/N1", "E-104/N2", -11.6, -9.0);
    water_riser(site, &item, "E-105/N1", "E-105/N2", -8.6, -9.0);
    struct pipe supply = pipe_from_nozzle(site, &item, "E-103/N1", 0.084, MATERIAL_COOLING_WATER, 0);
    pipe_go(&supply, "zy", vec(0, 9.2, 6.75));
    pipe_gate_valve(&supply, 2.9, UP);
    pipe_go(&supply, "z", vec(0, 0, RACK_LOW_M + 0.26));
    pipe_end(&supply);
    struct pipe back = pipe_from_nozzle(site, &item, "E-103/N2", 0.084, MATERIAL_COOLING_WATER, 0);
    pipe_go(&back, "y", vec(0, 9.9, 0));
    pipe_gate_valve(&back, 3.2, UP);
    pipe_go(&back, "z", vec(0, 0, RACK_LOW_M + 0.26));
    pipe_end(&back);
    item_end(&item);
}

static void steam_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-107", frame_at(0, 0, 0));
    const double z = RACK_HIGH_M + 0.1 + 0.110 + HOT_M, x = model_nozzle(&site->model, "E-102/N1")->at.o.x;
    rack_run(site, &item, 8.0, RACK_HIGH_M, -BATTERY_LIMIT_M, 12.6, 0.110, MATERIAL_PIPE, HOT_M, 0.8);
    struct pipe drop = pipe_from_point(site, &item, vec(x, 8.0, z), 0.084, MATERIAL_PIPE, HOT_M);
    pipe_go(&drop, "zy", vec(0, 3.6, z + 0.6));
    pipe_into_nozzle(&drop, "xyz", "E-102/N1");
    pipe_control_valve(&drop, 2.6, WEST);
    pipe_end(&drop);
    struct pipe condensate = pipe_from_nozzle(site, &item, "E-102/N2", 0.045, MATERIAL_PIPE, 0.04);
    pipe_go(&condensate, "xy", vec(-18.7, 8.9, 0));
    pipe_go(&condensate, "zx", vec(-BATTERY_LIMIT_M, 0, RACK_LOW_M + 0.19));
    pipe_blind_last(&condensate);
    pipe_end(&condensate);
    item_end(&item);
}

/* What only passes through. */
static void passing_lines(struct site *site)
{
    struct item item = item_begin(&site->model, "L-108", frame_at(0, 0, 0));
    rack_run(site, &item, 10.7, RACK_LOW_M, -BATTERY_LIMIT_M, BATTERY_LIMIT_M, 0.084, MATERIAL_PIPE, 0, 6.0);
    rack_run(site, &item, 11.3, RACK_LOW_M, -BATTERY_LIMIT_M, BATTERY_LIMIT_M, 0.057, MATERIAL_STAINLESS, 0, 6.0);
    rack_run(site, &item, 8.8, RACK_HIGH_M, -BATTERY_LIMIT_M, BATTERY_LIMIT_M, 0.110, MATERIAL_PIPE, HOT_M, 6.0);
    rack_run(site, &item, 9.5, RACK_HIGH_M, -BATTERY_LIMIT_M, BATTERY_LIMIT_M, 0.070, MATERIAL_PIPE, HOT_M, 6.0);
    rack_run(site, &item, 10.2, RACK_HIGH_M, -BATTERY_LIMIT_M, BATTERY_LIMIT_M, 0.084, MATERIAL_PIPE, 0, 6.0);
    rack_run(site, &item, 10.8, RACK_HIGH_M, -BATTERY_LIMIT_M, BATTERY_LIMIT_M, 0.045, MATERIAL_PIPE, 0, 6.0);
    item_end(&item);
}

void lines_build(struct site *site)
{
    feed_lines(site);
    overhead_lines(site);
    reflux_lines(site);
    bottoms_lines(site);
    offgas_lines(site);
    water_lines(site);
    steam_lines(site);
    passing_lines(site);
}
