/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits a plant file: finds the byte ranges of values with libyaml, and replaces these ranges in the text. */
#include "preprocess/import/revision/asset_edit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "preprocess/match/plant_edit.h"

struct splice {
    size_t begin, end; /* byte range of the plant file's text to replace */
    char *with;
};

struct editor {
    const char *text;
    size_t *bytes; /* by character of the text (libyaml counts characters): its byte offset */
    yaml_document_t doc;
    struct splice *splices;
    size_t splice_count, splice_room;
    char *why;
};

static const char not_block_style[] =
    "import can edit the lists `assets` and `nodes` in the plant file only if each item is on a line of its own";

static bool fail(struct editor *editor, const char *why)
{
    snprintf(editor->why, ASSET_EDIT_WHY_BYTES, "%s", why);
    return false;
}

/* Records the replacement of a byte range of the text, and takes ownership of the new text `with`. */
static void splice(struct editor *editor, size_t begin, size_t end, char *with)
{
    mem_grow(&editor->splices, &editor->splice_room, editor->splice_count + 1, sizeof(*editor->splices));
    editor->splices[editor->splice_count++] = (struct splice){ begin, end, with };
}

static size_t byte_at(const struct editor *editor, yaml_mark_t mark)
{
    return editor->bytes[mark.index];
}

static char *quoted(const char *text)
{
    struct text out = { 0 };
    plant_edit_add_quoted(&out, text);
    return out.at;
}

static yaml_node_t *value_of(struct editor *editor, yaml_node_t *map, const char *name, yaml_node_t **key_out)
{
    for (yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair < map->data.mapping.pairs.top; pair++) {
        yaml_node_t *key = yaml_document_get_node(&editor->doc, pair->key);
        if (key->type == YAML_SCALAR_NODE && !strcmp((const char *)key->data.scalar.value, name)) {
            *key_out = key;
            return yaml_document_get_node(&editor->doc, pair->value);
        }
    }
    return NULL;
}

/* --- one asset ---------------------------------------------------------------------------------------------------------------- */

static size_t line_begin(const char *text, size_t at)
{
    while (at > 0 && text[at - 1] != '\n')
        at--;
    return at;
}

static size_t line_end(const char *text, size_t at)
{
    at += strcspn(text + at, "\n");
    return at + (text[at] == '\n');
}

/* Removes all lines of an item of a block-style YAML list from the text, including blank lines and comments between its keys. */
static bool remove_item(struct editor *editor, const yaml_node_t *item)
{
    const char *text = editor->text;
    size_t begin = line_begin(text, byte_at(editor, item->start_mark)), indent = strspn(text + begin, " "), end = line_end(text, begin),
           limit = byte_at(editor, item->end_mark);
    if (text[begin + indent] != '-')
        return fail(editor, not_block_style);
    for (size_t line = end; text[line]; line = line_end(text, line)) {
        size_t spaces = strspn(text + line, " ");
        char first = text[line + spaces];
        bool inside = line + spaces < limit, blank = !first || first == '\n' || first == '\r';
        if (!blank && ((inside && first != '#') || (spaces > indent && line == end)))
            end = line_end(text, line);
        else if (!inside)
            break;
    }
    splice(editor, begin, end, mem_strdup(""));
    return true;
}

static void replace_scalar(struct editor *editor, const yaml_node_t *node, const char *with)
{
    if (strcmp((const char *)node->data.scalar.value, with) != 0)
        splice(editor, byte_at(editor, node->start_mark), byte_at(editor, node->end_mark), quoted(with));
}

/* Adds each line of `lines` as a quoted string, with `separator` before each but the first string of `out`. */
static void add_quoted_lines(struct text *out, const char *lines, const char *separator)
{
    char *copy = mem_strdup(lines), *next = copy;
    for (char *line = strsep(&next, "\n"); line; line = strsep(&next, "\n")) {
        if (out->length > 0)
            text_add(out, "%s", separator);
        plant_edit_add_quoted(out, line);
    }
    mem_free(copy);
}

/* Replaces a list in flow style, or a single string, by a list in flow style. */
static void replace_by_flow_list(struct editor *editor, const yaml_node_t *list, const struct asset_edit *edit)
{
    struct text items = { 0 };
    for (size_t i = 0; i < edit->node_count; i++)
        if (edit->nodes[i])
            add_quoted_lines(&items, edit->nodes[i], ", ");
    splice(editor, byte_at(editor, list->start_mark), byte_at(editor, list->end_mark), mem_printf("[%s]", items.at ? items.at : ""));
    text_finish(&items);
}

/* Replaces the string of an item of a block-style YAML list by the first of `lines`, and adds an item for each further line. */
static bool replace_item(struct editor *editor, const yaml_node_t *item, const char *lines)
{
    const char *text = editor->text;
    size_t begin = line_begin(text, byte_at(editor, item->start_mark)), indent = strspn(text + begin, " ");
    struct text items = { 0 };
    if (!strchr(lines, '\n')) {
        replace_scalar(editor, item, lines);
        return true;
    }
    if (text[begin + indent] != '-')
        return fail(editor, not_block_style);
    char *separator = mem_printf("\n%*s- ", (int)indent, "");
    add_quoted_lines(&items, lines, separator);
    mem_free(separator);
    splice(editor, byte_at(editor, item->start_mark), byte_at(editor, item->end_mark), items.at);
    return true;
}

static bool edit_nodes(struct editor *editor, const yaml_node_t *value, const struct asset_edit *edit)
{
    bool good = true;
    if (value->type == YAML_SCALAR_NODE && edit->node_count == 1 && edit->nodes[0]) {
        if (strchr(edit->nodes[0], '\n'))
            replace_by_flow_list(editor, value, edit);
        else
            replace_scalar(editor, value, edit->nodes[0]);
        return true;
    }
    const yaml_node_item_t *items = value->data.sequence.items.start;
    if (value->type != YAML_SEQUENCE_NODE || value->data.sequence.items.top - items != (ptrdiff_t)edit->node_count)
        return fail(editor, "import cannot edit `nodes` of an asset in the plant file: write the nodes as a list");
    if (value->data.sequence.style == YAML_FLOW_SEQUENCE_STYLE) {
        replace_by_flow_list(editor, value, edit);
        return true;
    }
    for (size_t i = 0; i < edit->node_count && good; i++) {
        const yaml_node_t *item = yaml_document_get_node(&editor->doc, items[i]);
        if (edit->nodes[i])
            good = replace_item(editor, item, edit->nodes[i]);
        else
            good = remove_item(editor, item);
    }
    return good;
}

static void add_tag(struct editor *editor, const yaml_node_t *map, const yaml_node_t *id_key, const yaml_node_t *id, const char *tag)
{
    char *text = quoted(tag);
    char *with = map->data.mapping.style == YAML_FLOW_MAPPING_STYLE ? mem_printf(", tag: %s", text)
                                                                    : mem_printf("\n%*stag: %s", (int)id_key->start_mark.column, "", text);
    size_t at = byte_at(editor, id->end_mark);
    splice(editor, at, at, with);
    mem_free(text);
}

static bool edit_asset(struct editor *editor, yaml_node_t *map, const struct asset_edit *edit)
{
    yaml_node_t *key = NULL;
    if (edit->removed)
        return remove_item(editor, map);
    yaml_node_t *nodes = edit->nodes ? value_of(editor, map, "nodes", &key) : NULL;
    if (nodes && !edit_nodes(editor, nodes, edit))
        return false;
    yaml_node_t *tag = edit->tag ? value_of(editor, map, "tag", &key) : NULL;
    yaml_node_t *id = edit->tag ? value_of(editor, map, "id", &key) : NULL;
    if (tag && tag->type == YAML_SCALAR_NODE)
        replace_scalar(editor, tag, edit->tag);
    else if (id && !tag)
        add_tag(editor, map, key, id, edit->tag);
    return true;
}

/* --- the text ----------------------------------------------------------------------------------------------------------------- */

static int by_begin(const void *a, const void *b)
{
    const struct splice *x = a, *y = b;
    return (x->begin > y->begin) - (x->begin < y->begin);
}

static char *spliced(struct editor *editor)
{
    struct text out = { 0 };
    size_t at = 0;
    if (editor->splice_count > 0)
        qsort(editor->splices, editor->splice_count, sizeof(*editor->splices), by_begin);
    for (size_t i = 0; i < editor->splice_count; i++) {
        /* skip the replacement if a YAML alias repeats the value: the value was already replaced at its anchor */
        if (editor->splices[i].begin < at)
            continue;
        text_add_bytes(&out, editor->text + at, editor->splices[i].begin - at);
        text_add(&out, "%s", editor->splices[i].with);
        at = editor->splices[i].end;
    }
    text_add(&out, "%s", editor->text + at);
    return out.at;
}

static void find_characters(struct editor *editor)
{
    size_t length = strlen(editor->text), count = 0, mark = strncmp(editor->text, "\xEF\xBB\xBF", 3) ? 0 : 3;
    editor->bytes = mem_array(length + 2, sizeof(*editor->bytes));
    for (size_t i = mark; i < length; i++)
        if (((unsigned char)editor->text[i] & 0xc0) != 0x80)
            editor->bytes[count++] = i;
    editor->bytes[count] = length;
}

static bool edit_all(struct editor *editor, const struct asset_edit *edits, size_t count)
{
    yaml_node_t *root = yaml_document_get_root_node(&editor->doc), *key,
                *assets = root && root->type == YAML_MAPPING_NODE ? value_of(editor, root, "assets", &key) : NULL;
    if (!assets || assets->type != YAML_SEQUENCE_NODE ||
        assets->data.sequence.items.top - assets->data.sequence.items.start != (ptrdiff_t)count)
        return fail(editor, "import cannot edit `assets` in the plant file: write the assets as a list");
    bool good = true;
    for (size_t i = 0; i < count && good; i++)
        good = edit_asset(editor, yaml_document_get_node(&editor->doc, assets->data.sequence.items.start[i]), &edits[i]);
    return good;
}

char *asset_edit_apply(const char *text, const struct asset_edit *edits, size_t count, const char *added, char why[ASSET_EDIT_WHY_BYTES])
{
    struct editor editor = { .text = text, .why = why };
    yaml_parser_t parser;
    char *out = NULL;
    if (!yaml_parser_initialize(&parser))
        return NULL;
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, strlen(text));
    if (yaml_parser_load(&parser, &editor.doc)) {
        find_characters(&editor);
        if (edit_all(&editor, edits, count))
            out = spliced(&editor);
        yaml_document_delete(&editor.doc);
    } else {
        fail(&editor, "not valid YAML");
    }
    yaml_parser_delete(&parser);
    if (out && added) {
        char *longer = plant_edit_append(out, "assets", "", added);
        if (!longer)
            fail(&editor, "import can edit the list `assets` in the plant file only if each item is on a line of its own");
        mem_free(out);
        out = longer;
    }
    for (size_t i = 0; i < editor.splice_count; i++)
        mem_free(editor.splices[i].with);
    mem_free(editor.splices);
    mem_free(editor.bytes);
    return out;
}
