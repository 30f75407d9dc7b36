/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who shares which stream of packets. A packet may need the one before it (H.264, or only what changed), so a client belongs to a chain
   and has a place in it; clients of one view share one, and who missed some of it is given those packets, or a picture that stands alone.
   Pure: time is handed in. Thread: under its owner's lock. */
#ifndef NET_CHAINS_H
#define NET_CHAINS_H
#include "net/paint/batch.h"

enum { CHAIN_KEPT = 32 };
struct chain {
    struct chain *next;
    void *work;                      /* the owner's; NULL in a new one */
    uint64_t planned;                /* number of its newest picture, from 1; those that are not made yet count */
    uint64_t oldest;                 /* the lowest number that can still be had */
    uint64_t key;                    /* the newest that stands alone; 0: none */
    int64_t key_ns;                  /* when that was planned */
    struct wish shown;               /* what the newest was made for: view, codec, quality */
    uint64_t content;                /* of it: frame->content */
    struct packet *kept[CHAIN_KEPT]; /* of oldest..oldest + kept_count - 1; NULL where nothing had changed */
    int kept_count;
    size_t kept_bytes, key_bytes;
    size_t members, present; /* clients in it; those of the orders that are being planned */
};

struct chain_link {
    uint64_t client;
    struct chain *chain;
    uint64_t position;                             /* the newest number that was given to it */
    int64_t joined_ns, join_after_ns, patience_ns; /* who falls behind often is not let in soon, since the others pay for it */
};

struct chains { /* zero-initialise */
    struct chain *first;
    struct chain_link *links; /* by client, ascending */
    size_t link_count, link_capacity;
};

struct plan { /* zero-initialise */
    struct chain *chain;
    bool encode;     /* the frame; else the chain's newest picture shows the same */
    bool key;        /* it has to stand alone */
    bool again;      /* it is to be sent even if nothing has changed */
    uint64_t number; /* of the picture, in the chain */
    uint64_t *from;  /* by order: the first number that it is to be given; above `number`: nothing new for it */
    size_t from_capacity;
};

/* What a frame becomes for orders of one codec and quality. Those who cannot share it go to `rest`, to be planned for by themselves. */
void chains_plan(struct chains *chains, const struct frame *frame, struct batch *orders, int64_t now_ns, struct plan *plan,
                 struct batch *rest);
/* What became of the next number: the chain takes its own reference; NULL: nothing had changed. needed: the lowest number that is still
   to be given to someone. */
void chain_keep(struct chain *chain, struct packet *packet, uint64_t needed);
/* What brings a client that lacks from..to up to date, oldest first, into out; no references are taken. Returns how many; -1: it is
   gone. */
int chain_run(const struct chain *chain, uint64_t from, uint64_t to, struct packet *out[CHAIN_KEPT]);
/* The newest could not be made: all in it need one that stands alone. */
void chain_break(struct chain *chain);
void chains_forget(struct chains *chains, uint64_t client);
/* The next chain that nobody is in, taken out; NULL: none. The owner sees to its work and then calls chain_destroy. */
struct chain *chains_take_empty(struct chains *chains, bool (*busy)(const struct chain *chain));
void chain_destroy(struct chain **chain);

#endif
