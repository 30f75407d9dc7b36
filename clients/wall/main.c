/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plantcast-wall: shows one display of a control room's wall, without a browser. */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "player.h"
#include "screen.h"
#include "version.h"
#include "words.h"

enum { FAST_NS = 8000000, SLOW_NS = 50000000 };
static const int64_t STUCK_NS = 60 * NS_PER_S, WATCHDOG_NS = 2 * NS_PER_S, REST_NS = 250 * NS_PER_MS;

struct options {
    const char *wall, *language, *token_path, *ca_path;
    int display, monitor, width_px, height_px;
    bool software;
};

static const char help[] =
    "Shows one display of a wall, as `walls` of the server's plant file has it, without a browser.\n"
    "usage: plantcast-wall URL --wall NAME [--display N] [options]\n"
    "\n"
    "  --wall NAME        which wall\n"
    "  --display N        which of its displays, from 1 (1)\n"
    "  --token-file FILE  the token of this display, in its first line; it is read again at each connection. Without a token, or with\n"
    "                     one that is revoked, it shows six digits for an engineer to enter on the page; what it is let in with then\n"
    "                     is kept in that file, or else in STATE_DIRECTORY, XDG_STATE_HOME/plantcast or ~/.local/state/plantcast\n"
    "  --ca FILE          certificate that is trusted besides the system's\n"
    "  --monitor N        which monitor of this machine, from 0 (0)\n"
    "  --window WxH       a window of that size, not the whole monitor\n"
    "  --language L       en, ko or de (en)\n"
    "  --software         H.264 is decoded by the processor, also where VA-API is there\n"
    "  --version, --help\n"
    "\n"
    "It connects again for ever. Where no server is heard for 3 s it says so in large letters, and since when. SDL chooses X11, Wayland or "
    "KMS;\n"
    "SDL_VIDEODRIVER=kmsdrm and SDL_RENDER_DRIVER=software make it choose otherwise. Under systemd it feeds the watchdog.\n";

static volatile sig_atomic_t ended;

static void on_signal(int number)
{
    (void)number;
    ended = 1;
}

static int usage(const char *what)
{
    fprintf(stderr, "plantcast-wall: %s\nusage: plantcast-wall URL --wall NAME [--display N] (--help says more)\n", what);
    return 2;
}

/* Tells systemd, if it started us. */
static void notify(const char *text)
{
    const char *path = getenv("NOTIFY_SOCKET");
    struct sockaddr_un address = { .sun_family = AF_UNIX };
    if (!path || !path[0] || strlen(path) >= sizeof(address.sun_path))
        return;
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    strcpy(address.sun_path, path);
    if (path[0] == '@')
        address.sun_path[0] = 0;
    if (fd >= 0 && sendto(fd, text, strlen(text), MSG_NOSIGNAL, (struct sockaddr *)&address,
                          (socklen_t)(offsetof(struct sockaddr_un, sun_path) + strlen(path))) < 0)
        fprintf(stderr, "plantcast-wall: %s: %s\n", path, strerror(errno));
    if (fd >= 0)
        close(fd);
}

static bool take_number(const char *text, int low, int high, int *out)
{
    char *end;
    long value = strtol(text, &end, 10);
    *out = (int)value;
    return end > text && !*end && value >= low && value <= high;
}

/* Returns 0, or the exit status. */
static int take_options(int argc, char **argv, struct options *options)
{
    static const struct option known[] = {
        { "wall", required_argument, NULL, 'w' },
        { "display", required_argument, NULL, 'd' },
        { "token-file", required_argument, NULL, 't' },
        { "ca", required_argument, NULL, 'c' },
        { "monitor", required_argument, NULL, 'm' },
        { "window", required_argument, NULL, 's' },
        { "language", required_argument, NULL, 'l' },
        { "software", no_argument, NULL, 'p' },
        { 0 },
    };
    char rest;
    for (int c; (c = getopt_long(argc, argv, "", known, NULL)) != -1;) {
        if (c == 'w')
            options->wall = optarg;
        else if (c == 't')
            options->token_path = optarg;
        else if (c == 'c')
            options->ca_path = optarg;
        else if (c == 'l' && words_choose(optarg))
            options->language = optarg;
        else if (c == 'p')
            options->software = true;
        else if (c == 'd' && take_number(optarg, 1, WALL_DISPLAYS, &options->display))
            continue;
        else if (c == 'm' && take_number(optarg, 0, 15, &options->monitor))
            continue;
        else if (c == 's' && sscanf(optarg, "%dx%d%c", &options->width_px, &options->height_px, &rest) == 2 && options->width_px >= 160 &&
                 options->height_px >= 120 && options->width_px <= 8192 && options->height_px <= 8192)
            continue;
        else
            return usage(c == 'd'   ? "--display: a number from 1 to 16 expected"
                         : c == 'm' ? "--monitor: a number from 0 to 15 expected"
                         : c == 's' ? "--window: WIDTHxHEIGHT in pixels expected, such as 1280x720"
                         : c == 'l' ? "--language: en, ko or de expected"
                                    : "unknown option");
    }
    if (optind + 1 != argc)
        return usage(optind < argc ? "one URL expected" : "a URL is missing");
    return options->wall && options->wall[0] ? 0 : usage("--wall NAME is missing");
}

struct shown {
    int64_t at_ns;
    struct burn_shift shift;
    double light;
};

/* Shows what has changed. Returns false if nothing can be shown any more. */
static bool show(struct player *player, struct screen *screen, int64_t now_ns, bool exposed, bool *changed, struct shown *shown)
{
    struct box dirty;
    struct shown now = { now_ns, player_shift(player), player_brightness(player) };
    *changed = player_draw(player, now_ns, &dirty);
    if (*changed)
        screen_update(screen, player->surface, &dirty);
    if (!*changed && !exposed && now.shift.x_px == shown->shift.x_px && now.shift.y_px == shown->shift.y_px && now.light == shown->light)
        return true;
    *shown = now;
    return screen_present(screen, now.shift.x_px, now.shift.y_px, now.light, player->ground);
}

static bool take_events(struct player *player, struct screen *screen, bool *exposed)
{
    int window_px[2], display_px[2];
    for (enum screen_event event; (event = screen_poll(screen)) != SCREEN_NOTHING;) {
        if (event == SCREEN_QUIT)
            return false;
        screen_size(screen, window_px, display_px);
        if (event == SCREEN_RESIZED || window_px[0] != player->width_px || window_px[1] != player->height_px)
            player_resize(player, window_px[0], window_px[1]);
        *exposed = true;
    }
    return true;
}

/* Redraws often while something moves, and rarely else. Returns the exit status. */
static int run(struct player *player, struct screen *screen)
{
    int64_t fed_ns = 0, moved_ns = 0;
    struct shown shown = { 0 };
    notify("READY=1");
    while (!ended) {
        bool exposed = false, changed;
        int64_t now_ns = clock_mono_ns();
        if (!take_events(player, screen, &exposed))
            break;
        if (!show(player, screen, now_ns, exposed, &changed, &shown))
            return 1;
        if (changed || player_waits(player))
            moved_ns = now_ns;
        int64_t alive_ns = links_alive_ns(&player->links);
        if (now_ns - fed_ns >= WATCHDOG_NS && now_ns - alive_ns < STUCK_NS) {
            notify("WATCHDOG=1");
            fed_ns = now_ns;
        }
        player_wait(player, now_ns + (now_ns - moved_ns < REST_NS ? FAST_NS : SLOW_NS));
    }
    notify("STOPPING=1");
    return 0;
}

int main(int argc, char **argv)
{
    static struct player player;
    struct options options = { .display = 1, .language = "en" };
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--help"))
            return fputs(help, stdout) < 0;
        if (!strcmp(argv[i], "--version"))
            return printf("plantcast-wall %s\n", PLANTCAST_VERSION) < 0;
    }
    setenv("TZ", "UTC", 1); /* until the plant's own is known */
    words_choose(options.language);
    int status = take_options(argc, argv, &options);
    if (status)
        return status;
    if (!daemon_set_options(NULL, options.ca_path) || !daemon_url_parse(argv[optind], &player.url))
        return 2;
    struct sigaction action = { .sa_handler = on_signal };
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGINT, &action, NULL);
    signal(SIGPIPE, SIG_IGN);
    srand((unsigned)(clock_utc_ns() ^ getpid()));
    struct screen *screen = screen_open(options.width_px, options.height_px, options.monitor);
    if (!screen)
        return 1;
    int window_px[2], display_px[2];
    screen_size(screen, window_px, display_px);
    player.wall_id = options.wall;
    player.display = options.display;
    pairing_init(&player.pairing, options.token_path, &player.url, options.wall, options.display);
    player.by_gpu = !options.software;
    player.width_px = window_px[0];
    player.height_px = window_px[1];
    player.display_width_px = display_px[0];
    player.display_height_px = display_px[1];
    printf("plantcast-wall: %s\n", screen_name(screen));
    fflush(stdout);
    status = player_start(&player) ? run(&player, screen) : 1;
    player_finish(&player);
    screen_close(&screen);
    return status;
}
