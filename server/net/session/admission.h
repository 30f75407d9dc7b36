/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether one more session can be served: by limits, and by what drawing costs on this machine, measured as pictures come back. Pure: time
   is handed in. Thread: the loop. */
#ifndef NET_ADMISSION_H
#define NET_ADMISSION_H
#include "net/paint/picture.h"
#include "net/session/quota.h"

enum { ADMISSION_WINDOWS = 3, ADMISSION_RETRY_S = 10 };

struct admission_window { /* a second of drawing */
    int64_t drawing_ns;   /* of pictures that somebody waits for: not refinements, which give way */
    int64_t moving;       /* pictures that went to sessions whose cameras moved */
    int64_t data_wait_ns; /* longest, of a reading that changed */
};

struct admission {
    const struct quotas *quotas;
    struct admission_window windows[ADMISSION_WINDOWS], now; /* newest last */
    int64_t begin_ns;                                        /* of `now` */
    uint64_t last_content;                                   /* those who share a picture come one after the other */
    int64_t pixels;                                          /* of all views */
};

void admission_on_picture(struct admission *admission, const struct picture *picture);
void admission_on_tick(struct admission *admission, int64_t now_ns);
int admission_busy_percent(const struct admission *admission); /* of the render thread's time, the quietest of the last windows */
/* NULL: a view of so many pixels can be added. Else (static) why not; `moving`: sessions that move now. */
const char *admission_refuses(const struct admission *admission, int64_t pixels, int moving);

#endif
