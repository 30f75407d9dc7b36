/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of a Modbus source: its thread (modbus.c), the state of each unit (modbus_units.c), adapting to how the device
   handles connections (modbus_manners.c), and processing of responses (modbus_answers.c). Thread: the source's own. */
#ifndef VALUE_MODBUS_IMPL_H
#define VALUE_MODBUS_IMPL_H
#include "base/log/log_pace.h"
#include "value/backoff.h"
#include "value/modbus_link.h"
#include "value/read_plan.h"
#include "value/source_impl.h"

enum unit_state { UNIT_UNKNOWN, UNIT_UP, UNIT_DOWN };

struct modbus_unit { /* one Modbus unit (slave address); a gateway or a serial line has several units */
    int id;
    enum unit_state state;
    struct backoff backoff;
    int64_t retry_ns;
    struct log_pace pace, busy_pace;
    bool loss_said; /* the log has "does not answer" for the unit, and not yet "answers again" */
    bool doubted;   /* a block failed on a new connection; the next block's result decides whether the block or the unit is to blame */
    enum register_table doubted_table;
    int doubted_first;
};

struct modbus_manners {       /* how the device handles connections (its manners): from the plant file, or learned from its behaviour */
    bool one_per_connection;  /* the device closes a connection after one answer */
    int64_t connect_delay_ns; /* delay in nanoseconds from connecting to the first request */
    /* nanoseconds during which the first request of a connection is repeated until it is answered; 0: it is sent once */
    int64_t first_wait_ns;
    int short_connections;  /* number of successive connections that the device closed after one answer */
    int silent_connections; /* number of successive connections without any answer while no unit of the source was answering */
    /* The unit that has just timed out, or NULL. A gateway may wait longer than our timeout for that unit before it accepts other
       requests. */
    const struct modbus_unit *timed_out;
    bool first_excused; /* on this connection, a first answer that comes late is no fault of the unit, because of `timed_out` */
    /* number of successive connections that the device refused or closed at once, each right after a connection on which it had answered */
    int failed_connections;
    bool ends_said;
};

struct modbus_source {
    struct source base;
    counter *reads_ok, *reads_failed, *connects, *up, *host;
    struct modbus_link *link;
    /* --- below: used by the source's thread only */
    struct read_plan plan;
    bool plan_cut; /* the plan has blocks that were split around addresses that the device refused or did not answer */
    struct modbus_unit *units;
    struct backoff backoff; /* backoff of connection attempts */
    int64_t connect_ns;     /* monotonic: the source makes no connection before this time */
    int64_t asked_ns;       /* monotonic time at which the last request ended */
    int64_t answered_ns;    /* monotonic time of the last answer */
    bool link_up;
    struct modbus_manners manners;
    struct log_pace pace;      /* rate limit of the log line "no readings" */
    bool loss_said;            /* the log has "no readings" for the source, and not yet "readings are back" */
    struct log_pace unit_pace; /* rate limit of the log line about answers that name another unit */
    bool *refused;             /* flag by index in plant->tags: the device refuses to read this tag */
    struct sample *samples;    /* buffer for one sample of each tag */
    int *lost;                 /* buffer for an array of tag indices, with room for all tags */
};

/* Returns the unit that a block is read from. */
struct modbus_unit *modbus_unit_of(const struct modbus_source *modbus, const struct read_plan_block *block);
/* Records that a unit answered; logs it if the log says that the unit does not answer. */
void modbus_unit_is_up(struct modbus_source *modbus, struct modbus_unit *unit);
/* Records that a unit does not answer: its tags lose their link, and the unit gets no request before a backoff delay has passed. */
void modbus_unit_is_down(struct modbus_source *modbus, struct modbus_unit *unit, const char *why);
/* Opens the link if it is closed. Returns false if it cannot be opened now; modbus->connect_ns is then the time of the next attempt. */
bool modbus_connect_link(struct modbus_source *modbus);

/* Initialises the device's manners (how it handles connections) from the plant file. */
void modbus_manners_init(struct modbus_source *modbus);
/* Prepares the link for a request to a unit: sets how long the first answer of a connection may take. */
void modbus_manners_before(struct modbus_source *modbus, const struct modbus_unit *unit);
/* Closes the connection after an answer, if the device wants one connection per request. */
void modbus_manners_after(struct modbus_source *modbus);
/* Learns the device's connection behaviour from an answer. */
void modbus_manners_answered(struct modbus_source *modbus, const struct read_plan_block *block);
/* Learns the device's connection behaviour from a read that failed with status < 0. Returns true if the failure is explained by that
   behaviour: the block is then requested again on a new connection, from modbus->connect_ns on. */
bool modbus_manners_excuse_read(struct modbus_source *modbus, int status, bool unit_up);
/* Returns true if the device's behaviour explains a failed connection attempt; the next attempt is then made at modbus->connect_ns. */
bool modbus_manners_excuse_connect(struct modbus_source *modbus, int status);
/* Call it when a block failed on a new connection while its unit was answering. Returns true if another block of the unit is requested
   first, so that its result tells whether the block or the whole unit is to blame. */
bool modbus_unit_doubt(struct modbus_source *modbus, struct modbus_unit *unit, size_t block);
/* Call it when a block of the unit was answered. If another block had failed before, that block and not the unit is at fault: its tags lose
   their link. */
void modbus_unit_settle(struct modbus_source *modbus, struct modbus_unit *unit, const struct read_plan_block *answered);

/* Decodes the response to a block and writes its tags to the store. */
void modbus_take_values(struct modbus_source *modbus, struct read_plan_block *block, const uint16_t *words);
/* Handles a Modbus exception: retries a busy device, splits a refused block, and marks refused tags as Bad. */
void modbus_take_exception(struct modbus_source *modbus, size_t block, int code, int64_t now_ns);
/* Logs and records that the device refuses a block's tags, or reads them again. Returns true if the state of any tag changed. */
bool modbus_note_refused(struct modbus_source *modbus, const struct read_plan_block *block, bool refused, const char *why);
/* Returns the delay in nanoseconds before an address that was refused `before` times in a row is requested again. */
int64_t modbus_refused_pause_ns(int before);
/* Rebuilds the read plan with the refused addresses included again, because the device may have been repaired or replaced. */
void modbus_replan(struct modbus_source *modbus);

#endif
