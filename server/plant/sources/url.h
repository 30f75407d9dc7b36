/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks URLs of servers that the plant file names. Call from any thread. */
#ifndef PLANT_SOURCES_URL_H
#define PLANT_SOURCES_URL_H
#include <stdbool.h>

#include "plant/parse/yaml_reader.h"

/* Returns true if the host name in a URL means this machine (localhost or a loopback address). */
bool url_is_here(const char *url);
/* Reports a key whose value is not a valid URL: it must begin with `plain` or `secure` (schemes such as http:// and https://), name a
   server, and contain neither a password nor white space. */
void url_check(struct yaml_reader *reader, const struct yaml_map *map, const char *key, const char *url, const char *plain,
               const char *secure);
/* Reports a `token_file` for a URL that may not get tokens: only https:// URLs and URLs of this machine may get them. */
void url_check_token(struct yaml_reader *reader, const struct yaml_map *map, const char *url);

#endif
