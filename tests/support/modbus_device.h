/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus device for tests, on TCP, RTU over TCP or a pseudo terminal: a libmodbus server on a thread, which can be told to
   misbehave. Holding register r holds r. */
#ifndef TESTS_MODBUS_DEVICE_H
#define TESTS_MODBUS_DEVICE_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum device_manner {
    DEVICE_GOOD,
    DEVICE_SILENT,      /* takes requests, never answers */
    DEVICE_DRIPPING,    /* one byte each 0.3 s */
    DEVICE_LATE,        /* answers after late_ms, on the same connection */
    DEVICE_TWICE,       /* each answer is followed, after late_ms, by one with its own number again and wrong values */
    DEVICE_BEHIND,      /* each answer is preceded by one with the number of the request before and wrong values */
    DEVICE_RESETTING,   /* takes a request, then resets the connection */
    DEVICE_SHORT,       /* all but the last byte of the answer */
    DEVICE_LONG,        /* an answer that says it has more values than were asked for */
    DEVICE_GARBAGE,     /* random bytes */
    DEVICE_FOREIGN,     /* the answer of another unit, with its values */
    DEVICE_MEASURED,    /* wrong values in an answer whose header says that it is said_length long */
    DEVICE_RENAMED,     /* the right answer, but it names said_unit */
};
enum device_wire { DEVICE_TCP, DEVICE_RTU_TCP, DEVICE_LINE };
#define DEVICE_WRONG_VALUE 0x7777

struct modbus_device { /* set what you like before or while it runs */
    _Atomic int manner, late_ms;
    _Atomic int bad_register, bad_code;  /* a request for this register is refused with this exception; code 0: none */
    _Atomic int bad_times;               /* so often, then no more; 0: always */
    _Atomic int said_length;             /* of DEVICE_MEASURED */
    _Atomic int said_unit;               /* of DEVICE_RENAMED */
    _Atomic int answers_per_connection;  /* then closes, or with `hushes` falls silent; 0: any number */
    _Atomic bool hushes, resets;         /* resets: in place of closing */
    _Atomic int deaf_ms;                 /* drops what comes sooner after connecting */
    _Atomic int first_late_ms;           /* so long for the first answer of a connection */
    _Atomic int away_ms;                 /* refuses connections for so long after one has ended */
    _Atomic int idle_ms;                 /* closes a connection without a request for so long; 0: never */
    _Atomic int mute_register;           /* a request for it is never answered; 0: none */
    _Atomic int dead_unit;               /* refused with exception 11; 0: none */
    _Atomic int dead_late_ms;            /* after so long, in which the device answers nobody */
    _Atomic int silent_unit;             /* not answered; 0: none */
    _Atomic int requests, refused, connections;
    _Atomic int functions;               /* bit f: function code f was asked for */
    _Atomic int most;                    /* registers or bits asked for at a time */
    _Atomic int64_t last_ns, least_gap_ns; /* between an answer and the next request; least_gap_ns 0: not yet known */
    enum device_wire wire;               /* before it starts; RTU knows unit 1 only */
    const char *address;                 /* to listen at; NULL: 127.0.0.1 */
    int port;                            /* 0: device_start chooses one */
    char line[64];                       /* out: the terminal of DEVICE_LINE */
    struct device_thread *thread;
};

void device_start(struct modbus_device *device);
void device_stop(struct modbus_device *device); /* connections are closed; may be started again */

#endif
