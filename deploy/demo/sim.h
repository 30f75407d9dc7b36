/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The simulated Modbus devices of a plant, one for each port in its sources, and its MQTT publisher. Call from one thread only. */
#ifndef DEMO_SIM_H
#define DEMO_SIM_H
#include "sim_modbus.h"
#include "sim_mqtt.h"
#include "sim_values.h"

struct sim_device {
    struct sim_modbus modbus;
    int port;        /* TCP port of the device in the plant file */
    int listen_port; /* port on which the simulator listens for this device */
    size_t tag_count;
};

struct sim {
    const struct plant *plant;
    struct sim_values *values;
    struct sim_device *devices;
    size_t device_count;
    struct sim_mqtt *mqtt; /* publisher of the tags of MQTT sources; NULL: nothing is published */
    bool mqtt_paused;
    bool quit;
};

/* Makes devices with registers for all tags of Modbus sources. port > 0: the first device listens there, the others on the ports after
   it. broker: HOST:PORT where tags of MQTT sources are published, or NULL. Returns false if there is nothing to serve, or memory is
   exhausted (printed to stderr). */
bool sim_init(struct sim *sim, const struct plant *plant, struct sim_values *values, int port, const char *broker);
void sim_finish(struct sim *sim);
/* Writes the present values of all tags to the registers. */
void sim_update(struct sim *sim);
/* Returns the simulated device of a tag, and its Modbus unit identifier in *unit; NULL if the tag's source is not Modbus TCP. */
struct sim_device *sim_device_of(const struct sim *sim, const struct plant_tag *tag, int *unit);

/* Executes the command in the first complete line received on the control port, and answers it; arg: struct sim. */
sim_take sim_control_take;
extern const char sim_control_help[];

#endif
