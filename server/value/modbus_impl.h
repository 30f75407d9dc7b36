/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files of a Modbus source. These are its thread (modbus.c), the state of each unit
   (modbus_units.c), its adaptation to the way the device handles connections (modbus_manners.c), and processing of responses
   (modbus_answers.c). Call only in the source's own thread. */
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
    bool loss_said; /* true: the log says that the unit does not answer, but not yet that it answers again */
    /* true: a block (tags read by one request) failed on a new connection while the unit was up. The result of the next block
       decides whether the block or the unit is to blame */
    bool doubted;
    enum register_table doubted_table;
    int doubted_first;
};

struct modbus_manners {       /* the device's manners: how it handles connections, stated in the plant file or learned from its behaviour */
    bool one_per_connection;  /* true: the device closes a connection after one answer */
    int64_t connect_delay_ns; /* delay in nanoseconds from connecting to the first request */
    /* nanoseconds during which the first request of a connection is repeated until it is answered; 0: it is sent once */
    int64_t first_wait_ns;
    int short_connections;  /* number of consecutive connections that the device closed after one answer */
    int silent_connections; /* number of consecutive connections without any answer while no unit of the source was up */
    /* unit whose request has just timed out, or NULL. A gateway may still wait for that unit, longer than our timeout, and accept no other
       request meanwhile */
    const struct modbus_unit *timed_out;
    /* true: a late first answer on this connection does not count against the unit, because the gateway may still be waiting for the
       unit `timed_out` */
    bool first_excused;
    /* Number of connections that the device, shortly after its last answer, refused or closed immediately: it needs a pause
       between connections. Each such connection doubles the time until the next attempt. */
    int failed_connections;
    bool ends_said;
    struct log_pace late_pace; /* rate limit of the log line about answers that come later than timeout_ms */
};

struct modbus_source {
    struct source base;
    counter *reads_ok, *reads_failed, *connects, *up, *host;
    struct modbus_link *link;
    /* --- below: members that only the source's thread uses */
    struct read_plan plan;
    /* true: the read plan has split blocks (requests), because the device refused some addresses or did not answer requests for them */
    bool plan_cut;
    struct modbus_unit *units;
    struct backoff backoff; /* backoff of connection attempts */
    int64_t connect_ns;     /* monotonic time before which the source makes no connection */
    int64_t asked_ns;       /* monotonic time at which the last request to the device ended */
    int64_t answered_ns;    /* monotonic time of the device's last answer */
    bool link_up;
    int fallen; /* number of Modbus units that have stopped answering since any unit of the source answered last */
    struct modbus_manners manners;
    struct log_pace pace;      /* rate limit of the log line that says that the source has no readings */
    bool loss_said;            /* true: the log says that the source has no readings, but not yet that they are back */
    struct log_pace unit_pace; /* rate limit of the log line about answers from a unit other than the one requested */
    bool *refused;             /* by index in plant->tags: true if the device refuses to read this tag */
    struct sample *samples;    /* buffer for samples on their way to the store, with room for one sample of each tag */
    int *lost;                 /* buffer for the indices of tags whose readings are lost, with room for all tags */
};

/* The gateway counts as lost if this many units stop answering one after the other, without an answer from any unit in between. */
enum { GATEWAY_UNITS = 3 };

/* Returns the Modbus unit (slave address) that a block of the read plan belongs to. */
struct modbus_unit *modbus_unit_of(const struct modbus_source *modbus, const struct read_plan_block *block);
/* Records that a unit answered. Logs this if the last log line said that the unit does not answer. */
void modbus_unit_is_up(struct modbus_source *modbus, struct modbus_unit *unit);
/* Returns the text for an error of modbus_link_open() or modbus_link_read(), for the log (static, or valid until strerror() is called
   again). status: -errno. */
const char *modbus_error_text(int status);
/* Records that a unit does not answer. The readings of its tags are lost (store_tags_lost()), and the unit gets no request
   before a backoff delay has passed. If GATEWAY_UNITS units have now failed without an answer in between, the readings of all
   units of the source are lost immediately. */
void modbus_unit_is_down(struct modbus_source *modbus, struct modbus_unit *unit, const char *why);
/* Opens the link if it is closed. Returns false if it is closed and cannot be opened now; modbus->connect_ns is then the time of the next
 * attempt. */
bool modbus_connect_link(struct modbus_source *modbus);

/* Initialises the device's manners (how it handles connections) from the plant file. */
void modbus_manners_init(struct modbus_source *modbus);
/* Prepares the connection for a request to a unit: sets how long to wait for the connection's first answer. */
void modbus_manners_before(struct modbus_source *modbus, const struct modbus_unit *unit);
/* Closes the connection after an answer, if the device accepts only one request per connection. */
void modbus_manners_after(struct modbus_source *modbus);
/* Learns from an answer how the device handles connections, for example how long its first answer takes. */
void modbus_manners_answered(struct modbus_source *modbus, const struct read_plan_block *block);
/* Logs, after a failed read, that the device answers later than timeout_ms. */
void modbus_manners_late(struct modbus_source *modbus);
/* Learns from a failed read (status < 0) how the device handles connections. Returns true if its way of handling them explains the
   failure: the block is then requested again on a new connection, from modbus->connect_ns on. */
bool modbus_manners_excuse_read(struct modbus_source *modbus, int status, bool unit_up);
/* Returns true if the way the device handles connections explains a failed connection attempt; the next attempt is then made at
 * modbus->connect_ns. */
bool modbus_manners_excuse_connect(struct modbus_source *modbus, int status);
/* Called when a block (tags read by one request) failed on a new connection while its unit was up. Returns true if another block of the
   unit is requested next, whose result tells whether the block or the whole unit is to blame. */
bool modbus_unit_doubt(struct modbus_source *modbus, struct modbus_unit *unit, size_t block);
/* Called when a block of the unit was answered. If another block had failed before (modbus_unit_doubt()), that block is to
   blame rather than the unit: the readings of its tags are lost. */
void modbus_unit_settle(struct modbus_source *modbus, struct modbus_unit *unit, const struct read_plan_block *answered);

/* Decodes the response to a block (tags read by one request) and writes the readings of its tags to the store. */
void modbus_take_values(struct modbus_source *modbus, struct read_plan_block *block, const uint16_t *words);
/* Returns true for exceptions with which a gateway reports that it cannot reach a unit. */
bool modbus_is_gateway_exception(int code);
/* Handles a Modbus exception (error response) to a block: retries a busy device, splits a refused block in two, and marks refused tags
   as Bad. */
void modbus_take_exception(struct modbus_source *modbus, size_t block, int code, int64_t now_ns);
/* Records that the device refuses a block's tags, or answers them again, and logs a change. Returns true if this changed for any tag. */
bool modbus_note_refused(struct modbus_source *modbus, const struct read_plan_block *block, bool refused, const char *why);
/* Returns the delay in nanoseconds before the next request for an address that was refused `before` consecutive times. */
int64_t modbus_refused_pause_ns(int before);
/* Rebuilds the read plan, including the addresses that the device has refused, because the device may have been repaired or replaced. */
void modbus_replan(struct modbus_source *modbus);

#endif
