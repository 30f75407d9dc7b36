/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the page's files of words: [section], then `key: text` or `key(plural): text`, with {name} where something is put in. */
#include "words.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/embedded.h"
#include "base/mem.h"
#include "render/overlay/overlay_words.h"
#include "render/overlay/text_face.h"

enum { TEXTS = 32, TEXT_BYTES = 512, FILES = 2, MOST_PAIRS = 8 };
static const char *files[FILES];
static bool has_plurals = true;
static enum language chosen;

static char *next_text(void)
{
    static char texts[TEXTS][TEXT_BYTES];
    static int next;
    next = (next + 1) % TEXTS;
    return texts[next];
}

enum language words_language(void)
{
    return chosen;
}

bool words_choose(const char *language)
{
    static const char *const names[] = { "clients/web/words/%s.js", "clients/web/words/lazy.%s.js" };
    if (strcmp(language, "en") != 0 && strcmp(language, "ko") != 0 && strcmp(language, "de") != 0)
        return false;
    for (int i = 0; i < FILES; i++) {
        char *name = mem_printf(i ? names[1] : names[0], language);
        files[i] = embedded_find(name);
        mem_free(name);
    }
    has_plurals = strcmp(language, "ko") != 0;
    overlay_language_find(language, &chosen);
    if (!text_face_has(overlay_word(chosen, WORD_NO_DATA)))
        fprintf(stderr, "no installed font has the letters of --language %s: boxes stand in their place (package fonts-nanum)\n", language);
    return files[0] && files[1];
}

/* The text of one line, up to its end; NULL: it is not in this file. */
static const char *find_in(const char *file, const char *section, size_t section_length, const char *key)
{
    size_t length = strlen(key);
    bool inside = section_length == 0;
    for (const char *line = file; line && *line; line = strchr(line, '\n'), line += line != NULL) {
        if (*line == '[')
            inside = strlen(line) > section_length + 1 && !strncmp(line + 1, section, section_length) && line[1 + section_length] == ']';
        else if (inside && !strncmp(line, key, length) && line[length] == ':')
            return line + length + 2;
    }
    return NULL;
}

static const char *find(const char *key, const char *plural)
{
    const char *dot = strchr(key, '.');
    size_t section_length = dot ? (size_t)(dot - key) : 0;
    char own[64];
    snprintf(own, sizeof(own), plural ? "%s(%s)" : "%s", dot ? dot + 1 : key, plural);
    for (int i = 0; i < FILES; i++) {
        const char *text = find_in(files[i], key, section_length, own);
        if (text)
            return text;
    }
    return NULL;
}

static const char *value_of(const char *const pairs[][2], const char *name, size_t length)
{
    for (int i = 0; pairs[i][0]; i++)
        if (strlen(pairs[i][0]) == length && !strncmp(pairs[i][0], name, length))
            return pairs[i][1];
    return "";
}

/* A line, and those after it that are indented; `…` escapes of the file do not occur in what is asked for. */
static void put_in(const char *text, const char *const pairs[][2], char *out)
{
    size_t n = 0;
    while (*text && n + 1 < TEXT_BYTES) {
        if (*text == '\n' && text[1] != ' ')
            break;
        if (*text == '\n') {
            text += 1 + strspn(text + 1, " ");
            out[n++] = ' ';
        } else if (*text == '{') {
            size_t length = strcspn(text + 1, "}");
            int more = snprintf(out + n, TEXT_BYTES - n, "%s", value_of(pairs, text + 1, length));
            n = n + (size_t)more < TEXT_BYTES ? n + (size_t)more : TEXT_BYTES - 1;
            text += length + 1;
            text += *text == '}';
        } else {
            out[n++] = *text++;
        }
    }
    out[n] = 0;
}

const char *say(const char *key, ...)
{
    const char *pairs[MOST_PAIRS + 1][2] = { { NULL, NULL } };
    char *out = next_text();
    va_list ap;
    va_start(ap, key);
    for (int i = 0; i < MOST_PAIRS && (pairs[i][0] = va_arg(ap, const char *)) != NULL; i++)
        pairs[i][1] = va_arg(ap, const char *);
    va_end(ap);
    const char *count = value_of((const char *const(*)[2])pairs, "count", 5);
    const char *text = find(key, NULL);
    if (!text && has_plurals && !strcmp(count, "1"))
        text = find(key, "one");
    if (!text)
        text = find(key, "other");
    put_in(text ? text : key, (const char *const(*)[2])pairs, out);
    return out;
}

const char *say_number(double value, int decimals)
{
    char *out = next_text();
    double shown = fabs(value) < 0.5 * pow(10, -decimals) ? 0 : value;
    snprintf(out, TEXT_BYTES, "%s%.*f", shown < 0 ? "\u2212" : "", decimals, fabs(shown));
    return out;
}

const char *say_age(int64_t age_ns)
{
    double s = (double)age_ns / 1e9;
    if (age_ns < 0)
        return "\u2013";
    if (s < 9.95)
        return say("age.s", "n", say_number(s, 1), NULL);
    if (s < 120)
        return say("age.s", "n", say_number(s, 0), NULL);
    if (s < 7200)
        return say("age.min", "n", say_number(floor(s / 60), 0), NULL);
    return s < 172800 ? say("age.h", "n", say_number(floor(s / 3600), 0), NULL) : say("age.d", "n", say_number(floor(s / 86400), 0), NULL);
}
