/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An MQTT source: connects to a broker, subscribes, and marks all its readings as lost when the connection is lost. It can
   publish only two messages, if the plant file allows them. These are the request for a Sparkplug birth certificate, and a last
   will on a topic below plantcast/. */
#include <errno.h>
#include <sys/random.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/lookup.h"
#include "value/mqtt/mqtt_impl.h"

/* time limit in nanoseconds, from the start of connecting, for the broker to acknowledge the subscription to all topics */
static const int64_t CONNECT_NS = 10 * NS_PER_S;
static const int64_t LINE_NS = 60 * NS_PER_S; /* minimum time in nanoseconds between two log lines about refused messages */

static bool stopping(const struct mqtt_source *mqtt, int64_t until_ns)
{
    return wait_for(-1, 0, mqtt->base.stop_fd, until_ns) == -ECANCELED;
}

/* --- the link --------------------------------------------------------------------------------------------------------------- */

/* Marks the readings of all tags of the source as lost, because values may have changed unnoticed while the broker could not be reached. */
static void link_lost(struct mqtt_source *mqtt, const char *why)
{
    int64_t now_ns = clock_mono_ns();
    log_at(mqtt->base.log, mqtt->link_up || !mqtt->link_known ? LOG_WARN : LOG_DEBUG, "source %s: %s:%d: no readings (%s)",
           mqtt->base.config->id, mqtt->base.config->hosts[mqtt->turn.index], mqtt->base.config->port, why);
    mqtt->link_up = mqtt->subscribed = false;
    mqtt->link_known = true;
    counter_set(mqtt->up, 0);
    counter_set(mqtt->host, 0);
    store_tags_dead(mqtt->base.store, mqtt->topics.tags, mqtt->topics.tag_count, now_ns);
    store_link_lost(mqtt->base.store, mqtt->base.index, now_ns);
}

static void on_subscribed(void *arg)
{
    struct mqtt_source *mqtt = arg;
    mqtt->subscribed = mqtt->link_up = mqtt->link_known = true;
    host_turn_succeeded(&mqtt->turn);
    counter_set(mqtt->up, 1);
    counter_set(mqtt->host, 1 + mqtt->turn.index);
    store_link_up(mqtt->base.store, mqtt->base.index, clock_mono_ns());
    if (mqtt->sparkplug)
        sparkplug_on_subscribed(mqtt->sparkplug, clock_mono_ns());
    log_info(mqtt->base.log, "source %s: %s:%d: reading", mqtt->base.config->id, mqtt->base.config->hosts[mqtt->turn.index],
             mqtt->base.config->port);
}

/* Called at each connection. Marks readings that the store took from the plant before a reload, or from a core: newer messages may
   have been missed, even with a persistent session: the broker keeps no messages that were published with QoS 0. (After a lost
   connection, link_lost() has already made all tags Bad.) Sparkplug readings become Bad, because they are valid only after a birth
   certificate; other readings become Uncertain until their next value, or until they are stale. */
static void note_missed(struct mqtt_source *mqtt)
{
    store_values_missed(mqtt->base.store, mqtt->topics.tags, mqtt->topics.tag_count, mqtt->sparkplug != NULL, clock_mono_ns());
}

static void on_connected(void *arg, bool session_present)
{
    struct mqtt_source *mqtt = arg;
    counter_inc(mqtt->connects, 1);
    note_missed(mqtt);
    log_debug(mqtt->base.log, "source %s: connected, %s session", mqtt->base.config->id, session_present ? "the earlier" : "a new");
    mqtt_client_subscribe(mqtt->client, mqtt->subscriptions, mqtt->subscription_count);
    if (mqtt->subscription_count == 0)
        on_subscribed(mqtt);
}

static void on_topic_refused(void *arg, const char *topic)
{
    struct mqtt_source *mqtt = arg;
    const struct mqtt_message message = { .topic = topic };
    mqtt_refuse(mqtt, &message, "the MQTT broker refused the subscription to the source's topics");
}

static void ask_rebirth(void *arg, const char *group, const char *node)
{
    struct mqtt_source *mqtt = arg;
    counter_inc(mqtt->rebirths, 1);
    mqtt_client_ask_rebirth(mqtt->client, group, node);
}

static void on_message(void *arg, const struct mqtt_message *message)
{
    mqtt_take_message(arg, message);
}

/* --- the thread ------------------------------------------------------------------------------------------------------------- */

/* Runs one connection to the broker until it ends. Returns -ECANCELED when the source must stop, else another negative code with the
   reason in `why`. */
static int run_session(struct mqtt_source *mqtt, char why[200])
{
    const struct mqtt_client_events events = {
        .arg = mqtt, .connected = on_connected, .subscribed = on_subscribed, .topic_refused = on_topic_refused, .message = on_message
    };
    int64_t deadline_ns = clock_mono_ns() + CONNECT_NS, tick_ns = 0;
    int *address = &mqtt->addresses[mqtt->turn.index];
    mqtt->client = mqtt_client_start(mqtt->base.config, mqtt->turn.index, *address, mqtt->client_id, &events, why);
    int status = mqtt->client ? mqtt_client_wait(mqtt->client, mqtt->base.stop_fd, deadline_ns, why) : -EINVAL;
    *address = mqtt_client_next_address(*address, status);
    while (status == 0) {
        int64_t now_ns = clock_mono_ns();
        mqtt_log_left_out(mqtt, now_ns);
        status = mqtt_client_serve(mqtt->client, mqtt->base.stop_fd, now_ns + NS_PER_S, why);
        if (status == 0 && !mqtt->subscribed && now_ns > deadline_ns) {
            snprintf(why, 200, "the MQTT broker does not answer");
            status = -ETIMEDOUT;
        }
        if (status == 0 && mqtt->sparkplug && mqtt->subscribed && now_ns > tick_ns) {
            sparkplug_on_tick(mqtt->sparkplug, now_ns);
            tick_ns = now_ns + NS_PER_S;
        }
    }
    mqtt_client_destroy(&mqtt->client);
    return status;
}

static void mqtt_run(struct source *source)
{
    struct mqtt_source *mqtt = (struct mqtt_source *)source;
    int64_t next_ns = 0;
    while (!stopping(mqtt, next_ns)) {
        char why[200] = "";
        if (run_session(mqtt, why) == -ECANCELED)
            break;
        link_lost(mqtt, why);
        next_ns = host_turn_next_ns(&mqtt->turn, (int)mqtt->base.config->host_count, clock_mono_ns());
    }
}

static void mqtt_destroy(struct source *source)
{
    struct mqtt_source *mqtt = (struct mqtt_source *)source;
    sparkplug_destroy(&mqtt->sparkplug);
    stamped_writer_finish(&mqtt->writer);
    mqtt_topics_finish(&mqtt->topics);
    for (size_t i = 0; i < mqtt->subscription_count; i++)
        mem_free(mqtt->subscriptions[i]);
    mem_free(mqtt->subscriptions);
    mem_free(mqtt->matched);
    mem_free(mqtt->client_id);
    mem_free(mqtt);
}

static void add_counters(struct mqtt_source *mqtt, struct counters *counters)
{
    const struct source *base = &mqtt->base;
    const char *messages = "Messages received from the source's MQTT broker, by result.";
    mqtt->messages_ok = source_counter(base, counters, "messages_total", ",result=\"ok\"", "counter", messages);
    mqtt->messages_refused = source_counter(base, counters, "messages_total", ",result=\"refused\"", "counter", messages);
    mqtt->samples = source_counter(base, counters, "samples_total", "", "counter",
                                   "Samples (readings) received from the source's server or broker, or replayed from its file.");
    mqtt->connects = source_counter(base, counters, "connects_total", "", "counter",
                                    "Connections made to the source's field devices, server or broker.");
    if (base->config->mqtt.payload == MQTT_SPARKPLUG) {
        mqtt->gaps = source_counter(base, counters, "gaps_total", "", "counter",
                                    "Sparkplug messages out of sequence, so that messages before them were lost.");
        mqtt->historical = source_counter(base, counters, "historical_total", "", "counter",
                                          "Sparkplug values ignored because the node marked them as historical.");
        mqtt->rebirths = source_counter(base, counters, "rebirths_total", "", "counter",
                                        "Requests sent to Sparkplug nodes for their birth certificate, which lists the node's metrics.");
    }
    mqtt->up =
        source_counter(base, counters, "up", "", "gauge", "1 while the source (connection to field devices, or replay) delivers readings.");
    mqtt->host = source_counter(base, counters, "host", "", "gauge",
                                "Number of the source's host that delivers readings: 1 is the first in `hosts`; 0: none.");
}

/* Returns the MQTT client id from the plant file, or a random one; the caller frees it. Ids must be unique, because the broker
   disconnects a client if another one connects with the same id. */
static char *make_client_id(const struct plant_source *config)
{
    unsigned random = 0;
    if (config->mqtt.client_id)
        return mem_strdup(config->mqtt.client_id);
    (void)!getrandom(&random, sizeof(random), 0);
    return mem_printf("plantcast-%08x", random);
}

static void add_sparkplug(struct mqtt_source *mqtt)
{
    const struct sparkplug_params params = { .log = mqtt->base.log,
                                             .source = mqtt->base.config->id,
                                             .plant = mqtt->base.plant,
                                             .topics = &mqtt->topics,
                                             .store = mqtt->base.store,
                                             .writer = &mqtt->writer,
                                             .gaps = mqtt->gaps,
                                             .historical = mqtt->historical,
                                             .rebirth = mqtt->base.config->mqtt.rebirth,
                                             .ask = ask_rebirth,
                                             .arg = mqtt };
    mqtt->sparkplug = sparkplug_create(&params);
    mqtt->subscriptions = sparkplug_subscriptions(mqtt->sparkplug, &mqtt->subscription_count);
}

static void add_topics(struct mqtt_source *mqtt)
{
    mqtt_topics_init(&mqtt->topics, mqtt->base.plant, mqtt->base.index);
    if (mqtt->base.config->mqtt.payload == MQTT_SPARKPLUG) {
        add_sparkplug(mqtt);
    } else {
        mqtt->subscriptions = mem_array(mqtt->topics.count, sizeof(*mqtt->subscriptions));
        for (size_t i = 0; i < mqtt->topics.count; i++)
            mqtt->subscriptions[mqtt->subscription_count++] = mem_strdup(mqtt->topics.at[i].name);
    }
    const struct plant_source *config = mqtt->base.config;
    log_info(mqtt->base.log, "source %s: %s:%d: %zu tags in %zu topics", config->id, config->hosts[0], config->port, mqtt->topics.tag_count,
             mqtt->topics.count);
}

static struct source *mqtt_create(const struct source *base, struct counters *counters)
{
    struct mqtt_source *mqtt = mem_new(sizeof(*mqtt));
    mqtt->base = *base;
    mqtt->refusals = mqtt->absences = (struct log_pace){ .first_ns = LINE_NS, .longest_ns = LINE_NS };
    mqtt->matched = mem_array(base->plant->tag_count, sizeof(*mqtt->matched));
    add_counters(mqtt, counters);
    add_topics(mqtt);
    stamped_writer_init(&mqtt->writer, base->plant, base->store);
    mqtt->client_id = make_client_id(base->config);
    return &mqtt->base;
}

const struct source_impl mqtt_impl = { .kind = "mqtt", .create = mqtt_create, .run = mqtt_run, .destroy = mqtt_destroy };
