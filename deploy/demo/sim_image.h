/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The registers of one simulated device: those exist that some tag names, in each of its units. Thread: one. */
#ifndef DEMO_SIM_IMAGE_H
#define DEMO_SIM_IMAGE_H
#include <modbus.h>
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

struct sim_unit;
struct sim_image { /* zero-initialise */
    struct sim_unit *units[256]; /* NULL: nobody there */
};

void sim_image_finish(struct sim_image *image);
/* Makes the registers of the tag exist. */
void sim_image_add(struct sim_image *image, int unit, const struct plant_tag *tag);
/* Puts a value there. False: the type cannot hold it. */
bool sim_image_set(struct sim_image *image, int unit, const struct plant_tag *tag, double value);
/* A device that refuses a request which touches the tag. */
void sim_image_fail(struct sim_image *image, int unit, const struct plant_tag *tag, bool failing);
/* 0, or the exception that a request for these earns. */
int sim_image_refusal(const struct sim_image *image, int unit, enum register_table table, int first, int count);
modbus_mapping_t *sim_image_mapping(struct sim_image *image, int unit);

#endif
