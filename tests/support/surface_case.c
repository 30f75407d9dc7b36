/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/surface_case.h"

#include <stddef.h>

struct log *the_log;
struct workers *workers;
struct cad_random chance;

double between(double low, double high)
{
    return low + (high - low) * cad_random(&chance);
}

int surface_case_set_up(void **state)
{
    (void)state;
    cad_random_start(&chance);
    the_log = log_create(LOG_ERROR);
    workers = workers_create(0);
    return 0;
}

int surface_case_tear_down(void **state)
{
    (void)state;
    workers_destroy(&workers);
    log_destroy(&the_log);
    return 0;
}
