/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/walls/burn_shift.h"

#include <stddef.h>

static const int64_t HELD_NS = 180000000000;

struct burn_shift burn_shift_at(int64_t utc_ns)
{
    static const struct burn_shift shifts[] = { { 0, 0 }, { 2, 1 }, { 3, -1 }, { 1, -3 }, { -1, -2 }, { -3, 0 }, { -2, 2 }, { 0, 3 } };
    return shifts[(size_t)(utc_ns / HELD_NS) % (sizeof(shifts) / sizeof(shifts[0]))];
}
