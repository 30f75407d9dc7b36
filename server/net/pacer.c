/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures under way to one client, by our own records. */
#include "net/pacer.h"

#include <assert.h>
#include <string.h>

bool pacer_may_ask(const struct pacer *pacer)
{
    return pacer->asked + pacer->flight_count < PACER_WINDOW;
}

void pacer_asked(struct pacer *pacer)
{
    assert(pacer_may_ask(pacer));
    pacer->asked++;
}

void pacer_dropped(struct pacer *pacer)
{
    assert(pacer->asked > 0);
    pacer->asked--;
}

uint32_t pacer_sent(struct pacer *pacer, size_t bytes, int64_t now_ns)
{
    assert(pacer->asked > 0 && pacer->flight_count < PACER_WINDOW);
    pacer->asked--;
    pacer->last_seq = pacer->last_seq == UINT32_MAX ? 1 : pacer->last_seq + 1;
    pacer->flight[pacer->flight_count++] = (struct pacer_flight){ .seq = pacer->last_seq, .bytes = bytes, .sent_ns = now_ns };
    return pacer->last_seq;
}

enum pacer_ack pacer_acked(struct pacer *pacer, uint32_t seq, int64_t now_ns)
{
    for (int i = 0; i < pacer->flight_count; i++) {
        if (pacer->flight[i].seq != seq)
            continue;
        pacer->ack_ns = now_ns - pacer->flight[i].sent_ns;
        pacer->flight_count -= i + 1;
        memmove(pacer->flight, pacer->flight + i + 1, (size_t)pacer->flight_count * sizeof(pacer->flight[0]));
        return PACER_ACK_NEW;
    }
    return seq > 0 && seq <= pacer->last_seq ? PACER_ACK_OLD : PACER_ACK_NEVER_SENT;
}

size_t pacer_bytes_in_flight(const struct pacer *pacer)
{
    size_t bytes = 0;
    for (int i = 0; i < pacer->flight_count; i++)
        bytes += pacer->flight[i].bytes;
    return bytes;
}
