/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The encoded frame, or the reason why there is none, that answers a client's frame request. */
#ifndef SERVICE_ENCODED_FRAME_H
#define SERVICE_ENCODED_FRAME_H
#include "service/frame_request.h"

/* Reason why a request was answered without a packet. FRAME_SKIPPED: the frame was not drawn, because the client sent a later
   request, or because the requested instant is no longer loaded. The client may then show any older picture. */
enum frame_absence {
    FRAME_SKIPPED,
    FRAME_UNCHANGED, /* no packet, because the client already shows this picture */
    FRAME_FAILED     /* no packet, because drawing or encoding the frame failed */
};

struct encoded_frame { /* encoded frame; the code that collected it owns it, and frees it with encoded_frame_destroy() */
    uint64_t client;
    /* number that the client's request gets when its drawing begins; of two frames for a client, the one with the larger number
       shows the newer state */
    uint64_t number;
    struct packet *packet; /* encoded frame; NULL: there is none, and `absence` says why */
    struct packet **earlier; /* packets of a shared stream that the client missed and must decode first, oldest first */
    int earlier_count;
    enum frame_absence absence; /* reason why there is no packet; set only if packet is NULL */
    struct frame_request request;
    int64_t wait_ns; /* nanoseconds from the user's input to the start of drawing */
    int64_t made_ns; /* monotonic time when encoding ended */
    struct encoded_frame *next;
};

/* Frees the frame and drops its references to packets, which other frames may share. Sets *frame to NULL; accepts a pointer to
   NULL. Any thread. */
void encoded_frame_destroy(struct encoded_frame **frame);
/* Returns the number of bytes of all packets of the frame. */
size_t encoded_frame_bytes(const struct encoded_frame *frame);
/* Returns whether the client can decode the frame without earlier packets. */
bool encoded_frame_stands_alone(const struct encoded_frame *frame);

#endif
