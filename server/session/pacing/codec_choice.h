/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choice of codec for a client that decodes both: H.264 takes half the bytes or less, JPEG half the work. So H.264, unless the network
   has capacity to spare and the processors have none. Pure; time is handed in. Thread: the loop. */
#ifndef SESSION_PACING_CODEC_CHOICE_H
#define SESSION_PACING_CODEC_CHOICE_H
#include <stdbool.h>
#include <stdint.h>

struct codec_facts {
    double bytes_per_s; /* bandwidth; 0: not known */
    double cpu_free;    /* of all processors of the machine, 0..1 */
    long pixels;        /* of a frame */
};

struct codec_choice { /* zero-initialise: H.264 */
    bool jpeg;
    int64_t against_ns; /* since when all facts have spoken for the other codec; 0: they do not */
};

/* Changes the choice once the facts have spoken for the other codec long enough. */
void codec_choice_update(struct codec_choice *choice, const struct codec_facts *facts, int64_t now_ns);

struct cpu_meter {       /* zero-initialise */
    uint64_t busy, idle; /* at the last reading */
};
/* Returns the share of the machine's processor time that was idle since the last call; 1 at the first call, and where it is not known.
   stat: the text of /proc/stat. */
double cpu_meter_free(struct cpu_meter *meter, const char *stat);

#endif
