/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The simulated devices of a plant: one for each port that its Modbus sources name. Thread: one. */
#ifndef DEMO_SIM_H
#define DEMO_SIM_H
#include "sim_modbus.h"
#include "sim_values.h"

struct sim_device {
    struct sim_modbus modbus;
    int port;          /* as the plant says */
    int listen_port;   /* where it is served */
    size_t tag_count;
};

struct sim {
    const struct plant *plant;
    struct sim_values *values;
    struct sim_device *devices;
    size_t device_count;
    bool quit;
};

/* Devices and registers for all tags of Modbus sources. port > 0: the first device is served there, the others after it. False:
   nothing to serve, or no memory; said on stderr. */
bool sim_init(struct sim *sim, const struct plant *plant, struct sim_values *values, int port);
void sim_finish(struct sim *sim);
/* Puts the present values of all tags into the registers. */
void sim_update(struct sim *sim);
/* The device and unit that serve a tag; NULL: it is not on Modbus. */
struct sim_device *sim_device_of(const struct sim *sim, const struct plant_tag *tag, int *unit);

/* The control port's lines; arg: struct sim. */
sim_take sim_control_take;
extern const char sim_control_help[];

#endif
