/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the command line of plantcast-video, and checks which options may be combined. */
#include "options.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>

#include "render/overlay/overlay_words.h"
#include "version.h"

enum { MIN_PX = 320, MAX_PX = 4096, MIN_HEIGHT_PX = 180, MIN_FPS = 5, MAX_FPS = 30, SRT_LEAST_CHARS = 10, SRT_MOST_CHARS = 79 };

static const char SUMMARY[] = "Serves a view of a Plantcast daemon as H.264 video over RTSP and SRT. The video is encoded once for all "
                              "viewers.\n"
                              "The picture shows sensor markers, a legend, a clock and the age of the values.\n"
                              "If the daemon or the values become unavailable, the picture says so within 3 s.";
static const char DETAIL[] = "Give --rtsp, --srt or both.\n"
                             "If --listen is not 127.0.0.1, --readers-file or --open-readers is required.\n"
                             "Players open these addresses:\n"
                             "  RTSP  rtsp://HOST:PORT/plantcast (with user and password)\n"
                             "  SRT   srt://HOST:PORT, in caller mode (the passphrase is the password in --readers-file)\n"
                             "Only SRT is encrypted. With --http PORT, http://127.0.0.1:PORT/metrics serves metrics for Prometheus.\n"
                             "Exit status: 0 success, 2 wrong usage, 1 any other error.";

static int wrong(const char *fmt, ...) G_GNUC_PRINTF(1, 2);
static int wrong(const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    fputs("plantcast-video: ", stderr);
    vfprintf(stderr, fmt, ap);
    fputs("\n", stderr);
    va_end(ap);
    return 2;
}

/* Returns the first line of a file without surrounding blanks (g_free), or NULL with the reason printed. */
static char *first_line(const char *path)
{
    char *text = NULL;
    GError *error = NULL;
    if (!g_file_get_contents(path, &text, NULL, &error)) {
        wrong("%s", error->message);
        g_error_free(error);
        return NULL;
    }
    text[strcspn(text, "\r\n")] = 0;
    g_strstrip(text);
    if (!text[0] || strlen(text) > 256) {
        wrong("%s: the first line must have 1 to 256 characters", path);
        g_clear_pointer(&text, g_free);
    }
    return text;
}

static int read_readers(struct video_options *options, const char *path)
{
    char *line = first_line(path), *colon = line ? strchr(line, ':') : NULL;
    int code = -1;
    if (line && (!colon || colon == line || !colon[1]))
        code = wrong("%s: the first line must be USER:PASSWORD", path);
    else if (!line)
        code = 2;
    else {
        options->user = g_strndup(line, (gsize)(colon - line));
        options->password = g_strdup(colon + 1);
        size_t n = strlen(options->password);
        if (options->srt_port && (n < SRT_LEAST_CHARS || n > SRT_MOST_CHARS))
            code = wrong("%s: the password is also the SRT passphrase, and must have %d to %d characters; it has %zu", path,
                         SRT_LEAST_CHARS, SRT_MOST_CHARS, n);
    }
    g_free(line);
    return code;
}

static int read_url(struct video_options *options, int argc, char **argv)
{
    if (argc != 2)
        return wrong("expected the URL of one daemon, such as http://HOST:PORT/ (see --help)");
    GUri *uri = g_uri_parse(argv[1], G_URI_FLAGS_NONE, NULL);
    const char *scheme = uri ? g_uri_get_scheme(uri) : "";
    bool good = uri && (!strcmp(scheme, "http") || !strcmp(scheme, "https")) && g_uri_get_host(uri) && *g_uri_get_host(uri) &&
                !g_uri_get_query(uri) && !g_uri_get_fragment(uri) && !g_uri_get_userinfo(uri);
    if (good)
        options->url = g_strconcat(argv[1], g_str_has_suffix(argv[1], "/") ? "" : "/", NULL);
    if (uri)
        g_uri_unref(uri);
    return good ? -1 : wrong("'%s' is not a URL such as https://HOST:PORT/, or https://HOST/PATH/ of a proxy", argv[1]);
}

static int read_size(struct video_options *options, const char *text)
{
    int n = 0;
    if (text && (sscanf(text, "%dx%d%n", &options->width_px, &options->height_px, &n) != 2 || text[n]))
        return wrong("--size %s: expected WIDTHxHEIGHT, such as 1920x1080", text);
    if (options->width_px < MIN_PX || options->width_px > MAX_PX || options->height_px < MIN_HEIGHT_PX || options->height_px > MAX_PX ||
        options->width_px % 2 || options->height_px % 2)
        return wrong("--size %dx%d: expected even numbers from %dx%d to %dx%d", options->width_px, options->height_px, MIN_PX,
                     MIN_HEIGHT_PX, MAX_PX, MAX_PX);
    return -1;
}

static int check_number(const char *name, int value, int least, int most)
{
    return value >= least && value <= most ? -1 : wrong("%s %d: expected %d to %d", name, value, least, most);
}

static int check_numbers(const struct video_options *options)
{
    const struct {
        const char *name;
        int value, least, most;
    } numbers[] = { { "--fps", options->fps, MIN_FPS, MAX_FPS }, { "--kbps", options->kbps, 100, 100000 },
                    { "--every", options->every_ms, 200, 1000 }, { "--most-readers", options->most_readers, 1, OPTIONS_MOST_READERS },
                    { "--rtsp", options->rtsp_port, 0, 65535 },  { "--http", options->http_port, 0, 65535 },
                    { "--srt", options->srt_port, 0, 65535 } };
    int code = -1;
    for (size_t i = 0; i < G_N_ELEMENTS(numbers) && code < 0; i++)
        code = check_number(numbers[i].name, numbers[i].value, numbers[i].least, numbers[i].most);
    return code;
}

static bool is_loopback(const char *address)
{
    struct in_addr four;
    return !strcmp(address, "::1") || (inet_pton(AF_INET, address, &four) == 1 && ntohl(four.s_addr) >> 24 == 127);
}

static int check_together(struct video_options *options, bool open_readers)
{
    unsigned char address[16];
    if (options->view && options->query)
        return wrong("--view and --query cannot be combined");
    if (!overlay_language_find(options->language, &options->words))
        return wrong("--language %s: expected en, ko or de", options->language);
    if (!options->rtsp_port && !options->srt_port)
        return wrong("no output: give --rtsp, --srt or both");
    if (inet_pton(AF_INET, options->listen, address) != 1 && inet_pton(AF_INET6, options->listen, address) != 1)
        return wrong("--listen %s: expected an address such as 0.0.0.0 or ::", options->listen);
    if (!is_loopback(options->listen) && !options->user && !open_readers)
        return wrong("--listen %s: anyone who can reach this address could watch; add --readers-file FILE, or --open-readers to allow that",
                     options->listen);
    if (options->user && open_readers)
        return wrong("--readers-file and --open-readers cannot be combined");
    return -1;
}

int options_read(struct video_options *options, int *argc, char ***argv)
{
    char *size = NULL, *readers_path = NULL;
    gboolean open_readers = FALSE, time_code = FALSE, version = FALSE;
    *options = (struct video_options){ .width_px = 1280, .height_px = 720, .fps = 10, .kbps = 4000, .every_ms = 1000 };
    options->most_readers = 64;
    const GOptionEntry entries[] = {
        { "view", 0, 0, G_OPTION_ARG_STRING, &options->view, "id of the view to show: a view in the plant file, or one saved on the page",
          "ID" },
        { "query", 0, 0, G_OPTION_ARG_STRING, &options->query,
          "view to show, as query parameters of /snapshot.png: "
          "group=temperature&camera=...",
          "PARAMETERS" },
        { "language", 0, 0, G_OPTION_ARG_STRING, &options->language, "language of all text in the picture: en, ko or de (default: en)",
          "LANGUAGE" },
        { "token-file", 0, 0, G_OPTION_ARG_FILENAME, &options->token_path,
          "file whose first line is a token for the daemon, made by `plantcast token`", "FILE" },
        { "ca", 0, 0, G_OPTION_ARG_FILENAME, &options->ca_path,
          "file of certificates (PEM) to trust instead of the system's "
          "certificates",
          "FILE" },
        { "size", 0, 0, G_OPTION_ARG_STRING, &size, "width and height of the video in pixels (default: 1280x720)", "WxH" },
        { "fps", 0, 0, G_OPTION_ARG_INT, &options->fps, "frames per second, 5 to 30, even while nothing changes (default: 10)", "N" },
        { "kbps", 0, 0, G_OPTION_ARG_INT, &options->kbps, "maximum bit rate of the video in kbit/s (default: 4000)", "N" },
        { "every", 0, 0, G_OPTION_ARG_INT, &options->every_ms,
          "time between two pictures from the daemon in ms, 200 to 1000 (default: 1000)", "MS" },
        { "listen", 0, 0, G_OPTION_ARG_STRING, &options->listen,
          "address of this machine on which RTSP and SRT are served (default: 127.0.0.1)", "ADDRESS" },
        { "rtsp", 0, 0, G_OPTION_ARG_INT, &options->rtsp_port, "TCP port on which to serve RTSP", "PORT" },
        { "srt", 0, 0, G_OPTION_ARG_INT, &options->srt_port, "UDP port on which to serve SRT", "PORT" },
        { "http", 0, 0, G_OPTION_ARG_INT, &options->http_port, "TCP port of 127.0.0.1 on which to serve /metrics", "PORT" },
        { "readers-file", 0, 0, G_OPTION_ARG_FILENAME, &readers_path, "file whose first line is USER:PASSWORD, which viewers must give",
          "FILE" },
        { "open-readers", 0, 0, G_OPTION_ARG_NONE, &open_readers, "require no password: anyone who can reach the address can watch", NULL },
        { "most-readers", 0, 0, G_OPTION_ARG_INT, &options->most_readers,
          "maximum number of simultaneous viewers, for RTSP and for SRT each (default: 64)", "N" },
        { "time-code", 0, 0, G_OPTION_ARG_NONE, &time_code,
          "add a row of blocks below the picture that encodes the picture's time, to be read by programs", NULL },
        { "version", 0, 0, G_OPTION_ARG_NONE, &version, "print the version", NULL },
        { NULL, 0, 0, G_OPTION_ARG_NONE, NULL, NULL, NULL }
    };
    GOptionContext *context = g_option_context_new("URL");
    GError *error = NULL;
    g_option_context_set_summary(context, SUMMARY);
    g_option_context_set_description(context, DETAIL);
    g_option_context_add_main_entries(context, entries, NULL);
    int code = g_option_context_parse(context, argc, argv, &error) ? -1 : wrong("%s", error->message);
    g_clear_error(&error);
    g_option_context_free(context);
    if (code < 0 && version) {
        puts("plantcast-video " PLANTCAST_VERSION);
        code = 0;
    }
    options->time_code = time_code;
    if (!options->listen)
        options->listen = g_strdup("127.0.0.1");
    if (!options->language)
        options->language = g_strdup("en");
    if (code < 0)
        code = read_url(options, *argc, *argv);
    if (code < 0)
        code = read_size(options, size);
    if (code < 0)
        code = check_numbers(options);
    if (code < 0 && options->token_path && !(options->token = first_line(options->token_path)))
        code = 2;
    if (code < 0 && readers_path)
        code = read_readers(options, readers_path);
    if (code < 0)
        code = check_together(options, open_readers);
    g_free(size);
    g_free(readers_path);
    return code;
}

void options_finish(struct video_options *options)
{
    char *const texts[] = { options->url,    options->view,     options->query,      options->token, options->ca_path,
                            options->listen, options->language, options->token_path, options->user,  options->password };
    for (size_t i = 0; i < G_N_ELEMENTS(texts); i++)
        g_free(texts[i]);
    *options = (struct video_options){ 0 };
}
