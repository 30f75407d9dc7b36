/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of equipment and tags as runs of letters and digits, so that TE-101A, te_101a and TE101A are the same. Thread: any. */
#ifndef PREPROCESS_MATCH_NAME_TOKENS_H
#define PREPROCESS_MATCH_NAME_TOKENS_H
#include <stdbool.h>
#include <stddef.h>

enum { NAME_MAX_TOKENS = 48, NAME_KEY_BYTES = 256 };

struct name_token {
    char text[32];  /* upper case; of digits without leading zeros; cut where it is longer */
    int raw_length; /* with leading zeros */
    bool digits;
    bool apart; /* a sign or blank stands before it, or it is the first */
};

struct name_tokens {
    struct name_token at[NAME_MAX_TOKENS];
    int count; /* what is beyond is left out */
};

/* Splits where letters and digits meet, where a sign stands, and before a capital that follows a small letter. */
void name_tokens_read(struct name_tokens *tokens, const char *text);
/* Writes the tokens [from, to) without signs, with a dot between two runs of digits. */
void name_tokens_key(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES]);
/* Likewise with O read as 0 and I or L as 1, leading zeros kept. */
void name_tokens_folded(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES]);
/* Writes the digits alone, with a dot between runs, and the letters alone. */
void name_tokens_split(const struct name_tokens *tokens, int from, int to, char digits[NAME_KEY_BYTES], char letters[NAME_KEY_BYTES]);
/* Returns whether the range has letters, or digits. */
bool name_tokens_have(const struct name_tokens *tokens, int from, int to, bool digits);

enum name_slip { NAME_SAME, NAME_SLIP /* a letter doubled, left out or swapped with the next */, NAME_OTHER_LETTER, NAME_DIFFERENT };
/* Compares two runs of letters. */
enum name_slip name_slip(const char *a, const char *b);

#endif
