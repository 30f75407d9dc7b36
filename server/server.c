/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates the parts of the daemon, runs it, and destroys its parts again. */
#include "server.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "agent.h"
#include "base/clock.h"
#include "base/files/file_writer.h"
#include "base/metrics/counters.h"
#include "base/system/cgroup.h"
#include "base/system/confine.h"
#include "base/mem.h"
#include "corelink/node_id.h"
#include "encode/encoder.h"
#include "scene/far_sensors.h"
#include "scene/manifest.h"
#include "plant_runtime.h"
#include "provenance/signing_key.h"
#include "reload.h"
#include "helper_program.h"
#include "message/view_named.h"
#include "plant/models/model_check.h"
#include "notify/test_messages.h"
#include "plant/plant_folder.h"
#include "scene/scene_create.h"
#include "value/read_plan_text.h"
#include "value/series_check.h"
#include "version.h"

enum { TOKEN_FILE_BYTES = 1 << 24 };
enum { SETTLE_MS = 3000 }; /* time limit in milliseconds: the start waits this long for an import that is replacing files */

struct server {
    struct server_params params;
    struct log *log;
    struct counters *counters;
    struct workers *workers;
    struct plant_clock clock;
    struct plant_runtime_context context;
    struct plant_runtime *runtime;
    struct reload *reload;
    int history_lock;            /* descriptor that locks the history folder; 0 or less: none */
    struct node_id node_id;      /* unique identity of this core, even among cores of the same name (corelink/node_id.h) */
    struct lease_keeper *keeper; /* keeps the lease that decides which of two cores leads; NULL: this core is alone */
    bool follows, lost;          /* follows: another core polls the devices; lost: this core had the leadership lease and lost it */
    bool divided;                /* true: each child process that reads files gets a cgroup (resource limits) of its own */
    struct supervision *supervision;
    struct agent *agent;             /* answers load balancers; NULL: off */
    struct signing_key *signing_key; /* key that signs pictures; NULL: pictures are not signed */
    struct audit *audit;             /* writer of the audit trail; NULL: nothing is recorded */
    struct file_writer *file_writer;
    struct plant_import *import;     /* importer of plants; NULL: import is off */
    pthread_mutex_t wake_lock; /* locked while the render thread wakes the event loop, so that `net` is not destroyed meanwhile */
    struct net *net;
    char *web;        /* folder of the web client's files; NULL: no page is served */
    int64_t begun_ns; /* monotonic time when the daemon began to start */
};

/* the event loop on which signals act; global, because a signal handler gets no argument for it */
static struct net *_Atomic to_stop;
static _Atomic bool preparing, told_to_end;

/* Handles signals before the event loop runs. Without a handler, a daemon that is process 1 of a container would ignore them. */
static void on_early_signal(int number)
{
    atomic_store(&told_to_end, true);
    if (atomic_load(&preparing))
        return;
    if (getpid() == 1)
        _exit(0);
    signal(number, SIG_DFL);
    raise(number);
}

/* SIGINT and SIGTERM end the daemon, SIGUSR1 drains it. SIGHUP makes the event loop reload the plant and read the files of
   tokens and certificate again, which it otherwise checks once a second. */
static void on_signal(int number)
{
    int cause = errno;
    struct net *net = atomic_load(&to_stop);
    if (net)
        (number == SIGHUP ? net_check_credentials : number == SIGUSR1 ? net_drain : net_stop)(net);
    errno = cause;
}

static void on_pictures(void *arg)
{
    struct server *server = arg;
    pthread_mutex_lock(&server->wake_lock);
    if (server->net)
        net_wake(server->net);
    pthread_mutex_unlock(&server->wake_lock);
}

/* --- files of the plant -------------------------------------------------------------------------------------------------------- */

static struct plant *load_plant(const char *path)
{
    struct diag diag = { 0 };
    struct plant *plant = plant_load(path, &diag);
    diag_print(&diag, stderr);
    if (!plant)
        fprintf(stderr, "plantcastd: %s: %d error%s\n", path, diag.errors, diag.errors == 1 ? "" : "s");
    diag_finish(&diag);
    return plant;
}

/* Finds the web client's files: in the installation, next to a built program, or in the source tree. */
static char *find_web(const char *given)
{
    static const char *const places[] = { "../share/plantcast/web", "web", "../clients/web", "../../../clients/web" };
    char program[PATH_MAX];
    if (given)
        return mem_strdup(given);
    ssize_t n = readlink("/proc/self/exe", program, sizeof(program) - 1);
    program[n > 0 ? n : 0] = 0;
    char *slash = strrchr(program, '/');
    if (!slash)
        return NULL;
    *slash = 0;
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++) {
        char *folder = mem_printf("%s/%s", program, places[i]), *index = mem_printf("%s/index.html", folder);
        bool found = access(index, R_OK) == 0;
        mem_free(index);
        if (found)
            return folder;
        mem_free(folder);
    }
    return NULL;
}

/* --- life cycle ---------------------------------------------------------------------------------------------------------------- */

/* Returns the codecs that work here: JPEG and PNG always, H.264 if its encoder works. */
static unsigned find_codecs(const struct server *server)
{
    const char *library = plant_runtime_h264_library(&server->params);
    unsigned codecs = 1u << WIRE_CODEC_JPEG | 1u << WIRE_CODEC_PNG;
    if (strcmp(library, "off") != 0 && encoder_works(server->log, "h264", library))
        codecs |= 1u << WIRE_CODEC_H264;
    else if (strcmp(library, "off") != 0)
        log_warn(server->log, "H.264 encoder %s does not work on this machine: clients get JPEG", library);
    return codecs;
}

/* Requests a reload. Called in the event loop, which starts only after server->reload was created. */
static uint64_t ask_reload(void *arg, const char *who)
{
    return reload_ask(((struct server *)arg)->reload, who);
}

static void follow_reload(void *arg, const struct core_follow *follow)
{
    reload_follow(((struct server *)arg)->reload, follow);
}

static void match_core(void *arg, const struct core_files *files, const char *configuration)
{
    reload_match(((struct server *)arg)->reload, files, configuration);
}

static void agree_on_tags(void *arg, const char *tags_hash)
{
    reload_agree(((struct server *)arg)->reload, tags_hash);
}

static void ask_save(void *arg, struct tag_save *save)
{
    reload_save(((struct server *)arg)->reload, save);
}

static void on_import_ordered(void *arg, const char *who)
{
    reload_import(((struct server *)arg)->reload, who);
}

static void end_leading(void *arg)
{
    reload_end_leading(((struct server *)arg)->reload);
}

static void on_tick(void *arg, const struct net_status *status)
{
    struct server *server = arg;
    supervision_tick(server->supervision, status);
    if (server->agent)
        agent_tell(server->agent, &(struct agent_state){ status->busy_percent, status->has_core, status->drains });
}

static bool start_net(struct server *server)
{
    struct net_params params = {
        .log = server->log,
        .plant = server->runtime->services,
        .counters = server->counters,
        .audit = server->audit,
        .file_writer = server->file_writer,
        .address = server->params.address,
        .port = server->params.port,
        .socket_fd = server->params.socket_fd,
        .begun_ns = server->begun_ns,
        .access = server->params.access,
        .signing_key = server->signing_key,
        .codecs = find_codecs(server),
        .web_folder = server->web,
        .version = PLANTCAST_VERSION,
        .node = server->params.role == SERVER_RENDER ? server->params.node : NULL,
        .is_core = server->params.role == SERVER_CORE,
        .node_name = server->params.node,
        .keeper = server->keeper,
        .end_leading = end_leading,
        .reload = ask_reload,
        .follow = server->params.role == SERVER_RENDER || server->keeper ? follow_reload : NULL,
        .match = server->params.role == SERVER_RENDER || server->keeper ? match_core : NULL,
        .agree = server->params.role == SERVER_RENDER || server->keeper ? agree_on_tags : NULL,
        .save = server->params.role == SERVER_RENDER ? NULL : ask_save,
        .import = server->import,
        .import_ordered = on_import_ordered,
        .tick = on_tick,
        .reload_arg = server,
    };
    if (!server->web)
        log_warn(server->log, "the files of the web page were not found next to the program; give their folder with --web");
    struct net *net = net_create(&params);
    pthread_mutex_lock(&server->wake_lock);
    server->net = net;
    pthread_mutex_unlock(&server->wake_lock);
    return net && (server->reload = reload_create(&server->context, &server->runtime, net, server->supervision, server->import));
}

static bool start_import(struct server *server)
{
    char lacks[CONFINE_LACKS_BYTES];
    if (!server->params.imports)
        return true;
    if (confine_lacks(lacks))
        log_warn(server->log, "--import: this kernel has %s", lacks);
    if (!server->divided)
        log_info(server->log, "--import: memory limits apply to each process that reads files alone; a limit for all together needs a "
                              "cgroup delegated by systemd (Delegate=memory pids)");
    server->import = plant_import_create(server->params.plant_path);
    if (!server->import)
        log_err(server->log, "%s: the folder `exports` next to this plant file cannot be created: %s", server->params.plant_path,
                strerror(errno));
    return server->import != NULL;
}

/* Sets the time zone of the process to the plant's, for clocks in pictures. Changes the environment, so call it while there is
   only one thread. */
static void set_time_zone(const struct plant *plant)
{
    setenv("TZ", plant->time_zone, 1);
    tzset();
}

/* Logs each line of the findings as a log entry of its own. */
static void log_findings(struct log *log, const struct diag *diag)
{
    char *lines = NULL;
    size_t length;
    FILE *out = open_memstream(&lines, &length);
    if (!out)
        return;
    diag_print(diag, out);
    fclose(out);
    for (char *at = lines, *line; (line = strsep(&at, "\n"));)
        if (*line)
            log_at(log, strstr(line, ": error: ") ? LOG_ERROR : LOG_WARN, "%s", line);
    free(lines);
}

static bool is_told_to_end(void *arg)
{
    (void)arg;
    return atomic_load(&told_to_end);
}

/* Prepares the plant if the prepared files belong to another plant file or other models, because the plant was imported but not
   prepared since. Does nothing if the folder has no prepared files at all, because it may be the wrong folder. */
static bool prepare(struct server *server)
{
    struct diag diag = { 0 };
    struct plant *plant = plant_load(server->params.plant_path, &diag);
    char *folder = plant ? plant_runtime_prepared_folder(&server->params, plant) : NULL, *why = NULL;
    bool good = folder && access(folder, F_OK) == 0;
    if (good) {
        log_warn(server->log, "%s: prepared files are missing or outdated: running plantcast-prep before the plant is served",
                 server->params.plant_path);
        supervision_starting(server->supervision, "preparing the plant");
        atomic_store(&preparing, true);
        why = helper_prepare(&(struct helper_params){ .stop = is_told_to_end, .log = server->log, .notifies = true }, folder,
                             server->params.plant_path, &server->params.access.quotas);
        atomic_store(&preparing, false);
        good = !why && !atomic_load(&told_to_end);
        if (atomic_load(&told_to_end))
            log_event(server->log, LOG_INFO, EVENT_STOPPING, "stopping while plantcast-prep prepares the plant; the next start continues");
        else if (why)
            log_err(server->log, "%s: plantcast-prep could not prepare the plant: %s", server->params.plant_path, why);
    }
    mem_free(why);
    mem_free(folder);
    plant_destroy(&plant);
    diag_finish(&diag);
    return good;
}

/* Waits until plant file, models and tag list belong to one revision: until no import is replacing them. Returns false on failure. */
static bool settle_folder(struct server *server)
{
    const char *finished = NULL;
    char *folder = plant_folder_of(server->params.plant_path), *why = NULL;
    bool settled =
        plant_folder_settle(&(struct plant_folder_params){ .folder = folder, .wait_ms = SETTLE_MS, .finished = &finished }, &why);
    if (finished)
        log_warn(server->log, "%s: completed %s, which had been interrupted", server->params.plant_path, finished);
    if (!settled)
        log_err(server->log, "%s: an import was interrupted and can neither be completed nor undone: %s", server->params.plant_path, why);
    mem_free(why);
    mem_free(folder);
    return settled;
}

/* Reads the plant, and prints the errors and warnings found. Returns false on errors. */
static bool read_plant(struct server *server)
{
    struct diag diag = { 0 };
    if (!settle_folder(server))
        return false;
    server->runtime = plant_runtime_read(&server->context, &diag);
    if (!server->runtime && !diag.errors && prepare(server)) {
        diag_finish(&diag);
        diag = (struct diag){ 0 };
        server->runtime = plant_runtime_read(&server->context, &diag);
    }
    if (log_is_text(server->log))
        diag_print(&diag, stderr);
    else
        log_findings(server->log, &diag);
    if (diag.errors && log_is_text(server->log))
        fprintf(stderr, "plantcastd: %s: %d error%s\n", server->params.plant_path, diag.errors, diag.errors == 1 ? "" : "s");
    diag_finish(&diag);
    return server->runtime != NULL;
}

static void record(const struct server *server, const char *event)
{
    char *what = mem_printf("plantcastd " PLANTCAST_VERSION ", configuration %s", server->runtime->plant->files.hash);
    audit_say(server->audit, &(struct audit_entry){ .event = event, .result = "done", .what = what });
    mem_free(what);
}

static bool start_audit(struct server *server)
{
    struct audit_params params = server->params.audit;
    if (!params.path)
        return true;
    params.log = server->log;
    params.counters = server->counters;
    server->context.audit = server->audit = audit_start(&params);
    if (server->audit)
        record(server, "start");
    return server->audit != NULL;
}

static bool load_signing_key(struct server *server)
{
    char why[SIGNING_KEY_WHY_BYTES], id[SIGNING_KEY_ID_BYTES];
    const char *path = server->params.signing_key;
    if (!path)
        return true;
    if (!(server->signing_key = signing_key_load(path, why))) {
        log_err(server->log, "--signing-key: %s", why);
        return false;
    }
    signing_key_id(server->signing_key, id);
    log_info(server->log, "pictures are signed with key %s", id);
    return true;
}

/* Called by the lease keeper's thread when this core becomes the leader of the pair. */
static void on_won(void *arg)
{
    struct server *server = arg;
    pthread_mutex_lock(&server->wake_lock);
    if (server->net)
        reload_lead(server->reload);
    pthread_mutex_unlock(&server->wake_lock);
}

/* Called by the lease keeper's thread when this core has lost the lease: ends the daemon. If that takes too long, the kernel
   kills the process. */
static void on_lost(void *arg)
{
    struct server *server = arg;
    pthread_mutex_lock(&server->wake_lock);
    server->lost = true;
    if (server->net)
        net_stop(server->net);
    pthread_mutex_unlock(&server->wake_lock);
}

static bool take_seat(struct server *server, char name[LEASE_NODE_BYTES])
{
    char *why = node_id_take(&server->node_id, server->runtime->services.history_folder);
    if (!why && !lease_name(name, server->params.node, server->node_id.id))
        why = mem_printf("--node: the name %s is longer than %d bytes", server->params.node,
                         LEASE_NODE_BYTES - 2 - (int)strlen(server->node_id.id));
    if (why)
        log_err(server->log, "%s", why);
    bool good = !why;
    mem_free(why);
    return good;
}

/* Creates the lease keeper of a core in a pair. Each of the two cores starts as a follower. Returns false on failure. */
static bool make_keeper(struct server *server)
{
    const struct plant *plant = server->runtime->plant;
    char name[LEASE_NODE_BYTES];
    if (server->params.role != SERVER_CORE || !server->params.core_count)
        return true;
    if (!plant->history.postgres.url || plant->history.off) {
        log_err(server->log,
                "%s: two cores (--role core with --core) require `postgres` in `history`, because PostgreSQL decides which core leads",
                server->params.plant_path);
        return false;
    }
    if (!take_seat(server, name))
        return false;
    server->follows = true;
    char *maintenance_path = mem_printf("%s/" LEASE_MAINTENANCE_FILE, server->runtime->services.history_folder);
    const struct lease_keeper_params params = {
        .log = server->log,
        .counters = server->counters,
        .postgres = &plant->history.postgres,
        .plant = plant->name,
        .node = name,
        .maintenance_path = maintenance_path,
        .won = on_won,
        .lost = on_lost,
        .arg = server,
    };
    server->context.keeper = server->keeper = lease_keeper_create(&params);
    mem_free(maintenance_path);
    return server->keeper;
}

/* Locks the history folder until this process ends, because two daemons would overwrite each other's lists, and record all readings
   and alarms twice. Waits for HISTORY_WAIT_MS, for a daemon that is just ending; SIGTERM kills the process during this wait. If the
   folder cannot be opened or locked at all, the daemon starts nevertheless, and whatever writes to the folder logs why. */
static bool lock_history_folder(struct server *server)
{
    enum { HISTORY_WAIT_MS = 5000, LOOK_MS = 50 };
    const char *folder = server->runtime->services.history_folder;
    if (!folder)
        return true;
    mkdir(folder, 0777);
    server->history_lock = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (server->history_lock < 0)
        return true;
    bool locked = flock(server->history_lock, LOCK_EX | LOCK_NB) == 0, used = !locked && errno == EWOULDBLOCK;
    for (int ms = 0; used && ms < HISTORY_WAIT_MS; ms += LOOK_MS) {
        nanosleep(&(struct timespec){ .tv_nsec = LOOK_MS * NS_PER_MS }, NULL);
        used = flock(server->history_lock, LOCK_EX | LOCK_NB) != 0;
    }
    if (used)
        log_err(server->log,
                "%s: another daemon records in this history folder: stop that daemon, or give this one its own folder with "
                "--history",
                folder);
    return !used;
}

static bool start_agent(struct server *server)
{
    const struct server_params *params = &server->params;
    return !params->agent_port || (server->agent = agent_start(server->log, params->address, params->agent_port));
}

static bool server_start(struct server *server)
{
    server->counters = counters_create();
    server->supervision = supervision_create(server->log, server->counters);
    supervision_starting(server->supervision, "reading the plant");
    server->context = (struct plant_runtime_context){ .params = &server->params,
                                                      .log = server->log,
                                                      .counters = server->counters,
                                                      .clock = &server->clock,
                                                      .notify = on_pictures,
                                                      .notify_arg = server,
                                                      .follows = &server->follows };
    if (!read_plant(server))
        return false;
    log_set_plant(server->log, server->runtime->plant->name);
    set_time_zone(server->runtime->plant);
    if (server->params.socket_fd < 0 && !net_port_free(server->log, server->params.address, server->params.port))
        return false;
    if (!net_access_good(server->log, &server->params.access) || !load_signing_key(server))
        return false;
    /* locks before the audit trail is opened: a refused second daemon must not add lines to the trail of the running one */
    if (!lock_history_folder(server) || !start_audit(server))
        return false;
    server->context.workers = server->workers = workers_create(0);
    if (!(server->context.file_writer = server->file_writer = file_writer_start(server->log, on_pictures, server)))
        return false;
    server->web = find_web(server->params.web);
    reload_count(server->counters, server->runtime->plant->files.hash, true);
    supervision_starting(server->supervision, "drawing the first picture");
    return make_keeper(server) && plant_runtime_start_recording(server->runtime, NULL) && plant_runtime_start_sources(server->runtime) &&
           plant_runtime_start_render_service(server->runtime, NULL, 0) && start_import(server) && start_agent(server) &&
           start_net(server) && (!server->keeper || lease_keeper_start(server->keeper));
}

/* Destroys the parts of the daemon, consumers before producers. */
static void server_finish(struct server *server)
{
    pthread_mutex_lock(&server->wake_lock);
    struct net *net = server->net;
    server->net = NULL;
    pthread_mutex_unlock(&server->wake_lock);
    reload_destroy(&server->reload);
    net_destroy(&net);
    file_writer_stop(server->file_writer);
    agent_stop(&server->agent);
    if (server->audit)
        record(server, "stop");
    audit_stop(&server->audit);
    plant_import_destroy(&server->import);
    plant_runtime_destroy(&server->runtime);
    file_writer_destroy(&server->file_writer);
    lease_keeper_destroy(&server->keeper); /* gives the leadership lease back, now that nothing polls devices any more */
    node_id_release(&server->node_id);
    if (server->history_lock > 0)
        close(server->history_lock);
    workers_destroy(&server->workers);
    supervision_destroy(&server->supervision);
    counters_destroy(&server->counters);
    signing_key_destroy(&server->signing_key);
    mem_free(server->web);
    pthread_mutex_destroy(&server->wake_lock);
    log_destroy(&server->log);
}

static void handle_early_signals(void)
{
    struct sigaction action = { .sa_handler = on_early_signal };
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

static void handle_signals(struct net *net)
{
    struct sigaction action = { .sa_handler = on_signal };
    sigemptyset(&action.sa_mask);
    atomic_store(&to_stop, net);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    sigaction(SIGUSR1, &action, NULL);
}

static void say_ready(const struct server *server)
{
    bool six = strchr(server->params.address, ':') != NULL;
    char *url = mem_printf("http%s://%s%s%s:%d/", server->params.access.tls_cert_path ? "s" : "", six ? "[" : "", server->params.address,
                           six ? "]" : "", net_port(server->net));
    if (log_is_text(server->log)) {
        printf("plantcastd: ready %s\n", url);
        fflush(stdout);
    } else {
        log_event(server->log, LOG_INFO, EVENT_READY, "ready %s", url);
    }
    mem_free(url);
}

int server_run(const struct server_params *params)
{
    struct server server = { .params = *params, .log = log_create(params->log_level), .begun_ns = clock_mono_ns() };
    log_set_format(server.log, params->log_format, NULL);
    pthread_mutex_init(&server.wake_lock, NULL);
    server.divided = cgroup_divide();
    confine_hide_memory();
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); /* ignores SIGXFSZ, so that a file that reaches its size limit gives a write error, like a full disk */
    handle_early_signals();
    bool good = server_start(&server);
    if (good) {
        handle_signals(server.net);
        say_ready(&server);
        if (params->imports_now && plant_import_order(server.import, &(struct import_order){ .models = true }))
            reload_import(server.reload, "the command line");
        net_run(server.net);
        atomic_store(&to_stop, NULL);
        log_event(server.log, LOG_INFO, EVENT_STOPPING, "stopping");
        supervision_stopping(server.supervision);
    }
    server_finish(&server);
    return (good || atomic_load(&told_to_end)) && !server.lost ? 0 : 1;
}

static void print_wrong_view(void *arg, const struct named_view *view, const char *wrong)
{
    printf("%s:%d: warning: view %s: %s\n", (const char *)arg, view->line, view->id, wrong);
}

/* Prints which textures and extensions of the plant's models plantcast-prep found that are not drawn. */
static void print_left_out(struct log *log, const struct plant *plant, const char *folder)
{
    enum { SHOWN = 20 };
    struct manifest manifest;
    if (!manifest_read(log, folder, &manifest))
        return;
    for (size_t a = 0; a < plant->asset_count; a++) {
        const struct plant_asset *asset = &plant->assets[a];
        const struct manifest_entry *entry = manifest_find(&manifest, asset->id);
        size_t count = entry ? entry->left_out_count : 0;
        for (size_t i = 0; i < count && i < SHOWN; i++)
            printf("%s:%d: warning: model %s: left out: %s\n", plant->files.path, asset->line, asset->model, entry->left_out[i]);
        if (count > SHOWN)
            printf("%s:%d: warning: model %s: %zu more glTF textures or extensions are not drawn (not listed here)\n", plant->files.path,
                   asset->line, asset->model, count - SHOWN);
    }
    manifest_finish(&manifest);
}

/* Returns whether every line of the file of tokens is accepted; net_access_good() logs the refused lines. */
static bool token_lines_good(const char *path)
{
    struct token_holder holder;
    const char *why;
    size_t bytes;
    bool good = true;
    char *text = text_read_file(path, TOKEN_FILE_BYTES, &bytes), *at = text;
    for (char *line; at && (line = strsep(&at, "\n"));)
        good &= tokens_parse_line(line, &holder, &why) >= 0;
    mem_free(text);
    return good;
}

/* Reads the files named by options such as --tokens and --openid. Logs each fault and returns false if there was any. */
static bool check_option_files(const struct server_params *params)
{
    struct server server = { .params = *params, .log = log_create(LOG_WARN) };
    struct access_params *access = &server.params.access;
    bool paired = !access->tls_cert_path == !access->tls_key_path;
    if (!paired) {
        log_err(server.log, "give both --tls-cert and --tls-key, or neither");
        access->tls_cert_path = NULL;
    }
    bool access_good = net_access_good(server.log, access), key_good = load_signing_key(&server);
    bool lines_good = !access->tokens_path || token_lines_good(access->tokens_path);
    signing_key_destroy(&server.signing_key);
    log_destroy(&server.log);
    return paired && access_good && key_good && lines_good;
}

static int check_prepared(const struct server_params *params, const struct plant *plant)
{
    char *folder = plant_runtime_prepared_folder(params, plant), *manifest = mem_printf("%s/manifest.json", folder);
    /* looks for the manifest, which plantcast-prep writes last: the folder alone also exists during the first preparation */
    bool exists = access(manifest, F_OK) == 0;
    struct log *log = log_create(LOG_WARN);
    if (exists)
        print_left_out(log, plant, folder);
    else
        printf("%s: the plant is not prepared yet (no prepared files in %s), so some things were not checked: glTF textures and "
               "extensions that cannot be drawn, sensors far from their surface, and views. Run plantcast-prep, then check again\n",
               params->plant_path, folder);
    mem_free(manifest);
    mem_free(folder);
    if (!exists) {
        log_destroy(&log);
        return 0;
    }
    struct scene *scene = plant_runtime_open_scene(log, params, plant);
    int status = scene ? 0 : 1;
    for (size_t i = 0; scene && i < scene->asset_count; i++)
        /* counts a missing asset as an error; its reason was logged when the scene was opened */
        status |= scene->assets[i].missing != NULL;
    if (scene) {
        size_t count;
        struct far_sensor *far = far_sensors_find(scene, &count);
        for (size_t i = 0; i < count; i++) {
            const struct plant_tag *tag = &plant->tags[far[i].sensor->tag];
            printf("%s:%d: warning: sensor %s is %.3f m from the surface of %s (at most %.3f m is expected)\n", plant->files.tags_path,
                   tag->line, tag->name, far[i].sensor->surface_distance_m, far[i].asset->plant->id, far[i].limit_m);
        }
        mem_free(far);
        view_named_check_all(scene, print_wrong_view, (void *)params->plant_path);
    }
    scene_destroy(&scene);
    log_destroy(&log);
    return status;
}

/* Counts the tags that are sensors. If there are none, only warns, because users may place sensors on the page. */
static size_t count_sensors(const struct plant *plant, struct diag *diag)
{
    size_t count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        count += plant->tags[i].group >= 0 && plant->tags[i].asset >= 0;
    if (count == 0 && plant->tag_count > 0)
        diag_warning(diag, plant->files.tags_path, 0, 0,
                     "none of the %zu tags has Group, Asset and a place, so there is no sensor, and surfaces show no values",
                     plant->tag_count);
    return count;
}

int server_check(const struct server_params *params)
{
    struct diag diag = { 0 };
    struct plant *plant = plant_load(params->plant_path, &diag);
    size_t sensors = 0;
    char *folder = plant_folder_of(params->plant_path), lacks[CONFINE_LACKS_BYTES];
    if (params->imports && confine_lacks(lacks))
        printf("%s: warning: --import: this kernel has %s\n", params->plant_path, lacks);
    if (plant_folder_unsettled(folder))
        diag_warning(
            &diag, params->plant_path, 0, 0,
            "an import was killed after it had replaced some of the plant's files; the next start of the daemon completes the import");
    mem_free(folder);
    if (plant) {
        models_check(plant, 0, &diag, stdout);
        series_check(plant, &diag);
        sensors = count_sensors(plant, &diag);
    }
    fflush(stdout);
    diag_print(&diag, stderr);
    int status = !plant || diag.errors || check_prepared(params, plant) ? 1 : 0;
    if (!check_option_files(params))
        status = 1;
    if (!plant)
        fprintf(stderr, "plantcastd: %s: %d error%s\n", params->plant_path, diag.errors, diag.errors == 1 ? "" : "s");
    else
        printf("%s: %zu asset%s, %zu group%s, %zu source%s, %zu tag%s, %zu of them sensors: %s", params->plant_path, plant->asset_count,
               plant->asset_count == 1 ? "" : "s", plant->group_count, plant->group_count == 1 ? "" : "s", plant->source_count,
               plant->source_count == 1 ? "" : "s", plant->tag_count, plant->tag_count == 1 ? "" : "s", sensors,
               status ? "not good" : "good");
    if (plant && diag.errors + diag.warnings > 0)
        printf(" (%d error%s, %d warning%s)", diag.errors, diag.errors == 1 ? "" : "s", diag.warnings, diag.warnings == 1 ? "" : "s");
    if (plant)
        printf("\n");
    diag_finish(&diag);
    plant_destroy(&plant);
    return status;
}

int server_dump_plan(const struct server_params *params)
{
    struct text text = { 0 };
    struct plant *plant = load_plant(params->plant_path);
    if (!plant)
        return 1;
    for (size_t i = 0; i < plant->source_count; i++)
        read_plan_text(&text, plant, (int)i);
    fputs(text.at ? text.at : "no sources\n", stdout);
    text_finish(&text);
    plant_destroy(&plant);
    return 0;
}

int server_test_notify(const struct server_params *params)
{
    struct plant *plant = load_plant(params->plant_path);
    if (!plant)
        return 1;
    struct log *log = log_create(LOG_WARN);
    int failed = plant->notify ? test_messages_send(log, plant, stdout) : 1;
    if (!plant->notify)
        fprintf(stderr, "plantcastd: %s: the plant file has no `notify`, so there is nobody to send a test message to\n",
                params->plant_path);
    log_destroy(&log);
    plant_destroy(&plant);
    return failed != 0;
}
