/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus TCP device for tests: a libmodbus server on a thread, which can be told to misbehave. Holding register r holds r. */
#ifndef TESTS_MODBUS_DEVICE_H
#define TESTS_MODBUS_DEVICE_H
#include <stdatomic.h>

enum device_manner {
    DEVICE_GOOD,
    DEVICE_SILENT,      /* takes requests, never answers */
    DEVICE_DRIPPING,    /* one byte each 0.3 s */
    DEVICE_LATE,        /* answers after late_ms, on the same connection */
    DEVICE_TWICE,       /* each answer is followed by one with its own number again and wrong values */
    DEVICE_BEHIND,      /* each answer is preceded by one with the number of the request before and wrong values */
    DEVICE_RESETTING,   /* takes a request, then resets the connection */
};
#define DEVICE_WRONG_VALUE 0x7777

struct device { /* set what you like before or while it runs */
    _Atomic int manner, late_ms;
    _Atomic int bad_register, bad_code;  /* a request for this register is refused with this exception; code 0: none */
    _Atomic int dead_unit;               /* refused with exception 11; 0: none */
    _Atomic int silent_unit;             /* not answered; 0: none */
    _Atomic int requests, refused, connections;
    _Atomic int functions;               /* bit f: function code f was asked for */
    int port;                            /* 0: device_start chooses one */
    struct device_thread *thread;
};

/* A free port at which nothing listens. */
int device_free_port(void);
void device_start(struct device *device);
void device_stop(struct device *device); /* connections are closed; may be started again */

#endif
