/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits names into runs of letters and digits. First normalises full-width letters, dashes and blanks; bytes of other
 * alphabets count as letters. */
#include "preprocess/match/name_tokens.h"

#include <ctype.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/match/fold.h"

static bool is_word(unsigned char c)
{
    return isalnum(c) || c >= 0x80;
}

static void read_folded(struct name_tokens *tokens, const char *text)
{
    bool apart = true;
    tokens->count = 0;
    while (*text && tokens->count < NAME_MAX_TOKENS) {
        if (!is_word((unsigned char)*text)) {
            apart = true;
            text++;
            continue;
        }
        struct name_token *token = &tokens->at[tokens->count++];
        size_t length = 0;
        *token = (struct name_token){ .digits = isdigit((unsigned char)*text), .apart = apart };
        unsigned char before = 0;
        for (; is_word((unsigned char)*text) && !!isdigit((unsigned char)*text) == token->digits; text++) {
            unsigned char c = (unsigned char)*text;
            if (isupper(c) && islower(before))
                break;
            before = c;
            token->raw_length++;
            if (token->digits && c == '0' && length == 0)
                continue;
            if (length < sizeof(token->text) - 1)
                token->text[length++] = (char)toupper(c);
        }
        if (token->digits && length == 0)
            token->text[length++] = '0';
        token->text[length] = 0;
        apart = false;
    }
}

void name_tokens_read(struct name_tokens *tokens, const char *text)
{
    char *folded = fold_text(text);
    read_folded(tokens, folded);
    mem_free(folded);
}

static void add_to_key(char key[NAME_KEY_BYTES], size_t *length, const char *text)
{
    size_t count = strlen(text);
    if (*length + count < NAME_KEY_BYTES) {
        memcpy(key + *length, text, count + 1);
        *length += count;
    }
}

void name_tokens_key(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES])
{
    size_t length = 0;
    key[0] = 0;
    for (int i = from; i < to; i++) {
        if (i > from && tokens->at[i].digits && tokens->at[i - 1].digits)
            add_to_key(key, &length, ".");
        add_to_key(key, &length, tokens->at[i].text);
    }
}

void name_tokens_folded(const struct name_tokens *tokens, int from, int to, char key[NAME_KEY_BYTES])
{
    size_t length = 0;
    key[0] = 0;
    for (int i = from; i < to; i++) {
        for (size_t zeros = strlen(tokens->at[i].text); tokens->at[i].digits && zeros < (size_t)tokens->at[i].raw_length; zeros++)
            add_to_key(key, &length, "0");
        add_to_key(key, &length, tokens->at[i].text);
    }
    for (char *c = key; *c; c++)
        *c = *c == 'O' ? '0' : *c == 'I' || *c == 'L' ? '1' : *c;
}

void name_tokens_split(const struct name_tokens *tokens, int from, int to, char digits[NAME_KEY_BYTES], char letters[NAME_KEY_BYTES])
{
    size_t digit_length = 0, letter_length = 0;
    digits[0] = letters[0] = 0;
    for (int i = from; i < to; i++)
        if (tokens->at[i].digits) {
            if (digit_length > 0)
                add_to_key(digits, &digit_length, ".");
            add_to_key(digits, &digit_length, tokens->at[i].text);
        } else {
            add_to_key(letters, &letter_length, tokens->at[i].text);
        }
}

bool name_tokens_have(const struct name_tokens *tokens, int from, int to, bool digits)
{
    for (int i = from; i < to; i++)
        if (tokens->at[i].digits == digits)
            return true;
    return false;
}

enum name_slip name_slip(const char *a, const char *b)
{
    size_t la = strlen(a), lb = strlen(b), same = 0;
    while (a[same] && a[same] == b[same])
        same++;
    if (la == lb && same == la)
        return NAME_SAME;
    if (la + 1 == lb)
        return strcmp(a + same, b + same + 1) == 0 ? NAME_SLIP : NAME_DIFFERENT;
    if (lb + 1 == la)
        return strcmp(a + same + 1, b + same) == 0 ? NAME_SLIP : NAME_DIFFERENT;
    if (la != lb)
        return NAME_DIFFERENT;
    if (a[same + 1] && a[same] == b[same + 1] && a[same + 1] == b[same] && strcmp(a + same + 2, b + same + 2) == 0)
        return NAME_SLIP;
    return strcmp(a + same + 1, b + same + 1) == 0 ? NAME_OTHER_LETTER : NAME_DIFFERENT;
}
