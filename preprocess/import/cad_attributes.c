/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses attribute files of RVM models line by line. Matches an element of the file with the model node of the same name below
 * the enclosing element's node; if there is none, with any node of that name. */
#include "preprocess/import/cad_attributes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/import/encoding.h"

enum { MAX_DEPTH = 1000 };

struct node_key { /* an entry of the model's two sorted node indexes: by parent and name, and by name alone */
    const char *name;
    int parent, node;
};

struct index {
    struct node_key *below, *anywhere;
    size_t count;
};

static int by_parent(const void *a, const void *b)
{
    const struct node_key *x = a, *y = b;
    return x->parent != y->parent ? (x->parent > y->parent) - (x->parent < y->parent) : strcmp(x->name, y->name);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct node_key *)a)->name, ((const struct node_key *)b)->name);
}

static void index_init(struct index *index, const struct cad_model *model)
{
    index->count = model->node_count;
    index->below = mem_array(index->count + 1, sizeof(*index->below));
    index->anywhere = mem_array(index->count + 1, sizeof(*index->anywhere));
    for (size_t i = 0; i < index->count; i++)
        index->below[i] = (struct node_key){ model->nodes[i].name, model->nodes[i].parent, (int)i };
    memcpy(index->anywhere, index->below, index->count * sizeof(*index->below));
    qsort(index->below, index->count, sizeof(*index->below), by_parent);
    qsort(index->anywhere, index->count, sizeof(*index->anywhere), by_name);
}

static int find(const struct index *index, int parent, const char *name)
{
    struct node_key key = { name, parent, -1 };
    const struct node_key *found = bsearch(&key, index->below, index->count, sizeof(key), by_parent);
    if (!found)
        found = bsearch(&key, index->anywhere, index->count, sizeof(key), by_name);
    return found ? found->node : -1;
}

static char *trim(char *text)
{
    text += strspn(text, " \t");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r", text[length - 1]))
        text[--length] = 0;
    if (length >= 2 && text[0] == '\'' && text[length - 1] == '\'') {
        text[length - 1] = 0;
        text++;
    }
    return text;
}

/* Parses the "key:= value" entries of a line, separated by `separator`, and adds them to the node's attributes. */
static void take_line(struct cad_model *model, int node, char *line, const char *separator, struct attribute_counts *counts)
{
    for (char *next; line; line = next) {
        next = separator[0] ? strstr(line, separator) : NULL;
        if (next) {
            *next = 0;
            next += strlen(separator);
        }
        char *value = strstr(line, ":=");
        if (!value || node < 0)
            continue;
        *value = 0;
        value = trim(value + 2);
        char *key = trim(line);
        if (*key && *value) {
            cad_node_add_attribute(&model->nodes[node], key, value);
            counts->attributes++;
        }
    }
}

/* Reads the entry separator from the attribute file's header line: the text after "sep:", such as "&end&". */
static void take_separator(const char *line, char *separator, size_t separator_bytes)
{
    const char *at = strstr(line, "sep:");
    if (!at)
        return;
    at += strlen("sep:");
    at += strspn(at, " ");
    snprintf(separator, separator_bytes, "%.*s", (int)strcspn(at, " ,\r\n"), at);
}

static bool read_lines(struct cad_model *model, char *text, size_t length, struct attribute_counts *counts, char *why, size_t why_bytes)
{
    struct index index;
    int stack[MAX_DEPTH], depth = 0;
    char separator[16] = "&end&";
    size_t number = 0;
    bool good = true;
    index_init(&index, model);
    for (size_t at = 0; at < length && good;) {
        char *end = memchr(text + at, '\n', length - at);
        size_t bytes = end ? (size_t)(end - text) - at : length - at;
        text[at + bytes] = 0;
        for (char *c = text + at; *c; c++)
            if ((unsigned char)*c < 32 || *c == 127)
                *c = ' ';
        char *word = trim(text + at);
        at += bytes + 1;
        if (++number == 1)
            take_separator(word, separator, sizeof(separator));
        if (!strncmp(word, "NEW ", 4) && depth == MAX_DEPTH) {
            snprintf(why, why_bytes, "line %zu of the attribute file: elements are nested more than %d deep", number, MAX_DEPTH);
            good = false;
        } else if (!strncmp(word, "NEW ", 4)) {
            int node = find(&index, depth > 0 ? stack[depth - 1] : -1, trim(word + 4));
            stack[depth++] = node;
            counts->elements++;
            counts->matched += node >= 0;
        } else if (!strcmp(word, "END") && depth == 0) {
            snprintf(why, why_bytes, "line %zu of the attribute file: END without an element (NEW) that it could end", number);
            good = false;
        } else if (!strcmp(word, "END")) {
            depth--;
        } else if (depth > 0) {
            take_line(model, stack[depth - 1], word, separator, counts);
        }
    }
    if (good && depth > 0) {
        snprintf(why, why_bytes, "line %zu: the attribute file ends before the END of %d element%s", number, depth, depth > 1 ? "s" : "");
        good = false;
    }
    mem_free(index.below);
    mem_free(index.anywhere);
    return good;
}

bool cad_attributes_read(struct cad_model *model, const char *bytes, size_t count, const struct attribute_params *params,
                         struct attribute_counts *counts, char *why, size_t why_bytes)
{
    struct charset_text text;
    *counts = (struct attribute_counts){ .encoding = encoding_choose(bytes, count, params->encoding, params->model_encoding) };
    charset_decode(bytes, count, counts->encoding.name, &text);
    bool good = read_lines(model, text.utf8, text.length, counts, why, why_bytes);
    mem_free(text.utf8);
    return good;
}
