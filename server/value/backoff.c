/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exponential backoff with jitter (a random part), for retries. */
#include "value/backoff.h"

static const int64_t FIRST_NS = 500000000, LONGEST_NS = 10000000000;

int64_t backoff_next_ns(struct backoff *backoff, uint64_t random)
{
    int64_t pause_ns = FIRST_NS << (backoff->failures < 5 ? backoff->failures : 5);
    backoff->failures += backoff->failures < 5;
    /* mixes the bits by multiplying with the golden ratio (in 64 bits), so that similar seeds give different random numbers */
    random = (random ^ random >> 31) * 0x9E3779B97F4A7C15u;
    pause_ns += pause_ns / 1000 * (int64_t)((random >> 32) % 500); /* the jitter: makes the delay up to 50 % longer */
    return pause_ns < LONGEST_NS ? pause_ns : LONGEST_NS - (int64_t)((random >> 32) % 1000) * 1000000;
}

int64_t host_turn_next_ns(struct host_turn *turn, int count, int64_t now_ns)
{
    turn->index = (turn->index + 1) % count;
    turn->tried++;
    return turn->tried % count ? now_ns : now_ns + backoff_next_ns(&turn->backoff, (uint64_t)now_ns);
}

void host_turn_succeeded(struct host_turn *turn)
{
    turn->tried = 0;
    turn->backoff = (struct backoff){ 0 };
}
