/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pacer: limits how many frames may be under way to one client (requested, waiting, sent and not acknowledged), and owns
   the client's channel estimate and quality ladder. Unacknowledged frames together may have as many bytes as the bandwidth
   carries in 33 ms plus one round trip; one frame may always be sent. Nothing queues behind them. Pure; the caller passes the
   time. Call only in the event loop. */
#ifndef SESSION_PACING_PACER_H
#define SESSION_PACING_PACER_H
#include "session/pacing/quality_ladder.h"

/* limits on the number of frames in flight to one client: from PACER_LEAST, growing with the round-trip time, to PACER_MOST */
enum { PACER_LEAST = 2, PACER_MOST = 8 };

struct pacer_note {    /* properties of a sent frame that are needed when the client acknowledges the frame */
    /* moving: the frame is a preview, drawn at step `step` of the quality ladder; full: the frame is a refined one (detailed,
       for a camera at rest) in full quality */
    bool moving, full;
    int step;
    double scale; /* preview: factor by which width and height are smaller than those of the view; 0: as at its step */
    bool preview; /* as for pacer_asked() */
    bool counts;  /* true: the time for making the frame counts for the size of later previews; only if `preview` is set, too */
    bool of_data; /* true: the frame was made because a reading changed; false: because of an input */
    /* monotonic: input_ns: time of the input or the changed reading; made_ns: when the frame was encoded */
    int64_t input_ns, made_ns;
};

struct pacer_flight {
    uint32_t seq;
    size_t bytes;
    bool written;                /* true: all bytes of the frame were written to the socket */
    /* sent_ns: monotonic time when the frame's first byte was written to the socket; written_ns: its last byte */
    int64_t sent_ns, written_ns;
    struct pacer_note note;
};

struct pacer {                              /* limits the frames under way to one client; initialise with pacer_init() */
    int asked;                              /* number of frames requested from the render service for the client and not sent yet */
    int previews;                           /* number of the frames in `asked` that are previews of a moving camera */
    bool newest_is_preview;                 /* true: the newest requested frame is a preview of a moving camera */
    /* monotonic time since which the render service has owed the client a preview: of the client's last frame, or of the request
       if that came later; 0: not known */
    int64_t owed_since_ns;
    struct pacer_flight flight[PACER_MOST]; /* frames sent and not acknowledged, oldest first */
    int flight_count;
    uint32_t last_seq;
    /* true: the rest of the newest frame is not sent, and the end of its WebSocket message must still be written */
    bool cut;
    int64_t moved_on_ns;       /* monotonic time of the client's last acknowledgement, or when its socket last accepted bytes */
    struct pacer_flight acked; /* the newest frame that the client has acknowledged */
    struct channel channel;
    struct quality_ladder ladder;
};

/* a client that acknowledges no frame and accepts no bytes for this many seconds counts as stalled (PROTOCOL.md) */
enum { PACER_STALL_S = 2 };
enum pacer_state { PACER_FLOWS, PACER_STALLS, PACER_DEAD };
enum pacer_ack { PACER_ACK_NEW, PACER_ACK_OLD, PACER_ACK_NEVER_SENT };

void pacer_init(struct pacer *pacer);
/* Returns whether another frame may be requested for the client now. */
bool pacer_may_ask(const struct pacer *pacer, int64_t now_ns);
/* Counts a frame that was requested. preview: the frame is a preview of a moving camera. Only the time for making such previews is
   measured. The caller passes the same value when the frame is dropped or sent (`preview` in struct pacer_note). */
void pacer_asked(struct pacer *pacer, bool preview, int64_t now_ns);
/* Counts a request that replaces the newest one, whose drawing has not begun. preview: of the new request, as for pacer_asked(). */
void pacer_replaced(struct pacer *pacer, bool preview, int64_t now_ns);
/* Counts a requested frame that will not be sent: the render service does not deliver it, or the session drops it. preview: as for
   pacer_asked(). */
void pacer_dropped(struct pacer *pacer, bool preview);
/* Counts a frame whose first byte is being sent. Returns the frame's sequence number in the session. */
uint32_t pacer_sent(struct pacer *pacer, size_t bytes, const struct pacer_note *note, int64_t now_ns);
/* Records that the socket has accepted a part of the newest frame. all: true: this was the frame's last part. */
void pacer_wrote(struct pacer *pacer, bool all, int64_t now_ns);
/* Records that the rest of the newest frame is not sent, so that the client will not acknowledge the frame. */
void pacer_gave_up(struct pacer *pacer);
/* Records the acknowledgement of frame seq, which covers all earlier frames too, and updates the channel estimate and the quality ladder.
   decode_ns: decoding time reported by the client; negative: not reported. Returns PACER_ACK_NEW, PACER_ACK_OLD if the frame was
   acknowledged before, or PACER_ACK_NEVER_SENT. */
enum pacer_ack pacer_acked(struct pacer *pacer, uint32_t seq, int64_t decode_ns, int64_t now_ns);
/* Returns PACER_FLOWS; PACER_STALLS if, for PACER_STALL_S, the client acknowledged no frame and its socket accepted no bytes (send no
   more); or PACER_DEAD if it should be disconnected. */
enum pacer_state pacer_state(const struct pacer *pacer, int64_t now_ns);
/* Returns whether the network would take longer than limit_ns to carry `bytes` bytes. */
bool pacer_is_slower(const struct pacer *pacer, double bytes, int64_t limit_ns);

#endif
