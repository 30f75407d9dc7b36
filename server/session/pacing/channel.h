/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates the network and the decoder of one client from its acknowledgements and pongs: round trip, bandwidth and decoding
   time. The decoding time that the client reports is subtracted, so that a slow decoder does not look like a slow network.
   Pure; the caller passes the time. Call only in the event loop. */
#ifndef SESSION_PACING_CHANNEL_H
#define SESSION_PACING_CHANNEL_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Number of recent samples that are stored. A client that is briefly busy (its page loads, a decoder starts) looks like a slow
   network for one or two samples; a slow network stays slow. So the minimum of the last two samples is used, and for the
   decoding time the minimum of the last three. */
enum { CHANNEL_LAST = 3 };
struct channel_last { /* ring buffer of the last samples of one measured quantity, such as the round trip; zero-initialise */
    double at[CHANNEL_LAST];
    int count; /* number of samples so far; kept small once the buffer is full, so that it cannot overflow */
};

struct channel { /* estimate for the connection to one client; zero-initialise; a member that is 0 was not measured yet */
    /* rtt_ns: minimum round trip: [0] in the current measuring window, [1] in the one before; 0: not measured. rtt_begin_ns:
       monotonic time when the current window began */
    int64_t rtt_ns[2], rtt_begin_ns;
    double ns_per_byte; /* nanoseconds that the network needs per byte, smoothed; reacts faster to a slowdown than to a recovery */
    double lag_ns;      /* delay added by the network: time from sending to acknowledgement, minus round trip and decoding, smoothed */
    double decode_ns;   /* decoding time of a frame in nanoseconds, as reported by the client, smoothed */
    struct channel_last last_ns_per_byte, last_lag_ns, last_decode_ns;
    int64_t arrived_ns, acked_ns;
    bool decoding; /* true: the client decodes one frame after the other without a pause, so frames queue at its decoder */
};

struct channel_ack {
    size_t bytes;    /* number of bytes of this frame and of the earlier frames that the acknowledgement covers */
    int64_t sent_ns; /* monotonic time when the first of the acknowledged frames was sent */
    int64_t now_ns;
    int64_t decode_ns; /* decoding time as reported by the client; negative: not reported */
};

/* Updates the channel estimate with an acknowledgement of the client. */
void channel_on_ack(struct channel *channel, const struct channel_ack *ack);
/* Updates the bandwidth estimate from messages other than frames: `bytes` bytes arrived within took_ns. */
void channel_on_bytes(struct channel *channel, size_t bytes, int64_t took_ns);
/* Updates the round-trip estimate with one measurement. */
void channel_on_pong(struct channel *channel, int64_t rtt_ns, int64_t now_ns);
/* Returns the round-trip time; 0: not measured yet. */
int64_t channel_rtt_ns(const struct channel *channel);
/* Returns whether the last measurement of the round-trip time is old, so that another is needed. Measure only while nothing
   else is in flight to the client. */
bool channel_rtt_is_old(const struct channel *channel, int64_t now_ns);
/* Returns the time that the client's bandwidth needs for `bytes` bytes, without the round trip; 0: the bandwidth is not known. */
int64_t channel_transfer_ns(const struct channel *channel, double bytes);

#endif
