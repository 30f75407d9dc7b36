/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides whether the server has enough capacity to accept one more session. */
#include "session/pacing/admission.h"

#include <string.h>

#include "base/clock.h"

static const int64_t WINDOW_NS = NS_PER_S;
/* longest permitted delay from a changed reading to its frame. Readings arrive once a second, so with a longer delay some would
   never be drawn */
static const int64_t LONGEST_DATA_WAIT_NS = NS_PER_S;
enum { BUSY_PERCENT = 85 };

void admission_join(struct admission *admission, struct address_share *share)
{
    if (share->sessions++ > 0)
        return;
    share->next = admission->shares;
    admission->shares = share;
}

void admission_leave(struct admission *admission, struct address_share *share)
{
    struct address_share **at = &admission->shares;
    if (--share->sessions > 0)
        return;
    while (*at != share)
        at = &(*at)->next;
    *at = share->next;
    share->newest = share->now = (struct admission_window){ 0 };
    share->moving = 0;
}

static void count(struct admission_window *window, const struct encoded_frame *encoded, bool drawn)
{
    const struct frame *frame = encoded->packet->frame;
    int64_t cost_ns = drawn ? frame->turn_ns : 0;
    bool moves = encoded->request.urgency == URGENCY_INPUT;
    window->drawing_ns += cost_ns;
    window->moving_ns += moves ? cost_ns : 0;
    window->drawn += moves && drawn;
    window->moving += moves;
    if (!moves && encoded->wait_ns > window->data_wait_ns)
        window->data_wait_ns = encoded->wait_ns;
}

void admission_on_frame(struct admission *admission, struct address_share *share, const struct encoded_frame *encoded)
{
    const struct frame *frame = encoded->packet ? encoded->packet->frame : NULL;
    enum urgency urgency = encoded->request.urgency;
    if (!frame || frame->view.tier == TIER_REFINED || (urgency != URGENCY_INPUT && urgency != URGENCY_DATA))
        return;
    bool drawn = frame->content != admission->last_content;
    admission->last_content = frame->content;
    count(&admission->now, encoded, drawn);
    if (share)
        count(&share->now, encoded, drawn);
}

void admission_on_tick(struct admission *admission, int64_t now_ns)
{
    if (now_ns - admission->begin_ns < WINDOW_NS)
        return;
    memmove(&admission->windows[0], &admission->windows[1], (ADMISSION_WINDOWS - 1) * sizeof(admission->windows[0]));
    admission->windows[ADMISSION_WINDOWS - 1] = admission->now;
    admission->now = (struct admission_window){ 0 };
    admission->begin_ns = now_ns;
    for (struct address_share *share = admission->shares; share; share = share->next) {
        share->newest = share->now;
        share->now = (struct admission_window){ 0 };
    }
}

int admission_busy_percent(const struct admission *admission)
{
    int64_t least_ns = INT64_MAX;
    for (int i = 0; i < ADMISSION_WINDOWS; i++)
        if (admission->windows[i].drawing_ns < least_ns)
            least_ns = admission->windows[i].drawing_ns;
    return (int)(least_ns * 100 / WINDOW_NS);
}

enum refusal_code admission_refuses_pixels(const struct admission *admission, const struct address_share *share, int64_t before,
                                           int64_t pixels)
{
    const int64_t *most = admission->quotas->at;
    if (admission->pixels - before + pixels > most[QUOTA_PIXELS])
        return REFUSAL_PIXELS;
    if (share && !share->exempt_pixels && share->pixels - before + pixels > most[QUOTA_ADDRESS_PIXELS])
        return REFUSAL_PIXELS_ADDRESS;
    return REFUSAL_NONE;
}

/* --- whether the render thread can serve one more moving camera ------------------------------------------------------------ */

/* Function that returns one figure of a client address's drawing statistics; 0: the figure is not known. */
typedef int64_t of_share(const struct address_share *share);

static int64_t cost_of(const struct address_share *share)
{
    return share->newest.drawn > 0 ? share->newest.moving_ns / share->newest.drawn : 0;
}

static int64_t data_wait_of(const struct address_share *share)
{
    return share->newest.data_wait_ns;
}

static int count_below(const struct admission *admission, of_share *of, int64_t value)
{
    int below = 0;
    for (const struct address_share *share = admission->shares; share; share = share->next)
        below += of(share) > 0 && of(share) < value;
    return below;
}

/* Returns the lower median of the figure `of` over all client addresses, so that no single address can shift the result. 0: the figure is
   known for no address. */
static int64_t usual(const struct admission *admission, of_share *of)
{
    int64_t found = 0;
    int known = count_below(admission, of, INT64_MAX);
    for (const struct address_share *share = admission->shares; share; share = share->next)
        if (of(share) > found && count_below(admission, of, of(share)) <= (known - 1) / 2)
            found = of(share);
    return found;
}

struct moving_sessions { /* how many sessions are moving their camera at present */
    /* own: moving sessions of the address in question; all: of all addresses; others: number of other addresses with moving sessions */
    int own, all, others;
};

static struct moving_sessions count_crowd(const struct admission *admission, const struct address_share *own)
{
    struct moving_sessions crowd = { .own = own ? own->moving : 0 };
    for (const struct address_share *share = admission->shares; share; share = share->next) {
        crowd.all += share->moving;
        crowd.others += share != own && share->moving > 0;
    }
    return crowd;
}

/* Returns whether frame rates would fall below QUOTA_LEAST_FPS if one more session of the client address `own` moved its camera. Render
   time is shared equally among addresses. */
static bool slows_too_far(const struct admission *admission, const struct address_share *own)
{
    const struct admission_window *newest = &admission->windows[ADMISSION_WINDOWS - 1];
    const struct moving_sessions crowd = count_crowd(admission, own);
    int64_t least_fps = admission->quotas->at[QUOTA_LEAST_FPS], cost_ns = usual(admission, cost_of);
    if (crowd.all == 0 || newest->moving >= least_fps * (crowd.all + 1))
        return false;
    if (crowd.others == 0 || cost_ns == 0)
        return true;
    if (crowd.own == 0 && crowd.others == 1)
        return false;
    return newest->moving_ns / cost_ns < least_fps * (crowd.others + 1) * (crowd.own + 1);
}

static bool reads_too_late(const struct admission *admission, const struct address_share *own)
{
    const struct admission_window *newest = &admission->windows[ADMISSION_WINDOWS - 1];
    int others = 0;
    if (newest->data_wait_ns <= LONGEST_DATA_WAIT_NS)
        return false;
    for (const struct address_share *share = admission->shares; share; share = share->next)
        others += share != own && share->newest.data_wait_ns > 0;
    if (others == 0)
        return true;
    bool has_any = own && own->newest.data_wait_ns > 0;
    return (has_any || others > 1) && usual(admission, data_wait_of) > LONGEST_DATA_WAIT_NS;
}

enum refusal_code admission_refuses(const struct admission *admission, const struct address_share *share, int64_t pixels)
{
    enum refusal_code why = admission_refuses_pixels(admission, share, 0, pixels);
    if (why || admission_busy_percent(admission) < BUSY_PERCENT)
        return why;
    if (slows_too_far(admission, share))
        return REFUSAL_MOVERS;
    if (reads_too_late(admission, share))
        return REFUSAL_LATE;
    return REFUSAL_NONE;
}
