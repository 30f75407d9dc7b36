/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the keys of a source of type opcua against each other. SOURCES.md describes the keys. */
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"

enum { PORT = 4840 };

static const struct yaml_choice policies[] = { { "best", OPCUA_BEST },
                                               { "Aes256_Sha256_RsaPss", OPCUA_AES256 },
                                               { "Basic256Sha256", OPCUA_BASIC256 },
                                               { "Aes128_Sha256_RsaOaep", OPCUA_AES128 },
                                               { 0 } };

void plant_opcua_read_security(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = {
        { "policy", KEY_CHOICE, false, offsetof(struct plant_source, opcua.policy), 0, 0, policies, NULL },
        { "certificate", KEY_NAME, true, offsetof(struct plant_source, opcua.certificate), 0, 0, NULL, NULL },
        { "key", KEY_NAME, true, offsetof(struct plant_source, opcua.key), 0, 0, NULL, NULL },
        { "trusted", KEY_NAME, true, offsetof(struct plant_source, opcua.trusted), 0, 0, NULL, NULL },
        { "server_name", KEY_NAME, false, offsetof(struct plant_source, opcua.server_name), 0, 0, NULL, NULL },
        { "user_certificate", KEY_NAME, false, offsetof(struct plant_source, opcua.user_certificate), 0, 0, NULL, NULL },
        { "user_key", KEY_NAME, false, offsetof(struct plant_source, opcua.user_key), 0, 0, NULL, NULL },
        { 0 }
    };
    struct plant_source *source = record;
    struct plant_opcua *opcua = &source->opcua;
    const char *text = yaml_text(node);
    struct yaml_map map;
    opcua->has_security = true;
    if (text && !strcmp(text, "none"))
        opcua->policy = OPCUA_NONE;
    else if (text)
        yaml_expected(reader, node, "security", "none, or a mapping");
    else if (yaml_map_read(reader, node, "security", keys, source, &map) && !opcua->user_certificate != !opcua->user_key)
        yaml_error(reader, map.place, "security: expected user_certificate and user_key, or neither");
}

void plant_opcua_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct plant_source *source)
{
    struct plant_opcua *opcua = &source->opcua;
    char **const files[] = { &opcua->certificate, &opcua->key, &opcua->trusted, &opcua->user_certificate, &opcua->user_key };
#ifndef PLANTCAST_OPCUA
    yaml_error(reader, yaml_map_place(map, "type"), "type: this plantcastd was built without OPC UA (plantcastd --version)");
#endif
    if (!yaml_map_good(map, "port"))
        source->port = PORT;
    if (!opcua->has_security)
        yaml_error(reader, map->place, "an opcua source needs the key 'security': a mapping, or none");
    if (opcua->policy == OPCUA_NONE && source->login)
        yaml_error(reader, yaml_map_place(map, "login"),
                   "login: not allowed with security: none, because the password would be readable on the network");
    if (source->login && opcua->user_certificate)
        yaml_error(reader, yaml_map_place(map, "login"), "login: expected login or user_certificate, not both");
    if (opcua->deadband > 0 && opcua->deadband_percent > 0)
        yaml_error(reader, yaml_map_place(map, "deadband"), "deadband: expected deadband or deadband_percent, not both");
    plant_secret_check(reader, map, plant, "login", &source->login);
    for (size_t i = 0; i < sizeof(files) / sizeof(*files); i++)
        plant_secret_check(reader, map, plant, "security", files[i]);
}

void plant_opcua_finish(struct plant_opcua *opcua)
{
    char *const texts[] = { opcua->certificate,      opcua->key,      opcua->trusted, opcua->server_name,
                            opcua->user_certificate, opcua->user_key, opcua->path,    opcua->name_space };
    for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++)
        mem_free(texts[i]);
}
