/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command lines of `plantcast snapshot` and `plantcast clip`, which is many of them. */
#include "snapshot.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/timestamp.h"

static const char snapshot_usage[] =
    "usage: plantcast snapshot (PLANT.yaml | http://HOST:PORT/) -o OUT.png [options]\n"
    "\n"
    "  -o, --out FILE          PNG file to write\n"
    "  --pick X,Y              print as JSON what is at this pixel: asset, place, value, nearest sensors; no picture without -o\n"
    "  --at INSTANT            as it was then, out of what was recorded; with --values: the time of these\n"
    "  --values FILE           without a daemon: CSV of tag,value[,quality] (perhaps unit; else the tag's Eng Units);\n"
    "                          may be repeated. Tags without a value have no data\n";
static const char clip_usage[] = "usage: plantcast clip (PLANT.yaml | http://HOST:PORT/) -o OUT.mp4 --from INSTANT --to INSTANT [options]\n"
                                 "\n"
                                 "A film of what was recorded, with the plant's clock and the word HISTORY in every picture.\n"
                                 "\n"
                                 "  -o, --out FILE          film to write: .mp4, .mkv or .mov, H.264\n"
                                 "  --from, --to INSTANT    what it shows\n"
                                 "  --tour ID               the views of this tour of the plant file, each for its time, with its text:\n"
                                 "                          in place of --to, and of all that is said below but --size\n"
                                 "  --speed F               seconds of the plant's in one of the film's; 60, of a tour 1\n"
                                 "  --fps F                 pictures in one second of the film; 25\n"
                                 "  --signed                of a daemon with --signing-key: with its signature of each picture, which\n"
                                 "                          `plantcast verify` checks; without loss: larger, and not for browsers.\n"
                                 "                          A tour's texts go to OUT.vtt, which players show, and are not signed\n";
static const char instant_usage[] =
    "  INSTANT                 2026-11-20T10:00:00Z, with an offset (+01:00), seconds since 1970, or back from now: -8h\n"
    "  --size WxH              pixels; 1280x720\n";
static const char view_usage[] =
    "  --camera EX,EY,EZ,TX,TY,TZ[,FOV]   eye, target (metres, plant frame), vertical degrees; the plant's own view\n"
    "  --projection NAME       perspective, orthographic       --height M   of an orthographic picture\n"
    "  --fit NAME              look at this asset or tag, --side top, bottom, front, back, left, right, iso or now; of the whole plant\n"
    "  --group ID              sensor group to show; the first one\n"
    "  --distance MODE         geodesic, euclidean; heat where prepared; the group's own, and so below\n"
    "  --interpolation NAME    shepard, paper; harmonic, fin, gp where prepared\n"
    "  --fill MODE             none or neighbours\n"
    "  --strength F, --decay F factors; --power P of shepard\n"
    "  --sensors TAG=STRENGTH[:DECAY],...   of single sensors, in place of the tag list's\n"
    "  --show WHAT             value, distance (from --sensor TAG, in metres), difference (from --baseline),\n"
    "                          operator (between each tag's own limits), uncertainty (of gp),\n"
    "                          blind (the least hot spot that sensors would show)\n"
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
    "  --backdrop NAME         light or dark: what is behind the plant\n"
    "  --strip legend          a strip below, from which `plantcast read` tells values in a copy of the picture\n"
    "  --language L            of legend and labels: en, ko or de\n"
    "  --arrows NAME           arrows, strokes, none: how directions are drawn\n"
    "  --select ASSET          outline this asset\n"
    "  --split \"NAME=V;...\"    a second picture beside it, under the same camera; names as above without dashes, but\n"
    "                          ramp_interval, radius_m, reach_m. What is not named is as in the first\n"
    "  --hide A,B --isolate A,B --ghost A,B   assets: left out; alone left; see-through, without a field\n"
    "                          (in place of those that the plant file starts so; \"\": none)\n"
    "  --clip NX,NY,NZ,D[;...] cut away where n p + d < 0, by up to 6 planes;  --clip-box X,Y,Z,X,Y,Z   all outside\n";
static const char offline_usage[] =
    "offline only:\n"
    "  --history FOLDER        where history is; as the plant file says, else beside it\n"
    "  --prepared FOLDER       where plantcast-prep put its files; PLANT.prepared beside the plant file\n"
    "  --tier TIER             still or moving\n"
    "  --no-overlay            no legend, markers and clock\n"
    "  --field KIND            vertices; or per-fragment: worked out anew at each fragment, for comparison\n"
    "  --gl KIND               auto, egl-device, egl-surfaceless, osmesa;  --gl-device N\n";

/* Options that are parameters of /snapshot.png too, under that name. */
static const struct {
    const char *option, *name;
} shared[] = {
    { "camera", "camera" },
    { "group", "group" },
    { "distance", "distance" },
    { "interpolation", "interpolation" },
    { "fill", "fill" },
    { "strength", "strength" },
    { "decay", "decay" },
    { "power", "power" },
    { "radius", "radius_m" },
    { "reach", "reach_m" },
    { "ramp", "ramp_interval" },
    { "range", "range" },
    { "colormap", "colormap" },
    { "look", "look" },
    { "light", "light" },
    { "backdrop", "backdrop" },
    { "strip", "strip" },
    { "language", "language" },
    { "arrows", "arrows" },
    { "environment", "environment" },
    { "select", "selected" },
    { "show", "show" },
    { "sensor", "sensor" },
    { "sensors", "sensors" },
    { "scale", "scale" },
    { "breaks", "breaks" },
    { "isolines", "isolines" },
    { "split", "split" },
    { "projection", "projection" },
    { "height", "height_m" },
    { "fit", "fit" },
    { "side", "side" },
    { "hide", "hidden" },
    { "isolate", "isolate" },
    { "ghost", "ghost" },
    { "clip", "clip" },
    { "clip-box", "clip_box" },
};
enum { SHARED = sizeof(shared) / sizeof(shared[0]) };
enum own_option {
    OPTION_SIZE = SHARED,
    OPTION_OUT,
    OPTION_PICK,
    OPTION_BASELINE,
    OPTION_AT,
    OPTION_FROM,
    OPTION_TO,
    OPTION_TOUR,
    OPTION_SPEED,
    OPTION_SIGNED,
    OPTION_FPS,
    OPTION_VALUES,
    OPTION_HISTORY,
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
    { "at", required_argument, NULL, OPTION_AT },
    { "from", required_argument, NULL, OPTION_FROM },
    { "to", required_argument, NULL, OPTION_TO },
    { "tour", required_argument, NULL, OPTION_TOUR },
    { "speed", required_argument, NULL, OPTION_SPEED },
    { "signed", no_argument, NULL, OPTION_SIGNED },
    { "fps", required_argument, NULL, OPTION_FPS },
    { "values", required_argument, NULL, OPTION_VALUES },
    { "history", required_argument, NULL, OPTION_HISTORY },
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

static bool parse_instant(const char *text, const char **given, int64_t *at_us)
{
    *given = text;
    return timestamp_parse(text, clock_utc_ns() / 1000, at_us);
}

static bool parse_factor(const char *text, double least, double most, double *out)
{
    char *end;
    *out = strtod(text, &end);
    return end != text && !*end && *out >= least && *out <= most;
}

/* Not all belong to both commands. */
static bool belongs(bool clip, int option)
{
    bool of_clip = option >= OPTION_FROM && option <= OPTION_FPS;
    bool of_snapshot = option == OPTION_PICK || option == OPTION_AT || option == OPTION_VALUES || option == OPTION_NO_OVERLAY;
    return clip ? !of_snapshot : !of_clip;
}

/* False: the option's argument is wrong. */
static bool take_own(struct snapshot_options *options, int option, const char *text)
{
    options->offline_only = options->offline_only || option >= OPTION_VALUES;
    switch (option) {
    case OPTION_SIZE: return add_size(options, text);
    case OPTION_OUT: options->out = text; return true;
    case OPTION_PICK: return parse_pick(options, text);
    case OPTION_BASELINE: options->baseline = text; return true;
    case OPTION_AT: return parse_instant(text, &options->at, &options->at_us);
    case OPTION_FROM: return parse_instant(text, &options->from_text, &options->from_us);
    case OPTION_TO: return parse_instant(text, &options->to_text, &options->to_us);
    case OPTION_TOUR: options->tour = text; return true;
    case OPTION_SPEED: return parse_factor(text, 0.001, 1e6, &options->speed);
    case OPTION_SIGNED: return options->is_signed = true;
    case OPTION_FPS: return parse_factor(text, 1, 120, &options->fps);
    case OPTION_HISTORY: options->history = text; return true;
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

static void print_usage(FILE *out, bool clip)
{
    fprintf(out, "%s%s%s%s", clip ? clip_usage : snapshot_usage, instant_usage, view_usage, offline_usage);
}

static int wrong(bool clip, const char *text)
{
    fprintf(stderr, "plantcast: %s\n", text);
    print_usage(stderr, clip);
    return 2;
}

static bool only_size(const struct snapshot_options *options)
{
    bool only = !options->baseline;
    for (size_t i = 0; i < options->arg_count; i++)
        only = only && (!strncmp(options->args[i], "width=", 6) || !strncmp(options->args[i], "height=", 7));
    return only;
}

/* -1: go on. */
static int judge(const struct snapshot_options *options, bool clip, int left)
{
    if (left != 1)
        return wrong(clip, "one plant file or URL expected");
    if (!options->out && !options->pick)
        return wrong(clip, clip ? "-o FILE.mp4 is missing" : "-o FILE.png is missing");
    if (clip && (!options->from_text || (!options->to_text && !options->tour)))
        return wrong(clip, "--from and --to are missing");
    if (options->tour && (options->to_text || !only_size(options)))
        return wrong(clip, "a tour says itself what is seen and for how long: only --size and --from have a place beside it");
    if (options->is_signed && !strstr(options->out, ".mp4") && !strstr(options->out, ".mov"))
        return wrong(clip, "--signed: signatures are kept in .mp4 and .mov");
    if (clip && !options->tour && options->from_us >= options->to_us)
        return wrong(clip, "--from is to be earlier than --to");
    return -1;
}

int snapshot_parse(int argc, char **argv, bool clip, struct snapshot_options *options)
{
    struct option list[OPTIONS + 1] = { 0 };
    *options = (struct snapshot_options){ .fps = 25 };
    for (int i = 0; i < SHARED; i++)
        list[i] = (struct option){ shared[i].option, required_argument, NULL, i };
    memcpy(list + SHARED, own, sizeof(own));
    for (int option; (option = getopt_long(argc, argv, "o:h", list, NULL)) != -1;) {
        if (option == 'h' || option == OPTION_HELP) {
            print_usage(stdout, clip);
            return 0;
        }
        if (option == '?')
            return 2;
        option = option == 'o' ? OPTION_OUT : option;
        if (belongs(clip, option) &&
            (option < SHARED ? snapshot_add_arg(options, shared[option].name, optarg) : take_own(options, option, optarg)))
            continue;
        fprintf(stderr, "plantcast: --%s: %s%s%s; see plantcast %s --help\n", list[option].name, optarg ? "'" : "", optarg ? optarg : "",
                belongs(clip, option) ? "' is not what is expected" : "' has no place here", argv[0]);
        return 2;
    }
    int code = judge(options, clip, argc - optind);
    options->from = argv[optind];
    if (options->speed <= 0)
        options->speed = options->tour ? 1 : 60;
    return code;
}

void snapshot_options_finish(struct snapshot_options *options)
{
    for (size_t i = 0; i < options->arg_count; i++)
        mem_free(options->args[i]);
}
