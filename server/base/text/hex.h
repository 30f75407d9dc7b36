/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts bytes to and from hexadecimal, two digits per byte. Pure. Call from any thread. */
#ifndef BASE_TEXT_HEX_H
#define BASE_TEXT_HEX_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Prints bytes as lower-case hexadecimal. `out` receives 2 * count digits and a 0 byte. */
void hex_print(const uint8_t *bytes, size_t count, char *out);
/* Reads exactly 2 * count hexadecimal digits of either case. Returns false if the text is anything else; `bytes` are then invalid. */
bool hex_read(const char *text, uint8_t *bytes, size_t count);

#endif
