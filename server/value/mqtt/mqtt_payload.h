/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads values out of payloads that anybody may have published: text, and JSON. Pure. Thread: any. */
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
    MQTT_ABSENT, /* the payload does not hold the tag's value */
    MQTT_WRONG,  /* it holds something else in its place: the tag is Bad */
};

struct mqtt_reader { /* which value of a JSON payload is read, and for which tag */
    const struct plant_mqtt *mqtt;
    const char *path; /* "": the payload itself, or its member `value` */
    const char *tag;
};

/* Reads a payload that is one number, or true or false, perhaps with blanks around it. Returns false if it is not. */
bool mqtt_number_read(const void *bytes, size_t count, double *out);
/* Parses a payload. Returns NULL if it is not JSON or has a member twice, and says so in `why`; else free with json_decref(). */
json_t *mqtt_json_parse(const void *bytes, size_t count, char why[200]);
/* Reads a tag's value, its quality and its time. Where it returns MQTT_WRONG, out->quality is the tag's and `why` says what is wrong. */
enum mqtt_found mqtt_json_read(const json_t *root, const struct mqtt_reader *reader, struct stamped_value *out, char why[200]);

#endif
