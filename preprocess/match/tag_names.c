/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements the lists of tag names in lines of the result. */
#include "preprocess/match/tag_names.h"

#include <stdarg.h>

enum { NAMED = 5 };

void tag_names_add(struct tag_names *names, const char *tag, const char *detail, ...)
{
    va_list ap;
    if (names->count++ >= NAMED)
        return;
    text_add(&names->names, "%s%s", names->count > 1 ? ", " : "", tag);
    size_t before = names->names.length;
    text_add(&names->names, " (");
    va_start(ap, detail);
    text_add_v(&names->names, detail, ap);
    va_end(ap);
    if (names->names.length > before + 2)
        text_add(&names->names, ")");
    else /* the detail is an empty text: omit the brackets */
        names->names.at[names->names.length = before] = 0;
}

void tag_names_join(struct tag_names *names, const struct tag_names *one)
{
    if (one->count > 0 && names->count++ < NAMED)
        text_add(&names->names, "%s%s", names->count > 1 ? ", " : "", one->names.at);
}

void tag_names_say(const struct tag_names *names, const char *one, const char *many, struct text *out)
{
    if (names->count > 0)
        text_add(out, "%zu %s: %s%s\n", names->count, names->count == 1 ? one : many, names->names.at, names->count > NAMED ? ", ..." : "");
}

void tag_names_finish(struct tag_names *names)
{
    text_finish(&names->names);
    *names = (struct tag_names){ 0 };
}
