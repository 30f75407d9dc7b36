/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates JSONPaths without compiling them: each evaluation parses the path step by step. */
#include "plant/sources/json_path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { INDEX_DIGITS = 6 };

static bool wrong(char why[200], const char *expected, const char *at)
{
    snprintf(why, 200, "%s, found '%.40s'", expected, at);
    return false;
}

static void skip_blanks(const char **at)
{
    *at += strspn(*at, " \t\r\n");
}

const char *json_path_begin(const char *text)
{
    text += *text == '$' || *text == '@';
    return text + (*text == '.');
}

/* --- strings ---------------------------------------------------------------------------------------------------------------- */

static bool add_byte(char out[JSON_PATH_TEXT_BYTES], size_t *count, unsigned byte)
{
    if (*count + 1 >= JSON_PATH_TEXT_BYTES)
        return false;
    out[(*count)++] = (char)byte;
    return true;
}

/* Appends the character of an escape \uXXXX as UTF-8. Returns false for \u0000 and for surrogates. */
static bool add_unicode(char out[JSON_PATH_TEXT_BYTES], size_t *count, const char *hex)
{
    char digits[5] = { 0 }, *end;
    memcpy(digits, hex, strnlen(hex, 4));
    unsigned long code = strtoul(digits, &end, 16);
    if (end != digits + 4 || code == 0 || (code >= 0xD800 && code < 0xE000))
        return false;
    if (code < 0x80)
        return add_byte(out, count, (unsigned)code);
    bool good = code < 0x800
                    ? add_byte(out, count, (unsigned)(0xC0 | code >> 6))
                    : add_byte(out, count, (unsigned)(0xE0 | code >> 12)) && add_byte(out, count, (unsigned)(0x80 | (code >> 6 & 0x3F)));
    return good && add_byte(out, count, (unsigned)(0x80 | (code & 0x3F)));
}

static bool add_escape(char out[JSON_PATH_TEXT_BYTES], size_t *count, const char **at)
{
    static const char names[] = "\"'\\/bfnrt", bytes[] = "\"'\\/\b\f\n\r\t";
    const char *p = *at + 1, *name = *p ? strchr(names, *p) : NULL;
    if (*p == 'u' && add_unicode(out, count, p + 1)) {
        *at = p + 5;
        return true;
    }
    *at = p + 1;
    return name && add_byte(out, count, (unsigned char)bytes[name - names]);
}

/* Reads a string literal in single or double quotes. Returns false with the reason in `why` if the text does not begin with one. */
static bool read_string(const char **at, char out[JSON_PATH_TEXT_BYTES], char why[200])
{
    const char *begin = *at, *p = begin + 1;
    size_t count = 0;
    bool good = true;
    while (good && *p && *p != *begin) {
        if (*p == '\\')
            good = p[1] && add_escape(out, &count, &p);
        else
            good = add_byte(out, &count, (unsigned char)*p++);
    }
    if (!good || !*p)
        return wrong(why, "expected a string of at most 127 bytes, closed by the same kind of quote", begin);
    out[count] = 0;
    *at = p + 1;
    return true;
}

/* --- filters ---------------------------------------------------------------------------------------------------------------- */

static bool read_word(const char **at, const char *word)
{
    size_t length = strlen(word);
    if (strncmp(*at, word, length) != 0 || (*at)[length] == '_' || strspn(*at + length, "abcdefghijklmnopqrstuvwxyz0123456789.[") > 0)
        return false;
    *at += length;
    return true;
}

/* Reads the literal (text, number, true, false or null) on the right-hand side of a comparison. Returns false with `why`
   unchanged if no literal begins here. */
static bool read_literal(const char **at, struct json_path_test *out, char why[200])
{
    static const char *const words[] = { "true", "false", "null" };
    if (**at == '\'' || **at == '"') {
        out->kind = JSON_LITERAL_STRING;
        return read_string(at, out->text, why);
    }
    for (int i = 0; i < 3; i++)
        if (read_word(at, words[i])) {
            out->kind = (enum json_literal_kind)(JSON_LITERAL_TRUE + i);
            return true;
        }
    size_t length = strspn(*at, "+-.0123456789eE");
    char *end = NULL;
    if (length == 0 || !strchr("-0123456789", **at) || (out->number = strtod(*at, &end), end != *at + length))
        return false;
    out->kind = JSON_LITERAL_NUMBER;
    *at = end;
    return true;
}

/* Reads the left-hand side of a comparison: `@.a.b`, `@['a']`, `@`, or just the name of a member. Returns false with the reason
   in `why` if that fails. */
static bool read_operand(const char **at, struct json_path_test *out, char why[200])
{
    struct json_path_step step;
    const char *p = *at;
    bool named = *p != '@';
    if (*p == '$' || *p == '!' || *p == '*')
        return wrong(why, "the path's filter must look like @.member == a string or number", *at);
    p += !named;
    p += !named && *p == '.';
    out->path = p;
    bool more = named || p[-1] == '.' || *p == '[';
    while (more) {
        if (!json_path_next_operand(&p, &step, why))
            return false;
        if (step.kind == JSON_PATH_FILTER)
            return wrong(why, "the path has a filter inside a filter, which Plantcast does not support", *at);
        more = p[-1] == '.' || *p == '[';
    }
    out->end = p;
    if (*p == '(')
        return wrong(why, "the path's filter has a function, which Plantcast does not support", *at);
    *at = p;
    return true;
}

static bool read_test(const char **at, struct json_path_test *out, char why[200])
{
    const char *begin = *at;
    *why = 0;
    bool literal_first = read_literal(at, out, why);
    if (!literal_first && (*why || !read_operand(at, out, why)))
        return false;
    skip_blanks(at);
    if (strncmp(*at, "==", 2) != 0)
        return wrong(why, "the path's filter needs ==, the only comparison that Plantcast supports", *at);
    *at += 2;
    skip_blanks(at);
    if (literal_first)
        return read_operand(at, out, why);
    return read_literal(at, out, why) ||
           (!*why && wrong(why, "the path's filter needs a string, a number, true, false or null after ==", begin));
}

/* Reads a filter's comparisons, joined by && and optionally in parentheses. Returns false with the reason in `why` if that fails. */
static bool read_tests(const char **at, struct json_path_step *out, int depth, char why[200])
{
    for (;;) {
        skip_blanks(at);
        if (**at == '(' && depth < JSON_PATH_MAX_TESTS) {
            ++*at;
            if (!read_tests(at, out, depth + 1, why))
                return false;
            if (**at != ')')
                return wrong(why, "expected )", *at);
            ++*at;
        } else if (out->test_count == JSON_PATH_MAX_TESTS) {
            return wrong(why, "the path's filter has more than 4 comparisons, the most that Plantcast supports", *at);
        } else if (!read_test(at, &out->tests[out->test_count++], why)) {
            return false;
        }
        skip_blanks(at);
        if (strncmp(*at, "&&", 2) != 0)
            return true;
        *at += 2;
    }
}

/* --- steps ------------------------------------------------------------------------------------------------------------------ */

static bool read_index(const char **at, long *out)
{
    const char *p = *at;
    bool negative = *p == '-';
    size_t digits = strspn(p += negative, "0123456789");
    long index = strtol(*at, NULL, 10);
    if (digits == 0 || digits > INDEX_DIGITS || (negative && index == 0))
        return false;
    *out = index;
    *at = p + digits;
    return true;
}

static const char *refusal_in_bracket(const char *at)
{
    switch (*at) {
    case '*': return "a wildcard selects several values; expected a path to one value";
    case ':': return "a slice selects several values; expected a path to one value";
    case ',': return "several selectors in one bracket select several values; expected a path to one value";
    case '|': return "the path's filter has ||, which Plantcast does not support";
    default: return "expected a path such as data.temperature, items[0].value or [\"odd name\"], and ]";
    }
}

/* Reads one step of a path in brackets: [0], [-1], ["name"], ['name'] or [?@.name=='text']. Returns false with the reason in `why` if that
   fails. */
static bool read_bracket(const char **at, struct json_path_step *out, char why[200])
{
    const char *begin = *at, *p = begin + 1;
    bool good = true;
    skip_blanks(&p);
    if (*p == '"' || *p == '\'') {
        out->kind = JSON_PATH_NAME;
        good = read_string(&p, out->name, why);
        if (good && !out->name[0])
            good = wrong(why, "expected a name that is not empty", begin);
    } else if (*p == '?') {
        p++;
        out->kind = JSON_PATH_FILTER;
        good = read_tests(&p, out, 0, why);
    } else {
        out->kind = JSON_PATH_INDEX;
        if (!read_index(&p, &out->index))
            return wrong(why, refusal_in_bracket(p), begin);
    }
    skip_blanks(&p);
    if (good && *p != ']')
        return wrong(why, refusal_in_bracket(p), p);
    *at = p + 1;
    return good;
}

static bool next(const char **at, struct json_path_step *out, const char *ends, char why[200])
{
    const char *p = *at;
    *out = (struct json_path_step){ .kind = JSON_PATH_NAME };
    if (*p == '[') {
        if (!read_bracket(&p, out, why))
            return false;
    } else {
        size_t length = strcspn(p, ends);
        if (length == 0 && *p == '.')
            return wrong(why, "descendants (..) select several values; expected a path to one value", p);
        if (length == 1 && *p == '*')
            return wrong(why, refusal_in_bracket(p), p);
        if (length == 0 || length >= sizeof(out->name))
            return wrong(why, "expected a path such as data.temperature, items[0].value or [\"odd name\"]", p);
        memcpy(out->name, p, length);
        p += length;
    }
    if (*p == '.' && p[1] == '.')
        return wrong(why, "descendants (..) select several values; expected a path to one value", p);
    if (*p == '.' && (!p[1] || p[1] == '['))
        return wrong(why, "expected a name after the dot in a path such as items[0].value", p);
    bool ended = !*p || *p == '[' || *p == '.' || strchr(ends, *p);
    if (!ended)
        return wrong(why, "expected . or [ in a path such as items[0].value", p);
    *at = p + (*p == '.');
    return true;
}

bool json_path_next(const char **at, struct json_path_step *out, char why[200])
{
    return next(at, out, ".[", why);
}

bool json_path_next_operand(const char **at, struct json_path_step *out, char why[200])
{
    return next(at, out, ".[ \t\r\n=!<>&|()],'\"*?", why);
}

bool json_path_check(const char *text, bool relative, char why[200])
{
    const char *at = json_path_begin(text);
    struct json_path_step step;
    if (*text == '@' && !relative)
        return wrong(why, "expected a path from the payload's root ($), not from the current value (@)", text);
    while (*at && json_path_next(&at, &step, why))
        ;
    return !*at;
}
