/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether one more session can be served: by limits, and by what drawing costs on this machine, measured as pictures come back. What there
   is goes to addresses in equal shares, and then to their sessions: one address alone keeps no other out. Pure: time is handed in.
   Thread: the loop. */
#ifndef SESSION_ADMISSION_H
#define SESSION_ADMISSION_H
#include "service/encoded_frame.h"
#include "access/quota.h"

enum { ADMISSION_WINDOWS = 3, ADMISSION_RETRY_S = 10 };

struct admission_window { /* a second of drawing */
    int64_t drawing_ns;   /* of pictures that somebody waits for: not refinements, which give way */
    int64_t moving_ns;    /* likewise, of those for cameras that moved */
    int64_t drawn;        /* how many such; who shares one adds none */
    int64_t moving;       /* pictures that went to sessions whose cameras moved */
    int64_t data_wait_ns; /* longest, of a reading that changed; 0: there was no such picture */
};

struct address_share {  /* of one address; zero-initialise */
    uint64_t payer;     /* for the painter: wish.payer */
    bool exempt_pixels; /* from the limit on the pixels of one address */
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
    uint64_t last_content;                                   /* those who share a picture come one after the other */
    int64_t pixels;                                          /* of all views */
    struct address_share *shares;                            /* of addresses that have sessions */
};

/* A session of that address more, or less. The share must outlive its sessions. */
void admission_join(struct admission *admission, struct address_share *share);
void admission_leave(struct admission *admission, struct address_share *share);
void admission_on_frame(struct admission *admission, struct address_share *share,
                        const struct encoded_frame *picture); /* share NULL: of nobody */
void admission_on_tick(struct admission *admission, int64_t now_ns);
int admission_busy_percent(const struct admission *admission); /* of the render thread's time, the quietest of the last windows */
/* NULL: a view may have so many pixels, in place of `before`. Else (static) why not. share NULL: of no address. */
const char *admission_refuses_pixels(const struct admission *admission, const struct address_share *share, int64_t before, int64_t pixels);
/* NULL: a session with a view of so many pixels can be added. Else (static) why not. */
const char *admission_refuses(const struct admission *admission, const struct address_share *share, int64_t pixels);

#endif
