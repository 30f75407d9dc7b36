/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text chunks of PNG files (PNG, third edition, 11.3.3): compressed zTXt. Pure. */
#ifndef PROVENANCE_PNG_TEXT_H
#define PROVENANCE_PNG_TEXT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct png_text {
    const char *keyword; /* 1 to 79 bytes */
    const char *text;    /* UTF-8, though readers may take it for Latin-1, which the format says: ASCII is safe */
    size_t length;
};

/* Returns a copy of the PNG file with the texts behind its header, and its size in *out_count; the caller frees it (mem_free). NULL: it is
   no PNG file, or there is no memory. */
uint8_t *png_text_add(const uint8_t *png, size_t count, const struct png_text *texts, int text_count, size_t *out_count);
/* Returns whether the file is whole, ends with its last chunk and has no chunks but those that show one picture as its pixels are: no
   animation, no colour profile. If not, writes the type of the first chunk that is too much, or "", to `type`. */
bool png_is_plain(const uint8_t *png, size_t count, char type[5]);
/* Returns the text of the only chunk with that keyword, followed by a 0 byte, and its length; the caller frees it (mem_free). NULL: there
   is none, there are several, the file is cut or damaged, or the text has more than max_bytes. */
char *png_text_find(const uint8_t *png, size_t count, const char *keyword, size_t max_bytes, size_t *out_length);

#endif
