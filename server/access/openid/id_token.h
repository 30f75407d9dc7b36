/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ID tokens of OpenID Connect: signature, then claims (OpenID Connect Core 1.0, 3.1.3.7). Only algorithms with public keys are accepted, so
   neither `none` nor a signature made with a public key passes. Pure: time is handed in. Any thread. */
#ifndef OPENID_ID_TOKEN_H
#define OPENID_ID_TOKEN_H
#include <jansson.h>

#include "access/openid/openid_config.h"

enum { ID_TOKEN_BYTES = 64 * 1024, ID_TOKEN_SKEW_S = 60 };

struct id_token_expected {
    const struct openid_config *config;
    const json_t *jwks; /* the provider's keys */
    const char *nonce;  /* NULL: of a refreshed token, which need not have one */
    const char *sub;    /* whose it is; NULL: not known yet */
    int64_t now_s;      /* UTC */
    int64_t patience_s; /* how long a token is accepted after its `exp` */
};

enum id_token_fault {
    ID_TOKEN_GOOD,
    ID_TOKEN_BAD,
    ID_TOKEN_NO_KEY, /* its key is not among them: the provider may have a new one */
};

/* Verifies a token. Returns its claims in *claims (json_decref) if it is good; else *why (static) says what is wrong. */
enum id_token_fault id_token_verify(const char *token, const struct id_token_expected *expected, json_t **claims, const char **why);
/* Returns the highest role that the claims' groups give; the claim's name may be a path with dots. */
enum role id_token_role(const struct openid_config *config, const json_t *claims);
/* Returns whether the claims have the groups at all. */
bool id_token_has_groups(const struct openid_config *config, const json_t *claims);
/* Writes the person's name, as it stands in lists and journals: the name claim, else e-mail, else sub. Returns false if there is none that
   can be shown. */
bool id_token_name(const struct openid_config *config, const json_t *claims, char *out, size_t size);

#endif
