/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `links`: templates of URLs of other systems' pages about an asset or a tag. */
#include <ctype.h>
#include <string.h>

#include "plant/plant_impl.h"

static const struct yaml_choice of_choices[] = { { "asset", 0 }, { "tag", 1 }, { 0 } };

static size_t scheme_length(const char *url)
{
    static const char *const schemes[] = { "https://", "http://" };
    for (size_t i = 0; i < sizeof(schemes) / sizeof(*schemes); i++)
        if (!strncmp(url, schemes[i], strlen(schemes[i])))
            return strlen(schemes[i]);
    return 0;
}

/* Returns a message that says what is wrong with a URL template, or NULL. Scheme and host must end before the first brace, so that a value
   inserted there cannot change the host. */
static const char *wrong_with(const char *url, bool of_tags)
{
    static const char *const of_asset[] = { "{id}", "{tag}", "{area}" }, *const of_tag[] = { "{name}", "{asset}", "{group}" };
    const char *const *known = of_tags ? of_tag : of_asset;
    size_t scheme = scheme_length(url), host = strcspn(url + scheme, "/?#{");
    if (scheme == 0)
        return "the address of the link must begin with https:// or http://";
    if (host == 0 || url[scheme + host] == '{')
        return "the address of the link names no server";
    for (const char *at = url; *at; at++) {
        if (isspace((unsigned char)*at) || iscntrl((unsigned char)*at))
            return "the address of the link contains white space, which is not allowed";
        bool put_in = false;
        for (size_t i = 0; *at == '{' && i < 3; i++)
            put_in |= !strncmp(at, known[i], strlen(known[i]));
        if (*at == '{' && !put_in)
            return of_tags ? "the address of the link may contain only {name}, {asset} and {group} in braces"
                           : "the address of the link may contain only {id}, {tag} and {area} in braces";
    }
    return NULL;
}

void plant_links_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    static const struct yaml_key keys[] = { { "name", KEY_NAME, true, offsetof(struct plant_link, name), 0, 0, NULL, NULL },
                                            { "url", KEY_NAME, true, offsetof(struct plant_link, url), 0, 0, NULL, NULL },
                                            { "of", KEY_FLAG, false, offsetof(struct plant_link, of_tags), 0, 0, of_choices, NULL },
                                            { 0 } };
    int count = yaml_list_count(reader, node, "links");
    if (count > PLANT_LINKS)
        yaml_error(reader, yaml_place(node), "links: expected at most %d links, found %d", PLANT_LINKS, count);
    for (int i = 0; i < count && i < PLANT_LINKS; i++) {
        struct plant_link *link = &plant->display.links[plant->display.link_count++];
        struct yaml_map map;
        yaml_map_read(reader, yaml_list_item(reader, node, i), "a link", keys, link, &map);
        const char *wrong = link->url ? wrong_with(link->url, link->of_tags) : NULL;
        if (wrong)
            yaml_error(reader, yaml_map_place(&map, "url"), "url: '%s': %s", link->url, wrong);
    }
}
