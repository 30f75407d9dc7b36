/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queue of deferred groups of requests, oldest group first. All requests of a group are answered by the same frame. A group is
   deferred if that frame cannot be drawn yet, for example because its field is not computed. */
#include "service/deferred_requests.h"

#include <string.h>

bool deferred_requests_push(struct deferred_requests *deferred, struct request_group *group)
{
    if (deferred->count == DEFERRED_MOST)
        return false;
    struct request_group empty = deferred->groups[deferred->count];
    deferred->groups[deferred->count++] = *group;
    *group = empty;
    group->count = 0;
    return true;
}

void deferred_requests_pop(struct deferred_requests *deferred, struct request_group *group)
{
    struct request_group empty = *group;
    *group = deferred->groups[0];
    memmove(deferred->groups, deferred->groups + 1, --deferred->count * sizeof(*group));
    empty.count = 0;
    deferred->groups[deferred->count] = empty;
}

bool deferred_requests_due(struct deferred_requests *deferred, bool others)
{
    bool due = deferred->count > 0 && (deferred->due || !others);
    deferred->due = !due;
    return due;
}

void deferred_requests_finish(struct deferred_requests *deferred)
{
    for (size_t i = 0; i < DEFERRED_MOST; i++)
        request_group_finish(&deferred->groups[i]);
}
