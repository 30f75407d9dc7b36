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

enum mqtt_found { MQTT_FOUND, MQTT_ABSENT /* the payload says nothing of it */, MQTT_WRONG };

/* Reads a payload that is one number, or true or false, perhaps with blanks around it. Returns false if it is not. */
bool mqtt_number_read(const void *bytes, size_t count, double *out);
/* Parses a payload. Returns NULL if it is no JSON, and says in why what is wrong; else free with json_decref(). */
json_t *mqtt_json_parse(const void *bytes, size_t count, char why[200]);
/* Reads the value at a path ("": as the source says), its quality and its time. Where it returns MQTT_WRONG, why says what is wrong. */
enum mqtt_found mqtt_json_read(const json_t *root, const struct plant_mqtt *mqtt, const char *path, struct stamped_value *out,
                               char why[200]);

#endif
