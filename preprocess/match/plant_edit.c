/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits the lines of a plant file (YAML). */
#include "preprocess/match/plant_edit.h"

#include <stdbool.h>
#include <string.h>

#include "base/mem.h"

const char plant_edit_placeholder[] = "  - { id: temperature, quantity: Temperature, unit: °C, min: 0, max: 100 }";

void plant_edit_add_quoted(struct text *out, const char *text)
{
    text_add(out, "\"");
    for (; *text; text++)
        text_add(out, *text == '"' || *text == '\\' ? "\\%c" : "%c", *text);
    text_add(out, "\"");
}

static const char *next_line(const char *line)
{
    line += strcspn(line, "\n");
    return line + (*line == '\n');
}

/* Finds the line `list:` of the plant file that has no value after the colon. Sets *flow if there is a value, which means a
 * list in flow style. Returns NULL if there is no such line. */
static const char *find_key(const char *text, const char *list, bool *flow)
{
    size_t length = strlen(list);
    for (const char *line = text; *line; line = next_line(line)) {
        if (strncmp(line, list, length) != 0 || line[length] != ':')
            continue;
        const char *behind = line + length + 1 + strspn(line + length + 1, " \t\r");
        *flow = *behind && *behind != '\n' && *behind != '#';
        return line;
    }
    return NULL;
}

/* Finds the byte range of a list's items: from the line after the list's key to the last item's last line. Excludes blank lines
 * and comments before the next key. */
static void find_items(const char *key, const char **begin, const char **end)
{
    *begin = *end = next_line(key);
    for (const char *line = *begin; *line; line = next_line(line)) {
        const char *first = line + strspn(line, " \t\r");
        if (*first == '\n' || !*first || (*first == '#' && first == line))
            continue;
        if (first == line && *first != '-')
            return;
        *end = next_line(line);
    }
}

static char *spliced(const char *text, const char *begin, const char *end, const char *lines)
{
    struct text out = { 0 };
    text_add_bytes(&out, text, (size_t)(begin - text));
    if (out.length > 0 && out.at[out.length - 1] != '\n')
        text_add(&out, "\n");
    text_add(&out, "%s%s", lines, end);
    return out.at;
}

/* Returns a copy of `lines`, indented like the list's existing items. The caller frees the text. */
static char *indented(const char *begin, const char *end, const char *lines)
{
    struct text out = { 0 };
    size_t indent = 2;
    for (const char *line = begin; line < end; line = next_line(line))
        if (line[strspn(line, " ")] == '-') {
            indent = strspn(line, " ");
            break;
        }
    text_add_bytes(&out, "", 0);
    for (const char *line = lines; *line; line = next_line(line)) {
        const char *first = line + strspn(line, " ");
        text_add(&out, "%*s%.*s", (int)indent, "", (int)(next_line(line) - first), first);
    }
    return out.at;
}

static char *edit(const char *text, const char *list, const char *comment, const char *lines, bool replace)
{
    bool flow = false;
    const char *key = find_key(text, list, &flow), *begin, *end;
    if (flow)
        return NULL;
    if (key) {
        find_items(key, &begin, &end);
        char *own = indented(begin, end, lines), *out = spliced(text, replace ? begin : end, end, own);
        mem_free(own);
        return out;
    }
    const char *tags = find_key(text, "tags", &flow);
    tags = tags ? tags : text + strlen(text);
    char *all = mem_printf("%s%s:\n%s\n", comment, list, lines), *out = spliced(text, tags, tags, all);
    mem_free(all);
    return out;
}

char *plant_edit_append(const char *text, const char *list, const char *comment, const char *lines)
{
    return edit(text, list, comment, lines, false);
}

char *plant_edit_replace(const char *text, const char *list, const char *lines)
{
    return edit(text, list, "", lines, true);
}

char *plant_edit_remove_line(const char *text, const char *line)
{
    size_t length = strlen(line);
    for (const char *at = text; *at; at = next_line(at))
        if (!strncmp(at, line, length) && (at[length] == '\n' || !at[length]))
            return spliced(text, at, next_line(at), "");
    return mem_strdup(text);
}
