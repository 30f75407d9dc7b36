/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formats error texts for rejected models: one line that names the object and the numbers. Call from any thread. */
#ifndef PLANT_MODELS_MODEL_REFUSAL_H
#define PLANT_MODELS_MODEL_REFUSAL_H
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define MODEL_WHY_BYTES 400

/* Formats the error text into `why`. Always returns false, so that callers can write `return wrong(why, ...)`. */
bool wrong(char why[MODEL_WHY_BYTES], const char *fmt, ...) __attribute__((format(printf, 2, 3)));

#ifdef __cplusplus
}
#endif
#endif
