/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads `postgres` of `history`: the database that receives a copy of the history. PLANT.md describes its keys. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "plant/plant_impl.h"

enum { NAME_MAX_BYTES = 63 };

/* Returns whether a schema name can be used in SQL without quoting. */
static bool is_schema(const char *name)
{
    size_t length = strlen(name);
    return length <= NAME_MAX_BYTES && strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_") == length && (*name < '0' || *name > '9') &&
           strncmp(name, "pg_", 3) != 0;
}

/* Returns whether the URL contains a password, which every reader of the plant file could see. */
static bool has_password(const char *url)
{
    const char *host = strstr(url, "://") + 3, *at = memchr(host, '@', strcspn(host, "/?"));
    return (at && memchr(host, ':', (size_t)(at - host))) || strstr(url, "password=");
}

static void check_url(struct yaml_reader *reader, const struct yaml_map *map, const char *url)
{
    struct text_position place = yaml_map_place(map, "url");
    if (strncmp(url, "postgresql://", 13) != 0 && strncmp(url, "postgres://", 11) != 0)
        yaml_error(reader, place, "url: expected postgresql://HOST/DATABASE, found '%.60s'", url);
    else if (has_password(url))
        yaml_error(reader, place, "url: do not write a password here; write it to a file, and name the file in `login`");
}

void plant_postgres_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = { { "url", KEY_NAME, true, offsetof(struct plant_postgres, url), 0, 0, NULL, NULL },
                                            { "login", KEY_NAME, false, offsetof(struct plant_postgres, login), 0, 0, NULL, NULL },
                                            { "schema", KEY_NAME, false, offsetof(struct plant_postgres, schema), 0, 0, NULL, NULL },
                                            { "spool_points", KEY_NUMBER, false, offsetof(struct plant_postgres, spool_points), 1000, 1e9,
                                              NULL, NULL },
                                            { 0 } };
    struct plant_postgres *postgres = &((struct plant_history *)record)->postgres;
    struct yaml_map map;
    postgres->spool_points = 2e7;
    if (!yaml_map_read(reader, node, "postgres", keys, postgres, &map))
        return;
    if (postgres->url)
        check_url(reader, &map, postgres->url);
    if (!postgres->schema)
        postgres->schema = mem_strdup("plantcast");
    if (!is_schema(postgres->schema))
        yaml_error(reader, yaml_map_place(&map, "schema"), "schema: expected lower-case letters, digits and _, found '%.70s'",
                   postgres->schema);
}

void plant_postgres_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant,
                          struct plant_postgres *postgres)
{
    struct text_position place = yaml_map_place(map, "postgres");
    plant_resolve_path(plant, &postgres->login);
    if (postgres->url && plant->history.off)
        yaml_error(reader, place, "`postgres` requires `record: yes` in `history`, because only recorded points are sent to PostgreSQL");
    /* An unreadable login file is only a warning: a user who only prepares the plant may lack the right to read it. */
    if (postgres->login && access(postgres->login, R_OK) != 0)
        diag_warning(reader->diag, reader->path, place.line, place.column, "login: '%s' cannot be read: %s", postgres->login,
                     strerror(errno));
}

void plant_postgres_finish(struct plant_postgres *postgres)
{
    mem_free(postgres->url);
    mem_free(postgres->login);
    mem_free(postgres->schema);
}
