/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of a Modbus source: its thread (modbus.c), which units answer (modbus_units.c), how the device wants its
   connections (modbus_manners.c), and what is done with a response (modbus_answers.c). Thread: the source's own. */
#ifndef VALUE_MODBUS_IMPL_H
#define VALUE_MODBUS_IMPL_H
#include "base/log/log_pace.h"
#include "value/backoff.h"
#include "value/modbus_link.h"
#include "value/read_plan.h"
#include "value/source_impl.h"

enum unit_state { UNIT_UNKNOWN, UNIT_UP, UNIT_DOWN };

struct modbus_unit { /* a device behind the address; a gateway or a serial line has several */
    int id;
    enum unit_state state;
    struct backoff backoff;
    int64_t retry_ns;
    struct log_pace pace, busy_pace;
    bool loss_said; /* the log has a line that it does not answer, and none since that it does */
    bool doubted;   /* a block failed on a new connection; the next block decides whether the block or the unit is to blame */
    enum register_table doubted_table;
    int doubted_first;
};

struct modbus_manners {       /* how the device wants its connections: as the plant file says, or as found out */
    bool one_per_connection;  /* it ends a connection after one answer */
    int64_t connect_delay_ns; /* between connecting and the first request */
    int64_t first_wait_ns;    /* the first request of a connection is repeated for so long; 0: it is answered like others */
    int short_connections;    /* in a row: ended by the device after one answer */
    int silent_connections;   /* in a row: no answer at all while no unit was up */
    /* The unit that timed out just now, or NULL: a gateway may wait for it longer than we did, before it takes requests for others. */
    const struct modbus_unit *timed_out;
    bool first_excused; /* the first answer of this connection may be late for that reason */
    int failed_connections;   /* in a row: refused or closed at once, right after a connection that answered */
    bool ends_said;
};

struct modbus_source {
    struct source base;
    counter *reads_ok, *reads_failed, *connects, *up, *host;
    struct modbus_link *link;
    /* --- below: used by the source's thread only */
    struct read_plan plan;
    bool plan_cut; /* blocks were split around addresses that the device refused */
    struct modbus_unit *units;
    struct backoff backoff; /* of connecting */
    int64_t connect_ns;     /* do not connect before */
    int64_t asked_ns;       /* when the last request ended */
    int64_t answered_ns;    /* when the last answer came */
    bool link_up;
    struct modbus_manners manners;
    struct log_pace pace;      /* of "no readings" */
    bool loss_said;            /* the log has a line that there are no readings, and none since that there are */
    struct log_pace unit_pace; /* of answers that name another unit */
    bool *refused;             /* by index in plant->tags: the device refuses to read it */
    struct sample *samples;    /* room for all tags */
    int *lost;                 /* room for the numbers of all tags */
};

/* Returns the unit that a block is read from. */
struct modbus_unit *modbus_unit_of(const struct modbus_source *modbus, const struct read_plan_block *block);
/* Records that a unit answered; logs it if it had not before. */
void modbus_unit_is_up(struct modbus_source *modbus, struct modbus_unit *unit);
/* Records that a unit does not answer: its tags lose their link, and it is left alone for a while. */
void modbus_unit_is_down(struct modbus_source *modbus, struct modbus_unit *unit, const char *why);
/* Opens the link if it is closed. Returns false if it cannot be opened now; connect_ns says when to try again. */
bool modbus_connect_link(struct modbus_source *modbus);

/* Begins with what the plant file says. */
void modbus_manners_init(struct modbus_source *modbus);
/* Prepares the link for a request to a unit: sets how long a first answer may take. */
void modbus_manners_before(struct modbus_source *modbus, const struct modbus_unit *unit);
/* Ends the connection after an answer, where the device wants one request per connection. */
void modbus_manners_after(struct modbus_source *modbus);
/* Learns from an answer. */
void modbus_manners_answered(struct modbus_source *modbus, const struct read_plan_block *block);
/* Learns from a read that failed with status < 0. Returns true if that is no verdict: the block is to be asked again on a new connection,
   from connect_ns on. */
bool modbus_manners_excuse_read(struct modbus_source *modbus, int status, bool unit_up);
/* The same for a connection that could not be made. */
bool modbus_manners_excuse_connect(struct modbus_source *modbus, int status);
/* A block failed on a connection of its own while its unit was up. Returns true if another block is asked before anyone is blamed. */
bool modbus_unit_doubt(struct modbus_source *modbus, struct modbus_unit *unit, size_t block);
/* A block of the unit was answered: if another one was in doubt, that one is to blame and its tags lose their link. */
void modbus_unit_settle(struct modbus_source *modbus, struct modbus_unit *unit, const struct read_plan_block *answered);

/* Decodes the response to a block and writes its tags to the store. */
void modbus_take_values(struct modbus_source *modbus, struct read_plan_block *block, const uint16_t *words);
/* Handles a Modbus exception: retries a busy device, splits a refused block, and marks refused tags as Bad. */
void modbus_take_exception(struct modbus_source *modbus, size_t block, int code, int64_t now_ns);
/* Logs and records that a block's tags are refused, or are read again. Returns whether that was news for some tag. */
bool modbus_note_refused(struct modbus_source *modbus, const struct read_plan_block *block, bool refused, const char *why);
/* Returns how long an address that was refused `before` times in a row is left alone. */
int64_t modbus_refused_pause_ns(int before);
/* Makes the read plan anew, with the addresses that were refused before: a device may have been repaired or replaced. */
void modbus_replan(struct modbus_source *modbus);

#endif
