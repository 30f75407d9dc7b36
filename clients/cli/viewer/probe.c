/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast probe`: runs many viewers of a daemon at the same time and prints their measurements as a table. */
#include "probe.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "clients/cli/commands.h"
#include "viewer_threads.h"
#include "clients/link/decoder.h"
#include "load_generator.h"

enum { MAX_SESSIONS = 1000 };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast probe URL [--sessions N] [--seconds S] [--motion still|orbit|random] [--hz N] [--size WxH]\n"
          "                           [--codec jpeg|h264] [--signed refined|all] [--save-signed FOLDER] [--follow] [--spread]\n"
          "                           [--stall N] [--blind] [--json]\n"
          "\n"
          "Opens N sessions on the daemon at URL, decodes every frame, and prints frame rates and latencies:\n"
          "\n"
          "  input to frame    time from sending a camera position until a frame of that or a newer position is decoded\n"
          "                    (each session sends 60 camera positions a second, or N with --hz N)\n"
          "  sensor to frame   time from a changed reading at the daemon until a frame with that reading is decoded\n"
          "  behind leader     with --follow: time from a camera position of the leader until a follower has decoded\n"
          "                    a frame of that position, not counting the first 3 s\n"
          "  steady            data rate received by all sessions after the first 3 s, not counting answers to pings\n"
          "\n"
          "Options:\n"
          "  --motion random   move the cameras like a user: drags of up to 2 s with pauses\n"
          "  --follow          move the camera of the first session; all other sessions follow its view\n"
          "  --spread          keep the cameras still, each looking from a different side\n"
          "  --signed WHICH    request signed PNG frames: refined (only still frames) or all\n"
          "                    (needs a server with --signing-key)\n"
          "  --save-signed FOLDER  write signed frames to FOLDER/SESSION-FRAME.png, for `plantcast verify`;\n"
          "                    implies --signed refined\n"
          "  --stall N         make the last N sessions stop reading after their first frame, like hung clients;\n"
          "                    these sessions are excluded from the printed figures\n"
          "  --blind           acknowledge frames without decoding them, to run many sessions on a small machine\n"
          "                    Over https://, one thread serves all sessions and reads only the headers of frames\n"
          "  --json            print the figures as JSON\n",
          out);
}

static struct viewer *make_viewer(struct probe *probe, int index)
{
    bool moves = probe->motion != MOTION_STILL;
    return viewer_create(&(struct viewer_params){ .url = &probe->url,
                                                  .width_px = probe->width_px,
                                                  .height_px = probe->height_px,
                                                  .motion = probe->motion,
                                                  .codec = probe->codec,
                                                  .seconds = probe->seconds,
                                                  .hz = probe->hz,
                                                  .blind = probe->blind,
                                                  .signs = probe->signs,
                                                  .folder = probe->folder,
                                                  .number = index + 1,
                                                  .stalls = index >= probe->watching,
                                                  .lead = probe->follow ? &probe->lead : NULL,
                                                  .follows = probe->follow && index > 0,
                                                  .seed = (unsigned)index + 1,
                                                  .start_deg = moves || probe->spread ? 360.0 * index / probe->sessions : 0 });
}

static int run_probe(struct probe *probe)
{
    bool good = true;
    probe->watching = probe->sessions - probe->stalled;
    probe->viewers = mem_array((size_t)probe->sessions, sizeof(*probe->viewers));
    pthread_mutex_init(&probe->lead.lock, NULL);
    for (int i = 0; i < probe->sessions; i++)
        good &= (probe->viewers[i] = make_viewer(probe, i)) != NULL;
    bool (*drive)(struct viewer **, int) = probe->blind && !probe->url.tls ? load_generator_run : viewer_threads_run;
    good = good && drive(probe->viewers, probe->sessions) && probe_report(probe);
    for (int i = 0; i < probe->sessions; i++)
        viewer_destroy(&probe->viewers[i]);
    pthread_mutex_destroy(&probe->lead.lock);
    mem_free(probe->viewers);
    return good ? 0 : 1;
}

static bool parse_size(const char *text, int *w, int *h)
{
    char rest;
    return sscanf(text, "%dx%d%c", w, h, &rest) == 2 && *w >= 16 && *h >= 16 && *w <= 8192 && *h <= 8192;
}

static bool parse_motion(const char *text, enum motion *motion)
{
    for (int i = 0; i < MOTION_COUNT; i++) {
        if (!strcmp(text, probe_motions[i])) {
            *motion = (enum motion)i;
            return true;
        }
    }
    return false;
}

/* Returns true if this build can decode the chosen codec, or if the viewers do not decode. */
static bool decodes(const struct probe *probe)
{
    char why[DECODER_WHY_BYTES];
    if (probe->blind || strcmp(probe->codec, "h264") != 0 || decoder_has(WIRE_CODEC_H264, why))
        return true;
    fprintf(stderr, "plantcast: probe: --codec h264: %s\n", why);
    return false;
}

static bool take_option(int option, struct probe *probe)
{
    char *end = "";
    switch (option) {
    case 'n': probe->sessions = (int)strtol(optarg, &end, 10); return !*end && probe->sessions >= 1 && probe->sessions <= MAX_SESSIONS;
    case 's': probe->seconds = strtod(optarg, &end); return !*end && probe->seconds > 0 && probe->seconds <= 1e6;
    case 'm': return parse_motion(optarg, &probe->motion);
    case 'r': probe->hz = strtod(optarg, &end); return !*end && probe->hz >= 0.1 && probe->hz <= 1000;
    case 't': probe->stalled = (int)strtol(optarg, &end, 10); return !*end && probe->stalled >= 0;
    case 'f': probe->follow = true; return true;
    case 'p': probe->spread = true; return true;
    case 'b': probe->blind = true; return true;
    case 'z': return parse_size(optarg, &probe->width_px, &probe->height_px);
    case 'c': probe->codec = optarg; return !strcmp(optarg, "jpeg") || !strcmp(optarg, "h264");
    case 'g': probe->signs = optarg; return !strcmp(optarg, "refined") || !strcmp(optarg, "all");
    case 'o': probe->folder = optarg; return true;
    case 'j': probe->as_json = true; return true;
    default: return false;
    }
}

int cmd_probe(const struct daemon_access *access, int argc, char **argv)
{
    static const struct option options[] = {
        { "sessions", required_argument, NULL, 'n' },
        { "seconds", required_argument, NULL, 's' },
        { "motion", required_argument, NULL, 'm' },
        { "size", required_argument, NULL, 'z' },
        { "hz", required_argument, NULL, 'r' },
        { "stall", required_argument, NULL, 't' },
        { "follow", no_argument, NULL, 'f' },
        { "spread", no_argument, NULL, 'p' },
        { "blind", no_argument, NULL, 'b' },
        { "codec", required_argument, NULL, 'c' },
        { "signed", required_argument, NULL, 'g' },
        { "save-signed", required_argument, NULL, 'o' },
        { "json", no_argument, NULL, 'j' },
        { "help", no_argument, NULL, 'h' },
        { NULL, 0, NULL, 0 },
    };
    struct probe probe = {
        .sessions = 1, .codec = "jpeg", .seconds = 5, .hz = 60, .motion = MOTION_ORBIT, .width_px = 1280, .height_px = 720
    };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        if (option == 'h') {
            print_usage(stdout);
            return 0;
        }
        if (!take_option(option, &probe)) {
            if (option != '?')
                fprintf(stderr, "plantcast probe: an option has the invalid value '%s': see plantcast probe --help\n", optarg);
            print_usage(stderr);
            return 2;
        }
    }
    if (probe.folder && !probe.signs)
        probe.signs = "refined";
    if (optind + 1 != argc || probe.stalled >= probe.sessions || (probe.folder && probe.blind)) {
        print_usage(stderr);
        return 2;
    }
    probe.url_text = argv[optind];
    if (!decodes(&probe))
        return 1;
    return daemon_url_parse(probe.url_text, access, &probe.url) ? run_probe(&probe) : 2;
}
