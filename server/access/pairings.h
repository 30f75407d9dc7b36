/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Devices that show a wall's display without anybody typing a token there. A device makes its own secret and shows six digits; an engineer
   who reads them approves it, and the hash of the secret is kept in devices.json in the folder of the history until it is revoked. The
   secret stands for the role viewer, of no other display. Thread: the loop. */
#ifndef ACCESS_PAIRINGS_H
#define ACCESS_PAIRINGS_H
#include <jansson.h>

#include "access/tokens.h"
#include "base/refusal.h"
#include "views/wall_remote.h"

enum {
    PAIRING_DIGITS = 6,
    PAIRING_S = 300,       /* digits are good for so long, */
    PAIRING_QUIET_S = 60,  /* and not once the device has not asked for so long */
    PAIRINGS = 64,         /* devices that may wait, shared equally among addresses */
    PAIRINGS_FROM = 8,     /* devices that may wait from one address */
    PAIRING_WRONG = 10,    /* digits that may be wrong within a minute */
    PAIRED_DEVICES = 256,
};
#define PAIRINGS_FILE "devices.json"

enum pairing { PAIRING_WAITS, PAIRING_DONE, PAIRING_FULL, PAIRING_OTHER };

struct pairing_request {
    const char *secret;     /* of the device; pairings_secret_valid() */
    struct wall_place place; /* that it shows; without an area */
    const uint8_t *address; /* of the device, as in struct address_usage */
    const char *from;       /* the same as text */
};

struct pairings;
/* Reads the devices. folder: of the history; NULL: none can be paired. Of a file that cannot be read (logged) no device is let in, and it
   is not written over. Never returns NULL. folder must outlive them. */
struct pairings *pairings_open(struct log *log, const char *folder);
void pairings_close(struct pairings **pairings); /* &NULL is fine; leaves NULL */
/* Returns whether a device may have that secret: of the form of a token (tokens_make), which has 256 bits. */
bool pairings_secret_valid(const char *secret);
/* Returns why no device can be paired (static), or NULL. */
enum refusal_code pairings_refusal(const struct pairings *pairings);
/* Returns whether the device is paired; if it waits, its digits and for how long they are good. PAIRING_FULL: too many wait.
   PAIRING_OTHER: the device is paired as another display, and that secret is for no second one. now_ns: monotonic. */
enum pairing pairings_ask(struct pairings *pairings, const struct pairing_request *request, int64_t now_ns, char digits[PAIRING_DIGITS + 1],
                          int *left_s);
/* Pairs the device that shows those digits. who: approves it; now_us: UTC. Returns NULL with the id of the device, or why it could not
   (static). */
enum refusal_code pairings_approve(struct pairings *pairings, const char *digits, const char *who, int64_t now_ns, int64_t now_us,
                             char id[TOKEN_NAME_BYTES]);
/* Revokes a device. Returns NULL, or why it could not (static). */
enum refusal_code pairings_revoke(struct pairings *pairings, const char *id);
/* Looks a paired device up by the hash of its secret, for tokens_set_pairings(). pairings: a struct pairings. Returns false if there is
   none. */
bool pairings_find(const void *pairings, const uint8_t hash[TOKEN_HASH_BYTES], struct token_holder *out);
/* Returns the paired devices as JSON, without their hashes; mem_free. */
char *pairings_text(const struct pairings *pairings);

/* --- of a renderer, whose core lets devices in ------------------------------------------------------------------------------- */

/* Returns a number that increases with each change of the devices that are paired, or wait. */
uint64_t pairings_number(const struct pairings *pairings);
/* Returns them as the core tells them: { devices, waiting }, with hashes; the caller's. */
json_t *pairings_told(const struct pairings *pairings, int64_t now_ns);
/* Takes them in at a renderer, or a core that stands by. Returns false if they cannot be such. */
bool pairings_mirror(struct pairings *pairings, const json_t *told, int64_t now_ns);
/* As pairings_ask(), by what the core told: digits "" until it has told some. */
enum pairing pairings_look(const struct pairings *pairings, const struct pairing_request *request, int64_t now_ns,
                           char digits[PAIRING_DIGITS + 1], int *left_s);
/* Returns what a renderer tells its core where a device asks: JSON without the secret; mem_free. The core does as it says. */
char *pairings_request_text(const struct pairing_request *request);
void pairings_ask_for(struct pairings *pairings, const json_t *request, int64_t now_ns);

#endif
