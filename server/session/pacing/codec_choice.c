/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses between the codecs H.264 (fewer bytes) and JPEG (less processor time) for one client. */
#include "session/pacing/codec_choice.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/clock.h"

/* expected bytes per pixel of a JPEG frame (196 kB at 1920x1080, quality 78), and frames per second, from which the bandwidth
   for JPEG is computed */
static const double JPEG_BYTES_PER_PX = 0.1, RATE_HZ = 30;
/* Limits on the measured bandwidth, as a multiple of the bandwidth that JPEG needs. Above PLENTY, the codec may change to JPEG;
   below SCARCE, it changes back to H.264. */
static const double PLENTY = 4, SCARCE = 2;
/* Limits on the idle part of the processors, 0..1. Below BUSY_IDLE_SHARE, the codec changes to JPEG, which takes less processor
   time; above FREE_IDLE_SHARE, it changes back to H.264. */
static const double BUSY_IDLE_SHARE = 0.15, FREE_IDLE_SHARE = 0.4;
/* time in nanoseconds for which bandwidth and processor load (codec_facts) must favour the other codec before the server
   switches to it; long, because a switch costs a key frame */
static const int64_t TO_JPEG_NS = 5 * NS_PER_S, TO_H264_NS = 30 * NS_PER_S;

static bool speaks_for_other(const struct codec_choice *choice, const struct codec_facts *facts)
{
    double need = (double)facts->pixels * JPEG_BYTES_PER_PX * RATE_HZ;
    if (choice->jpeg)
        return facts->bytes_per_s < SCARCE * need || facts->cpu_free > FREE_IDLE_SHARE;
    return facts->bytes_per_s > PLENTY * need && facts->cpu_free < BUSY_IDLE_SHARE;
}

void codec_choice_update(struct codec_choice *choice, const struct codec_facts *facts, int64_t now_ns)
{
    bool narrow = choice->jpeg && facts->bytes_per_s < (double)facts->pixels * JPEG_BYTES_PER_PX * RATE_HZ;
    if (!speaks_for_other(choice, facts)) {
        choice->against_ns = 0;
        return;
    }
    if (!choice->against_ns)
        choice->against_ns = now_ns;
    if (!narrow && now_ns - choice->against_ns < (choice->jpeg ? TO_H264_NS : TO_JPEG_NS))
        return;
    choice->jpeg = !choice->jpeg;
    choice->against_ns = 0;
}

double cpu_meter_free(struct cpu_meter *meter, const char *stat)
{
    uint64_t user, nice, system, idle, wait, irq, softirq, steal;
    if (sscanf(stat, "cpu %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64, &user, &nice,
               &system, &idle, &wait, &irq, &softirq, &steal) != 8)
        return 1;
    struct cpu_meter now = { .busy = user + nice + system + irq + softirq + steal, .idle = idle + wait };
    uint64_t busy = now.busy - meter->busy, rest = now.idle - meter->idle;
    bool first = meter->busy + meter->idle == 0, backwards = now.busy < meter->busy || now.idle < meter->idle;
    *meter = now;
    return first || backwards || busy + rest == 0 ? 1 : (double)rest / (double)(busy + rest);
}
