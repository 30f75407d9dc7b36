/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts the frames in flight to one client, from the server's own records of frames sent and acknowledged. */
#include "session/pacing/pacer.h"

#include <assert.h>
#include <string.h>

#include "base/clock.h"

/* limit on the bytes in flight to a client, as a time in nanoseconds: they must be able to arrive within this time plus one
   round trip */
static const int64_t AHEAD_NS = 33 * NS_PER_MS;
/* Nanoseconds in which a client acknowledges no frame and its socket accepts no bytes. After STALL_NS it is stalled and gets no
   more frames; after DEAD_NS it is disconnected. See PROTOCOL.md. */
static const int64_t STALL_NS = PACER_STALL_S * NS_PER_S, DEAD_NS = 15 * NS_PER_S;

void pacer_init(struct pacer *pacer)
{
    *pacer = (struct pacer){ 0 };
    quality_ladder_init(&pacer->ladder);
}

static size_t bytes_in_flight(const struct pacer *pacer)
{
    size_t bytes = 0;
    for (int i = 0; i < pacer->flight_count; i++)
        bytes += pacer->flight[i].bytes;
    return bytes;
}

static bool is_writing(const struct pacer *pacer)
{
    return pacer->flight_count > 0 && !pacer->flight[pacer->flight_count - 1].written;
}

static int most_frames(const struct pacer *pacer)
{
    int64_t most = PACER_LEAST + channel_rtt_ns(&pacer->channel) / AHEAD_NS;
    return most > PACER_MOST ? PACER_MOST : (int)most;
}

/* Returns whether one more frame may be requested within the limit on unacknowledged bytes (AHEAD_NS). A frame that is
   requested but not made yet counts with the expected size of a preview at the present step of the quality ladder. */
static bool fits_window(const struct pacer *pacer)
{
    int64_t window_ns = AHEAD_NS + channel_rtt_ns(&pacer->channel);
    double bytes = (double)bytes_in_flight(pacer) + (pacer->asked + 1) * quality_ladder_bytes(&pacer->ladder);
    return channel_transfer_ns(&pacer->channel, bytes) <= window_ns;
}

bool pacer_may_ask(const struct pacer *pacer, int64_t now_ns)
{
    int under_way = pacer->asked + pacer->flight_count;
    if (pacer->cut)
        return false;
    if (under_way == 0)
        return true;
    if (is_writing(pacer) || under_way >= most_frames(pacer) || pacer_state(pacer, now_ns) != PACER_FLOWS ||
        channel_rtt_is_old(&pacer->channel, now_ns))
        return false;
    return fits_window(pacer);
}

/* Counts the newest request. A preview's time begins with its own request, not with that of a frame of another kind, which may
   wait for long. */
static void add_newest(struct pacer *pacer, bool preview, int64_t now_ns)
{
    if (preview && pacer->previews == 0)
        pacer->owed_since_ns = now_ns;
    pacer->previews += preview;
    pacer->newest_is_preview = preview;
}

/* Subtracts an answered or replaced request. */
static void subtract(struct pacer *pacer, bool preview)
{
    pacer->previews -= preview && pacer->previews > 0;
    if (pacer->asked == 0)
        pacer->previews = 0;
}

void pacer_asked(struct pacer *pacer, bool preview, int64_t now_ns)
{
    assert(pacer->asked + pacer->flight_count < PACER_MOST);
    pacer->asked++;
    add_newest(pacer, preview, now_ns);
}

void pacer_replaced(struct pacer *pacer, bool preview, int64_t now_ns)
{
    if (preview && pacer->newest_is_preview)
        return;
    subtract(pacer, pacer->newest_is_preview);
    add_newest(pacer, preview, now_ns);
}

void pacer_dropped(struct pacer *pacer, bool preview)
{
    assert(pacer->asked > 0);
    pacer->asked--;
    subtract(pacer, preview);
    pacer->owed_since_ns = 0;
}

/* Tells the quality ladder how long the server took to make a preview. */
static void measure_making(struct pacer *pacer, const struct pacer_note *note, int64_t now_ns)
{
    if (note->counts && pacer->owed_since_ns && note->made_ns > pacer->owed_since_ns)
        quality_ladder_on_made(&pacer->ladder, note->made_ns - pacer->owed_since_ns, now_ns);
    pacer->owed_since_ns = note->made_ns;
}

uint32_t pacer_sent(struct pacer *pacer, size_t bytes, const struct pacer_note *note, int64_t now_ns)
{
    assert(pacer->asked > 0 && pacer->flight_count < PACER_MOST);
    pacer->asked--;
    subtract(pacer, note->preview);
    measure_making(pacer, note, now_ns);
    pacer->last_seq = pacer->last_seq == UINT32_MAX ? 1 : pacer->last_seq + 1;
    pacer->moved_on_ns = now_ns;
    pacer->flight[pacer->flight_count++] =
        (struct pacer_flight){ .seq = pacer->last_seq, .bytes = bytes, .sent_ns = now_ns, .note = *note };
    return pacer->last_seq;
}

void pacer_wrote(struct pacer *pacer, bool all, int64_t now_ns)
{
    pacer->moved_on_ns = now_ns;
    if (all && is_writing(pacer)) {
        pacer->flight[pacer->flight_count - 1].written = true;
        pacer->flight[pacer->flight_count - 1].written_ns = now_ns;
    }
    pacer->cut &= !all;
}

void pacer_gave_up(struct pacer *pacer)
{
    assert(is_writing(pacer));
    pacer->flight_count--;
    pacer->cut = true;
}

/* Records that the first `count` frames in flight were acknowledged. */
static void arrived(struct pacer *pacer, int count, int64_t decode_ns, int64_t now_ns)
{
    struct channel_ack ack = { .sent_ns = pacer->flight[0].sent_ns, .now_ns = now_ns, .decode_ns = decode_ns };
    for (int i = 0; i < count; i++)
        ack.bytes += pacer->flight[i].bytes;
    pacer->acked = pacer->flight[count - 1];
    pacer->moved_on_ns = now_ns;
    pacer->flight_count -= count;
    memmove(pacer->flight, pacer->flight + count, (size_t)pacer->flight_count * sizeof(pacer->flight[0]));
    channel_on_ack(&pacer->channel, &ack);
    if (pacer->acked.note.moving)
        quality_ladder_on_ack(&pacer->ladder, &pacer->channel, pacer->acked.note.step, pacer->acked.note.scale, pacer->acked.bytes, now_ns);
}

enum pacer_ack pacer_acked(struct pacer *pacer, uint32_t seq, int64_t decode_ns, int64_t now_ns)
{
    for (int i = 0; i < pacer->flight_count; i++) {
        if (pacer->flight[i].seq != seq || !pacer->flight[i].written)
            continue;
        arrived(pacer, i + 1, decode_ns, now_ns);
        return PACER_ACK_NEW;
    }
    bool sent = seq > 0 && seq <= pacer->last_seq && !(seq == pacer->last_seq && is_writing(pacer));
    return sent ? PACER_ACK_OLD : PACER_ACK_NEVER_SENT;
}

enum pacer_state pacer_state(const struct pacer *pacer, int64_t now_ns)
{
    int64_t quiet_ns = pacer->flight_count > 0 || pacer->cut ? now_ns - pacer->moved_on_ns : 0;
    return quiet_ns >= DEAD_NS ? PACER_DEAD : quiet_ns >= STALL_NS ? PACER_STALLS : PACER_FLOWS;
}

bool pacer_is_slower(const struct pacer *pacer, double bytes, int64_t limit_ns)
{
    return channel_transfer_ns(&pacer->channel, bytes) > limit_ns;
}
