/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The configuration file of --openid: the identity provider, and the roles of its user groups. OPENID.md describes the keys.
   One thread reads the file; the configuration is immutable afterwards. */
#ifndef OPENID_OPENID_CONFIG_H
#define OPENID_OPENID_CONFIG_H
#include "base/log/log.h"
#include "message/role.h"

struct openid_group {
    char *group;
    int role; /* role (enum role) that members of the provider's group `group` have */
};

struct openid_config {
    /* issuer: URL of the provider; client_id: id of this server at the provider. client_secret_file NULL: this server is a public client
       without a secret */
    char *issuer, *client_id, *client_secret_file;
    char *url;          /* URL of this server's page as browsers see it, with a trailing slash */
    char *redirect_uri; /* URL to which the provider sends browsers back; derived from `url` */
    /* file with the provider's CA certificate; NULL: the machine's trusted certificates */
    char *ca_file;
    /* prompt: parameter `prompt` of the log-in request, NULL: not sent; label: text of the sign-in button */
    char *scope, *prompt, *label;
    char *name_claim, *groups_claim;
    struct openid_group *groups;
    size_t group_count;
    double check_s, hours;
    bool secure;     /* true: cookies are sent over TLS only, because `url` is https */
    char cookie[40]; /* name of the session cookie; differs per plant, so that two plants on one host do not share a login */
};

/* Reads and checks the configuration file. Returns NULL on failure, already logged. */
struct openid_config *openid_config_read(struct log *log, const char *path);
void openid_config_free(struct openid_config **config); /* frees the configuration and sets *config to NULL; accepts a pointer to NULL */
/* Returns the highest role that the configuration grants to members of a group; ROLE_NOBODY: none. */
enum role openid_config_role(const struct openid_config *config, const char *group);

#endif
