/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits names of equipment and tags into runs of letters and digits, so that TE-101A, te_101a and TE101A compare equal. Call from
   any thread. */
#ifndef PREPROCESS_MATCH_NAME_TOKENS_H
#define PREPROCESS_MATCH_NAME_TOKENS_H
#include <stdbool.h>
#include <stddef.h>

enum { NAME_MAX_TOKENS = 48, NAME_KEY_BYTES = 256 };

struct name_token {
    char text[32];  /* token in upper case, digits without leading zeros; truncated if it does not fit */
    int raw_length; /* number of characters before leading zeros were removed */
    bool digits;
    bool apart; /* true: the token is the first, or follows a separator or blank */
};

struct name_tokens {
    struct name_token at[NAME_MAX_TOKENS];
    int count; /* number of tokens; further tokens of a longer text are dropped */
};

/* Splits a name into tokens: between letters and digits, at separators, and between a small and a capital letter. */
void name_tokens_read(struct name_tokens *tokens, const char *text);
/* Writes a hash map key for the tokens [from, to): the tokens without separators, but with a dot between two runs of digits. */
void name_tokens_key(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES]);
/* Writes the key of the tokens [from, to) like name_tokens_key(), but with 0 for O and 1 for I and L, and keeps leading zeros. */
void name_tokens_folded(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES]);
/* Writes two keys for the tokens [from, to): only the digits, with a dot between two runs, and only the letters. */
void name_tokens_split(const struct name_tokens *tokens, int from, int to, char digits[NAME_KEY_BYTES], char letters[NAME_KEY_BYTES]);
/* Returns whether the tokens [from, to) include a run of digits (digits true) or of letters (digits false). */
bool name_tokens_have(const struct name_tokens *tokens, int from, int to, bool digits);

enum name_slip { NAME_SAME, NAME_SLIP /* names differ by one letter doubled, left out or swapped */, NAME_OTHER_LETTER, NAME_DIFFERENT };
/* Compares two runs of letters. Returns NAME_SAME if they are equal, NAME_SLIP if they differ by one spelling mistake,
 * NAME_OTHER_LETTER if they differ in one letter, else NAME_DIFFERENT. */
enum name_slip name_slip(const char *a, const char *b);

#endif
