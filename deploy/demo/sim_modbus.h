/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers Modbus TCP requests from the registers of a simulated device. Write requests are refused and counted. Call from one
   thread only. */
#ifndef DEMO_SIM_MODBUS_H
#define DEMO_SIM_MODBUS_H
#include "sim_image.h"
#include "sim_port.h"

struct sim_modbus {
    struct sim_image image;
    modbus_t *modbus; /* libmodbus context that makes the replies */
    bool paused;      /* true: the device receives requests but does not answer them */
    long reads, refusals, writes_refused;
};

/* Initialises a device. Returns false if out of memory. */
bool sim_modbus_init(struct sim_modbus *device);
void sim_modbus_finish(struct sim_modbus *device);
sim_take sim_modbus_take; /* Answers a request; arg: struct sim_modbus. */

#endif
