/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plant.yaml and tags.csv as text. */
#include "plant_file.h"

#include "base/files/atomic_file.h"
#include "base/text/text.h"
#include "layout.h"

static const char head[] =
    "# SPDX-License-Identifier: GPL-3.0-or-later\n"
    "# The demo plant, made by plantcast-demo. Metres; plant frame: x east, y north, z up, origin on the slab.\n"
    "plant:\n"
    "  name: Stabiliser unit 100 (demo)\n"
    "  time_zone: UTC\n"
    "  up: z\n"
    "  view: { eye: [-37.0, -38.5, 27.0], target: [-0.2, -0.6, 6.2], fov: 36 }\n"
    "\n"
    "groups:\n"
    "  - id: temperature\n"
    "    quantity: Temperature\n"
    "    unit: °C\n"
    "    min: 20\n"
    "    max: 180\n"
    "    limits: { H: 172, HH: 178 }\n"
    "    interpolation: shepard\n"
    "    distance: geodesic\n"
    "    reach_m: 12\n"
    "    singles: cut\n"
    "  - id: pressure\n"
    "    quantity: Pressure\n"
    "    unit: bar\n"
    "    min: 0\n"
    "    max: 16\n"
    "    limits: { H: 14.5, HH: 15.5 }\n"
    "    interpolation: shepard\n"
    "    distance: geodesic\n"
    "    singles: cut\n"
    "  - id: vibration\n"
    "    quantity: Vibration velocity\n"
    "    unit: mm/s\n"
    "    min: 0\n"
    "    max: 12\n"
    "    limits: { H: 4.5, HH: 7.1 }\n"
"    breaks: [2.8, 4.5, 7.1]\n"
    "    interpolation: shepard\n"
    "    distance: euclidean\n"
    "    reach_m: 2.5\n"
    "    singles: cut\n"
    "\n"
    "sources:\n"
    "  - id: plc1\n"
    "    type: modbus\n"
    "    host: 127.0.0.1\n"
    "    port: 1502\n"
    "    unit: 1\n"
    "    poll_ms: 500\n"
    "    byte_order: CDAB\n"
    "    address_base: 1\n"
    "    simulated: yes\n"
    "\n"
    "tags: tags.csv\n"
    "\n"
    "assets:\n";

/* Behind all else: a copy of the plant may have its own. Display 1: overview and alarms; 2: six panes. */
static const char walls[] =
    "\n"
    "views:\n"
    "  - { id: unit, title: Whole unit, view: \"group=temperature\" }\n"
    "  - { id: column, title: Stabiliser column, view: \"group=temperature&camera=-30,-24,16,-7.7,2.9,9,0,0,1,45\" }\n"
    "  - { id: unit-pressure, title: Pressures, view: \"group=pressure\" }\n"
    "  - { id: machines, title: Machines, view: \"group=vibration&camera=9,-26,32,8,-1,1,0,0,1,40\" }\n"
    "\n"
    "walls:\n"
    "  - id: control-room\n"
    "    inches: 65\n"
    "    distance_m: 3\n"
    "    dim_hours: 22:00-06:00\n"
    "    dim_percent: 60\n"
    "    displays:\n"
    "      - grid: [main main main alarms, main main main alarms, main main main tiles]\n"
    "        panes:\n"
    "          - { area: main, views: [unit, column], every_s: 60, on_alarm: yes }\n"
    "          - { area: alarms, alarms: yes }\n"
    "          - { area: tiles, title: Column, tiles: [TE-149, TE-141, PT-143, PT-141] }\n"
    "      - grid: [one two three, four five six]\n"
    "        panes:\n"
    "          - { area: one, views: column, on_alarm: yes }\n"
    "          - { area: two, views: unit-pressure }\n"
    "          - { area: three, views: machines }\n"
    "          - { area: four, title: Column temperatures, trend: [TE-149, TE-145, TE-141], hours: 2 }\n"
    "          - { area: five, title: Compressor K-101, tiles: [PT-161, PT-162, TE-161, TE-168, VT-161, VT-165] }\n"
    "          - { area: six, alarms: yes }\n";

int plant_file_write(const char *path)
{
    struct text out = { 0 };
    text_add(&out, "%s", head);
    for (int i = 0; i < layout_asset_count; i++)
        text_add(&out, "  - { id: %s, model: plant.glb, nodes: %s, up: y, description: \"%s\" }\n", layout_assets[i].name,
                 layout_assets[i].name,
                 layout_assets[i].description);
    text_add(&out, "%s", walls);
    int status = atomic_file_put(path, out.at, out.length);
    text_finish(&out);
    return status;
}

struct kind {
    const char *group, *unit, *type, *scaling, *byte_order;
    int decimals; /* of limits */
    double low;   /* no limit at or below it: the range's own end */
};
static const struct kind kinds[] = {
    [TAG_TEMPERATURE] = { "temperature", "°C", "Float32", "None,,,,", "CDAB", 0, 15.0 },
    [TAG_WINDING] = { "temperature", "°C", "Int16", "Linear,0,2000,0,200", "", 0, 15.0 },
    [TAG_PRESSURE] = { "pressure", "bar", "Int16", "Linear,0,27648,0,16", "", 1, 0.0 },
    [TAG_VIBRATION] = { "vibration", "mm/s", "Float32", "None,,,,", "CDAB", 1, 0.0 },
};

static void add_limit(struct text *out, const struct tag *tag, double bands)
{
    const struct kind *kind = kinds + tag->kind;
    double limit = tag->value + bands * tag->band;
    if (tag->band > 0.0 && limit > kind->low)
        text_add(out, ",%.*f", kind->decimals, limit);
    else
        text_add(out, ",");
}

static void add_tag(struct text *out, const struct tag *tag)
{
    const struct kind *kind = kinds + tag->kind;
    text_add(out, "%s,%d,%s,500,%s,%s,,\"%s\",plc1,%s,%s,", tag->name, tag->address, kind->type, kind->scaling, kind->unit,
             tag->description, kind->group,
             tag->asset);
    if (tag->node)
        text_add(out, "%s,,,", tag->name);
    else
        text_add(out, ",%.4f,%.4f,%.4f", tag->position.x, tag->position.y, tag->position.z);
    text_add(out, ",%s", kind->byte_order);
    add_limit(out, tag, -1.6);
    add_limit(out, tag, -1.0);
    add_limit(out, tag, 1.0);
    add_limit(out, tag, 1.6);
    text_add(out, ",%.4g,%s\n", tag->value, tag->loop);
}

int tag_list_write(const struct tags *tags, const char *path)
{
    struct text out = { 0 };
    text_add(&out,
             "Tag Name,Address,Data Type,Scan Rate,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Eng Units,Negate Value,Description,"
                   "Source,Group,Asset,Node,X,Y,Z,Byte Order,LL,L,H,HH,Sim Value,Sim Loop\n");
    for (size_t i = 0; i < tags->count; i++)
        add_tag(&out, tags->at + i);
    int status = atomic_file_put(path, out.at, out.length);
    text_finish(&out);
    return status;
}
