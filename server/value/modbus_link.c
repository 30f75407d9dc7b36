/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libmodbus over a socket of ours: connected with a deadline, thrown away after any error. */
#include "value/modbus_link.h"

#include <errno.h>
#include <fcntl.h>
#include <modbus.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/lookup.h"
#include "value/plan.h"

struct modbus_link {
    const struct plant_source *source;
    modbus_t *modbus;
    int stop_fd;
    int null_fd;
    int slot_fd;   /* taken early and kept for life, the connection is put into it: libmodbus calls select(), whose sets end at
                      FD_SETSIZE, while the daemon may hold more files than that by the time of a reconnect */
    bool open;
    struct lookup *lookup;
};

static modbus_t *new_modbus(int timeout_ms, int fd)
{
    modbus_t *modbus = modbus_new_tcp("127.0.0.1", MODBUS_TCP_DEFAULT_PORT); /* never connects: it is given a socket */
    if (!modbus)
        return NULL;
    modbus_set_response_timeout(modbus, (uint32_t)(timeout_ms / 1000), (uint32_t)(timeout_ms % 1000) * 1000);
    modbus_set_byte_timeout(modbus, 0, 0); /* off: the response timeout is for the whole reply, not anew for each byte */
    modbus_set_socket(modbus, fd);
    return modbus;
}

struct modbus_link *modbus_link_create(struct log *log, const struct plant_source *source, int stop_fd)
{
    struct modbus_link *link = mem_new(sizeof(*link));
    link->source = source;
    link->stop_fd = stop_fd;
    link->null_fd = open("/dev/null", O_RDWR | O_CLOEXEC);
    link->slot_fd = link->null_fd < 0 ? -1 : fcntl(link->null_fd, F_DUPFD_CLOEXEC, 0);
    if (link->slot_fd < 0 || link->slot_fd >= FD_SETSIZE) {
        log_err(log, "source %s: no file descriptor below %d is free", source->id, FD_SETSIZE);
        goto error;
    }
    link->modbus = new_modbus(source->timeout_ms, link->slot_fd);
    if (!link->modbus) {
        log_err(log, "source %s: libmodbus: %s", source->id, modbus_strerror(errno));
        goto error;
    }
    return link;
error:
    modbus_link_destroy(&link);
    return NULL;
}

void modbus_link_destroy(struct modbus_link **link_ptr)
{
    struct modbus_link *link = *link_ptr;
    if (!link)
        return;
    if (link->modbus)
        modbus_free(link->modbus);
    if (link->slot_fd >= 0)
        close(link->slot_fd);
    if (link->null_fd >= 0)
        close(link->null_fd);
    lookup_destroy(&link->lookup);
    mem_free(link);
    *link_ptr = NULL;
}

bool modbus_link_is_open(const struct modbus_link *link)
{
    return link->open;
}

void modbus_link_close(struct modbus_link *link)
{
    if (link->open)
        dup3(link->null_fd, link->slot_fd, O_CLOEXEC);
    link->open = false;
}

static int finish_connect(int fd, int stop_fd, int64_t deadline_ns)
{
    int status = wait_for(fd, POLLOUT, stop_fd, deadline_ns), cause = 0;
    socklen_t bytes = sizeof(cause);
    if (status)
        return status;
    if (getsockopt(fd, SOL_SOCKET, SO_ERROR, &cause, &bytes) != 0)
        return -errno;
    return -cause;
}

static int connect_one(const struct addrinfo *to, int stop_fd, int64_t deadline_ns, int *out_fd)
{
    int status = 0, on = 1;
    int fd = socket(to->ai_family, to->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, to->ai_protocol);
    if (fd < 0)
        return -errno;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    if (connect(fd, to->ai_addr, to->ai_addrlen) != 0)
        status = errno == EINPROGRESS ? finish_connect(fd, stop_fd, deadline_ns) : -errno;
    if (status)
        close(fd);
    else
        *out_fd = fd;
    return status;
}

static int connect_any(struct modbus_link *link, int64_t deadline_ns, int *out_fd)
{
    const struct addrinfo *to = NULL;
    if (!link->lookup)
        link->lookup = lookup_start(link->source->host, link->source->port);
    int status = lookup_wait(link->lookup, link->stop_fd, deadline_ns, &to);
    if (status == -ETIMEDOUT) /* the resolver hangs: the next attempt waits on for the same answer */
        return status;
    for (; to; to = to->ai_next) {
        status = connect_one(to, link->stop_fd, deadline_ns, out_fd);
        if (status == 0 || status == -ECANCELED)
            break;
    }
    lookup_destroy(&link->lookup); /* asked anew each time: addresses change */
    return status;
}

int modbus_link_open(struct modbus_link *link)
{
    int fd = -1;
    int status = connect_any(link, clock_mono_ns() + link->source->timeout_ms * NS_PER_MS, &fd);
    if (status)
        return status;
    if (dup3(fd, link->slot_fd, O_CLOEXEC) < 0)
        status = -errno;
    close(fd);
    link->open = status == 0;
    if (link->open && wait_for(-1, 0, link->stop_fd, 0) == -ECANCELED) { /* interrupted before it was in its slot */
        modbus_link_close(link);
        status = -ECANCELED;
    }
    return status;
}

static int read_bits(modbus_t *modbus, enum register_table table, int first, int count, uint16_t *words)
{
    uint8_t bits[PLAN_MAX_BITS];
    int got = table == TABLE_COIL ? modbus_read_bits(modbus, first, count, bits) : modbus_read_input_bits(modbus, first, count, bits);
    for (int i = 0; i < got; i++)
        words[i] = bits[i];
    return got;
}

static int read_words(modbus_t *modbus, enum register_table table, int first, int count, uint16_t *words)
{
    return table == TABLE_INPUT ? modbus_read_input_registers(modbus, first, count, words)
                                : modbus_read_registers(modbus, first, count, words);
}

int modbus_link_read(struct modbus_link *link, int unit, enum register_table table, int first, int count, uint16_t *words)
{
    bool bits = table == TABLE_COIL || table == TABLE_DISCRETE;
    if (modbus_set_slave(link->modbus, unit) != 0)
        return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE; /* libmodbus asks units 0..247 and 255 */
    modbus_flush(link->modbus); /* a reply sent twice */
    int got = bits ? read_bits(link->modbus, table, first, count, words) : read_words(link->modbus, table, first, count, words);
    int cause = errno;
    if (got == count)
        return 0;
    if (got < 0 && cause > MODBUS_ENOBASE && cause < MODBUS_ENOBASE + MODBUS_EXCEPTION_MAX)
        return cause - MODBUS_ENOBASE;
    modbus_link_close(link);
    return got < 0 && cause > 0 && cause < MODBUS_ENOBASE ? -cause : -EPROTO;
}

void modbus_link_interrupt(struct modbus_link *link)
{
    shutdown(link->slot_fd, SHUT_RDWR);
}
