/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Constants and hashes that the writer and the verifier of signed pictures share. Private to provenance/. */
#ifndef PROVENANCE_PICTURE_STATEMENT_H
#define PROVENANCE_PICTURE_STATEMENT_H
#include <jansson.h>

#include "encode/packet.h"

#define PICTURE_STATEMENT_KEYWORD "Plantcast statement"
#define PICTURE_SIGNATURE_KEYWORD "Plantcast signature"
#define PICTURE_JSON (JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(17))
enum {
    /* Current version of the signed statement. Version 1 lacks two members: `overlay` (always `full` or `bare` then) and `tier`
       (always `refined` then). */
    PICTURE_STATEMENT_VERSION = 2,
    PICTURE_STATEMENT_MAX_BYTES = 64 << 20, /* maximum length of a statement in bytes; enough for three sets of readings of 100,000 tags */
    PICTURE_SIGNATURE_BYTES = 128,
    PICTURE_HASH_BYTES = 65
};

/* Writes the SHA-256 of the bytes (pixels, or a part of a statement) as hexadecimal digits; "" if OpenSSL fails. */
void picture_hash(const void *bytes, size_t count, char out[PICTURE_HASH_BYTES]);
/* Writes the SHA-256 of the text of a JSON value in the format PICTURE_JSON, as hexadecimal digits. */
void picture_hash_json(const json_t *value, char out[PICTURE_HASH_BYTES]);

#endif
