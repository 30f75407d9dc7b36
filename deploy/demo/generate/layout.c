/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The unit: a stabiliser column with its feed, overhead, reflux, reboiler, bottoms and off-gas sections. North is +y; the rack runs
   along the north side, so that the view from the south-west looks over low equipment to tall. */
#include "layout.h"

#include "context.h"
#include "lines.h"

const struct layout_asset layout_assets[] = {
    { "E-101", "Feed / bottoms exchanger" },
    { "E-102", "Reboiler (kettle)" },
    { "E-103", "Overhead trim condenser" },
    { "E-104", "Bottoms product cooler" },
    { "E-105", "Distillate product cooler" },
    { "EA-101", "Overhead air-cooled condenser" },
    { "T-101", "Stabiliser column" },
    { "V-101", "Reflux drum" },
    { "V-102", "Compressor suction drum" },
    { "K-101", "Off-gas compressor" },
    { "P-101A", "Feed pump" },
    { "P-101B", "Feed pump, spare" },
    { "P-102A", "Reflux pump" },
    { "P-102B", "Reflux pump, spare" },
    { "P-103A", "Bottoms pump" },
    { "P-103B", "Bottoms pump, spare" },
    { "TK-101", "Feed tank" },
    { "TK-102", "Distillate tank" },
    { "L-101", "Feed lines" },
    { "L-102", "Overhead lines" },
    { "L-103", "Reflux and distillate lines" },
    { "L-104", "Reboiler and bottoms lines" },
    { "L-105", "Off-gas lines" },
    { "L-106", "Cooling water lines" },
    { "L-107", "Steam and condensate lines" },
    { "L-108", "Lines that pass through" },
    { "PR-101", "Pipe rack" },
    { "ST-101", "Overhead structure" },
    { "AS-101", "Access and support steel" },
    { "CIVIL", "Slab, foundations and kerbs" },
};
const int layout_asset_count = sizeof(layout_assets) / sizeof(layout_assets[0]);

static struct frame facing(double x, double y, double deg)
{
    return frame_turned(frame_at(x, y, 0), deg);
}

static void build_exchangers(struct site *site)
{
    const struct exchanger_spec feed = { 0.58, 5.4, 1.60, 0.60, 0.110, 0.110, 96, 44, 0.0375, MATERIAL_CLADDING };
    const struct exchanger_spec trim = { 0.46, 4.2, STRUCTURE_HIGH_M + 1.0, STRUCTURE_HIGH_M, 0.084, 0.110, 48, 20, 0.13, MATERIAL_VESSEL };
    const struct exchanger_spec low = { 0.44, 4.0, 1.30, 0.50, 0.084, 0.084, 48, 20, 0.13, MATERIAL_CLADDING };
    const struct exchanger_spec high = { 0.44, 4.0, 1.30, 0.50, 0.084, 0.084, 48, 20, 0.13, MATERIAL_VESSEL };
    exchanger_build(site, "E-101", facing(-16.0, -6.2, 90), &feed); /* channels to the south, where bundles are pulled */
    exchanger_build(site, "E-103", facing(0.6, 3.4, 0), &trim);
    exchanger_build(site, "E-104", facing(-11.6, -6.6, 90), &low);
    exchanger_build(site, "E-105", facing(-8.6, -6.6, 90), &high);
    kettle_build(site, "E-102", facing(-14.2, 3.6, 0));
    air_cooler_build(site, "EA-101", frame_at(9.0, 9.5, RACK_TOP_M), 4.4, 6.6);
}

static void build_pumps(struct site *site)
{
    const struct {
        const char *name;
        double x, y;
    } pumps[] = { { "P-101A", 3.4, -8.4 }, { "P-101B", 5.6, -8.4 }, { "P-102A", -1.6, -4.4 }, { "P-102B", 0.6, -4.4 },
                  { "P-103A", -6.0, -4.4 }, { "P-103B", -3.8, -4.4 } };
    for (int i = 0; i < 6; i++) {
        struct frame at = facing(pumps[i].x, pumps[i].y, -90); /* pump end to the north, motor to the south */
        if (i == 0) {
            pump_build(site, pumps[i].name, at);
            continue;
        }
        model_add_instance(&site->model, pumps[i].name, pumps[0].name, at);
        pump_plinth(site, at);
    }
    civil_kerb(site, -7.2, 1.8, -6.6, -3.0, 0.12);
    civil_kerb(site, 2.2, 6.8, -10.6, -7.0, 0.12);
}

void layout_build(struct site *site)
{
    const struct column_spec column = { 0.85, 3.0, 20.0 };
    const struct tank_spec feed_tank = { 2.9, 7.2, 240 }, distillate_tank = { 2.3, 5.6, 246 };
    civil_build(site);
    site->access = item_begin(&site->model, "AS-101", frame_at(0, 0, 0));
    rack_build(site, "PR-101");
    structure_build(site, "ST-101");
    build_exchangers(site);
    column_build(site, "T-101", frame_at(-8.2, 3.6, 0), &column);
    drum_build(site, "V-101", frame_at(0.68, 3.4, 0), 0.85, 4.2, STRUCTURE_LOW_M);
    knockout_build(site, "V-102", frame_at(9.2, 3.6, 0), 0.65, 3.2);
    compressor_build(site, "K-101", frame_at(14.6, 3.4, 0));
    build_pumps(site);
    tank_build(site, "TK-101", frame_at(16.2, -6.6, 0), &feed_tank);
    tank_build(site, "TK-102", frame_at(10.0, -9.0, 0), &distillate_tank);
    civil_kerb(site, 6.9, 19.9, -12.4, -2.9, 0.35);
    lines_build(site);
    item_end(&site->access);
    item_end(&site->civil);
}
