/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tags say of other tags, by name: known once the whole list is read. Only for the files of this folder. */
#ifndef PLANT_TAGS_TAG_LINKS_H
#define PLANT_TAGS_TAG_LINKS_H
#include "plant/plant.h"
#include "plant/tags/tag_columns.h"

struct tag_link {
    size_t tag;
    char *to;         /* a name; NULL: its address is an expression */
    int line, column; /* of the cell */
    bool direction;   /* of the column Direction; else Quality Tag */
};

struct tag_links { /* zero-initialise */
    struct tag_link *at;
    size_t count, capacity;
};

bool tag_is_derived(const struct tag_columns *columns); /* the current row is that of a derived tag */
/* Takes what the current row, which is that tag's, says. */
void tag_links_add(struct tag_links *links, struct tag_links *derived, struct tag_columns *columns, struct plant *plant, size_t tag);
/* Of tags whose address is an expression: expressions, plant->derived. tags_by_name is there. */
void tag_derived_resolve(const struct tag_links *derived, struct plant *plant, struct diag *diag);
/* Names become indices, also those of heartbeats; what names no tag is reported. tags_by_name is there. Frees links. */
void tag_links_resolve(struct tag_links *links, struct plant *plant, struct diag *diag);

#endif
