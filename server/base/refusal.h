/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Refusals: why an action was refused, as a code with named arguments. Each client turns the code into a sentence in its user's
   language (clients/web/words/refused.*.js). Pure. Call from any thread. */
#ifndef BASE_REFUSAL_H
#define BASE_REFUSAL_H
#include <jansson.h>

#include "words_refused.h"

#define REFUSAL_MEMBER(name, ...) REFUSAL_##name,
enum refusal_code { REFUSAL_NONE, REFUSED_WORDS(REFUSAL_MEMBER) REFUSALS };
#undef REFUSAL_MEMBER

enum { REFUSAL_ARGS_BYTES = 240, REFUSAL_TEXT_BYTES = 400 };
struct refusal {
    enum refusal_code code;
    char args[REFUSAL_ARGS_BYTES]; /* arguments of the refusal, one NAME=VALUE per line; empty: none */
};

/* Sets the refusal's code and arguments. `args`: a format for lines of NAME=VALUE, one line for each {name} in the code's
   sentence. Values must not contain line breaks. */
void refusal_set(struct refusal *refusal, enum refusal_code code, const char *args, ...) __attribute__((format(printf, 3, 4)));
/* Writes the refusal's English sentence, for the log and the command line. */
void refusal_text(const struct refusal *refusal, char out[REFUSAL_TEXT_BYTES]);
/* Returns the English sentence (static) of a code without arguments; "" for REFUSAL_NONE. */
const char *refusal_words(enum refusal_code code);
/* Returns {"code": ..., "args": {...}}, or NULL for REFUSAL_NONE. */
json_t *refusal_json(const struct refusal *refusal);
/* Sets two members of a JSON answer: `why`, the English sentence ("" for REFUSAL_NONE), and `refusal`, unless the code is REFUSAL_NONE. */
void refusal_add(json_t *answer, enum refusal_code code);
void refusal_add_with(json_t *answer, const struct refusal *refusal); /* like refusal_add(), for a refusal whose sentence has arguments */
/* Sets two members of a JSON answer, `unaudited` and `unaudited_refusal`: why the audit trail does not record the action. */
void refusal_add_unaudited(json_t *answer, enum refusal_code code);

#endif
