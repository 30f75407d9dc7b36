/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests to the identity provider. Each call blocks for at most 7 s. Call from any thread. */
#ifndef OPENID_OPENID_HTTP_H
#define OPENID_OPENID_HTTP_H
#include <jansson.h>
#include <stdatomic.h>

#include "access/openid/openid_config.h"

struct openid_reply {
    int status;    /* HTTP status of the provider's answer; 0: no answer */
    json_t *json;  /* JSON in the body of the provider's answer; NULL: there was no answer, or its body is not JSON */
    char why[256]; /* reason why the provider gave no answer */
};

/* openid_get() and openid_post() return true if the provider answered, even with an error status; free the answer with
   openid_reply_finish(). stop: once another thread sets this flag, the request is aborted. */
/* Requests a URL with GET and reads the JSON answer. bearer: an access token; NULL: none. */
bool openid_get(const struct openid_config *config, const char *url, const char *bearer, const _Atomic bool *stop,
                struct openid_reply *reply);
/* Sends a form with POST. Authenticates this server with its client secret, through HTTP Basic or, if in_form, as a form field. */
bool openid_post(const struct openid_config *config, const char *url, const char *form, bool in_form, const _Atomic bool *stop,
                 struct openid_reply *reply);
void openid_reply_finish(struct openid_reply *reply);

/* Appends `&name=value`, percent-encoded, to a form or query; omits the `&` if `out` is empty. */
void openid_add_argument(struct text *out, const char *name, const char *value);

#endif
