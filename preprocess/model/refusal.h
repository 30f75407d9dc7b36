/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Why a model is refused: one line of text, with the object's name and the numbers. */
#ifndef PREPROCESS_MODEL_REFUSAL_H
#define PREPROCESS_MODEL_REFUSAL_H
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define MODEL_WHY_BYTES 400

/* Writes the reason; always false, for `return wrong(why, ...)`. */
bool wrong(char why[MODEL_WHY_BYTES], const char *fmt, ...) __attribute__((format(printf, 2, 3)));

#ifdef __cplusplus
}
#endif
#endif
