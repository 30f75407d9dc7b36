/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The registers of one simulated device, for each of its Modbus unit identifiers. Only registers used by a tag exist. Call from
   one thread only. */
#ifndef DEMO_SIM_IMAGE_H
#define DEMO_SIM_IMAGE_H
#include <modbus.h>
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

struct sim_unit;
struct sim_image {               /* zero-initialise */
    struct sim_unit *units[256]; /* registers of each Modbus unit, by unit identifier; NULL: the device lacks the unit */
};

void sim_image_finish(struct sim_image *image);
/* Adds the registers of a tag. */
void sim_image_add(struct sim_image *image, int unit, const struct plant_tag *tag);
/* Writes the value of a tag. Returns false if its data type cannot hold the value. */
bool sim_image_set(struct sim_image *image, int unit, const struct plant_tag *tag, double value);
/* Makes the device refuse requests that include the tag, or accept them again. */
void sim_image_fail(struct sim_image *image, int unit, const struct plant_tag *tag, bool failing);
/* Returns 0, or the Modbus exception code of the reply to a request for these registers. */
int sim_image_refusal(const struct sim_image *image, int unit, enum register_table table, int first, int count);
/* Returns the registers of a Modbus unit for libmodbus; NULL if there is no such unit. */
modbus_mapping_t *sim_image_mapping(struct sim_image *image, int unit);

#endif
