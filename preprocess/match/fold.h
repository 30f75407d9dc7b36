/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts without differences that people do not see: full-width letters, kinds of dashes and blanks (Unicode's form NFKC). Thread:
   any. */
#ifndef PREPROCESS_MATCH_FOLD_H
#define PREPROCESS_MATCH_FOLD_H

/* Returns a text in NFKC with every dash as '-', every run of blanks as one ' ', and without characters that are not seen; mem_free. */
char *fold_text(const char *text);
/* Returns only the letters and digits of a text, in lower case and without accents: "Maßeinheit [°C]" is "masseinheitc"; mem_free. */
char *fold_key(const char *text);

#endif
