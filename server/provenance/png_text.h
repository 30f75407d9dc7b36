/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text chunks of PNG files (PNG, third edition, 11.3.3): compressed zTXt. No input or output. Call from any thread. */
#ifndef PROVENANCE_PNG_TEXT_H
#define PROVENANCE_PNG_TEXT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct png_text {
    const char *keyword; /* keyword of the text chunk, which says what the text is; 1 to 79 bytes */
    /* the chunk's text in UTF-8; use ASCII only, because some readers decode it as Latin-1, as the PNG standard says */
    const char *text;
    size_t length;
};

/* Returns a copy of the PNG file with the texts inserted after its header, and the copy's size in *out_count; the caller frees it
   (mem_free). NULL: not a PNG file, or out of memory. */
uint8_t *png_text_add(const uint8_t *png, size_t count, const struct png_text *texts, int text_count, size_t *out_count);
enum { PNG_PLAIN_WHY_BYTES = 160 };
/* Returns true if a PNG file has exactly the chunks that our writer emits, with the same contents: IHDR of 8-bit RGB,
   compressed texts with these keywords, sRGB, IDAT, IEND, in this order; gAMA and cHRM only with the values of sRGB. Every
   browser shows the pixels of such a file unchanged. If not, `why` receives the reason, with the name of the chunk. */
bool png_is_plain(const uint8_t *png, size_t count, const char *const *keywords, int keyword_count, char why[PNG_PLAIN_WHY_BYTES]);
/* Returns the text of the only text chunk with that keyword, followed by a 0 byte, and its length; the caller frees it
   (mem_free). Returns NULL if there is no such chunk or there are several, or if the file is truncated or damaged. Also returns
   NULL if bytes follow the compressed text, or the text is longer than max_bytes. */
char *png_text_find(const uint8_t *png, size_t count, const char *keyword, size_t max_bytes, size_t *out_length);

#endif
