/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which codec a client gets that decodes both: H.264 takes half the bytes or less, JPEG half the work. So H.264, unless the network has
   plenty and the processors have nothing left. Pure; time is handed in. */
#ifndef SESSION_CODEC_CHOICE_H
#define SESSION_CODEC_CHOICE_H
#include <stdbool.h>
#include <stdint.h>

struct codec_facts {
    double bytes_per_s; /* that the network takes; 0: not known */
    double cpu_free;    /* of all processors of the machine, 0..1 */
    long pixels;        /* of a picture */
};

struct codec_choice { /* zero-initialise: H.264 */
    bool jpeg;
    int64_t against_ns; /* since when everything speaks for the other; 0: not now */
};

void codec_choice_update(struct codec_choice *choice, const struct codec_facts *facts, int64_t now_ns);

struct cpu_meter {       /* zero-initialise */
    uint64_t busy, idle; /* at the last reading */
};
/* Share of the machine's processor time that nobody used since the last call; 1 at the first, and where it is not known. stat: what
   /proc/stat says. */
double cpu_meter_free(struct cpu_meter *meter, const char *stat);

#endif
