/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Request groups: lists of frame requests answered with one frame. */
#include "service/request_group.h"

#include "base/mem.h"

void request_group_add(struct request_group *group, const struct request_ticket *ticket)
{
    mem_grow(&group->tickets, &group->capacity, group->count + 1, sizeof(*group->tickets));
    group->tickets[group->count++] = *ticket;
}

void request_group_split(struct request_group *group, bool (*belongs)(const struct request_ticket *ticket, void *arg), void *arg,
                         struct request_group *into)
{
    size_t kept = 0;
    into->count = 0;
    for (size_t i = 0; i < group->count; i++) {
        if (belongs(&group->tickets[i], arg))
            request_group_add(into, &group->tickets[i]);
        else
            group->tickets[kept++] = group->tickets[i];
    }
    group->count = kept;
}

bool request_group_wants_record(const struct request_group *group)
{
    for (size_t i = 0; i < group->count; i++)
        if (group->tickets[i].request.record)
            return true;
    return false;
}

bool request_group_wants_depth(const struct request_group *group)
{
    for (size_t i = 0; i < group->count; i++)
        if (group->tickets[i].request.depth)
            return true;
    return false;
}

void request_group_finish(struct request_group *group)
{
    mem_free(group->tickets);
    *group = (struct request_group){ 0 };
}
