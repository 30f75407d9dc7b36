/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the hashes that the signed statement of a picture contains. */
#include "provenance/picture_statement.h"

#include <openssl/evp.h>
#include <string.h>

#include "base/text/hex.h"

void picture_hash(const void *bytes, size_t count, char out[PICTURE_HASH_BYTES])
{
    uint8_t hash[PACKET_SHA256_BYTES];
    *out = 0;
    if (EVP_Digest(bytes, count, hash, NULL, EVP_sha256(), NULL) == 1)
        hex_print(hash, sizeof(hash), out);
}

void picture_hash_json(const json_t *value, char out[PICTURE_HASH_BYTES])
{
    char *text = json_dumps(value, PICTURE_JSON);
    *out = 0;
    if (text)
        picture_hash(text, strlen(text), out);
    free(text);
}
