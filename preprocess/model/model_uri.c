/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the bytes that the URIs in a glTF file refer to. */
#include "preprocess/model/model_uri.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <utf8proc.h>

#include "base/mem.h"
#include "base/text/text.h"

/* --- files --------------------------------------------------------------------------------------------------------------- */

static int hex_digit(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Decodes percent escapes such as %20 in place. Returns false if the result contains a zero byte. */
static bool percent_decode(char *name)
{
    char *to = name;
    for (const char *at = name; *at; at++) {
        int high = *at == '%' ? hex_digit(at[1]) : -1, low = high >= 0 ? hex_digit(at[2]) : -1;
        if (low < 0) {
            *to++ = *at;
            continue;
        }
        if (high == 0 && low == 0)
            return false;
        *to++ = (char)(high * 16 + low);
        at += 2;
    }
    *to = 0;
    return true;
}

/* Resolves a file name, following symlinks, and checks that the file is inside the folder. Returns NULL, or why it may not be
 * opened. The caller frees *real with free(). */
static const char *find_inside(const char *folder, const char *name, char **real)
{
    struct stat st;
    size_t length = strcmp(folder, "/") == 0 ? 0 : strlen(folder);
    if (name[0] == '/')
        return "absolute paths are not allowed";
    if (strstr(name, "://"))
        return "URLs are not supported";
    char *joined = mem_printf("%s/%s", folder, name);
    *real = realpath(joined, NULL);
    mem_free(joined);
    if (!*real)
        return errno == ENOENT ? "no such file" : strerror(errno);
    if (strncmp(*real, folder, length) != 0 || (*real)[length] != '/')
        return "the file is outside the model's folder";
    if (stat(*real, &st) != 0 || !S_ISREG(st.st_mode))
        return "not a regular file";
    return NULL;
}

/* Resolves a file name in a folder. If there is no such file, tries other spellings: literal percent signs, composed or
 * decomposed accents (macOS), and backslashes as separators. */
static const char *find_any_form(const char *folder, const char *uri, const char *name, char **real)
{
    const utf8proc_uint8_t *bytes = (const utf8proc_uint8_t *)name;
    char *slashes = mem_strdup(name), *joined = (char *)utf8proc_NFC(bytes), *apart = (char *)utf8proc_NFD(bytes);
    for (char *at = slashes; (at = strchr(at, '\\'));)
        *at = '/';
    const char *const forms[] = { uri, slashes, joined, apart }, *first = find_inside(folder, name, real);
    const char *reason = first;
    for (size_t i = 0; reason && i < sizeof(forms) / sizeof(forms[0]); i++) {
        free(*real);
        *real = NULL;
        reason = forms[i] ? find_inside(folder, forms[i], real) : reason;
    }
    mem_free(slashes);
    free(joined);
    free(apart);
    return reason ? first : NULL;
}

static unsigned char *read_inside(const char *folder, const char *uri, const char *name, size_t *size, char *why)
{
    char *real = NULL, *bytes = NULL;
    const char *reason = find_any_form(folder, uri, name, &real);
    if (!reason) {
        bytes = text_read_file(real, MODEL_MAX_BYTES, size);
        reason = strerror(errno);
    }
    if (!bytes)
        wrong(why, "'%.120s' is not a readable file inside the model's folder: %s", name, reason);
    free(real);
    return (unsigned char *)bytes;
}

/* --- data URIs ----------------------------------------------------------------------------------------------------------- */

static int base64_digit(char c)
{
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+'             ? 62
           : c == '/'             ? 63
                                  : -1;
}

static unsigned char *base64_decode(const char *text, size_t *size, char *why)
{
    size_t length = strlen(text), count = 0;
    for (int padding = 0; padding < 2 && length > 0 && text[length - 1] == '='; padding++)
        length--;
    unsigned char *out = mem_try_array(length / 4 * 3 + 3, 1);
    unsigned bits = 0;
    if (!out || length % 4 == 1) {
        wrong(why,
              out ? "invalid glTF file: the base64 data in a data URI is truncated after %zu digits"
                  : "cannot decode %zu base64 digits of a data URI of the glTF model: out of memory",
              length);
        goto error;
    }
    for (size_t i = 0; i < length; i++) {
        int digit = base64_digit(text[i]);
        if (digit < 0) {
            wrong(why, "invalid glTF file: byte %zu of a data URI is not a base64 digit", i);
            goto error;
        }
        bits = (bits << 6 | (unsigned)digit) & 0xffffff;
        if (i % 4 != 0)
            out[count++] = (unsigned char)(bits >> (6 - 2 * (i % 4)));
    }
    *size = count;
    return out;
error:
    mem_free(out);
    return NULL;
}

bool model_uri_is_data(const char *uri)
{
    return strncmp(uri, "data:", 5) == 0;
}

unsigned char *model_uri_read(const char *folder, const char *uri, size_t *size, char why[MODEL_WHY_BYTES])
{
    if (model_uri_is_data(uri)) {
        const char *comma = strchr(uri, ',');
        if (comma && comma - uri >= 7 && strncmp(comma - 7, ";base64", 7) == 0)
            return base64_decode(comma + 1, size, why);
        wrong(why, "invalid glTF file: the data URI '%.40s' is not encoded as base64", uri);
        return NULL;
    }
    char *name = mem_strdup(uri);
    unsigned char *bytes = NULL;
    if (percent_decode(name))
        bytes = read_inside(folder, uri, name, size, why);
    else
        wrong(why, "'%.120s' is not a readable file inside the model's folder: the name contains a 0 byte", uri);
    mem_free(name);
    return bytes;
}
