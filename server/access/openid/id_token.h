/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verifies ID tokens of OpenID Connect: the signature, then the claims (OpenID Connect Core 1.0, 3.1.3.7). Only public-key
   algorithms are accepted, so neither the algorithm `none` nor an HMAC made with a public key passes. No input or output; the
   caller passes the time. Call from any thread. */
#ifndef OPENID_ID_TOKEN_H
#define OPENID_ID_TOKEN_H
#include <jansson.h>

#include "access/openid/openid_config.h"

enum { ID_TOKEN_BYTES = 64 * 1024, ID_TOKEN_SKEW_S = 60 };

struct id_token_expected {
    const struct openid_config *config;
    const json_t *jwks; /* the identity provider's public keys */
    const char *nonce;  /* nonce that the token must contain; NULL: not checked, because a token from a refresh may lack one */
    /* subject (user id at the provider) that the token must contain; NULL: any, because the user's subject is not known yet */
    const char *sub;
    int64_t now_s;      /* present time, seconds UTC */
    int64_t patience_s; /* seconds for which a token is still accepted after it expires (claim `exp`) */
};

enum id_token_fault {
    ID_TOKEN_GOOD,
    ID_TOKEN_BAD,
    ID_TOKEN_NO_KEY, /* the token was signed with a key that is not in `jwks`: the provider may have a new key */
};

/* Verifies an ID token. If it is valid, *claims receives its claims (free with json_decref()); otherwise *why (static text)
   says what is wrong. */
enum id_token_fault id_token_verify(const char *token, const struct id_token_expected *expected, json_t **claims, const char **why);
/* Returns the highest role that the user's groups grant. config->groups_claim names the claim that lists the groups; it may be
   a dotted path. */
enum role id_token_role(const struct openid_config *config, const json_t *claims);
/* Returns true if the claims contain the user's groups. */
bool id_token_has_groups(const struct openid_config *config, const json_t *claims);
/* Returns the user's groups as JSON in ASCII for a message, cut to 300 characters; free with mem_free(). */
char *id_token_groups_text(const struct openid_config *config, const json_t *claims);
/* Writes the user's name for lists and journals: the name claim, else the e-mail address, else the claim `sub`. Returns false
   if no such claim can be displayed. */
bool id_token_name(const struct openid_config *config, const json_t *claims, char *out, size_t size);

#endif
