/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source: who answers, and who is left alone for how long. */
#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "value/modbus_impl.h"

struct unit *modbus_unit_of(const struct modbus_source *modbus, const struct read_plan_block *block)
{
    size_t i = 0;
    while (modbus->units[i].id != block->unit)
        i++;
    return &modbus->units[i];
}

static void link_lost(struct modbus_source *modbus, const char *why)
{
    int64_t now_ns = clock_mono_ns();
    log_at(modbus->base.log, modbus->link_up || !modbus->link_known ? LOG_WARN : LOG_DEBUG, "source %s: %s: no readings (%s)",
           modbus->base.config->id, modbus_link_name(modbus->link), why);
    modbus->link_up = false;
    modbus->link_known = true;
    counter_set(modbus->up, 0);
    counter_set(modbus->host, 0);
    store_link_lost(modbus->base.store, modbus->base.index, now_ns);
}

void modbus_unit_is_up(struct modbus_source *modbus, struct unit *unit)
{
    if (unit->state == UNIT_DOWN && modbus->plan_cut)
        modbus_replan(modbus); /* it may have come back another */
    if (unit->state == UNIT_DOWN && modbus->link_up)
        log_info(modbus->base.log, "source %s: unit %d answers again", modbus->base.config->id, unit->id);
    unit->state = UNIT_UP;
    unit->backoff = modbus->backoff = (struct backoff){ 0 };
    if (modbus->link_up)
        return;
    modbus->link_up = modbus->link_known = true;
    counter_set(modbus->up, 1);
    counter_set(modbus->host, 1 + modbus_link_host(modbus->link));
    store_link_up(modbus->base.store, modbus->base.index, clock_mono_ns());
    log_info(modbus->base.log, "source %s: %s: reading", modbus->base.config->id, modbus_link_name(modbus->link));
}

static bool any_unit_up(const struct modbus_source *modbus)
{
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        if (modbus->units[i].state == UNIT_UP)
            return true;
    return false;
}

static void lose_tags_of(struct modbus_source *modbus, const struct unit *unit)
{
    size_t count = 0;
    for (size_t b = 0; b < modbus->plan.block_count; b++) {
        const struct read_plan_block *block = &modbus->plan.blocks[b];
        for (size_t t = 0; block->unit == unit->id && t < block->tag_count; t++)
            modbus->lost[count++] = modbus->plan.tags[block->first_tag + t];
    }
    store_tags_lost(modbus->base.store, modbus->lost, count, clock_mono_ns());
}

/* The next host at once, if there is one that was not tried since a unit answered; else after a pause. */
static void try_elsewhere(struct modbus_source *modbus)
{
    int64_t now_ns = clock_mono_ns();
    bool all_tried = modbus_link_next_host(modbus->link);
    modbus->connect_ns = all_tried ? now_ns + backoff_next_ns(&modbus->backoff, (uint64_t)now_ns) : now_ns;
    for (size_t i = 0; i < modbus->plan.unit_count && !all_tried; i++)
        modbus->units[i].retry_ns = now_ns;
}

void modbus_unit_is_down(struct modbus_source *modbus, struct unit *unit, const char *why)
{
    bool was_up = unit->state == UNIT_UP;
    unit->state = UNIT_DOWN;
    unit->retry_ns = clock_mono_ns() + backoff_next_ns(&unit->backoff, (uint64_t)clock_mono_ns());
    if (!any_unit_up(modbus)) {
        link_lost(modbus, why);
        if (modbus->base.config->host_count > 1)
            try_elsewhere(modbus);
        return;
    }
    log_at(modbus->base.log, was_up ? LOG_WARN : LOG_DEBUG, "source %s: unit %d does not answer (%s)", modbus->base.config->id,
           unit->id, why);
    lose_tags_of(modbus, unit);
}

bool modbus_connect_link(struct modbus_source *modbus)
{
    int status = modbus_link_open(modbus->link);
    if (status == 0) {
        counter_inc(modbus->connects, 1);
        return true;
    }
    if (status == -ECANCELED)
        return false;
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        modbus->units[i].state = UNIT_DOWN;
    link_lost(modbus, strerror(-status));
    try_elsewhere(modbus);
    return false;
}
