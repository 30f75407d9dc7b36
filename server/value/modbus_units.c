/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source: records which units (slave addresses) answer, and when a silent unit or a refused block is requested again. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "value/lookup.h"
#include "value/modbus_impl.h"

/* Delay before a register that the device refused is read again. The delay doubles after each refusal up to MAX_REFUSED_DELAY_NS,
   because a device may refuse only while it starts up. */
static const int64_t REFUSED_DELAY_NS = 2 * NS_PER_S, MAX_REFUSED_DELAY_NS = 60 * NS_PER_S;
/* delay between two requests to a unit while blocks (tags read by one request) are split to find the addresses that get no answer */
static const int64_t SPLIT_PAUSE_NS = 500 * NS_PER_MS;

struct modbus_unit *modbus_unit_of(const struct modbus_source *modbus, const struct read_plan_block *block)
{
    size_t i = 0;
    while (modbus->units[i].id != block->unit)
        i++;
    return &modbus->units[i];
}

const char *modbus_error_text(int status)
{
    return status == -EPROTO ? "the answer is not Modbus, or belongs to another request: check host, port, unit and transport"
                             : strerror(-status);
}

static void link_lost(struct modbus_source *modbus, const char *why)
{
    int64_t now_ns = clock_mono_ns();
    char more[LOG_PACE_BYTES];
    if (log_pace_take(&modbus->pace, now_ns, more)) {
        log_warn(modbus->base.log, "source %s: %s: no readings (%s)%s", modbus->base.config->id, modbus_link_name(modbus->link), why, more);
        modbus->loss_said = true;
    }
    modbus->link_up = false;
    counter_set(modbus->up, 0);
    counter_set(modbus->host, 0);
    store_link_lost(modbus->base.store, modbus->base.index, now_ns);
}

bool modbus_note_refused(struct modbus_source *modbus, const struct read_plan_block *block, bool refused, const char *why)
{
    size_t changed = 0;
    const char *first = "";
    for (size_t i = 0; i < block->tag_count; i++) {
        int tag = modbus->plan.tags[block->first_tag + i];
        if (modbus->refused[tag] != refused && changed++ == 0)
            first = modbus->base.plant->tags[tag].name;
        modbus->refused[tag] = refused;
    }
    if (changed)
        log_at(modbus->base.log, refused ? LOG_WARN : LOG_INFO, "source %s: unit %d: %s%s (%d from address %d): %s",
               modbus->base.config->id, block->unit, first, changed > 1 ? " and others" : "", block->count, block->first, why);
    return changed > 0;
}

int64_t modbus_refused_pause_ns(int before)
{
    return before < 5 ? REFUSED_DELAY_NS << before : MAX_REFUSED_DELAY_NS;
}

void modbus_replan(struct modbus_source *modbus)
{
    read_plan_finish(&modbus->plan);
    read_plan_init(&modbus->plan, modbus->base.plant, modbus->base.index);
    modbus->plan_cut = false;
}

void modbus_unit_is_up(struct modbus_source *modbus, struct modbus_unit *unit)
{
    if (unit->state == UNIT_DOWN && modbus->plan_cut)
        modbus_replan(modbus); /* the unit answers again, maybe because another device replaced it: requests the refused addresses again */
    if (unit->loss_said)
        log_info(modbus->base.log, "source %s: unit %d answers again", modbus->base.config->id, unit->id);
    unit->loss_said = false;
    unit->state = UNIT_UP;
    unit->backoff = modbus->backoff = (struct backoff){ 0 };
    if (modbus->link_up)
        return;
    modbus->link_up = true;
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        /* a unit answers, so the gateway may be back: lets the other units be requested again immediately */
        modbus->units[i].retry_ns = clock_mono_ns();
    counter_set(modbus->up, 1);
    counter_set(modbus->host, 1 + modbus_link_host(modbus->link));
    store_link_up(modbus->base.store, modbus->base.index, clock_mono_ns());
    if (modbus->loss_said || !modbus->pace.next_ns)
        log_info(modbus->base.log, "source %s: %s: reading", modbus->base.config->id, modbus_link_name(modbus->link));
    modbus->loss_said = false;
}

static bool any_unit_up(const struct modbus_source *modbus)
{
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        if (modbus->units[i].state == UNIT_UP)
            return true;
    return false;
}

static void lose_tags_of(struct modbus_source *modbus, const struct modbus_unit *unit)
{
    size_t count = 0;
    for (size_t b = 0; b < modbus->plan.block_count; b++) {
        const struct read_plan_block *block = &modbus->plan.blocks[b];
        for (size_t t = 0; block->unit == unit->id && t < block->tag_count; t++)
            modbus->lost[count++] = modbus->plan.tags[block->first_tag + t];
    }
    store_tags_lost(modbus->base.store, modbus->lost, count, clock_mono_ns());
}

/* Switches to the source's next host and connects to it without a delay. Once all hosts were tried, backs off before trying the
   first again. */
static void try_elsewhere(struct modbus_source *modbus)
{
    int64_t now_ns = clock_mono_ns();
    bool all_tried = modbus_link_next_host(modbus->link);
    modbus->connect_ns = all_tried ? now_ns + backoff_next_ns(&modbus->backoff, (uint64_t)now_ns) : now_ns;
    for (size_t i = 0; i < modbus->plan.unit_count && !all_tried; i++)
        modbus->units[i].retry_ns = now_ns;
}

/* Marks all units of a gateway as down. Units that were up before are requested again immediately. */
static void lose_gateway(struct modbus_source *modbus)
{
    for (size_t i = 0; i < modbus->plan.unit_count; i++) {
        struct modbus_unit *unit = &modbus->units[i];
        if (unit->state == UNIT_UP)
            unit->retry_ns = clock_mono_ns();
        unit->state = UNIT_DOWN;
        unit->doubted = false;
    }
}

void modbus_unit_is_down(struct modbus_source *modbus, struct modbus_unit *unit, const char *why)
{
    char more[LOG_PACE_BYTES], gateway[200];
    modbus->fallen += unit->state == UNIT_UP;
    unit->state = UNIT_DOWN;
    unit->doubted = false;
    unit->retry_ns = clock_mono_ns() + backoff_next_ns(&unit->backoff, (uint64_t)clock_mono_ns());
    if (modbus->fallen >= GATEWAY_UNITS && any_unit_up(modbus)) {
        lose_gateway(modbus);
        snprintf(gateway, sizeof(gateway), "the gateway counts as lost, because %d of its units stopped answering one after the other: %s",
                 modbus->fallen, why);
        why = gateway;
    }
    if (!any_unit_up(modbus)) {
        link_lost(modbus, why);
        if (modbus->base.config->host_count > 1)
            try_elsewhere(modbus);
        return;
    }
    if (log_pace_take(&unit->pace, clock_mono_ns(), more)) {
        log_warn(modbus->base.log, "source %s: unit %d does not answer (%s)%s", modbus->base.config->id, unit->id, why, more);
        unit->loss_said = true;
    }
    lose_tags_of(modbus, unit);
}

/* --- deciding whether a block or its unit is to blame ----------------------------------------------------------------------- */

/* Returns the block (tags read by one request) to try instead: of the unit's other blocks whose last request was answered, the
   one due first. NULL: none. */
static struct read_plan_block *other_block(struct modbus_source *modbus, const struct read_plan_block *block)
{
    struct read_plan_block *other = NULL;
    for (size_t i = 0; i < modbus->plan.block_count; i++) {
        struct read_plan_block *b = &modbus->plan.blocks[i];
        if (b != block && b->unit == block->unit && b->silent_count == 0 && (!other || b->due_ns < other->due_ns))
            other = b;
    }
    return other;
}

bool modbus_unit_doubt(struct modbus_source *modbus, struct modbus_unit *unit, size_t block)
{
    struct read_plan_block *failed = &modbus->plan.blocks[block], *other = other_block(modbus, failed);
    if (unit->state != UNIT_UP || unit->doubted || !other || modbus->fallen >= GATEWAY_UNITS - 1)
        return false;
    unit->doubted = true;
    unit->doubted_table = failed->table;
    unit->doubted_first = failed->first;
    /* makes block `other`, another request to the same unit, the next to be read */
    other->due_ns = failed->due_ns - failed->scan_ms * NS_PER_MS;
    return true;
}

/* Records that a block rather than its unit is to blame for a missing answer. Splits the block in two or, if it has a single
   tag, requests it again after growing delays. */
static void blame(struct modbus_source *modbus, size_t index)
{
    struct read_plan_block *block = &modbus->plan.blocks[index];
    int64_t now_ns = clock_mono_ns();
    for (size_t t = 0; t < block->tag_count; t++)
        modbus->lost[t] = modbus->plan.tags[block->first_tag + t];
    store_tags_lost(modbus->base.store, modbus->lost, block->tag_count, now_ns);
    modbus->plan_cut = true;
    if (block->tag_count > 1) {
        block->silent_count = 1;
        block->due_ns = now_ns + SPLIT_PAUSE_NS;
        read_plan_split(&modbus->plan, modbus->base.plant, index);
        return;
    }
    modbus_note_refused(modbus, block, true, "the device does not answer for these addresses, although it answers for others");
    block->due_ns = now_ns + modbus_refused_pause_ns(block->silent_count++);
}

void modbus_unit_settle(struct modbus_source *modbus, struct modbus_unit *unit, const struct read_plan_block *answered)
{
    bool doubted = unit->doubted;
    unit->doubted = false;
    if (!doubted || (answered->table == unit->doubted_table && answered->first == unit->doubted_first))
        return;
    for (size_t i = 0; i < modbus->plan.block_count; i++) {
        const struct read_plan_block *block = &modbus->plan.blocks[i];
        if (block->unit == unit->id && block->table == unit->doubted_table && block->first == unit->doubted_first) {
            blame(modbus, i);
            return;
        }
    }
}

bool modbus_connect_link(struct modbus_source *modbus)
{
    int status = modbus_link_open(modbus->link);
    if (status == 0) {
        counter_inc(modbus->connects, 1);
        return wait_for(-1, 0, modbus->base.stop_fd, clock_mono_ns() + modbus->manners.connect_delay_ns) != -ECANCELED;
    }
    if (status == -ECANCELED || modbus_manners_excuse_connect(modbus, status))
        return false;
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        modbus->units[i].state = UNIT_DOWN;
    link_lost(modbus, modbus_error_text(status));
    try_elsewhere(modbus);
    return false;
}
