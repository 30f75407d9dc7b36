/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the columns of a row with the address of a tag's value in the device and with its conversion. Only for the files of this folder. */
#ifndef PLANT_TAGS_TAG_WIRE_H
#define PLANT_TAGS_TAG_WIRE_H
#include "plant/plant.h"
#include "plant/tags/tag_columns.h"

/* Fills the tag's address, data type and conversion from the current row; its source must be set. */
void tag_wire_read(struct tag_columns *columns, const struct plant *plant, struct plant_tag *tag);

#endif
