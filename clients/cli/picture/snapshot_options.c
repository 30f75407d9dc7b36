/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the command lines of `plantcast snapshot` and `plantcast clip`; a clip is a series of snapshots. */
#include "snapshot.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/timestamp.h"

static const char snapshot_usage[] =
    "usage: plantcast snapshot (PLANT.yaml | http://HOST:PORT/) -o OUT.png [OPTION ...]\n"
    "\n"
    "Draws one picture, offline from a plant file or by a daemon, as PNG.\n"
    "\n"
    "  -o, --out FILE          PNG file to write\n"
    "  --pick X,Y              print as JSON the asset, place, value and nearest sensors at this pixel (no picture without -o)\n"
    "  --at INSTANT            draw recorded history at this time; with --values: the time of these values\n"
    "  --values FILE           offline: read values from this CSV file of tag,value[,quality] (with an optional column unit;\n"
    "                          default: the tag's Eng Units); may be repeated. Tags without a value have no data\n";
static const char clip_usage[] =
    "usage: plantcast clip (PLANT.yaml | http://HOST:PORT/) -o OUT.mp4 --from INSTANT --to INSTANT [OPTION ...]\n"
    "\n"
    "Makes a film of recorded history. Each picture shows the plant's clock and the word HISTORY.\n"
    "\n"
    "  -o, --out FILE          film to write: .mp4, .mkv or .mov, H.264\n"
    "  --from, --to INSTANT    period to show\n"
    "  --tour ID               show the views of this tour of the plant file one after another, with their texts. Replaces\n"
    "                          --to and all options for the view but --size\n"
    "  --speed F               plant seconds per film second (default: 60; of a tour: 1)\n"
    "  --fps F                 frames a second (default: 25)\n"
    "  --signed                by a daemon with --signing-key: store the signature of each picture, for `plantcast verify`.\n"
    "                          Lossless: larger, and browsers cannot play it. Texts of a tour go to OUT.vtt, unsigned\n";
static const char instant_usage[] =
    "  INSTANT                 2026-11-20T10:00:00Z, with an offset (+01:00), seconds since 1970, or back from now: -8h\n"
    "  --size WxH              pixels (default: 1280x720)\n";
static const char view_usage[] =
    "Camera:\n"
    "  --camera EX,EY,EZ,TX,TY,TZ[,FOV]   eye and target in metres (plant frame), vertical field of view in degrees\n"
    "                          (default: the plant's own view)\n"
    "  --projection NAME       perspective or orthographic\n"
    "  --height M              height of an orthographic picture in metres\n"
    "  --fit NAME              frame this asset or tag (default: the whole plant)\n"
    "  --side NAME             view --fit from top, bottom, front, back, left, right, iso or now\n"
    "Field:\n"
    "  --group ID              sensor group (default: the first one)\n"
    "  --distance MODE         geodesic or euclidean; heat where prepared (default: the group's own, also for the next ones)\n"
    "  --interpolation NAME    shepard or paper; harmonic, fin or gp where prepared\n"
    "  --fill MODE             none or neighbours\n"
    "  --strength F, --decay F factors of all sensors\n"
    "  --power P               exponent of shepard\n"
    "  --radius M              R of paper in metres; 0: automatic\n"
    "  --reach M               reach of each sensor in metres\n"
    "  --sensors TAG=STRENGTH[:DECAY],...   strength and decay of single sensors, instead of the tag list's\n"
    "  --show WHAT             value, distance (to --sensor TAG, in metres), difference (to --baseline), operator (position\n"
    "                          between each tag's own limits), uncertainty (of gp), or blind (size of the smallest hot\n"
    "                          spot that the sensors would show)\n"
    "  --baseline FILE         CSV file like --values; by a daemon: name of a saved baseline\n"
    "Colours:\n"
    "  --range MIN,MAX         range of the colours (default: the group's own)\n"
    "  --scale NAME            linear or log\n"
    "  --ramp UNITS            height of a colour step in units; 0: continuous\n"
    "  --breaks V,V,...        limits of colour bands; `group` or `limits`: those of the group\n"
    "  --isolines V,V,...      contour lines at these values, or every:STEP (limits of bands always have one)\n"
    "  --colormap NAME         relief or calm (both made for shaded 3D), viridis, cividis, diverging, turbo, or one of the\n"
    "                          plant's; offline also an image file, read from left to right\n"
    "Look:\n"
    "  --look NAME             default, glossy, flat or materials\n"
    "  --light X,Y,Z           direction towards the sun\n"
    "  --environment NAME      surroundings that light the plant: sky, or one of the plant file\n"
    "  --backdrop NAME         light or dark background\n"
    "  --strip legend          add a strip below the picture from which `plantcast read` reads values\n"
    "  --language L            language of legend and labels: en, ko or de\n"
    "  --arrows NAME           arrows, strokes or none, for directions\n"
    "  --select ASSET          outline this asset\n"
    "  --hide A,B              hide these assets\n"
    "  --isolate A,B           show only these assets\n"
    "  --ghost A,B             make these assets transparent, without a field. \"\" clears a list that the plant file sets\n"
    "  --clip NX,NY,NZ,D[;...] cut away all points p with n p + d < 0; 6 planes at most\n"
    "  --clip-box X,Y,Z,X,Y,Z  cut away everything outside this box\n"
    "  --split \"NAME=V;...\"    draw a second picture beside the first with the same camera. Names are those of options\n"
    "                          without dashes, but ramp_interval, radius_m and reach_m; others are as in the first picture\n";
static const char offline_usage[] =
    "Offline only:\n"
    "  --history FOLDER        folder of the history (default: the one that the plant file names, else next to it)\n"
    "  --prepared FOLDER       output folder of plantcast-prep (default: PLANT.prepared next to the plant file)\n"
    "  --tier TIER             still or moving\n"
    "  --no-overlay            leave out legend, markers and clock\n"
    "  --field KIND            vertices, or per-fragment: slow, for comparison (default: vertices)\n"
    "  --gl KIND               auto, egl-device, egl-surfaceless or osmesa\n"
    "  --gl-device N           GPU (see plantcastd --list-gl-devices)\n";

/* Options that are also parameters of /snapshot.png, by the parameter's name. */
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

/* Returns true if the option is allowed in this command, `plantcast clip` or `plantcast snapshot`. */
static bool belongs(bool clip, int option)
{
    bool of_clip = option >= OPTION_FROM && option <= OPTION_FPS;
    bool of_snapshot = option == OPTION_PICK || option == OPTION_AT || option == OPTION_VALUES || option == OPTION_NO_OVERLAY;
    return clip ? !of_snapshot : !of_clip;
}

/* Applies one option. Returns false if its argument is wrong. */
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

/* Checks that the options fit together. left: number of arguments that are not options. Returns -1 to continue, or the exit code. */
static int judge(const struct snapshot_options *options, bool clip, int left)
{
    if (left != 1)
        return wrong(clip, "one plant file or URL expected");
    if (!options->out && !options->pick)
        return wrong(clip, clip ? "-o FILE.mp4 is missing" : "-o FILE.png is missing");
    if (clip && (!options->from_text || (!options->to_text && !options->tour)))
        return wrong(clip, "--from and --to are missing");
    if (options->tour && (options->to_text || !only_size(options)))
        return wrong(clip, "--tour sets view and length; combine it only with --size and --from");
    if (options->is_signed && !strstr(options->out, ".mp4") && !strstr(options->out, ".mov"))
        return wrong(clip, "--signed: signatures are kept in .mp4 and .mov");
    if (clip && !options->tour && options->from_us >= options->to_us)
        return wrong(clip, "--from must be earlier than --to");
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
                belongs(clip, option) ? "' is not valid" : "' is unexpected here", argv[0]);
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
