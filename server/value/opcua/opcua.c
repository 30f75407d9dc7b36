/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An OPC UA source: connects to a server, subscribes, and marks all its readings as lost when the connection is lost. */
#include <errno.h>

#include "base/clock.h"
#include "base/log/log_pace.h"
#include "base/mem.h"
#include "value/backoff.h"
#include "value/lookup.h"
#include "value/opcua/opcua_client.h"
#include "value/source_impl.h"

/* CONNECT_NS: time limit for opening a session; SUBSCRIBE_NS: time limit for subscribing to all nodes */
static const int64_t CONNECT_NS = 15 * NS_PER_S, SUBSCRIBE_NS = 60 * NS_PER_S;
/* SERVE_NS: maximum duration of one wait for new values; RETRY_NS: interval between repeated requests for nodes that the server refused */
static const int64_t SERVE_NS = NS_PER_S, RETRY_NS = 30 * NS_PER_S;
/* minimum time between two reads of all nodes after notifications from the server were lost */
static const int64_t READ_NS = 10 * NS_PER_S;
static const int64_t SKEW_NS = 5 * NS_PER_S, SKEW_SAID_NS = 60 * NS_PER_S;
enum { REFUSALS_SAID = 8 }; /* maximum number of log lines per session about refused nodes; the same for refused deadbands */

struct opcua_source {
    struct source base;
    counter *samples, *connects, *up, *host, *refused;
    /* --- below: members that only the source's thread uses */
    struct opcua_nodes nodes;
    struct stamped_writer writer;
    struct host_turn turn;
    bool link_up, link_known;
    int refusals_said, deadbands_said;
    bool *wrong; /* by node: true: the last log line about the node says that its value is not a number */
    int64_t skew_said_ns;
    struct log_pace missed_pace; /* rate limit of the log line about lost notifications */
};

/* --- values ----------------------------------------------------------------------------------------------------------------- */

/* Logs the difference between the server's clock and ours. Uses the server timestamp, because the source timestamp may be an old time of
   the sensor. */
static void report_skew(struct opcua_source *opcua, const UA_DataValue *value)
{
    int64_t now_ns = opcua->writer.mono_ns;
    if (!value->hasServerTimestamp)
        return;
    int64_t skew_ns = (value->serverTimestamp - UA_DATETIME_UNIX_EPOCH) * 100 - opcua->writer.utc_ns;
    if ((skew_ns < SKEW_NS && skew_ns > -SKEW_NS) || (opcua->skew_said_ns && now_ns - opcua->skew_said_ns < SKEW_SAID_NS))
        return;
    opcua->skew_said_ns = now_ns;
    log_warn(opcua->base.log, "source %s: the server's timestamps are %.1f s %s this machine's clock", opcua->base.config->id,
             (double)(skew_ns > 0 ? skew_ns : -skew_ns) / 1e9, skew_ns > 0 ? "ahead of" : "behind");
}

static void on_value(void *arg, size_t index, const UA_DataValue *data)
{
    struct opcua_source *opcua = arg;
    const struct opcua_node *node = &opcua->nodes.at[index];
    bool good = true;
    char why[200];
    stamped_writer_begin(&opcua->writer, clock_mono_ns(), clock_utc_ns());
    for (size_t i = 0; i < node->tag_count; i++) {
        struct stamped_value value;
        int tag = node->tags[i];
        good &= opcua_value_read(data, opcua->base.plant->tags[tag].signal.element, &value, why);
        stamped_writer_add(&opcua->writer, tag, &value, false, true);
    }
    stamped_writer_end(&opcua->writer);
    counter_inc(opcua->samples, (int64_t)opcua->writer.written);
    report_skew(opcua, data);
    if (!good && !opcua->wrong[index])
        log_warn(opcua->base.log, "source %s: %.100s: %s", opcua->base.config->id, node->id, why);
    opcua->wrong[index] = !good;
}

static void on_refused(void *arg, size_t index, uint32_t status, const char *why)
{
    struct opcua_source *opcua = arg;
    const struct opcua_node *node = &opcua->nodes.at[index];
    stamped_writer_begin(&opcua->writer, clock_mono_ns(), clock_utc_ns());
    for (size_t i = 0; i < node->tag_count; i++)
        stamped_writer_add_bad(&opcua->writer, node->tags[i], status);
    stamped_writer_end(&opcua->writer);
    if (++opcua->refusals_said <= REFUSALS_SAID)
        log_warn(opcua->base.log, "source %s: the OPC UA server refuses to read node nsu=%.80s;%.80s: %s%s", opcua->base.config->id,
                 node->name_space, node->id, why, opcua->refusals_said == REFUSALS_SAID ? "; further refusals are not logged" : "");
}

/* Logs that the server refuses a deadband that the tag list states. A refused deadband of the plant file is not logged, because it
   applies only to nodes that support one. */
static void on_deadband_refused(void *arg, size_t index, const char *why)
{
    struct opcua_source *opcua = arg;
    const struct opcua_node *node = &opcua->nodes.at[index];
    if (node->own_deadband && ++opcua->deadbands_said <= REFUSALS_SAID)
        log_warn(opcua->base.log, "source %s: nsu=%.80s;%.80s: the server refuses the OPC Deadband %.9g%s (%s) and reports every change%s",
                 opcua->base.config->id, node->name_space, node->id, node->deadband.value, node->deadband.percent ? "%" : "", why,
                 opcua->deadbands_said == REFUSALS_SAID ? "; further refusals are not logged" : "");
}

/* --- the link --------------------------------------------------------------------------------------------------------------- */

/* Marks the readings of all tags of the source as lost, because values may have changed unnoticed while the server could not be reached. */
static void link_lost(struct opcua_source *opcua, const char *why)
{
    int64_t now_ns = clock_mono_ns();
    const struct plant_source *config = opcua->base.config;
    log_at(opcua->base.log, opcua->link_up || !opcua->link_known ? LOG_WARN : LOG_DEBUG, "source %s: %s:%d: no readings (%s)", config->id,
           config->hosts[opcua->turn.index], config->port, why);
    opcua->link_up = false;
    opcua->link_known = true;
    counter_set(opcua->up, 0);
    counter_set(opcua->host, 0);
    store_tags_dead(opcua->base.store, opcua->nodes.tags, opcua->nodes.tag_count, now_ns);
    store_link_lost(opcua->base.store, opcua->base.index, now_ns);
}

static void link_up(struct opcua_source *opcua, const struct opcua_client *client)
{
    const struct plant_source *config = opcua->base.config;
    opcua->link_up = opcua->link_known = true;
    host_turn_succeeded(&opcua->turn);
    counter_set(opcua->up, 1);
    counter_set(opcua->host, 1 + opcua->turn.index);
    counter_set(opcua->refused, (int64_t)opcua_client_refused(client));
    store_link_up(opcua->base.store, opcua->base.index, clock_mono_ns());
    log_info(opcua->base.log, "source %s: %s:%d: reading %zu nodes; the server refused %zu", config->id, config->hosts[opcua->turn.index],
             config->port, opcua->nodes.count - opcua_client_refused(client), opcua_client_refused(client));
    if (opcua_client_publishing_ms(client) > 0)
        log_warn(opcua->base.log, "source %s: the server publishes changes every %.0f ms instead of every %d ms", config->id,
                 opcua_client_publishing_ms(client), config->poll_ms);
}

/* Reads the values of all nodes if notifications of changes were lost: otherwise a tag would keep an old value until its next
   change. */
static int make_up(struct opcua_source *opcua, struct opcua_client *client, int64_t *next_ns, char why[200])
{
    int64_t now_ns = clock_mono_ns();
    char more[LOG_PACE_BYTES];
    if (!opcua_client_missed(client) || now_ns < *next_ns)
        return 0;
    *next_ns = now_ns + READ_NS;
    if (log_pace_take(&opcua->missed_pace, now_ns, more))
        log_warn(opcua->base.log, "source %s: notifications from the OPC UA server were lost, so all nodes are read again%s",
                 opcua->base.config->id, more);
    return opcua_client_read(client, opcua->base.stop_fd, now_ns + SUBSCRIBE_NS, why);
}

static int serve(struct opcua_source *opcua, struct opcua_client *client, char why[200])
{
    int status = 0;
    int64_t retry_ns = clock_mono_ns() + RETRY_NS, read_ns = 0;
    while (status == 0) {
        int64_t now_ns = clock_mono_ns();
        status = opcua_client_serve(client, opcua->base.stop_fd, now_ns + SERVE_NS, why);
        if (status == 0)
            status = make_up(opcua, client, &read_ns, why);
        if (status || now_ns < retry_ns)
            continue;
        retry_ns = now_ns + RETRY_NS;
        status = opcua_client_subscribe(client, opcua->base.stop_fd, now_ns + SUBSCRIBE_NS, why);
        counter_set(opcua->refused, (int64_t)opcua_client_refused(client));
    }
    return status;
}

/* Runs one session with the server until it ends. Returns -ECANCELED when the source must stop, else another negative code with the
   reason in `why`. */
static int run_session(struct opcua_source *opcua, char why[200])
{
    const struct opcua_events events = { .arg = opcua, .value = on_value, .refused = on_refused, .deadband_refused = on_deadband_refused };
    struct opcua_client *client = opcua_client_create(opcua->base.config, opcua->turn.index, &opcua->nodes, &events, why);
    opcua->refusals_said = opcua->deadbands_said = 0;
    int status = client ? opcua_client_connect(client, opcua->base.stop_fd, clock_mono_ns() + CONNECT_NS, why) : -EINVAL;
    if (status == 0) {
        counter_inc(opcua->connects, 1);
        status = opcua_client_subscribe(client, opcua->base.stop_fd, clock_mono_ns() + SUBSCRIBE_NS, why);
    }
    if (status == 0) {
        link_up(opcua, client);
        status = serve(opcua, client, why);
    }
    if (status != -ECANCELED)
        link_lost(opcua, why);
    opcua_client_destroy(&client);
    return status;
}

static void opcua_run(struct source *source)
{
    struct opcua_source *opcua = (struct opcua_source *)source;
    int64_t next_ns = 0;
    while (wait_for(-1, 0, source->stop_fd, next_ns) != -ECANCELED) {
        char why[200] = "";
        if (run_session(opcua, why) == -ECANCELED)
            break;
        next_ns = host_turn_next_ns(&opcua->turn, (int)opcua->base.config->host_count, clock_mono_ns());
    }
}

static void opcua_destroy(struct source *source)
{
    struct opcua_source *opcua = (struct opcua_source *)source;
    stamped_writer_finish(&opcua->writer);
    opcua_nodes_finish(&opcua->nodes);
    mem_free(opcua->wrong);
    mem_free(opcua);
}

static struct source *opcua_create(const struct source *base, struct counters *counters)
{
    struct opcua_source *opcua = mem_new(sizeof(*opcua));
    opcua->base = *base;
    opcua->samples = source_counter(base, counters, "samples_total", "", "counter",
                                    "Samples (readings) received from the source's server or broker, or replayed from its file.");
    opcua->connects = source_counter(base, counters, "connects_total", "", "counter",
                                     "Connections made to the source's field devices, server or broker.");
    opcua->refused =
        source_counter(base, counters, "nodes_refused", "", "gauge", "Nodes (tags) that the source's OPC UA server refuses to read.");
    opcua->up =
        source_counter(base, counters, "up", "", "gauge", "1 while the source (connection to field devices, or replay) delivers readings.");
    opcua->host = source_counter(base, counters, "host", "", "gauge",
                                 "Number of the source's host that delivers readings: 1 is the first in `hosts`; 0: none.");
    opcua_nodes_init(&opcua->nodes, base->plant, base->index);
    opcua->wrong = mem_array(opcua->nodes.count, sizeof(*opcua->wrong));
    stamped_writer_init(&opcua->writer, base->plant, base->store);
    opcua->missed_pace = (struct log_pace){ .first_ns = 60 * NS_PER_S, .longest_ns = 3600 * NS_PER_S };
    log_info(base->log, "source %s: %s:%d: %zu tags in %zu nodes", base->config->id, base->config->hosts[0], base->config->port,
             opcua->nodes.tag_count, opcua->nodes.count);
    return &opcua->base;
}

const struct source_impl opcua_impl = { .kind = "opcua", .create = opcua_create, .run = opcua_run, .destroy = opcua_destroy };
