/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sending half of a probe's viewer (viewer_impl.h): sends hello, cameras and acknowledgements. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "viewer_impl.h"

static const double TURN_DEG_PER_S = 30;
static const int64_t PING_NS = 1 * NS_PER_S;

static int say(const struct viewer *viewer, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static int say(const struct viewer *viewer, const char *fmt, ...)
{
    unsigned char buffer[LWS_PRE + 512];
    va_list ap;
    va_start(ap, fmt);
    int count = vsnprintf((char *)buffer + LWS_PRE, sizeof(buffer) - LWS_PRE, fmt, ap);
    va_end(ap);
    if (viewer->raw)
        return raw_websocket_send(viewer->raw, (const char *)buffer + LWS_PRE, (size_t)count) ? 0 : -1;
    return lws_write(viewer->wsi, buffer + LWS_PRE, (size_t)count, LWS_WRITE_TEXT) < count ? -1 : 0;
}

static double seconds_of(int64_t ns)
{
    return (double)ns / 1e9;
}

/* --- cameras ------------------------------------------------------------------------------------------------------------------ */

static double uniform(struct viewer *viewer, double low, double high)
{
    return low + (high - low) * rand_r(&viewer->params.seed) / RAND_MAX;
}

/* Begins the next leg of random camera motion: drags of up to 2 s alternate with pauses of up to 2 s. */
static void next_leg(struct viewer *viewer, int64_t now_ns)
{
    viewer->angle_deg += viewer->speed_deg * seconds_of(viewer->leg_end_ns - viewer->leg_ns);
    viewer->speed_deg = viewer->speed_deg != 0 ? 0 : uniform(viewer, -90, 90);
    viewer->leg_ns = now_ns;
    viewer->leg_end_ns = now_ns + (int64_t)(uniform(viewer, 0.2, 2) * 1e9);
}

static double angle_of(const struct viewer *viewer, int64_t now_ns)
{
    switch (viewer->params.motion) {
    case MOTION_ORBIT: return viewer->params.start_deg + TURN_DEG_PER_S * seconds_of(now_ns - viewer->begin_ns);
    case MOTION_RANDOM: return viewer->params.start_deg + viewer->angle_deg + viewer->speed_deg * seconds_of(now_ns - viewer->leg_ns);
    default: return viewer->params.start_deg;
    }
}

static void publish(struct viewer *viewer, const double eye[3], int64_t now_ns)
{
    struct leader *lead = viewer->params.lead;
    if (!lead || viewer->params.follows)
        return;
    pthread_mutex_lock(&lead->lock);
    lead->newest++;
    memcpy(lead->cameras[lead->newest % LEAD_CAMERAS].eye, eye, sizeof(lead->cameras[0].eye));
    lead->cameras[lead->newest % LEAD_CAMERAS].sent_ns = now_ns;
    pthread_mutex_unlock(&lead->lock);
}

static int say_camera(struct viewer *viewer)
{
    int64_t now_ns = clock_mono_ns();
    double angle = angle_of(viewer, now_ns) * M_PI / 180;
    double dx = viewer->eye[0] - viewer->target[0], dy = viewer->eye[1] - viewer->target[1];
    double eye[3] = { viewer->target[0] + dx * cos(angle) - dy * sin(angle), viewer->target[1] + dx * sin(angle) + dy * cos(angle),
                      viewer->eye[2] };
    viewer->camera_due = false;
    viewer->sent_ns[++viewer->camera_seq % SENT_RING] = now_ns;
    publish(viewer, eye, now_ns);
    return say(viewer, "{\"type\":\"camera\",\"seq\":%u,\"eye\":[%.6f,%.6f,%.6f],\"target\":[%.6f,%.6f,%.6f],\"fov\":%.3f}",
               viewer->camera_seq, eye[0], eye[1], eye[2], viewer->target[0], viewer->target[1], viewer->target[2], viewer->fov_deg);
}

/* --- other messages ----------------------------------------------------------------------------------------------------------- */

static int say_hello(struct viewer *viewer)
{
    const struct viewer_params *params = &viewer->params;
    viewer->greeted = true;
    return say(viewer, "{\"type\":\"hello\",\"width\":%d,\"height\":%d,\"codecs\":[\"%s\"%s],\"signed\":\"%s\"}", params->width_px,
               params->height_px, params->codec, params->signs ? ",\"png\"" : "", params->signs ? params->signs : "none");
}

static int say_ack(struct viewer *viewer)
{
    uint32_t seq = viewer->acks[0].seq;
    double decode_ms = viewer->acks[0].decode_ms;
    viewer->ack_count--;
    memmove(viewer->acks, viewer->acks + 1, (size_t)viewer->ack_count * sizeof(viewer->acks[0]));
    return say(viewer, "{\"type\":\"ack\",\"seq\":%u,\"decode_ms\":%.3f}", seq, decode_ms);
}

static int say_ping(struct viewer *viewer)
{
    viewer->ping_due = false;
    viewer->ping_ns = clock_mono_ns();
    return say(viewer, "{\"type\":\"ping\",\"t\":%lld}", (long long)(viewer->ping_ns / 1000));
}

static int say_follow(struct viewer *viewer)
{
    struct leader *lead = viewer->params.lead;
    viewer->follow_due = false;
    viewer->followed = true;
    pthread_mutex_lock(&lead->lock);
    uint64_t session = lead->session;
    pthread_mutex_unlock(&lead->lock);
    return say(viewer, "{\"type\":\"follow\",\"session\":%llu}", (unsigned long long)session);
}

bool viewer_has_output(const struct viewer *viewer)
{
    return !viewer->greeted || viewer->ack_count > 0 || viewer->camera_due || viewer->follow_due || viewer->ping_due;
}

int viewer_send(struct viewer *viewer)
{
    int status = 0;
    if (!viewer->greeted)
        status = say_hello(viewer);
    else if (viewer->ack_count > 0)
        status = say_ack(viewer);
    else if (viewer->camera_due)
        status = say_camera(viewer);
    else if (viewer->follow_due)
        status = say_follow(viewer);
    else if (viewer->ping_due)
        status = say_ping(viewer);
    return status;
}

static bool has_leader(const struct viewer *viewer)
{
    struct leader *lead = viewer->params.lead;
    pthread_mutex_lock(&lead->lock);
    bool there = lead->session != 0;
    pthread_mutex_unlock(&lead->lock);
    return there;
}

static bool moves(struct viewer *viewer, int64_t now_ns)
{
    const struct viewer_params *params = &viewer->params;
    if (params->follows)
        return false;
    if (params->motion == MOTION_STILL)
        return params->start_deg != 0 && viewer->camera_seq == 0;
    if (params->motion == MOTION_RANDOM && now_ns >= viewer->leg_end_ns)
        next_leg(viewer, now_ns);
    return params->motion == MOTION_ORBIT || viewer->speed_deg != 0;
}

void viewer_schedule(struct viewer *viewer, int64_t now_ns)
{
    if (!viewer->welcomed || viewer->params.stalls)
        return;
    viewer->camera_due |= moves(viewer, now_ns);
    viewer->follow_due |= viewer->params.follows && !viewer->followed && has_leader(viewer);
    viewer->ping_due |= now_ns - viewer->ping_ns >= PING_NS;
}
