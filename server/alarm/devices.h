/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The devices from which tags are read: each unit of each source. A device that does not answer raises one alarm instead of one
   per tag. No input or output. Call from one thread at a time. */
#ifndef ALARM_DEVICES_H
#define ALARM_DEVICES_H
#include "plant/plant.h"

enum device_status { DEVICE_UNKNOWN, DEVICE_USABLE, DEVICE_GONE /* DEVICE_GONE: no data arrives from the device, or its controller has
                                                                   stopped */, DEVICE_OTHER };

struct alarm_device {
    char *name; /* name of the source, followed by the unit if the source has several: "plc1", "gateway/7" */
    int source, unit;
    int usable, gone; /* usable: number of the device's tags with status DEVICE_USABLE; gone: with status DEVICE_GONE */
    /* monotonic time since when the device has not been lost (device_is_lost()); 0: it is lost, or no tag has reported yet */
    int64_t back_ns;
    int alarm;        /* index of the device's LINK alarm, which is raised when the device does not answer; -1: none */
    bool changed;     /* true: the status of a tag of the device changed since alarms.c last evaluated the device */
};

struct devices {
    struct alarm_device *list;
    size_t count, capacity;
    int *of_tag;       /* [tag]: index of the tag's device in `list` (all devices); -1: the tag belongs to no device */
    uint8_t *statuses; /* [tag]: whether the tag shows that its device answers (enum device_status) */
};

/* Lists the devices of the plant; `plant` must outlive the result. Never returns NULL. */
struct devices *devices_create(const struct plant *plant);
/* frees the devices and sets *devices to NULL; accepts a pointer to NULL */
void devices_destroy(struct devices **devices);
int devices_find(const struct devices *devices, const char *name); /* returns the index of the device with that name, or -1 */

/* Returns what the quality of a tag tells about its device: for example, that the device does not answer. */
enum device_status device_status_of(uint32_t quality);
/* Records the status that a tag reports for its device from mono_ns on. */
void devices_put(struct devices *devices, int tag, enum device_status status, int64_t mono_ns);
/* Returns true if the device as a whole does not answer: none of its tags is usable, and at least one has the status DEVICE_GONE. */
bool device_is_lost(const struct alarm_device *device);

#endif
