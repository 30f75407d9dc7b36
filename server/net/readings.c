/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The event loop's snapshot of the readings, and the state of the connections to their sources. */
#include "base/clock.h"
#include "net/net_impl.h"
#include "net/unread_files.h"
#include "value/quality.h"

/* time in nanoseconds for which clients are told that an entry is not recorded, after the error has ended */
static const int64_t UNRECORDED_HOLD_NS = 10 * NS_PER_S;

/* Returns when a reading changed. A reading that has just become stale (too old to be Good) counts as changed now, whenever it
   was received. */
static int64_t changed_ns(const struct snapshot *snapshot, const struct reading *reading)
{
    bool usable = !quality_is_bad(reading->quality) && reading->age_ns < NS_PER_S;
    return snapshot->taken_mono_ns - (usable ? reading->age_ns : 0);
}

bool net_take_snapshot(struct server_context *server)
{
    bool changed = false;
    const struct plant_services *plant = &server->params.plant;
    server->readings.next_change_ns = store_take(plant->store, clock_mono_ns(), clock_plant_ns(plant->clock), server->readings.snapshot);
    render_service_set_readings(plant->render_service, server->readings.snapshot);
    server->readings.data_ns = server->readings.snapshot->taken_mono_ns;
    for (size_t i = 0; i < server->readings.snapshot->count; i++) {
        const struct reading *reading = &server->readings.snapshot->readings[i];
        if (server->readings.changes[i] == reading->changes)
            continue;
        int64_t at_ns = changed_ns(server->readings.snapshot, reading);
        server->readings.data_ns = at_ns < server->readings.data_ns ? at_ns : server->readings.data_ns;
        server->readings.changes[i] = reading->changes;
        changed = true;
    }
    return changed;
}

/* Returns the bit mask of entries (enum unrecorded) that this daemon does not record, because it cannot use a file. */
static unsigned find_unrecorded(const struct server_context *server)
{
    const struct plant_services *plant = &server->params.plant;
    const char *names[UNREAD_FILES];
    bool lists = unread_files(plant, names) > 0;
    bool readings = plant->historian && historian_error(plant->historian);
    bool alarms = plant->alarm_service && alarm_service_journal_error(plant->alarm_service);
    bool actions = audit_error(server->params.audit);
    return (unsigned)readings << UNRECORDED_READINGS | (unsigned)alarms << UNRECORDED_ALARMS | (unsigned)actions << UNRECORDED_ACTIONS |
           (unsigned)lists << UNRECORDED_LISTS;
}

/* Returns the entries to report as not recorded: those of find_unrecorded(), and those that it returned within the last
   UNRECORDED_HOLD_NS. A reload replaces the historian, and the new one knows an error of the disk only after its first write. The
   page's warning must not disappear meanwhile. */
static unsigned hold_unrecorded(struct server_context *server, int64_t now_ns)
{
    unsigned unrecorded = find_unrecorded(server);
    for (int i = 0; i < UNRECORDED_COUNT; i++) {
        int64_t *at_ns = &server->readings.unrecorded_ns[i];
        if (unrecorded & 1u << i)
            *at_ns = now_ns;
        else if (*at_ns && now_ns - *at_ns < UNRECORDED_HOLD_NS)
            unrecorded |= 1u << i;
    }
    return unrecorded;
}

bool net_check_links(struct server_context *server)
{
    bool changed = false, any = false;
    for (size_t i = 0; i < server->session_context.plant->source_count; i++) {
        bool up = store_link_is_up(server->params.plant.store, (int)i);
        changed |= server->readings.links_up[i] != up;
        server->readings.links_up[i] = up;
        any |= up;
    }
    struct core_link *core_link = server->params.plant.core_link;
    bool core_up = core_link && core_link_is_up(core_link);
    changed |= server->session_context.core.up != core_up;
    server->session_context.core.up = core_up;
    server->session_context.readings.live = any;
    struct clock_state clock = clock_state_read(), *known = &server->session_context.readings.clock;
    changed |= known->set != clock.set || known->leap_s != clock.leap_s || clock_state_error_ms(known) != clock_state_error_ms(&clock);
    *known = clock;
    unsigned unrecorded = hold_unrecorded(server, clock_mono_ns());
    changed |= server->session_context.unrecorded != unrecorded;
    server->session_context.unrecorded = unrecorded;
    counter_set(server->counters.clock_set, clock.set);
    counter_set(server->counters.clock_error, (int64_t)(clock.error_s * 1e6));
    counter_set(server->counters.clock_leap, clock.leap_s);
    return changed;
}

void net_note_changes(struct server_context *server)
{
    bool data_changed = net_take_snapshot(server);
    server->readings.data_changed |= data_changed;
    server->readings.links_changed |= net_check_links(server);
    if (data_changed)
        server->session_context.readings.changed_ns = server->readings.snapshot->taken_mono_ns;
}

void net_refresh_readings(struct server_context *server)
{
    if (clock_mono_ns() - server->readings.snapshot->taken_mono_ns > READINGS_INTERVAL_NS)
        net_note_changes(server);
}
