/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the configuration file of --openid. */
#include "access/openid/openid_config.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

#include "access/access.h"
#include "base/mem.h"
#include "plant/parse/yaml_reader.h"

static const double CHECK_S = 30, HOURS = 12;
enum { MAX_GROUPS = 200 };

/* Returns true if secrets sent to the URL could be intercepted: it is neither https nor on this machine. */
static bool is_unsafe(const char *url)
{
    char host[256], name[256];
    if (!strncmp(url, "https://", 8))
        return false;
    if (strncmp(url, "http://", 7) != 0)
        return true;
    snprintf(host, sizeof(host), "%.*s", (int)strcspn(url + 7, "/"), url + 7);
    return !access_host_name(host, name, sizeof(name)) || !access_name_is_local(name);
}

static void read_group(struct yaml_reader *reader, yaml_node_t *node, struct openid_group *group)
{
    static const struct yaml_choice roles[] = {
        { "viewer", ROLE_VIEWER }, { "operator", ROLE_OPERATOR }, { "engineer", ROLE_ENGINEER }, { 0 }
    };
    static const struct yaml_key keys[] = { { "group", KEY_NAME, true, offsetof(struct openid_group, group), 0, 0, NULL, NULL },
                                            { "role", KEY_CHOICE, true, offsetof(struct openid_group, role), 0, 0, roles, NULL },
                                            { 0 } };
    struct yaml_map map;
    yaml_map_read(reader, node, "a group", keys, group, &map);
}

static void read_groups(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct openid_config *config = record;
    int count = yaml_list_count(reader, node, "roles");
    if (count < 1 || count > MAX_GROUPS) {
        yaml_error(reader, yaml_place(node), "roles: expected 1 to %d groups", MAX_GROUPS);
        return;
    }
    config->groups = mem_array((size_t)count, sizeof(*config->groups));
    for (int i = 0; i < count; i++)
        read_group(reader, yaml_list_item(reader, node, i), &config->groups[config->group_count++]);
}

static void resolve(const char *path, char **name)
{
    const char *slash = strrchr(path, '/');
    if (!*name || **name == '/' || !slash)
        return;
    char *whole = mem_printf("%.*s/%s", (int)(slash - path), path, *name);
    mem_free(*name);
    *name = whole;
}

static void set_default(char **text, const char *usual)
{
    if (!*text)
        *text = mem_strdup(usual);
}

static void complete(struct openid_config *config, const char *path)
{
    resolve(path, &config->client_secret_file);
    resolve(path, &config->ca_file);
    set_default(&config->scope, "openid profile");
    set_default(&config->name_claim, "preferred_username");
    set_default(&config->groups_claim, "groups");
    set_default(&config->label, config->issuer);
    if (config->url[strlen(config->url) - 1] != '/') {
        char *whole = mem_printf("%s/", config->url);
        mem_free(config->url);
        config->url = whole;
    }
    config->redirect_uri = mem_printf("%slogin/callback", config->url);
    config->secure = !strncmp(config->url, "https://", 8);
    snprintf(config->cookie, sizeof(config->cookie), "%splantcast-%08" PRIx64, config->secure ? "__Host-" : "",
             (uint64_t)XXH3_64bits(config->url, strlen(config->url)) & 0xffffffff);
}

static void check(struct yaml_reader *reader, const struct yaml_map *map, const struct openid_config *config)
{
    if (yaml_map_good(map, "issuer") && is_unsafe(config->issuer))
        yaml_error(reader, yaml_map_place(map, "issuer"),
                   "issuer: expected an address that begins with https://; http:// is allowed only for this machine");
    if (yaml_map_good(map, "url") && is_unsafe(config->url))
        yaml_error(reader, yaml_map_place(map, "url"),
                   "url: expected the page's address, which begins with https://; http:// is allowed only for this machine");
    if (yaml_map_good(map, "scope") && strncmp(config->scope, "openid", 6) != 0)
        yaml_error(reader, yaml_map_place(map, "scope"), "scope: expected a list of scopes that begins with openid");
}

struct openid_config *openid_config_read(struct log *log, const char *path)
{
#define TEXT(name, required)                                                                                                               \
    {                                                                                                                                      \
#name, KEY_NAME, required, offsetof(struct openid_config, name), 0, 0, NULL, NULL                                                  \
    }
    static const struct yaml_key keys[] = { TEXT(issuer, true),
                                            TEXT(client_id, true),
                                            TEXT(client_secret_file, false),
                                            TEXT(url, true),
                                            TEXT(ca_file, false),
                                            TEXT(scope, false),
                                            TEXT(prompt, false),
                                            TEXT(label, false),
                                            TEXT(name_claim, false),
                                            TEXT(groups_claim, false),
                                            { "roles", KEY_CUSTOM, true, 0, 0, 0, NULL, read_groups },
                                            { "check_s", KEY_NUMBER, false, offsetof(struct openid_config, check_s), 1, 45, NULL, NULL },
                                            { "hours", KEY_NUMBER, false, offsetof(struct openid_config, hours), 0.01, 168, NULL, NULL },
                                            { 0 } };
#undef TEXT
    struct openid_config *config = mem_new(sizeof(*config));
    struct diag diag = { 0 };
    struct yaml_reader reader;
    struct yaml_map map;
    config->check_s = CHECK_S;
    config->hours = HOURS;
    if (yaml_reader_open(&reader, path, &diag)) {
        if (yaml_map_read(&reader, yaml_document_get_root_node(&reader.doc), "the --openid file", keys, config, &map))
            check(&reader, &map, config);
        yaml_reader_close(&reader);
    }
    for (size_t i = 0; i < diag.count; i++)
        log_err(log, "%s:%d:%d: %s", diag.items[i].file, diag.items[i].line, diag.items[i].column, diag.items[i].text);
    if (diag.errors)
        openid_config_free(&config);
    else
        complete(config, path);
    diag_finish(&diag);
    return config;
}

void openid_config_free(struct openid_config **pointer)
{
    struct openid_config *config = *pointer;
    if (!config)
        return;
    char *texts[] = { config->issuer,     config->client_id,    config->client_secret_file,
                      config->url,        config->redirect_uri, config->ca_file,
                      config->scope,      config->prompt,       config->label,
                      config->name_claim, config->groups_claim };
    for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++)
        mem_free(texts[i]);
    for (size_t i = 0; i < config->group_count; i++)
        mem_free(config->groups[i].group);
    mem_free(config->groups);
    mem_free(config);
    *pointer = NULL;
}

enum role openid_config_role(const struct openid_config *config, const char *group)
{
    enum role best = ROLE_NOBODY;
    for (size_t i = 0; i < config->group_count; i++)
        if (!strcmp(config->groups[i].group, group) && config->groups[i].role > (int)best)
            best = (enum role)config->groups[i].role;
    return best;
}
