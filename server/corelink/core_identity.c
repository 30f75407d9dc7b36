/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that a core and its renderers have the same version, plant and configuration: with different ones, the tag indices in
   their messages would mean different tags. */
#include "corelink/core_identity.h"

#include <string.h>

#include "base/mem.h"

json_t *core_identity_message(const char *type, const struct core_identity *own)
{
    return json_pack("{s:s,s:s,s:s,s:s}", "type", type, "version", own->version, "plant", own->plant, "configuration", own->configuration);
}

char *core_identity_difference(const json_t *told, const char *peer, const struct core_identity *own)
{
    const struct {
        const char *member, *own;
    } members[] = { { "version", own->version }, { "plant", own->plant }, { "configuration", own->configuration } };
    for (size_t i = 0; i < sizeof(members) / sizeof(members[0]); i++) {
        const char *other = json_string_value(json_object_get(told, members[i].member));
        if (!other)
            return mem_printf("the %s does not send its %s", peer, members[i].member);
        if (strcmp(other, members[i].own) != 0)
            return mem_printf("%s: the %s has %.100s, this node %s", members[i].member, peer, other, members[i].own);
    }
    return NULL;
}

static bool is_equal(const json_t *told, const char *member, const char *own)
{
    const char *other = json_string_value(json_object_get(told, member));
    return other && !strcmp(other, own);
}

bool core_identity_is_other_configuration(const json_t *told, const struct core_identity *own)
{
    return is_equal(told, "version", own->version) && is_equal(told, "plant", own->plant) &&
           !is_equal(told, "configuration", own->configuration);
}
