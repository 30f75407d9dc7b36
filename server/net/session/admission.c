/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether one more session can be served. */
#include "net/session/admission.h"

#include <string.h>

#include "base/clock.h"

static const int64_t WINDOW_NS = NS_PER_S;
static const int64_t LONGEST_DATA_WAIT_NS = NS_PER_S; /* readings come once a second: later than that, some are never drawn */
enum { BUSY_PERCENT = 85 };

void admission_on_picture(struct admission *admission, const struct picture *picture)
{
    const struct frame *frame = picture->packet ? picture->packet->frame : NULL;
    enum urgency urgency = picture->wish.urgency;
    if (!frame || frame->view.tier == TIER_STILL || (urgency != URGENCY_INPUT && urgency != URGENCY_DATA))
        return;
    if (frame->content != admission->last_content)
        admission->now.drawing_ns += frame->render_ns + frame->readback_ns + frame->field_ns;
    admission->last_content = frame->content;
    if (urgency == URGENCY_INPUT)
        admission->now.moving++;
    else if (picture->wait_ns > admission->now.data_wait_ns)
        admission->now.data_wait_ns = picture->wait_ns;
}

void admission_on_tick(struct admission *admission, int64_t now_ns)
{
    if (now_ns - admission->begin_ns < WINDOW_NS)
        return;
    memmove(&admission->windows[0], &admission->windows[1], (ADMISSION_WINDOWS - 1) * sizeof(admission->windows[0]));
    admission->windows[ADMISSION_WINDOWS - 1] = admission->now;
    admission->now = (struct admission_window){ 0 };
    admission->begin_ns = now_ns;
}

int admission_busy_percent(const struct admission *admission)
{
    int64_t least_ns = INT64_MAX;
    for (int i = 0; i < ADMISSION_WINDOWS; i++)
        if (admission->windows[i].drawing_ns < least_ns)
            least_ns = admission->windows[i].drawing_ns;
    return (int)(least_ns * 100 / WINDOW_NS);
}

const char *admission_refuses(const struct admission *admission, int64_t pixels, int moving)
{
    const struct admission_window *newest = &admission->windows[ADMISSION_WINDOWS - 1];
    if (admission->pixels + pixels > admission->quotas->at[QUOTA_PIXELS])
        return "full: all views together have as many pixels as this server may draw; try later, or a smaller picture";
    if (admission_busy_percent(admission) < BUSY_PERCENT)
        return NULL;
    if (moving > 0 && newest->moving < admission->quotas->at[QUOTA_LEAST_FPS] * (moving + 1))
        return "full: with one more, those who move would get too few pictures; try later";
    if (newest->data_wait_ns > LONGEST_DATA_WAIT_NS)
        return "full: readings are drawn too late already; try later";
    return NULL;
}
