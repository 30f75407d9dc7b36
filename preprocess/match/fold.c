/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decomposes text into base characters and accents with utf8proc, replaces or drops characters, and recomposes the text. */
#include "preprocess/match/fold.h"

#include <stdbool.h>
#include <string.h>
#include <utf8proc.h>

#include "base/mem.h"
#include "base/text/text.h"

static bool is_ascii(const char *text)
{
    while (*text && !((unsigned char)*text & 0x80))
        text++;
    return !*text;
}

static bool is_dash(utf8proc_int32_t c)
{
    return utf8proc_category(c) == UTF8PROC_CATEGORY_PD || c == 0x2212 /* minus */ || c == 0x00ad /* soft hyphen */;
}

static bool is_blank(utf8proc_int32_t c)
{
    utf8proc_category_t category = utf8proc_category(c);
    return c == '\t' || category == UTF8PROC_CATEGORY_ZS || category == UTF8PROC_CATEGORY_ZL || category == UTF8PROC_CATEGORY_ZP;
}

/* Returns the text's Unicode code points in decomposed form, which the caller frees (mem_free), or NULL if the text is not valid UTF-8. */
static utf8proc_int32_t *decompose(const char *text, utf8proc_option_t options, utf8proc_ssize_t *count)
{
    const utf8proc_uint8_t *bytes = (const utf8proc_uint8_t *)text;
    utf8proc_ssize_t room = utf8proc_decompose(bytes, 0, NULL, 0, UTF8PROC_NULLTERM | options);
    if (room < 0)
        return NULL;
    utf8proc_int32_t *out = mem_array((size_t)room + 1, sizeof(*out));
    *count = utf8proc_decompose(bytes, 0, out, room, UTF8PROC_NULLTERM | options);
    return out;
}

static char *compose(utf8proc_int32_t *characters, utf8proc_ssize_t count)
{
    struct text out = { 0 };
    count = utf8proc_normalize_utf32(characters, count, UTF8PROC_COMPOSE | UTF8PROC_STABLE);
    text_add_bytes(&out, "", 0);
    for (utf8proc_ssize_t i = 0; i < count; i++) {
        utf8proc_uint8_t bytes[4];
        text_add_bytes(&out, bytes, (size_t)utf8proc_encode_char(characters[i], bytes));
    }
    mem_free(characters);
    return out.at;
}

char *fold_text(const char *text)
{
    utf8proc_ssize_t count = 0, kept = 0;
    utf8proc_int32_t *at = is_ascii(text) ? NULL : decompose(text, UTF8PROC_DECOMPOSE | UTF8PROC_COMPAT, &count);
    if (!at)
        return mem_strdup(text);
    for (utf8proc_ssize_t i = 0; i < count; i++) {
        if (utf8proc_category(at[i]) == UTF8PROC_CATEGORY_CF && at[i] != 0x00ad)
            continue; /* drop a zero-width blank or direction mark */
        utf8proc_int32_t c = is_dash(at[i]) ? '-' : is_blank(at[i]) ? ' ' : at[i];
        if (c != ' ' || (kept > 0 && at[kept - 1] != ' '))
            at[kept++] = c;
    }
    while (kept > 0 && at[kept - 1] == ' ')
        kept--;
    return compose(at, kept);
}

char *fold_key(const char *text)
{
    utf8proc_ssize_t count = 0, kept = 0;
    utf8proc_int32_t *at = decompose(text, UTF8PROC_DECOMPOSE | UTF8PROC_COMPAT | UTF8PROC_CASEFOLD, &count);
    if (!at)
        return mem_strdup("");
    for (utf8proc_ssize_t i = 0; i < count; i++) {
        const char *category = utf8proc_category_string(at[i]);
        bool accent = at[i] >= 0x300 && at[i] < 0x370;
        if (!accent && strchr("LNM", category[0]))
            at[kept++] = at[i];
    }
    return compose(at, kept);
}
