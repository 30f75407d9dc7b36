/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes plant-file lines that turn selected model nodes into assets. */
#include "preprocess/match/equipment.h"

#include <errno.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/match/plant_edit.h"

static const size_t max_list_bytes = (size_t)16 << 20;

static const char *without_slash(const char *name)
{
    return name + (name[0] == '/' && name[1]);
}

static bool is_named(const char *list, const char *name)
{
    size_t length = strlen(name);
    for (const char *line = list; *line;) {
        size_t count = strcspn(line, "\r\n");
        if (count == length && !memcmp(line, name, length))
            return true;
        line += count + strspn(line + count, "\r\n");
    }
    return false;
}

static bool is_chosen(const char *choice, const char *list, const char *name, int level)
{
    if (list)
        return *name && (is_named(list, name) || is_named(list, without_slash(name)));
    if (!strncmp(choice, "level=", 6))
        return level == atoi(choice + 6);
    return *name && (fnmatch(choice, name, 0) == 0 || fnmatch(choice, without_slash(name), 0) == 0);
}

static const char *description_of(const struct tree_node *node)
{
    for (size_t i = 0; i < node->attribute_count; i++)
        if (!strcmp(node->attributes[i].name, "Description") && strcmp(node->attributes[i].value, "unset") != 0)
            return node->attributes[i].value;
    return NULL;
}

static void add_field(struct text *lines, const char *key, const char *text)
{
    text_add(lines, ", %s: ", key);
    plant_edit_add_quoted(lines, text);
}

/* Appends a plant-file line for an asset made from a model node. The asset's id is unique over all models, and its node pattern
 * matches only this node. */
static void add_asset(const struct model_index *site, size_t model, size_t node, struct text *lines)
{
    const struct model_tree *tree = &site->models[model];
    const char *name = tree->nodes[node].name, *description = description_of(&tree->more[node]);
    size_t folder = strlen(site->plant->files.folder);
    bool inside = !strncmp(tree->path, site->plant->files.folder, folder) && tree->path[folder] == '/';
    const char *area = tree->nodes[node].parent >= 0 ? tree->nodes[tree->nodes[node].parent].name : "";
    size_t alike = 0;
    for (size_t m = 0; m < site->model_count; m++)
        for (size_t i = 0; i < site->models[m].count; i++)
            alike += !strcmp(site->models[m].nodes[i].name, name);
    bool unique = alike == 1 && *name && !strpbrk(name, "*?[#!");
    char *number = mem_printf("#%u", tree->nodes[node].number), *id = mem_printf("%s %s", *name ? name : "unnamed", number);
    text_add(lines, "  - { id: ");
    plant_edit_add_quoted(lines, unique ? without_slash(name) : id);
    if (description && *description)
        add_field(lines, "description", description);
    if (*area)
        add_field(lines, "area", without_slash(area));
    add_field(lines, "model", tree->path + (inside ? folder + 1 : 0));
    add_field(lines, "nodes", unique ? name : number);
    text_add(lines, " }\n");
    mem_free(number);
    mem_free(id);
}

static int choose(const struct model_index *site, const char *const *choices, char *const *lists, int count, struct text *lines)
{
    int found = 0;
    for (size_t m = 0; m < site->model_count; m++) {
        const struct model_tree *tree = &site->models[m];
        int *levels = mem_array(tree->count, sizeof(*levels));
        for (size_t i = 0; i < tree->count;) {
            bool chosen = false;
            levels[i] = tree->nodes[i].parent < 0 ? 1 : levels[tree->nodes[i].parent] + 1;
            for (int c = 0; c < count && tree->more[i].low[0] <= tree->more[i].high[0]; c++)
                chosen |= is_chosen(choices[c], lists[c], tree->nodes[i].name, levels[i]);
            if (chosen)
                add_asset(site, m, i, lines);
            found += chosen;
            i = chosen ? tree->nodes[i].end : i + 1;
        }
        mem_free(levels);
    }
    return found;
}

int equipment_choose(const struct model_index *site, const char *const *choices, int count, struct text *lines,
                     char why[MODEL_INDEX_WHY_BYTES])
{
    char **lists = mem_array((size_t)count, sizeof(*lists));
    int found = 0;
    for (int i = 0; i < count && found >= 0; i++) {
        size_t bytes;
        if (choices[i][0] != '@')
            continue;
        lists[i] = text_read_file(choices[i] + 1, max_list_bytes, &bytes);
        if (!lists[i]) {
            snprintf(why, MODEL_INDEX_WHY_BYTES, "%.200s: %s", choices[i] + 1, strerror(errno));
            found = -1;
        }
    }
    if (found == 0)
        found = choose(site, choices, lists, count, lines);
    if (found == 0) {
        snprintf(why, MODEL_INDEX_WHY_BYTES,
                 "--equipment selects no node with triangles: check the level or the names with `plantcast nodes`");
        found = -1;
    }
    for (int i = 0; i < count; i++)
        mem_free(lists[i]);
    mem_free(lists);
    return found;
}
