/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signed films: the server's statement and signature of each picture, beside pictures that were encoded without loss, so that their pixels
   are those that were signed (SIGNED.md). Thread: one. */
#ifndef FILM_SIGNED_FILM_H
#define FILM_SIGNED_FILM_H
#include "clients/cli/picture/redraw.h"
#include "video.h"

struct film_statements;
struct film_statements *film_statements_create(void); /* never NULL */
void film_statements_destroy(struct film_statements **statements); /* &NULL is fine; leaves NULL */
/* Takes the statement and the signature of the next picture. Returns false if the PNG file has none. */
bool film_statements_add(struct film_statements *statements, const uint8_t *png, size_t count);
/* Puts them into the film. Returns false if they are too long, printed. */
bool film_statements_put(const struct film_statements *statements, struct video *video);

/* Verifies each picture of the film by the server's public key, that none is missing or moved between the first and the last one, and with
   options->plant draws each again; prints what it is. tour: its view may change; each is printed, and since when. Returns 0: all of it
   agrees; 1: something does not; 2: it could not be asked. */
int film_verify(const struct signing_key *key, const char *path, const struct redraw_options *options, bool tour);

#endif
