/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transfers the tag list from the leading core to a standby or renderer over HTTP, and records which lists
   both have had in common. Each function blocks; call them in one thread at a time. */
#ifndef CORELINK_CORE_TAGS_H
#define CORELINK_CORE_TAGS_H
#include "base/system/http_request.h"
#include "corelink/core_link.h"

#define CORE_TAGS_PATH "/core/tags"

/* Prepares the request for the tag list of the core that core_link_leader() names. The link may be freed afterwards. stop: flag
   that ends the request soon. Returns false if there is no such core, or no memory. End with http_request_finish(). */
bool core_tags_begin(struct http_request *request, struct core_link *link, const _Atomic bool *stop);
/* Requests the tag list. Returns its text (mem_free), or NULL with the reason in *why (mem_free). */
char *core_tags_get(struct http_request *request, char **why);

/* Records in a folder the hash of the tag list that this node and its core have in common. A list without a record was edited on
   this machine, and must not be overwritten. Returns 0 or -errno. */
int core_tags_agree(const char *folder, const char *hash);
/* Adds to the record the hash of a list that this node is about to save, and keeps the newest eight: the core may accept the node
   only with a later list. Returns 0 or -errno. */
int core_tags_expect(const char *folder, const char *hash);
/* Returns true if the record in the folder has this hash. */
bool core_tags_agreed(const char *folder, const char *hash);

#endif
