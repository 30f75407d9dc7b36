/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signs pictures on a thread of its own: the statement of 10,000 readings takes a tenth of a second, in which the loop would send nothing.
   Thread: the loop. */
#ifndef NET_PICTURE_SIGNER_H
#define NET_PICTURE_SIGNER_H
#include "provenance/signed_picture.h"
#include "service/encoded_frame.h"

struct signing {
    struct encoded_frame *encoded; /* NULL: somebody took it */
    struct picture_origin origin; /* its args are the signing's own */
    bool good;                    /* signed: the frame's packet is the signed file now; else it cannot be */
    struct signing *next;
};
void signing_free(struct signing **signing); /* leaves NULL */

struct picture_signer;
/* Starts the thread; notify(arg) is called on it when a picture is signed. Returns NULL if it cannot start, already logged.
   key must outlive it. */
struct picture_signer *picture_signer_create(struct log *log, const struct signing_key *key, void (*notify)(void *arg), void *arg);
/* Ends the thread. &NULL is fine; leaves NULL. */
void picture_signer_destroy(struct picture_signer **signer);
/* Takes a frame that has a record, and copies the args. origin->scene must stay until picture_signer_settle. */
void picture_signer_ask(struct picture_signer *signer, struct encoded_frame *encoded, const struct picture_origin *origin);
/* Returns what was signed so far, oldest first; the caller owns it (signing_free). NULL: nothing. */
struct signing *picture_signer_collect(struct picture_signer *signer);
/* Drops what waits, and returns once nothing of a plant is read any more. */
void picture_signer_settle(struct picture_signer *signer);

#endif
