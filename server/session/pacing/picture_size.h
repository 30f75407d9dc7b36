/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the size of previews so that a picture costs no more time than a limit. The caller says what the cost is: the client's
   time to decode a picture, or the server's time to make one. A picture gets smaller after half a second above the limit, and
   larger only once the larger one is expected to stay below a lower limit for three seconds, or longer if the last larger one did
   not hold. Pure; the caller passes the time. */
#ifndef SESSION_PACING_PICTURE_SIZE_H
#define SESSION_PACING_PICTURE_SIZE_H
#include <stdint.h>

enum { PICTURE_SIZES = 4 };

struct picture_size { /* all zeros: full size, nothing measured */
    int index;        /* 0: full size; less than PICTURE_SIZES */
    /* monotonic time in nanoseconds since which the cost has been too high, or low enough for a larger picture; 0: it is not */
    int64_t hard_since_ns, easy_since_ns;
    int64_t up_ns, patience_ns; /* monotonic time of the last step to a larger picture; least time before the next one; 0: none yet */
};

struct picture_cost {
    int64_t cost_ns; /* time that a picture of the present size takes */
    /* hard_ns: limit above which the picture gets smaller; easy_ns: it gets larger if the larger one is expected to take less */
    int64_t hard_ns, easy_ns;
    double fixed; /* share of a full-size picture's cost that does not depend on the size, from 0 to 1 */
};

/* Returns the factor by which width and height of a picture are multiplied. */
double picture_size_scale(int index);
/* Returns the factor by which a picture of size `to` is expected to cost more than one of size `from`. fixed: see picture_cost. */
double picture_size_ratio(int from, int to, double fixed);
/* Adjusts the size to the cost of a picture. */
void picture_size_follow(struct picture_size *size, const struct picture_cost *cost, int64_t now_ns);
/* Forgets since when pictures have cost too much or little, because none is measured now. The size stays. */
void picture_size_pause(struct picture_size *size);

#endif
