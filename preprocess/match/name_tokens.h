/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits names of equipment and tags into runs of letters and digits, so that TE-101A, te_101a and TE101A are equal. Thread: any. */
#ifndef PREPROCESS_MATCH_NAME_TOKENS_H
#define PREPROCESS_MATCH_NAME_TOKENS_H
#include <stdbool.h>
#include <stddef.h>

enum { NAME_MAX_TOKENS = 48, NAME_KEY_BYTES = 256 };

struct name_token {
    char text[32];  /* text of the token in upper case, for digits without leading zeros; truncated if it does not fit */
    int raw_length; /* number of characters of the token before leading zeros were removed */
    bool digits;
    bool apart; /* true: the token is the first, or comes after a separator or blank */
};

struct name_tokens {
    struct name_token at[NAME_MAX_TOKENS];
    int count; /* number of tokens; a text with more tokens is cut off */
};

/* Splits a name into tokens: between letters and digits, at separators, and before a capital letter that follows a small letter. */
void name_tokens_read(struct name_tokens *tokens, const char *text);
/* Writes a key of the tokens [from, to) for hash maps: the tokens without separators, but with a dot between two runs of digits. */
void name_tokens_key(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES]);
/* Writes the key of the tokens [from, to) as name_tokens_key() does, but with 0 in place of O and 1 in place of I and L, and with leading
 * zeros kept. */
void name_tokens_folded(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES]);
/* Writes two keys of the tokens [from, to): the digits alone, with a dot between two runs, and the letters alone. */
void name_tokens_split(const struct name_tokens *tokens, int from, int to, char digits[NAME_KEY_BYTES], char letters[NAME_KEY_BYTES]);
/* Returns whether the tokens [from, to) include a run of digits (digits true) or of letters (digits false). */
bool name_tokens_have(const struct name_tokens *tokens, int from, int to, bool digits);

enum name_slip { NAME_SAME, NAME_SLIP /* names differ by one letter doubled, left out or swapped */, NAME_OTHER_LETTER, NAME_DIFFERENT };
/* Compares two runs of letters. Returns NAME_SAME if they are equal, NAME_SLIP if they differ by one slip, NAME_OTHER_LETTER if they differ
 * in one letter, else NAME_DIFFERENT. */
enum name_slip name_slip(const char *a, const char *b);

#endif
