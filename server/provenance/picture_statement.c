/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes of what a statement names. */
#include "provenance/picture_statement.h"

#include <openssl/evp.h>
#include <stdio.h>
#include <string.h>

void picture_hex(const uint8_t hash[PACKET_SHA256_BYTES], char out[PICTURE_HASH_BYTES])
{
    for (int i = 0; i < PACKET_SHA256_BYTES; i++)
        sprintf(out + 2 * i, "%02x", hash[i]);
}

void picture_hash(const void *bytes, size_t count, char out[PICTURE_HASH_BYTES])
{
    uint8_t hash[PACKET_SHA256_BYTES];
    *out = 0;
    if (EVP_Digest(bytes, count, hash, NULL, EVP_sha256(), NULL) == 1)
        picture_hex(hash, out);
}

void picture_hash_json(const json_t *value, char out[PICTURE_HASH_BYTES])
{
    char *text = json_dumps(value, PICTURE_JSON);
    *out = 0;
    if (text)
        picture_hash(text, strlen(text), out);
    free(text);
}
