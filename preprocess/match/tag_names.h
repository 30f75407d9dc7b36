/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts the tags that a line of the result is about, and keeps the names of the first ones. Call from one thread only. */
#ifndef PREPROCESS_MATCH_TAG_NAMES_H
#define PREPROCESS_MATCH_TAG_NAMES_H
#include <stddef.h>

#include "base/text/text.h"

struct tag_names { /* zero-initialise */
    size_t count;
    struct text names; /* the first names, separated by commas, each followed by its detail in brackets */
};

/* Adds a tag. detail: printf format of a text that is shown after the name; an empty result is not shown. */
void tag_names_add(struct tag_names *names, const char *tag, const char *detail, ...) __attribute__((format(printf, 3, 4)));
/* Adds the tag of `one`, a list with at most one tag, together with its detail. */
void tag_names_join(struct tag_names *names, const struct tag_names *one);
/* Appends the line "COUNT ONE: NAMES", or "COUNT MANY: NAMES" if there are several tags; nothing if there is no tag. */
void tag_names_say(const struct tag_names *names, const char *one, const char *many, struct text *out);
void tag_names_finish(struct tag_names *names);

#endif
