/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses between the text encoding given by the user, the one given in the file, and the detected one. */
#include "preprocess/import/encoding.h"

#include <string.h>

#include "base/mem.h"

struct charset_choice encoding_choose(const char *text, size_t length, const char *asked, const char *said)
{
    struct charset_choice found = charset_find(text, length), named = { .ascii = found.ascii };
    if (asked && *asked)
        return charset_resolve(asked, named.name) ? named : found;
    bool legacy = !found.ascii && strncmp(found.name, "UTF-", 4) != 0;
    return legacy && said && *said && charset_resolve(said, named.name) && charset_fits(text, length, named.name) ? named : found;
}

void encoding_say(struct text *out, const char *what, const struct charset_choice *choice)
{
    if (choice->ascii || !strcmp(choice->name, "UTF-8"))
        return;
    char *how = charset_describe(choice);
    text_add(out, "%s: %s\n", what, how);
    mem_free(how);
}
