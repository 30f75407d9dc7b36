/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the two halves of a viewer: receiving and lifetime (viewer.c), sending (viewer_send.c). */
#ifndef CLI_VIEWER_VIEWER_IMPL_H
#define CLI_VIEWER_VIEWER_IMPL_H
#include "raw_websocket.h"
#include "base/text/text.h"
#include "clients/link/decoder.h"
#include "viewer.h"

enum { SENT_RING = 4096, MAX_ACKS = 16 };

struct viewer {
    struct viewer_params params;
    struct viewer_result result;
    struct lws_context *context;
    struct lws *wsi; /* one of these, while it is connected */
    struct raw_websocket *raw;
    lws_sorted_usec_list_t timer;
    struct decoder *decoder;
    int64_t decode_ns; /* of the parts of a picture so far */
    struct text in;    /* the message that comes; over `bare`, of a binary one no more than its beginning */
    size_t in_count;   /* its length */
    bool greeted, welcomed, camera_due, ping_due, follow_due, followed, done;
    double eye[3], target[3], fov_deg;
    uint64_t session;
    uint32_t camera_seq, shown_camera_seq;
    int64_t sent_ns[SENT_RING], begin_ns, next_ns;
    int64_t ping_ns, rtt_ns, offset_us; /* the server's clock less ours, by the shortest round trip */
    double angle_deg, speed_deg;        /* of random motion, from `leg_ns` on */
    int64_t leg_ns, leg_end_ns;
    struct {
        uint32_t seq;
        double decode_ms;
    } acks[MAX_ACKS];
    int ack_count;
};

/* Ends the viewer with this reason; the first one stands. */
void viewer_fail(struct viewer *viewer, const char *why);
/* Sends the next message that is due. Returns a negative number if the connection is gone. */
int viewer_send(struct viewer *viewer);
/* Returns whether a message is due. */
bool viewer_has_output(const struct viewer *viewer);
/* Marks the messages that are due by now_ns. */
void viewer_schedule(struct viewer *viewer, int64_t now_ns);
/* Handles the complete message in viewer->in. */
void viewer_on_message(struct viewer *viewer, bool binary);
/* Handles the timer, which fires as often as the viewer's cameras go. */
void viewer_on_time(struct viewer *viewer, int64_t now_ns);

#endif
