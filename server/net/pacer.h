/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How many pictures may be under way to one client: asked for, waiting, sent and not yet acknowledged. Pure; time is handed in. */
#ifndef NET_PACER_H
#define NET_PACER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PACER_WINDOW = 2 };

struct pacer_flight {
    uint32_t seq;
    size_t bytes;
    int64_t sent_ns;
};

struct pacer {                                /* zero-initialise */
    int asked;                                /* pictures asked for, and not sent yet */
    struct pacer_flight flight[PACER_WINDOW]; /* sent and not acknowledged, oldest first */
    int flight_count;
    uint32_t last_seq;
    int64_t ack_ns; /* from sent to acknowledged, the newest */
};

enum pacer_ack { PACER_ACK_NEW, PACER_ACK_OLD, PACER_ACK_NEVER_SENT };

bool pacer_may_ask(const struct pacer *pacer);
void pacer_asked(struct pacer *pacer);
void pacer_dropped(struct pacer *pacer); /* what was asked for does not come, or is not sent */
/* Hands out the frame's number. */
uint32_t pacer_sent(struct pacer *pacer, size_t bytes, int64_t now_ns);
/* A client shows the newest of what came: an acknowledged frame stands for all before it. */
enum pacer_ack pacer_acked(struct pacer *pacer, uint32_t seq, int64_t now_ns);
size_t pacer_bytes_in_flight(const struct pacer *pacer);

#endif
