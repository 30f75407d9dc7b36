/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signs pictures on a thread of its own: signing a statement about 10,000 readings takes a tenth of a second, too long for the
   event loop. Call only in the event loop. */
#ifndef NET_PICTURE_SIGNER_H
#define NET_PICTURE_SIGNER_H
#include "provenance/signed_picture.h"
#include "service/encoded_frame.h"

struct signing {
    struct encoded_frame *encoded; /* frame to sign; NULL: the caller that received the signed frame has taken it */
    /* content of the signed statement besides the readings: plant, arguments of the request and overlay; this struct owns the
       arguments */
    struct picture_origin origin;
    bool good;                     /* true: the frame's packet is now the signed file; false: it could not be signed */
    struct signing *next;
};
void signing_free(struct signing **signing); /* frees the picture and sets *signing to NULL */

struct picture_signer;
/* Starts the thread; it calls notify(arg) when a picture is signed. Returns NULL if it cannot start, already logged. `key` must outlive the
   signer. */
struct picture_signer *picture_signer_create(struct log *log, const struct signing_key *key, void (*notify)(void *arg), void *arg);
/* Ends the thread and sets *signer to NULL; accepts a pointer to NULL. */
void picture_signer_destroy(struct picture_signer **signer);
/* Queues a frame, which must carry the record of what it was drawn from. Takes ownership of the frame and copies the arguments.
   origin->scene must stay valid until picture_signer_settle(). */
void picture_signer_ask(struct picture_signer *signer, struct encoded_frame *encoded, const struct picture_origin *origin);
/* Returns the list of pictures signed so far, oldest first; the caller frees each with signing_free(). NULL: none. */
struct signing *picture_signer_collect(struct picture_signer *signer);
/* Drops pictures that are not signed yet, and returns once the signing thread no longer uses data of a plant. */
void picture_signer_settle(struct picture_signer *signer);

#endif
