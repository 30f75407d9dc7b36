/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State shared by the halves of a viewer: viewer.c (receiving and lifetime) and viewer_send.c (sending). */
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
    struct lws *wsi; /* libwebsockets connection of a viewer that decodes frames; NULL: not connected, or the viewer uses `raw` */
    struct raw_websocket *raw;
    lws_sorted_usec_list_t timer;
    struct decoder *decoder;
    int64_t decode_ns; /* time spent so far on decoding the current picture, which may consist of several frames */
    struct text in;    /* the message that is being received; of a binary message over a raw_websocket only the beginning */
    size_t in_count;   /* length of the incoming message */
    bool greeted, welcomed, camera_due, ping_due, follow_due, followed, done;
    double eye[3], target[3], fov_deg;
    uint64_t session;
    uint32_t camera_seq, shown_camera_seq;
    int64_t sent_ns[SENT_RING], begin_ns, next_ns;
    int64_t ping_ns, rtt_ns, offset_us; /* ping_ns: send time of the newest ping; rtt_ns: shortest round trip so far; offset_us: server's
                                           clock minus ours, measured in that round trip */
    /* random motion of the camera: angle of its orbit in degrees at the time leg_ns, and speed since then in degrees per second */
    double angle_deg, speed_deg;
    int64_t leg_ns, leg_end_ns;
    struct {
        uint32_t seq;
        double decode_ms;
    } acks[MAX_ACKS];
    int ack_count;
};

/* Ends the viewer with a reason; reasons of later calls are ignored. */
void viewer_fail(struct viewer *viewer, const char *why);
/* Sends the next message that is due. Returns a negative number if the connection is closed. */
int viewer_send(struct viewer *viewer);
/* Returns true if a message is due for sending. */
bool viewer_has_output(const struct viewer *viewer);
/* Marks messages as due that must be sent by now_ns. */
void viewer_schedule(struct viewer *viewer, int64_t now_ns);
/* Handles the complete message in viewer->in. */
void viewer_on_message(struct viewer *viewer, bool binary);
/* Handles the timer, which fires at the rate of the viewer's camera updates. */
void viewer_on_time(struct viewer *viewer, int64_t now_ns);

#endif
