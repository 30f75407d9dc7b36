/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round trip, bandwidth and decoding time of one client. */
#include "session/pacing/channel.h"

#include "base/clock.h"

static const int64_t RTT_NS = 15 * NS_PER_S;      /* a measured round trip is good for so long, and for as long again */
static const int64_t RTT_MOST_NS = 1 * NS_PER_S;  /* more is a queue */
static const int64_t SHORTEST_NS = NS_PER_MS / 4; /* transfers that took less say only that there is enough */
static const int64_t WAITED_NS = 1 * NS_PER_MS;   /* decoding that began so soon after the frame before had waited for it */
static const size_t SMALL_BYTES = 4096;           /* frames in which little changed say at most that there is more bandwidth */
static const double SHARE = 0.25;                 /* of a new sample in what is smoothed */

static void smooth(double *value, double sample)
{
    *value = *value > 0 ? *value + SHARE * (sample - *value) : sample;
}

/* The least of the last `most`. The first few say what is known; after them it is smoothed. */
static void note(double *value, struct channel_last *last, int most, double sample)
{
    last->at[last->count % CHANNEL_LAST] = sample;
    last->count = last->count < 2 * CHANNEL_LAST ? last->count + 1 : CHANNEL_LAST + 1; /* it goes round */
    double least = sample;
    for (int back = 1; back <= most && back <= last->count; back++) {
        double one = last->at[(last->count - back) % CHANNEL_LAST];
        least = one < least ? one : least;
    }
    if (last->count > most)
        smooth(value, least);
    else
        *value = least;
}

static int64_t more(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int64_t less(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

void channel_on_pong(struct channel *channel, int64_t rtt_ns, int64_t now_ns)
{
    int64_t sample_ns = less(more(rtt_ns, 1), RTT_MOST_NS);
    if (!channel->rtt_ns[0] || now_ns - channel->rtt_begin_ns >= RTT_NS) {
        channel->rtt_ns[1] = channel->rtt_ns[0];
        channel->rtt_ns[0] = sample_ns;
        channel->rtt_begin_ns = now_ns;
    }
    channel->rtt_ns[0] = less(channel->rtt_ns[0], sample_ns);
}

int64_t channel_rtt_ns(const struct channel *channel)
{
    return channel->rtt_ns[1] ? less(channel->rtt_ns[0], channel->rtt_ns[1]) : channel->rtt_ns[0];
}

bool channel_rtt_is_old(const struct channel *channel, int64_t now_ns)
{
    return channel->rtt_ns[0] && now_ns - channel->rtt_begin_ns >= RTT_NS;
}

/* The client says when it had the frame: it acknowledges after decoding. On our clock that is later by the way back, as is all that is
   kept here; differences are what counts. */
void channel_on_ack(struct channel *channel, const struct channel_ack *ack)
{
    int64_t rtt_ns = channel_rtt_ns(channel), took_ns = more(ack->now_ns - ack->sent_ns, 0);
    int64_t decode_ns = less(more(ack->decode_ns, 0), more(took_ns - rtt_ns, 0));
    int64_t arrived_ns = ack->now_ns - decode_ns;
    int64_t transfer_ns = arrived_ns - more(ack->sent_ns + rtt_ns, channel->arrived_ns);
    channel->decoding = decode_ns > WAITED_NS && arrived_ns - channel->acked_ns < WAITED_NS;
    if (ack->decode_ns >= 0)
        note(&channel->decode_ns, &channel->last_decode_ns, CHANNEL_LAST, (double)decode_ns);
    channel->acked_ns = ack->now_ns;
    channel->arrived_ns = arrived_ns;
    if (channel->decoding)
        return;
    note(&channel->lag_ns, &channel->last_lag_ns, 2, (double)more(arrived_ns - ack->sent_ns - rtt_ns, 1));
    double ns_per_byte = (double)more(transfer_ns, SHORTEST_NS) / (double)(ack->bytes + 1);
    if (ack->bytes >= SMALL_BYTES)
        note(&channel->ns_per_byte, &channel->last_ns_per_byte, 2, ns_per_byte);
    else if (ns_per_byte < channel->ns_per_byte)
        smooth(&channel->ns_per_byte, ns_per_byte);
}

void channel_on_bytes(struct channel *channel, size_t bytes, int64_t took_ns)
{
    int64_t transfer_ns = more(took_ns - channel_rtt_ns(channel), SHORTEST_NS);
    channel->ns_per_byte = (double)transfer_ns / (double)(bytes + 1); /* a guess, while the client begins: frames tell */
}

int64_t channel_transfer_ns(const struct channel *channel, double bytes)
{
    return (int64_t)(bytes * channel->ns_per_byte);
}
