/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads values out of untrusted MQTT payloads: plain text, and JSON. Pure. Thread: any. */
#ifndef VALUE_MQTT_PAYLOAD_H
#define VALUE_MQTT_PAYLOAD_H
#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"
#include "value/stamped_writer.h"

enum mqtt_found {
    MQTT_FOUND,
    MQTT_ABSENT, /* the payload does not contain the tag's value */
    MQTT_WRONG,  /* the payload has something other than a number in the value's place: the tag becomes Bad */
};

struct mqtt_reader { /* selects the value of one tag in a JSON payload */
    const struct plant_mqtt *mqtt;
    const char *path; /* JSON path of the value; "": the payload itself, or its member `value` */
    const char *tag;
};

/* Reads a payload that is one number, or true or false, perhaps surrounded by blanks. Returns false if it is anything else. */
bool mqtt_number_read(const void *bytes, size_t count, double *out);
/* Parses a payload. Returns NULL with the reason in `why` if it is not JSON or repeats a member; else the caller frees it with
   json_decref(). */
json_t *mqtt_json_parse(const void *bytes, size_t count, char why[200]);
/* Reads a tag's value, quality and time. If it returns MQTT_WRONG, out->quality is the tag's quality and `why` says what is wrong. */
enum mqtt_found mqtt_json_read(const json_t *root, const struct mqtt_reader *reader, struct stamped_value *out, char why[200]);

#endif
