/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads Ignition's export. Folders and UDT instances (instances of user-defined types) contain tags, and tags have properties. A UDT
 * instance has the members of its type, and of all parents of that type. The instance and each type may override single properties. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "preprocess/match/tag_export.h"
#include "preprocess/match/table.h"
#include "preprocess/match/tag_names.h"

enum { MAX_DEPTH = 64, MAX_LAYERS = 32, MAX_REFERENCES = 1000 };

static const struct property {
    const char *name;
    enum export_field field;
} properties[] = {
    { "opcItemPath", EXPORT_ADDRESS },       { "dataType", EXPORT_TYPE },       { "engUnit", EXPORT_UNIT },
    { "documentation", EXPORT_DESCRIPTION }, { "tooltip", EXPORT_DESCRIPTION }, { "opcServer", EXPORT_DEVICE },
};

struct tag_json_reader {
    struct tag_export *list;
    json_t *types; /* definitions of user-defined types (UDT), by path within the export's folder of types; borrowed */
    struct tag_names unknown, circular, unresolved, without;
    bool too_deep, too_many;
    /* number of references to parameters resolved for the current property; limited, because parameters may refer to each other in a
     * cycle */
    int references;
};

/* an element of the export (folder, instance or tag) as a stack of definitions ("layers"): its own definition first, then those
 * of its types */
struct layered_node {
    json_t *layers[MAX_LAYERS];
    int count;
};

struct instance_frame { /* an instance of a user-defined type (UDT) that contains a tag */
    const struct instance_frame *outer;
    const struct layered_node *node;
    /* number of layers (definitions) of the instance itself, not of its types; parameters in these layers refer to the
     * enclosing instance */
    int own;
    const char *name;
};

struct scope { /* context in which parameter references are resolved: the tag, its folder and the UDT instances that contain it */
    struct tag_json_reader *reader;
    const struct instance_frame *frame;
    const char *folder, *name; /* path of the tag's folder; name of the tag */
};

static const char *text_of(json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static json_t *property_of(const struct layered_node *node, const char *key)
{
    json_t *found = NULL;
    for (int i = 0; i < node->count && (!found || json_is_null(found)); i++)
        found = json_object_get(node->layers[i], key);
    return found;
}

static const char *string_of(const struct layered_node *node, const char *key)
{
    const char *text = json_string_value(property_of(node, key));
    return text ? text : "";
}

static void complain(struct tag_names *names, const char *folder, const char *name, const char *detail)
{
    char *path = mem_printf("%s%s%.80s", folder, *folder ? "/" : "", name);
    tag_names_add(names, path, "%.80s", detail);
    mem_free(path);
}

/* --- types ------------------------------------------------------------------------------------------------------------------ */

static const char types_folder[] = "_types_";

/* Indexes the definitions of all user-defined types. `path` is relative to the export's folder of types. */
static void index_types(struct tag_json_reader *reader, json_t *node, const char *path, int depth)
{
    json_t *inner = json_is_array(node) ? node : json_object_get(node, "tags"), *item;
    const char *name = text_of(node, "name");
    size_t index;
    bool root = json_is_array(node) || !*name || !strcmp(text_of(node, "tagType"), "Provider");
    char *below = !strcmp(name, types_folder) || root ? mem_strdup(root ? path : "") : mem_printf("%s%s%s", path, *path ? "/" : "", name);
    if (!strcmp(text_of(node, "tagType"), "UdtType"))
        json_object_set(reader->types, below, node);
    else if (depth < MAX_DEPTH)
        json_array_foreach(inner, index, item) index_types(reader, item, below, depth + 1);
    mem_free(below);
}

/* Returns the type definition whose path in the export is `id`, or else the only type with that name, ignoring case. NULL:
 * there is no such type, or several have the name. */
static json_t *find_type(const struct tag_json_reader *reader, const char *id)
{
    const char *wanted = !strncmp(id, "_types_/", 8) ? id + 8 : id, *slash = strrchr(wanted, '/'), *name = slash ? slash + 1 : wanted, *key;
    json_t *type = json_object_get(reader->types, wanted), *other = NULL;
    size_t same = 0;
    if (type)
        return type;
    json_object_foreach(reader->types, key, type)
    {
        const char *last = strrchr(key, '/');
        if (!strcasecmp(last ? last + 1 : key, name)) {
            other = type;
            same++;
        }
    }
    return same == 1 ? other : NULL;
}

static bool is_around(const struct instance_frame *frame, const json_t *type)
{
    for (; frame; frame = frame->outer)
        for (int i = frame->own; i < frame->node->count; i++)
            if (frame->node->layers[i] == type)
                return true;
    return false;
}

/* Appends the definitions of an instance's type and the type's parents to its layers. */
static void add_types(struct tag_json_reader *reader, struct layered_node *node, const struct instance_frame *outer, const char *folder,
                      const char *name)
{
    const char *id = string_of(node, "typeId");
    for (int own = node->count; *id && node->count < MAX_LAYERS; id = text_of(node->layers[node->count - 1], "typeId")) {
        json_t *type = find_type(reader, id);
        bool circular = type && is_around(outer, type);
        for (int i = own; i < node->count; i++)
            circular |= node->layers[i] == type;
        if (!type || circular) {
            complain(type ? &reader->circular : &reader->unknown, folder, name, id);
            return;
        }
        node->layers[node->count++] = type;
    }
}

/* --- parameters --------------------------------------------------------------------------------------------------------------- */

static bool expand(const struct scope *scope, const char *text, struct text *out, int depth);

static const char *builtin(const struct scope *scope, const char *name, char **made)
{
    const struct instance_frame *frame = scope->frame, *root = frame;
    while (root && root->outer)
        root = root->outer;
    if (!strcmp(name, "TagName"))
        return scope->name;
    if (!strcmp(name, "PathToParentFolder"))
        return scope->folder;
    if (!strcmp(name, "PathToTag"))
        return *made = mem_printf("%s%s%s", scope->folder, *scope->folder ? "/" : "", scope->name);
    if (!strcmp(name, "InstanceName"))
        return frame ? frame->name : NULL;
    if (!strcmp(name, "ParentInstanceName"))
        return frame ? (frame->outer ? frame->outer->name : frame->name) : NULL;
    return !strcmp(name, "RootInstanceName") && root ? root->name : NULL;
}

static json_t *value_of(json_t *parameter)
{
    return json_is_object(parameter) && json_object_get(parameter, "value") ? json_object_get(parameter, "value") : parameter;
}

/* Appends the text of a property's value: a number, a text, or a binding to parameters. Returns false if a parameter cannot be resolved. */
static bool add_value(const struct scope *scope, json_t *value, struct text *out, int depth)
{
    if (json_is_object(value)) {
        const char *kind = text_of(value, "bindType");
        if (*kind && strcmp(kind, "parameter") != 0 && strcmp(kind, "UDTParameter") != 0)
            return false;
        value = json_object_get(value, "binding");
    }
    if (json_is_string(value))
        return expand(scope, json_string_value(value), out, depth);
    if (json_is_number(value))
        text_add(out, "%.12g", json_number_value(value));
    else if (json_is_boolean(value))
        text_add(out, "%s", json_is_true(value) ? "true" : "false");
    return json_is_number(value) || json_is_boolean(value);
}

/* Appends the value of a UDT parameter. A parameter passed to a nested instance may refer to parameters of the enclosing instance. Returns
 * false if it cannot be resolved. */
static bool add_parameter(const struct scope *scope, const char *name, struct text *out, int depth)
{
    size_t before = out->length;
    if (scope->reader->references++ > MAX_REFERENCES)
        return false;
    for (const struct instance_frame *frame = scope->frame; frame; frame = frame->outer)
        for (int i = 0; i < frame->node->count; i++) {
            json_t *value = value_of(json_object_get(json_object_get(frame->node->layers[i], "parameters"), name));
            struct scope inner = *scope;
            if (!value || json_is_null(value) || (json_is_object(value) && !json_object_get(value, "binding")))
                continue;
            inner.frame = i < frame->own && frame->outer ? frame->outer : frame;
            bool good = add_value(&inner, value, out, depth + 1);
            if (!good && out->at)
                out->at[out->length = before] = 0;
            return good;
        }
    char *made = NULL;
    const char *text = builtin(scope, name, &made);
    if (text)
        text_add(out, "%s", text);
    mem_free(made);
    return text != NULL;
}

/* a term being evaluated, such as "Base+10*(Number-1)" */
struct term_reading {
    const struct scope *scope;
    const char *at;
    int depth;
    bool good; /* false: the text is not a term, or a parameter is not a number */
};

static double sum_of(struct term_reading *term);

static double parameter_of(struct term_reading *term)
{
    char name[200], *end = NULL;
    struct text value = { 0 };
    size_t length = strcspn(term->at, "|+-*/%()");
    snprintf(name, sizeof(name), "%.*s", (int)length, term->at);
    for (size_t last = strlen(name); last > 0 && name[last - 1] == ' '; last--)
        name[last - 1] = 0;
    term->at += length;
    term->good &= length < sizeof(name) && add_parameter(term->scope, name, &value, term->depth) && value.at;
    double number = term->good ? strtod(value.at, &end) : 0;
    term->good = term->good && end != value.at && !*end;
    text_finish(&value);
    return number;
}

static double factor_of(struct term_reading *term)
{
    char *end;
    term->at += strspn(term->at, " ");
    double number = 0, sign = *term->at == '-' ? -1 : 1;
    term->at += sign < 0;
    if (*term->at == '(' && term->depth < MAX_DEPTH) {
        term->at++;
        term->depth++;
        number = sum_of(term);
        term->good &= *term->at == ')';
        term->at += *term->at == ')';
    } else if (*term->at >= '0' && *term->at <= '9') {
        number = strtod(term->at, &end);
        term->at = end;
    } else {
        number = parameter_of(term);
    }
    term->at += strspn(term->at, " ");
    return sign * number;
}

static double product_of(struct term_reading *term)
{
    double number = factor_of(term);
    while (term->good && *term->at && strchr("*/%", *term->at)) {
        char sign = *term->at++;
        double by = factor_of(term);
        term->good &= sign == '*' || by != 0;
        number = sign == '*' ? number * by : sign == '/' ? number / by : fmod(number, by);
    }
    return number;
}

static double sum_of(struct term_reading *term)
{
    double number = product_of(term);
    while (term->good && *term->at && strchr("+-", *term->at)) {
        bool minus = *term->at++ == '-';
        double by = product_of(term);
        number += minus ? -by : by;
    }
    return number;
}

/* Appends the value of a parameter reference with arithmetic or a number format, such as "{Base+10*No}" and "{Number|000}".
 * Returns false if it cannot be resolved. */
static bool add_formatted(const struct scope *scope, const char *reference, struct text *out, int depth)
{
    struct term_reading term = { scope, reference, depth, true };
    if (!reference[strcspn(reference, "|+-*/%")])
        return false;
    double number = sum_of(&term);
    if (!term.good || !isfinite(number) || (*term.at && *term.at != '|'))
        return false;
    if (*term.at) {
        const char *dot = strchr(term.at, '.');
        size_t digits = dot ? strspn(dot + 1, "0#") : 0, width = strspn(term.at + 1, "0#,") + (digits > 0 ? digits + 1 : 0);
        text_add(out, "%0*.*f", (int)(width % 40), (int)(digits % 20), number);
    } else {
        text_add(out, "%.12g", number);
    }
    return true;
}

/* Appends a text with parameter references replaced by their values. Returns false if a reference could not be resolved; it
 * then stays in the text. */
static bool expand(const struct scope *scope, const char *text, struct text *out, int depth)
{
    bool good = true;
    text_add_bytes(out, "", 0);
    while (*text) {
        const char *open = strchr(text, '{'), *close = open ? strchr(open, '}') : NULL;
        if (!close || depth > 16) {
            text_add(out, "%s", text);
            return good && !close;
        }
        char *name = mem_printf("%.*s", (int)(close - open - 1), open + 1);
        text_add_bytes(out, text, (size_t)(open - text));
        if (!add_parameter(scope, name, out, depth) && !add_formatted(scope, name, out, depth)) {
            text_add(out, "{%s}", name);
            good = false;
        }
        mem_free(name);
        text = close + 1;
    }
    return good;
}

/* --- tags --------------------------------------------------------------------------------------------------------------------- */

/* Sets a field of a tag to a text, trimmed and without control characters. */
static void set_text(struct tag_export *list, struct export_tag *tag, enum export_field field, char *text)
{
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) {
            *c = ' ';
            list->control++;
        }
    char *from = text + strspn(text, " "), *end = from + strlen(from);
    while (end > from && end[-1] == ' ')
        *--end = 0;
    export_tag_set(tag, field, from);
}

static void set_field(const struct scope *scope, struct export_tag *tag, enum export_field field, json_t *value)
{
    struct text out = { 0 };
    if (!value || json_is_null(value) || json_is_boolean(value))
        return;
    scope->reader->references = 0;
    bool good = add_value(scope, value, &out, 0);
    if (!good && json_is_object(value))
        complain(field == EXPORT_ADDRESS ? &scope->reader->unresolved : &scope->reader->without, scope->folder, scope->name,
                 text_of(value, "binding"));
    if (out.at && (good || field == EXPORT_ADDRESS || json_is_string(value)))
        set_text(scope->reader->list, tag, field, out.at);
    text_finish(&out);
}

/* Sets a number from a property. Exports omit properties that have their default value, `initial`. */
static void set_range(const struct scope *scope, struct export_tag *tag, enum export_field field, json_t *value, const char *initial)
{
    if (!value || json_is_null(value))
        export_tag_set(tag, field, initial);
    else
        set_field(scope, tag, field, value);
}

/* Sets the scaling of a tag, or the range of its engineering unit if Ignition does not scale it. */
static void set_scaling(const struct scope *scope, struct export_tag *tag, const struct layered_node *node)
{
    static const char *const scaled[][2] = { { "rawLow", "0" }, { "rawHigh", "10" }, { "scaledLow", "0" }, { "scaledHigh", "10" } };
    json_t *mode = property_of(node, "scaleMode"), *low = property_of(node, "engLow"), *high = property_of(node, "engHigh");
    set_range(scope, tag, EXPORT_SCALING, mode, "None");
    const char *scaling = tag->fields[EXPORT_SCALING];
    if (scaling && (!strcasecmp(scaling, "Linear") || !strcasecmp(scaling, "SquareRoot"))) {
        for (int i = 0; i < 4; i++)
            set_range(scope, tag, EXPORT_RAW_LOW + i, property_of(node, scaled[i][0]), scaled[i][1]);
    } else if (low || high) {
        set_range(scope, tag, EXPORT_SCALED_LOW, low, "0");
        set_range(scope, tag, EXPORT_SCALED_HIGH, high, "100");
    }
}

/* Adds a tag of the export to the list. A member of a UDT instance gets its whole path as its name, because its own name is the
 * same in all instances. */
static void add_tag(const struct scope *scope, const struct layered_node *node)
{
    struct tag_export *list = scope->reader->list;
    list->rows++;
    if (!*scope->name) {
        list->nameless++;
        return;
    }
    struct export_tag *tag = tag_export_add(list, 0);
    char *name = scope->frame ? mem_printf("%s%s%s", scope->folder, *scope->folder ? "/" : "", scope->name) : mem_strdup(scope->name);
    set_text(list, tag, EXPORT_NAME, name);
    mem_free(name);
    for (size_t i = 0; i < sizeof(properties) / sizeof(*properties); i++)
        set_field(scope, tag, properties[i].field, property_of(node, properties[i].name));
    set_scaling(scope, tag, node);
    export_tag_set(tag, EXPORT_AREA, scope->folder);
    if (!tag->fields[EXPORT_NAME]) /* a tag whose name is blank in the export gets the name "unnamed" */
        export_tag_set(tag, EXPORT_NAME, "unnamed");
    scope->reader->too_many |= list->count > TABLE_MAX_ROWS;
}

static void add_node(struct tag_json_reader *reader, struct layered_node *node, const struct instance_frame *frame, const char *folder,
                     int depth);

static json_t *child_of(json_t *layer, const char *name)
{
    json_t *item;
    size_t index;
    json_array_foreach(json_object_get(layer, "tags"), index, item) if (!strcmp(text_of(item, "name"), name)) return item;
    return NULL;
}

/* Adds the children of a folder or UDT instance. Children with the same name in several layers (definitions) are merged into one. */
static void add_children(struct tag_json_reader *reader, const struct layered_node *node, const struct instance_frame *frame,
                         const char *folder, int depth)
{
    json_t *item;
    size_t index;
    for (int i = 0; i < node->count; i++)
        json_array_foreach(json_object_get(node->layers[i], "tags"), index, item)
        {
            const char *name = text_of(item, "name");
            struct layered_node child = { { item }, 1 };
            bool before = false;
            for (int k = 0; k < i && *name && !before; k++)
                before = child_of(node->layers[k], name) != NULL;
            for (int k = i + 1; k < node->count && *name && !before; k++) {
                json_t *below = child_of(node->layers[k], name);
                if (below)
                    child.layers[child.count++] = below;
            }
            if (!before && !reader->too_many)
                add_node(reader, &child, frame, folder, depth + 1);
        }
}

static bool has_children(const struct layered_node *node)
{
    return json_is_array(property_of(node, "tags"));
}

static void add_node(struct tag_json_reader *reader, struct layered_node *node, const struct instance_frame *frame, const char *folder,
                     int depth)
{
    const char *name = string_of(node, "name"), *type = string_of(node, "tagType");
    json_t *item;
    size_t index;
    if (depth >= MAX_DEPTH) {
        reader->too_deep = true;
        return;
    }
    json_array_foreach(node->layers[0], index, item) add_node(reader, &(struct layered_node){ { item }, 1 }, frame, folder, depth + 1);
    if (!json_is_object(node->layers[0]) || !strcmp(type, "UdtType") || (!frame && !strcmp(name, types_folder)))
        return;
    int own = node->count;
    bool instance = !strcmp(type, "UdtInstance") || *string_of(node, "typeId");
    if (instance)
        add_types(reader, node, frame, folder, name);
    if (!instance && !has_children(node) && strcmp(type, "Folder") != 0 && strcmp(type, "Provider") != 0) {
        add_tag(&(struct scope){ reader, frame, folder, name }, node);
        return;
    }
    char *below = *name ? mem_printf("%s%s%s", folder, *folder ? "/" : "", name) : mem_strdup(folder);
    const struct instance_frame inner = { frame, node, own, name };
    add_children(reader, node, instance ? &inner : frame, below, depth);
    mem_free(below);
}

static void say(struct tag_export *list, struct tag_names *names, const char *what)
{
    tag_names_say(names, what, what, &list->remarks);
    tag_names_finish(names);
}

bool tag_export_read_json(struct tag_export *list, const char *text, size_t length, char *why, size_t why_bytes)
{
    json_error_t error;
    json_t *root = json_loadb(text, length, 0, &error);
    struct tag_json_reader reader = { .list = list };
    list->format = "Ignition (JSON)";
    if (!root) {
        snprintf(why, why_bytes, "line %d: not JSON: %.120s", error.line, error.text);
        return false;
    }
    reader.types = json_object();
    index_types(&reader, root, "", 0);
    add_node(&reader, &(struct layered_node){ { root }, 1 }, NULL, "", 0);
    say(list, &reader.unknown, "instances of Ignition types (UDT) have a type that is not in the export; export the folder of types too");
    say(list, &reader.circular, "instances of Ignition types (UDT) have a type that contains itself: its inner copies are left out");
    say(list, &reader.unresolved, "addresses refer to parameters of Ignition types (UDT) that have no value");
    say(list, &reader.without, "units, ranges and descriptions refer to tags or parameters that have no value in this export: left out");
    if (reader.too_deep || reader.too_many)
        snprintf(why, why_bytes, reader.too_deep ? "folders deeper than %d" : "more than %d tags",
                 reader.too_deep ? MAX_DEPTH : TABLE_MAX_ROWS);
    json_decref(reader.types);
    json_decref(root);
    return !reader.too_deep && !reader.too_many;
}
