/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts bytes to and from hexadecimal digits, two a byte. Pure. Thread: any. */
#ifndef BASE_TEXT_HEX_H
#define BASE_TEXT_HEX_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Prints bytes in lower case. `out` receives 2 * count digits and a 0 byte. */
void hex_print(const uint8_t *bytes, size_t count, char *out);
/* Reads exactly 2 * count digits, in lower or upper case. Returns false if the text is anything else; `bytes` are then invalid. */
bool hex_read(const char *text, uint8_t *bytes, size_t count);

#endif
