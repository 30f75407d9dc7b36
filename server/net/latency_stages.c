/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures latency: how long frames spend in each stage (such as drawing, encoding and sending) between a user's input and the
   client. */
#include "net/latency_stages.h"

#include "base/mem.h"
#include "base/metrics/histogram.h"

static const char *const names[STAGE_COUNT] = { "wait", "field", "render", "encode", "queue", "write", "network", "decode" };

void latency_stages_init(struct latency_stages *latency, struct counters *counters)
{
    for (int i = 0; i < STAGE_COUNT; i++) {
        char *name = mem_printf("plantcast_stage_seconds{stage=\"%s\"}", names[i]);
        latency->of[i] = counters_add_histogram(counters, name, "Seconds that a frame spends in each stage of the pipeline.");
        mem_free(name);
    }
    latency->input = counters_add_histogram(counters, "plantcast_input_to_frame_seconds",
                                            "Seconds from a client's input until the client acknowledges the frame that shows it.");
    latency->sensor = counters_add_histogram(counters, "plantcast_sensor_to_frame_seconds",
                                             "Seconds from a changed reading until a client acknowledges the frame that shows it.");
}

void latency_stages_sent(struct latency_stages *latency, const struct encoded_frame *encoded, int64_t now_ns)
{
    const struct frame *frame = encoded->packet->frame;
    histogram_add(latency->of[STAGE_WAIT], encoded->wait_ns);
    histogram_add(latency->of[STAGE_FIELD], frame->field_ns);
    histogram_add(latency->of[STAGE_RENDER], frame->render_ns + frame->readback_ns);
    histogram_add(latency->of[STAGE_ENCODE], encoded->packet->encode_ns);
    histogram_add(latency->of[STAGE_QUEUE], now_ns - encoded->made_ns);
}

void latency_stages_shown(struct latency_stages *latency, const struct pacer *pacer)
{
    const struct pacer_flight *acked = &pacer->acked;
    const struct channel *channel = &pacer->channel;
    histogram_add(latency->of[STAGE_WRITE], acked->written_ns - acked->sent_ns);
    histogram_add(latency->of[STAGE_NETWORK], channel->arrived_ns - acked->written_ns);
    histogram_add(latency->of[STAGE_DECODE], channel->acked_ns - channel->arrived_ns);
    if (acked->note.moving || acked->note.of_data)
        histogram_add(acked->note.of_data ? latency->sensor : latency->input, channel->acked_ns - acked->note.input_ns);
}
