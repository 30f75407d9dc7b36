/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses OPC UA addresses. The index of an array element ([3]) precedes the node, because names of nodes may themselves end in brackets. */
#include "plant/sources/opcua_address.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static const char EXPECTED[] = "expected nsu=URI;s=NAME, with i=NUMBER, g=GUID or b=BASE64 in place of s=NAME";

/* Reads the optional index of an array element, such as [3], at the beginning of an address. Returns false if it is malformed. */
static bool read_element(const char **at, int *element)
{
    char *end;
    *element = -1;
    if (**at != '[')
        return true;
    errno = 0;
    long number = strtol(*at + 1, &end, 10);
    if (!isdigit((unsigned char)(*at)[1]) || *end != ']' || errno || number > 1000000)
        return false;
    *element = (int)number;
    *at = end + 1;
    return true;
}

/* Decodes %3B (;) and %25 (%) in a URI. Returns NULL if an escape is malformed. */
static char *unescaped(const char *uri, size_t length)
{
    char *out = mem_array(length + 1, 1), *to = out;
    for (size_t i = 0; i < length; i++) {
        unsigned code = 0;
        if (uri[i] == '%' && (i + 2 >= length || sscanf(uri + i + 1, "%2x", &code) != 1 || code == 0)) {
            mem_free(out);
            return NULL;
        }
        *to++ = uri[i] == '%' ? (char)code : uri[i];
        i += uri[i] == '%' ? 2 : 0;
    }
    *to = 0;
    return out;
}

static bool check_identifier(const char *text)
{
    static const char GUID[] = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";
    const char *value = *text ? text + 2 : text;
    if (!strchr("sigb", *text) || !*text || text[1] != '=' || !*value || strlen(value) > OPCUA_NODE_BYTES)
        return false;
    if (*text == 'i') {
        errno = 0;
        return strspn(value, "0123456789") == strlen(value) && strtoull(value, NULL, 10) <= UINT32_MAX && !errno;
    }
    for (size_t i = 0; *text == 'g' && i < sizeof(GUID); i++)
        if (GUID[i] == 'x' ? !isxdigit((unsigned char)value[i]) : value[i] != GUID[i])
            return false;
    return true;
}

/* Returns the namespace URI of an address: that of its prefix nsu=URI, or else the source's. Returns NULL with the reason in
   `why` if there is neither. */
static char *read_namespace(const char **at, const char *of_source, char why[200])
{
    const char *end = strchr(*at, ';');
    snprintf(why, 200, "%s", EXPECTED);
    if (!strncmp(*at, "ns=", 3)) {
        snprintf(why, 200,
                 "ns=NUMBER is not allowed, because namespace numbers can change when the OPC UA server restarts; write nsu=URI; instead");
        return NULL;
    }
    if (strncmp(*at, "nsu=", 4) != 0) {
        if (!of_source)
            snprintf(why, 200, "%s, or set the key `namespace` of the source", EXPECTED);
        return of_source ? mem_strdup(of_source) : NULL;
    }
    if (!end || end == *at + 4)
        return NULL;
    char *uri = unescaped(*at + 4, (size_t)(end - *at - 4));
    *at = end + 1;
    return uri;
}

bool opcua_address_resolve(const struct plant *plant, struct plant_tag *tag, char why[200])
{
    const char *at = tag->signal.address;
    if (!read_element(&at, &tag->signal.element)) {
        snprintf(why, 200, "expected the number of an array element, 0 to 1000000, in brackets");
        return false;
    }
    tag->signal.topic = read_namespace(&at, plant->sources[tag->source].opcua.name_space, why);
    if (!tag->signal.topic)
        return false;
    if (!check_identifier(at)) {
        snprintf(why, 200, "%s", EXPECTED);
        return false;
    }
    tag->signal.path = mem_strdup(at);
    return true;
}
