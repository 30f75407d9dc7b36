/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normalises text to remove invisible differences: full-width letters, kinds of dashes and blanks (Unicode form NFKC). Call from
   any thread. */
#ifndef PREPROCESS_MATCH_FOLD_H
#define PREPROCESS_MATCH_FOLD_H

/* Returns the text in NFKC, with every dash as '-', every run of blanks as one ' ', and without invisible characters. The caller frees it
 * (mem_free). */
char *fold_text(const char *text);
/* Returns only the letters and digits of a text, in lower case and without accents: "Maßeinheit [°C]" gives "masseinheitc". The
 * caller frees it (mem_free). */
char *fold_key(const char *text);

#endif
