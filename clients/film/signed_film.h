/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signed films contain the server's signed statement about each picture. The pictures are encoded losslessly, so that their
   pixels are exactly those that the server signed (SIGNED.md). Call from one thread only. */
#ifndef FILM_SIGNED_FILM_H
#define FILM_SIGNED_FILM_H
#include "clients/cli/picture/redraw.h"
#include "video.h"

struct film_statements;
struct film_statements *film_statements_create(void);              /* never NULL */
void film_statements_destroy(struct film_statements **statements); /* &NULL is fine; leaves NULL */
/* Takes the signed statement of the next picture from the picture's PNG file. Returns false if the file has none. */
bool film_statements_add(struct film_statements *statements, const uint8_t *png, size_t count);
/* Writes the collected statements into the film's metadata. Returns false, with the reason printed, if they are too long. */
bool film_statements_put(const struct film_statements *statements, struct video *video);

/* Verifies each picture of the film with the server's public key, and that no picture between the first and the last is missing
   or out of place. With options->plant it also redraws each picture. Prints the findings. tour: the view may change; each view
   is printed with its start time. Returns 0 if all agree, 1 if something differs, 2 if the film could not be checked. */
int film_verify(const struct signing_key *key, const char *path, const struct redraw_options *options, bool tour);

#endif
