/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ed25519 keys, implemented with OpenSSL: reading, signing and verifying. */
#include "provenance/signing_key.h"

#include <errno.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/text/hex.h"

struct signing_key {
    EVP_PKEY *pair; /* OpenSSL's key: a private and public key, or only a public key */
    char id[SIGNING_KEY_ID_BYTES];
};

static bool find_id(struct signing_key *key)
{
    uint8_t raw[32], hash[32];
    size_t count = sizeof(raw);
    if (EVP_PKEY_get_raw_public_key(key->pair, raw, &count) != 1 || EVP_Digest(raw, count, hash, NULL, EVP_sha256(), NULL) != 1)
        return false;
    hex_print(hash, (SIGNING_KEY_ID_BYTES - 1) / 2, key->id);
    return true;
}

/* Callback of OpenSSL that must supply the passphrase of an encrypted key. Fails, because nobody is present to type one. */
static int no_passphrase(char *out, int bytes, int writes, void *arg)
{
    (void)out, (void)bytes, (void)writes, (void)arg;
    return -1;
}

static struct signing_key *load(const char *path, bool is_private, char why[SIGNING_KEY_WHY_BYTES])
{
    struct stat info;
    FILE *file = fopen(path, "r");
    if (!file) {
        snprintf(why, SIGNING_KEY_WHY_BYTES, "%.180s: %s", path, strerror(errno));
        return NULL;
    }
    struct signing_key *key = NULL;
    if (is_private && fstat(fileno(file), &info) == 0 && (info.st_mode & S_IROTH)) {
        snprintf(why, SIGNING_KEY_WHY_BYTES, "%.180s: all users can read this private key; run chmod o-rwx on the file", path);
    } else {
        key = mem_new(sizeof(*key));
        key->pair = (is_private ? PEM_read_PrivateKey : PEM_read_PUBKEY)(file, NULL, no_passphrase, NULL);
        if (!key->pair || EVP_PKEY_id(key->pair) != EVP_PKEY_ED25519 || !find_id(key)) {
            snprintf(why, SIGNING_KEY_WHY_BYTES, "%.180s: not a %s key (Ed25519, PEM)", path, is_private ? "private" : "public");
            signing_key_destroy(&key);
        }
    }
    fclose(file);
    return key;
}

struct signing_key *signing_key_load(const char *path, char why[SIGNING_KEY_WHY_BYTES])
{
    return load(path, true, why);
}

struct signing_key *signing_key_load_public(const char *path, char why[SIGNING_KEY_WHY_BYTES])
{
    return load(path, false, why);
}

void signing_key_destroy(struct signing_key **key)
{
    if (!*key)
        return;
    EVP_PKEY_free((*key)->pair);
    mem_free(*key);
    *key = NULL;
}

bool signing_key_sign(const struct signing_key *key, const void *bytes, size_t count, uint8_t signature[SIGNATURE_BYTES])
{
    size_t length = SIGNATURE_BYTES;
    EVP_MD_CTX *context = EVP_MD_CTX_new();
    bool good = context && EVP_DigestSignInit(context, NULL, NULL, NULL, key->pair) == 1 &&
                EVP_DigestSign(context, signature, &length, bytes, count) == 1 && length == SIGNATURE_BYTES;
    EVP_MD_CTX_free(context);
    return good;
}

bool signing_key_verify(const struct signing_key *key, const void *bytes, size_t count, const uint8_t signature[SIGNATURE_BYTES])
{
    EVP_MD_CTX *context = EVP_MD_CTX_new();
    bool good = context && EVP_DigestVerifyInit(context, NULL, NULL, NULL, key->pair) == 1 &&
                EVP_DigestVerify(context, signature, SIGNATURE_BYTES, bytes, count) == 1;
    EVP_MD_CTX_free(context);
    return good;
}

void signing_key_id(const struct signing_key *key, char id[SIGNING_KEY_ID_BYTES])
{
    memcpy(id, key->id, SIGNING_KEY_ID_BYTES);
}
