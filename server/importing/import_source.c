/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a plant's data source (a Modbus device) for an import, and checks that it is safe to pass as program arguments. */
#include "importing/import_source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const orders[] = { "", "ABCD", "CDAB", "BADC", "DCBA" }; /* names of the byte orders, indexed by enum byte_order */

static bool is_number(const char *text, int least, int most)
{
    char *end;
    long number = strtol(text, &end, 10);
    return !*text || (text[strspn(text, "0123456789")] == 0 && end > text && number >= least && number <= most);
}

bool import_source_good(const struct import_source *source)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.-_";
    bool known = false;
    for (size_t i = 0; i < sizeof(orders) / sizeof(orders[0]); i++)
        known |= !strcmp(source->order, orders[i]);
    return *source->host && *source->host != '-' && source->host[strspn(source->host, letters)] == 0 && known &&
           is_number(source->port, 1, 65535) && is_number(source->unit, 0, 255) && is_number(source->base, 0, 1);
}

struct import_source import_source_of_plant(const struct plant *plant)
{
    struct import_source out = { .host = "" };
    const struct plant_source *only = plant->source_count == 1 ? &plant->sources[0] : NULL;
    if (!only || strcmp(only->kind, "modbus") != 0 || only->transport != TRANSPORT_TCP || only->host_count != 1)
        return out;
    snprintf(out.host, sizeof(out.host), "%s", only->hosts[0]);
    snprintf(out.port, sizeof(out.port), "%u", (unsigned)only->port % 65536);
    snprintf(out.unit, sizeof(out.unit), "%u", (unsigned)only->unit % 256);
    snprintf(out.order, sizeof(out.order), "%s", orders[only->byte_order]);
    snprintf(out.base, sizeof(out.base), "%u", (unsigned)only->address_base % 2);
    if (!import_source_good(&out))
        *out.host = 0;
    return out;
}

json_t *import_source_json(const struct import_source *source)
{
    return *source->host ? json_pack("{s:s,s:s,s:s,s:s,s:s}", "host", source->host, "port", source->port, "unit", source->unit, "order",
                                     source->order, "base", source->base)
                         : NULL;
}
