/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How many pictures may be under way to one client (asked for, waiting, sent and not yet acknowledged), and how good they are. What is
   unacknowledged is at most what its bandwidth takes in 33 ms and a round trip, or one picture; nothing is queued behind it. Pure;
   time is handed in. */
#ifndef SESSION_PACER_H
#define SESSION_PACER_H
#include "session/quality_ladder.h"

enum { PACER_LEAST = 2, PACER_MOST = 8 }; /* pictures, whatever the bandwidth */

struct pacer_note {    /* what is to be known of a picture when it is acknowledged */
    bool moving, full; /* made by the ladder, at this step; of the quality that nothing better follows */
    int step;
    bool of_data;              /* it was made for a reading that changed, else for an input */
    int64_t input_ns, made_ns; /* monotonic: when that was; when it was encoded */
};

struct pacer_flight {
    uint32_t seq;
    size_t bytes;
    bool written;                /* all of it */
    int64_t sent_ns, written_ns; /* its first byte, its last one */
    struct pacer_note note;
};

struct pacer {                              /* pacer_init */
    int asked;                              /* pictures asked for, and not sent yet */
    struct pacer_flight flight[PACER_MOST]; /* sent and not acknowledged, oldest first */
    int flight_count;
    uint32_t last_seq;
    bool cut;                  /* a picture was given up, and its end has not gone yet */
    int64_t moved_on_ns;       /* when the client or its socket last took something */
    struct pacer_flight acked; /* the newest that was */
    struct channel channel;
    struct quality_ladder ladder;
};

enum pacer_state { PACER_FLOWS, PACER_STALLS, PACER_DEAD };
enum pacer_ack { PACER_ACK_NEW, PACER_ACK_OLD, PACER_ACK_NEVER_SENT };

void pacer_init(struct pacer *pacer);
bool pacer_may_ask(const struct pacer *pacer, int64_t now_ns);
void pacer_asked(struct pacer *pacer);
void pacer_dropped(struct pacer *pacer); /* what was asked for does not come, or is not sent */
/* The first byte goes. Hands out the frame's number. */
uint32_t pacer_sent(struct pacer *pacer, size_t bytes, const struct pacer_note *note, int64_t now_ns);
void pacer_wrote(struct pacer *pacer, bool all, int64_t now_ns); /* the socket took a part of the newest; all: its end */
void pacer_gave_up(struct pacer *pacer);                         /* the newest was cut short: nobody will acknowledge it */
/* A client shows the newest of what came: an acknowledged frame stands for all before it. decode_ns: negative: not said. */
enum pacer_ack pacer_acked(struct pacer *pacer, uint32_t seq, int64_t decode_ns, int64_t now_ns);
/* Nothing moves: no more is sent; then it is given up. */
enum pacer_state pacer_state(const struct pacer *pacer, int64_t now_ns);
/* A picture of so many bytes would take the network longer than that. */
bool pacer_is_slower(const struct pacer *pacer, double bytes, int64_t limit_ns);

#endif
