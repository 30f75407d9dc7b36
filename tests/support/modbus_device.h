/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus device for tests, on TCP, RTU over TCP or a pseudo terminal: a libmodbus server on its own thread, which can be told
   to misbehave. Holding register r has the value r. */
#ifndef TESTS_MODBUS_DEVICE_H
#define TESTS_MODBUS_DEVICE_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum device_manner {
    DEVICE_GOOD,
    DEVICE_SILENT,      /* accepts requests and never answers */
    DEVICE_DRIPPING,    /* sends one byte every 0.3 s */
    DEVICE_LATE,        /* answers late_ms late, on the same connection; with DEVICE_RTU_TCP on the newest connection */
    DEVICE_TWICE,       /* sends, late_ms after each right answer, a second answer with the same transaction number and wrong values */
    DEVICE_BEHIND,      /* sends, before each right answer, another one with the previous request's transaction number and wrong values */
    DEVICE_RESETTING,   /* accepts a request, then resets the connection */
    DEVICE_SHORT,       /* sends the answer without its last byte */
    DEVICE_LONG,        /* sends an answer with more values than requested */
    DEVICE_GARBAGE,     /* sends random bytes */
    DEVICE_FOREIGN,     /* answers with another unit's number and that unit's values */
    DEVICE_MEASURED,    /* answers with wrong values, and a header that states said_length instead of the true length */
    DEVICE_RENAMED,     /* answers with right values but the unit number said_unit */
};
enum device_wire { DEVICE_TCP, DEVICE_RTU_TCP, DEVICE_LINE };
#define DEVICE_WRONG_VALUE 0x7777

struct modbus_device { /* tests may set the following members before the start or while the device runs */
    _Atomic int manner, late_ms;
    _Atomic int bad_register, bad_code;  /* requests that include bad_register are answered with the exception bad_code; 0: none are */
    _Atomic int bad_times;               /* only this many requests get bad_code; 0: all */
    _Atomic int said_length;             /* length that the answers of DEVICE_MEASURED state */
    _Atomic int said_unit;               /* unit number that the answers of DEVICE_RENAMED state */
    /* number of answers after which the connection is closed or, with `hushes`, gets no more answers; 0: unlimited */
    _Atomic int answers_per_connection;
    _Atomic bool hushes, resets;         /* resets: resets connections instead of closing them */
    _Atomic int deaf_ms;                 /* ignores requests that arrive within this time after the connection was made */
    _Atomic int first_late_ms;           /* delay of a connection's first answer */
    _Atomic int away_ms;                 /* refuses connections for this long after one has ended */
    _Atomic int idle_ms;                 /* closes a connection that was idle for this long; 0: never */
    _Atomic int mute_register;           /* register; requests for it are never answered; 0: none */
    _Atomic int dead_unit;               /* unit; requests to it get exception 11 (target failed to respond); -1: all units; 0: none */
    _Atomic int dead_late_ms;            /* delay of that exception; meanwhile the device answers nobody */
    _Atomic int silent_unit;             /* unit that never answers; 0: none */
    _Atomic int requests, refused, connections;
    _Atomic int functions;               /* function codes requested so far: bit f stands for code f */
    _Atomic int most;                    /* largest number of registers or bits in one request so far */
    /* last_ns: time just before the last answer; least_gap_ns: shortest time so far between an answer and the next request; 0: there was
       none */
    _Atomic int64_t last_ns, least_gap_ns;
    enum device_wire wire;               /* transport; set it before the start; with RTU the device is unit 1 only */
    const char *address;                 /* address to listen on; NULL: 127.0.0.1 */
    int port;                            /* port to listen on; 0: device_start() chooses one */
    char line[64];                       /* output: path of DEVICE_LINE's terminal */
    struct device_thread *thread;
};

void device_start(struct modbus_device *device);
void device_stop(struct modbus_device *device); /* closes all connections; the device may be started again */

#endif
