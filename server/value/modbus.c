/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source: asks each block of its plan when it is due, and finds out again and again who answers. */
#include "value/modbus.h"

#include <errno.h>
#include <modbus.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/backoff.h"
#include "value/decode.h"
#include "value/lookup.h"
#include "value/modbus_link.h"
#include "value/plan.h"
#include "value/quality.h"

static const int64_t REPLAN_NS = 60 * NS_PER_S; /* how long a refused register is believed to be wrong */

enum unit_state { UNIT_UNKNOWN, UNIT_UP, UNIT_DOWN };

struct unit { /* a device behind the address; several behind a gateway */
    int id;
    enum unit_state state;
    struct backoff backoff;
    int64_t retry_ns;
};

struct modbus_source {
    struct source base;
    struct log *log;
    const struct plant *plant;
    const struct plant_source *config;
    int index;
    struct store *store;
    counter *reads_ok, *reads_failed, *connects, *up;
    int stop_fd;
    pthread_t thread;
    bool has_thread;
    struct modbus_link *link;
    /* --- below: the thread's own */
    struct plan plan;
    int64_t replan_ns;          /* INT64_MAX: the plan is whole */
    struct unit *units;
    struct backoff backoff;     /* of connecting */
    int64_t connect_ns;         /* not before */
    bool link_up, link_known;
    bool *refused;              /* by index in plant->tags: the device has said no to it */
    struct sample *samples;     /* room for all tags */
    int *lost;                  /* likewise */
};

/* --- links and units -------------------------------------------------------------------------------------------------------- */

static struct unit *unit_of(const struct modbus_source *modbus, const struct plan_block *block)
{
    size_t i = 0;
    while (modbus->units[i].id != block->unit)
        i++;
    return &modbus->units[i];
}

static void link_lost(struct modbus_source *modbus, const char *why)
{
    int64_t now_ns = clock_mono_ns();
    log_at(modbus->log, modbus->link_up || !modbus->link_known ? LOG_WARN : LOG_DEBUG, "source %s: %s:%d: no readings (%s)",
           modbus->config->id, modbus->config->host, modbus->config->port, why);
    modbus->link_up = false;
    modbus->link_known = true;
    counter_set(modbus->up, 0);
    store_link_lost(modbus->store, modbus->index, now_ns);
}

static void unit_is_up(struct modbus_source *modbus, struct unit *unit)
{
    if (unit->state == UNIT_DOWN && modbus->replan_ns != INT64_MAX)
        modbus->replan_ns = 0; /* it may have come back another: what it refused before is asked anew */
    if (unit->state == UNIT_DOWN && modbus->link_up)
        log_info(modbus->log, "source %s: unit %d answers again", modbus->config->id, unit->id);
    unit->state = UNIT_UP;
    unit->backoff = (struct backoff){ 0 };
    if (modbus->link_up)
        return;
    modbus->link_up = modbus->link_known = true;
    counter_set(modbus->up, 1);
    store_link_up(modbus->store, modbus->index, clock_mono_ns());
    log_info(modbus->log, "source %s: %s:%d: reading", modbus->config->id, modbus->config->host, modbus->config->port);
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
        const struct plan_block *block = &modbus->plan.blocks[b];
        for (size_t t = 0; block->unit == unit->id && t < block->tag_count; t++)
            modbus->lost[count++] = modbus->plan.tags[block->first_tag + t];
    }
    store_tags_lost(modbus->store, modbus->lost, count, clock_mono_ns());
}

static void unit_is_down(struct modbus_source *modbus, struct unit *unit, const char *why)
{
    bool was_up = unit->state == UNIT_UP;
    unit->state = UNIT_DOWN;
    unit->retry_ns = clock_mono_ns() + backoff_next_ns(&unit->backoff, (uint64_t)clock_mono_ns());
    if (!any_unit_up(modbus)) {
        link_lost(modbus, why);
        return;
    }
    log_at(modbus->log, was_up ? LOG_WARN : LOG_DEBUG, "source %s: unit %d does not answer (%s)", modbus->config->id, unit->id, why);
    lose_tags_of(modbus, unit);
}

static bool connect_link(struct modbus_source *modbus)
{
    int status = modbus_link_open(modbus->link);
    if (status == 0) {
        modbus->backoff = (struct backoff){ 0 };
        counter_inc(modbus->connects, 1);
        return true;
    }
    if (status == -ECANCELED)
        return false;
    modbus->connect_ns = clock_mono_ns() + backoff_next_ns(&modbus->backoff, (uint64_t)clock_mono_ns());
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        modbus->units[i].state = UNIT_DOWN;
    link_lost(modbus, strerror(-status));
    return false;
}

/* --- what a read brings ----------------------------------------------------------------------------------------------------- */

static void note_refused(struct modbus_source *modbus, const struct plan_block *block, bool refused, const char *why)
{
    size_t changed = 0;
    const char *first = "";
    for (size_t i = 0; i < block->tag_count; i++) {
        int tag = modbus->plan.tags[block->first_tag + i];
        if (modbus->refused[tag] != refused && changed++ == 0)
            first = modbus->plant->tags[tag].name;
        modbus->refused[tag] = refused;
    }
    if (changed)
        log_at(modbus->log, refused ? LOG_WARN : LOG_INFO, "source %s: unit %d: %s%s (%d from %d): %s", modbus->config->id, block->unit,
               first, changed > 1 ? " and others" : "", block->count, block->first, why);
}

static void take_values(struct modbus_source *modbus, const struct plan_block *block, const uint16_t *words)
{
    for (size_t i = 0; i < block->tag_count; i++) {
        int index = modbus->plan.tags[block->first_tag + i];
        const struct plant_tag *tag = &modbus->plant->tags[index];
        modbus->samples[i].tag = index;
        decode_sample(tag, words + (tag->register_index - block->first), &modbus->samples[i]);
    }
    unit_is_up(modbus, unit_of(modbus, block));
    store_write(modbus->store, modbus->samples, block->tag_count, clock_mono_ns(), clock_utc_ns());
    note_refused(modbus, block, false, "read again");
}

static void take_refusal(struct modbus_source *modbus, const struct plan_block *block, uint32_t quality, const char *why)
{
    for (size_t i = 0; i < block->tag_count; i++)
        modbus->samples[i] = (struct sample){ .tag = modbus->plan.tags[block->first_tag + i], .quality = quality };
    store_write(modbus->store, modbus->samples, block->tag_count, clock_mono_ns(), clock_utc_ns());
    note_refused(modbus, block, true, why);
}

static uint32_t quality_of_exception(int code)
{
    switch (code) {
    case MODBUS_EXCEPTION_ILLEGAL_FUNCTION:
    case MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS:
    case MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE:
        return QUALITY_BAD_CONFIGURATION;
    case MODBUS_EXCEPTION_SLAVE_OR_SERVER_FAILURE:
    case MODBUS_EXCEPTION_MEMORY_PARITY:
        return QUALITY_BAD_DEVICE_FAILURE;
    default: /* busy and the like: asked again when it is due; stale if that goes on */
        return QUALITY_GOOD;
    }
}

static void take_exception(struct modbus_source *modbus, size_t index, int code, int64_t now_ns)
{
    struct plan_block *block = &modbus->plan.blocks[index];
    const char *why = modbus_strerror(MODBUS_ENOBASE + code);
    uint32_t quality = quality_of_exception(code);
    if (code == MODBUS_EXCEPTION_GATEWAY_PATH || code == MODBUS_EXCEPTION_GATEWAY_TARGET) {
        unit_is_down(modbus, unit_of(modbus, block), why);
        return;
    }
    unit_of(modbus, block)->backoff = (struct backoff){ 0 };
    if (quality_is_good(quality))
        return;
    if (modbus->replan_ns == INT64_MAX)
        modbus->replan_ns = now_ns + REPLAN_NS;
    if (code != MODBUS_EXCEPTION_ILLEGAL_FUNCTION && block->tag_count > 1) {
        block->due_ns = now_ns; /* both halves at once, and so on down to the register that is to blame */
        plan_split(&modbus->plan, modbus->plant, index);
        return;
    }
    if (quality == QUALITY_BAD_CONFIGURATION)
        block->due_ns = modbus->replan_ns;
    take_refusal(modbus, block, quality, why);
}

/* --- the thread ------------------------------------------------------------------------------------------------------------- */

static bool stopping(const struct modbus_source *modbus)
{
    return wait_for(-1, 0, modbus->stop_fd, 0) == -ECANCELED;
}

static void read_block(struct modbus_source *modbus, size_t index)
{
    struct plan_block *block = &modbus->plan.blocks[index];
    uint16_t words[PLAN_MAX_BITS];
    if (!modbus_link_is_open(modbus->link) && !connect_link(modbus))
        return;
    int status = modbus_link_read(modbus->link, block->unit, block->table, block->first, block->count, words);
    if (status < 0 && stopping(modbus))
        return;
    int64_t now_ns = clock_mono_ns(), next_ns = block->due_ns + block->scan_ms * NS_PER_MS;
    block->due_ns = next_ns > now_ns ? next_ns : now_ns + block->scan_ms * NS_PER_MS; /* late: no bursts to catch up */
    counter_inc(status == 0 ? modbus->reads_ok : modbus->reads_failed, 1);
    if (status == 0)
        take_values(modbus, block, words);
    else if (status > 0)
        take_exception(modbus, index, status, now_ns);
    else
        unit_is_down(modbus, unit_of(modbus, block), strerror(-status));
}

/* When this block may be asked: when it is due, and its unit and the connection are not being left alone. */
static int64_t ready_ns(const struct modbus_source *modbus, const struct plan_block *block)
{
    const struct unit *unit = unit_of(modbus, block);
    int64_t at_ns = block->due_ns;
    if (unit->state == UNIT_DOWN && unit->retry_ns > at_ns)
        at_ns = unit->retry_ns;
    if (!modbus_link_is_open(modbus->link) && modbus->connect_ns > at_ns)
        at_ns = modbus->connect_ns;
    return at_ns;
}

/* Of the blocks that are ready, the one that has waited longest: a block that always fails cannot starve the rest.
   block_count: none is, *wake_ns says when. */
static size_t choose_block(const struct modbus_source *modbus, int64_t now_ns, int64_t *wake_ns)
{
    size_t chosen = modbus->plan.block_count;
    *wake_ns = modbus->replan_ns;
    for (size_t i = 0; i < modbus->plan.block_count; i++) {
        int64_t at_ns = ready_ns(modbus, &modbus->plan.blocks[i]);
        if (at_ns < *wake_ns)
            *wake_ns = at_ns;
        if (at_ns <= now_ns && (chosen == modbus->plan.block_count || modbus->plan.blocks[i].due_ns < modbus->plan.blocks[chosen].due_ns))
            chosen = i;
    }
    return chosen;
}

/* Forgets which registers were refused: a device may have been repaired, or was still starting. */
static void replan(struct modbus_source *modbus)
{
    plan_finish(&modbus->plan);
    plan_init(&modbus->plan, modbus->plant, modbus->index);
    modbus->replan_ns = INT64_MAX;
}

static void *modbus_main(void *arg)
{
    struct modbus_source *modbus = arg;
    while (!stopping(modbus)) {
        int64_t now_ns = clock_mono_ns(), wake_ns;
        if (now_ns >= modbus->replan_ns)
            replan(modbus);
        size_t chosen = choose_block(modbus, now_ns, &wake_ns);
        if (chosen < modbus->plan.block_count)
            read_block(modbus, chosen);
        else
            wait_for(-1, 0, modbus->stop_fd, wake_ns);
    }
    return NULL;
}

static void modbus_stop(struct source *source)
{
    struct modbus_source *modbus = (struct modbus_source *)source;
    if (modbus->has_thread) {
        eventfd_write(modbus->stop_fd, 1);
        modbus_link_interrupt(modbus->link);
        pthread_join(modbus->thread, NULL);
    }
    modbus_link_destroy(&modbus->link);
    if (modbus->stop_fd >= 0)
        close(modbus->stop_fd);
    plan_finish(&modbus->plan);
    mem_free(modbus->units);
    mem_free(modbus->refused);
    mem_free(modbus->samples);
    mem_free(modbus->lost);
    mem_free(modbus);
}

static counter *add_counter(struct counters *counters, const char *name, const char *source, const char *more, const char *type,
                            const char *help)
{
    char *full = mem_printf("plantcast_source_%s{source=\"%s\"%s}", name, source, more);
    counter *added = counters_add(counters, full, type, help);
    mem_free(full);
    return added;
}

static void add_counters(struct modbus_source *modbus, struct counters *counters)
{
    const char *id = modbus->config->id, *reads = "requests to field devices", *up = "1 while readings come in";
    modbus->reads_ok = add_counter(counters, "reads_total", id, ",result=\"ok\"", "counter", reads);
    modbus->reads_failed = add_counter(counters, "reads_total", id, ",result=\"failed\"", "counter", reads);
    modbus->connects = add_counter(counters, "connects_total", id, "", "counter", "connections made to field devices");
    modbus->up = add_counter(counters, "up", id, "", "gauge", up);
}

static void add_plan(struct modbus_source *modbus)
{
    plan_init(&modbus->plan, modbus->plant, modbus->index);
    modbus->replan_ns = INT64_MAX;
    modbus->units = mem_array(modbus->plan.unit_count, sizeof(*modbus->units));
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        modbus->units[i].id = modbus->plan.units[i];
    modbus->refused = mem_array(modbus->plant->tag_count, sizeof(*modbus->refused));
    modbus->samples = mem_array(modbus->plan.tag_count, sizeof(*modbus->samples));
    modbus->lost = mem_array(modbus->plan.tag_count, sizeof(*modbus->lost));
    log_info(modbus->log, "source %s: %s:%d: %zu tags in %zu requests", modbus->config->id, modbus->config->host, modbus->config->port,
             modbus->plan.tag_count, modbus->plan.block_count);
}

static struct source *modbus_start(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters)
{
    struct modbus_source *modbus = mem_new(sizeof(*modbus));
    modbus->base.impl = &modbus_impl;
    modbus->log = log;
    modbus->plant = plant;
    modbus->config = &plant->sources[source];
    modbus->index = source;
    modbus->store = store;
    modbus->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (modbus->stop_fd < 0) {
        log_err(log, "source %s: eventfd: %s", modbus->config->id, strerror(errno));
        goto error;
    }
    modbus->link = modbus_link_create(log, modbus->config, modbus->stop_fd);
    if (!modbus->link)
        goto error;
    add_counters(modbus, counters);
    add_plan(modbus);
    modbus->has_thread = pthread_create(&modbus->thread, NULL, modbus_main, modbus) == 0;
    if (!modbus->has_thread) {
        log_err(log, "source %s: no thread", modbus->config->id);
        goto error;
    }
    return &modbus->base;
error:
    modbus_stop(&modbus->base);
    return NULL;
}

const struct source_impl modbus_impl = { .kind = "modbus", .start = modbus_start, .stop = modbus_stop };
