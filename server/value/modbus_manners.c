/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source: learns how the device handles connections ("manners") and adapts to it. Logs once which key of the plant file would
   set this from the start. */
#include <errno.h>
#include <stdio.h>

#include "base/clock.h"
#include "value/modbus_impl.h"

/* LISTEN_TIMEOUTS: how long to wait for a late answer in RTU frames while no unit answers, in multiples of the source's timeout.
   SHORT_CONNECTIONS: number of consecutive connections closed after one answer that makes the source send one request per
   connection. REFUSED_CONNECTIONS, CLOSED_CONNECTIONS: maximum number of failed connections, when connecting and when reading, that
   are blamed on reconnecting too early. */
enum { LISTEN_TIMEOUTS = 4, SHORT_CONNECTIONS = 3, REFUSED_CONNECTIONS = 6, CLOSED_CONNECTIONS = 2 };
/* First delay in nanoseconds before reconnecting to a device that refuses connections, because some devices take a while to
   release a closed connection. It doubles with each further failure. */
static const int64_t RECONNECT_DELAY_NS = 50 * NS_PER_MS;
/* time in nanoseconds after a device's last answer during which a failed connection is attributed to reconnecting too early */
static const int64_t TOLERANCE_NS = 2 * NS_PER_S;
/* time limit in nanoseconds for the first answer on a connection, if the previous connection got no answer at all; twice
   this time after two or more such connections */
static const int64_t FIRST_ANSWER_TIMEOUT_NS = 3 * NS_PER_S;
/* Some RTU-over-TCP devices ignore requests sent too soon after connecting. After each connection without an answer, the delay
   between connecting and the first request is doubled, and this time is added (nanoseconds). Repeating the request instead
   would not work: RTU frames have no transaction numbers, so a late answer could be taken for that to another request. */
static const int64_t RTU_DELAY_NS = 500 * NS_PER_MS;
/* time limit in nanoseconds for the answer of a unit (slave address) that is up, if another unit behind the same gateway has
   just timed out */
static const int64_t GATEWAY_TIMEOUT_NS = 5 * NS_PER_S;
static const int64_t MAX_CONNECT_DELAY_NS = 8 * NS_PER_S;

void modbus_manners_init(struct modbus_source *modbus)
{
    const struct plant_source *config = modbus->base.config;
    modbus->manners = (struct modbus_manners){ .one_per_connection = config->close_between_polls,
                                               .connect_delay_ns = config->connect_delay_ms * NS_PER_MS };
    modbus->pace = (struct log_pace){ .first_ns = 10 * NS_PER_S, .longest_ns = 3600 * NS_PER_S };
    modbus->manners.late_pace = (struct log_pace){ .first_ns = 60 * NS_PER_S, .longest_ns = 3600 * NS_PER_S };
    modbus->unit_pace = (struct log_pace){ .first_ns = 60 * NS_PER_S, .longest_ns = 3600 * NS_PER_S };
    for (size_t i = 0; i < modbus->plan.unit_count; i++)
        modbus->units[i].pace = modbus->units[i].busy_pace = modbus->pace;
    modbus_link_allow_any_unit(modbus->link, modbus->plan.unit_count == 1);
}

static bool is_network(const struct modbus_source *modbus)
{
    return modbus->base.config->transport != TRANSPORT_RTU;
}

void modbus_manners_before(struct modbus_source *modbus, const struct modbus_unit *unit)
{
    struct modbus_manners *manners = &modbus->manners;
    int64_t patience_ns = manners->first_wait_ns;
    if (!modbus->link_up && manners->silent_connections > 0 && patience_ns < FIRST_ANSWER_TIMEOUT_NS)
        patience_ns = manners->silent_connections == 1 ? FIRST_ANSWER_TIMEOUT_NS : 2 * FIRST_ANSWER_TIMEOUT_NS;
    /* waits longer than the timeout only once for a gateway that may be busy with a silent unit: a second time, the gateway
       itself may be lost */
    bool waits = manners->timed_out && manners->timed_out != unit && modbus->fallen < GATEWAY_UNITS - 1;
    manners->first_excused = waits && unit->state == UNIT_UP && patience_ns < GATEWAY_TIMEOUT_NS;
    if (manners->first_excused)
        patience_ns = GATEWAY_TIMEOUT_NS;
    manners->timed_out = NULL;
    if (modbus->base.config->transport != TRANSPORT_TCP) /* while no unit answers, waiting for late answers delays nothing else */
        patience_ns = modbus->link_up ? 0 : LISTEN_TIMEOUTS * modbus->base.config->timeout_ms * NS_PER_MS;
    modbus_link_set_patience(modbus->link, patience_ns);
}

void modbus_manners_after(struct modbus_source *modbus)
{
    if (modbus->manners.one_per_connection && is_network(modbus))
        modbus_link_close(modbus->link);
}

/* --- learning --------------------------------------------------------------------------------------------------------------- */

static void log_found(struct modbus_source *modbus, const char *found)
{
    log_info(modbus->base.log, "source %s: device %s %s", modbus->base.config->id, modbus_link_name(modbus->link), found);
}

/* Learns why the first answer on a connection was late. Either the device dropped the first request and answered a repeated
   one, or it took long to answer the first. */
static void learn_start(struct modbus_source *modbus)
{
    struct modbus_manners *manners = &modbus->manners;
    int64_t answered_ns, sent_ns = modbus_link_first_ns(modbus->link, &answered_ns),
                         timeout_ns = modbus->base.config->timeout_ms * NS_PER_MS;
    bool known = manners->first_wait_ns > 0, repeated = answered_ns - sent_ns < timeout_ns / 2;
    char found[200];
    if (answered_ns - manners->connect_delay_ns < timeout_ns) {
        /* forgets the learned delay: the first answer of this connection came in time, so an earlier late answer had another
           reason */
        manners->first_wait_ns = 0;
        return;
    }
    if (answered_ns > manners->first_wait_ns / 2)
        manners->first_wait_ns = 2 * answered_ns;
    if (known)
        return;
    long long sent_ms = (sent_ns / NS_PER_MS + 99) / 100 * 100, answered_ms = answered_ns / NS_PER_MS;
    if (repeated)
        snprintf(found, sizeof(found),
                 "does not answer requests sent less than %lld ms after connecting: repeating the first request; set `connect_delay_ms: "
                 "%lld` to wait from the start",
                 sent_ms, sent_ms);
    else
        snprintf(found, sizeof(found), "needs %lld ms after connecting for its first answer, so the first request waits that long",
                 answered_ms);
    log_found(modbus, found);
}

/* Logs the delay that a device with RTU frames over TCP needs between connecting and the first request. Its frames have no
   transaction numbers, so requests must not be repeated. Instead, after each connection without an answer, the next connection
   waits longer before its first request. */
static void learn_rtu_delay(struct modbus_source *modbus)
{
    struct modbus_manners *manners = &modbus->manners;
    bool found = manners->silent_connections > 0 && manners->connect_delay_ns > modbus->base.config->connect_delay_ms * NS_PER_MS;
    if (found && modbus->base.config->transport == TRANSPORT_RTU_TCP)
        log_info(modbus->base.log,
                 "source %s: device %s needs %lld ms between connecting and the first request; set `connect_delay_ms` to apply this from "
                 "the start",
                 modbus->base.config->id, modbus_link_name(modbus->link), (long long)(manners->connect_delay_ns / NS_PER_MS));
}

static void note_unit(struct modbus_source *modbus, int asked)
{
    int answered = modbus_link_answered_unit(modbus->link);
    char more[LOG_PACE_BYTES];
    if (modbus->base.config->transport == TRANSPORT_TCP && answered != asked && log_pace_take(&modbus->unit_pace, clock_mono_ns(), more))
        log_info(modbus->base.log,
                 "source %s: device %s answers as unit %d to requests for unit %d: accepted, because only one unit is "
                 "read%s",
                 modbus->base.config->id, modbus_link_name(modbus->link), answered, asked, more);
}

void modbus_manners_answered(struct modbus_source *modbus, const struct read_plan_block *block)
{
    struct modbus_manners *manners = &modbus->manners;
    int answers = modbus_link_answers(modbus->link);
    if (answers == 1 && modbus->base.config->transport == TRANSPORT_TCP && !manners->first_excused)
        learn_start(modbus);
    learn_rtu_delay(modbus);
    if (answers > 1)
        manners->short_connections = 0;
    manners->silent_connections = manners->failed_connections = 0;
    note_unit(modbus, block->unit);
}

/* --- failures --------------------------------------------------------------------------------------------------------------- */

/* Returns a value for `timeout_ms` that is long enough for a device that answers after late_ns: twice that time. */
static long long enough_ms(int64_t late_ns)
{
    return (2 * late_ns / NS_PER_MS + 99) / 100 * 100;
}

void modbus_manners_late(struct modbus_source *modbus)
{
    int64_t late_ns = modbus_link_late_ns(modbus->link);
    char more[LOG_PACE_BYTES];
    if (late_ns && log_pace_take(&modbus->manners.late_pace, clock_mono_ns(), more))
        log_warn(modbus->base.log,
                 "source %s: device %s answers up to %lld ms after a request, later than `timeout_ms: %d`, so its answers are not used: "
                 "set `timeout_ms: %lld`%s",
                 modbus->base.config->id, modbus_link_name(modbus->link), (long long)(late_ns / NS_PER_MS),
                 modbus->base.config->timeout_ms, enough_ms(late_ns), more);
}

static bool is_closed(int status)
{
    return status == -ECONNRESET || status == -EPIPE || status == -ECONNREFUSED || status == -ECONNABORTED;
}

/* Logs why the source reads one block (tags read by one request) per connection from now on. A slow device looks like one that
   answers only once per connection, because its second answer does not come in time. */
static void log_one_per_connection(struct modbus_source *modbus, int status)
{
    int64_t wait_ns = modbus->manners.first_wait_ns;
    char found[200];
    snprintf(found, sizeof(found),
             "answers only after %lld ms, later than `timeout_ms: %d`, so each request gets a new connection; set `timeout_ms: %lld`",
             (long long)(wait_ns / 2 / NS_PER_MS), modbus->base.config->timeout_ms, enough_ms(wait_ns / 2));
    log_found(modbus, status == -ETIMEDOUT && wait_ns > 0 ? found
                                                          : "closes the connection after each answer, so each request gets a new "
                                                            "connection; set `close_between_polls: yes` to do so from the start");
}

/* Counts connections that the device closed after one answer; after SHORT_CONNECTIONS in a row, switches to one request per
 * connection. If the device closes a connection after more than one answer, only logs that, once. */
static void learn_end(struct modbus_source *modbus, int answers, int status)
{
    struct modbus_manners *manners = &modbus->manners;
    manners->short_connections = answers == 1 ? manners->short_connections + 1 : 0;
    if (manners->short_connections == SHORT_CONNECTIONS && !manners->one_per_connection) {
        manners->one_per_connection = true;
        log_one_per_connection(modbus, status);
    } else if (answers > 1 && !manners->ends_said) {
        manners->ends_said = true;
        log_info(modbus->base.log, "source %s: device %s closes connections after some answers; the daemon connects again each time",
                 modbus->base.config->id, modbus_link_name(modbus->link));
    }
}

/* Returns true, and sets the time of the next attempt, if the device refused or closed a connection soon after its last answer
   on an earlier one. It may take a while to release the earlier connection. */
static bool may_be_early(struct modbus_source *modbus, int status, int most)
{
    struct modbus_manners *manners = &modbus->manners;
    bool ends = manners->one_per_connection || manners->short_connections > 1;
    int64_t now_ns = clock_mono_ns();
    if (!modbus->link_up || !ends || !is_closed(status) || now_ns - modbus->answered_ns > TOLERANCE_NS ||
        manners->failed_connections >= most || modbus->base.config->host_count > 1)
        return false;
    modbus->connect_ns = now_ns + (RECONNECT_DELAY_NS << manners->failed_connections++);
    return true;
}

bool modbus_manners_excuse_connect(struct modbus_source *modbus, int status)
{
    return is_network(modbus) && may_be_early(modbus, status, REFUSED_CONNECTIONS);
}

static void try_longer_start(struct modbus_source *modbus)
{
    struct modbus_manners *manners = &modbus->manners;
    const struct plant_source *config = modbus->base.config;
    manners->silent_connections++;
    if (config->transport != TRANSPORT_RTU_TCP)
        return;
    manners->connect_delay_ns = 2 * manners->connect_delay_ns + RTU_DELAY_NS;
    if (manners->connect_delay_ns > MAX_CONNECT_DELAY_NS)
        manners->connect_delay_ns = config->connect_delay_ms * NS_PER_MS;
}

bool modbus_manners_excuse_read(struct modbus_source *modbus, int status, bool unit_up)
{
    int answers = modbus_link_answers(modbus->link);
    bool silent_after_one = unit_up && answers == 1 && status == -ETIMEDOUT && modbus->base.config->transport == TRANSPORT_TCP;
    if (!is_network(modbus))
        return false;
    if (silent_after_one || (modbus->link_up && answers > 0 && is_closed(status))) {
        learn_end(modbus, answers, status);
        return true;
    }
    if (!modbus->link_up && answers == 0 && status == -ETIMEDOUT)
        try_longer_start(modbus);
    return unit_up && may_be_early(modbus, status, CLOSED_CONNECTIONS);
}
