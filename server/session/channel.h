/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is known of the way to one client, from its acknowledgements and pongs: round trip, bandwidth, and how long it decodes.
   A frame's way is taken apart by what the client says of its decoding, so that a slow decoder is not taken for a slow network.
   Pure; time is handed in. */
#ifndef SESSION_CHANNEL_H
#define SESSION_CHANNEL_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A client that is busy for a moment (a page that loads, a decoder that begins) looks like a slow network once or twice, a slow network
   time and again: what counts is the least of the last two, of decoding of the last three. */
enum { CHANNEL_LAST = 3 };
struct channel_last { /* zero-initialise */
    double at[CHANNEL_LAST];
    int count; /* of all that there were */
};

struct channel {                     /* zero-initialise; 0: not known yet */
    int64_t rtt_ns[2], rtt_begin_ns; /* least of the last moments, and of those before */
    double ns_per_byte;              /* smoothed; so a network that slows down is noticed sooner than one that recovers */
    double lag_ns;                   /* from sent to acknowledged, without round trip and decoding: what the network adds; smoothed */
    double decode_ns;                /* smoothed */
    struct channel_last last_ns_per_byte, last_lag_ns, last_decode_ns;
    int64_t arrived_ns, acked_ns;
    bool decoding; /* the client decodes without a pause: what it acknowledges had waited there */
};

struct channel_ack {
    size_t bytes;    /* of this frame and of those that it stands for */
    int64_t sent_ns; /* of the first of them */
    int64_t now_ns;
    int64_t decode_ns; /* as the client says; negative: it does not */
};

void channel_on_ack(struct channel *channel, const struct channel_ack *ack);
/* So many bytes of other messages were there after so long. */
void channel_on_bytes(struct channel *channel, size_t bytes, int64_t took_ns);
void channel_on_pong(struct channel *channel, int64_t rtt_ns, int64_t now_ns);
int64_t channel_rtt_ns(const struct channel *channel);
/* The round trip was measured so long ago that nothing may be under way when it is measured next. */
bool channel_rtt_is_old(const struct channel *channel, int64_t now_ns);
/* How long the network takes for so many bytes; 0: not known. */
int64_t channel_transfer_ns(const struct channel *channel, double bytes);

#endif
