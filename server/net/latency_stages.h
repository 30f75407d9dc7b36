/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the time goes from an input, or a reading, to the picture that shows it: each stage's durations, for /metrics. Thread: the loop. */
#ifndef NET_LATENCY_STAGES_H
#define NET_LATENCY_STAGES_H
#include "base/counters.h"
#include "service/encoded_frame.h"
#include "session/pacer.h"

enum { STAGE_WAIT, STAGE_FIELD, STAGE_RENDER, STAGE_ENCODE, STAGE_QUEUE, STAGE_WRITE, STAGE_NETWORK, STAGE_DECODE, STAGE_COUNT };
struct latency_stages {
    struct histogram *of[STAGE_COUNT];
    struct histogram *input, *sensor; /* all together, to the acknowledgement: with the way back */
};

void latency_stages_init(struct latency_stages *stages, struct counters *counters);
void latency_stages_sent(struct latency_stages *stages, const struct encoded_frame *picture, int64_t now_ns); /* its first byte goes */
void latency_stages_shown(struct latency_stages *stages, const struct pacer *pacer); /* pacer->acked was acknowledged */

#endif
