/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The event loop: its libwebsockets context, its periodic work (ticks) and its shutdown. */
#include "net/net.h"

#include <arpa/inet.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/http/site.h"
#include "corelink/core_identity.h"
#include "net/core_end.h"
#include "net/renderers.h"
#include "net/tls.h"
#include "net/connection.h"
#include "net/handed_socket.h"
#include "net/net_impl.h"
#include "net/wall_displays.h"
#include "session/view/resume.h"

/* interval at which the event loop checks whether users' actions have reached the disk, while at least one action has not */
static const int64_t SETTLE_NS = 5 * NS_PER_MS;
/* longest wait at shutdown for users' actions to reach the disk; long enough, because settling_end() gives each action at most a second */
static const int64_t SETTLED_NS = 1500 * NS_PER_MS;
/* TICK_NS: interval between two runs (ticks) of the sessions' periodic work; REST_NS: the same while no session has timed work
   within the next second */
static const int64_t TICK_NS = 100 * NS_PER_MS, REST_NS = NS_PER_S;
static const int64_t GOODBYE_NS = 500 * NS_PER_MS;       /* how long shutdown waits for close frames and answers to be sent */
static const int64_t RECORD_INTERVAL_NS = 60 * NS_PER_S; /* minimum time between two audit entries about throttled addresses */
static const int64_t FILE_CHECK_INTERVAL_NS = NS_PER_S;  /* interval between checks of the token and certificate files */
enum { SPARE_FILES = 256 }; /* file descriptors reserved for other uses than connections: models, data sources, the database and so on */

static const struct lws_protocols protocols[] = {
    { .name = "http", .callback = http_callback, .per_session_data_size = sizeof(void *) },
    { .name = WIRE_SUBPROTOCOL, .callback = stream_callback, .per_session_data_size = sizeof(void *), .rx_buffer_size = 4096 },
    { .name = CORE_SUBPROTOCOL, .callback = renderer_callback, .per_session_data_size = sizeof(void *), .rx_buffer_size = 4096 },
    { .name = HANDED_PROTOCOL, .callback = handed_socket_callback },
    { 0 },
};

static const lws_retry_bo_t idle_policy = { .secs_since_valid_ping = 20, .secs_since_valid_hangup = 40 };

/* Log to which libwebsockets' messages go. One variable suffices: libwebsockets has one log function per process, and a process
   has one event loop. */
static struct log *_Atomic lws_log_to;

static void lws_log_line(int level, const char *line)
{
    struct log *log = atomic_load(&lws_log_to);
    if (log)
        log_at(log, level == LLL_ERR ? LOG_WARN : LOG_DEBUG, "lws: %.*s", (int)strcspn(line, "\n"), line);
}

/* --- periodic work ---------------------------------------------------------------------------------------------------- */

/* Checks whether the files of tokens and certificate have changed. A changed file is read only once it has stopped changing;
   until then the check is repeated. */
static void look_at_files(struct net *net, int64_t now_ns)
{
    struct server_context *server = &net->server;
    bool asked = atomic_exchange(&net->look, false);
    if (!asked && now_ns - server->logins.looked_ns < FILE_CHECK_INTERVAL_NS)
        return;
    server->logins.looked_ns = now_ns;
    if (asked && server->params.reload)
        server->params.reload(server->params.reload_arg, "signal");
    if (server->tls)
        tls_look(server->tls);
    if (server->logins.tokens) {
        tokens_look(server->logins.tokens);
        /* also closes sessions of signed-in users who lost their rights. Without a token file no check is needed, because
           sign-in with OpenID Connect requires a token file */
        streams_check_tokens(server, clock_utc_ns());
    }
}

static void record_sum(const struct server_context *server, int64_t *count, const char *what)
{
    if (!*count)
        return;
    char *text = mem_printf("%lld %s", (long long)*count, what);
    audit_say(server->params.audit, &(struct audit_entry){ .event = "login", .result = "refused", .what = text });
    mem_free(text);
    *count = 0;
}

/* Adds a line to the audit trail, at most once a minute, with the number of tokens and log-in answers left unchecked because
   their address is throttled. */
static void record_held(struct server_context *server, int64_t now_ns)
{
    if ((!server->logins.held && !server->logins.unasked) || now_ns - server->logins.held_ns < RECORD_INTERVAL_NS)
        return;
    record_sum(server, &server->logins.held, "tokens from rate-limited addresses were refused unchecked");
    record_sum(server, &server->logins.unasked,
               "answers of the identity provider were rejected: they belonged to no sign-in, could not be checked, or were errors");
    server->logins.held_ns = now_ns;
}

/* Reads the processor load, and updates which displays are connected, once a second. */
static void look_around(struct net *net, int64_t now_ns)
{
    char stat[512] = "";
    if (now_ns - net->cpu_ns < NS_PER_S)
        return;
    FILE *file = fopen("/proc/stat", "r");
    size_t count = file ? fread(stat, 1, sizeof(stat) - 1, file) : 0;
    stat[count] = 0;
    if (file)
        fclose(file);
    net->cpu_ns = now_ns;
    wall_displays_count(&net->server, now_ns);
    net->server.session_context.load.cpu_used = 1 - cpu_meter_free(&net->cpu, stat);
}

/* Returns this core's role in a pair of cores, as status text for the service manager (static); NULL: there is no pair. */
static const char *core_standing(const struct server_context *server)
{
    struct lease_keeper *keeper = server->params.keeper;
    if (!keeper)
        return NULL;
    if (!core_end_leads(server))
        return server->session_context.core.up ? "standby: follows the core that leads" : "standby: not connected to a core that leads";
    return lease_keeper_is_alone(keeper) ? "leads alone (maintenance): no other core takes over" : renderers_standby_texts(server)->status;
}

static bool has_core(const struct server_context *server)
{
    return !server->params.plant.core_link || server->session_context.core.up;
}

static void say_status(const struct server_context *server)
{
    if (server->params.tick)
        server->params.tick(server->params.reload_arg,
                            &(struct net_status){
                                .render_service = server->params.plant.render_service,
                                .sessions = (size_t)server->streams.count,
                                .busy_percent = admission_busy_percent(&server->room.admission),
                                .has_core = has_core(server),
                                .core = core_standing(server),
                                .drains = server->life.drain_ns != 0,
                                .certificate_ends_s = server->tls ? tls_ends_s(server->tls) : 0,
                            });
}

/* Measures how long the daemon took to start. At shutdown, the daemon tells clients to reconnect after that time. */
static void time_start(struct server_context *server, int64_t now_ns)
{
    if (!server->life.start_s && render_service_ready(server->params.plant.render_service))
        server->life.start_s = (int)((now_ns - server->params.begun_ns) / NS_PER_S) + 1;
}

static void tick(struct net *net, int64_t now_ns)
{
    time_start(&net->server, now_ns);
    if (atomic_load(&net->drain) && !net->server.life.drain_ns) {
        net->server.life.drain_ns = now_ns;
        log_info(net->server.params.log, "drain (SIGUSR1): moving %d sessions to other daemons within 12 s", net->server.streams.count);
    }
    look_at_files(net, now_ns);
    look_around(net, now_ns);
    renderers_describe_standby(&net->server);
    record_held(&net->server, now_ns);
    admission_on_tick(&net->server.room.admission, now_ns);
    counter_set(net->server.counters.busy, admission_busy_percent(&net->server.room.admission));
    counter_set(net->server.counters.connections, net->server.room.connections);
    counter_set(net->server.counters.logins_slowed, login_throttle_slowed(net->server.logins.throttle, now_ns));
    if (net->server.history_loader)
        net->server.session_context.readings.history_first_us = history_loader_first_us(net->server.history_loader);
    if (net_check_links(&net->server))
        streams_on_readings(&net->server, false, true);
    if (core_loss_on_tick(&net->server.life.core_loss, has_core(&net->server), now_ns))
        log_warn(net->server.params.log,
                 "no connection to a core for %d s: moving sessions to the other daemons that the load balancer reports as available",
                 (int)((now_ns - net->server.life.core_loss.lost_ns) / NS_PER_S));
    streams_on_tick(&net->server);
    http_on_tick(&net->server, now_ns);
    render_service_wake(net->server.params.plant.render_service);
    say_status(&net->server);
    net->ticked_ns = now_ns;
}

/* libwebsockets runs due timers before it waits. A timer that becomes due between these two steps would not end the wait, so this handler
   wakes libwebsockets immediately. */
static void on_timer(lws_sorted_usec_list_t *sul)
{
    struct net *net = lws_container_of(sul, struct net, timer);
    net->timer_ns = 0;
    lws_cancel_service(net->server.lws);
}

static void set_timer(struct net *net, int64_t at_ns)
{
    int64_t now_ns = clock_mono_ns();
    if (at_ns == net->timer_ns)
        return;
    net->timer_ns = at_ns;
    lws_sul_schedule(net->server.lws, 0, &net->timer, on_timer, at_ns > now_ns ? (at_ns - now_ns) / 1000 + 1 : 1);
}

bool net_settle_answers(struct net *net)
{
    struct server_context *server = &net->server;
    struct kept_answers *answers = &server->kept_answers;
    /* true: at least one queued change was written to disk, so views, notes or other lists that are sent to clients may have
       changed */
    bool changed = file_writer_collect(server->params.file_writer);
    if (answers->waiting) {
        answers->waiting = false;
        session_settle_gone(answers);
        streams_settle(server);
        renderers_settle(server);
        http_settle(server);
    }
    if (changed) {
        streams_on_alarms(server);
        renderers_on_change(server);
    }
    return answers->waiting;
}

/* Does the event loop's work that is due now, and schedules the next wake-up. libwebsockets waits in whole milliseconds,
   rounded down, and busy-polls in the last one; so work due within a millisecond is done now. */
static void do_what_is_due(struct net *net)
{
    int64_t soon_ns = clock_mono_ns() + NS_PER_MS, readings_ns = net_update_readings(net, soon_ns);
    if (soon_ns - net->ticked_ns >= (net->server.streams.restless ? TICK_NS : REST_NS))
        tick(net, soon_ns);
    int64_t tick_ns = net->ticked_ns + (net->server.streams.restless ? TICK_NS : REST_NS);
    int64_t settle_ns = net_settle_answers(net) ? soon_ns + SETTLE_NS : INT64_MAX;
    int64_t next_ns = tick_ns < readings_ns ? tick_ns : readings_ns;
    set_timer(net, settle_ns < next_ns ? settle_ns : next_ns);
}

static void collect_picks(struct server_context *server)
{
    for (struct pick_answer *answer = render_service_collect_picks(server->params.plant.render_service), *next; answer; answer = next) {
        next = answer->next;
        if (stream_owns(server, answer->query.client))
            stream_on_pick(server, answer);
        else
            http_on_pick(server, answer);
        mem_free(answer);
    }
}

static void collect_signed(struct server_context *server)
{
    struct signing *signing = server->signing.signer ? picture_signer_collect(server->signing.signer) : NULL;
    for (struct signing *next; signing; signing = next) {
        next = signing->next;
        if (stream_owns(server, signing->encoded->client))
            stream_on_signed(server, signing);
        else
            http_on_signed(server, signing);
        signing_free(&signing);
    }
}

static void collect_history_answers(struct server_context *server)
{
    struct history_answer *answer = server->history_queries ? history_queries_collect(server->history_queries) : NULL;
    for (struct history_answer *next; answer; answer = next) {
        next = answer->next;
        http_on_history_answer(server, answer);
        history_answer_free(&answer);
    }
}

static void look_at_alarms(struct server_context *server)
{
    uint64_t number = server->params.plant.alarm_service ? alarm_service_number(server->params.plant.alarm_service) : 0;
    uint64_t told = server->params.plant.notifier ? notifier_number(server->params.plant.notifier) : 0;
    if (told != server->core.told_number)
        renderers_on_change(server);
    server->core.told_number = told;
    if (number == server->texts.alarms_number)
        return;
    server->texts.alarms_number = number;
    streams_on_alarms(server);
    renderers_on_change(server);
}

static void collect_historical_snapshots(struct server_context *server)
{
    struct history_loader_answer *answer = server->history_loader ? history_loader_collect(server->history_loader) : NULL;
    if (answer)
        server->session_context.readings.history_first_us = history_loader_first_us(server->history_loader);
    for (struct history_loader_answer *next; answer; answer = next) {
        next = answer->next;
        if (stream_owns(server, answer->client))
            stream_on_historical_snapshot(server, answer);
        else
            http_on_historical_snapshot(server, answer);
        mem_free(answer);
    }
}

static void collect_coverage(struct server_context *server)
{
    struct sensor_coverage_answer *answer = server->params.plant.placing ? placing_collect(server->params.plant.placing) : NULL;
    for (struct sensor_coverage_answer *next; answer; answer = next) {
        next = answer->next;
        stream_on_coverage(server, answer);
        sensor_coverage_answer_free(answer);
    }
    if (server->params.plant.placing)
        streams_on_placed(server);
}

static void collect(struct net *net)
{
    struct server_context *server = &net->server;
    net_calls_run(net);
    if (atomic_load(&net->look))
        look_at_files(net, clock_mono_ns());
    core_end_collect(server);
    look_at_alarms(server);
    collect_picks(server);
    collect_history_answers(server);
    collect_signed(server);
    collect_historical_snapshots(server);
    collect_coverage(server);
    http_on_sign_ins(server);
    for (struct encoded_frame *encoded = render_service_collect(server->params.plant.render_service), *next; encoded; encoded = next) {
        next = encoded->next;
        encoded->next = NULL;
        if (stream_owns(server, encoded->client))
            stream_on_frame(server, encoded);
        else
            http_on_frame(server, encoded);
    }
    render_service_wake(server->params.plant.render_service);
    do_what_is_due(net);
}

/* --- life cycle --------------------------------------------------------------------------------------------------------- */

static void raise_file_limit(struct log *log, const struct quotas *quotas)
{
    struct rlimit limit;
    rlim_t wanted = (rlim_t)quotas->at[QUOTA_CONNECTIONS] + SPARE_FILES;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
        return;
    if (limit.rlim_max != RLIM_INFINITY && limit.rlim_max < wanted) {
        log_warn(log, "this process may open only %llu files, but --limit connections=%lld needs %llu; raise ulimit -n or LimitNOFILE=",
                 (unsigned long long)limit.rlim_max, (long long)quotas->at[QUOTA_CONNECTIONS], (unsigned long long)wanted);
        wanted = limit.rlim_max;
    }
    limit.rlim_cur = wanted;
    if (setrlimit(RLIMIT_NOFILE, &limit) != 0)
        log_warn(log, "the limit of open files of this process cannot be raised: %s", strerror(errno));
}

/* Checks that the port can be bound, and logs the reason if not: libwebsockets does not report why it cannot listen. */
bool net_port_free(struct log *log, const char *address, int port)
{
    struct sockaddr_in6 six = { .sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port) };
    struct sockaddr_in four = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port) };
    bool is_six = strchr(address, ':') != NULL;
    if (inet_pton(is_six ? AF_INET6 : AF_INET, address, is_six ? (void *)&six.sin6_addr : (void *)&four.sin_addr) != 1) {
        log_err(log, "--listen: %s is not an IP address", address);
        return false;
    }
    int fd = socket(is_six ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), on = 1;
    bool good = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) == 0 &&
                bind(fd, is_six ? (struct sockaddr *)&six : (struct sockaddr *)&four, is_six ? sizeof(six) : sizeof(four)) == 0 &&
                listen(fd, 1) == 0;
    if (!good)
        log_err(log, "cannot listen on address %s, port %d: %s%s", address, port, strerror(errno),
                errno == EADDRINUSE ? "; stop the program that uses this port, or choose another port with --port" : "");
    if (fd >= 0)
        close(fd);
    return good;
}

static void add_counters(struct server_context *server)
{
    struct counters *c = server->params.counters;
    latency_stages_init(&server->latency, c);
    server->counters.sessions =
        counters_add(c, "plantcast_sessions", "gauge", "Clients connected now: pages and programs that show live pictures.");
    server->counters.sessions_all = counters_add(c, "plantcast_sessions_total", "counter", "Client sessions opened since the start.");
    server->counters.refused = counters_add(c, "plantcast_sessions_refused_total", "counter", "Client sessions refused.");
    server->counters.connections = counters_add(c, "plantcast_connections", "gauge", "TCP connections open now.");
    server->counters.busy = counters_add(c, "plantcast_drawing_busy_percent", "gauge",
                                         "Percentage of time in which the thread that draws pictures was busy with live views.");
    server->counters.frames = counters_add(c, "plantcast_frames_sent_total", "counter", "Frames (pictures of live views) sent to clients.");
    server->counters.frame_bytes =
        counters_add(c, "plantcast_frame_bytes_total", "counter", "Bytes of frames (pictures of live views) sent to clients.");
    server->counters.depth_bytes = counters_add(
        c, "plantcast_depth_bytes_total", "counter",
        "Bytes of depth data sent to pages, which use it to move the current picture with the camera until the next one arrives.");
    server->counters.dropped =
        counters_add(c, "plantcast_frames_dropped_total", "counter", "Frames replaced by a newer frame before they were sent.");
    server->counters.given_up = counters_add(c, "plantcast_frames_given_up_total", "counter",
                                             "Frames that were not sent completely, because the client did not read them.");
    server->counters.stalled =
        counters_add(c, "plantcast_sessions_stalled_total", "counter", "Sessions closed because the client stopped reading.");
    server->counters.messages = counters_add(c, "plantcast_messages_total", "counter", "Messages received from clients.");
    server->counters.errors =
        counters_add(c, "plantcast_message_errors_total", "counter", "Messages from clients that the daemon answered with an error.");
    server->counters.clock_set = counters_add(c, "plantcast_clock_synchronised", "gauge", "1 while this machine's clock is synchronised.");
    server->counters.clock_error =
        counters_add_seconds(c, "plantcast_clock_error_seconds", "gauge", "Maximum error of this machine's clock; 0: unknown.");
    server->counters.clock_leap =
        counters_add(c, "plantcast_clock_leap_seconds", "gauge", "Leap second announced for the end of the month: 1, -1 or 0.");
    server->counters.logins_wrong = counters_add(c, "plantcast_logins_wrong_total", "counter", "Log-ins with an unknown or expired token.");
    server->counters.logins_held =
        counters_add(c, "plantcast_logins_held_total", "counter",
                     "Log-ins refused unchecked, because their client address is rate-limited after many wrong tokens.");
    server->counters.logins_slowed = counters_add(c, "plantcast_logins_slowed_addresses", "gauge",
                                                  "Client addresses that are rate-limited after ten wrong tokens within a minute.");
    server->counters.renderers =
        counters_add(c, "plantcast_renderers", "gauge",
                     "Renderers (daemons that draw for this core) that are connected now; the standby core is not counted.");
    server->counters.standby_files =
        counters_add(c, "plantcast_core_standby_differing_files", "gauge",
                     "Number of the standby's files (1 plant file, 1 tag list, 1 for all models) that differ from this core's.");
    server->counters.requests = counters_add(c, "plantcast_http_requests_total", "counter", "HTTP requests.");
}

static bool open_context(struct net *net)
{
    struct server_context *server = &net->server;
    struct lws_context_creation_info info = {
        .port = server->params.port,
        .iface = server->params.address,
        .protocols = protocols,
        .user = server,
        .gid = -1,
        .uid = -1,
        .options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_DISABLE_OS_CA_CERTS |
                   (strchr(server->params.address, ':') ? 0 : LWS_SERVER_OPTION_DISABLE_IPV6),
        .timeout_secs = (unsigned)server->room.quotas->at[QUOTA_PATIENCE_S],
        .keepalive_timeout = 30,
        .pt_serv_buf_size = 16 * 1024,
        .fd_limit_per_thread = 0,
        .retry_and_idle_policy = &idle_policy,
        .vhost_name = "plantcast",
    };
    if (server->tls) {
        info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
        info.ssl_cert_filepath = server->params.access.tls_cert_path;
        info.ssl_private_key_filepath = server->params.access.tls_key_path;
        /* HTTP/2 stays off: there one connection carries many requests, one of which may even be a WebSocket, but this server keeps its
           state per connection */
        info.alpn = "http/1.1";
    }
    lws_set_log_level(LLL_ERR | LLL_WARN, lws_log_line);
    atomic_store(&lws_log_to, server->params.log);
    if (server->params.socket_fd >= 0)
        info.port = CONTEXT_PORT_NO_LISTEN_SERVER;
    else if (!net_port_free(server->params.log, server->params.address, server->params.port))
        return false;
    server->lws = lws_create_context(&info);
    if (!server->lws) {
        log_err(server->params.log, "cannot listen on address %s, port %d: libwebsockets could not start", server->params.address,
                server->params.port);
        return false;
    }
    net->vhost = lws_get_vhost_by_name(server->lws, "plantcast");
    return server->params.socket_fd < 0 || handed_socket_listen(net);
}

static void wake_loop(void *arg)
{
    struct net *net = arg;
    if (net->server.lws)
        lws_cancel_service(net->server.lws);
}

static bool open_access(struct net *net)
{
    struct server_context *server = &net->server;
    const struct access_params *access = &server->params.access;
    connection_learn_host_name(server);
    server->http.content_policy = access_content_policy(access);
    server->local_only = access_name_is_local(server->params.address) && !access->behind_proxy;
    if (access->tokens_path)
        server->session_context.sign_in.tokens = server->logins.tokens = tokens_create(server->params.log, access->tokens_path);
    if (access->tokens_path && !server->logins.tokens)
        return false;
    if (access->notice_path && !(server->logins.notice = access_notice_read(server->params.log, access->notice_path)))
        return false;
    server->session_context.sign_in.lock_ns = (int64_t)(access->lock_min * 60e9);
    if (server->logins.tokens) {
        tokens_set_plant(server->logins.tokens, server->params.plant.scene->plant->name);
        tokens_set_pairings(server->logins.tokens, pairings_find, server->params.plant.pairings);
    }
    const struct openid_params openid = { .log = server->params.log,
                                          .counters = server->params.counters,
                                          .audit = server->params.audit,
                                          .path = access->openid_path,
                                          .lock_ns = (int64_t)(access->lock_min * 60e9),
                                          .wake = wake_loop,
                                          .wake_arg = net };
    if (access->openid_path && !(server->session_context.sign_in.openid = server->logins.openid = openid_start(&openid)))
        return false;
    return !access->tls_cert_path || (server->tls = tls_create(server->params.log, access->tls_cert_path, access->tls_key_path));
}

bool net_access_good(struct log *log, const struct access_params *access)
{
    struct tokens *tokens = access->tokens_path ? tokens_create(log, access->tokens_path) : NULL;
    struct tls *tls = access->tls_cert_path ? tls_create(log, access->tls_cert_path, access->tls_key_path) : NULL;
    struct openid_config *openid = access->openid_path ? openid_config_read(log, access->openid_path) : NULL;
    char *notice = access->notice_path ? access_notice_read(log, access->notice_path) : NULL;
    bool good = (tokens || !access->tokens_path) && (tls || !access->tls_cert_path) && (openid || !access->openid_path) &&
                (notice || !access->notice_path);
    mem_free(notice);
    openid_config_free(&openid);
    tokens_destroy(&tokens);
    tls_destroy(&tls);
    return good;
}

struct net *net_create(const struct net_params *params)
{
    struct net *net = mem_new(sizeof(*net));
    struct server_context *server = &net->server;
    net_calls_init(net);
    server->params = *params;
    server->streams.next_client = 1;
    server->room.quotas = &server->params.access.quotas;
    server->room.admission.quotas = server->room.quotas;
    server->room.addresses = address_limits_create(server->room.quotas, !params->access.behind_proxy && params->access.proxy_count == 0);
    server->logins.throttle = login_throttle_create();
    server->session_context = (struct session_context){
        .caches.alarm_texts = &server->texts.alarms,
        .caches.tag_texts = &server->texts.tags,
        .caches.lists_said = server->texts.lists,
        .codecs = params->codecs,
        .imports = params->import != NULL,
        .version = params->version,
        .node = params->node,
        .quotas = server->room.quotas,
        .resumes = resumes_create(),
        .admission = &server->room.admission,
        .sign_in.login_throttle = server->logins.throttle,
        .records.audit = params->audit,
        .records.file_writer = params->file_writer,
        .records.kept_answers = &server->kept_answers,
    };
    if (params->signing_key) {
        signing_key_id(params->signing_key, server->signing.key_id);
        server->session_context.signing_key = server->signing.key_id;
    }
    if (params->is_core)
        renderers_make_key(server);
    add_counters(server);
    net_bind_plant(net);
    raise_file_limit(params->log, server->room.quotas);
    server->http.site = site_create(params->log, params->web_folder);
    if (!open_access(net) || !open_context(net) || !net_open_history(net) || !net_open_signer(net))
        net_destroy(&net);
    return net;
}

void net_destroy(struct net **net_ptr)
{
    struct net *net = *net_ptr;
    if (!net)
        return;
    lws_sul_cancel(&net->timer);
    /* destroys the services that have threads of their own before the libwebsockets context, because these threads wake the
       event loop through that context */
    history_queries_destroy(&net->server.history_queries);
    picture_signer_destroy(&net->server.signing.signer);
    history_loader_destroy(&net->server.history_loader);
    openid_stop(&net->server.logins.openid);
    if (net->server.lws)
        lws_context_destroy(net->server.lws);
    session_settle_gone(&net->server.kept_answers);
    atomic_store(&lws_log_to, NULL);
    tls_destroy(&net->server.tls);
    tokens_destroy(&net->server.logins.tokens);
    site_destroy(&net->server.http.site);
    mem_free(net->server.http.content_policy);
    mem_free(net->server.logins.notice);
    address_limits_destroy(&net->server.room.addresses);
    login_throttle_destroy(&net->server.logins.throttle);
    mem_free(net->server.streams.by_client);
    resumes_destroy(&net->server.session_context.resumes);
    alarm_text_cache_finish(&net->server.texts.alarms);
    tag_text_cache_finish(&net->server.texts.tags);
    for (int i = 0; i < LISTS; i++)
        mem_free(net->server.texts.lists[i]);
    marker_text_cache_finish(&net->server.texts.markers);
    neighbour_text_cache_finish(&net->server.texts.neighbours);
    snapshot_destroy(&net->server.readings.snapshot);
    mem_free(net->server.readings.changes);
    mem_free(net->server.readings.links_up);
    json_decref(net->server.session_context.standby);
    net_calls_finish(net);
    mem_free(net);
    *net_ptr = NULL;
}

int net_port(const struct net *net)
{
    return net->server.params.socket_fd >= 0 ? net->server.params.port : lws_get_vhost_listen_port(net->vhost);
}

/* At shutdown, continues to serve until the clients' actions are on disk (or cannot be written) and renderers have the answers. */
static void finish_actions(struct net *net)
{
    for (int64_t now_ns = clock_mono_ns(), end_ns = now_ns + SETTLED_NS;
         (net_settle_answers(net) || renderers_owe_answers(&net->server)) && now_ns < end_ns; now_ns = clock_mono_ns()) {
        set_timer(net, now_ns + SETTLE_NS);
        lws_service(net->server.lws, 0);
    }
}

static bool goes_on(struct net *net)
{
    if (!atomic_load(&net->stopping))
        return true;
    set_timer(net, clock_mono_ns() + SETTLE_NS);
    return net_hand_over(net);
}

void net_run(struct net *net)
{
    struct server_context *server = &net->server;
    net_watch_readings(net);
    do_what_is_due(net);
    while (goes_on(net) && lws_service(server->lws, 0) >= 0)
        collect(net);
    net_calls_close(net);
    net_unwatch_readings(net);
    finish_actions(net);
    streams_close(server);
    renderers_close(server, "the core is shutting down");
    server->life.goes_down = true;
    set_timer(net, clock_mono_ns() + GOODBYE_NS);
    for (int64_t end_ns = clock_mono_ns() + GOODBYE_NS;
         (server->streams.count > 0 || server->room.unanswered > 0 || server->core.renderers) && clock_mono_ns() < end_ns;)
        lws_service(server->lws, 0);
}

void net_stop(struct net *net)
{
    atomic_store(&net->stopping, true);
    lws_cancel_service(net->server.lws);
}

void net_drain(struct net *net)
{
    atomic_store(&net->drain, true);
    lws_cancel_service(net->server.lws);
}

void net_check_credentials(struct net *net)
{
    atomic_store(&net->look, true);
    lws_cancel_service(net->server.lws);
}
