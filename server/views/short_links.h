/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Short links: views that users share under a short id, such as /v/ID. Stored in links.json in the history's folder. Call only in
   the event loop. */
#ifndef VIEWS_SHORT_LINKS_H
#define VIEWS_SHORT_LINKS_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/files/file_writer.h"
#include "base/refusal.h"

enum { SHORT_LINKS = 500, SHORT_LINK_ID_BYTES = 17 };
#define SHORT_LINKS_FILE "links.json"
#define SHORT_LINK_PATH "/v/"

struct short_links;
/* Reads the links. folder: the history's folder; NULL: no links can be made. An unreadable file counts as empty (logged) and is not
   overwritten. Never returns NULL. `folder` must outlive the links. */
struct short_links *short_links_open(struct log *log, const char *folder, struct file_writer *writer);
void short_links_close(struct short_links **links); /* Frees the links and sets *links to NULL. *links may be NULL. */
/* Returns the name of the file (static) if it could not be read; otherwise NULL. */
const char *short_links_unread_file(const struct short_links *links);
/* Returns REFUSAL_NONE with the id of a view, or why it failed. The id depends only on the view, so that sharing a view again
   returns the same id. Sharing it again also marks the link as used. If SHORT_LINKS links exist, a new link replaces the least
   recently used one. If more than half of the links were never used, the new link replaces the oldest of these. Fails with
   REFUSAL_LINKS_OFTEN if many new links were made within a short time. view: the part after # of the page's address. added: set
   to whether the link is new; may be NULL. */
enum refusal_code short_links_share(struct short_links *links, const char *view, int64_t now_us, char id[SHORT_LINK_ID_BYTES], bool *added);
/* Returns the view of a link, owned by `links`; NULL: there is no such link. */
const char *short_links_find(const struct short_links *links, const char *id);
/* Returns a counter that increases with each change of the links; 0: there has been no link. */
uint64_t short_links_number(const struct short_links *links);
/* For the connection between a core and its renderers. short_links_list() returns the list of links, owned by `links`.
   short_links_mirror() replaces the list with that of the other daemon; it returns false, with nothing changed, if that list is
   invalid. */
json_t *short_links_list(const struct short_links *links);
bool short_links_mirror(struct short_links *links, json_t *list);

#endif
