/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Admission: decides whether the server can take one more session, from configured limits and the measured drawing cost of
   finished frames. Capacity is shared equally among client addresses, then among each address's sessions, so that one address
   cannot exhaust it. Pure: the caller passes the time. Call only in the event loop. */
#ifndef SESSION_PACING_ADMISSION_H
#define SESSION_PACING_ADMISSION_H
#include "service/encoded_frame.h"
#include "access/quota.h"

enum { ADMISSION_WINDOWS = 3, ADMISSION_RETRY_S = 10 };

struct admission_window { /* statistics of one second of drawing */
    /* render time of frames that clients wait for; excludes refined frames (detailed ones, for a camera at rest), which yield
       to others */
    int64_t drawing_ns;
    int64_t moving_ns;    /* part of drawing_ns spent on frames of sessions whose camera moves */
    int64_t drawn;        /* number of frames in moving_ns; a frame shared by several sessions counts once */
    int64_t moving;       /* number of frames delivered to sessions with a moving camera */
    /* longest time from a changed reading to the frame that shows it; 0: no frame of this second showed a changed reading */
    int64_t data_wait_ns;
};

struct address_share {  /* one client address's use of the server; zero-initialise */
    uint64_t account;   /* id of the address; the same as frame_request.account in the requests of its sessions */
    bool exempt_pixels; /* true: the quota on pixels per address does not apply to this address */
    int64_t pixels;     /* number of pixels that the views of all sessions of the address have together */
    int moving;         /* number of sessions of the address whose camera moved within the last second */
    int sessions;
    struct admission_window newest, now;
    struct address_share *next;
};

struct admission {
    const struct quotas *quotas;
    /* drawing statistics of the last ADMISSION_WINDOWS seconds, newest last; `now`: statistics of the current second */
    struct admission_window windows[ADMISSION_WINDOWS], now;
    int64_t begin_ns; /* monotonic time when the window `now` began */
    /* content id of the frame counted last. Several clients report a frame that they share, one after the other; with this id
       it is counted once */
    uint64_t last_content;
    int64_t pixels;               /* number of pixels that the views of all sessions of all addresses have together */
    struct address_share *shares; /* linked list of the client addresses that have sessions */
};

/* admission_join() adds a session to the client address `share`, admission_leave() removes it. The share must outlive its sessions. */
void admission_join(struct admission *admission, struct address_share *share);
void admission_leave(struct admission *admission, struct address_share *share);
/* Counts the cost of a preview that answers an input or changed readings; ignores other frames. share: the client's address;
   NULL: no address is charged. */
void admission_on_frame(struct admission *admission, struct address_share *share, const struct encoded_frame *encoded);
/* Starts a new measuring window if the current one is at least a second old. */
void admission_on_tick(struct admission *admission, int64_t now_ns);
/* Returns the percentage of the render thread's time spent on frames that clients wait for, in the least busy of the last
   ADMISSION_WINDOWS seconds. */
int admission_busy_percent(const struct admission *admission);
/* Returns REFUSAL_NONE if a view may grow from `before` to `pixels` pixels; otherwise the reason. share: the client's address;
   NULL: only the limit for all addresses together applies. */
enum refusal_code admission_refuses_pixels(const struct admission *admission, const struct address_share *share, int64_t before,
                                           int64_t pixels);
/* Returns REFUSAL_NONE if a session with a view of `pixels` pixels can be added; otherwise the reason. share: the client's address. */
enum refusal_code admission_refuses(const struct admission *admission, const struct address_share *share, int64_t pixels);

#endif
