/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Puts the sensors on the surfaces, and instruments where a node carries the name. */
#ifndef GENERATE_SENSORS_H
#define GENERATE_SENSORS_H
#include "model.h"
#include "tags.h"

/* After the geometry is final: sets every tag's position, adds the nodes. */
void sensors_place(struct model *model, struct tags *tags);

#endif
