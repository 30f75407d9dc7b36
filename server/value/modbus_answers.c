/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source: writes the values in responses to the store, and splits or rebuilds the read plan after exceptions (Modbus error
   responses). */
#include <modbus.h>

#include "base/clock.h"
#include "value/decode.h"
#include "value/modbus_impl.h"
#include "value/quality.h"

static const int64_t BUSY_DELAY_NS = 50 * NS_PER_MS;
enum { BUSY_TRIES = 4 };

void modbus_take_values(struct modbus_source *modbus, struct read_plan_block *block, const uint16_t *words)
{
    for (size_t i = 0; i < block->tag_count; i++) {
        int index = modbus->plan.tags[block->first_tag + i];
        const struct plant_tag *tag = &modbus->base.plant->tags[index];
        modbus->samples[i].tag = index;
        decode_sample(tag, words + (tag->signal.register_index - block->first), &modbus->samples[i]);
    }
    block->busy_count = block->refused_count = block->silent_count = 0;
    block->answered = true;
    store_write(modbus->base.store, modbus->samples, block->tag_count, clock_mono_ns(), clock_utc_ns());
    bool repaired = modbus_note_refused(modbus, block, false, "read again");
    /* the call may rebuild the read plan, so the pointer `block` must not be used afterwards */
    modbus_unit_is_up(modbus, modbus_unit_of(modbus, block));
    if (repaired)
        modbus_replan(modbus);
}

static void take_refusal(struct modbus_source *modbus, const struct read_plan_block *block, uint32_t quality, const char *why)
{
    for (size_t i = 0; i < block->tag_count; i++)
        modbus->samples[i] = (struct sample){ .tag = modbus->plan.tags[block->first_tag + i], .quality = quality };
    store_write(modbus->base.store, modbus->samples, block->tag_count, clock_mono_ns(), clock_utc_ns());
    modbus_note_refused(modbus, block, true, why);
}

static uint32_t quality_of_exception(int code)
{
    switch (code) {
    case MODBUS_EXCEPTION_ILLEGAL_FUNCTION:
    case MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS:
    case MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE: return QUALITY_BAD_CONFIGURATION;
    case MODBUS_EXCEPTION_SLAVE_OR_SERVER_FAILURE:
    case MODBUS_EXCEPTION_MEMORY_PARITY: return QUALITY_BAD_DEVICE_FAILURE;
    /* After other exceptions, such as "busy", the caller writes no quality to the store; QUALITY_GOOD tells it so. The source
       asks the device again soon. If the exceptions continue, the readings become stale. */
    default: return QUALITY_GOOD;
    }
}

/* Logs that a device answers every request for a block with an exception such as acknowledge (5) or busy (6). The readings of the
   block's tags become stale meanwhile. */
static void note_busy(struct modbus_source *modbus, const struct read_plan_block *block, int code, int64_t now_ns)
{
    char more[LOG_PACE_BYTES];
    if (log_pace_take(&modbus_unit_of(modbus, block)->busy_pace, now_ns, more))
        log_warn(modbus->base.log,
                 "source %s: unit %d: %d registers or bits from address %d on could not be read in %d tries: the device answers with "
                 "Modbus exception %d (%s)%s",
                 modbus->base.config->id, block->unit, block->count, block->first, BUSY_TRIES, code, modbus_strerror(MODBUS_ENOBASE + code),
                 more);
}

bool modbus_is_gateway_exception(int code)
{
    return code == MODBUS_EXCEPTION_GATEWAY_PATH || code == MODBUS_EXCEPTION_GATEWAY_TARGET;
}

void modbus_take_exception(struct modbus_source *modbus, size_t index, int code, int64_t now_ns)
{
    struct read_plan_block *block = &modbus->plan.blocks[index];
    const char *why = modbus_strerror(MODBUS_ENOBASE + code);
    uint32_t quality = quality_of_exception(code);
    if (modbus_is_gateway_exception(code)) {
        modbus_unit_is_down(modbus, modbus_unit_of(modbus, block), why);
        return;
    }
    modbus_unit_of(modbus, block)->backoff = (struct backoff){ 0 };
    if (quality_is_good(quality)) {
        if (++block->busy_count < BUSY_TRIES) {
            block->due_ns = now_ns + (BUSY_DELAY_NS << block->busy_count);
            return;
        }
        block->busy_count = 0;
        note_busy(modbus, block, code, now_ns);
        return;
    }
    /* the device has answered requests for this block (tags read by one request) before, so one more request decides whether
       the block is split in two */
    if (block->answered) {
        block->answered = false;
        block->due_ns = now_ns;
        return;
    }
    modbus->plan_cut = true;
    if (code != MODBUS_EXCEPTION_ILLEGAL_FUNCTION && block->tag_count > 1) {
        /* reads both halves of the split block (tags read by one request) immediately. A half that the device refuses is split
           again, until the refused register is found */
        block->due_ns = now_ns;
        read_plan_split(&modbus->plan, modbus->base.plant, index);
        return;
    }
    if (quality == QUALITY_BAD_CONFIGURATION)
        block->due_ns = now_ns + modbus_refused_pause_ns(block->refused_count++);
    take_refusal(modbus, block, quality, why);
}
