/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The file of --openid: which identity provider signs people in, and which of its groups have which role. OPENID.md describes its keys.
   Thread: one reads it; immutable from then on. */
#ifndef OPENID_OPENID_CONFIG_H
#define OPENID_OPENID_CONFIG_H
#include "base/log/log.h"
#include "message/role.h"

struct openid_group {
    char *group;
    int role; /* enum role */
};

struct openid_config {
    char *issuer, *client_id, *client_secret_file; /* the last: NULL: a public client */
    char *url;                                     /* of our page, as browsers have it, with a slash at its end */
    char *redirect_uri;                            /* made of that */
    char *ca_file;                                 /* NULL: certificates that the machine trusts */
    char *scope, *prompt, *label;                  /* prompt NULL: none; label: of the button */
    char *name_claim, *groups_claim;
    struct openid_group *groups;
    size_t group_count;
    double check_s, hours;
    bool secure;     /* url is https: cookies are sent over TLS only */
    char cookie[40]; /* its name; another for each plant of a host */
};

/* Reads the file. Returns NULL after an error, already logged. */
struct openid_config *openid_config_read(struct log *log, const char *path);
void openid_config_free(struct openid_config **config); /* &NULL is fine; leaves NULL */
/* Returns the highest role that a group gives; ROLE_NOBODY: none. */
enum role openid_config_role(const struct openid_config *config, const char *group);

#endif
