/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Character encodings of files that other programs wrote: finds the encoding of a text, and converts it to UTF-8. Thread: any. */
#ifndef BASE_TEXT_CHARSET_H
#define BASE_TEXT_CHARSET_H
#include <stdbool.h>
#include <stddef.h>

enum { CHARSET_NAME_BYTES = 32 };

struct charset_choice {
    char name[CHARSET_NAME_BYTES];  /* "UTF-8", "GB18030", "Windows-1251", ... */
    char other[CHARSET_NAME_BYTES]; /* another encoding that explains the bytes nearly as well, as other letters; "": the choice is sure */
    bool ascii;                     /* all bytes are ASCII: any encoding says the same */
};

struct charset_text {
    char *utf8; /* ends in 0; the caller frees it (mem_free) */
    size_t length;
    struct charset_choice encoding;
    size_t damaged; /* characters that are U+FFFD because their bytes mean nothing in the encoding, and bytes 0, which are left out */
};

/* Finds the encoding: a byte order mark decides, then validity as UTF-8, then how likely the bytes are in each known encoding. */
struct charset_choice charset_find(const char *bytes, size_t count);
/* Converts a whole file. encoding: a name that charset_resolve() knows; NULL: charset_find() decides. */
void charset_decode(const char *bytes, size_t count, const char *encoding, struct charset_text *out);
/* Converts one string without looking for marks. Returns the UTF-8 text (mem_free); adds to *damaged, which may be NULL. */
char *charset_convert(const char *bytes, size_t count, const char *encoding, size_t *damaged);
/* Translates an encoding's name as people and programs write it ("Windows 1251", "GBK", "latin1") into the name that charset_convert()
   takes. Returns false if there is no such encoding. */
bool charset_resolve(const char *written, char name[CHARSET_NAME_BYTES]);
/* Returns whether all bytes mean something in an encoding. */
bool charset_fits(const char *bytes, size_t count, const char *encoding);
/* Returns one line without line end: "read as GB18030", and the alternative where the choice is unsure; mem_free. */
char *charset_describe(const struct charset_choice *choice);

/* Converts a UTF-8 text. Returns the bytes written, or 0: the encoding has no such characters, or `out` is too small. */
size_t charset_encode(const char *utf8, size_t count, const char *encoding, unsigned char *out, size_t out_bytes);

/* For charset_find() and its tests. Chooses among the encodings that are neither UTF-8 nor UTF-16, by models of text in each. */
struct charset_choice charset_find_legacy(const char *bytes, size_t count);

#endif
