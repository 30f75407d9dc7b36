/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognises quantities in text in ten languages: "Bearing temperature", "Füllstand", "泵轴承温度". Call from any thread. */
#ifndef PREPROCESS_MATCH_QUANTITY_WORDS_H
#define PREPROCESS_MATCH_QUANTITY_WORDS_H

/* Returns the quantity named in a text, spelt as by isa_quantity() (static), or NULL if the text names none or several. */
const char *quantity_words_find(const char *text);

#endif
