/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A row of the tag list: what is on the wire and what becomes of it. Only for the files of this folder. */
#ifndef PLANT_TAGS_TAG_WIRE_H
#define PLANT_TAGS_TAG_WIRE_H
#include "plant/plant.h"
#include "plant/tags/tag_columns.h"

/* Fills tag from the current row; its source is known. */
void tag_wire_read(struct tag_columns *columns, const struct plant *plant, struct plant_tag *tag);

#endif
