/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses of servers that the plant file names. Thread: any. */
#ifndef PLANT_SOURCES_URL_H
#define PLANT_SOURCES_URL_H
#include <stdbool.h>

#include "plant/parse/yaml_reader.h"

/* Returns whether an address is one of this machine, by name. */
bool url_is_here(const char *url);
/* Reports what is wrong with the value of a key: another scheme than these two, no server, a password or white space in it. */
void url_check(struct yaml_reader *reader, const struct yaml_map *map, const char *key, const char *url, const char *plain,
               const char *secure);
/* Reports a `token_file` beside an address to which no token may be sent: it goes over https:// only, or to this machine. */
void url_check_token(struct yaml_reader *reader, const struct yaml_map *map, const char *url);

#endif
