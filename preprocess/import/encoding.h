/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encoding of the names of a model: given by the user, stated by the file, or detected. Thread: any. */
#ifndef PREPROCESS_IMPORT_ENCODING_H
#define PREPROCESS_IMPORT_ENCODING_H
#include "base/text/charset.h"
#include "base/text/text.h"

/* Chooses the encoding of a text, in this order. asked: the user's choice, which always wins; NULL: none. Then ASCII or Unicode, if the
 * text is valid UTF-8 or UTF-16. said: the encoding stated by the file, if all bytes are valid in it; NULL or "": none. Otherwise the
 * encoding is detected. */
struct charset_choice encoding_choose(const char *text, size_t length, const char *asked, const char *said);
/* Appends a line that states the encoding of `what`, such as "names". Appends nothing for ASCII and UTF-8. */
void encoding_say(struct text *out, const char *what, const struct charset_choice *choice);

#endif
