/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the codec for a client that decodes both H.264 and JPEG: H.264 takes at most half the bytes, JPEG half the processor
   time. JPEG is chosen only if the network has spare capacity and the processors have none. Pure; the caller passes the time.
   Call only in the event loop. */
#ifndef SESSION_PACING_CODEC_CHOICE_H
#define SESSION_PACING_CODEC_CHOICE_H
#include <stdbool.h>
#include <stdint.h>

struct codec_facts {
    double bytes_per_s; /* the client's bandwidth in bytes per second; 0: not known */
    double cpu_free;    /* idle share of all processors of the machine, 0..1 */
    long pixels;        /* number of pixels of one frame of the client's view */
};

struct codec_choice { /* zero-initialise, which chooses H.264 */
    bool jpeg;
    /* monotonic time since which bandwidth and processor load (codec_facts) have favoured the codec that is not in use; 0: they
       favour the one in use */
    int64_t against_ns;
};

/* Switches to the other codec (H.264 or JPEG) once bandwidth and processor load have favoured it for long enough. */
void codec_choice_update(struct codec_choice *choice, const struct codec_facts *facts, int64_t now_ns);

struct cpu_meter {       /* reads the processors' load from /proc/stat; zero-initialise */
    uint64_t busy, idle; /* busy and idle time of all processors in /proc/stat at the previous call, in clock ticks */
};
/* Returns the idle share of the machine's processor time since the last call; 1 at the first call, and if it is unknown. stat: the text
   of /proc/stat. */
double cpu_meter_free(struct cpu_meter *meter, const char *stat);

#endif
