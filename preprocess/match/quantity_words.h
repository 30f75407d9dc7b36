/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which quantity a text speaks of, in ten languages: "Bearing temperature", "Füllstand", "泵轴承温度". Thread: any. */
#ifndef PREPROCESS_MATCH_QUANTITY_WORDS_H
#define PREPROCESS_MATCH_QUANTITY_WORDS_H

/* Returns the only quantity that a text names, as isa_quantity() calls it (static); NULL if it names none or several. */
const char *quantity_words_find(const char *text);

#endif
