/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the fleet file. */
#include "fleet_file.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "access/access.h"
#include "base/mem.h"
#include "plant/parse/yaml_reader.h"

static const double POLL_S = 30, PICTURE_S = 300;

/* Returns the URL in canonical form: scheme and host in lower case, no default port, a slash at the end. mem_free. */
static char *plain_url(const char *url)
{
    char *plain = mem_printf("%s%s", url, *url && url[strlen(url) - 1] == '/' ? "" : "/");
    char *host = strstr(plain, "://"), *end = host ? host + 3 + strcspn(host + 3, "/?#") : plain;
    for (char *at = plain; at < end; at++)
        *at = (char)tolower((unsigned char)*at);
    const char *usual = !strncmp(plain, "https", 5) ? ":443" : ":80";
    size_t length = strlen(usual);
    if (host && end - (host + 3) > (long)length && !strncmp(end - length, usual, length))
        memmove(end - length, end, strlen(end) + 1);
    return plain;
}

static const char *wrong_with(const char *url)
{
    const char *host = strstr(url, "://");
    if (strncasecmp(url, "http://", 7) != 0 && strncasecmp(url, "https://", 8) != 0)
        return "the plant's address must begin with https:// or http://";
    size_t length = strcspn(host + 3, "/?#");
    if (length == 0)
        return "the plant's address contains no host name";
    if (memchr(host + 3, '@', length))
        return "the plant's address must not contain a password: write a token to a file, and give the file's path in `token_file`";
    if (strpbrk(url, "?# \t\"<>"))
        return "expected the address of the plant's page, without ?, # and white space";
    return NULL;
}

/* Returns true if requests to this URL would cross a network unencrypted. */
static bool is_in_clear(const char *plain_url)
{
    char host[256], name[256];
    if (!strncmp(plain_url, "https://", 8))
        return false;
    snprintf(host, sizeof(host), "%.*s", (int)strcspn(plain_url + 7, "/"), plain_url + 7);
    return !access_host_name(host, name, sizeof(name)) || !access_name_is_local(name);
}

/* Returns true if a plant's id needs no escaping in a URL or a metric, and is not too long. */
static bool is_id(const char *id)
{
    for (const char *at = id; *at; at++)
        if (!isalnum((unsigned char)*at) && !strchr("-_.", *at))
            return false;
    return strlen(id) < 64;
}

static void resolve(const struct fleet_file *file, char **path)
{
    if (!*path || **path == '/')
        return;
    char *whole = mem_printf("%s/%s", file->folder, *path);
    mem_free(*path);
    *path = whole;
}

static void check_new(struct yaml_reader *reader, const struct yaml_map *map, const struct fleet_file *file,
                      const struct fleet_plant *plant)
{
    for (const struct fleet_plant *other = file->plants; other < plant; other++) {
        if (plant->id && other->id && !strcmp(plant->id, other->id))
            yaml_error(reader, yaml_map_place(map, "id"), "id: plant '%s' is listed twice (first at line %d)", plant->id, other->line);
        else if (plant->url && other->url && !strcmp(plant->url, other->url))
            yaml_error(reader, yaml_map_place(map, "url"), "url: the plant at %s is listed twice (first at line %d)", plant->url,
                       other->line);
    }
}

static void read_one(struct yaml_reader *reader, yaml_node_t *node, struct fleet_file *file)
{
    static const struct yaml_key keys[] = { { "id", KEY_NAME, true, offsetof(struct fleet_plant, id), 0, 0, NULL, NULL },
                                            { "name", KEY_NAME, false, offsetof(struct fleet_plant, name), 0, 0, NULL, NULL },
                                            { "url", KEY_NAME, true, offsetof(struct fleet_plant, url), 0, 0, NULL, NULL },
                                            { "token_file", KEY_NAME, false, offsetof(struct fleet_plant, token_file), 0, 0, NULL, NULL },
                                            { "ca_file", KEY_NAME, false, offsetof(struct fleet_plant, ca_file), 0, 0, NULL, NULL },
                                            { "poll_s", KEY_NUMBER, false, offsetof(struct fleet_plant, poll_s), 1, 86400, NULL, NULL },
                                            { "picture_s", KEY_NUMBER, false, offsetof(struct fleet_plant, picture_s), 0, 86400, NULL,
                                              NULL },
                                            { 0 } };
    struct fleet_plant *plant = &file->plants[file->count++];
    struct yaml_map map;
    *plant = (struct fleet_plant){ .poll_s = file->poll_s, .picture_s = file->picture_s, .line = yaml_place(node).line };
    if (!yaml_map_read(reader, node, "a plant", keys, plant, &map))
        return;
    if (plant->id && !is_id(plant->id))
        yaml_error(reader, yaml_map_place(&map, "id"), "id: expected up to 63 letters, digits, -, _ and ., found '%.80s'", plant->id);
    const char *wrong = plant->url ? wrong_with(plant->url) : NULL;
    if (wrong)
        yaml_error(reader, yaml_map_place(&map, "url"), "url: %s", wrong);
    if (plant->url && !wrong) {
        char *plain = plain_url(plant->url);
        mem_free(plant->url);
        plant->url = plain;
        if (plant->token_file && is_in_clear(plain))
            yaml_error(reader, yaml_map_place(&map, "url"),
                       "url: a plant with `token_file` needs an https:// address, or a server on this machine");
    }
    if (!plant->name && plant->id)
        plant->name = mem_strdup(plant->id);
    resolve(file, &plant->token_file);
    resolve(file, &plant->ca_file);
    check_new(reader, &map, file, plant);
}

static void read_plants(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct fleet_file *file = record;
    int count = yaml_list_count(reader, node, "plants");
    if (count == 0 || count > FLEET_PLANTS)
        yaml_error(reader, yaml_place(node), "plants: expected 1 to %d plants, found %d", FLEET_PLANTS, count);
    if (count <= 0 || count > FLEET_PLANTS)
        return;
    file->plants = mem_array((size_t)count, sizeof(*file->plants));
    for (int i = 0; i < count; i++)
        read_one(reader, yaml_list_item(reader, node, i), file);
}

struct fleet_file *fleet_file_read(const char *path, struct diag *diag)
{
    static const struct yaml_key keys[] = { { "name", KEY_NAME, false, offsetof(struct fleet_file, name), 0, 0, NULL, NULL },
                                            { "poll_s", KEY_NUMBER, false, offsetof(struct fleet_file, poll_s), 1, 86400, NULL, NULL },
                                            { "picture_s", KEY_NUMBER, false, offsetof(struct fleet_file, picture_s), 0, 86400, NULL,
                                              NULL },
                                            { "plants", KEY_CUSTOM, true, 0, 0, 0, NULL, read_plants },
                                            { 0 } };
    struct fleet_file *file = mem_new(sizeof(*file));
    const char *slash = strrchr(path, '/');
    struct yaml_reader reader;
    struct yaml_map map;
    file->path = mem_strdup(path);
    file->folder = slash ? mem_printf("%.*s", (int)(slash - path), path) : mem_strdup(".");
    file->poll_s = POLL_S;
    file->picture_s = PICTURE_S;
    if (yaml_reader_open(&reader, path, diag)) {
        yaml_map_read(&reader, yaml_document_get_root_node(&reader.doc), "the fleet file", keys, file, &map);
        yaml_reader_close(&reader);
    }
    if (!file->name)
        file->name = mem_strdup("Plantcast");
    if (diag->errors)
        fleet_file_free(&file);
    return file;
}

void fleet_file_free(struct fleet_file **pointer)
{
    struct fleet_file *file = *pointer;
    if (!file)
        return;
    for (size_t i = 0; i < file->count; i++) {
        mem_free(file->plants[i].id);
        mem_free(file->plants[i].name);
        mem_free(file->plants[i].url);
        mem_free(file->plants[i].token_file);
        mem_free(file->plants[i].ca_file);
    }
    mem_free(file->plants);
    mem_free(file->path);
    mem_free(file->folder);
    mem_free(file->name);
    mem_free(file);
    *pointer = NULL;
}
