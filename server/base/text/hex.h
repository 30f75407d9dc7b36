/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bytes as hexadecimal digits, two each. Pure. Thread: any. */
#ifndef BASE_TEXT_HEX_H
#define BASE_TEXT_HEX_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Prints them in lower case. out: 2 * count digits and a 0 byte. */
void hex_print(const uint8_t *bytes, size_t count, char *out);
/* Reads exactly as many, of either case. Returns false if the text is anything else; then bytes are not to be used. */
bool hex_read(const char *text, uint8_t *bytes, size_t count);

#endif
