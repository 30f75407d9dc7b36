/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates round trip, bandwidth and decoding time of one client. */
#include "session/pacing/channel.h"

#include "base/clock.h"

static const int64_t RTT_WINDOW_NS =
    /* length in nanoseconds of a window of time whose smallest round-trip time is kept; the estimate is the smaller one of the
       present and the previous window */
    15 * NS_PER_S;
/* longest round trip, in nanoseconds, that is attributed to the network alone; a longer one includes waiting in a queue, and is
   replaced by this time */
static const int64_t MAX_RTT_NS = 1 * NS_PER_S;
/* shortest transfer time, in nanoseconds, that is used to compute the bandwidth; a shorter measurement is replaced by this
   time, because it is too inexact */
static const int64_t MIN_TRANSFER_NS = NS_PER_MS / 4;
/* nanoseconds. A frame waited for the client's decoder if its decoding started at most this long after the acknowledgement of
   the frame before. */
static const int64_t WAITED_NS = 1 * NS_PER_MS;
/* size in bytes. A smaller frame may only raise the estimate of the bandwidth, because its measurement is too inexact to lower
   it. */
static const size_t SMALL_BYTES = 4096;
/* weight, 0..1, of a new measurement when it is averaged with the earlier ones (exponential smoothing) */
static const double SAMPLE_WEIGHT = 0.25;

static void smooth(double *value, double sample)
{
    *value = *value > 0 ? *value + SAMPLE_WEIGHT * (sample - *value) : sample;
}

/* Adds a sample, and updates *value from the minimum of the last `most` samples. Sets *value to the minimum itself until there
   are more than `most` samples; afterwards smooths it. */
static void add_sample(double *value, struct channel_last *last, int most, double sample)
{
    last->at[last->count % CHANNEL_LAST] = sample;
    /* keeps the count from overflowing. It stays above CHANNEL_LAST, and count % CHANNEL_LAST stays the index of the next sample */
    last->count = last->count < 2 * CHANNEL_LAST ? last->count + 1 : CHANNEL_LAST + 1;
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
    int64_t sample_ns = less(more(rtt_ns, 1), MAX_RTT_NS);
    if (!channel->rtt_ns[0] || now_ns - channel->rtt_begin_ns >= RTT_WINDOW_NS) {
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
    return channel->rtt_ns[0] && now_ns - channel->rtt_begin_ns >= RTT_WINDOW_NS;
}

/* Handles the client's acknowledgement of a frame, sent after decoding. The reported decoding time gives the time when the
   frame arrived. On the server's clock, every arrival appears late by the delay of the acknowledgement's way back. Only
   differences between arrivals are used, so this delay cancels out. */
void channel_on_ack(struct channel *channel, const struct channel_ack *ack)
{
    int64_t rtt_ns = channel_rtt_ns(channel), took_ns = more(ack->now_ns - ack->sent_ns, 0);
    int64_t decode_ns = less(more(ack->decode_ns, 0), more(took_ns - rtt_ns, 0));
    int64_t arrived_ns = ack->now_ns - decode_ns;
    int64_t transfer_ns = arrived_ns - more(ack->sent_ns + rtt_ns, channel->arrived_ns);
    channel->decoding = decode_ns > WAITED_NS && arrived_ns - channel->acked_ns < WAITED_NS;
    if (ack->decode_ns >= 0)
        add_sample(&channel->decode_ns, &channel->last_decode_ns, CHANNEL_LAST, (double)decode_ns);
    channel->acked_ns = ack->now_ns;
    channel->arrived_ns = arrived_ns;
    if (channel->decoding)
        return;
    add_sample(&channel->lag_ns, &channel->last_lag_ns, 2, (double)more(arrived_ns - ack->sent_ns - rtt_ns, 1));
    double ns_per_byte = (double)more(transfer_ns, MIN_TRANSFER_NS) / (double)(ack->bytes + 1);
    if (ack->bytes >= SMALL_BYTES)
        add_sample(&channel->ns_per_byte, &channel->last_ns_per_byte, 2, ns_per_byte);
    else if (ns_per_byte < channel->ns_per_byte)
        smooth(&channel->ns_per_byte, ns_per_byte);
}

void channel_on_bytes(struct channel *channel, size_t bytes, int64_t took_ns)
{
    int64_t transfer_ns = more(took_ns - channel_rtt_ns(channel), MIN_TRANSFER_NS);
    /* takes a rough initial value of the bandwidth; the frames that follow measure it better */
    channel->ns_per_byte = (double)transfer_ns / (double)(bytes + 1);
}

int64_t channel_transfer_ns(const struct channel *channel, double bytes)
{
    return (int64_t)(bytes * channel->ns_per_byte);
}
