/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the alarm settings of the plant file and the tag list. Only for the files of this folder. */
#ifndef PLANT_SECTIONS_PLANT_ALARMS_H
#define PLANT_SECTIONS_PLANT_ALARMS_H
#include "plant/plant_impl.h"
#include "plant/tags/tag_columns.h"

/* References to other tags in the tag list's cells about alarms. The names are looked up after all rows are read, because a
   named tag may come later in the list. Zero-initialise. */
struct alarm_references {
    struct alarm_reference *at;
    size_t count, capacity;
};

void plant_alarms_read_mode(struct yaml_reader *reader, yaml_node_t *node, void *plant);
/* Reads the key `alarm` (alarm settings) of a group. */
void plant_alarms_read_group(struct yaml_reader *reader, yaml_node_t *node, void *group);
void plant_alarms_check(struct yaml_reader *reader, struct text_position place, const struct plant *plant);
void plant_alarms_read_row(struct tag_columns *columns, struct plant *plant, struct plant_tag *tag, struct alarm_references *references);
/* Resolves the references once all rows are read and the plant's names are sorted; reports unknown names. Frees the references. */
void plant_alarms_resolve(struct plant *plant, struct diag *diag, struct alarm_references *references);

#endif
