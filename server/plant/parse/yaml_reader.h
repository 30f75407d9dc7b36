/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads YAML mappings into structs, by tables of their allowed keys. Errors and warnings go to diag with line and column. Call from
   one thread only. */
#ifndef PLANT_PARSE_YAML_READER_H
#define PLANT_PARSE_YAML_READER_H
#include <stdbool.h>
#include <stddef.h>
#include <yaml.h>

#include "base/text/diag.h"

struct yaml_reader {
    char *path;
    struct diag *diag;
    yaml_document_t doc;
};

struct text_position {
    int line, column; /* position of a YAML node in the file; both count from 1 */
};

struct yaml_choice { /* allowed text of a YAML value, and the number that represents it; a table of choices ends with { 0 } */
    const char *name;
    double value;
};

enum key_kind {
    KEY_TEXT,   /* char *, any text */
    KEY_NAME,   /* member of type char *: a text that is not empty */
    KEY_NUMBER, /* double */
    KEY_INT,    /* int */
    KEY_CHOICE, /* member of type int or of an enum: one of the names in `choices` */
    KEY_FLAG,   /* bool, from `choices` */
    KEY_FACTOR, /* double, from `choices` */
    KEY_POINT,  /* double[3] */
    KEY_CUSTOM  /* member of any type: the function `read` reads the YAML value into it */
};

struct yaml_key { /* an allowed key of a YAML mapping; a table of keys ends with { 0 } */
    const char *name;
    enum key_kind kind;
    bool required;
    size_t offset;    /* byte offset of the member in the struct into which the mapping is read */
    double low, high; /* inclusive bounds of a number; low and high both 0: any finite number */
    const struct yaml_choice *choices;
    void (*read)(struct yaml_reader *reader, yaml_node_t *value, void *record);
};

#define YAML_MAP_MAX_KEYS 56
/* result of reading a mapping: the file positions of the mapping and its values, and whether each value was good */
struct yaml_map {
    const struct yaml_key *keys;
    struct text_position place;
    struct text_position values[YAML_MAP_MAX_KEYS];
    bool good[YAML_MAP_MAX_KEYS]; /* true: the key was given and its value was read without an error */
};

/* Parses a YAML file. Returns false if it is unreadable, not text or not YAML (reported); yaml_reader_close() is then not needed. The path
   is copied; diag must outlive the reader. */
bool yaml_reader_open(struct yaml_reader *reader, const char *path, struct diag *diag);
void yaml_reader_close(struct yaml_reader *reader);

struct text_position yaml_place(const yaml_node_t *node);
void yaml_error(struct yaml_reader *reader, struct text_position place, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
/* Reports that the value `name` at the position of a YAML node is not as expected: "NAME: expected ..., found ...". */
void yaml_expected(struct yaml_reader *reader, const yaml_node_t *node, const char *name, const char *expected);
/* Returns whether a YAML node is null: an empty plain scalar, `~` or `null` in lower case. The pointer must not be NULL. */
bool yaml_is_null(const yaml_node_t *node);
/* Returns the text of a YAML node that is a single value; NULL for lists and mappings. */
const char *yaml_text(const yaml_node_t *node);
/* Reads a finite number in [low, high]. Returns false, reported, if the node is not such a number. */
bool yaml_number(struct yaml_reader *reader, const yaml_node_t *node, const char *name, double low, double high, double *out);

/* Reads a YAML mapping into the struct `record`; members whose key is absent or null stay unchanged. `what` names the mapping
   in messages ("a group"). Returns false if the node is not a mapping. */
bool yaml_map_read(struct yaml_reader *reader, yaml_node_t *node, const char *what, const struct yaml_key *keys, void *record,
                   struct yaml_map *map);
/* Returns whether the key was given and its value read without an error. */
bool yaml_map_good(const struct yaml_map *map, const char *name);
/* Returns whether the mapping contains the key, with any value, even an invalid one. */
bool yaml_map_has(const struct yaml_map *map, const char *name);
/* Returns the position of a key's value; the position of the mapping if the key is absent. */
struct text_position yaml_map_place(const struct yaml_map *map, const char *name);

/* Returns the number of items of a YAML list; -1 if the node is not a list (reported). */
int yaml_list_count(struct yaml_reader *reader, const yaml_node_t *node, const char *name);
yaml_node_t *yaml_list_item(struct yaml_reader *reader, const yaml_node_t *node, int index);

#endif
