/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits the output of a model reader into records and fields. The reader may be compromised: fields may be missing and bytes may be
 * invalid UTF-8. */
#include "preprocess/import/findings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/utf8.h"

enum { MAX_FIELDS = 6, MAX_LISTED = 20000 };

static const char flat_node[] = "flat\t#";

/* Returns a copy of the text; invalid UTF-8 and control characters except tabs become '?'. The caller frees it with mem_free. */
static char *clean(const char *text, size_t length)
{
    struct text out = { 0 };
    text_add(&out, "%s", "");
    for (size_t i = 0, bytes; i < length; i += bytes) {
        bytes = utf8_length(text + i, length - i);
        bool shown = bytes > 0 && ((unsigned char)text[i] >= ' ' || text[i] == '\t') && text[i] != 0x7f;
        bytes = bytes > 0 ? bytes : 1;
        text_add_bytes(&out, shown ? text + i : "?", shown ? bytes : 1);
    }
    return out.at;
}

/* Splits a line of a reader's output at its tabs, which are overwritten. Missing fields become "". */
static void split(char *line, const char *fields[MAX_FIELDS])
{
    for (int i = 0; i < MAX_FIELDS; i++) {
        fields[i] = line;
        line += strcspn(line, "\t");
        if (*line && i < MAX_FIELDS - 1)
            *line++ = 0;
    }
}

static void append(json_t *model, const char *key, json_t *value)
{
    json_t *list = json_object_get(model, key);
    if (json_array_size(list) < MAX_LISTED)
        json_array_append_new(list, value);
    else
        json_decref(value);
}

static void add_lost(json_t *model, const char *const fields[MAX_FIELDS], struct text *plain)
{
    const char *id = fields[1], *name = fields[2], *class = fields[3], *guid = fields[4], *why = fields[5];
    json_int_t count = json_integer_value(json_object_get(model, "lost_count"));
    json_object_set_new(model, "lost_count", json_integer(count + 1));
    append(model, "lost", json_pack("{s:s,s:s,s:s,s:s,s:s}", "id", id, "name", name, "class", class, "guid", guid, "why", why));
    text_add(plain, "lost: %s%s%s%s(%s%s%s): %s\n", id, *id ? " " : "", name, *name ? " " : "", class, *guid ? ", " : "", guid, why);
}

static void add_line(json_t *model, char *line, struct text *plain)
{
    static const char left_out[] = "left out: ";
    const char *fields[MAX_FIELDS];
    if (!strncmp(line, "lost\t", 5) || !strncmp(line, flat_node, strlen(flat_node))) {
        split(line, fields);
        add_lost(model, fields, plain);
    } else if (!strncmp(line, "error\t", 6)) {
        split(line, fields);
        long count = strtol(fields[1], NULL, 10);
        append(model, "errors", json_pack("{s:I,s:s}", "count", (json_int_t)count, "text", fields[2]));
        if (count > 1)
            text_add(plain, "error, %ld times: %s\n", count, fields[2]);
        else
            text_add(plain, "error: %s\n", fields[2]);
    } else if (!strncmp(line, "unit\t", 5)) {
        split(line, fields);
        double length = strtod(fields[2], NULL);
        if (isfinite(length))
            json_object_set_new(model, "unit", json_pack("{s:s,s:f}", "taken", fields[1], "length", length));
    } else if (*line) {
        if (!strncmp(line, left_out, sizeof(left_out) - 1))
            append(model, "left_out", json_string(line + sizeof(left_out) - 1));
        text_add(plain, "%s\n", line);
    }
}

json_t *findings_read(const char *file, const char *said, const char *failed, struct text *plain)
{
    char *name = clean(file, strlen(file)), *why = failed ? clean(failed, strlen(failed)) : NULL;
    json_t *model = json_pack("{s:s,s:i,s:[],s:[],s:[],s:n,s:s?}", "file", name,
                              "lost_count", 0, "lost", "errors", "left_out", "unit", "failed", why);
    for (size_t length; *said; said += length + (said[length] == '\n')) {
        length = strcspn(said, "\n");
        char *line = clean(said, length);
        add_line(model, line, plain);
        mem_free(line);
    }
    mem_free(name);
    mem_free(why);
    return model;
}

void findings_print(const char *path, const char *lines, FILE *out)
{
    for (size_t length; lines && *lines; lines += length + (lines[length] == '\n')) {
        length = strcspn(lines, "\n");
        if (length > 0)
            fprintf(out, "%s: %.*s\n", path, (int)length, lines);
    }
}

double findings_guessed_m(const json_t *findings)
{
    const char *unit = json_member_text(json_object_get(findings, "unit"), "taken");
    return !unit ? 0 : !strcmp(unit, "m") ? 1 : !strcmp(unit, "mm") ? 1e-3 : 0;
}

void findings_flat_nodes(const char *said, bool *flat, size_t count)
{
    for (const char *line = said; *line; line += strcspn(line, "\n"), line += *line == '\n')
        if (!strncmp(line, flat_node, strlen(flat_node))) {
            unsigned long number = strtoul(line + strlen(flat_node), NULL, 10);
            if (number < count)
                flat[number] = true;
        }
}
