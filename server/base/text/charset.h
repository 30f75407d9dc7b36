/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Character encodings of files from other programs: detects the encoding of a text, and converts the text to UTF-8. Call from any
   thread. */
#ifndef BASE_TEXT_CHARSET_H
#define BASE_TEXT_CHARSET_H
#include <stdbool.h>
#include <stddef.h>

enum { CHARSET_NAME_BYTES = 32 };

struct charset_choice {
    char name[CHARSET_NAME_BYTES];  /* name such as "UTF-8", "GB18030" or "Windows-1251" */
    char other[CHARSET_NAME_BYTES]; /* another encoding that is nearly as likely but gives different letters; empty: there is none */
    bool ascii;                     /* true: all bytes are ASCII, so every encoding gives the same text */
};

struct charset_text {
    char *utf8; /* text, terminated by a 0 byte; the caller frees it (mem_free) */
    size_t length;
    struct charset_choice encoding;
    size_t damaged; /* number of undecodable characters, replaced by U+FFFD, plus number of dropped zero bytes */
};

/* Detects the encoding: by a byte order mark, else by validity as UTF-8, else by the likelihood of the bytes in each known encoding. */
struct charset_choice charset_find(const char *bytes, size_t count);
/* Converts the content of a whole file. `encoding`: a name that charset_resolve() knows; NULL: charset_find() decides. */
void charset_decode(const char *bytes, size_t count, const char *encoding, struct charset_text *out);
/* Converts one string, without looking for a byte order mark. Returns the UTF-8 text (mem_free); adds the number of undecodable
   characters to *damaged, which may be NULL. */
char *charset_convert(const char *bytes, size_t count, const char *encoding, size_t *damaged);
/* Translates an encoding's name as written by people and programs ("Windows 1251", "GBK", "latin1") into the name that
   charset_convert() expects. Returns false if the name is unknown. */
bool charset_resolve(const char *written, char name[CHARSET_NAME_BYTES]);
/* Returns true if all bytes can be decoded with that encoding. */
bool charset_fits(const char *bytes, size_t count, const char *encoding);
/* Describes the detected encoding in one line, such as "read as GB18030", with the alternative if it is uncertain (mem_free()). */
char *charset_describe(const struct charset_choice *choice);

/* Opens a converter from UTF-8 to an encoding. */
struct charset_encoder *charset_encoder_open(const char *encoding);
void charset_encoder_close(struct charset_encoder *encoder);
/* Converts a UTF-8 text. Returns the number of bytes written; 0: the encoding is unknown or lacks a character, or `out` is too small. */
size_t charset_encode(struct charset_encoder *encoder, const char *utf8, size_t count, unsigned char *out, size_t out_bytes);

#endif
