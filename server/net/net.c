/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop: its context, its tick, its end. */
#include "net/net_impl.h"

#include <arpa/inet.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/tls.h"
#include "net/connection.h"
#include "value/quality.h"

static const int64_t TICK_NS = 100 * NS_PER_MS;
static const int64_t GOODBYE_NS = 500 * NS_PER_MS; /* for the close frames to leave */
static const int64_t LOOK_NS = NS_PER_S;           /* at the files of tokens and certificate, so often */
enum { SPARE_FILES = 256 };                        /* beside connections: models, sources, the database */

static const struct lws_protocols protocols[] = {
    { .name = "http", .callback = http_callback, .per_session_data_size = sizeof(void *) },
    { .name = WIRE_SUBPROTOCOL, .callback = stream_callback, .per_session_data_size = sizeof(void *), .rx_buffer_size = 4096 },
    { 0 },
};

static const lws_retry_bo_t idle_policy = { .secs_since_valid_ping = 20, .secs_since_valid_hangup = 40 };

/* lws has one place for its log in a process: ours has one loop. */
static struct log *_Atomic lws_log_to;

static void lws_log_line(int level, const char *line)
{
    struct log *log = atomic_load(&lws_log_to);
    if (log)
        log_at(log, level == LLL_ERR ? LOG_WARN : LOG_DEBUG, "lws: %.*s", (int)strcspn(line, "\n"), line);
}

bool net_write(struct server_context *hub, struct lws *wsi, const void *bytes, size_t count, enum lws_write_protocol how)
{
    memcpy(hub->out + LWS_PRE, bytes, count);
    return lws_write(wsi, hub->out + LWS_PRE, count, how) >= (int)count;
}

void net_wake_render_service(struct server_context *hub)
{
    if (hub->asked)
        render_service_wake(hub->params.plant.painter);
    hub->asked = false;
}

/* --- what happens by itself ---------------------------------------------------------------------------------------------- */

/* A reading that went stale changed just now, whenever it came in. */
static int64_t changed_ns(const struct snapshot *snapshot, const struct reading *reading)
{
    bool usable = !quality_is_bad(reading->quality) && reading->age_ns < NS_PER_S;
    return snapshot->taken_mono_ns - (usable ? reading->age_ns : 0);
}

static bool take_snapshot(struct server_context *hub)
{
    bool changed = false;
    store_snapshot(hub->params.plant.store, clock_mono_ns(), clock_utc_ns(), hub->snapshot);
    hub->data_ns = hub->snapshot->taken_mono_ns;
    for (size_t i = 0; i < hub->snapshot->count; i++) {
        const struct reading *reading = &hub->snapshot->readings[i];
        if (hub->changes[i] == reading->changes)
            continue;
        int64_t at_ns = changed_ns(hub->snapshot, reading);
        hub->data_ns = at_ns < hub->data_ns ? at_ns : hub->data_ns;
        hub->changes[i] = reading->changes;
        changed = true;
    }
    return changed;
}

static bool look_at_links(struct server_context *hub)
{
    bool changed = false, any = false;
    for (size_t i = 0; i < hub->world.plant->source_count; i++) {
        bool up = store_link_is_up(hub->params.plant.store, (int)i);
        changed |= hub->links_up[i] != up;
        hub->links_up[i] = up;
        any |= up;
    }
    hub->world.live = any;
    bool set = clock_utc_is_set();
    changed |= hub->world.clock_is_set != set;
    hub->world.clock_is_set = set;
    counter_set(hub->counters.clock_set, set);
    return changed;
}

/* Twice, if need be: a file counts as changed once it has stopped changing. */
static void look_at_files(struct net *net, int64_t now_ns)
{
    struct server_context *hub = &net->hub;
    bool asked = atomic_exchange(&net->look, false);
    if (!asked && now_ns - hub->looked_ns < LOOK_NS)
        return;
    hub->looked_ns = now_ns;
    if (asked && hub->params.reload)
        hub->params.reload(hub->params.reload_arg);
    if (hub->tls)
        tls_look(hub->tls);
    if (hub->tokens) {
        tokens_look(hub->tokens);
        streams_check_tokens(hub, clock_utc_ns());
    }
}

/* Once a second: what the machine has left. */
static void look_at_processors(struct net *net, int64_t now_ns)
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
    net->hub.world.cpu_used = 1 - cpu_meter_free(&net->cpu, stat);
}

static void on_tick(lws_sorted_usec_list_t *sul)
{
    struct net *net = lws_container_of(sul, struct net, tick);
    int64_t now_ns = clock_mono_ns();
    look_at_files(net, now_ns);
    look_at_processors(net, now_ns);
    admission_on_tick(&net->hub.admission, now_ns);
    counter_set(net->hub.counters.busy, admission_busy_percent(&net->hub.admission));
    counter_set(net->hub.counters.connections, net->hub.connection_count);
    counter_set(net->hub.counters.logins_slowed, logins_slowed(net->hub.logins, now_ns));
    bool data_changed = take_snapshot(&net->hub), links_changed = look_at_links(&net->hub);
    if (net->hub.past)
        net->hub.world.history_first_us = history_loader_first_us(net->hub.past);
    if (data_changed)
        net->hub.world.changed_ns = net->hub.snapshot->taken_mono_ns;
    if (data_changed)
        render_service_on_data(net->hub.params.plant.painter);
    streams_on_tick(&net->hub, data_changed, links_changed);
    net_wake_render_service(&net->hub);
    lws_sul_schedule(net->hub.context, 0, sul, on_tick, TICK_NS / 1000);
}

static void collect_picks(struct server_context *hub)
{
    for (struct pick_answer *answer = render_service_collect_picks(hub->params.plant.painter), *next; answer; answer = next) {
        next = answer->next;
        if (stream_owns(hub, answer->order.client))
            stream_on_pick(hub, answer);
        else
            http_on_pick(hub, answer);
        mem_free(answer);
    }
}

static void collect_recalled(struct server_context *hub)
{
    struct history_answer *recalled = hub->recall ? history_queries_collect(hub->recall) : NULL;
    for (struct history_answer *next; recalled; recalled = next) {
        next = recalled->next;
        http_on_history_answer(hub, recalled);
        history_answer_free(&recalled);
    }
}

static void look_at_alarms(struct server_context *hub)
{
    uint64_t number = hub->params.plant.alarm_service ? alarm_service_number(hub->params.plant.alarm_service) : 0;
    if (number == hub->alarms_number)
        return;
    hub->alarms_number = number;
    streams_on_alarms(hub);
}

static void collect_moments(struct server_context *hub)
{
    struct history_loader_answer *answer = hub->past ? history_loader_collect(hub->past) : NULL;
    if (answer)
        hub->world.history_first_us = history_loader_first_us(hub->past);
    for (struct history_loader_answer *next; answer; answer = next) {
        next = answer->next;
        if (stream_owns(hub, answer->client))
            stream_on_historical_snapshot(hub, answer);
        else
            http_on_historical_snapshot(hub, answer);
        mem_free(answer);
    }
}

static void collect_places(struct server_context *hub)
{
    struct sensor_coverage_answer *answer = hub->params.plant.placing ? placing_collect(hub->params.plant.placing) : NULL;
    for (struct sensor_coverage_answer *next; answer; answer = next) {
        next = answer->next;
        stream_on_gaps(hub, answer);
        sensor_coverage_answer_free(answer);
    }
    if (hub->params.plant.placing)
        streams_on_placed(hub);
}

static void collect(struct net *net)
{
    struct server_context *hub = &net->hub;
    net_calls_run(net);
    look_at_alarms(hub);
    collect_picks(hub);
    collect_recalled(hub);
    collect_moments(hub);
    collect_places(hub);
    for (struct encoded_frame *picture = render_service_collect(hub->params.plant.painter), *next; picture; picture = next) {
        next = picture->next;
        picture->next = NULL;
        if (stream_owns(hub, picture->client))
            stream_on_frame(hub, picture);
        else
            http_on_frame(hub, picture);
    }
    net_wake_render_service(hub);
}

/* --- life ------------------------------------------------------------------------------------------------------------------ */

static void raise_file_limit(struct log *log, const struct quotas *quotas)
{
    struct rlimit limit;
    rlim_t wanted = (rlim_t)quotas->at[QUOTA_CONNECTIONS] + SPARE_FILES;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
        return;
    if (limit.rlim_max != RLIM_INFINITY && limit.rlim_max < wanted) {
        log_warn(log, "files: this process may open %llu, and %llu are wanted for --limit connections=%lld; ulimit -n, or LimitNOFILE=",
                 (unsigned long long)limit.rlim_max, (unsigned long long)wanted, (long long)quotas->at[QUOTA_CONNECTIONS]);
        wanted = limit.rlim_max;
    }
    limit.rlim_cur = wanted;
    if (setrlimit(RLIMIT_NOFILE, &limit) != 0)
        log_warn(log, "files: the limit stays as it is: %s", strerror(errno));
}

/* lws does not say why it cannot listen; this does. */
bool net_port_free(struct log *log, const char *address, int port)
{
    struct sockaddr_in6 six = { .sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port) };
    struct sockaddr_in four = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port) };
    bool is_six = strchr(address, ':') != NULL;
    if (inet_pton(is_six ? AF_INET6 : AF_INET, address, is_six ? (void *)&six.sin6_addr : (void *)&four.sin_addr) != 1) {
        log_err(log, "listen %s: not an IP address", address);
        return false;
    }
    int fd = socket(is_six ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), on = 1;
    bool good = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) == 0 &&
                bind(fd, is_six ? (struct sockaddr *)&six : (struct sockaddr *)&four, is_six ? sizeof(six) : sizeof(four)) == 0 &&
                listen(fd, 1) == 0;
    if (!good)
        log_err(log, "listen %s port %d: %s%s", address, port, strerror(errno),
                errno == EADDRINUSE ? "; end the program that has it, or take another with --port" : "");
    if (fd >= 0)
        close(fd);
    return good;
}

static void add_counters(struct server_context *hub)
{
    struct counters *c = hub->params.counters;
    latency_stages_init(&hub->stages, c);
    hub->counters.sessions = counters_add(c, "plantcast_sessions", "gauge", "Clients that are connected.");
    hub->counters.sessions_all = counters_add(c, "plantcast_sessions_total", "counter", "Clients that ever were.");
    hub->counters.refused = counters_add(c, "plantcast_sessions_refused_total", "counter", "Clients that were not let in.");
    hub->counters.connections = counters_add(c, "plantcast_connections", "gauge", "TCP connections.");
    hub->counters.busy = counters_add(c, "plantcast_drawing_busy_percent", "gauge", "Of the render thread's time, for moving pictures.");
    hub->counters.frames = counters_add(c, "plantcast_frames_sent_total", "counter", "Frames sent.");
    hub->counters.frame_bytes = counters_add(c, "plantcast_frame_bytes_total", "counter", "Bytes of frames sent.");
    hub->counters.dropped =
        counters_add(c, "plantcast_frames_dropped_total", "counter", "Frames made and overtaken before they were sent.");
    hub->counters.given_up = counters_add(c, "plantcast_frames_given_up_total", "counter", "Frames that were not sent to their end.");
    hub->counters.stalled = counters_add(c, "plantcast_sessions_stalled_total", "counter", "Clients closed because they took nothing.");
    hub->counters.messages = counters_add(c, "plantcast_messages_total", "counter", "Messages of clients.");
    hub->counters.errors = counters_add(c, "plantcast_message_errors_total", "counter", "Messages of clients answered with an error.");
    hub->counters.clock_set =
        counters_add(c, "plantcast_clock_synchronised", "gauge", "1 while something keeps this machine's clock right.");
    hub->counters.logins_wrong = counters_add(c, "plantcast_logins_wrong_total", "counter", "Tokens that were nobody's, or no longer.");
    hub->counters.logins_held =
        counters_add(c, "plantcast_logins_held_total", "counter", "Tokens that were not looked at, of addresses that are slowed.");
    hub->counters.logins_slowed =
        counters_add(c, "plantcast_logins_slowed_addresses", "gauge", "Addresses that are slowed, for ten wrong tokens within a minute.");
    hub->counters.requests = counters_add(c, "plantcast_http_requests_total", "counter", "HTTP requests.");
}

static bool open_context(struct net *net)
{
    struct server_context *hub = &net->hub;
    struct lws_context_creation_info info = {
        .port = hub->params.port,
        .iface = hub->params.address,
        .protocols = protocols,
        .user = hub,
        .gid = -1,
        .uid = -1,
        .options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_DISABLE_OS_CA_CERTS | LWS_SERVER_OPTION_VALIDATE_UTF8 |
                   (strchr(hub->params.address, ':') ? 0 : LWS_SERVER_OPTION_DISABLE_IPV6),
        .timeout_secs = (unsigned)hub->quotas->at[QUOTA_PATIENCE_S],
        .keepalive_timeout = 30,
        .pt_serv_buf_size = 16 * 1024,
        .fd_limit_per_thread = 0,
        .retry_and_idle_policy = &idle_policy,
        .vhost_name = "plantcast",
    };
    if (hub->tls) {
        info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
        info.ssl_cert_filepath = hub->params.access.tls_cert_path;
        info.ssl_private_key_filepath = hub->params.access.tls_key_path;
        info.alpn = "http/1.1"; /* in HTTP/2 a request would be no connection, and could have a stream in it */
    }
    lws_set_log_level(LLL_ERR | LLL_WARN, lws_log_line);
    atomic_store(&lws_log_to, hub->params.log);
    if (!net_port_free(hub->params.log, hub->params.address, hub->params.port))
        return false;
    hub->context = lws_create_context(&info);
    if (!hub->context) {
        log_err(hub->params.log, "listen %s port %d: libwebsockets could not start", hub->params.address, hub->params.port);
        return false;
    }
    net->vhost = lws_get_vhost_by_name(hub->context, "plantcast");
    return true;
}

static bool open_access(struct net *net)
{
    struct server_context *hub = &net->hub;
    const struct access_params *access = &hub->params.access;
    connection_learn_host_name(hub);
    hub->content_policy = access_content_policy(access);
    hub->local_only = access_name_is_local(hub->params.address) && !access->behind_proxy;
    if (access->tokens_path && !(hub->world.tokens = hub->tokens = tokens_create(hub->params.log, access->tokens_path)))
        return false;
    return !access->tls_cert_path || (hub->tls = tls_create(hub->params.log, access->tls_cert_path, access->tls_key_path));
}

static void wake(void *arg)
{
    net_wake(arg);
}

bool net_open_history(struct net *net)
{
    struct server_context *hub = &net->hub;
    const struct net_plant *plant = &hub->params.plant;
    const struct history_loader_params past = { .log = hub->params.log,
                                                .plant = plant->scene->plant,
                                                .folder = plant->history_folder,
                                                .snapshot_cache = plant->snapshot_cache,
                                                .notify = wake,
                                                .notify_arg = net };
    hub->world.snapshot_cache = plant->history_folder ? plant->snapshot_cache : NULL;
    if (!plant->history_folder)
        return true;
    hub->recall = history_queries_create(hub->params.log, plant->scene->plant, plant->history_folder, wake, net);
    hub->past = history_loader_create(&past);
    return hub->recall && hub->past;
}

bool net_access_good(struct log *log, const struct access_params *access)
{
    struct tokens *tokens = access->tokens_path ? tokens_create(log, access->tokens_path) : NULL;
    struct tls *tls = access->tls_cert_path ? tls_create(log, access->tls_cert_path, access->tls_key_path) : NULL;
    bool good = (tokens || !access->tokens_path) && (tls || !access->tls_cert_path);
    tokens_destroy(&tokens);
    tls_destroy(&tls);
    return good;
}

void net_bind_plant(struct net *net)
{
    struct server_context *hub = &net->hub;
    const struct plant *plant = hub->params.plant.scene->plant;
    hub->snapshot = snapshot_create(plant->tag_count);
    hub->changes = mem_array(plant->tag_count, sizeof(*hub->changes));
    hub->links_up = mem_array(plant->source_count, sizeof(*hub->links_up));
    hub->world.plant = plant;
    hub->world.scene = hub->params.plant.scene;
    hub->world.snapshot = hub->snapshot;
    hub->world.baselines = hub->params.plant.baselines;
    hub->world.alarm_service = hub->params.plant.alarm_service;
    hub->world.placing = hub->params.save ? hub->params.plant.placing : NULL;
    hub->world.loop_checks = hub->params.plant.loop_checks;
    hub->world.tag_list = hub->params.plant.tag_list;
    hub->world.links_up = hub->links_up;
    take_snapshot(hub);
    look_at_links(hub);
}

struct net *net_create(const struct net_params *params)
{
    struct net *net = mem_new(sizeof(*net));
    struct server_context *hub = &net->hub;
    net_calls_init(net);
    hub->params = *params;
    hub->next_client = 1;
    hub->quotas = &hub->params.access.quotas;
    hub->admission.quotas = hub->quotas;
    hub->peers = address_limits_create(hub->quotas, !params->access.behind_proxy);
    hub->logins = login_throttle_create();
    hub->world = (struct session_context){
        .alarms_said = &hub->alarms_said,
        .tags_said = &hub->tags_said,
        .lists_said = hub->lists_said,
        .codecs = params->codecs,
        .version = params->version,
        .quotas = hub->quotas,
        .resumes = resumes_create(),
        .admission = &hub->admission,
        .logins = hub->logins,
    };
    add_counters(hub);
    net_bind_plant(net);
    raise_file_limit(params->log, hub->quotas);
    if (!open_access(net) || !open_context(net) || !net_open_history(net))
        net_destroy(&net);
    return net;
}

void net_destroy(struct net **net_ptr)
{
    struct net *net = *net_ptr;
    if (!net)
        return;
    lws_sul_cancel(&net->tick);
    history_queries_destroy(&net->hub.recall); /* before what they wake */
    history_loader_destroy(&net->hub.past);
    if (net->hub.context)
        lws_context_destroy(net->hub.context);
    atomic_store(&lws_log_to, NULL);
    tls_destroy(&net->hub.tls);
    tokens_destroy(&net->hub.tokens);
    mem_free(net->hub.content_policy);
    address_limits_destroy(&net->hub.peers);
    login_throttle_destroy(&net->hub.logins);
    mem_free(net->hub.by_client);
    resumes_destroy(&net->hub.world.resumes);
    alarm_text_cache_finish(&net->hub.alarms_said);
    tag_text_cache_finish(&net->hub.tags_said);
    for (int i = 0; i < 2; i++)
        mem_free(net->hub.lists_said[i]);
    marker_text_cache_finish(&net->hub.marker_lists);
    snapshot_destroy(&net->hub.snapshot);
    mem_free(net->hub.changes);
    mem_free(net->hub.links_up);
    net_calls_finish(net);
    mem_free(net);
    *net_ptr = NULL;
}

int net_port(const struct net *net)
{
    return lws_get_vhost_listen_port(net->vhost);
}

void net_run(struct net *net)
{
    struct server_context *hub = &net->hub;
    on_tick(&net->tick);
    while (!atomic_load(&net->stopping) && lws_service(hub->context, 0) >= 0)
        collect(net);
    net_calls_close(net);
    streams_close(hub);
    for (int64_t end_ns = clock_mono_ns() + GOODBYE_NS; hub->stream_count > 0 && clock_mono_ns() < end_ns;)
        lws_service(hub->context, 0);
}

void net_wake(struct net *net)
{
    lws_cancel_service(net->hub.context);
}

void net_stop(struct net *net)
{
    atomic_store(&net->stopping, true);
    lws_cancel_service(net->hub.context);
}

void net_check_credentials(struct net *net)
{
    atomic_store(&net->look, true);
    lws_cancel_service(net->hub.context);
}
