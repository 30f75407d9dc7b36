/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that publishes readings and alarms to an MQTT broker. */
#include "notify/publisher.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "base/text/timestamp.h"
#include "value/backoff.h"
#include "value/lookup.h"
#include "value/mqtt/mqtt_client.h"
#include "value/quality.h"

static const int64_t CONNECT_NS = 10 * NS_PER_S;

struct topic {
    char *name, *unit;       /* name: MQTT topic of the tag; unit: text of a JSON object with the tag's unit as its only member */
    int64_t received_utc_ns; /* UTC time of the reading of this tag that was published last */
    double value;            /* value that was published last; a sample with the same time may still replace this value */
    uint32_t quality;
    bool is_published; /* true: the tag's reading was published on the present connection */
};

struct publisher {
    struct publisher_params params;
    pthread_t thread;
    bool started;
    int stop_fd; /* eventfd that becomes readable when the thread must end */
    char *client_id;
    counter *up, *messages;
    /* --- below: members that only the publisher's thread uses */
    struct mqtt_client *client;
    int address; /* which of the broker's IP addresses to use, see mqtt_client_next_address() */
    struct snapshot *snapshot;
    struct topic *topics; /* by tag: its MQTT topic */
    uint64_t alarm_number;
    bool connected, alarms_published;
    char said[200]; /* last problem with the MQTT broker that was logged; empty: no problem */
};

/* --- published messages ------------------------------------------------------------------------------------------------------- */

/* Appends a tag's name as one level of an MQTT topic. Percent-encodes level separators, wildcards and percent signs. */
static void add_level(struct text *text, const char *name)
{
    for (const char *c = name; *c; c++)
        text_add(text, strchr("/+#%", *c) ? "%%%02X" : "%c", (unsigned char)*c);
}

/* Publishes a text to a topic. If the broker refuses the message, logs the refusal and continues. Returns false if the
   connection has ended. */
static bool publish(struct publisher *publisher, const char *topic, const char *text)
{
    int status = mqtt_client_publish(publisher->client, topic, text);
    counter_inc(publisher->messages, status == 0);
    if (status < 0 && status != -ENOTCONN)
        log_warn(publisher->params.log, "publish: topic %s: the MQTT client refused a message of %zu bytes; it is not sent", topic,
                 strlen(text));
    return status != -ENOTCONN;
}

static bool publish_reading(struct publisher *publisher, struct topic *topic, const struct reading *reading)
{
    char time[TIMESTAMP_BYTES], value[40] = "null";
    struct text text = { 0 };
    int64_t now_ns = publisher->snapshot->taken_utc_ns;
    int64_t at_ns = quality_is_bad(reading->quality) || !reading->received_utc_ns ? now_ns : reading->received_utc_ns;
    timestamp_print(at_ns / 1000, time);
    if (!quality_is_bad(reading->quality))
        snprintf(value, sizeof(value), "%.15g", reading->value);
    text_add(&text, "{\"value\":%s,\"time\":\"%s\",\"quality\":%u,%s", value, time, reading->quality, topic->unit + 1);
    topic->received_utc_ns = reading->received_utc_ns;
    topic->value = reading->value;
    topic->quality = reading->quality;
    topic->is_published = true;
    bool good = publish(publisher, topic->name, text.at);
    text_finish(&text);
    return good;
}

static bool publish_readings(struct publisher *publisher)
{
    struct snapshot *snapshot = publisher->snapshot;
    bool good = true;
    store_snapshot(publisher->params.store, clock_mono_ns(), clock_utc_ns(), snapshot);
    for (size_t i = 0; i < snapshot->count && good; i++) {
        struct topic *topic = &publisher->topics[i];
        const struct reading *reading = &snapshot->readings[i];
        bool same = topic->received_utc_ns == reading->received_utc_ns && topic->quality == reading->quality;
        if (!topic->is_published || !same || topic->value != reading->value)
            good = publish_reading(publisher, topic, reading);
    }
    return good;
}

static void set_time(json_t *object, const char *key, int64_t utc_ns)
{
    char time[TIMESTAMP_BYTES];
    timestamp_print(utc_ns / 1000, time);
    if (utc_ns)
        json_object_set_new(object, key, json_string(time));
}

static void add_alarm(void *arg, const struct alarm *alarm)
{
    json_t *one = json_pack("{s:s,s:s,s:s,s:i}", alarm->tag < 0 ? "device" : "tag", alarm->name, "kind", alarm_kind_name(alarm->kind),
                            "state", alarm_status_name(alarm_status_of(alarm)), "priority", alarm->priority);
    set_time(one, "raised", alarm->raised_utc_ns);
    set_time(one, "changed", alarm->changed_utc_ns);
    if (!isnan(alarm->value))
        json_object_set_new(one, "value", json_real(alarm->value));
    if (!isnan(alarm->limit))
        json_object_set_new(one, "limit", json_real(alarm->limit));
    json_array_append_new(arg, one);
}

/* Publishes all alarms that are not normal in one message. The broker retains only the last message, so it never shows an ended alarm. */
static bool publish_alarms(struct publisher *publisher)
{
    const struct plant_publish *config = publisher->params.plant->publish;
    uint64_t number = alarm_service_number(publisher->params.alarm_service);
    if (publisher->alarms_published && number == publisher->alarm_number)
        return true;
    json_t *alarms = json_array(), *body = json_pack("{s:o}", "alarms", alarms);
    publisher->alarm_number = alarm_service_changes(publisher->params.alarm_service, 0, add_alarm, alarms);
    set_time(body, "time", clock_utc_ns());
    char *topic = mem_printf("%s/alarms", config->prefix), *text = json_text(body, 15);
    bool good = publisher->alarms_published = publish(publisher, topic, text);
    mem_free(text);
    mem_free(topic);
    return good;
}

/* --- the thread --------------------------------------------------------------------------------------------------------------- */

static void on_connected(void *arg, bool session_present)
{
    struct publisher *publisher = arg;
    const struct plant_publish *config = publisher->params.plant->publish;
    (void)session_present;
    publisher->connected = true;
    publisher->alarms_published = false;
    for (size_t i = 0; i < publisher->params.plant->tag_count; i++)
        publisher->topics[i].is_published = false;
    publish(publisher, config->broker.mqtt.will, "online");
    counter_set(publisher->up, 1);
    log_info(publisher->params.log, "publish: %s:%d: publishing to %s/", config->broker.hosts[0], config->broker.port, config->prefix);
    *publisher->said = 0;
}

static void on_message(void *arg, const struct mqtt_message *message)
{
    (void)arg; /* does nothing: the broker sends no messages, because the publisher subscribes to no topic */
    (void)message;
}

/* Publishes over one connection to the broker until the connection ends. Returns -ECANCELED when the publisher must stop, else
   another negative code with the reason in `why`. */
static int run_session(struct publisher *publisher, char why[200])
{
    const struct plant_publish *config = publisher->params.plant->publish;
    const struct mqtt_client_events events = { .arg = publisher, .connected = on_connected, .message = on_message };
    const int64_t every_ns = (int64_t)(config->every_s * NS_PER_S);
    int64_t deadline_ns = clock_mono_ns() + CONNECT_NS, next_ns = 0;
    publisher->connected = false;
    publisher->client = mqtt_client_start(&config->broker, 0, publisher->address, publisher->client_id, &events, why);
    int status = publisher->client ? mqtt_client_wait(publisher->client, publisher->stop_fd, deadline_ns, why) : -EINVAL;
    publisher->address = mqtt_client_next_address(publisher->address, status);
    while (status == 0) {
        int64_t now_ns = clock_mono_ns(), until_ns = publisher->connected && next_ns > now_ns ? next_ns : now_ns + NS_PER_S / 10;
        status = mqtt_client_serve(publisher->client, publisher->stop_fd, until_ns, why);
        now_ns = clock_mono_ns();
        if (status == 0 && !publisher->connected && now_ns > deadline_ns) {
            snprintf(why, 200, "the broker does not answer");
            status = -ETIMEDOUT;
        }
        if (status == 0 && publisher->connected && now_ns >= next_ns && mqtt_client_has_sent(publisher->client) &&
            publish_alarms(publisher) && publish_readings(publisher))
            next_ns = now_ns + every_ns;
    }
    if (status == -ECANCELED && publisher->connected)
        publish(publisher, config->broker.mqtt.will, "offline");
    mqtt_client_destroy(&publisher->client);
    return status;
}

static void *publisher_main(void *arg)
{
    struct publisher *publisher = arg;
    const struct plant_source *broker = &publisher->params.plant->publish->broker;
    struct backoff backoff = { 0 };
    char why[200] = "";
    while (run_session(publisher, why) != -ECANCELED) {
        int64_t now_ns = clock_mono_ns();
        counter_set(publisher->up, 0);
        if (strcmp(why, publisher->said) != 0)
            log_warn(publisher->params.log, "publish: %s:%d: not publishing: %s", broker->hosts[0], broker->port, why);
        memcpy(publisher->said, why, sizeof(why));
        if (publisher->connected)
            backoff = (struct backoff){ 0 };
        if (wait_for(-1, 0, publisher->stop_fd, now_ns + backoff_next_ns(&backoff, (uint64_t)now_ns)) == -ECANCELED)
            break;
        *why = 0;
    }
    counter_set(publisher->up, 0);
    return NULL;
}

static void make_topics(struct publisher *publisher)
{
    const struct plant *plant = publisher->params.plant;
    publisher->topics = mem_array(plant->tag_count + 1, sizeof(*publisher->topics));
    for (size_t i = 0; i < plant->tag_count; i++) {
        struct text name = { 0 };
        text_add(&name, "%s/tags/", plant->publish->prefix);
        add_level(&name, plant->tags[i].name);
        publisher->topics[i].name = name.at;
        publisher->topics[i].unit = json_text(json_pack("{s:s}", "unit", plant->tags[i].unit ? plant->tags[i].unit : ""), 0);
    }
}

/* Returns the MQTT client id from the plant file. If the file has none, returns a random id, because the broker disconnects a
   client when another one connects with the same id. */
static char *make_client_id(const struct plant_publish *config)
{
    unsigned random = 0;
    if (config->broker.mqtt.client_id)
        return mem_strdup(config->broker.mqtt.client_id);
    (void)!getrandom(&random, sizeof(random), 0);
    return mem_printf("plantcast-out-%08x", random);
}

struct publisher *publisher_start(const struct publisher_params *params)
{
    struct publisher *publisher = mem_new(sizeof(*publisher));
    publisher->params = *params;
    publisher->stop_fd = eventfd(0, EFD_CLOEXEC);
    publisher->client_id = make_client_id(params->plant->publish);
    publisher->snapshot = snapshot_create(params->plant->tag_count);
    publisher->up =
        counters_add(params->counters, "plantcast_publish_up", "gauge", "1 while the MQTT broker accepts published readings and alarms.");
    publisher->messages = counters_add(params->counters, "plantcast_publish_messages_total", "counter",
                                       "Messages with readings or alarms published to the MQTT broker.");
    make_topics(publisher);
    int error = publisher->stop_fd < 0 ? errno : pthread_create(&publisher->thread, NULL, publisher_main, publisher);
    publisher->started = !error;
    if (error) {
        log_err(params->log, "publish: cannot start a thread: %s", strerror(error));
        publisher_stop(&publisher);
    }
    return publisher;
}

void publisher_stop(struct publisher **pointer)
{
    struct publisher *publisher = *pointer;
    if (!publisher)
        return;
    if (publisher->started) {
        eventfd_write(publisher->stop_fd, 1);
        pthread_join(publisher->thread, NULL);
    }
    if (publisher->stop_fd >= 0)
        close(publisher->stop_fd);
    for (size_t i = 0; i < publisher->params.plant->tag_count; i++) {
        mem_free(publisher->topics[i].name);
        mem_free(publisher->topics[i].unit);
    }
    mem_free(publisher->topics);
    mem_free(publisher->client_id);
    snapshot_destroy(&publisher->snapshot);
    mem_free(publisher);
    *pointer = NULL;
}
