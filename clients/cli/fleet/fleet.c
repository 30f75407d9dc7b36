/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast fleet`: serves one page and one /metrics that show the servers of many plants. */
#include <getopt.h>
#include <libwebsockets.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "access/access.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/text/embedded.h"
#include "clients/cli/commands.h"
#include "fleet_poll.h"

enum { PORT = 8090, HEADER_BYTES = 2048, CHUNK = 16384, NAME_BYTES = 256 };

struct fleet_site {
    struct fleet_poll *poll;
    const struct fleet_file *file;
    /* additional host name under which the page may be requested; other non-local Host headers are refused (DNS rebinding). NULL: none */
    const char *host;
};

struct fleet_answer { /* response of one connection */
    char *body;
    size_t bytes, sent;
};

/* libwebsockets context; global, so that the signal handler, which gets no argument, can wake the server */
static struct lws_context *_Atomic serving;
static atomic_bool ending;

static void print_usage(FILE *out)
{
    fputs("usage: plantcast fleet FLEET.yaml [--check]\n"
          "       plantcast fleet FLEET.yaml --serve [--address ADDRESS] [--port PORT] [--host NAME]\n"
          "\n"
          "Serves one overview page and one /metrics page for the daemons of many plants.\n"
          "For each plant, the page shows a small picture, the alarms by priority and the field devices without a\n"
          "connection. For each daemon, it shows the version, certificate, disk space and last backup.\n"
          "If a daemon does not answer, the page shows since when.\n"
          "The page has no sign-in: to control who can see it, put it behind a reverse proxy.\n"
          "MONITORING.md describes FLEET.yaml.\n"
          "\n"
          "  --check            check FLEET.yaml for errors and exit\n"
          "  --address ADDRESS  address of this machine to listen on: 127.0.0.1 or ::1 (default: 127.0.0.1)\n"
          "  --port PORT        TCP port to listen on; 0: any free port (default: 8090)\n"
          "  --host NAME        host name under which browsers reach the reverse proxy; requests for other host\n"
          "                     names are refused, as protection against DNS rebinding\n",
          out);
}

/* --- answers ---------------------------------------------------------------------------------------------------------------- */

static const struct page_file {
    const char *path, *embedded, *type;
} page_files[] = {
    { "/", "clients/fleet/fleet.html", "text/html; charset=utf-8" },
    { "/fleet.js", "clients/fleet/fleet.js", "text/javascript; charset=utf-8" },
    { "/core/phrases.js", "clients/web/core/phrases.js", "text/javascript; charset=utf-8" },
    { "/words/fleet.en.js", "clients/web/words/fleet.en.js", "text/javascript; charset=utf-8" },
    { "/words/fleet.ko.js", "clients/web/words/fleet.ko.js", "text/javascript; charset=utf-8" },
    { "/words/fleet.de.js", "clients/web/words/fleet.de.js", "text/javascript; charset=utf-8" },
    { "/fleet.css", "clients/fleet/fleet.css", "text/css; charset=utf-8" },
};

/* Returns the response body for a request of `path` (mem_free), and sets *type to its content type. NULL: no such path. */
static char *answer_to(const struct fleet_site *site, const char *path, size_t *bytes, const char **type)
{
    static const char pictures[] = "/picture/";
    struct text text = { 0 };
    char *body = NULL;
    for (size_t i = 0; i < sizeof(page_files) / sizeof(*page_files); i++)
        if (!strcmp(path, page_files[i].path)) {
            *type = page_files[i].type;
            body = mem_strdup(embedded_find(page_files[i].embedded));
            *bytes = strlen(body);
            return body;
        }
    if (!strncmp(path, pictures, sizeof(pictures) - 1)) {
        *type = "image/png";
        return fleet_poll_picture(site->poll, path + sizeof(pictures) - 1, bytes);
    }
    struct fleet_plant_state *states = fleet_poll_states(site->poll);
    if (!strcmp(path, "/fleet.json")) {
        *type = "application/json";
        body = fleet_json(site->file, states, clock_utc_ns() / 1000);
        *bytes = strlen(body);
    } else if (!strcmp(path, "/metrics")) {
        *type = "text/plain; version=0.0.4; charset=utf-8";
        fleet_metrics(site->file, states, &text);
        body = text.at;
        *bytes = text.length;
    }
    mem_free(states);
    return body;
}

static bool add_header(struct lws *wsi, const char *name, const char *value, unsigned char **at, unsigned char *end)
{
    return !lws_add_http_header_by_name(wsi, (const unsigned char *)name, (const unsigned char *)value, (int)strlen(value), at, end);
}

static int begin_answer(struct lws *wsi, struct fleet_answer *answer, int status, const char *type)
{
    unsigned char buffer[LWS_PRE + HEADER_BYTES], *start = buffer + LWS_PRE, *at = start, *end = buffer + sizeof(buffer) - 1;
    if (lws_add_http_common_headers(wsi, (unsigned)status, type, answer->bytes, &at, end) ||
        !add_header(wsi, "Cache-Control:", "no-store", &at, end) || !add_header(wsi, "X-Content-Type-Options:", "nosniff", &at, end) ||
        !add_header(wsi, "Referrer-Policy:", "no-referrer", &at, end) ||
        !add_header(wsi, "Content-Security-Policy:", "default-src 'self'; base-uri 'none'; frame-ancestors 'none'", &at, end) ||
        lws_finalize_write_http_header(wsi, start, &at, end))
        return -1;
    lws_callback_on_writable(wsi);
    return 0;
}

/* Returns false if the request's Host header names another host, as in a DNS rebinding attack. */
static bool is_for_us(const struct fleet_site *site, struct lws *wsi)
{
    char host[NAME_BYTES], name[NAME_BYTES];
    if (lws_hdr_copy(wsi, host, sizeof(host), WSI_TOKEN_HOST) <= 0 || !access_host_name(host, name, sizeof(name)))
        return false;
    return access_name_is_local(name) || (site->host && !strcasecmp(site->host, name));
}

static int on_request(struct lws *wsi, struct fleet_answer *answer, const char *path)
{
    const struct fleet_site *site = lws_context_user(lws_get_context(wsi));
    const char *type = "text/plain; charset=utf-8";
    bool may = is_for_us(site, wsi), gets = lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0;
    mem_free(answer->body);
    *answer = (struct fleet_answer){ 0 };
    char *body = may && gets ? answer_to(site, path, &answer->bytes, &type) : NULL;
    int status = body ? HTTP_STATUS_OK : may ? HTTP_STATUS_NOT_FOUND : HTTP_STATUS_FORBIDDEN;
    if (!body) {
        type = "text/plain; charset=utf-8";
        body = mem_strdup(may ? "Not found.\n" : "This server does not serve this host name: see plantcast fleet --host.\n");
        answer->bytes = strlen(body);
    }
    answer->body = mem_array(LWS_PRE + answer->bytes + 1, 1);
    memcpy(answer->body + LWS_PRE, body, answer->bytes);
    mem_free(body);
    return begin_answer(wsi, answer, status, type);
}

static int write_on(struct lws *wsi, struct fleet_answer *answer)
{
    size_t left = answer->bytes - answer->sent, now = left < CHUNK ? left : CHUNK;
    bool last = now == left;
    if (!answer->body)
        return 0;
    unsigned char *at = (unsigned char *)answer->body + LWS_PRE + answer->sent;
    if (lws_write(wsi, at, now, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < (int)now)
        return -1;
    answer->sent += now;
    if (!last) {
        lws_callback_on_writable(wsi);
        return 0;
    }
    mem_free(answer->body);
    answer->body = NULL;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t length)
{
    struct fleet_answer *answer = user;
    switch (reason) {
    case LWS_CALLBACK_HTTP: return on_request(wsi, answer, in);
    case LWS_CALLBACK_HTTP_WRITEABLE: return write_on(wsi, answer);
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
    case LWS_CALLBACK_CLOSED_HTTP:
        if (answer) {
            mem_free(answer->body);
            answer->body = NULL;
        }
        return 0;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: return -1; /* reject WebSockets */
    default: return lws_callback_http_dummy(wsi, reason, user, in, length);
    }
}

/* --- the command ------------------------------------------------------------------------------------------------------------ */

static void on_signal(int number)
{
    (void)number;
    struct lws_context *context = atomic_load(&serving);
    atomic_store(&ending, true);
    if (context)
        lws_cancel_service(context);
}

static int serve(const struct fleet_file *file, const char *address, int port, const char *host)
{
    static const struct lws_protocols protocols[] = { { "http", on_event, sizeof(struct fleet_answer), 0, 0, NULL, 0 }, { 0 } };
    struct fleet_site site = { fleet_poll_start(file), file, host };
    struct lws_context_creation_info info = { .port = port,
                                              .iface = address,
                                              .protocols = protocols,
                                              .user = &site,
                                              .vhost_name = "fleet",
                                              .gid = (gid_t)-1,
                                              .uid = (uid_t)-1,
                                              .options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND |
                                                         (strchr(address, ':') ? 0 : LWS_SERVER_OPTION_DISABLE_IPV6) };
    lws_set_log_level(LLL_ERR, NULL);
    signal(SIGPIPE, SIG_IGN);
    struct lws_context *context = site.poll ? lws_create_context(&info) : NULL;
    struct lws_vhost *vhost = context ? lws_get_vhost_by_name(context, "fleet") : NULL;
    if (vhost) {
        atomic_store(&serving, context);
        signal(SIGINT, on_signal);
        signal(SIGTERM, on_signal);
        printf("plantcast fleet: ready http://%s%s%s:%d/\n", strchr(address, ':') ? "[" : "", address, strchr(address, ':') ? "]" : "",
               lws_get_vhost_listen_port(vhost));
        fflush(stdout);
        while (!atomic_load(&ending) && lws_service(context, 0) >= 0)
            continue;
    } else if (site.poll) {
        fprintf(stderr, "plantcast: cannot listen on %s port %d: another program may be using the port\n", address, port);
    }
    atomic_store(&serving, NULL);
    if (context)
        lws_context_destroy(context);
    fleet_poll_stop(&site.poll);
    return vhost ? 0 : 1;
}

static struct fleet_file *read_or_print(const char *path)
{
    struct diag diag = { 0 };
    struct fleet_file *file = fleet_file_read(path, &diag);
    diag_print(&diag, stderr);
    diag_finish(&diag);
    return file;
}

int cmd_fleet(int argc, char **argv)
{
    static const struct option options[] = { { "serve", no_argument, NULL, 's' },
                                             { "check", no_argument, NULL, 'c' },
                                             { "address", required_argument, NULL, 'a' },
                                             { "port", required_argument, NULL, 'p' },
                                             { "host", required_argument, NULL, 'n' },
                                             { "help", no_argument, NULL, 'h' },
                                             { NULL, 0, NULL, 0 } };
    const char *address = "127.0.0.1", *host = NULL;
    int port = PORT;
    bool serves = false;
    char *end = "";
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;)
        switch (option) {
        case 's': serves = true; break;
        case 'c': break;
        case 'a': address = optarg; break;
        case 'p': port = (int)strtol(optarg, &end, 10); break;
        case 'n': host = optarg; break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    bool is_here = !strncmp(address, "127.", 4) || !strcmp(address, "::1");
    if (argc - optind != 1 || *end || port < 0 || port > 65535 || !is_here) {
        print_usage(stderr);
        return 2;
    }
    struct fleet_file *file = read_or_print(argv[optind]);
    if (!file)
        return 1;
    int code = 0;
    if (serves)
        code = serve(file, address, port, host);
    else
        printf("%s: %zu plant%s\n", file->path, file->count, file->count == 1 ? "" : "s");
    fleet_file_free(&file);
    return code;
}
