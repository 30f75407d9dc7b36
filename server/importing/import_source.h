/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data source of an imported plant: one Modbus TCP device. No input or output. Call from any thread. */
#ifndef IMPORTING_IMPORT_SOURCE_H
#define IMPORTING_IMPORT_SOURCE_H
#include <jansson.h>

#include "plant/plant.h"

struct import_source { /* the data source as arguments of `plantcast match`; an empty text: not stated */
    /* texts of the data source's host, port and so on; an empty `host`: there is no data source */
    char host[254], port[6], unit[4], order[5], base[2];
};

/* Returns true if the texts are safe as program arguments: `host` is a host name or a numeric IPv4 address, port, unit and base
   are numbers within their limits, and `order` is a byte order. */
bool import_source_good(const struct import_source *source);
/* Returns the data source of a plant. Its host is empty if the plant has no source, several sources, or a source of another kind. */
struct import_source import_source_of_plant(const struct plant *plant);
/* Returns the source as an object of texts, { host, port, unit, order, base }; the caller owns it. NULL: the source has no host. */
json_t *import_source_json(const struct import_source *source);

#endif
