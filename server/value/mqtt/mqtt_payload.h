/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads values from MQTT payloads, which are not trusted: plain text, and JSON. No side effects. Call from any thread. */
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
    MQTT_ABSENT, /* the message's payload contains no value for this tag */
    MQTT_WRONG,  /* the value in the payload is not a number: the tag becomes Bad */
};

struct mqtt_reader { /* paths in a JSON payload at which one tag's value, its time and its quality are */
    const struct plant_mqtt *mqtt;
    const char *path; /* JSON path of the value; "": the value is the whole payload, or its member `value` */
    const char *tag;
};

/* Reads a payload that is one number, or true or false, with or without blanks around it. Returns false if it is anything else. */
bool mqtt_number_read(const void *bytes, size_t count, double *out);
/* Parses a payload as JSON. Returns the document, which the caller frees with json_decref(). Returns NULL with the reason in `why` if
   the payload is not JSON, or an object in it has two members with the same name. */
json_t *mqtt_json_parse(const void *bytes, size_t count, char why[200]);
/* Reads a tag's value, quality and time from a JSON document. If it returns MQTT_WRONG, out->quality is the tag's quality and `why` says
   what is wrong. */
enum mqtt_found mqtt_json_read(const json_t *root, const struct mqtt_reader *reader, struct stamped_value *out, char why[200]);

#endif
