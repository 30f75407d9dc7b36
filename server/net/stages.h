/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the time goes from an input, or a reading, to the picture that shows it: each stage's durations, for /metrics. Thread: the loop. */
#ifndef NET_STAGES_H
#define NET_STAGES_H
#include "base/counters.h"
#include "net/paint/picture.h"
#include "net/session/pacer.h"

enum { STAGE_WAIT, STAGE_FIELD, STAGE_RENDER, STAGE_ENCODE, STAGE_QUEUE, STAGE_WRITE, STAGE_NETWORK, STAGE_DECODE, STAGE_COUNT };
struct stages {
    struct histogram *of[STAGE_COUNT];
    struct histogram *input, *sensor; /* all together, to the acknowledgement: with the way back */
};

void stages_init(struct stages *stages, struct counters *counters);
void stages_sent(struct stages *stages, const struct picture *picture, int64_t now_ns); /* its first byte goes */
void stages_shown(struct stages *stages, const struct pacer *pacer);                     /* pacer->acked was acknowledged */

#endif
