/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Admission: decides whether one more session can be served, by limits and by what drawing costs on this machine, as measured from the
   frames that come back. Capacity is shared equally among addresses, then among their sessions, so that no address keeps others out.
   Pure: time is handed in. Thread: the loop. */
#ifndef SESSION_PACING_ADMISSION_H
#define SESSION_PACING_ADMISSION_H
#include "service/encoded_frame.h"
#include "access/quota.h"

enum { ADMISSION_WINDOWS = 3, ADMISSION_RETRY_S = 10 };

struct admission_window { /* a second of drawing */
    int64_t drawing_ns;   /* of frames that somebody waits for: not refined ones, which give way */
    int64_t moving_ns;    /* likewise, of those for cameras that moved */
    int64_t drawn;        /* how many such; sharing a frame adds none */
    int64_t moving;       /* frames that went to sessions whose cameras moved */
    int64_t data_wait_ns; /* the longest wait of a changed reading; 0: there was no frame for one */
};

struct address_share {  /* of one address; zero-initialise */
    uint64_t account;   /* frame_request.account of its sessions */
    bool exempt_pixels; /* the limit on the pixels of one address does not hold */
    int64_t pixels;     /* of its views */
    int moving;         /* its sessions that moved within the last second */
    int sessions;
    struct admission_window newest, now;
    struct address_share *next;
};

struct admission {
    const struct quotas *quotas;
    struct admission_window windows[ADMISSION_WINDOWS], now; /* newest last */
    int64_t begin_ns;                                        /* of `now` */
    uint64_t last_content;                                   /* of the last frame: clients that share one come one after the other */
    int64_t pixels;                                          /* of all views */
    struct address_share *shares;                            /* of addresses that have sessions */
};

/* Count one session more, or less, of that address. The share must outlive its sessions. */
void admission_join(struct admission *admission, struct address_share *share);
void admission_leave(struct admission *admission, struct address_share *share);
/* Counts what a frame cost. share: of the client's address; NULL: of none. */
void admission_on_frame(struct admission *admission, struct address_share *share, const struct encoded_frame *encoded);
/* Closes a window of measurement when its second is over. */
void admission_on_tick(struct admission *admission, int64_t now_ns);
/* Returns how much of the render thread's time moving frames took, in the quietest of the last windows. */
int admission_busy_percent(const struct admission *admission);
/* Returns NULL if a view may have so many pixels, in place of `before`; else the reason (static) why not. share NULL: of no address. */
const char *admission_refuses_pixels(const struct admission *admission, const struct address_share *share, int64_t before, int64_t pixels);
/* Returns NULL if a session with a view of so many pixels can be added; else the reason (static) why not. */
const char *admission_refuses(const struct admission *admission, const struct address_share *share, int64_t pixels);

#endif
