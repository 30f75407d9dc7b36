/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairing of devices that show a wall's display, so that nobody needs to type a token there. A device generates a secret and
   shows six digits that this daemon assigns to it. An engineer who reads the digits approves the device. Then the secret's hash
   is stored in devices.json in the history folder until the device is revoked. The secret grants the role viewer, for that
   display only. Call only in the event loop. */
#ifndef ACCESS_PAIRINGS_H
#define ACCESS_PAIRINGS_H
#include <jansson.h>

#include "access/tokens.h"
#include "base/files/file_writer.h"
#include "base/refusal.h"
#include "views/wall_remote.h"

enum {
    PAIRING_DIGITS = 6,
    PAIRING_S = 300,      /* validity in seconds of the six digits that a waiting device shows */
    PAIRING_QUIET_S = 60, /* seconds without a request from a waiting device after which its digits expire early */
    PAIRINGS = 64,        /* maximum number of devices waiting for approval, in total */
    PAIRINGS_FROM = 8,    /* maximum number of devices waiting for approval, per address */
    PAIRING_WRONG = 10,   /* maximum number of wrong attempts per minute at entering digits, all engineers together */
    PAIRED_DEVICES = 256,
};
#define PAIRINGS_FILE "devices.json"

enum pairing { PAIRING_WAITS, PAIRING_DONE, PAIRING_FULL, PAIRING_OTHER };

struct pairing_request {
    const char *secret;      /* secret that the device generated; must pass pairings_secret_valid() */
    struct wall_place place; /* wall and display that the device shows; the member `area` is ignored */
    const uint8_t *address;  /* address of the device: 16 bytes, IPv4 as ::ffff:a.b.c.d */
    const char *from;        /* address of the device as text */
};

struct pairings;
/* Reads the paired devices from devices.json. folder: history folder, must outlive the result; NULL: no device can be paired.
   If the file cannot be read (logged), no device is accepted, and the file is never overwritten. Never returns NULL. */
struct pairings *pairings_open(struct log *log, const char *folder, struct file_writer *writer);
void pairings_close(struct pairings **pairings); /* frees the pairings and sets *pairings to NULL; accepts a pointer to NULL */
/* Returns the name of the file (static) if it could not be read; otherwise NULL. */
const char *pairings_unread_file(const struct pairings *pairings);
/* Returns true if the secret has the form of a token from tokens_make(), which has 256 random bits. */
bool pairings_secret_valid(const char *secret);
/* Returns why this daemon cannot pair devices, or REFUSAL_NONE. */
enum refusal_code pairings_refusal(const struct pairings *pairings);
/* Returns the state of the requesting device; a new device joins the devices that wait for approval. PAIRING_DONE: paired.
   PAIRING_WAITS: not approved yet; `digits` and their remaining seconds are set. PAIRING_FULL: too many devices are waiting.
   PAIRING_OTHER: paired with another display, and a secret is valid for one display only. now_ns: monotonic. */
enum pairing pairings_ask(struct pairings *pairings, const struct pairing_request *request, int64_t now_ns, char digits[PAIRING_DIGITS + 1],
                          int *left_s);
/* Pairs the waiting device that shows those digits. who: the approving engineer; now_us: UTC. Returns REFUSAL_NONE with the device's id,
   or why it was refused. */
enum refusal_code pairings_approve(struct pairings *pairings, const char *digits, const char *who, int64_t now_ns, int64_t now_us,
                                   char id[TOKEN_NAME_BYTES]);
/* Revokes a paired device. Returns REFUSAL_NONE, or why it was refused. */
enum refusal_code pairings_revoke(struct pairings *pairings, const char *id);
/* Finds a paired device by the hash of its secret. Its signature is tokens_find_device, so that tokens_set_pairings() can use
   it. pairings: a struct pairings. Returns false if there is none. */
bool pairings_find(const void *pairings, const uint8_t hash[TOKEN_HASH_BYTES], struct token_holder *out);
/* Returns the paired devices as JSON, without the hashes of their secrets; the caller frees the text with mem_free. */
char *pairings_text(const struct pairings *pairings);

/* --- for a renderer, whose core approves devices --------------------------------------------------------------------------------- */

/* Returns a number that increases with each change of paired or waiting devices. The core compares it to decide whether to send
   renderers the lists again. */
uint64_t pairings_number(const struct pairings *pairings);
/* Returns the paired and the waiting devices as JSON for renderers and a standby: { devices, waiting }, with the hashes of
   their secrets. The caller owns the JSON. */
json_t *pairings_told(const struct pairings *pairings, int64_t now_ns);
/* On a renderer or a standby core, replaces the lists of devices with those from the core. Returns false if the JSON is invalid. */
bool pairings_mirror(struct pairings *pairings, const json_t *told, int64_t now_ns);
/* Like pairings_ask(), but on a renderer: looks up the device's state in the lists that its core sent. `digits` stays empty
   until the core has sent the device's digits. */
enum pairing pairings_look(const struct pairings *pairings, const struct pairing_request *request, int64_t now_ns,
                           char digits[PAIRING_DIGITS + 1], int *left_s);
/* Returns the pairing request that a renderer forwards to its core: JSON without the device's secret; the caller frees it with
   mem_free. On the core, pairings_ask_for() handles such a request. */
char *pairings_request_text(const struct pairing_request *request);
void pairings_ask_for(struct pairings *pairings, const json_t *request, int64_t now_ns);

#endif
