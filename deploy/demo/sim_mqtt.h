/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Publishes the values of tags of MQTT sources, as numbers or JSON, to one broker. Call from one thread only; the library has a
   thread of its own. */
#ifndef DEMO_SIM_MQTT_H
#define DEMO_SIM_MQTT_H
#include "plant/plant.h"
#include "sim_values.h"

struct sim_mqtt;

/* Connects to a broker, HOST:PORT, retrying until it is up. Returns NULL if there is nothing to publish, or `where` is not HOST:PORT
   (printed to stderr). `plant` must outlive it. */
struct sim_mqtt *sim_mqtt_create(const struct plant *plant, const char *where);
void sim_mqtt_destroy(struct sim_mqtt **mqtt); /* Ends the connection and frees the publisher; *mqtt becomes NULL and may be NULL */
size_t sim_mqtt_tag_count(const struct sim_mqtt *mqtt);
/* Returns whether a tag is published. */
bool sim_mqtt_has(const struct plant *plant, size_t tag);
/* Publishes the topics of all sources that are due by their poll_ms. */
void sim_mqtt_step(struct sim_mqtt *mqtt, const struct sim_values *values, int64_t now_mono_ns, int64_t now_utc_ns);

#endif
