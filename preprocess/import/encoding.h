/* SPDX-License-Identifier: GPL-3.0-or-later */
/* In which encoding the names of a model are: as a person says, as the file says, or as they look. Thread: any. */
#ifndef PREPROCESS_IMPORT_ENCODING_H
#define PREPROCESS_IMPORT_ENCODING_H
#include "base/charset.h"
#include "base/text.h"

/* Chooses the encoding of a text. asked: by a person, NULL: nobody has; it is taken. said: what the file calls its encoding, NULL or "":
   nothing; it is taken if all bytes fit, unless the text is UTF-8. */
struct charset_choice encoding_choose(const char *text, size_t length, const char *asked, const char *said);
/* Appends a line that says how `what`, such as "names", are read. Says nothing where that is ASCII or UTF-8. */
void encoding_say(struct text *out, const char *what, const struct charset_choice *choice);

#endif
