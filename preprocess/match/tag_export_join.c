/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adds tags to an exported list, and handles names that occur several times: duplicates of a tag, or different tags with the
 * same name in several folders. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "preprocess/match/fold.h"
#include "preprocess/match/tag_export.h"
#include "preprocess/match/tag_names.h"

struct export_tag *tag_export_add(struct tag_export *list, int line)
{
    mem_grow(&list->tags, &list->capacity, list->count + 1, sizeof(*list->tags));
    struct export_tag *tag = &list->tags[list->count++];
    *tag = (struct export_tag){ .line = line };
    return tag;
}

void export_tag_set(struct export_tag *tag, enum export_field field, const char *text)
{
    if (*text && !tag->fields[field])
        tag->fields[field] = mem_strdup(text);
}

static int by_name(const void *pa, const void *pb, void *tags_ptr)
{
    const struct export_tag *tags = tags_ptr;
    size_t a = *(const size_t *)pa, b = *(const size_t *)pb;
    int order = strcasecmp(tags[a].fields[EXPORT_NAME], tags[b].fields[EXPORT_NAME]);
    return order ? order : (a > b) - (a < b);
}

static bool same_text(const char *a, const char *b)
{
    return !strcmp(a ? a : "", b ? b : "");
}

/* Returns the indices of the tags sorted by name, followed by tags->count as an end mark. The caller frees the array. */
static size_t *sort_names(struct tag_export *list)
{
    size_t *order = mem_array(list->count + 1, sizeof(*order));
    for (size_t i = 0; i <= list->count; i++)
        order[i] = i;
    qsort_r(order, list->count, sizeof(*order), by_name, list->tags);
    return order;
}

static bool same_name(const struct tag_export *list, size_t a, size_t b)
{
    return !strcasecmp(list->tags[a].fields[EXPORT_NAME], list->tags[b].fields[EXPORT_NAME]);
}

/* Prefixes the folder path to the names of tags that have the same name as a tag of another folder. */
static void rename_by_folder(struct tag_export *list)
{
    size_t *order = sort_names(list);
    for (size_t i = 0, end; i < list->count; i = end) {
        bool differ = false;
        for (end = i + 1; end < list->count && same_name(list, order[i], order[end]); end++)
            differ |= !same_text(list->tags[order[i]].fields[EXPORT_AREA], list->tags[order[end]].fields[EXPORT_AREA]);
        for (size_t k = i; k < end && differ; k++) {
            struct export_tag *tag = &list->tags[order[k]];
            char *name = tag->fields[EXPORT_NAME];
            if (!tag->fields[EXPORT_AREA])
                continue;
            tag->fields[EXPORT_NAME] = NULL;
            char *with_path = mem_printf("%s/%s", tag->fields[EXPORT_AREA], name);
            export_tag_set(tag, EXPORT_NAME, with_path);
            mem_free(with_path);
            mem_free(name);
            list->renamed++;
        }
    }
    mem_free(order);
}

/* Adds a pair of tags to `names`, under the name of the first one, with the line numbers of both. */
static void add_pair(struct tag_names *names, const struct export_tag *first, const struct export_tag *second)
{
    char lines[60] = "";
    if (first->line > 0)
        snprintf(lines, sizeof(lines), "lines %d and %d", first->line, second->line);
    tag_names_add(names, first->fields[EXPORT_NAME], "%s", lines);
}

struct folded {
    char *key;
    size_t tag;
};

static int by_key(const void *pa, const void *pb)
{
    const struct folded *a = pa, *b = pb;
    int order = strcasecmp(a->key, b->key);
    return order ? order : (a->tag > b->tag) - (a->tag < b->tag);
}

/* Appends a remark about similar names that differ only in dashes, letter widths or blanks. */
static void say_alike(struct tag_export *list)
{
    struct folded *all = mem_array(list->count + 1, sizeof(*all));
    struct tag_names names = { 0 };
    for (size_t i = 0; i < list->count; i++)
        all[i] = (struct folded){ fold_text(list->tags[i].fields[EXPORT_NAME]), i };
    qsort(all, list->count, sizeof(*all), by_key);
    for (size_t i = 1; i < list->count; i++)
        if (strcasecmp(all[i].key, all[i - 1].key) == 0)
            add_pair(&names, &list->tags[all[i - 1].tag], &list->tags[all[i].tag]);
    tag_names_say(&names, "tag differs from another tag only in the kind of dashes, letter widths or blanks; both tags are kept",
                  "tags differ from another tag only in the kind of dashes, letter widths or blanks; both tags are kept", &list->remarks);
    for (size_t i = 0; i < list->count; i++)
        mem_free(all[i].key);
    mem_free(all);
    tag_names_finish(&names);
}

void tag_export_join(struct tag_export *list)
{
    rename_by_folder(list);
    size_t *order = sort_names(list), kept = 0;
    bool *drop = mem_array(list->count + 1, sizeof(*drop));
    for (size_t i = 0, first = 0; i < list->count; i++) {
        if (i == 0 || !same_name(list, order[first], order[i])) {
            first = i;
            continue;
        }
        bool same = true;
        for (int f = EXPORT_ADDRESS; f < EXPORT_FIELDS; f++)
            same &= same_text(list->tags[order[first]].fields[f], list->tags[order[i]].fields[f]);
        drop[order[i]] = true;
        list->same += same;
        if (!same)
            add_pair(&list->differing, &list->tags[order[first]], &list->tags[order[i]]);
    }
    for (size_t i = 0; i < list->count; i++)
        if (drop[i])
            for (int f = 0; f < EXPORT_FIELDS; f++)
                mem_free(list->tags[i].fields[f]);
        else
            list->tags[kept++] = list->tags[i];
    list->count = kept;
    for (size_t i = 0; i < list->count; i++)
        for (int f = 0; f < EXPORT_FIELDS; f++)
            if (!list->tags[i].fields[f])
                list->tags[i].fields[f] = mem_strdup("");
    say_alike(list);
    mem_free(order);
    mem_free(drop);
}
