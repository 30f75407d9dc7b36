/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sparkplug B payloads, from bytes that anybody may have sent. Pure. Thread: any. */
#ifndef VALUE_SPARKPLUG_PAYLOAD_H
#define VALUE_SPARKPLUG_PAYLOAD_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum sparkplug_form { /* of a value on the wire */
                      SPARKPLUG_NOTHING,
                      SPARKPLUG_INT,
                      SPARKPLUG_LONG,
                      SPARKPLUG_FLOAT,
                      SPARKPLUG_DOUBLE,
                      SPARKPLUG_BOOLEAN,
                      SPARKPLUG_OTHER
};

struct sparkplug_metric {
    const char *name; /* NULL: by its alias */
    bool has_alias, is_historical, is_null;
    uint64_t alias;
    int64_t utc_ns;   /* of the metric, else of its payload; 0: neither is stated */
    uint32_t type;    /* 0: not stated */
    uint32_t quality; /* by its property Quality; Good without one */
    enum sparkplug_form form;
    union {
        uint64_t whole; /* INT, LONG, BOOLEAN */
        double real;    /* FLOAT, DOUBLE */
    };
};

struct sparkplug_payload {
    struct sparkplug_metric *metrics; /* names live as long as the payload */
    size_t count;
    int seq;    /* 0 to 255; -1: none */
    void *from; /* unpacked */
};

/* Reads a payload. Returns false, with nothing to free, if it is none, and says in why what is wrong. */
bool sparkplug_payload_read(const void *bytes, size_t count, struct sparkplug_payload *out, char why[200]);
void sparkplug_payload_finish(struct sparkplug_payload *payload);
/* Reads the value of a metric of that type (of the metric's own or, where it states none, of its birth). Returns whether it is a number. */
bool sparkplug_number(const struct sparkplug_metric *metric, uint32_t type, double *out);
const char *sparkplug_type_name(uint32_t type); /* returns "Int32" and so on; "a type that is unknown" */
/* Returns the session number of a birth or death certificate; -1 if there is none. */
int64_t sparkplug_bd_seq(const struct sparkplug_payload *payload);

enum { SPARKPLUG_REBIRTH_BYTES = 64 };
/* Writes the payload that asks a node for its birth certificate. Returns its length. */
size_t sparkplug_rebirth_write(uint8_t out[SPARKPLUG_REBIRTH_BYTES], int64_t utc_ns);

#endif
