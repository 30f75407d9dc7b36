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
#include "plant/plant.h"

static const char snapshot_usage[] =
    "usage: plantcast snapshot (PLANT.yaml | http://HOST:PORT/) -o OUT.png [OPTION ...]\n"
    "\n"
    "Draws one picture of the plant as PNG: offline from a plant file, or through a running daemon.\n"
    "\n"
    "  -o, --out FILE          PNG file to write\n"
    "  --pick X,Y              print asset, position, value and nearest sensors at pixel X,Y as JSON;\n"
    "                          without -o, write no picture\n"
    "  --at TIME               draw the readings recorded at this time instead of the present readings;\n"
    "                          with --values: time that the picture's clock shows\n"
    "  --values FILE           with a plant file: CSV file of readings to draw; may be repeated\n"
    "                          Columns of FILE: tag,value[,quality][,unit] (default unit: the tag's Eng Units).\n"
    "                          Tags that are in none of these files are drawn without data\n";
static const char clip_usage[] =
    "usage: plantcast clip (PLANT.yaml | http://HOST:PORT/) -o OUT.mp4 --from TIME --to TIME [OPTION ...]\n"
    "\n"
    "Renders recorded readings as a video clip. Each frame shows the time of its readings and the word HISTORY.\n"
    "\n"
    "  -o, --out FILE          H.264 video file to write; the name must end in .mp4, .mkv or .mov\n"
    "  --from, --to TIME       start and end of the recorded period that the clip shows\n"
    "  --tour ID               show the tour ID of the plant file: its views one after another, with captions\n"
    "                          The tour determines views and length; of the view options, only --size is allowed\n"
    "  --speed F               seconds of recorded time per second of the clip (default: 60; with --tour: 1)\n"
    "  --fps F                 frames per second of the clip (default: 25)\n"
    "  --signed                store the server's signature of each frame in the clip (see `plantcast verify`);\n"
    "                          needs a daemon with --signing-key\n"
    "                          A signed clip is lossless: the file is large, and browsers cannot play it\n"
    "                          The captions of a tour are written to OUT.vtt and are not signed\n";
static const char instant_usage[] =
    "  TIME                    a time such as 2026-11-20T10:00:00Z (or offset +01:00), seconds since 1970, or -8h (8 hours ago)\n"
    "  --size WxH              width and height of the picture in pixels (default: 1280x720)\n";
static const char view_usage[] =
    "  --view NAME             use the camera and all settings of the view with this id or title. The view is in the\n"
    "                          plant file or was saved on the page. Other options override the view's settings.\n"
    "                          The readings are the present ones, or those recorded at --at TIME\n"
    "Camera:\n"
    "  --camera EX,EY,EZ,TX,TY,TZ[,FOV]\n"
    "                          camera position E and target point T in metres, in plant coordinates, and\n"
    "                          vertical field of view in degrees (default: camera of the plant file)\n"
    "  --projection TYPE       projection of the camera: perspective or orthographic\n"
    "  --height M              metres that the picture covers from bottom to top, with --projection orthographic\n"
    "  --fit ITEM              move the camera so that this asset or tag fills the picture (default: whole plant)\n"
    "  --side SIDE             side from which the camera looks at the item given with --fit: top, bottom, front,\n"
    "                          back, left, right, iso (diagonally from above) or now (keep the direction of --camera)\n"
    "Field (values on the surface, computed from the sensors; default: the settings of the sensor group):\n"
    "  --group ID              sensor group to show (default: first group of the plant file)\n"
    "  --distance METHOD       how distances from sensors are measured: geodesic (along the surface),\n"
    "                          euclidean (straight), or heat (approximate, along the surface)\n"
    "                          heat needs distances that plantcast-prep computed with the heat method\n"
    "  --interpolation METHOD  how values between sensors are computed: shepard (inverse distance),\n"
    "                          paper (Kim and Suh 2025), harmonic, fin (heat conduction) or gp (Gaussian process);\n"
    "                          harmonic, fin and gp need weights that plantcast-prep computed\n"
    "  --fill none|neighbours  how the area around a sensor with a bad reading is drawn: without data, or\n"
    "                          with colours computed from the neighbouring sensors\n"
    "  --strength F            factor by which the weight (strength) of every sensor is multiplied\n"
    "  --decay F               with --interpolation paper: factor for every sensor's decay; the higher the decay,\n"
    "                          the faster the sensor's weight falls with distance\n"
    "  --power P               exponent P of the weight 1/distance^P (--interpolation shepard)\n"
    "  --radius M              with --interpolation paper: distance in metres at which a sensor's weight reaches 0;\n"
    "                          0: the largest distance on each asset\n"
    "  --reach M               distance up to which a sensor influences the surface, in metres\n"
    "  --sensors TAG=STRENGTH[:DECAY],...\n"
    "                          strength and decay of single sensors, instead of those in the tag list\n"
    "  --show QUANTITY         quantity that the colours show:\n"
    "                            value        readings of the sensors\n"
    "                            distance     distance in metres from the sensor given with --sensor\n"
    "                            difference   change of the readings since --baseline\n"
    "                            operator     position of each reading between the alarm limits of its tag\n"
    "                            uncertainty  standard deviation of --interpolation gp\n"
    "                            blind        how much hotter than its surroundings a hot spot must be for a sensor to\n"
    "                                         detect it, in the unit of the values\n"
    "  --sensor TAG            sensor to measure from, with --show distance\n"
    "  --baseline BASELINE     readings to compare with, for --show difference: with a plant file, a CSV file as\n"
    "                          for --values; with a daemon, the name of a saved baseline\n"
    "Colours:\n"
    "  --range MIN,MAX         values at the two ends of the colour map (default: the range of the sensor group)\n"
    "  --scale linear|log      how values are spread over the colour map: linearly or logarithmically\n"
    "  --ramp UNITS            size of one colour band in the unit of the values; 0: continuous colours\n"
    "  --breaks V,V,...        values at which one colour band ends and the next begins; `group` or `limits`:\n"
    "                          breaks or limits of the sensor group in the plant file\n"
    "  --isolines V,V,...      draw contour lines at these values, or at each multiple of STEP (every:STEP);\n"
    "                          the edges of colour bands are always drawn as contour lines\n"
    "  --colormap COLOURS      colour map: viridis, cividis, diverging, turbo, relief or calm (both made for\n"
    "                          shaded 3D), or the name of a colour map in the plant file; with a plant file\n"
    "                          also an image file whose pixels, from left to right, are the colours\n"
    "Look:\n"
    "  --look STYLE            style of the surfaces: default, glossy, flat, or materials (colours of the model,\n"
    "                          not coloured by the sensors' values)\n"
    "  --light X,Y,Z           direction from the plant towards the sun\n"
    "  --environment ID        surroundings that light the plant: sky, or ID of an environment in the plant file\n"
    "  --backdrop light|dark   background of the picture\n"
    "  --strip legend          add a strip below the picture, from which `plantcast read` reads values\n"
    "  --language en|ko|de     language of legend and labels\n"
    "  --arrows STYLE          how measured directions are drawn: arrows, strokes or none\n"
    "  --select ASSET          draw an outline around this asset\n"
    "  --hide ASSET,...        hide these assets; \"\": show even the assets that the plant file hides\n"
    "  --isolate ASSET,...     show only these assets; \"\": show all assets\n"
    "  --ghost ASSET,...       draw these assets transparent, not coloured by values; \"\": no asset\n"
    "  --clip NX,NY,NZ,D[;...] cut away all points (x,y,z) with NX x + NY y + NZ z + D < 0; at most 6 planes\n"
    "  --clip-box X,Y,Z,X,Y,Z  cut away everything outside the box between these two corners (metres)\n"
    "  --split \"PARAM=V;...\"   draw a second picture to the right of the first, with the same camera and options\n"
    "                          except for those given here. PARAM is the name of an option without --, such as\n"
    "                          interpolation=gp; for --ramp, --radius and --reach, PARAM is ramp_interval,\n"
    "                          radius_m and reach_m\n";
static const char offline_usage[] =
    "Only with a plant file (offline):\n"
    "  --history FOLDER        folder of recorded readings (default: the folder given in the plant file, or\n"
    "                          PLANT.history; for the service plantcastd@NAME: /var/lib/plantcast/NAME/history)\n"
    "  --prepared FOLDER       output folder of plantcast-prep (default: PLANT.prepared next to PLANT.yaml;\n"
    "                          for the service plantcastd@NAME: /var/lib/plantcast/NAME/prepared)\n"
    "  --tier still|moving     quality of the picture, as for a still or a moving camera (default: still)\n"
    "  --no-overlay            omit legend, sensor markers and clock\n"
    "  --field WHERE           where the field is computed: vertices (fast), or per-fragment (at each pixel;\n"
    "                          slow, for comparison) (default: vertices)\n"
    "  --gl CONTEXT            OpenGL context: auto (the first that works), egl-device, egl-surfaceless or\n"
    "                          osmesa (draws on the CPU, not the GPU) (default: auto)\n"
    "  --gl-device N           number of the GPU that draws the picture (see `plantcastd --list-gl-devices`)\n";

/* Options that are passed on as parameters of /snapshot.png: option, and parameter name. */
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
    OPTION_VIEW,
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
    { "view", required_argument, NULL, OPTION_VIEW },
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

/* Returns true if this command (clip: `plantcast clip`, else `plantcast snapshot`) accepts the option. */
static bool belongs(bool clip, int option)
{
    bool of_clip = option >= OPTION_FROM && option <= OPTION_FPS;
    bool of_snapshot = option == OPTION_PICK || option == OPTION_AT || option == OPTION_VALUES || option == OPTION_NO_OVERLAY;
    return clip ? !of_snapshot : !of_clip;
}

/* Stores the argument of one option of `plantcast snapshot` or `clip` in *options. Returns false if the argument is invalid. */
static bool take_own(struct snapshot_options *options, int option, const char *text)
{
    options->offline_only = options->offline_only || option >= OPTION_VALUES;
    switch (option) {
    case OPTION_SIZE: return add_size(options, text);
    case OPTION_OUT: options->out = text; return true;
    case OPTION_PICK: return parse_pick(options, text);
    case OPTION_BASELINE: options->baseline = text; return true;
    case OPTION_VIEW: options->view = text; return true;
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
    bool only = !options->baseline && !options->view;
    for (size_t i = 0; i < options->arg_count; i++)
        only = only && (!strncmp(options->args[i], "width=", 6) || !strncmp(options->args[i], "height=", 7));
    return only;
}

/* Checks that the options may be combined. left: number of non-option arguments. Returns -1 to continue, or the exit code. */
static int judge(const struct snapshot_options *options, bool clip, int left)
{
    if (left != 1)
        return wrong(clip, "expected exactly one plant file or URL");
    if (!options->out && !options->pick)
        return wrong(clip, clip ? "-o FILE.mp4 is missing" : "-o FILE.png is missing");
    if (clip && (!options->from_text || (!options->to_text && !options->tour)))
        return wrong(clip, "a clip needs --from and --to, or --from and --tour");
    if (options->tour && (options->to_text || !only_size(options)))
        return wrong(clip, "--tour determines the views and the length of the clip: omit --to and all view options except --size");
    if (options->is_signed && !strstr(options->out, ".mp4") && !strstr(options->out, ".mov"))
        return wrong(clip, "--signed needs an output file in .mp4 or .mov format: other formats cannot hold signatures");
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

char *snapshot_options_folder(const struct snapshot_options *options, const struct plant *plant)
{
    return options->history ? mem_strdup(options->history) : plant_recorded_folder(plant);
}

void snapshot_options_finish(struct snapshot_options *options)
{
    for (size_t i = 0; i < options->arg_count; i++)
        mem_free(options->args[i]);
}
