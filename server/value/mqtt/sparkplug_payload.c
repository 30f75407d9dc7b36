/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unpacks Sparkplug payloads with protobuf-c. Its allocator has a byte limit, because two bytes of a message may take two hundred bytes
   of memory. */
#include "value/mqtt/sparkplug_payload.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sparkplug_b.pb-c.h"
#include "value/quality.h"

enum { MAX_UNPACKED_BYTES = 64 << 20 }; /* memory limit of one unpacked payload */
enum { TYPE_INT8 = 1, TYPE_INT16, TYPE_INT32, TYPE_INT64, TYPE_UINT8, TYPE_UINT16, TYPE_UINT32, TYPE_UINT64, TYPE_FLOAT, TYPE_DOUBLE,
       TYPE_BOOLEAN };

static const char *const type_names[] = { [TYPE_INT8] = "Int8",     [TYPE_INT16] = "Int16",   [TYPE_INT32] = "Int32",
                                          [TYPE_INT64] = "Int64",   [TYPE_UINT8] = "UInt8",   [TYPE_UINT16] = "UInt16",
                                          [TYPE_UINT32] = "UInt32", [TYPE_UINT64] = "UInt64", [TYPE_FLOAT] = "Float",
                                          [TYPE_DOUBLE] = "Double", [TYPE_BOOLEAN] = "Boolean", "String", "DateTime", "Text", "UUID",
                                          "DataSet", "Bytes", "File", "Template", "PropertySet", "PropertySetList" };

const char *sparkplug_type_name(uint32_t type)
{
    return type > 0 && type < sizeof(type_names) / sizeof(*type_names) ? type_names[type] : "an unknown type";
}

/* --- memory ----------------------------------------------------------------------------------------------------------------- */

static void *take(void *arg, size_t bytes)
{
    size_t *left = arg;
    if (bytes > *left)
        return NULL;
    *left -= bytes;
    return malloc(bytes);
}

static void give_back(void *arg, void *p)
{
    (void)arg;
    free(p);
}

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

/* Converts milliseconds since 1970 to nanoseconds. Returns 0 if there is no time (`has` false) or it is out of range. */
static int64_t ns_of_ms(bool has, uint64_t ms)
{
    return has && ms <= INT64_MAX / 1000000 ? (int64_t)ms * 1000000 : 0;
}

/* Converts a metric's property Quality, with Sparkplug's codes (192 good, 0 bad, 500 stale), to an OPC UA status code. */
static uint32_t quality_of(const Sparkplug__Payload__PropertySet *set)
{
    for (size_t i = 0; set && i < set->n_keys && i < set->n_values; i++) {
        const Sparkplug__Payload__PropertyValue *value = set->values[i];
        if (strcmp(set->keys[i], "Quality") != 0)
            continue;
        uint64_t code = value->value_case == SPARKPLUG__PAYLOAD__PROPERTY_VALUE__VALUE_INT_VALUE    ? value->int_value
                        : value->value_case == SPARKPLUG__PAYLOAD__PROPERTY_VALUE__VALUE_LONG_VALUE ? value->long_value
                                                                                                    : 1;
        return code == 192 ? QUALITY_GOOD : code == 0 ? QUALITY_BAD : code == 500 ? QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE
                                                                                  : QUALITY_UNCERTAIN;
    }
    return QUALITY_GOOD;
}

static void read_value(const Sparkplug__Payload__Metric *from, struct sparkplug_metric *out)
{
    switch (from->value_case) {
    case SPARKPLUG__PAYLOAD__METRIC__VALUE__NOT_SET:
        out->form = SPARKPLUG_NOTHING;
        break;
    case SPARKPLUG__PAYLOAD__METRIC__VALUE_INT_VALUE:
        out->form = SPARKPLUG_INT;
        out->whole = from->int_value;
        break;
    case SPARKPLUG__PAYLOAD__METRIC__VALUE_LONG_VALUE:
        out->form = SPARKPLUG_LONG;
        out->whole = from->long_value;
        break;
    case SPARKPLUG__PAYLOAD__METRIC__VALUE_FLOAT_VALUE:
        out->form = SPARKPLUG_FLOAT;
        out->real = (double)from->float_value;
        break;
    case SPARKPLUG__PAYLOAD__METRIC__VALUE_DOUBLE_VALUE:
        out->form = SPARKPLUG_DOUBLE;
        out->real = from->double_value;
        break;
    case SPARKPLUG__PAYLOAD__METRIC__VALUE_BOOLEAN_VALUE:
        out->form = SPARKPLUG_BOOLEAN;
        out->whole = from->boolean_value != 0;
        break;
    default:
        out->form = SPARKPLUG_OTHER;
    }
}

static void read_metric(const Sparkplug__Payload *payload, const Sparkplug__Payload__Metric *from, struct sparkplug_metric *out)
{
    int64_t utc_ns = ns_of_ms(from->has_timestamp, from->timestamp);
    *out = (struct sparkplug_metric){
        .name = from->name && *from->name ? from->name : NULL,
        .has_alias = from->has_alias,
        .alias = from->alias,
        .is_historical = from->has_is_historical && from->is_historical,
        .is_null = from->has_is_null && from->is_null,
        .utc_ns = utc_ns ? utc_ns : ns_of_ms(payload->has_timestamp, payload->timestamp),
        .type = from->has_datatype ? from->datatype : 0,
        .quality = quality_of(from->properties),
    };
    read_value(from, out);
}

bool sparkplug_payload_read(const void *bytes, size_t count, struct sparkplug_payload *out, char why[200])
{
    size_t left = MAX_UNPACKED_BYTES;
    ProtobufCAllocator allocator = { .alloc = take, .free = give_back, .allocator_data = &left };
    Sparkplug__Payload *payload = sparkplug__payload__unpack(&allocator, count, bytes);
    struct sparkplug_metric *metrics = payload ? mem_try_array(payload->n_metrics + 1, sizeof(*metrics)) : NULL;
    *out = (struct sparkplug_payload){ .seq = -1 };
    if (!metrics) {
        if (payload || left < MAX_UNPACKED_BYTES / 2)
            snprintf(why, 200, "decoding its Sparkplug metrics takes more than %d MiB of memory: publish fewer metrics in one message",
                     MAX_UNPACKED_BYTES >> 20);
        else
            snprintf(why, 200, "not a Sparkplug B payload");
        if (payload)
            sparkplug__payload__free_unpacked(payload, &allocator);
        return false;
    }
    if (payload->uuid && !strcmp(payload->uuid, "SPBV1.0_COMPRESSED")) {
        snprintf(why, 200, "compressed Sparkplug payloads are not supported: switch compression off in the node");
        sparkplug__payload__free_unpacked(payload, &allocator);
        mem_free(metrics);
        return false;
    }
    for (size_t i = 0; i < payload->n_metrics; i++)
        read_metric(payload, payload->metrics[i], &metrics[i]);
    out->metrics = metrics;
    out->count = payload->n_metrics;
    out->seq = payload->has_seq && payload->seq <= 255 ? (int)payload->seq : -1;
    out->from = payload;
    return true;
}

void sparkplug_payload_finish(struct sparkplug_payload *payload)
{
    ProtobufCAllocator allocator = { .alloc = take, .free = give_back };
    if (payload->from)
        sparkplug__payload__free_unpacked(payload->from, &allocator);
    mem_free(payload->metrics);
    *payload = (struct sparkplug_payload){ 0 };
}

/* --- values ----------------------------------------------------------------------------------------------------------------- */

/* Returns a metric's integer. Sparkplug sends the integer's bytes as an unsigned number, so a negative one is sign-extended only to the
   width of its type. */
static double whole_of(const struct sparkplug_metric *metric, uint32_t type)
{
    switch (type) {
    case TYPE_INT8: return (int8_t)metric->whole;
    case TYPE_INT16: return (int16_t)metric->whole;
    case TYPE_INT32: return (int32_t)metric->whole;
    case TYPE_INT64: return metric->form == SPARKPLUG_INT ? (double)metric->whole : (double)(int64_t)metric->whole;
    case TYPE_UINT8: return (uint8_t)metric->whole;
    case TYPE_UINT16: return (uint16_t)metric->whole;
    case TYPE_UINT32: return (uint32_t)metric->whole;
    default: return (double)metric->whole;
    }
}

bool sparkplug_number(const struct sparkplug_metric *metric, uint32_t type, double *out)
{
    bool is_whole = metric->form == SPARKPLUG_INT || metric->form == SPARKPLUG_LONG;
    bool is_real = metric->form == SPARKPLUG_FLOAT || metric->form == SPARKPLUG_DOUBLE;
    if (type >= TYPE_INT8 && type <= TYPE_UINT64 && is_whole)
        *out = whole_of(metric, type);
    else if ((type == TYPE_FLOAT || type == TYPE_DOUBLE) && is_real)
        *out = metric->real;
    else if (type == TYPE_BOOLEAN && metric->form == SPARKPLUG_BOOLEAN)
        *out = (double)metric->whole;
    else
        return false;
    return true;
}

int64_t sparkplug_bd_seq(const struct sparkplug_payload *payload)
{
    for (size_t i = 0; i < payload->count; i++) {
        const struct sparkplug_metric *metric = &payload->metrics[i];
        bool is_whole = metric->form == SPARKPLUG_INT || metric->form == SPARKPLUG_LONG;
        if (metric->name && !strcmp(metric->name, "bdSeq") && is_whole && metric->whole <= INT64_MAX)
            return (int64_t)metric->whole;
    }
    return -1;
}

size_t sparkplug_rebirth_write(uint8_t out[SPARKPLUG_REBIRTH_BYTES], int64_t utc_ns)
{
    Sparkplug__Payload payload = SPARKPLUG__PAYLOAD__INIT;
    Sparkplug__Payload__Metric metric = SPARKPLUG__PAYLOAD__METRIC__INIT, *metrics = &metric;
    metric.name = (char[]){ "Node Control/Rebirth" };
    metric.has_datatype = true;
    metric.datatype = TYPE_BOOLEAN;
    metric.value_case = SPARKPLUG__PAYLOAD__METRIC__VALUE_BOOLEAN_VALUE;
    metric.boolean_value = true;
    payload.has_timestamp = true;
    payload.timestamp = (uint64_t)(utc_ns / 1000000);
    payload.n_metrics = 1;
    payload.metrics = &metrics;
    return sparkplug__payload__pack(&payload, out);
}
