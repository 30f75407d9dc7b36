/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Command line of plantcastd, which reads a plant, renders it and serves the pictures. */
#include <arpa/inet.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/system/service_manager.h"
#include "base/system/standard_output.h"
#include "net/handed_socket.h"
#include "server.h"
#include "version.h"

#ifdef PLANTCAST_OPCUA
#define LACKS ""
#else
#define LACKS "\nbuilt without OPC UA"
#endif

enum { GOOD = 0, FAILED = 1, USAGE = 2 };
enum { MIN_MEMORY_MB = 128, MAX_MEMORY_MB = 1 << 20 };

static void print_usage(FILE *out)
{
    fputs("usage: plantcastd PLANT.yaml [OPTION ...]\n"
          "       plantcastd --check PLANT.yaml [OPTION ...]\n"
          "       plantcastd --dump-plan PLANT.yaml\n"
          "       plantcastd --test-notify PLANT.yaml\n"
          "       plantcastd --list-gl-devices | --version | --help\n"
          "\n"
          "Serves live pictures of a plant to browsers and other clients.\n"
          "\n"
          "  --check          read all files, including those given with --tokens, --openid, --notice,\n"
          "                   --tls-cert and --signing-key, print every error and exit; no server is started\n"
          "  --dump-plan      print the requests that this daemon would send to field devices, with registers\n"
          "                   and load, and exit\n"
          "  --test-notify    send a test message to every recipient in the plant file's `notify`, print\n"
          "                   whether each was accepted, and exit (exit status 0: all were)\n"
          "  --list-gl-devices  print the GPUs that --gl-device accepts, and exit\n"
          "\n"
          "Network:\n"
          "  --listen ADDRESS  IP address of this machine to listen on (default: 127.0.0.1)\n"
          "  --port N         TCP port to listen on; 0: any free port (default: 8080)\n"
          "  --web DIR        folder with the files of the web page (default: the folder installed with this\n"
          "                   program)\n"
          "  --host NAME      additional host name under which browsers may reach this server; may be given up\n"
          "                   to 16 times\n"
          "  --origin URL     address of another web site that may connect to this server and embed its page,\n"
          "                   such as https://portal.example; may be given up to 16 times\n"
          "  --behind-proxy   take clients' addresses from X-Forwarded-For, which a reverse proxy on this\n"
          "                   machine sets; requires --host\n"
          "  --trusted-proxy ADDRESS[/BITS]  take clients' addresses from X-Forwarded-For of a proxy on another\n"
          "                   machine, such as 10.0.0.10 or 10.0.0.0/28; ignore X-Forwarded-For from all other\n"
          "                   machines; may be given up to 16 times\n"
          "  --limit NAME=N   change one resource limit; the limits are listed below; may be repeated\n"
          "\n"
          "Drawing:\n"
          "  --gl CONTEXT     OpenGL context to draw with: auto, egl-device, egl-surfaceless or osmesa (on the\n"
          "                   CPU) (default: auto, the first context that works)\n"
          "  --gl-device GPU  GPU to draw with: its number from --list-gl-devices, or its PCI address such as\n"
          "                   0000:65:00.0\n"
          "  --memory MB      total memory limit for all caches (default: a quarter of the machine's memory,\n"
          "                   at most 2048). The model and the picture being drawn are not included. /metrics\n"
          "                   shows how much each cache uses\n"
          "  --field WHERE    where values between sensors are computed: vertices (fast) or per-fragment (at each pixel,\n"
          "                   which is slow, for comparison only) (default: vertices)\n"
          "  --h264 ENCODER   libavcodec encoder for H.264 video: libx264, h264_nvenc, h264_vaapi, libopenh264,\n"
          "                   ...; off: send JPEG only (default: libx264). If the encoder does not work on this\n"
          "                   machine, clients get JPEG\n"
          "\n"
          "Files:\n"
          "  --prepared DIR   output folder of plantcast-prep (default: NAME.prepared next to NAME.yaml;\n"
          "                   for /etc/plantcast/NAME/plant.yaml, also /var/lib/plantcast/NAME/prepared)\n"
          "  --history DIR    folder in which readings are recorded (default: the folder that the plant file\n"
          "                   names, else a folder next to the plant file)\n"
          "  --import[=now]   let engineers upload models and tag lists on the page, as `plantcast import\n"
          "                   --serve` does. --import=now: also import the files in the folder `exports` next to\n"
          "                   the plant file when the daemon starts\n"
          "  --signing-key FILE  sign the pictures from /snapshot.png with the Ed25519 private key in FILE (PEM);\n"
          "                   `openssl genpkey -algorithm ed25519` creates such a key\n"
          "  --log-level LEVEL  lowest severity of log lines to write: error, warn, info or debug (default:\n"
          "                   info)\n"
          "  --log-format FORMAT  format of log lines: text, json (one object per line) or journal (default:\n"
          "                   journal if standard error is the systemd journal, else text)\n"
          "\n"
          "Several machines:\n"
          "  --role ROLE      what this daemon does: all: polls field devices and serves users; core: like all,\n"
          "                   and lets daemons with the role render connect; render: draws pictures only,\n"
          "                   with readings and alarms from a core (default: all)\n"
          "  --core URL       with --role render: address wss://HOST:PORT of the core; repeat the option for a\n"
          "                   second core. With --role core: address of the other core. One core is active, the\n"
          "                   other core takes over when the active core fails; two cores need PostgreSQL\n"
          "  --core-token-file FILE  file with the token that this daemon presents to the core (`plantcast\n"
          "                   token add --role renderer`, or standby for a second core)\n"
          "  --core-ca FILE   CA certificates (PEM) for checking the core's certificate\n"
          "  --node NAME      name of this daemon in the core's log (default: host name)\n"
          "  --agent-port PORT  port on which HAProxy's agent check reads how much capacity this daemon has\n"
          "                   left. The signal SIGUSR1 moves all sessions to other daemons\n"
          "\n"
          "Access: without --tokens, all users on this machine have access, and no other machine has.\n"
          "To listen on another address, give --tls-cert and --tokens, or --open-viewers.\n"
          "\n"
          "  --tls-cert FILE  TLS certificate of this server with its chain (PEM); reloaded when the file\n"
          "                   changes\n"
          "  --tls-key FILE   private key of the TLS certificate (PEM); reloaded when the file changes\n"
          "  --tokens FILE    users and programs that have access, with their roles, as `plantcast token`\n"
          "                   writes them. Users on this machine need a token too. Reloaded when the file\n"
          "                   changes\n"
          "  --openid FILE    sign users in through an identity provider (OpenID Connect); FILE holds the\n"
          "                   settings of the provider\n"
          "  --notice FILE    text that the page shows before users sign in (UTF-8, at most 4 kB)\n"
          "  --lock-after MINUTES  sign users out after MINUTES without activity, except users whose token was\n"
          "                   created with --unattended\n"
          "  --open-viewers   let anyone who can reach the --listen address view pictures, but do nothing else\n"
          "  --trust-local    with --tokens: users on this machine need no token and have the role engineer\n"
          "  --audit FILE     record sign-ins, refused requests and changes in FILE; `plantcast audit verify\n"
          "                   FILE` detects whether FILE was altered\n"
          "  --audit-size MB  size in MB at which a new audit file begins; the full file is kept (default: 64)\n"
          "  --audit-syslog HOST[:PORT]  also send the audit trail to this syslog server over TLS (default port:\n"
          "                   6514)\n"
          "  --audit-ca FILE  CA certificates (PEM) for checking the syslog server's certificate\n"
          "  --audit-cert FILE, --audit-key FILE  certificate and private key that this daemon presents to the\n"
          "                   syslog server\n"
          "\n"
          "Resource limits (--limit NAME=N) with their defaults:\n",
          out);
    quotas_print(out);
}

static bool parse_minutes(const char *text, double *out)
{
    char *end;
    *out = strtod(text, &end);
    return end != text && !*end && *out >= 0.01 && *out <= 1440;
}

static bool parse_int(const char *text, long low, long high, int *out)
{
    char *end;
    long value = strtol(text, &end, 10);
    if (end == text || *end || value < low || value > high)
        return false;
    *out = (int)value;
    return true;
}

static bool parse_level(const char *text, enum log_level *level)
{
    static const char *const names[] = { "error", "warn", "info", "debug" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (!strcmp(names[i], text)) {
            *level = (enum log_level)i;
            return true;
        }
    return false;
}

static bool parse_format(const char *text, enum log_format *format)
{
    static const char *const names[] = { "text", "json", "journal" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (!strcmp(names[i], text)) {
            *format = (enum log_format)i;
            return true;
        }
    return false;
}

static bool parse_field(const char *text, bool *per_fragment)
{
    *per_fragment = !strcmp(text, "per-fragment");
    return *per_fragment || !strcmp(text, "vertices");
}

static bool is_loopback(const char *address)
{
    struct in_addr four;
    struct in6_addr six;
    if (inet_pton(AF_INET, address, &four) == 1)
        return ntohl(four.s_addr) >> 24 == 127;
    return inet_pton(AF_INET6, address, &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

/* Prints where the options are listed. The whole list is too long to follow an error, which would no longer be on the screen. */
static int point_to_help(void)
{
    fprintf(stderr, "usage: plantcastd PLANT.yaml [OPTION ...]; plantcastd --help lists the options\n");
    return USAGE;
}

static int usage_error(const char *what, const char *value)
{
    fprintf(stderr, "plantcastd: %s '%s'\n", what, value);
    return point_to_help();
}

enum {
    OPTION_LISTEN = 256,
    OPTION_PORT,
    OPTION_GL,
    OPTION_FIELD,
    OPTION_GL_DEVICE,
    OPTION_H264,
    OPTION_LIST_GL,
    OPTION_PREPARED,
    OPTION_HISTORY,
    OPTION_WEB,
    OPTION_LEVEL,
    OPTION_FORMAT,
    OPTION_MEMORY,
    OPTION_OPEN,
    OPTION_TLS_CERT,
    OPTION_TLS_KEY,
    OPTION_TOKENS,
    OPTION_OPENID,
    OPTION_NOTICE,
    OPTION_LOCK,
    OPTION_PROXY,
    OPTION_TRUSTED_PROXY,
    OPTION_TRUST,
    OPTION_HOST,
    OPTION_ORIGIN,
    OPTION_LIMIT,
    OPTION_SIGNING_KEY,
    OPTION_AUDIT,
    OPTION_AUDIT_SYSLOG,
    OPTION_AUDIT_CA,
    OPTION_AUDIT_CERT,
    OPTION_AUDIT_KEY,
    OPTION_AUDIT_SIZE,
    OPTION_IMPORT,
    OPTION_ROLE,
    OPTION_CORE,
    OPTION_CORE_TOKEN,
    OPTION_CORE_CA,
    OPTION_NODE,
    OPTION_AGENT,
    OPTION_CHECK,
    OPTION_PLAN,
    OPTION_TEST_NOTIFY,
    OPTION_VERSION,
    OPTION_HELP
};

static const struct option options[] = {
    { "listen", required_argument, NULL, OPTION_LISTEN },
    { "port", required_argument, NULL, OPTION_PORT },
    { "field", required_argument, NULL, OPTION_FIELD },
    { "gl", required_argument, NULL, OPTION_GL },
    { "h264", required_argument, NULL, OPTION_H264 },
    { "gl-device", required_argument, NULL, OPTION_GL_DEVICE },
    { "list-gl-devices", no_argument, NULL, OPTION_LIST_GL },
    { "history", required_argument, NULL, OPTION_HISTORY },
    { "prepared", required_argument, NULL, OPTION_PREPARED },
    { "web", required_argument, NULL, OPTION_WEB },
    { "log-level", required_argument, NULL, OPTION_LEVEL },
    { "log-format", required_argument, NULL, OPTION_FORMAT },
    { "memory", required_argument, NULL, OPTION_MEMORY },
    { "open-viewers", no_argument, NULL, OPTION_OPEN },
    { "tls-cert", required_argument, NULL, OPTION_TLS_CERT },
    { "tls-key", required_argument, NULL, OPTION_TLS_KEY },
    { "tokens", required_argument, NULL, OPTION_TOKENS },
    { "openid", required_argument, NULL, OPTION_OPENID },
    { "notice", required_argument, NULL, OPTION_NOTICE },
    { "lock-after", required_argument, NULL, OPTION_LOCK },
    { "behind-proxy", no_argument, NULL, OPTION_PROXY },
    { "trusted-proxy", required_argument, NULL, OPTION_TRUSTED_PROXY },
    { "trust-local", no_argument, NULL, OPTION_TRUST },
    { "host", required_argument, NULL, OPTION_HOST },
    { "origin", required_argument, NULL, OPTION_ORIGIN },
    { "limit", required_argument, NULL, OPTION_LIMIT },
    { "signing-key", required_argument, NULL, OPTION_SIGNING_KEY },
    { "audit", required_argument, NULL, OPTION_AUDIT },
    { "audit-syslog", required_argument, NULL, OPTION_AUDIT_SYSLOG },
    { "audit-ca", required_argument, NULL, OPTION_AUDIT_CA },
    { "audit-cert", required_argument, NULL, OPTION_AUDIT_CERT },
    { "audit-key", required_argument, NULL, OPTION_AUDIT_KEY },
    { "audit-size", required_argument, NULL, OPTION_AUDIT_SIZE },
    { "import", optional_argument, NULL, OPTION_IMPORT },
    { "role", required_argument, NULL, OPTION_ROLE },
    { "core", required_argument, NULL, OPTION_CORE },
    { "core-token-file", required_argument, NULL, OPTION_CORE_TOKEN },
    { "core-ca", required_argument, NULL, OPTION_CORE_CA },
    { "agent-port", required_argument, NULL, OPTION_AGENT },
    { "node", required_argument, NULL, OPTION_NODE },
    { "check", no_argument, NULL, OPTION_CHECK },
    { "dump-plan", no_argument, NULL, OPTION_PLAN },
    { "test-notify", no_argument, NULL, OPTION_TEST_NOTIFY },
    { "version", no_argument, NULL, OPTION_VERSION },
    { "help", no_argument, NULL, OPTION_HELP },
    { NULL, 0, NULL, 0 },
};

static bool add_host(struct access_params *access, const char *name)
{
    char lower[256];
    if (access->host_count == ACCESS_MAX_NAMES || !access_host_name(name, lower, sizeof(lower)) || strcasecmp(name, lower) != 0)
        return false;
    access->hosts[access->host_count++] = name;
    return true;
}

static bool add_origin(struct access_params *access, const char *url)
{
    const char *name = strstr(url, "://");
    char lower[256];
    if (access->origin_count == ACCESS_MAX_NAMES || !name || !access_host_name(name + 3, lower, sizeof(lower)))
        return false;
    access->origins[access->origin_count++] = url;
    return true;
}

/* Handles a command-line option about access. Returns -1 if the program continues, otherwise the exit code. */
static int take_access_option(int option, struct access_params *access)
{
    switch (option) {
    case OPTION_OPEN: access->open_viewers = true; return -1;
    case OPTION_TLS_CERT: access->tls_cert_path = optarg; return -1;
    case OPTION_TLS_KEY: access->tls_key_path = optarg; return -1;
    case OPTION_TOKENS: access->tokens_path = optarg; return -1;
    case OPTION_OPENID: access->openid_path = optarg; return -1;
    case OPTION_NOTICE: access->notice_path = optarg; return -1;
    case OPTION_LOCK:
        return parse_minutes(optarg, &access->lock_min)
                   ? -1
                   : usage_error("--lock-after: expected a number of minutes, at most 1440, found", optarg);
    case OPTION_PROXY: access->behind_proxy = true; return -1;
    case OPTION_TRUSTED_PROXY:
        return access_add_proxy(access, optarg)
                   ? -1
                   : usage_error("--trusted-proxy: expected ADDRESS or ADDRESS/BITS with at least 1 bit (at most 16), found", optarg);
    case OPTION_TRUST: access->trust_local = true; return -1;
    case OPTION_HOST:
        return add_host(access, optarg) ? -1 : usage_error("--host: expected a name without port (at most 16 names), found", optarg);
    case OPTION_ORIGIN:
        return add_origin(access, optarg) ? -1 : usage_error("--origin: expected SCHEME://HOST[:PORT] (at most 16), found", optarg);
    case OPTION_LIMIT:
        return quotas_parse(&access->quotas, optarg) ? -1 : usage_error("--limit: unknown limit, or value out of range:", optarg);
    default: /* unknown option, for which getopt has already printed an error */ return point_to_help();
    }
}

/* Handles a command-line option about the audit trail. Returns -1 if the program continues, otherwise the exit code. */
static int take_audit_option(int option, struct server_params *params)
{
    struct audit_params *audit = &params->audit;
    int megabytes;
    switch (option) {
    case OPTION_AUDIT: audit->path = optarg; return -1;
    case OPTION_AUDIT_SYSLOG: audit->syslog = optarg; return -1;
    case OPTION_AUDIT_CA: audit->syslog_ca = optarg; return -1;
    case OPTION_AUDIT_CERT: audit->syslog_cert = optarg; return -1;
    case OPTION_AUDIT_KEY: audit->syslog_key = optarg; return -1;
    case OPTION_AUDIT_SIZE:
        if (!parse_int(optarg, 1, 1024, &megabytes))
            return usage_error("--audit-size: expected megabytes from 1 to 1024, found", optarg);
        audit->most_bytes = (size_t)megabytes << 20;
        return -1;
    default: return take_access_option(option, &params->access);
    }
}

static bool parse_role(const char *text, enum server_role *role)
{
    static const char *const names[] = { [SERVER_ALL] = "all", [SERVER_CORE] = "core", [SERVER_RENDER] = "render" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (!strcmp(names[i], text)) {
            *role = (enum server_role)i;
            return true;
        }
    return false;
}

static bool add_core(struct server_params *params, const char *url)
{
    if (params->core_count == CORE_URLS || !core_link_url_good(url))
        return false;
    params->cores[params->core_count++] = url;
    return true;
}

/* Handles a command-line option about the daemon's role. Returns -1 if the program continues, otherwise the exit code. */
static int take_role_option(int option, struct server_params *params)
{
    switch (option) {
    case OPTION_ROLE: return parse_role(optarg, &params->role) ? -1 : usage_error("--role: expected all, core or render, found", optarg);
    case OPTION_CORE: return add_core(params, optarg) ? -1 : usage_error("--core: expected wss://HOST:PORT (at most 4), found", optarg);
    case OPTION_AGENT:
        return parse_int(optarg, 1, 65535, &params->agent_port) ? -1 : usage_error("--agent-port: expected a port, found", optarg);
    case OPTION_CORE_TOKEN: params->core_token = optarg; return -1;
    case OPTION_CORE_CA: params->core_ca = optarg; return -1;
    case OPTION_NODE: params->node = optarg; return tokens_name_valid(optarg) ? -1 : usage_error("--node: invalid name:", optarg);
    default: return take_audit_option(option, params);
    }
}

/* Checks that the command-line options about the role are consistent. Returns NULL if they are, else what is wrong. */
static const char *role_wrong(const struct server_params *params)
{
    bool render = params->role == SERVER_RENDER;
    if (render && !params->core_count)
        return "--role render requires --core URL";
    if (params->role == SERVER_ALL && params->core_count)
        return "--core URL requires --role render, or --role core if there is a second core";
    if (!params->core_count && (params->core_token || params->core_ca))
        return "--core-token-file and --core-ca require --core URL";
    if (render && params->imports)
        return "--import is not allowed with --role render: give --import to the core";
    return NULL;
}

/* Handles any command-line option. Returns -1 if the program continues, otherwise the exit code. *task receives the function to
   run instead of serving, if the option asks for one. */
static int take_option(int option, struct server_params *params, int (**task)(const struct server_params *params))
{
    int megabytes;
    switch (option) {
    case OPTION_LISTEN:
        params->address = strcmp(optarg, "localhost") == 0 ? "127.0.0.1" : optarg;
        return access_name_is_address(params->address) ? -1 : usage_error("--listen: expected an IP address, found", optarg);
    case OPTION_PORT:
        return parse_int(optarg, 0, 65535, &params->port) ? -1 : usage_error("--port: expected a number from 0 to 65535, found", optarg);
    case OPTION_FIELD:
        return parse_field(optarg, &params->per_fragment) ? -1 : usage_error("--field: expected vertices or per-fragment, found", optarg);
    case OPTION_GL: return gl_kind_parse(optarg, &params->gl) ? -1 : usage_error("--gl: unknown OpenGL context", optarg);
    case OPTION_GL_DEVICE:
        params->has_gl_device = true;
        return gl_device_parse(optarg, &params->gl_device) ? -1
                                                           : usage_error("--gl-device: expected an index or a PCI address, found", optarg);
    case OPTION_LIST_GL: return gl_list_devices(stdout) > 0 ? GOOD : FAILED;
    case OPTION_H264: params->h264 = optarg; return -1;
    case OPTION_HISTORY: params->history = optarg; return -1;
    case OPTION_PREPARED: params->prepared = optarg; return -1;
    case OPTION_SIGNING_KEY: params->signing_key = optarg; return -1;
    case OPTION_WEB: params->web = optarg; return -1;
    case OPTION_LEVEL: return parse_level(optarg, &params->log_level) ? -1 : usage_error("--log-level: unknown level", optarg);
    case OPTION_FORMAT: return parse_format(optarg, &params->log_format) ? -1 : usage_error("--log-format: unknown format", optarg);
    case OPTION_MEMORY:
        if (!parse_int(optarg, MIN_MEMORY_MB, MAX_MEMORY_MB, &megabytes))
            return usage_error("--memory: expected a number of megabytes, at least 128, found", optarg);
        params->memory_bytes = (size_t)megabytes << 20;
        return -1;
    case OPTION_IMPORT:
        params->imports = true;
        params->imports_now = optarg && !strcmp(optarg, "now");
        return !optarg || params->imports_now ? -1 : usage_error("--import: expected --import or --import=now, found", optarg);
    case OPTION_CHECK: *task = server_check; return -1;
    case OPTION_PLAN: *task = server_dump_plan; return -1;
    case OPTION_TEST_NOTIFY: *task = server_test_notify; return -1;
    case OPTION_VERSION: puts("plantcastd " PLANTCAST_VERSION LACKS); return GOOD;
    case OPTION_HELP: print_usage(stdout); return GOOD;
    default: return take_role_option(option, params);
    }
}

int main(int argc, char **argv)
{
    struct server_params params = { .address = "127.0.0.1",
                                    .port = 8080,
                                    .socket_fd = -1,
                                    .log_level = LOG_INFO,
                                    .log_format = service_is_journal(STDERR_FILENO) ? LOG_JOURNAL : LOG_TEXT,
                                    .access.quotas = quotas_default() };
    int (*task)(const struct server_params *params) = server_run;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        int code = take_option(option, &params, &task);
        if (code >= 0)
            return standard_output_end("plantcastd", code);
    }
    if (optind + 1 != argc)
        return usage_error("expected one plant file, found", optind == argc ? "none" : argv[optind + 1]);
    params.plant_path = argv[optind];
    if (task != server_run)
        return standard_output_end("plantcastd", task(&params));
    char handed[HANDED_ADDRESS_BYTES];
    params.socket_fd = service_take_socket();
    if (params.socket_fd >= 0 && handed_socket_find(params.socket_fd, handed, &params.port)) {
        params.address = handed;
    } else if (params.socket_fd != -1) {
        fprintf(stderr, "plantcastd: expected one listening TCP socket from the service manager\n");
        return FAILED;
    }
    const char *why;
    char machine[256] = "";
    if (!params.node && gethostname(machine, sizeof(machine) - 1) == 0)
        params.node = machine;
    if ((params.audit.syslog && !params.audit.path) || !params.audit.syslog_cert != !params.audit.syslog_key) {
        fputs("plantcastd: --audit-syslog needs --audit FILE; give both --audit-cert and --audit-key, or neither.\n", stderr);
        return FAILED;
    }
    if ((why = role_wrong(&params))) {
        fprintf(stderr, "plantcastd: %s.\n", why);
        return FAILED;
    }
    if (!access_allowed_at(&params.access, is_loopback(params.address), &why)) {
        fprintf(stderr, "plantcastd: --listen %s: %s.\n", params.address, why);
        return FAILED;
    }
    return server_run(&params);
}
