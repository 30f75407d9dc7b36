/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pacer: limits how many frames may be under way to one client (requested, waiting, sent and not acknowledged), and keeps its channel
   estimate and quality ladder. Unacknowledged are at most the bytes that the bandwidth carries in 33 ms and a round trip, or one frame;
   nothing is queued behind that. Pure; time is handed in. Thread: the loop. */
#ifndef SESSION_PACING_PACER_H
#define SESSION_PACING_PACER_H
#include "session/pacing/quality_ladder.h"

enum { PACER_LEAST = 2, PACER_MOST = 8 }; /* frames, whatever the bandwidth */

struct pacer_note {    /* what is to be known of a frame when it is acknowledged */
    bool moving, full; /* a preview, at `step` of the ladder; of full quality */
    int step;
    bool of_data;              /* made for a changed reading, else for an input */
    int64_t input_ns, made_ns; /* monotonic: when that happened; when it was encoded */
};

struct pacer_flight {
    uint32_t seq;
    size_t bytes;
    bool written;                /* completely */
    int64_t sent_ns, written_ns; /* when its first byte, its last byte was written */
    struct pacer_note note;
};

struct pacer {                              /* pacer_init */
    int asked;                              /* frames requested and not sent yet */
    struct pacer_flight flight[PACER_MOST]; /* sent and not acknowledged, oldest first */
    int flight_count;
    uint32_t last_seq;
    bool cut;                  /* a frame was given up, and the end of its message is not written yet */
    int64_t moved_on_ns;       /* when the client last acknowledged, or its socket last took bytes */
    struct pacer_flight acked; /* the newest frame that was acknowledged */
    struct channel channel;
    struct quality_ladder ladder;
};

enum { PACER_STALL_S = 2 }; /* without an acknowledgement, as in PROTOCOL.md */
enum pacer_state { PACER_FLOWS, PACER_STALLS, PACER_DEAD };
enum pacer_ack { PACER_ACK_NEW, PACER_ACK_OLD, PACER_ACK_NEVER_SENT };

void pacer_init(struct pacer *pacer);
/* Returns whether another frame may be requested now. */
bool pacer_may_ask(const struct pacer *pacer, int64_t now_ns);
/* Counts a frame that was requested. */
void pacer_asked(struct pacer *pacer);
/* Counts a requested frame that does not come, or is not sent. */
void pacer_dropped(struct pacer *pacer);
/* Counts a frame whose first byte is being sent. Returns its number in the session. */
uint32_t pacer_sent(struct pacer *pacer, size_t bytes, const struct pacer_note *note, int64_t now_ns);
/* Notes that the socket took a part of the newest frame; all: its end. */
void pacer_wrote(struct pacer *pacer, bool all, int64_t now_ns);
/* Notes that the newest frame was cut short: it will not be acknowledged. */
void pacer_gave_up(struct pacer *pacer);
/* Takes an acknowledgement, which stands for all frames before it too, and updates channel and ladder. decode_ns: the client's time of
   decoding; negative: not said. Returns whether that frame was newly acknowledged, was before, or was never sent. */
enum pacer_ack pacer_acked(struct pacer *pacer, uint32_t seq, int64_t decode_ns, int64_t now_ns);
/* Returns whether frames flow; PACER_STALLS: nothing was taken for too long and no more is to be sent; PACER_DEAD: the client is to be
   disconnected. */
enum pacer_state pacer_state(const struct pacer *pacer, int64_t now_ns);
/* Returns whether the network would take longer than limit_ns for a frame of so many bytes. */
bool pacer_is_slower(const struct pacer *pacer, double bytes, int64_t limit_ns);

#endif
