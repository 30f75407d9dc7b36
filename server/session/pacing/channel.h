/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The channel estimate of one client, from its acknowledgements and pongs: round trip, bandwidth and decoding time. The time that the
   client reports for decoding is subtracted, so that a slow decoder is not taken for a slow network. Pure; time is handed in. Thread: the
   loop. */
#ifndef SESSION_PACING_CHANNEL_H
#define SESSION_PACING_CHANNEL_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A client that is busy for a moment (while its page loads, or a decoder starts) looks like a slow network once or twice; a slow network
   does so again and again. So the least of the last two samples counts, of decoding the least of three. */
enum { CHANNEL_LAST = 3 };
struct channel_last { /* zero-initialise */
    double at[CHANNEL_LAST];
    int count; /* of all samples so far */
};

struct channel {                     /* zero-initialise; 0: not known yet */
    int64_t rtt_ns[2], rtt_begin_ns; /* minimum of the current window, and of the one before */
    double ns_per_byte;              /* smoothed; slowing down is noticed sooner than recovering */
    double lag_ns;                   /* from sent to acknowledged, without round trip and decoding: what the network adds; smoothed */
    double decode_ns;                /* smoothed */
    struct channel_last last_ns_per_byte, last_lag_ns, last_decode_ns;
    int64_t arrived_ns, acked_ns;
    bool decoding; /* the client decodes without a pause: frames wait there */
};

struct channel_ack {
    size_t bytes;    /* of this frame and those that the acknowledgement stands for */
    int64_t sent_ns; /* of the first of them */
    int64_t now_ns;
    int64_t decode_ns; /* as reported by the client; negative: not */
};

/* Updates the estimate with an acknowledgement. */
void channel_on_ack(struct channel *channel, const struct channel_ack *ack);
/* Updates the estimate: so many bytes of other messages had arrived after took_ns. */
void channel_on_bytes(struct channel *channel, size_t bytes, int64_t took_ns);
/* Updates the round trip. */
void channel_on_pong(struct channel *channel, int64_t rtt_ns, int64_t now_ns);
/* Returns the round trip; 0: not known. */
int64_t channel_rtt_ns(const struct channel *channel);
/* Returns whether the round trip was measured so long ago that it is to be measured again, with nothing else under way. */
bool channel_rtt_is_old(const struct channel *channel, int64_t now_ns);
/* Returns how long the client's bandwidth takes for so many bytes, without the round trip; 0: the bandwidth is not known. */
int64_t channel_transfer_ns(const struct channel *channel, double bytes);

#endif
