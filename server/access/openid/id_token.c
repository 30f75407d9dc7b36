/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verifies ID tokens, using libcjose. */
#include "access/openid/id_token.h"

#include <cjose/cjose.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/utf8.h"

enum { GROUPS_LENGTH = 300 /* maximum number of characters of a user's groups in a message */ };

static const int64_t OLDEST_S = 24 * 3600;

static const struct {
    const char *alg, *kty;
} algorithms[] = { { "RS256", "RSA" }, { "RS384", "RSA" }, { "RS512", "RSA" }, { "PS256", "RSA" }, { "PS384", "RSA" },
                   { "PS512", "RSA" }, { "ES256", "EC" },  { "ES384", "EC" },  { "ES512", "EC" } };

static const char *kty_of(const char *alg)
{
    for (size_t i = 0; alg && i < sizeof(algorithms) / sizeof(*algorithms); i++)
        if (!strcmp(algorithms[i].alg, alg))
            return algorithms[i].kty;
    return NULL;
}

/* --- the signature -------------------------------------------------------------------------------------------------------- */

static bool is_for(const json_t *key, const char *alg, const char *kid)
{
    const char *use = json_member_text(key, "use"), *its_alg = json_member_text(key, "alg");
    const char *its_kid = json_member_text(key, "kid"), *kty = json_member_text(key, "kty");
    return kty && !strcmp(kty, kty_of(alg)) && (!use || !strcmp(use, "sig")) && (!its_alg || !strcmp(its_alg, alg)) &&
           (!kid || (its_kid && !strcmp(its_kid, kid)));
}

/* Imports one of the provider's public keys. Omits private members and members of other standards, because libcjose would
   require them to be complete. */
static cjose_jwk_t *import_key(const json_t *key)
{
    static const char *const members[] = { "kty", "kid", "n", "e", "crv", "x", "y" };
    json_t *plain = json_object();
    for (size_t i = 0; i < sizeof(members) / sizeof(*members); i++)
        if (json_object_get(key, members[i]))
            json_object_set(plain, members[i], json_object_get(key, members[i]));
    char *text = json_dumps(plain, JSON_COMPACT);
    cjose_jwk_t *jwk = text ? cjose_jwk_import(text, strlen(text), NULL) : NULL;
    free(text);
    json_decref(plain);
    return jwk;
}

static enum id_token_fault verify(cjose_jws_t *jws, const json_t *jwks, const char *alg, const char *kid)
{
    const json_t *keys = json_object_get(jwks, "keys");
    enum id_token_fault fault = ID_TOKEN_NO_KEY;
    for (size_t i = 0; i < json_array_size(keys) && fault != ID_TOKEN_GOOD; i++) {
        const json_t *key = json_array_get(keys, i);
        cjose_jwk_t *jwk = is_for(key, alg, kid) ? import_key(key) : NULL;
        if (jwk)
            fault = cjose_jws_verify(jws, jwk, NULL) ? ID_TOKEN_GOOD : ID_TOKEN_BAD;
        cjose_jwk_release(jwk);
    }
    return fault;
}

static enum id_token_fault read_claims(const char *token, const json_t *jwks, json_t **claims, const char **why)
{
    uint8_t *text = NULL;
    size_t count;
    cjose_jws_t *jws = strlen(token) < ID_TOKEN_BYTES ? cjose_jws_import(token, strlen(token), NULL) : NULL;
    cjose_header_t *header = jws ? cjose_jws_get_protected(jws) : NULL;
    const char *alg = header ? cjose_header_get(header, CJOSE_HDR_ALG, NULL) : NULL;
    const char *kid = header ? cjose_header_get(header, CJOSE_HDR_KID, NULL) : NULL;
    enum id_token_fault fault = ID_TOKEN_BAD;
    *why = "the ID token is not signed with a public-key algorithm";
    if (header && json_object_get(header, "crit"))
        *why = "the ID token requires an extension (crit) that Plantcast does not support";
    else if (kty_of(alg)) {
        fault = verify(jws, jwks, alg, kid);
        *why = fault == ID_TOKEN_NO_KEY ? "the ID token is signed with a key that the provider does not publish"
                                        : "the signature of the ID token is invalid";
    }
    if (fault == ID_TOKEN_GOOD && (!cjose_jws_get_plaintext(jws, &text, &count, NULL) ||
                                   !(*claims = json_loadb((char *)text, count, JSON_REJECT_DUPLICATES, NULL)))) {
        fault = ID_TOKEN_BAD;
        *why = "the contents (claims) of the ID token are not JSON";
    }
    cjose_jws_release(jws);
    return fault;
}

/* --- the claims ----------------------------------------------------------------------------------------------------------- */

static bool is_for_us(const json_t *claims, const char *client_id)
{
    const json_t *aud = json_object_get(claims, "aud");
    const char *azp = json_member_text(claims, "azp");
    bool found = json_is_string(aud) && !strcmp(json_string_value(aud), client_id);
    for (size_t i = 0; i < json_array_size(aud); i++) {
        const char *one = json_string_value(json_array_get(aud, i));
        found |= one && !strcmp(one, client_id);
    }
    if (json_array_size(aud) > 1 && !azp)
        return false;
    return found && (!azp || !strcmp(azp, client_id));
}

static const char *fault_of(const json_t *claims, const struct id_token_expected *expected)
{
    const char *iss = json_member_text(claims, "iss"), *sub = json_member_text(claims, "sub"), *nonce = json_member_text(claims, "nonce");
    const json_t *exp = json_object_get(claims, "exp"), *iat = json_object_get(claims, "iat"), *nbf = json_object_get(claims, "nbf");
    double now_s = (double)expected->now_s, oldest_s = now_s - OLDEST_S - (double)expected->patience_s;
    if (!iss || strcmp(iss, expected->config->issuer) != 0)
        return "the ID token comes from another issuer (iss) than the --openid file names";
    if (!is_for_us(claims, expected->config->client_id))
        return "the ID token is meant for another client (aud) than the --openid file names";
    if (!sub || !*sub || (expected->sub && strcmp(sub, expected->sub) != 0))
        return "the user (sub) in the ID token is missing, or is not the user who signed in";
    if (!json_is_number(exp) || now_s >= json_number_value(exp) + ID_TOKEN_SKEW_S + (double)expected->patience_s)
        return "the ID token has expired; check the clocks of this machine and of the provider";
    if (!json_is_number(iat) || json_number_value(iat) > now_s + ID_TOKEN_SKEW_S || json_number_value(iat) < oldest_s ||
        (nbf && !(json_number_value(nbf) <= now_s + ID_TOKEN_SKEW_S)))
        return "the time of issue of the ID token is implausible; check the clocks of this machine and of the provider";
    if (expected->nonce && (!nonce || strcmp(nonce, expected->nonce) != 0))
        return "the ID token was issued for another sign-in (nonce)";
    return NULL;
}

enum id_token_fault id_token_verify(const char *token, const struct id_token_expected *expected, json_t **claims, const char **why)
{
    *claims = NULL;
    enum id_token_fault fault = read_claims(token, expected->jwks, claims, why);
    if (fault != ID_TOKEN_GOOD || !(*why = fault_of(*claims, expected)))
        return fault;
    json_decref(*claims);
    *claims = NULL;
    return ID_TOKEN_BAD;
}

/* --- reading the claims ------------------------------------------------------------------------------------------------------- */

static const json_t *at_path(const json_t *claims, const char *path)
{
    /* the path of a claim is its name, or names of nested objects joined by dots; first looks for a claim whose name is the
       whole path, because such a name may be a URL, which contains dots itself */
    const json_t *whole = json_object_get(claims, path);
    char *copy = mem_strdup(path), *rest = copy;
    const json_t *found = claims;
    for (char *part; !whole && (part = strsep(&rest, "."));)
        found = json_object_get(found, part);
    mem_free(copy);
    return whole ? whole : found;
}

bool id_token_has_groups(const struct openid_config *config, const json_t *claims)
{
    const json_t *groups = at_path(claims, config->groups_claim);
    return json_is_array(groups) || json_is_string(groups);
}

char *id_token_groups_text(const struct openid_config *config, const json_t *claims)
{
    const json_t *groups = at_path(claims, config->groups_claim);
    char *json = groups ? json_dumps(groups, JSON_ENCODE_ANY | JSON_ENSURE_ASCII) : NULL;
    char *text = !json                          ? mem_printf("the provider sent no claim %s", config->groups_claim)
                 : strlen(json) > GROUPS_LENGTH ? mem_printf("%.*s...", GROUPS_LENGTH, json)
                                                : mem_strdup(json);
    free(json);
    return text;
}

enum role id_token_role(const struct openid_config *config, const json_t *claims)
{
    const json_t *groups = at_path(claims, config->groups_claim);
    enum role best = json_is_string(groups) ? openid_config_role(config, json_string_value(groups)) : ROLE_NOBODY;
    for (size_t i = 0; i < json_array_size(groups); i++) {
        const char *group = json_string_value(json_array_get(groups, i));
        enum role role = group ? openid_config_role(config, group) : ROLE_NOBODY;
        best = role > best ? role : best;
    }
    return best;
}

/* Copies a user's name. Returns false if it is invalid UTF-8 or contains control characters, which could break or forge a log line. */
static bool copy_name(const char *text, char *out, size_t size)
{
    size_t at = 0;
    for (size_t left = text ? strlen(text) : 0, n; left > 0; text += n, left -= n, at += n) {
        n = utf8_length(text, left);
        if (n == 0 || (n == 1 && ((unsigned char)*text < ' ' || *text == 0x7f)) || at + n >= size)
            return false;
        memcpy(out + at, text, n);
    }
    out[at] = 0;
    return at > 0;
}

bool id_token_name(const struct openid_config *config, const json_t *claims, char *out, size_t size)
{
    return copy_name(json_member_text(claims, config->name_claim), out, size) || copy_name(json_member_text(claims, "email"), out, size) ||
           copy_name(json_member_text(claims, "sub"), out, size);
}
