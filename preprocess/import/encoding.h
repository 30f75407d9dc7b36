/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text encoding of the names in a model: given by the user, given in the file, or detected. Call from any thread. */
#ifndef PREPROCESS_IMPORT_ENCODING_H
#define PREPROCESS_IMPORT_ENCODING_H
#include "base/text/charset.h"
#include "base/text/text.h"

/* Chooses the encoding of a text. The first of these applies: `asked` (given by the user; NULL or "": none); ASCII or Unicode,
 * if the text is valid UTF-8 or UTF-16; `said` (given in the file; NULL or "": none), if all bytes are valid in it; a detected
 * encoding. */
struct charset_choice encoding_choose(const char *text, size_t length, const char *asked, const char *said);
/* Appends a line that names the encoding chosen for `what`, such as "names", to `out`. Appends nothing for ASCII and UTF-8. */
void encoding_say(struct text *out, const char *what, const struct charset_choice *choice);

#endif
