/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A listening TCP port and its clients. Collects the bytes of each client until they are a complete message. Call from one thread only. */
#ifndef DEMO_SIM_PORT_H
#define DEMO_SIM_PORT_H
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum { SIM_PORT_CLIENTS = 64, SIM_PORT_BYTES = 1024 };

struct sim_client {
    int fd;
    uint8_t bytes[SIM_PORT_BYTES];
    size_t count;
};

/* Handles the message at the start of `bytes`. Returns its length, 0 if it is not complete yet, or -1 to close the connection. */
typedef ssize_t sim_take(void *arg, int fd, const uint8_t *bytes, size_t count);

struct sim_port {
    int fd; /* listening socket; -1: not open */
    sim_take *take;
    void *arg;
    struct sim_client clients[SIM_PORT_CLIENTS];
    size_t client_count;
};

/* Opens a port. Returns 0, or -errno if it cannot listen there. */
int sim_port_open(struct sim_port *port, const char *address, int number, sim_take *take, void *arg);
void sim_port_close(struct sim_port *port);
/* Serves all ports until timeout_ms has passed or extra_fd is readable. Returns 1 if extra_fd is readable, else 0. */
int sim_ports_serve(struct sim_port *ports, size_t count, int extra_fd, int timeout_ms);

#endif
