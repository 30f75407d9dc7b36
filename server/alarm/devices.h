/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The devices that tags come from: each unit of each source. Lost as a whole, a device is one alarm, not one for each of its tags.
   Pure. Thread: one at a time. */
#ifndef ALARM_DEVICES_H
#define ALARM_DEVICES_H
#include "plant/plant.h"

enum device_status { DEVICE_UNKNOWN, DEVICE_USABLE, DEVICE_GONE /* nothing comes, or the controller has stopped */, DEVICE_OTHER };

struct device {
    char *name; /* of its source, and its unit where that has several: "plc1", "gateway/7" */
    int source, unit;
    int usable, gone; /* how many of its tags are so */
    int64_t back_ns;  /* monotonic: since when there is something usable; 0: there is nothing */
    int alarm;        /* index in alarms; -1: nobody would miss it */
    bool changed;     /* since it was looked at */
};

struct devices {
    struct device *list;
    size_t count, capacity;
    int *of_tag;       /* -1: from no device */
    uint8_t *statuses; /* by tag, enum device_status */
};

struct devices *devices_create(const struct plant *plant);         /* outlives it */
void devices_destroy(struct devices **devices);                    /* &NULL is fine; leaves NULL */
int devices_find(const struct devices *devices, const char *name); /* index or -1 */

enum device_status device_status_of(uint32_t quality);
/* What is known of a tag by now. */
void devices_put(struct devices *devices, int tag, enum device_status status, int64_t mono_ns);
bool device_is_lost(const struct device *device);

#endif
