/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes Sparkplug B payloads, which are not trusted. No side effects. Call from any thread. */
#ifndef VALUE_SPARKPLUG_PAYLOAD_H
#define VALUE_SPARKPLUG_PAYLOAD_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum sparkplug_form { /* form in which a message contains a metric's value */
                      SPARKPLUG_NOTHING,
                      SPARKPLUG_INT,
                      SPARKPLUG_LONG,
                      SPARKPLUG_FLOAT,
                      SPARKPLUG_DOUBLE,
                      SPARKPLUG_BOOLEAN,
                      SPARKPLUG_OTHER
};

struct sparkplug_metric {
    const char *name; /* name of the metric; NULL: the message identifies the metric only by its alias */
    bool has_alias, is_historical, is_null;
    uint64_t alias;
    int64_t utc_ns;   /* UTC time stated by the metric or, if it states none, by its payload; 0: neither states a time */
    uint32_t type;    /* data type of the metric (Sparkplug's number); 0: the message does not state it */
    uint32_t quality; /* quality from the metric's property Quality; Good if it has none */
    enum sparkplug_form form;
    union {
        uint64_t whole; /* value of the metric if `form` is INT, LONG or BOOLEAN */
        double real;    /* value of the metric if `form` is FLOAT or DOUBLE */
    };
};

struct sparkplug_payload {
    struct sparkplug_metric *metrics; /* metrics of the payload; their names are freed with the payload */
    size_t count;
    int seq;    /* sequence number of the message, 0 to 255; -1: the message has none */
    void *from; /* unpacked protobuf message, owned by this struct; contains the names of the metrics */
};

/* Decodes a payload. Returns false with the reason in `why`, and nothing to free, if the bytes are not a valid payload. */
bool sparkplug_payload_read(const void *bytes, size_t count, struct sparkplug_payload *out, char why[200]);
void sparkplug_payload_finish(struct sparkplug_payload *payload);
/* Reads a metric's value as a number. type: the type that the metric states or, if it states none, the type in its birth
   certificate. Returns false if the value is not a number. */
bool sparkplug_number(const struct sparkplug_metric *metric, uint32_t type, double *out);
/* Returns the name of a Sparkplug data type, such as "Int32"; "an unknown type" for a number that is not a type. */
const char *sparkplug_type_name(uint32_t type);
/* Returns the session number (bdSeq) in a birth or death certificate; -1: it has none. */
int64_t sparkplug_bd_seq(const struct sparkplug_payload *payload);

enum { SPARKPLUG_REBIRTH_BYTES = 64 };
/* Writes the payload that asks a node for its birth certificate. Returns its length in bytes. */
size_t sparkplug_rebirth_write(uint8_t out[SPARKPLUG_REBIRTH_BYTES], int64_t utc_ns);

#endif
