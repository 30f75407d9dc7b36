/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks URLs of servers that the plant file names. Thread: any. */
#ifndef PLANT_SOURCES_URL_H
#define PLANT_SOURCES_URL_H
#include <stdbool.h>

#include "plant/parse/yaml_reader.h"

/* Returns true if the host name in a URL means this machine (localhost or a loopback address). */
bool url_is_here(const char *url);
/* Reports an invalid URL as the value of a key: a scheme other than `plain` and `secure`, no server, a password or white space in it. */
void url_check(struct yaml_reader *reader, const struct yaml_map *map, const char *key, const char *url, const char *plain,
               const char *secure);
/* Reports a `token_file` of a URL to which no token may be sent: a token needs https://, or a URL of this machine. */
void url_check_token(struct yaml_reader *reader, const struct yaml_map *map, const char *url);

#endif
