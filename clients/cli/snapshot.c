/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast snapshot`: reads the command line; asks a daemon, or draws by itself. */
#include "snapshot.h"

#include <ctype.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text.h"
#include "commands.h"

static const char usage[] =
    "usage: plantcast snapshot (PLANT.yaml | http://HOST:PORT/) -o OUT.png [options]\n"
    "\n"
    "  -o, --out FILE          PNG file to write\n"
    "  --pick X,Y              print as JSON what is at this pixel: asset, place, value, nearest sensors; no picture without -o\n"
    "  --size WxH              pixels; 1280x720\n"
    "  --camera EX,EY,EZ,TX,TY,TZ[,FOV]   eye, target (metres, plant frame), vertical degrees; the plant's own view\n"
    "  --projection NAME       perspective, orthographic       --height M   of an orthographic picture\n"
    "  --fit NAME              look at this asset or tag, --side top, bottom, front, back, left, right, iso or now; of the whole plant\n"
    "  --group ID              sensor group to show; the first one\n"
    "  --distance MODE         geodesic or euclidean; the group's own, and so below\n"
    "  --interpolation NAME    shepard or paper\n"
    "  --fill MODE             none or neighbours\n"
    "  --strength F, --decay F factors; --power P of shepard\n"
    "  --sensors TAG=STRENGTH[:DECAY],...   of single sensors, in place of the tag list's\n"
    "  --show WHAT             value, distance (from --sensor TAG, in metres), difference (from --baseline),\n"
    "                          operator (between each tag's own limits)\n"
    "  --baseline FILE         CSV like --values; of a daemon: the name of one that it keeps\n"
    "  --radius M              R of paper; 0: automatic          --reach M   how far a sensor reaches\n"
    "  --range MIN,MAX         of the colours; the group's own    --scale NAME   linear or log\n"
    "  --ramp UNITS            colours in steps; 0: continuous\n"
    "  --breaks V,V,...        colours in bands that meet there; `group` or `limits`: at the group's own\n"
    "  --isolines V,V,...      lines of equal value; every:STEP   (where bands meet there is a line in any case)\n"
    "  --colormap NAME         relief, calm (both made for shaded 3D), viridis, cividis, diverging,\n"
    "                          turbo, one of the plant's; offline also an image file: its colours from left to right\n"
    "  --look NAME             default, glossy, flat, materials  --light X,Y,Z   towards the sun\n"
    "  --environment NAME      surroundings that light the plant: sky, or one of the plant file\n"
    "  --select ASSET          outline this asset\n"
    "  --split \"NAME=V;...\"    a second picture beside it, under the same camera; names as above without dashes, but\n"
    "                          ramp_interval, radius_m, reach_m. What is not named is as in the first\n"
    "  --hide A,B --isolate A,B --ghost A,B   assets: left out; alone left; see-through, without a field\n"
    "  --clip NX,NY,NZ,D[;...] cut away where n p + d < 0, by up to 6 planes;  --clip-box X,Y,Z,X,Y,Z   all outside\n"
    "offline only:\n"
    "  --values FILE           CSV of tag,value[,quality]; may be repeated. Tags without a value have no data\n"
    "  --at TIME               of the values: 2026-01-31T12:00:00Z; now\n"
    "  --prepared FOLDER       where plantcast-prep put its files; PLANT.prepared beside the plant file\n"
    "  --tier TIER             still or moving\n"
    "  --no-overlay            no legend, markers and clock\n"
    "  --field KIND            vertices; or per-fragment: worked out anew at each fragment, for comparison\n"
    "  --gl KIND               auto, egl-device, egl-surfaceless, osmesa;  --gl-device N\n";

/* Options that are parameters of /snapshot.png too, under that name. */
static const struct {
    const char *option, *name;
} shared[] = {
    { "camera", "camera" },     { "group", "group" },       { "distance", "distance" },  { "interpolation", "interpolation" },
    { "fill", "fill" },         { "strength", "strength" }, { "decay", "decay" },        { "power", "power" },
    { "radius", "radius_m" },   { "reach", "reach_m" },     { "ramp", "ramp_interval" }, { "range", "range" },
    { "colormap", "colormap" }, { "look", "look" },         { "light", "light" },
    { "environment", "environment" },        { "select", "selected" },
    { "show", "show" },         { "sensor", "sensor" },     { "sensors", "sensors" },
    { "scale", "scale" },       { "breaks", "breaks" },     { "isolines", "isolines" },  { "split", "split" },
    { "projection", "projection" }, { "height", "height_m" }, { "fit", "fit" },          { "side", "side" },
    { "hide", "hidden" },       { "isolate", "isolate" },   { "ghost", "ghost" },        { "clip", "clip" },
    { "clip-box", "clip_box" },
};
enum { SHARED = sizeof(shared) / sizeof(shared[0]) };
enum own_option {
    OPTION_SIZE = SHARED,
    OPTION_OUT,
    OPTION_PICK,
    OPTION_BASELINE,
    OPTION_VALUES,
    OPTION_AT,
    OPTION_PREPARED,
    OPTION_TIER,
    OPTION_NO_OVERLAY,
    OPTION_FIELD,
    OPTION_GL,
    OPTION_GL_DEVICE,
    OPTION_HELP,
    OPTIONS
};

static const struct option own[] = {
    { "size", required_argument, NULL, OPTION_SIZE },
    { "out", required_argument, NULL, OPTION_OUT },
    { "pick", required_argument, NULL, OPTION_PICK },
    { "baseline", required_argument, NULL, OPTION_BASELINE },
    { "values", required_argument, NULL, OPTION_VALUES },
    { "at", required_argument, NULL, OPTION_AT },
    { "prepared", required_argument, NULL, OPTION_PREPARED },
    { "tier", required_argument, NULL, OPTION_TIER },
    { "no-overlay", no_argument, NULL, OPTION_NO_OVERLAY },
    { "field", required_argument, NULL, OPTION_FIELD },
    { "gl", required_argument, NULL, OPTION_GL },
    { "gl-device", required_argument, NULL, OPTION_GL_DEVICE },
    { "help", no_argument, NULL, OPTION_HELP },
};

bool snapshot_add_arg(struct snapshot_options *options, const char *name, const char *value)
{
    if (options->arg_count == SNAPSHOT_MAX)
        return false;
    options->args[options->arg_count++] = mem_printf("%s=%s", name, value);
    return true;
}

static bool add_size(struct snapshot_options *options, const char *text)
{
    unsigned width, height;
    char number[16], rest;
    if (sscanf(text, "%ux%u%c", &width, &height, &rest) != 2)
        return false;
    snprintf(number, sizeof(number), "%u", width);
    if (!snapshot_add_arg(options, "width", number))
        return false;
    snprintf(number, sizeof(number), "%u", height);
    return snapshot_add_arg(options, "height", number);
}

static bool parse_time(const char *text, int64_t *utc_ns)
{
    struct tm utc = { 0 };
    const char *end = strptime(text, "%Y-%m-%dT%H:%M:%S", &utc);
    if (!end || (strcmp(end, "Z") && strcmp(end, "")))
        return false;
    *utc_ns = (int64_t)timegm(&utc) * NS_PER_S;
    return true;
}

static bool parse_field(struct snapshot_options *options, const char *text)
{
    options->per_fragment = !strcmp(text, "per-fragment");
    return options->per_fragment || !strcmp(text, "vertices");
}

static bool parse_tier(struct snapshot_options *options, const char *text)
{
    options->moving = !strcmp(text, "moving");
    return options->moving || !strcmp(text, "still");
}

static bool parse_pick(struct snapshot_options *options, const char *text)
{
    char rest;
    options->pick = sscanf(text, "%lf,%lf%c", &options->place_px[0], &options->place_px[1], &rest) == 2;
    return options->pick;
}

/* False: the option's argument is wrong. */
static bool take_own(struct snapshot_options *options, int option, const char *text)
{
    options->offline_only = options->offline_only || option > OPTION_BASELINE;
    switch (option) {
    case OPTION_SIZE: return add_size(options, text);
    case OPTION_OUT: options->out = text; return true;
    case OPTION_PICK: return parse_pick(options, text);
    case OPTION_BASELINE: options->baseline = text; return true;
    case OPTION_AT: return parse_time(text, &options->at_utc_ns);
    case OPTION_PREPARED: options->prepared = text; return true;
    case OPTION_TIER: return parse_tier(options, text);
    case OPTION_NO_OVERLAY: return options->no_overlay = true;
    case OPTION_FIELD: return parse_field(options, text);
    case OPTION_GL: return gl_kind_parse(text, &options->gl);
    case OPTION_GL_DEVICE: options->has_gl_device = true; return gl_device_parse(text, &options->gl_device);
    case OPTION_VALUES:
        if (options->value_count == SNAPSHOT_MAX)
            return false;
        options->values[options->value_count++] = text;
        return true;
    default: return false;
    }
}

/* Exit code, or -1: go on. */
static int parse(int argc, char **argv, struct snapshot_options *options)
{
    struct option list[OPTIONS + 1] = { 0 };
    for (int i = 0; i < SHARED; i++)
        list[i] = (struct option){ shared[i].option, required_argument, NULL, i };
    memcpy(list + SHARED, own, sizeof(own));
    for (int option; (option = getopt_long(argc, argv, "o:h", list, NULL)) != -1;) {
        if (option == 'h' || option == OPTION_HELP) {
            fputs(usage, stdout);
            return 0;
        }
        if (option == '?')
            return 2;
        if (option < SHARED ? snapshot_add_arg(options, shared[option].name, optarg)
                            : take_own(options, option == 'o' ? OPTION_OUT : option, optarg))
            continue;
        fprintf(stderr, "plantcast: --%s: '%s' is not what is expected; see plantcast snapshot --help\n",
                option == 'o' ? "out" : list[option].name, optarg);
        return 2;
    }
    if (optind + 1 != argc || (!options->out && !options->pick)) {
        fputs(optind + 1 != argc ? "plantcast: one plant file or URL expected\n" : "plantcast: -o FILE.png is missing\n", stderr);
        fputs(usage, stderr);
        return 2;
    }
    options->from = argv[optind];
    return -1;
}

static void add_encoded(struct text *path, const char *arg)
{
    for (; *arg; arg++)
        text_add(path, isalnum((unsigned char)*arg) || strchr("-_.=,", *arg) ? "%c" : "%%%02X", (unsigned char)*arg);
}

static int from_daemon(struct snapshot_options *options)
{
    struct text path = { 0 }, query = { 0 };
    if (options->offline_only) {
        fputs("plantcast: --values, --at, --prepared, --tier, --no-overlay, --field and --gl only go with a plant file\n", stderr);
        return 2;
    }
    if (options->baseline && !snapshot_add_arg(options, "baseline", options->baseline))
        return 2;
    for (size_t i = 0; i < options->arg_count; i++) {
        text_add(&query, "&");
        add_encoded(&query, options->args[i]);
    }
    const char *rest = query.at ? query.at : "";
    int code = 0;
    if (options->pick) {
        text_add(&path, "/api/v1/pick?x=%.17g&y=%.17g%s", options->place_px[0], options->place_px[1], rest);
        code = daemon_download(options->from, path.at, NULL);
        path.length = 0;
    }
    text_add(&path, "/snapshot.png%s%s", *rest ? "?" : "", *rest ? rest + 1 : "");
    if (options->out && code == 0)
        code = daemon_download(options->from, path.at, options->out);
    text_finish(&path);
    text_finish(&query);
    return code;
}

int cmd_snapshot(int argc, char **argv)
{
    struct snapshot_options options = { 0 };
    int code = parse(argc, argv, &options);
    if (code < 0)
        code = strstr(options.from, "://") ? from_daemon(&options) : snapshot_offline(&options);
    for (size_t i = 0; i < options.arg_count; i++)
        mem_free(options.args[i]);
    return code;
}
