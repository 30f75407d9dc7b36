/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Latency stages: histograms for /metrics that show where time is spent between an input, or a changed reading, and the frame
   that shows it. Call only in the event loop. */
#ifndef NET_LATENCY_STAGES_H
#define NET_LATENCY_STAGES_H
#include "base/metrics/counters.h"
#include "service/encoded_frame.h"
#include "session/pacing/pacer.h"

enum { STAGE_WAIT, STAGE_FIELD, STAGE_RENDER, STAGE_ENCODE, STAGE_QUEUE, STAGE_WRITE, STAGE_NETWORK, STAGE_DECODE, STAGE_COUNT };
struct latency_stages {
    struct histogram *of[STAGE_COUNT];
    /* total latency until a frame is acknowledged, from the input or from the changed reading that the frame shows */
    struct histogram *input, *sensor;
};

/* Registers the histograms of all latency stages with the server's metrics. */
void latency_stages_init(struct latency_stages *stages, struct counters *counters);
/* Records how long a frame spent in the stages before sending. Call it when the frame's first byte is being sent. */
void latency_stages_sent(struct latency_stages *stages, const struct encoded_frame *encoded, int64_t now_ns);
/* Records how long the frame that the client acknowledged last (pacer->acked) spent in the stages after sending. */
void latency_stages_shown(struct latency_stages *stages, const struct pacer *pacer);

#endif
