/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asks the kernel about the state of the machine's clock, such as whether it is synchronised. */
#include "base/system/clock_state.h"

#include "base/clock.h"

struct clock_state clock_state_of(const struct timex *timex, int state)
{
    bool set = state >= 0 && state != TIME_ERROR && !(timex->status & STA_UNSYNC);
    return (struct clock_state){
        .set = set,
        .error_s = set ? (double)timex->maxerror / 1e6 : 0,
        .leap_s = !set ? 0 : timex->status & STA_INS ? 1 : timex->status & STA_DEL ? -1 : 0,
    };
}

struct clock_state clock_state_read(void)
{
    struct timex asked = { .modes = 0 };
    int state = adjtimex(&asked);
    return clock_state_of(&asked, state);
}

int clock_state_error_ms(const struct clock_state *state)
{
    int step = state->error_s > 0 ? 1 : 0;
    while (step && step < 1000000 && step < state->error_s * 1000)
        step *= 10;
    return step;
}

bool clock_utc_is_set(void)
{
    return clock_state_read().set;
}
