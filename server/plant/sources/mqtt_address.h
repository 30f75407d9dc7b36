/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses of values that are published over MQTT (`TOPIC#PATH`) or Sparkplug (`GROUP/NODE[/DEVICE]#METRIC`), and templates of
   topics (SOURCES.md). Call from any thread. */
#ifndef PLANT_SOURCES_MQTT_ADDRESS_H
#define PLANT_SOURCES_MQTT_ADDRESS_H
#include <stdbool.h>

#include "plant/plant.h"

enum { MQTT_TOPIC_BYTES = 1024 }; /* maximum length in bytes of a tag's topic; MQTT itself allows 65535 */

/* Checks the template of a source's topics. Returns false on errors, with the expected form in `why`. */
bool mqtt_template_check(const char *text, char why[200]);
/* Sets tag->topic and tag->path from the tag's address and the topic template of its source; name, address, source, group and asset of the
   tag must be set. Returns false on errors, with the expected form in `why`. */
bool mqtt_address_resolve(const struct plant *plant, struct plant_tag *tag, char why[200]);
/* Returns the path at which a tag that has a source finds its value (struct tag_signal): the tag's own, else its source's key `value`; "":
   there is none. */
const char *mqtt_address_path(const struct plant *plant, const struct plant_tag *tag);

#endif
