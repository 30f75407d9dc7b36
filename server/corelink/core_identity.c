/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that a core and its renderers have the same version, plant and configuration: with different ones, the tag indices in
   their messages would mean different tags. */
#include "corelink/core_identity.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"

/* --- hashes of the plant's files ---------------------------------------------------------------------------------------------- */

/* The kinds of files in the order of enum core_file's bits. key: in messages and on engineers' pages; name: in the log; at: offset of
   the hash in struct core_files. */
static const struct {
    const char *key, *name;
    size_t at;
} kinds[] = {
    { "plant", "plant file", offsetof(struct core_files, plant) },
    { "tags", "tag list", offsetof(struct core_files, tags) },
    { "models", "models", offsetof(struct core_files, models) },
};
enum { KINDS = sizeof(kinds) / sizeof(kinds[0]) };

static char *hash_of(struct core_files *files, int kind)
{
    return (char *)files + kinds[kind].at;
}

static const char *const_hash_of(const struct core_files *files, int kind)
{
    return (const char *)files + kinds[kind].at;
}

struct core_files core_files_of(const struct plant *plant, uint64_t models_hash)
{
    struct core_files files;
    snprintf(files.plant, sizeof(files.plant), "%s", plant->files.plant_hash);
    snprintf(files.tags, sizeof(files.tags), "%s", plant->files.tags_hash);
    snprintf(files.models, sizeof(files.models), "%016llx", (unsigned long long)models_hash);
    return files;
}

json_t *core_files_json(const struct core_files *files)
{
    json_t *object = json_object();
    for (int i = 0; i < KINDS; i++)
        json_object_set_new(object, kinds[i].key, json_string(const_hash_of(files, i)));
    return object;
}

static bool read_hash(const json_t *files, const char *name, char out[CORE_HASH_BYTES])
{
    const char *text = json_member_text(files, name);
    snprintf(out, CORE_HASH_BYTES, "%s", text ? text : "");
    return text && strlen(text) == CORE_HASH_BYTES - 1;
}

bool core_files_read(const json_t *told, struct core_files *out)
{
    const json_t *files = json_object_get(told, "files");
    bool good = true;
    for (int i = 0; i < KINDS; i++)
        good = read_hash(files, kinds[i].key, hash_of(out, i)) && good;
    return good;
}

unsigned core_files_differing(const struct core_files *own, const struct core_files *other)
{
    unsigned differing = 0;
    for (int i = 0; i < KINDS; i++)
        if (strcmp(const_hash_of(own, i), const_hash_of(other, i)) != 0)
            differing |= 1u << i;
    return differing;
}

char *core_files_text(unsigned files)
{
    struct text text = { 0 };
    text_add(&text, "%s", "");
    for (int i = 0; i < KINDS; i++)
        if (files & 1u << i)
            text_add(&text, "%s%s", text.length ? ", " : "", kinds[i].name);
    return text.at;
}

json_t *core_files_keys(unsigned files)
{
    json_t *keys = json_array();
    for (int i = 0; i < KINDS; i++)
        if (files & 1u << i)
            json_array_append_new(keys, json_string(kinds[i].key));
    return keys;
}

/* --- introduction ------------------------------------------------------------------------------------------------------------- */

json_t *core_identity_message(const char *type, const struct core_identity *own)
{
    return json_pack("{s:s,s:s,s:s,s:s,s:o}", "type", type, "version", own->version, "plant", own->plant, "configuration",
                     own->configuration, "files", core_files_json(&own->files));
}

/* Returns the names of the files that differ, in brackets; "" if the peer does not state its files. */
static char *name_files(const json_t *told, const struct core_identity *own)
{
    struct core_files files;
    if (!core_files_read(told, &files))
        return mem_strdup("");
    char *names = core_files_text(core_files_differing(&own->files, &files));
    char *text = mem_printf(" (different: %s)", names);
    mem_free(names);
    return text;
}

char *core_identity_difference(const json_t *told, const char *peer, const struct core_identity *own)
{
    const struct {
        const char *member, *own;
    } members[] = { { "version", own->version }, { "plant", own->plant }, { "configuration", own->configuration } };
    for (size_t i = 0; i < sizeof(members) / sizeof(members[0]); i++) {
        const char *other = json_string_value(json_object_get(told, members[i].member));
        if (!other)
            return mem_printf("the %s does not send its %s: do both nodes run the same version?", peer, members[i].member);
        if (strcmp(other, members[i].own) != 0) {
            char *files = members[i].own == own->configuration ? name_files(told, own) : mem_strdup("");
            char *why = mem_printf("%s: the %s has %.100s, this node %s%s", members[i].member, peer, other, members[i].own, files);
            mem_free(files);
            return why;
        }
    }
    return NULL;
}

static bool is_equal(const json_t *told, const char *member, const char *own)
{
    const char *other = json_string_value(json_object_get(told, member));
    return other && !strcmp(other, own);
}

bool core_identity_is_other_configuration(const json_t *told, const struct core_identity *own)
{
    return is_equal(told, "version", own->version) && is_equal(told, "plant", own->plant) &&
           !is_equal(told, "configuration", own->configuration);
}
