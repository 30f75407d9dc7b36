/* SPDX-License-Identifier: GPL-3.0-or-later */
/* WHEP (draft-ietf-wish-whep): a browser posts an offer to /whep and gets an answer and a place of its own, which it deletes when it is
   done. Whoever watches shows USER:PASSWORD, or the password as a bearer token. Thread: that of the default main context. */
#ifndef VIDEO_WHEP_H
#define VIDEO_WHEP_H
#include <libsoup/soup.h>

#include "options.h"
#include "outputs.h"

struct whep;
/* Serves below /whep. Returns NULL with the reason printed. The caller destroys it, before the server. */
struct whep *whep_create(const struct options *options, struct outputs *outputs);
void whep_serve(struct whep *whep, SoupServer *server);
void whep_destroy(struct whep **whep); /* &NULL is fine; leaves NULL */
/* Ends those whose reader has gone; call it for each frame. NULL is fine. */
void whep_look(struct whep *whep);
guint whep_readers(const struct whep *whep); /* NULL is fine */

#endif
