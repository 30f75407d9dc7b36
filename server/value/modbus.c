/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source: reads each block of its read plan when the block is due, and retries units (slave addresses) that do not answer. */
#include "value/modbus_impl.h"

#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/lookup.h"

static bool stopping(const struct modbus_source *modbus)
{
    return wait_for(-1, 0, modbus->base.stop_fd, 0) == -ECANCELED;
}

static void read_block(struct modbus_source *modbus, size_t index)
{
    struct read_plan_block *block = &modbus->plan.blocks[index];
    uint16_t words[READ_PLAN_MAX_BITS];
    struct modbus_unit *unit = modbus_unit_of(modbus, block);
    modbus_manners_before(modbus, unit);
    if (!modbus_link_is_open(modbus->link) && !modbus_connect_link(modbus))
        return;
    if (modbus->base.config->pause_ms > 0 &&
        wait_for(-1, 0, modbus->base.stop_fd, modbus->asked_ns + modbus->base.config->pause_ms * NS_PER_MS) == -ECANCELED)
        return;
    int status = modbus_link_read(modbus->link, block->unit, block->table, block->first, block->count, words);
    if (status < 0 && stopping(modbus))
        return;
    const struct read_plan_block asked = *block;
    int64_t now_ns = clock_mono_ns(), next_ns = block->due_ns + block->scan_ms * NS_PER_MS;
    modbus->asked_ns = now_ns;
    if (status < 0 && modbus_manners_excuse_read(modbus, status, unit->state == UNIT_UP))
        /* does not move the block's due time on, so that this block (tags read by one request) is the first to be read on the
           next connection */
        return;
    /* a late block (tags read by one request) skips the reads that it missed instead of catching up in a burst */
    block->due_ns = next_ns > now_ns ? next_ns : now_ns + block->scan_ms * NS_PER_MS;
    counter_inc(status == 0 ? modbus->reads_ok : modbus->reads_failed, 1);
    if (status < 0) {
        modbus->manners.timed_out = status == -ETIMEDOUT ? unit : NULL;
        modbus_manners_late(modbus);
        if (!modbus_unit_doubt(modbus, unit, index))
            modbus_unit_is_down(modbus, unit, modbus_error_text(status));
        return;
    }
    modbus->answered_ns = now_ns;
    if (!modbus_is_gateway_exception(status))
        modbus->fallen = 0;
    modbus_manners_answered(modbus, block);
    if (status == 0)
        modbus_take_values(modbus, block, words);
    else
        modbus_take_exception(modbus, index, status, now_ns);
    modbus_unit_settle(modbus, unit, &asked);
    modbus_manners_after(modbus);
}

/* Returns the time from which a block (tags read by one request) may be read: the block's due time or, if later, the retry time
   of its unit (while the unit is down) or the time of the next connection attempt (while the link is closed). */
static int64_t ready_ns(const struct modbus_source *modbus, const struct read_plan_block *block)
{
    const struct modbus_unit *unit = modbus_unit_of(modbus, block);
    int64_t at_ns = block->due_ns;
    if (unit->state == UNIT_DOWN && unit->retry_ns > at_ns)
        at_ns = unit->retry_ns;
    if (!modbus_link_is_open(modbus->link) && modbus->connect_ns > at_ns)
        at_ns = modbus->connect_ns;
    return at_ns;
}

/* Returns the index of the block (tags read by one request) that may be read now and has waited longest. So a block that always
   fails cannot keep others from being read. Returns block_count if no block may be read yet; *wake_ns is then the time when one
   may. */
static size_t choose_block(const struct modbus_source *modbus, int64_t now_ns, int64_t *wake_ns)
{
    size_t chosen = modbus->plan.block_count;
    *wake_ns = INT64_MAX;
    for (size_t i = 0; i < modbus->plan.block_count; i++) {
        int64_t at_ns = ready_ns(modbus, &modbus->plan.blocks[i]);
        if (at_ns < *wake_ns)
            *wake_ns = at_ns;
        if (at_ns <= now_ns && (chosen == modbus->plan.block_count || modbus->plan.blocks[i].due_ns < modbus->plan.blocks[chosen].due_ns))
            chosen = i;
    }
    return chosen;
}

static void modbus_run(struct source *source)
{
    struct modbus_source *modbus = (struct modbus_source *)source;
    while (!stopping(modbus)) {
        int64_t wake_ns;
        size_t chosen = choose_block(modbus, clock_mono_ns(), &wake_ns);
        if (chosen < modbus->plan.block_count)
            read_block(modbus, chosen);
        else
            wait_for(-1, 0, modbus->base.stop_fd, wake_ns);
    }
}

static void modbus_interrupt(struct source *source)
{
    modbus_link_interrupt(((struct modbus_source *)source)->link);
}

static void modbus_destroy(struct source *source)
{
    struct modbus_source *modbus = (struct modbus_source *)source;
    modbus_link_destroy(&modbus->link);
    read_plan_finish(&modbus->plan);
    mem_free(modbus->units);
    mem_free(modbus->refused);
    mem_free(modbus->samples);
    mem_free(modbus->lost);
    mem_free(modbus);
}

static void add_counters(struct modbus_source *modbus, struct counters *counters)
{
    const struct source *base = &modbus->base;
    const char *reads = "Requests for readings sent to the source's field devices, by result.",
               *up = "1 while the source (connection to field devices, or replay) delivers readings.";
    modbus->reads_ok = source_counter(base, counters, "reads_total", ",result=\"ok\"", "counter", reads);
    modbus->reads_failed = source_counter(base, counters, "reads_total", ",result=\"failed\"", "counter", reads);
    modbus->connects = source_counter(base, counters, "connects_total", "", "counter",
                                      "Connections made to the source's field devices, server or broker.");
    modbus->up = source_counter(base, counters, "up", "", "gauge", up);
    modbus->host = source_counter(base, counters, "host", "", "gauge",
                                  "Number of the source's host that delivers readings: 1 is the first in `hosts`; 0: none.");
}

static void add_plan(struct modbus_source *modbus)
{
    read_plan_init(&modbus->plan, modbus->base.plant, modbus->base.index);
    modbus->units = mem_array(modbus->plan.unit_count, sizeof(*modbus->units));
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        modbus->units[i].id = modbus->plan.units[i];
    modbus->refused = mem_array(modbus->base.plant->tag_count, sizeof(*modbus->refused));
    modbus->samples = mem_array(modbus->plan.tag_count, sizeof(*modbus->samples));
    modbus->lost = mem_array(modbus->plan.tag_count, sizeof(*modbus->lost));
    log_info(modbus->base.log, "source %s: %s: %zu tags in %zu requests", modbus->base.config->id, modbus_link_name(modbus->link),
             modbus->plan.tag_count, modbus->plan.block_count);
    modbus_manners_init(modbus);
}

static struct source *modbus_create(const struct source *base, struct counters *counters)
{
    struct modbus_source *modbus = mem_new(sizeof(*modbus));
    modbus->base = *base;
    modbus->link = modbus_link_create(base->log, base->config, base->stop_fd);
    if (!modbus->link) {
        modbus_destroy(&modbus->base);
        return NULL;
    }
    add_counters(modbus, counters);
    add_plan(modbus);
    return &modbus->base;
}

const struct source_impl modbus_impl = {
    .kind = "modbus",
    .create = modbus_create,
    .run = modbus_run,
    .interrupt = modbus_interrupt,
    .destroy = modbus_destroy,
};
