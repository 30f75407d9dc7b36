/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Admission: decides whether the server can take one more session, by configured limits and by the drawing cost measured from finished
   frames. Capacity is shared equally among client addresses, then among each address's sessions, so that one address cannot exhaust it.
   Pure: the caller passes the time. Thread: the event loop. */
#ifndef SESSION_PACING_ADMISSION_H
#define SESSION_PACING_ADMISSION_H
#include "service/encoded_frame.h"
#include "access/quota.h"

enum { ADMISSION_WINDOWS = 3, ADMISSION_RETRY_S = 10 };

struct admission_window { /* figures about one second of drawing */
    int64_t drawing_ns;   /* render time of frames that a client waits for; excludes refined frames, which yield to others */
    int64_t moving_ns;    /* the part of drawing_ns spent on frames of moving cameras */
    int64_t drawn;        /* number of frames in moving_ns; a frame shared by several sessions counts once */
    int64_t moving;       /* number of frames delivered to sessions with a moving camera */
    int64_t data_wait_ns; /* longest time from a changed reading to its frame; 0: no frame was due to a reading */
};

struct address_share {  /* use of the server by one client address; zero-initialise */
    uint64_t account;   /* value of frame_request.account in the address's sessions */
    bool exempt_pixels; /* the limit on the pixels of one address does not apply */
    int64_t pixels;     /* pixels of all views of the address */
    int moving;         /* sessions of the address whose camera moved within the last second */
    int sessions;
    struct admission_window newest, now;
    struct address_share *next;
};

struct admission {
    const struct quotas *quotas;
    struct admission_window windows[ADMISSION_WINDOWS], now; /* finished windows, newest last; `now`: the current one */
    int64_t begin_ns;                                        /* monotonic start of `now` */
    uint64_t last_content;        /* content number of the last frame: clients that share a frame report it one after the other */
    int64_t pixels;               /* pixels of all views of all addresses */
    struct address_share *shares; /* linked list of the addresses that have sessions */
};

/* Count one session more, or one less, of an address. The share must outlive its sessions. */
void admission_join(struct admission *admission, struct address_share *share);
void admission_leave(struct admission *admission, struct address_share *share);
/* Counts the cost of a frame. share: of the client's address; NULL: the frame belongs to no address. */
void admission_on_frame(struct admission *admission, struct address_share *share, const struct encoded_frame *encoded);
/* Closes the current measuring window when its second is over. */
void admission_on_tick(struct admission *admission, int64_t now_ns);
/* Returns the percentage of the render thread's time spent on awaited frames, in the least busy of the last windows. */
int admission_busy_percent(const struct admission *admission);
/* Returns NULL if a view may grow from `before` to `pixels` pixels; otherwise the reason (static text). share NULL: only the total limit
   applies. */
const char *admission_refuses_pixels(const struct admission *admission, const struct address_share *share, int64_t before, int64_t pixels);
/* Returns NULL if a session with a view of `pixels` pixels can be added; otherwise the reason (static text). */
const char *admission_refuses(const struct admission *admission, const struct address_share *share, int64_t pixels);

#endif
