/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/sources/url.h"

#include <string.h>

static const char *host_of(const char *url)
{
    const char *colon = strstr(url, "://");
    return colon ? colon + 3 : url;
}

bool url_is_here(const char *url)
{
    static const char *const names[] = { "localhost", "127.0.0.1", "[::1]" };
    const char *host = host_of(url);
    for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++) {
        size_t length = strlen(names[i]);
        if (!strncmp(host, names[i], length) && (!host[length] || strchr(":/?", host[length])))
            return true;
    }
    return false;
}

/* Returns what is wrong with a URL, or NULL if the URL is good. */
static const char *wrong_with(const char *url, const char *plain, const char *secure)
{
    size_t plain_length = strlen(plain), secure_length = strlen(secure);
    if (strncmp(url, secure, secure_length) != 0 && strncmp(url, plain, plain_length) != 0)
        return "the address begins with a scheme (such as https://) that is not supported here";
    const char *host = host_of(url);
    size_t host_length = strcspn(host, "/?#");
    if (host_length == 0)
        return "the address names no server";
    if (memchr(host, '@', host_length))
        return "do not write a password in the plant file; write it to a file, and name the file in password_file or token_file";
    for (const char *at = url; *at; at++)
        if ((unsigned char)*at <= ' ' || *at == 127)
            return "the address contains white space, which is not allowed";
    return NULL;
}

void url_check(struct yaml_reader *reader, const struct yaml_map *map, const char *key, const char *url, const char *plain,
               const char *secure)
{
    const char *wrong = yaml_map_good(map, key) && url ? wrong_with(url, plain, secure) : NULL;
    if (wrong)
        /* does not repeat the URL in the message, because the URL may contain a password */
        yaml_error(reader, yaml_map_place(map, key), "%s: %s (expected %s... or %s...)", key, wrong, secure, plain);
}

void url_check_token(struct yaml_reader *reader, const struct yaml_map *map, const char *url)
{
    if (yaml_map_has(map, "token_file") && url && strncmp(url, "https://", 8) != 0 && !url_is_here(url))
        yaml_error(reader, yaml_map_place(map, "token_file"),
                   "token_file: needs an address that begins with https://, or a server on this machine, because the token would be "
                   "readable on the network");
}
