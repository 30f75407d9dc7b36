/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ed25519 keys (RFC 8032) in PEM files, as OpenSSL writes them: the private key signs, the public key verifies. Immutable. Call
   from any thread. */
#ifndef PROVENANCE_SIGNING_KEY_H
#define PROVENANCE_SIGNING_KEY_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SIGNATURE_BYTES = 64, SIGNING_KEY_ID_BYTES = 17, SIGNING_KEY_WHY_BYTES = 256 };

struct signing_key;
/* Reads a private key. Returns NULL with the reason in `why` if the file cannot be read, is readable by all users, or has no private
   key. */
struct signing_key *signing_key_load(const char *path, char why[SIGNING_KEY_WHY_BYTES]);
/* Reads a public key. Returns NULL with the reason in `why` if the file cannot be read or has no key. */
struct signing_key *signing_key_load_public(const char *path, char why[SIGNING_KEY_WHY_BYTES]);
void signing_key_destroy(struct signing_key **key); /* Frees the key and sets *key to NULL; accepts a pointer to NULL. */

/* Signs the bytes with a private key. Returns false if OpenSSL fails. */
bool signing_key_sign(const struct signing_key *key, const void *bytes, size_t count, uint8_t signature[SIGNATURE_BYTES]);
/* Returns true if the signature of the bytes was made with this key. */
bool signing_key_verify(const struct signing_key *key, const void *bytes, size_t count, const uint8_t signature[SIGNATURE_BYTES]);
/* Writes the key's id: the first 16 hexadecimal digits of the SHA-256 of the public key's 32 bytes. */
void signing_key_id(const struct signing_key *key, char id[SIGNING_KEY_ID_BYTES]);

#endif
