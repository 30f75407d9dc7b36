/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the player says, in the page's own words (clients/web/words). Thread: one. */
#ifndef WALL_WORDS_H
#define WALL_WORDS_H
#include <stdbool.h>
#include <stdint.h>

#include "render/view.h"

/* Chooses the language, also of legends and labels: en, ko or de. Says if no font has its letters. Returns false if it is none of them.
   Before say(). */
bool words_choose(const char *language);
/* Returns it; English until one is chosen. */
enum language words_language(void);
/* Returns the text of a key, with pairs of name and value put in, ended by NULL: say("walls.since", "time", "10:00", NULL). The plural is
   that
   of `count`, where there is one. Returned texts are used again after 32 others. */
const char *say(const char *key, ...) __attribute__((sentinel));
/* Returns an age in words; negative: unknown. Likewise. */
const char *say_age(int64_t age_ns);
/* Returns a number, as text. Likewise. */
const char *say_number(double value, int decimals);

#endif
