/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads YAML through libyaml's document API, which keeps the position of every node. */
#include "plant/parse/yaml_reader.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/parse/input.h"
#include "plant/parse/number.h"
#include "plant/parse/suggest.h"

/* --- the document ----------------------------------------------------------------------------------------------------------- */

static struct text_position place_of_byte(const char *text, size_t offset)
{
    struct text_position place = { 1, 1 };
    for (size_t i = 0; i < offset && text[i]; i++) {
        if (text[i] == '\n')
            place = (struct text_position){ place.line + 1, 1 };
        else if (((unsigned char)text[i] & 0xC0) != 0x80)
            place.column++;
    }
    return place;
}

/* Reports tabs in the indentation of the YAML file's lines: YAML forbids tabs there, but libyaml's message does not mention them. Returns
   whether any were found. */
static bool report_tabs(struct yaml_reader *reader, const char *text)
{
    bool any = false;
    int line = 1;
    for (const char *p = text; *p; line++) {
        size_t blanks = strspn(p, " "), all = strspn(p, " \t");
        if (all > blanks && !strchr("\r\n#", p[all])) {
            yaml_error(reader, (struct text_position){ line, (int)blanks + 1 }, "tab in the indentation; YAML needs spaces");
            any = true;
        }
        p += strcspn(p, "\n");
        p += *p == '\n';
    }
    return any;
}

static void report_syntax(struct yaml_reader *reader, const yaml_parser_t *parser, const char *text)
{
    struct text_position place = { (int)parser->problem_mark.line + 1, (int)parser->problem_mark.column + 1 };
    if (parser->error == YAML_READER_ERROR)
        place = place_of_byte(text, parser->problem_offset);
    else if (report_tabs(reader, text))
        return;
    const char *problem = parser->problem ? parser->problem : "out of memory";
    if (parser->context)
        yaml_error(reader, place, "invalid YAML: %s, %s that begins at line %zu", problem, parser->context, parser->context_mark.line + 1);
    else
        yaml_error(reader, place, "invalid YAML: %s", problem);
}

static void report_second_document(struct yaml_reader *reader, yaml_parser_t *parser, const char *text)
{
    yaml_document_t second;
    if (!yaml_parser_load(parser, &second)) {
        report_syntax(reader, parser, text);
        return;
    }
    yaml_node_t *root = yaml_document_get_root_node(&second);
    if (root)
        yaml_error(reader, yaml_place(root), "a second YAML document begins here; expected only one document");
    yaml_document_delete(&second);
}

static bool load_document(struct yaml_reader *reader, const char *text, size_t bytes)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) {
        diag_error(reader->diag, reader->path, 0, 0, "out of memory");
        return false;
    }
    yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, bytes);
    bool loaded = yaml_parser_load(&parser, &reader->doc);
    if (!loaded) {
        report_syntax(reader, &parser, text);
    } else if (!yaml_document_get_root_node(&reader->doc)) {
        diag_error(reader->diag, reader->path, 1, 1, "is empty");
        yaml_document_delete(&reader->doc);
        loaded = false;
    } else {
        report_second_document(reader, &parser, text);
    }
    yaml_parser_delete(&parser);
    return loaded;
}

bool yaml_reader_open(struct yaml_reader *reader, const char *path, struct diag *diag)
{
    size_t bytes;
    char *text = input_read(path, "a plant file (YAML)", diag, &bytes);
    if (!text)
        return false;
    *reader = (struct yaml_reader){ .path = mem_strdup(path), .diag = diag };
    bool loaded = load_document(reader, text, bytes);
    mem_free(text);
    if (!loaded)
        mem_free(reader->path);
    return loaded;
}

void yaml_reader_close(struct yaml_reader *reader)
{
    yaml_document_delete(&reader->doc);
    mem_free(reader->path);
    *reader = (struct yaml_reader){ 0 };
}

/* --- nodes ------------------------------------------------------------------------------------------------------------------ */

struct text_position yaml_place(const yaml_node_t *node)
{
    return (struct text_position){ (int)node->start_mark.line + 1, (int)node->start_mark.column + 1 };
}

void yaml_error(struct yaml_reader *reader, struct text_position place, const char *fmt, ...)
{
    struct text text = { 0 };
    va_list ap;
    va_start(ap, fmt);
    text_add_v(&text, fmt, ap);
    va_end(ap);
    diag_error(reader->diag, reader->path, place.line, place.column, "%s", text.at);
    text_finish(&text);
}

const char *yaml_text(const yaml_node_t *node)
{
    return node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

static bool is_plain(const yaml_node_t *node)
{
    return node->type == YAML_SCALAR_NODE && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
}

bool yaml_is_null(const yaml_node_t *node)
{
    if (!is_plain(node))
        return false;
    const char *text = yaml_text(node);
    return !*text || !strcmp(text, "~") || !strcmp(text, "null");
}

void yaml_expected(struct yaml_reader *reader, const yaml_node_t *node, const char *name, const char *expected)
{
    struct text_position place = yaml_place(node);
    const char *text = yaml_text(node);
    if (!text)
        yaml_error(reader, place, "%s: expected %s, found a %s", name, expected, node->type == YAML_SEQUENCE_NODE ? "list" : "mapping");
    else if (is_plain(node) || !*text)
        yaml_error(reader, place, "%s: expected %s, found '%.60s'", name, expected, text);
    else
        yaml_error(reader, place, "%s: expected %s, found the text \"%.60s\"", name, expected, text);
}

static void expected_number(struct yaml_reader *reader, const yaml_node_t *node, const char *name, const char *what, double low,
                            double high)
{
    char expected[120];
    if ((low == 0 && high == 0) || high >= 1e30)
        snprintf(expected, sizeof(expected), "a %s", what);
    else
        snprintf(expected, sizeof(expected), "a %s from %.9g to %.9g", what, low, high);
    yaml_expected(reader, node, name, expected);
}

bool yaml_number(struct yaml_reader *reader, const yaml_node_t *node, const char *name, double low, double high, double *out)
{
    double value = 0;
    enum number_result result = is_plain(node) ? number_parse(yaml_text(node), &value) : NUMBER_NOT_A_NUMBER;
    bool any = low == 0 && high == 0;
    if (result == NUMBER_GOOD && (any || (value >= low && value <= high))) {
        *out = value;
        return true;
    }
    expected_number(reader, node, name, result == NUMBER_NOT_FINITE ? "finite number" : "number", low, high);
    return false;
}

/* --- mappings --------------------------------------------------------------------------------------------------------------- */

static void read_text(struct yaml_reader *reader, const yaml_node_t *node, const struct yaml_key *key, char **out)
{
    const char *text = yaml_text(node);
    if (!text || (key->kind == KEY_NAME && !*text)) {
        yaml_expected(reader, node, key->name, "text");
        return;
    }
    if (memchr(text, 0, node->data.scalar.length)) {
        yaml_error(reader, yaml_place(node), "%s: contains a NUL character", key->name);
        return;
    }
    mem_free(*out);
    *out = mem_strdup(text);
}

static void read_int(struct yaml_reader *reader, const yaml_node_t *node, const struct yaml_key *key, int *out)
{
    double value;
    bool good = is_plain(node) && number_parse(yaml_text(node), &value) == NUMBER_GOOD && value == floor(value);
    if (good && value >= key->low && value <= key->high)
        *out = (int)value;
    else
        expected_number(reader, node, key->name, "whole number", key->low, key->high);
}

static const struct yaml_choice *read_choice(struct yaml_reader *reader, const yaml_node_t *node, const struct yaml_key *key)
{
    const char *text = yaml_text(node);
    const struct yaml_choice *choice = key->choices;
    while (choice->name && (!text || strcmp(choice->name, text) != 0))
        choice++;
    if (choice->name)
        return choice;
    struct text expected = { 0 };
    for (choice = key->choices; choice->name; choice++)
        text_add(&expected, "%s%s", choice == key->choices ? "" : choice[1].name ? ", " : " or ", choice->name);
    yaml_expected(reader, node, key->name, expected.at);
    text_finish(&expected);
    return NULL;
}

static void read_point(struct yaml_reader *reader, const yaml_node_t *node, const struct yaml_key *key, double *out)
{
    double point[3];
    if (node->type != YAML_SEQUENCE_NODE || node->data.sequence.items.top - node->data.sequence.items.start != 3) {
        yaml_expected(reader, node, key->name, "a list of three numbers such as [1.5, 0, 2]");
        return;
    }
    bool good = true;
    for (int i = 0; i < 3; i++)
        good &= yaml_number(reader, yaml_list_item(reader, node, i), key->name, key->low, key->high, &point[i]);
    if (good)
        memcpy(out, point, sizeof(point));
}

static void read_value(struct yaml_reader *reader, yaml_node_t *node, const struct yaml_key *key, void *record)
{
    char *out = (char *)record + key->offset;
    const struct yaml_choice *choice;
    switch (key->kind) {
    case KEY_TEXT:
    case KEY_NAME:
        read_text(reader, node, key, (char **)(void *)out);
        break;
    case KEY_NUMBER:
        yaml_number(reader, node, key->name, key->low, key->high, (double *)(void *)out);
        break;
    case KEY_INT:
        read_int(reader, node, key, (int *)(void *)out);
        break;
    case KEY_CHOICE:
        choice = read_choice(reader, node, key);
        if (choice)
            *(int *)(void *)out = (int)choice->value;
        break;
    case KEY_FLAG:
        choice = read_choice(reader, node, key);
        if (choice)
            *(bool *)(void *)out = choice->value != 0;
        break;
    case KEY_FACTOR:
        choice = read_choice(reader, node, key);
        if (choice)
            *(double *)(void *)out = choice->value;
        break;
    case KEY_POINT:
        read_point(reader, node, key, (double *)(void *)out);
        break;
    case KEY_CUSTOM:
        key->read(reader, node, record);
        break;
    }
}

static size_t count_keys(const struct yaml_key *keys)
{
    size_t count = 0;
    while (keys[count].name)
        count++;
    assert(count <= YAML_MAP_MAX_KEYS);
    return count;
}

static size_t find_key(const struct yaml_key *keys, const char *name)
{
    size_t i = 0;
    while (keys[i].name && strcmp(keys[i].name, name) != 0)
        i++;
    return i;
}

static void report_unknown(struct yaml_reader *reader, const yaml_node_t *node, const char *what, const struct yaml_key *keys)
{
    const char *near = suggest_nearest(yaml_text(node), keys, count_keys(keys), sizeof(*keys));
    if (near) {
        yaml_error(reader, yaml_place(node), "unknown key '%.60s' in %s; did you mean '%s'?", yaml_text(node), what, near);
        return;
    }
    struct text known = { 0 };
    for (const struct yaml_key *key = keys; key->name; key++)
        text_add(&known, "%s%s", key == keys ? "" : ", ", key->name);
    yaml_error(reader, yaml_place(node), "unknown key '%.60s' in %s; expected one of: %s", yaml_text(node), what, known.at);
    text_finish(&known);
}

static void read_pair(struct yaml_reader *reader, const yaml_node_pair_t *pair, const char *what, void *record, struct yaml_map *map)
{
    yaml_node_t *name = yaml_document_get_node(&reader->doc, pair->key), *value = yaml_document_get_node(&reader->doc, pair->value);
    if (!yaml_text(name)) {
        yaml_expected(reader, name, what, "the name of a key");
        return;
    }
    const struct yaml_key *key = &map->keys[find_key(map->keys, yaml_text(name))];
    struct text_position *place = &map->values[key - map->keys];
    if (!key->name) {
        report_unknown(reader, name, what, map->keys);
    } else if (place->line) {
        yaml_error(reader, yaml_place(name), "key '%s' is listed twice (first at line %d)", key->name, place->line);
    } else {
        int errors = reader->diag->errors;
        *place = yaml_place(value);
        if (!yaml_is_null(value))
            read_value(reader, value, key, record);
        else if (key->required)
            yaml_expected(reader, value, key->name, "a value");
        map->good[key - map->keys] = !yaml_is_null(value) && reader->diag->errors == errors;
    }
}

bool yaml_map_read(struct yaml_reader *reader, yaml_node_t *node, const char *what, const struct yaml_key *keys, void *record,
                   struct yaml_map *map)
{
    *map = (struct yaml_map){ .keys = keys, .place = yaml_place(node) };
    if (node->type != YAML_MAPPING_NODE) {
        yaml_expected(reader, node, what, "a mapping (key: value)");
        return false;
    }
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++)
        read_pair(reader, pair, what, record, map);
    for (size_t i = 0; i < count_keys(keys); i++)
        if (keys[i].required && !map->values[i].line)
            yaml_error(reader, map->place, "%s needs the key '%s'", what, keys[i].name);
    return true;
}

bool yaml_map_good(const struct yaml_map *map, const char *name)
{
    return map->keys && map->good[find_key(map->keys, name)];
}

bool yaml_map_has(const struct yaml_map *map, const char *name)
{
    return map->values[find_key(map->keys, name)].line != 0;
}

struct text_position yaml_map_place(const struct yaml_map *map, const char *name)
{
    struct text_position place = map->values[find_key(map->keys, name)];
    return place.line ? place : map->place;
}

/* --- lists ------------------------------------------------------------------------------------------------------------------ */

int yaml_list_count(struct yaml_reader *reader, const yaml_node_t *node, const char *name)
{
    if (node->type == YAML_SEQUENCE_NODE)
        return (int)(node->data.sequence.items.top - node->data.sequence.items.start);
    yaml_expected(reader, node, name, "a list (lines that begin with -)");
    return -1;
}

yaml_node_t *yaml_list_item(struct yaml_reader *reader, const yaml_node_t *node, int index)
{
    return yaml_document_get_node(&reader->doc, node->data.sequence.items.start[index]);
}
