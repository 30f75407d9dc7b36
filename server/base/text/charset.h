/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Character encodings of files that other programs wrote: detects the encoding of a text, and converts the text to UTF-8. Thread: any. */
#ifndef BASE_TEXT_CHARSET_H
#define BASE_TEXT_CHARSET_H
#include <stdbool.h>
#include <stddef.h>

enum { CHARSET_NAME_BYTES = 32 };

struct charset_choice {
    char name[CHARSET_NAME_BYTES];  /* name such as "UTF-8", "GB18030" or "Windows-1251" */
    char other[CHARSET_NAME_BYTES]; /* another encoding that is nearly as likely but gives other letters; empty: none is nearly as likely */
    bool ascii;                     /* true: all bytes are ASCII, so that every encoding gives the same text */
};

struct charset_text {
    char *utf8; /* text that ends in 0; the caller frees it (mem_free) */
    size_t length;
    struct charset_choice encoding;
    size_t damaged; /* number of characters that could not be decoded and became U+FFFD, plus the number of zero bytes, which were left
                       out */
};

/* Detects the encoding: a byte order mark decides, then validity as UTF-8, then the likelihood of the bytes in each known encoding. */
struct charset_choice charset_find(const char *bytes, size_t count);
/* Converts a whole file. `encoding`: a name that charset_resolve() knows; NULL: charset_find() decides. */
void charset_decode(const char *bytes, size_t count, const char *encoding, struct charset_text *out);
/* Converts one string without looking for byte order marks. Returns the UTF-8 text (mem_free); adds the number of characters that could
   not be decoded to *damaged, which may be NULL. */
char *charset_convert(const char *bytes, size_t count, const char *encoding, size_t *damaged);
/* Translates an encoding's name as people and programs write it ("Windows 1251", "GBK", "latin1") into the name that charset_convert()
   takes. Returns false if the name is unknown. */
bool charset_resolve(const char *written, char name[CHARSET_NAME_BYTES]);
/* Returns true if all bytes can be decoded in an encoding. */
bool charset_fits(const char *bytes, size_t count, const char *encoding);
/* Returns one line without a line end: "read as GB18030", with the alternative if the choice is uncertain; free with mem_free(). */
char *charset_describe(const struct charset_choice *choice);

/* Opens a conversion from UTF-8 to an encoding. */
struct charset_encoder *charset_encoder_open(const char *encoding);
void charset_encoder_close(struct charset_encoder *encoder);
/* Converts a UTF-8 text. Returns the number of bytes written; 0: the encoding is unknown or lacks a character, or `out` is too small. */
size_t charset_encode(struct charset_encoder *encoder, const char *utf8, size_t count, unsigned char *out, size_t out_bytes);

#endif
