/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests to the identity provider. They block, for 7 s at most. Any thread. */
#ifndef OPENID_OPENID_HTTP_H
#define OPENID_OPENID_HTTP_H
#include <jansson.h>
#include <stdatomic.h>

#include "access/openid/openid_config.h"

struct openid_reply {
    int status;    /* of HTTP; 0: there was no answer */
    json_t *json;  /* NULL: none */
    char why[256]; /* there is no answer */
};

/* Both return whether there was an answer at all; it is freed with openid_reply_finish. stop: gives up when it becomes true. */
/* Gets JSON. bearer: an access token; NULL: none. */
bool openid_get(const struct openid_config *config, const char *url, const char *bearer, const _Atomic bool *stop,
                struct openid_reply *reply);
/* Posts a form, as the client: with its secret, by HTTP Basic or in the form (in_form). */
bool openid_post(const struct openid_config *config, const char *url, const char *form, bool in_form, const _Atomic bool *stop,
                 struct openid_reply *reply);
void openid_reply_finish(struct openid_reply *reply);

/* Appends `&name=value` (or without `&`, at the beginning), encoded. */
void openid_add_argument(struct text *out, const char *name, const char *value);

#endif
