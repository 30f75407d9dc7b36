/* SPDX-License-Identifier: GPL-3.0-or-later */
/* References from tags to other tags by name, which are looked up after the whole tag list is read. Only for the files of this folder. */
#ifndef PLANT_TAGS_TAG_LINKS_H
#define PLANT_TAGS_TAG_LINKS_H
#include "plant/plant.h"
#include "plant/tags/tag_columns.h"

struct tag_link {
    size_t tag;
    char *to;         /* name of the other tag; NULL: `tag` is a derived tag, whose address is an expression */
    int line, column; /* position of the cell */
    bool direction;   /* true: the name is from the column Direction; false: from the column Quality Tag */
};

struct tag_links { /* zero-initialise */
    struct tag_link *at;
    size_t count, capacity;
};

/* Returns whether the current row of the tag list describes a derived tag, which is computed from other tags. */
bool tag_is_derived(const struct tag_columns *columns);
/* Records the names of other tags in the current row of the tag list, which describes the tag with the index `tag`. */
void tag_links_add(struct tag_links *links, struct tag_links *derived, struct tag_columns *columns, struct plant *plant, size_t tag);
/* Parses the expressions of derived tags and fills plant->derived. tags_by_name must be set. */
void tag_derived_resolve(const struct tag_links *derived, struct plant *plant, struct diag *diag);
/* Replaces names of tags, and of heartbeats, by indices; reports unknown tags. tags_by_name must be set. Frees `links`. */
void tag_links_resolve(struct tag_links *links, struct plant *plant, struct diag *diag);

#endif
