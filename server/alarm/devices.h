/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The devices that tags are read from: each unit of each source. A device that fails as a whole raises one alarm, not one for each of its
   tags. Pure. Thread: one at a time. */
#ifndef ALARM_DEVICES_H
#define ALARM_DEVICES_H
#include "plant/plant.h"

enum device_status { DEVICE_UNKNOWN, DEVICE_USABLE, DEVICE_GONE /* nothing comes, or the controller has stopped */, DEVICE_OTHER };

struct alarm_device {
    char *name;          /* of its source, and its unit where that has several: "plc1", "gateway/7" */
    int source, unit;
    int usable, gone;    /* the number of its tags that are DEVICE_USABLE, and DEVICE_GONE */
    int64_t back_ns;     /* monotonic: since when one of its tags is usable; 0: none is */
    int alarm;           /* index in alarms; -1: it has none */
    bool changed;        /* since alarms.c evaluated it */
};

struct devices {
    struct alarm_device *list;
    size_t count, capacity;
    int *of_tag;         /* -1: from no device */
    uint8_t *statuses;      /* by tag, enum device_status */
};

struct devices *devices_create(const struct plant *plant); /* plant must outlive it; never NULL */
void devices_destroy(struct devices **devices);            /* &NULL is fine; leaves NULL */
int devices_find(const struct devices *devices, const char *name); /* returns the index, or -1 */

enum device_status device_status_of(uint32_t quality); /* returns what a quality says about the device */
/* Records the status that a tag has from mono_ns on. */
void devices_put(struct devices *devices, int tag, enum device_status status, int64_t mono_ns);
bool device_is_lost(const struct alarm_device *device); /* returns whether it has failed: no tag is usable, at least one is gone */

#endif
