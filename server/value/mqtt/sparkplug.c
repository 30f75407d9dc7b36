/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Processes the birth and death certificates and the data messages of Sparkplug nodes. A node's readings are valid from its birth to its
   death. A device's readings are valid only while its node is alive too. */
#include "value/mqtt/sparkplug.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"
#include "plant/sources/mqtt_address.h"
#include "value/mqtt/sparkplug_payload.h"
#include "value/quality.h"

static const int64_t ASK_NS = 10 * NS_PER_S; /* minimum time between two requests to one node for its birth certificate */
static const char PREFIX[] = "spBv1.0/";

struct alias {
    uint64_t number;
    size_t topic; /* index of the node's or device's topic, whose birth certificate defined the alias */
    /* tags of that topic that take their values from the metric with this alias: index of the first, and their number */
    size_t first_tag, tags;
};

struct sparkplug_node {
    char *group, *name;
    bool is_born;
    bool told;      /* true: the log already says that this node sends values before its birth certificate */
    int64_t bd_seq; /* session number (bdSeq) of the node's birth certificate; -1: none */
    int next_seq;
    int64_t asked_ns;      /* monotonic time of the last birth request; 0: never */
    bool is_wanted;        /* true: a request for the birth certificate must be sent once ASK_NS have passed since the last one */
    /* aliases of the node and its devices, sorted by number, then by topic: the topic distinguishes devices, because some nodes
       number the metrics of each device from 1 */
    struct alias *aliases;
    size_t alias_count, alias_capacity;
};

struct sparkplug {
    struct sparkplug_params params;
    struct sparkplug_node *nodes;
    size_t node_count;
    size_t *node_of; /* by topic: index of the node that the topic belongs to */
    /* by topic: true while the node or device is alive (its birth certificate has arrived, and no death certificate since) */
    bool *is_born;
    uint32_t *types; /* by tag: data type of its metric, as the birth certificate states it; 0: no birth certificate contains the metric */
    struct stamped_value *last; /* last value, by tag */
    /* by tag. has_last: `last` is set; in_message: the message that is being processed has a value of the tag */
    bool *has_last, *in_message;
};

enum verb { NBIRTH, NDEATH, NDATA, DBIRTH, DDEATH, DDATA, OTHER };
static const char *const verbs[] = { "NBIRTH", "NDEATH", "NDATA", "DBIRTH", "DDEATH", "DDATA" };

/* --- nodes and topics ------------------------------------------------------------------------------------------------------- */

/* Finds a node by group and name. A linear search suffices, because there are few nodes, and each message needs only one search. */
static struct sparkplug_node *find_node(const struct sparkplug *sparkplug, const char *group, size_t group_length, const char *name,
                                        size_t length)
{
    for (size_t i = 0; i < sparkplug->node_count; i++) {
        struct sparkplug_node *node = &sparkplug->nodes[i];
        if (!strncmp(node->name, name, length) && !node->name[length] && !strncmp(node->group, group, group_length) &&
            !node->group[group_length])
            return node;
    }
    return NULL;
}

static void add_node(struct sparkplug *sparkplug, size_t topic)
{
    const char *group = sparkplug->params.topics->at[topic].name, *name = strchr(group, '/') + 1;
    size_t group_length = (size_t)(name - 1 - group), length = strcspn(name, "/");
    struct sparkplug_node *node = find_node(sparkplug, group, group_length, name, length);
    if (!node) {
        node = &sparkplug->nodes[sparkplug->node_count++];
        node->group = mem_printf("%.*s", (int)group_length, group);
        node->name = mem_printf("%.*s", (int)length, name);
    }
    sparkplug->node_of[topic] = (size_t)(node - sparkplug->nodes);
}

struct sparkplug *sparkplug_create(const struct sparkplug_params *params)
{
    struct sparkplug *sparkplug = mem_new(sizeof(*sparkplug));
    size_t topics = params->topics->count, tags = params->plant->tag_count;
    sparkplug->params = *params;
    sparkplug->nodes = mem_array(topics, sizeof(*sparkplug->nodes));
    sparkplug->node_of = mem_array(topics, sizeof(*sparkplug->node_of));
    sparkplug->is_born = mem_array(topics, sizeof(*sparkplug->is_born));
    sparkplug->types = mem_array(tags, sizeof(*sparkplug->types));
    sparkplug->last = mem_array(tags, sizeof(*sparkplug->last));
    sparkplug->has_last = mem_array(tags, sizeof(*sparkplug->has_last));
    sparkplug->in_message = mem_array(tags, sizeof(*sparkplug->in_message));
    for (size_t i = 0; i < topics; i++)
        add_node(sparkplug, i);
    return sparkplug;
}

void sparkplug_destroy(struct sparkplug **sparkplug)
{
    struct sparkplug *gone = *sparkplug;
    *sparkplug = NULL;
    if (!gone)
        return;
    for (size_t i = 0; i < gone->node_count; i++) {
        mem_free(gone->nodes[i].group);
        mem_free(gone->nodes[i].name);
        mem_free(gone->nodes[i].aliases);
    }
    void *const arrays[] = { gone->nodes, gone->node_of, gone->is_born, gone->types, gone->last, gone->has_last, gone->in_message };
    for (size_t i = 0; i < sizeof(arrays) / sizeof(*arrays); i++)
        mem_free(arrays[i]);
    mem_free(gone);
}

/* Returns topic filters for all messages of each node and its devices. Devices without tags are included, because a node and
   its devices share one sequence number. */
char **sparkplug_subscriptions(const struct sparkplug *sparkplug, size_t *count)
{
    char **names = mem_array(sparkplug->node_count, sizeof(*names));
    *count = sparkplug->node_count;
    for (size_t i = 0; i < sparkplug->node_count; i++)
        names[i] = mem_printf("%s%s/+/%s/#", PREFIX, sparkplug->nodes[i].group, sparkplug->nodes[i].name);
    return names;
}

/* --- birth and death -------------------------------------------------------------------------------------------------------- */

static void ask(struct sparkplug *sparkplug, struct sparkplug_node *node, int64_t now_ns)
{
    node->is_wanted = sparkplug->params.rebirth;
    if (!node->is_wanted || (node->asked_ns && now_ns - node->asked_ns < ASK_NS))
        return;
    node->is_wanted = false;
    node->asked_ns = now_ns;
    log_info(sparkplug->params.log, "source %s: node %s/%s: requesting the Sparkplug birth certificate, which lists the node's metrics",
             sparkplug->params.source, node->group, node->name);
    sparkplug->params.ask(sparkplug->params.arg, node->group, node->name);
}

void sparkplug_on_tick(struct sparkplug *sparkplug, int64_t now_mono_ns)
{
    for (size_t i = 0; i < sparkplug->node_count; i++)
        if (sparkplug->nodes[i].is_wanted)
            ask(sparkplug, &sparkplug->nodes[i], now_mono_ns);
}

static void forget(struct sparkplug *sparkplug, struct sparkplug_node *node)
{
    node->is_born = false;
    node->alias_count = 0;
    for (size_t i = 0; i < sparkplug->params.topics->count; i++)
        if (&sparkplug->nodes[sparkplug->node_of[i]] == node)
            sparkplug->is_born[i] = false;
}

void sparkplug_on_subscribed(struct sparkplug *sparkplug, int64_t now_mono_ns)
{
    for (size_t i = 0; i < sparkplug->node_count; i++) {
        forget(sparkplug, &sparkplug->nodes[i]);
        sparkplug->nodes[i].told = false;
        sparkplug->nodes[i].asked_ns = 0;
        ask(sparkplug, &sparkplug->nodes[i], now_mono_ns);
    }
}

static void topic_dies(struct sparkplug *sparkplug, size_t topic)
{
    const struct mqtt_topic *dead = &sparkplug->params.topics->at[topic];
    sparkplug->is_born[topic] = false;
    store_tags_dead(sparkplug->params.store, dead->tags, dead->tag_count, sparkplug->params.writer->mono_ns);
}

/* Marks a node and all its devices as dead, and their tags as lost. spared: index of a topic that is not marked, because its birth
   certificate is being processed; SIZE_MAX: none. */
static void node_dies(struct sparkplug *sparkplug, struct sparkplug_node *node, size_t spared)
{
    for (size_t i = 0; i < sparkplug->params.topics->count; i++)
        if (&sparkplug->nodes[sparkplug->node_of[i]] == node && i != spared)
            topic_dies(sparkplug, i);
    forget(sparkplug, node);
}

/* --- metrics ---------------------------------------------------------------------------------------------------------------- */

/* Finds the tags of a topic that take their values from the metric with this name; they are adjacent in the topic's list of tags.
   Returns their number; *first receives the index of the first. */
static size_t tags_named(const struct sparkplug *sparkplug, size_t topic, const char *name, size_t *first)
{
    const struct mqtt_topic *of = &sparkplug->params.topics->at[topic];
    const struct plant_tag *tags = sparkplug->params.plant->tags;
    size_t at, end;
    search_sorted(at, of->tag_count, strcmp(tags[of->tags[at]].signal.path, name) < 0);
    for (end = at; end < of->tag_count && !strcmp(tags[of->tags[end]].signal.path, name);)
        end++;
    *first = at;
    return end - at;
}

static int by_number(const void *pa, const void *pb)
{
    const struct alias *a = pa, *b = pb;
    int order = (a->number > b->number) - (a->number < b->number);
    return order ? order : (a->topic > b->topic) - (a->topic < b->topic);
}

static void drop_aliases(struct sparkplug_node *node, size_t topic)
{
    size_t kept = 0;
    for (size_t i = 0; i < node->alias_count; i++)
        if (node->aliases[i].topic != topic)
            node->aliases[kept++] = node->aliases[i];
    node->alias_count = kept;
}

/* Finds the tags that take their values from a metric, by its name or, if it states none, by its alias. Returns their number, which
   is 0 for most metrics. */
static size_t tags_of(const struct sparkplug *sparkplug, const struct sparkplug_node *node, size_t topic,
                      const struct sparkplug_metric *metric, size_t *first)
{
    if (metric->name)
        return tags_named(sparkplug, topic, metric->name, first);
    const struct alias wanted = { .number = metric->alias, .topic = topic };
    const struct alias *alias =
        metric->has_alias && node->alias_count > 0 ? bsearch(&wanted, node->aliases, node->alias_count, sizeof(wanted), by_number) : NULL;
    if (!alias)
        return 0;
    *first = alias->first_tag;
    return alias->tags;
}

static void write_value(struct sparkplug *sparkplug, int tag, const struct stamped_value *value)
{
    sparkplug->last[tag] = *value;
    sparkplug->has_last[tag] = !quality_is_bad(value->quality);
    sparkplug->in_message[tag] = true;
    stamped_writer_add(sparkplug->params.writer, tag, value, false, true);
}

/* Writes a metric's value to a tag. Returns false if the metric's type differs from that in the birth certificate, or its value is
   not a number. */
static bool take_metric(struct sparkplug *sparkplug, const struct sparkplug_metric *metric, int tag, char why[200])
{
    struct stamped_value value = { .quality = metric->quality, .utc_ns = metric->utc_ns };
    uint32_t born = sparkplug->types[tag], type = metric->type ? metric->type : born;
    const char *name = sparkplug->params.plant->tags[tag].signal.path;
    if (metric->is_null && !quality_is_bad(value.quality))
        value.quality = QUALITY_BAD_SENSOR_FAILURE;
    bool good = type == born && (quality_is_bad(value.quality) || sparkplug_number(metric, type, &value.value));
    if (!good && type != born)
        snprintf(why, 200, "Sparkplug metric %.60s had type %s in the birth certificate, and now has %s", name, sparkplug_type_name(born),
                 sparkplug_type_name(type));
    else if (!good)
        snprintf(why, 200, "Sparkplug metric %.60s has type %s, which is not a number", name, sparkplug_type_name(type));
    if (!good)
        value.quality = QUALITY_BAD_CONFIGURATION;
    write_value(sparkplug, tag, &value);
    return good;
}

/* Writes the metrics of a payload to their tags. Returns false if a metric is wrong, with the reason in `why`; the tags of that metric
   become Bad. */
static bool take_metrics(struct sparkplug *sparkplug, const struct sparkplug_node *node, size_t topic,
                         const struct sparkplug_payload *payload, char why[200])
{
    const struct mqtt_topic *of = &sparkplug->params.topics->at[topic];
    bool all_good = true;
    for (size_t i = 0; i < payload->count; i++) {
        const struct sparkplug_metric *metric = &payload->metrics[i];
        size_t first = 0, count = tags_of(sparkplug, node, topic, metric, &first);
        if (metric->is_historical && count > 0 && sparkplug->params.historical)
            counter_inc(sparkplug->params.historical, 1);
        for (size_t t = 0; t < count && !metric->is_historical; t++)
            all_good &= take_metric(sparkplug, metric, of->tags[first + t], why);
    }
    return all_good;
}

/* Records the types and aliases of the metrics that a birth certificate states. */
static void learn(struct sparkplug *sparkplug, struct sparkplug_node *node, size_t topic, const struct sparkplug_payload *payload)
{
    const struct mqtt_topic *of = &sparkplug->params.topics->at[topic];
    drop_aliases(node, topic);
    for (size_t i = 0; i < of->tag_count; i++)
        sparkplug->types[of->tags[i]] = 0;
    for (size_t i = 0; i < payload->count; i++) {
        const struct sparkplug_metric *metric = &payload->metrics[i];
        size_t first = 0, count = metric->name ? tags_named(sparkplug, topic, metric->name, &first) : 0;
        for (size_t t = 0; t < count; t++)
            sparkplug->types[of->tags[first + t]] = metric->type;
        if (count == 0 || !metric->has_alias || node->alias_count > sparkplug->params.plant->tag_count)
            continue;
        mem_grow(&node->aliases, &node->alias_capacity, node->alias_count + 1, sizeof(*node->aliases));
        node->aliases[node->alias_count++] = (struct alias){ metric->alias, topic, first, count };
    }
    if (node->alias_count > 0)
        qsort(node->aliases, node->alias_count, sizeof(*node->aliases), by_number);
}

/* Processes a birth certificate of a node or device. Tags whose metric is not in the certificate become Bad_ConfigurationError. Returns
   false, with the reason in `why`, if the certificate is refused. */
static bool take_birth(struct sparkplug *sparkplug, struct sparkplug_node *node, size_t topic, const struct sparkplug_payload *payload,
                       char why[200])
{
    const struct mqtt_topic *of = &sparkplug->params.topics->at[topic];
    size_t missing = 0;
    int first = 0;
    learn(sparkplug, node, topic, payload);
    sparkplug->is_born[topic] = true;
    /* also forgets the last values: a tag whose metric is not in the certificate must not get one back after a gap (doubt_all()) */
    for (size_t i = 0; i < of->tag_count; i++)
        sparkplug->in_message[of->tags[i]] = sparkplug->has_last[of->tags[i]] = false;
    bool good = take_metrics(sparkplug, node, topic, payload, why);
    for (size_t i = 0; i < of->tag_count; i++) {
        int tag = of->tags[i];
        if (sparkplug->in_message[tag])
            continue;
        if (missing++ == 0)
            first = tag;
        stamped_writer_add_bad(sparkplug->params.writer, tag, QUALITY_BAD_CONFIGURATION);
    }
    if (missing > 0)
        log_warn(sparkplug->params.log, "source %s: %s: the Sparkplug birth certificate has no metric '%.60s'%s", sparkplug->params.source,
                 of->name, sparkplug->params.plant->tags[first].signal.path, missing > 1 ? ", nor metrics of other tags" : "");
    return good;
}

/* --- sequence numbers ------------------------------------------------------------------------------------------------------- */

/* Makes all readings of a node uncertain, because messages with newer values were lost. */
static void doubt_all(struct sparkplug *sparkplug, const struct sparkplug_node *node)
{
    for (size_t i = 0; i < sparkplug->params.topics->count; i++) {
        const struct mqtt_topic *topic = &sparkplug->params.topics->at[i];
        if (&sparkplug->nodes[sparkplug->node_of[i]] != node || !sparkplug->is_born[i])
            continue;
        for (size_t t = 0; t < topic->tag_count; t++) {
            int tag = topic->tags[t];
            struct stamped_value value = sparkplug->last[tag];
            if (!sparkplug->has_last[tag])
                continue;
            value.quality = QUALITY_UNCERTAIN_LAST_USABLE;
            value.utc_ns = sparkplug->params.writer->last[tag].utc_ns;
            stamped_writer_add(sparkplug->params.writer, tag, &value, true, true);
        }
    }
}

static void follow(struct sparkplug *sparkplug, struct sparkplug_node *node, const struct sparkplug_payload *payload)
{
    int seq = payload->seq, wanted = node->next_seq;
    node->next_seq = (seq + 1) % 256;
    if (seq == wanted)
        return;
    if (sparkplug->params.gaps)
        counter_inc(sparkplug->params.gaps, 1);
    log_warn(sparkplug->params.log, "source %s: node %s/%s: Sparkplug messages were lost: received sequence number %d, expected %d",
             sparkplug->params.source, node->group, node->name, seq, wanted);
    doubt_all(sparkplug, node);
    ask(sparkplug, node, sparkplug->params.writer->mono_ns);
}

/* --- messages --------------------------------------------------------------------------------------------------------------- */

struct said {
    enum verb verb;
    struct sparkplug_node *node;
    size_t topic; /* index of the topic of the node or device; SIZE_MAX: no tag of the plant has this topic */
};

/* Parses a topic spBv1.0/GROUP/VERB/NODE[/DEVICE]. Returns false if the topic has another form. */
static bool read_topic(const struct sparkplug *sparkplug, const char *topic, struct said *out)
{
    const char *at[4]; /* group, verb, node, device */
    size_t length[4] = { 0 };
    int parts = 0;
    if (strncmp(topic, PREFIX, strlen(PREFIX)) != 0)
        return false;
    for (const char *p = topic + strlen(PREFIX) - 1; p && parts < 4; p = strchr(p, '/'), parts++) {
        at[parts] = ++p;
        length[parts] = strcspn(p, "/");
    }
    if (parts < 3 || length[0] + length[2] + length[3] > MQTT_TOPIC_BYTES)
        return false;
    *out = (struct said){ .verb = NBIRTH, .node = find_node(sparkplug, at[0], length[0], at[2], length[2]), .topic = SIZE_MAX };
    while (out->verb < OTHER && (strlen(verbs[out->verb]) != length[1] || strncmp(verbs[out->verb], at[1], length[1]) != 0))
        out->verb++;
    if (!out->node || (out->verb != OTHER && (parts == 4) != (out->verb >= DBIRTH)))
        return false;
    char *name = mem_printf("%.*s/%.*s%s%.*s", (int)length[0], at[0], (int)length[2], at[2], parts == 4 ? "/" : "", (int)length[3],
                            parts == 4 ? at[3] : "");
    const struct mqtt_topic *found = mqtt_topics_find(sparkplug->params.topics, name);
    if (found)
        out->topic = (size_t)(found - sparkplug->params.topics->at);
    mem_free(name);
    return true;
}

/* Refuses a message of a node or device whose birth certificate has not arrived: the node may be dead, and its aliases are unknown.
   Requests the birth certificate. */
static bool refuse_unborn(struct sparkplug *sparkplug, struct sparkplug_node *node, char why[200])
{
    ask(sparkplug, node, sparkplug->params.writer->mono_ns);
    if (!node->told)
        log_warn(sparkplug->params.log,
                 "source %s: node %s/%s: values ignored, because the node has not sent a Sparkplug birth certificate yet%s",
                 sparkplug->params.source, node->group, node->name, sparkplug->params.rebirth ? "" : "; `rebirth: yes` requests it");
    node->told = true;
    snprintf(why, 200, "the message came before the node's Sparkplug birth certificate");
    return false;
}

static bool take_node_birth(struct sparkplug *sparkplug, const struct said *said, const struct sparkplug_payload *payload, char why[200])
{
    struct sparkplug_node *node = said->node;
    /* first marks the node and its devices as dead, because their earlier birth certificates are no longer valid */
    node_dies(sparkplug, node, said->topic);
    node->is_born = true;
    node->told = node->is_wanted = false;
    node->bd_seq = sparkplug_bd_seq(payload);
    node->next_seq = (payload->seq + 1) % 256;
    log_info(sparkplug->params.log, "source %s: node %s/%s: online (Sparkplug birth certificate received)", sparkplug->params.source,
             node->group, node->name);
    return said->topic == SIZE_MAX || take_birth(sparkplug, node, said->topic, payload, why);
}

static bool take_node_death(struct sparkplug *sparkplug, struct sparkplug_node *node, const struct sparkplug_payload *payload)
{
    int64_t bd_seq = sparkplug_bd_seq(payload);
    if (!node->is_born)
        return true;
    if (bd_seq >= 0 && node->bd_seq >= 0 && bd_seq != node->bd_seq) {
        log_info(sparkplug->params.log,
                 "source %s: node %s/%s: an old Sparkplug death certificate (bdSeq %lld; the birth certificate has %lld) is ignored",
                 sparkplug->params.source, node->group, node->name, (long long)bd_seq, (long long)node->bd_seq);
        return true;
    }
    log_warn(sparkplug->params.log, "source %s: node %s/%s: offline (Sparkplug death certificate received)", sparkplug->params.source,
             node->group, node->name);
    node_dies(sparkplug, node, SIZE_MAX);
    return true;
}

/* Processes a message of a node that is alive, or of its devices, after checking the sequence number. The node's own birth and death
   certificates are not passed to this function. */
static bool take_in_order(struct sparkplug *sparkplug, const struct said *said, const struct sparkplug_payload *payload, char why[200])
{
    follow(sparkplug, said->node, payload);
    if (said->topic == SIZE_MAX)
        return true;
    if (said->verb == DBIRTH)
        return take_birth(sparkplug, said->node, said->topic, payload, why);
    if (said->verb == DDEATH) {
        log_warn(sparkplug->params.log, "source %s: device %s: offline (Sparkplug death certificate received)", sparkplug->params.source,
                 sparkplug->params.topics->at[said->topic].name);
        topic_dies(sparkplug, said->topic);
        return true;
    }
    if (!sparkplug->is_born[said->topic])
        return refuse_unborn(sparkplug, said->node, why);
    return take_metrics(sparkplug, said->node, said->topic, payload, why);
}

bool sparkplug_take(struct sparkplug *sparkplug, const struct mqtt_message *message, char why[200])
{
    struct sparkplug_payload payload;
    struct said said;
    snprintf(why, 200, "the topic is not a topic of Sparkplug B");
    if (!read_topic(sparkplug, message->topic, &said))
        return false;
    if (said.verb == OTHER) /* NCMD and DCMD: commands that other programs send to nodes */
        return true;
    snprintf(why, 200, "retained messages are ignored, because they may be old");
    if (message->is_retained)
        return false;
    snprintf(why, 200, "longer than %d MiB", MQTT_MAX_PAYLOAD >> 20);
    if (message->count > MQTT_MAX_PAYLOAD || !sparkplug_payload_read(message->payload, message->count, &payload, why))
        return false;
    bool good = said.verb == NDEATH || payload.seq >= 0;
    if (!good)
        snprintf(why, 200, "the message has no Sparkplug sequence number (seq)");
    else if (said.verb == NBIRTH)
        good = take_node_birth(sparkplug, &said, &payload, why);
    else if (said.verb == NDEATH)
        good = take_node_death(sparkplug, said.node, &payload);
    else
        good = said.node->is_born ? take_in_order(sparkplug, &said, &payload, why) : refuse_unborn(sparkplug, said.node, why);
    sparkplug_payload_finish(&payload);
    return good;
}
