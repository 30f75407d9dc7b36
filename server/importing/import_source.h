/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the values of a plant come from that is brought in: one device that speaks Modbus TCP. Pure. Thread: any. */
#ifndef IMPORTING_IMPORT_SOURCE_H
#define IMPORTING_IMPORT_SOURCE_H
#include <jansson.h>

#include "plant/plant.h"

struct import_source { /* as `plantcast match` takes it; "": not said */
    char host[254], port[6], unit[4], order[5], base[2]; /* host "": there is none */
};

/* Returns whether a program can be given it: a name or a numeric IPv4 address, numbers within their limits, an order of bytes. */
bool import_source_good(const struct import_source *source);
/* Returns the one that a plant has, without a host if it has none, several, or another kind. */
struct import_source import_source_of_plant(const struct plant *plant);
/* Returns it as an object of texts, { host, port, unit, order, base }; the caller owns it. NULL: it has no host. */
json_t *import_source_json(const struct import_source *source);

#endif
