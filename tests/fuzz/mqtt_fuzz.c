/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds payloads to all three readers of an MQTT source and to the follower of Sparkplug nodes; the first byte selects one.
   Whatever arrives, the store must hold only numbers or Bad. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/mem.h"
#include "plant/sources/json_path.h"
#include "tests/fuzz/promise.h"
#include "value/mqtt/mqtt_payload.h"
#include "value/mqtt/sparkplug.h"
#include "value/mqtt/sparkplug_payload.h"
#include "value/quality.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

enum { TAGS = 3 };
static const char *const verbs[] = { "NBIRTH/n", "NDATA/n", "NDEATH/n", "DBIRTH/n/d", "DDATA/n/d", "DDEATH/n/d", "NCMD/n", "STATE/n/d/e" };

struct follower {
    struct plant *plant;
    struct log *log;
    struct store *store;
    struct snapshot *snapshot;
    struct mqtt_topics topics;
    struct stamped_writer writer;
    struct sparkplug *sparkplug;
};

static void ask_nobody(void *arg, const char *group, const char *node)
{
    (void)arg;
    require(*group && *node, "who is asked has a name");
}

static struct plant *make_plant(void)
{
    static const char *const metrics[TAGS] = { "a", "b", "a" };
    struct plant *plant = mem_new(sizeof(*plant));
    plant->sources = mem_array(1, sizeof(*plant->sources));
    plant->source_count = 1;
    plant->tags = mem_array(TAGS, sizeof(*plant->tags));
    plant->tag_count = TAGS;
    for (int i = 0; i < TAGS; i++) {
        plant->tags[i].name = mem_printf("t%d", i);
        plant->tags[i].signal.topic = mem_strdup(i < 2 ? "g/n" : "g/n/d");
        plant->tags[i].signal.path = mem_strdup(metrics[i]);
        plant->tags[i].signal.type = DATA_FLOAT64;
        plant->tags[i].validity.stale_s = PLANT_NEVER_STALE_S;
    }
    return plant;
}

static struct follower *follower(void)
{
    static struct follower *f;
    if (f)
        return f;
    f = mem_new(sizeof(*f));
    f->plant = make_plant();
    f->log = log_create(LOG_ERROR);
    f->store = store_create(f->plant);
    f->snapshot = snapshot_create(TAGS);
    mqtt_topics_init(&f->topics, f->plant, 0);
    stamped_writer_init(&f->writer, f->plant, f->store);
    f->sparkplug = sparkplug_create(&(struct sparkplug_params){ .log = f->log,
                                                                .source = "s",
                                                                .plant = f->plant,
                                                                .topics = &f->topics,
                                                                .store = f->store,
                                                                .writer = &f->writer,
                                                                .rebirth = true,
                                                                .ask = ask_nobody });
    return f;
}

/* Feeds a sequence of messages, each preceded by its length and kind. */
static void follow(const uint8_t *bytes, size_t count)
{
    struct follower *f = follower();
    int64_t now_ns = 1000000000000;
    sparkplug_on_subscribed(f->sparkplug, now_ns);
    while (count >= 2) {
        size_t length = bytes[1] < count - 2 ? bytes[1] : count - 2;
        char topic[64] = "spBv1.0/g/", why[200] = "";
        strcat(topic, verbs[bytes[0] % 8]);
        stamped_writer_begin(&f->writer, now_ns, now_ns + 1700000000000000000);
        const struct mqtt_message message = { .topic = topic, .payload = bytes + 2, .count = length, .is_retained = bytes[0] == 255 };
        bool good = sparkplug_take(f->sparkplug, &message, why);
        stamped_writer_end(&f->writer);
        require(good || *why, "a refusal says why");
        bytes += 2 + length;
        count -= 2 + length;
        now_ns += 1000000000;
    }
    store_snapshot(f->store, now_ns, now_ns + 1700000000000000000, f->snapshot);
    for (int i = 0; i < TAGS; i++)
        require(quality_is_bad(f->snapshot->readings[i].quality) || isfinite(f->snapshot->readings[i].value), "a reading is a number");
}

static void read_json(const uint8_t *bytes, size_t count)
{
    static const struct plant_mqtt plain = { .payload = MQTT_JSON },
                                   all = { .payload = MQTT_JSON, .value = "v", .time = "t", .quality = "q" };
    static const char *const paths[] = { "", "a[0].b", "v", "a[?@.id=='x' && @.a[-1]==1]['v']" };
    char why[200] = "";
    struct stamped_value value;
    json_t *root = mqtt_json_parse(bytes, count, why);
    require(root || *why, "a refusal says why");
    for (int i = 0; root && i < 4; i++)
        if (mqtt_json_read(root, &(struct mqtt_reader){ i < 2 ? &plain : &all, paths[i], "T1" }, &value, why) == MQTT_FOUND) {
            require(quality_is_bad(value.quality) || isfinite(value.value), "a value is a number");
            require(value.utc_ns >= 0, "a time is after 1970");
        }
    json_decref(root);
}

/* Splits the input at its first zero byte into a JSON path and a payload, and selects a value from the payload by the path. */
static void select_by_path(const uint8_t *bytes, size_t count)
{
    static const struct plant_mqtt plain = { .payload = MQTT_JSON };
    const uint8_t *end = memchr(bytes, 0, count);
    char why[200] = "";
    struct stamped_value value;
    if (!end)
        return;
    bool good = json_path_check((const char *)bytes, false, why);
    require(good || *why, "a refusal says why");
    json_t *root = good ? mqtt_json_parse(end + 1, (size_t)(bytes + count - end - 1), why) : NULL;
    if (root && mqtt_json_read(root, &(struct mqtt_reader){ &plain, (const char *)bytes, "T1" }, &value, why) == MQTT_FOUND)
        require(quality_is_bad(value.quality) || isfinite(value.value), "a value is a number");
    json_decref(root);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    double number = 0;
    struct sparkplug_payload payload;
    char why[200];
    if (count == 0)
        return 0;
    if (mqtt_number_read(bytes + 1, count - 1, &number))
        require(isfinite(number), "a number is finite");
    read_json(bytes + 1, count - 1);
    select_by_path(bytes + 1, count - 1);
    if (sparkplug_payload_read(bytes + 1, count - 1, &payload, why))
        sparkplug_payload_finish(&payload);
    follow(bytes, count);
    return 0;
}
