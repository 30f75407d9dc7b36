/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A connection to a Modbus device: opens a TCP socket or serial line within a deadline, and closes it after any error. Uses libmodbus
   for RTU frames, and modbus_tcp.c for TCP frames. */
#include "value/modbus_link.h"

#include <errno.h>
#include <fcntl.h>
#include <modbus.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/lookup.h"
#include "value/modbus_tcp.h"
#include "value/read_plan.h"

static const int64_t SETTLE_NS = 50 * NS_PER_MS;
enum {
    /* Multiples of the source's timeout. LATEST: after this time, a device is unlikely to answer an abandoned request. QUIET:
       if late answers come even then, the line counts as cleared after this time without an answer. */
    LATEST_TIMEOUTS = 10,
    QUIET_TIMEOUTS = 5,
    DRAINED_ANSWERS = 10, /* number of discarded stray answers from which the line counts as noisy */
};

struct modbus_link {
    const struct plant_source *source;
    modbus_t *modbus; /* libmodbus context for RTU frames; NULL: the link uses TCP frames */
    uint16_t number;  /* transaction identifier of the last request, for TCP frames */
    int stop_fd;
    int null_fd;
    /* A low file descriptor that is reserved when the link is created; dup3() moves each connection into it. The daemon may
       have more than FD_SETSIZE files open, and select(), which libmodbus calls, cannot handle descriptors of FD_SETSIZE or
       higher. */
    int slot_fd;
    bool open;
    /* true (RTU frames only): the device may still answer an abandoned request, so the next answer may belong to that request */
    bool suspect;
    /* For RTU frames. asked_ns: monotonic time when the last request was sent. abandoned_ns: when the oldest request that may
       still be answered was sent; 0: none. late_ns: how long the device took to answer an abandoned request; 0: it answers in
       time */
    int64_t asked_ns, abandoned_ns, late_ns;
    int host;     /* index in source->hosts of the host that is used now */
    int answers;  /* number of requests on the present connection that the device has answered */
    bool any_unit;
    struct modbus_answered answered; /* transaction identifier and unit in the last response, for TCP frames */
    int64_t patience_ns;
    /* Monotonic times: opened_ns: when the connection was opened; sent_ns: when its first answered request was sent; first_answered_ns:
       when the answer to that request arrived. */
    int64_t opened_ns, sent_ns, first_answered_ns;
    struct lookup *lookup;
    struct sockaddr_storage last; /* address of the last connection; all zero: none */
    char name[300];
};

/* Creates a libmodbus context for RTU frames with 8 data bits, as RTU requires. This file opens the connection itself and passes its
   descriptor to libmodbus. */
static modbus_t *new_modbus(const struct plant_source *source)
{
    bool line = source->transport == TRANSPORT_RTU;
    modbus_t *modbus = modbus_new_rtu(line ? source->device : "/dev/null", source->baud, (char)source->parity, 8, source->stop_bits);
    if (!modbus)
        return NULL;
    modbus_set_response_timeout(modbus, (uint32_t)(source->timeout_ms / 1000), (uint32_t)(source->timeout_ms % 1000) * 1000);
    /* sets no timeout between bytes, because the response timeout limits the whole reply */
    modbus_set_byte_timeout(modbus, 0, 0);
    return modbus;
}

static void name_link(struct modbus_link *link)
{
    const struct plant_source *source = link->source;
    if (source->transport == TRANSPORT_RTU)
        snprintf(link->name, sizeof(link->name), "%s", source->device);
    else
        snprintf(link->name, sizeof(link->name), "%s:%d", source->hosts[link->host], source->port);
}

struct modbus_link *modbus_link_create(struct log *log, const struct plant_source *source, int stop_fd)
{
    struct modbus_link *link = mem_new(sizeof(*link));
    link->source = source;
    link->stop_fd = stop_fd;
    link->null_fd = open("/dev/null", O_RDWR | O_CLOEXEC);
    link->slot_fd = link->null_fd < 0 ? -1 : fcntl(link->null_fd, F_DUPFD_CLOEXEC, 0);
    if (link->slot_fd < 0 || link->slot_fd >= FD_SETSIZE) {
        log_err(
            log,
            "source %s: cannot connect, because all %d file descriptors that connections can use are in use: lower --limit connections=N",
            source->id, FD_SETSIZE);
        goto error;
    }
    bool framed = source->transport == TRANSPORT_TCP;
    if (!framed && !(link->modbus = new_modbus(source))) {
        log_err(log, "source %s: libmodbus: %s", source->id, modbus_strerror(errno));
        goto error;
    }
    if (link->modbus)
        modbus_set_socket(link->modbus, link->slot_fd);
    name_link(link);
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

const char *modbus_link_name(const struct modbus_link *link)
{
    return link->name;
}

int modbus_link_host(const struct modbus_link *link)
{
    return link->host;
}

static void close_link(struct modbus_link *link)
{
    if (link->open && link->source->transport == TRANSPORT_RTU) {
        ioctl(link->slot_fd, TIOCNXCL);
        link->suspect = true;
    }
    if (link->open)
        dup3(link->null_fd, link->slot_fd, O_CLOEXEC);
    link->open = false;
}

void modbus_link_close(struct modbus_link *link)
{
    close_link(link);
}

void modbus_link_allow_any_unit(struct modbus_link *link, bool any)
{
    link->any_unit = any;
}

int modbus_link_answered_unit(const struct modbus_link *link)
{
    return link->answered.unit;
}

void modbus_link_set_patience(struct modbus_link *link, int64_t patience_ns)
{
    link->patience_ns = patience_ns;
}

int modbus_link_answers(const struct modbus_link *link)
{
    return link->answers;
}

int64_t modbus_link_late_ns(const struct modbus_link *link)
{
    return link->late_ns;
}

int64_t modbus_link_first_ns(const struct modbus_link *link, int64_t *answered_ns)
{
    *answered_ns = link->first_answered_ns - link->opened_ns;
    return link->sent_ns - link->opened_ns;
}

bool modbus_link_next_host(struct modbus_link *link)
{
    int count = link->source->transport == TRANSPORT_RTU ? 1 : link->source->host_count;
    close_link(link);
    if (count > 1)
        lookup_destroy(&link->lookup);
    link->host = (link->host + 1) % count;
    name_link(link);
    return link->host == 0;
}

/* --- opening ---------------------------------------------------------------------------------------------------------------- */

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

/* Tries the addresses of a host in turn until one accepts the connection; each gets an equal share of the remaining time. Begins with
   the address of the last connection, so that an address that never answers costs time only once. found: list of the addresses. */
static int connect_in_turn(struct modbus_link *link, const struct addrinfo *found, int64_t deadline_ns, int *out_fd)
{
    const struct addrinfo *to = found;
    int status = -EHOSTUNREACH, left = 0;
    for (const struct addrinfo *at = found; at; at = at->ai_next, left++)
        if (memcmp(at->ai_addr, &link->last, at->ai_addrlen) == 0)
            to = at;
    for (; left > 0 && status != 0 && status != -ECANCELED; left--) {
        int64_t now_ns = clock_mono_ns();
        status = connect_one(to, link->stop_fd, now_ns + (deadline_ns - now_ns) / left, out_fd);
        if (status == 0)
            memcpy(&link->last, to->ai_addr, to->ai_addrlen);
        to = to->ai_next ? to->ai_next : found;
    }
    return status;
}

static int connect_any(struct modbus_link *link, int64_t deadline_ns, int *out_fd)
{
    const struct addrinfo *found = NULL;
    if (!link->lookup)
        link->lookup = lookup_start(link->source->hosts[link->host], link->source->port);
    int status = lookup_wait(link->lookup, link->stop_fd, deadline_ns, &found);
    /* the system's resolver has not answered yet; link->lookup is kept, so that the next attempt to connect waits for the same
       answer */
    if (status == -ETIMEDOUT)
        return status;
    if (status == 0)
        status = connect_in_turn(link, found, deadline_ns, out_fd);
    lookup_destroy(&link->lookup); /* resolves the host name again for each connection, because addresses change */
    return status;
}

/* Opens the serial line with exclusive access. libmodbus sets the line's speed and parity and remembers the previous settings. Returns 0
   or -errno. */
static int open_line(struct modbus_link *link, int *out_fd)
{
    if (modbus_connect(link->modbus) != 0) {
        modbus_set_socket(link->modbus, link->slot_fd);
        return -errno;
    }
    *out_fd = modbus_get_socket(link->modbus);
    modbus_set_socket(link->modbus, link->slot_fd);
    ioctl(*out_fd, TIOCEXCL);
    return 0;
}

int modbus_link_open(struct modbus_link *link)
{
    int fd = -1, status;
    if (link->source->transport == TRANSPORT_RTU)
        status = open_line(link, &fd);
    else
        status = connect_any(link, clock_mono_ns() + link->source->timeout_ms * NS_PER_MS, &fd);
    if (status)
        return status;
    if (dup3(fd, link->slot_fd, O_CLOEXEC) < 0)
        status = -errno;
    close(fd);
    link->open = status == 0;
    link->answers = 0;
    link->opened_ns = clock_mono_ns();
    /* checks stop_fd a second time: a call of modbus_link_interrupt() before the socket was in its reserved descriptor could
       not end this connection */
    if (link->open && wait_for(-1, 0, link->stop_fd, 0) == -ECANCELED) {
        close_link(link);
        status = -ECANCELED;
    }
    return status;
}

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

/* Discards received bytes that belong to no request, such as a duplicate reply or noise. modbus_flush() does not do this for RTU frames
   over a socket. Returns false if the device has closed the connection meanwhile. */
static bool flush(struct modbus_link *link)
{
    uint8_t bytes[512];
    ssize_t got = 1;
    if (link->source->transport == TRANSPORT_RTU)
        return tcflush(link->slot_fd, TCIOFLUSH), true;
    for (int i = 0; got > 0 && i < 64; i++)
        got = recv(link->slot_fd, bytes, sizeof(bytes), MSG_DONTWAIT);
    return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

static int read_bits(modbus_t *modbus, enum register_table table, int first, int count, uint16_t *words)
{
    uint8_t bits[READ_PLAN_MAX_BITS];
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

/* Maps a result of libmodbus to 0, a Modbus exception code or -errno. count: number of values that were requested. */
static int status_of(int got, int count)
{
    int cause = errno;
    if (got == count)
        return 0;
    if (got < 0 && cause > MODBUS_ENOBASE && cause < MODBUS_ENOBASE + MODBUS_EXCEPTION_MAX)
        return cause - MODBUS_ENOBASE;
    return got < 0 && cause > 0 && cause < MODBUS_ENOBASE ? -cause : -EPROTO;
}

/* Sends a request in TCP frames and receives its answer. The first request of a connection is repeated until it is answered or
   patience_ns have passed. Some devices drop requests that come soon after connecting, others take long for their first answer.
   The answer to any of the repeated requests is accepted. */
static int ask_framed(struct modbus_link *link, const struct modbus_question *question, uint16_t *words)
{
    struct modbus_question numbered = *question;
    int status;
    numbered.any_unit = link->any_unit;
    numbered.oldest = (uint16_t)(link->number + 1);
    int64_t begin_ns = clock_mono_ns(), timeout_ns = link->source->timeout_ms * NS_PER_MS;
    do {
        numbered.number = ++link->number;
        status = modbus_tcp_ask(link->slot_fd, link->stop_fd, clock_mono_ns() + timeout_ns, &numbered, words, &link->answered);
    } while (status == -ETIMEDOUT && link->answers == 0 && !link->answered.began && clock_mono_ns() < begin_ns + link->patience_ns);
    if (link->answers == 0) /* computes when the answered copy of the repeated request was sent: copies are sent one timeout apart */
        link->sent_ns = begin_ns + (uint16_t)(link->answered.number - numbered.oldest) * timeout_ns;
    return status;
}

/* Sends a request and reads its response. Returns 0, a Modbus exception code, or -errno. */
static int ask(struct modbus_link *link, const struct modbus_question *question, uint16_t *words)
{
    enum register_table table = question->table;
    if (!flush(link))
        return -ECONNRESET;
    if (!link->modbus)
        return ask_framed(link, question, words);
    link->asked_ns = clock_mono_ns();
    bool bits = table == TABLE_COIL || table == TABLE_DISCRETE;
    int got = bits ? read_bits(link->modbus, table, question->first, question->count, words)
                   : read_words(link->modbus, table, question->first, question->count, words);
    return status_of(got, question->count);
}

/* Discards answers until none has arrived for quiet_ns. Returns how many arrived; DRAINED_ANSWERS: the line is still not quiet. */
static int drain(struct modbus_link *link, int64_t quiet_ns)
{
    int count = 0;
    while (count < DRAINED_ANSWERS && wait_for(link->slot_fd, POLLIN, link->stop_fd, clock_mono_ns() + quiet_ns) == 0) {
        wait_for(-1, 0, link->stop_fd, clock_mono_ns() + SETTLE_NS); /* waits a moment, because an answer may arrive in several pieces */
        if (!flush(link))
            break;
        count++;
    }
    return count;
}

/* Discards the answers to abandoned requests: RTU frames have no transaction numbers, so such an answer could be taken for the
   answer to the next request. Sends a request, discards its answer, and waits until the line is quiet. The discarded answer may
   have been the one to the oldest abandoned request. The device then takes as long for each of the others. Returns false if the
   device does not answer. */
static bool clear_line(struct modbus_link *link, const struct modbus_question *question, uint16_t *words)
{
    int64_t timeout_ns = link->source->timeout_ms * NS_PER_MS, quiet_ns = timeout_ns;
    if (ask(link, question, words) == -ETIMEDOUT)
        return false;
    int64_t late_ns = link->abandoned_ns ? clock_mono_ns() - link->abandoned_ns : 0;
    if (late_ns > LATEST_TIMEOUTS * timeout_ns)
        quiet_ns = QUIET_TIMEOUTS * timeout_ns;
    else if (late_ns + late_ns / 4 > quiet_ns)
        quiet_ns = late_ns + late_ns / 4;
    int late = drain(link, quiet_ns);
    if (late > 0 && late_ns > timeout_ns)
        link->late_ns = late_ns;
    link->suspect = late == DRAINED_ANSWERS;
    if (!link->suspect)
        link->abandoned_ns = 0;
    return !link->suspect;
}

/* Records that the last request, in RTU frames, was abandoned without an answer. cleared: clear_line() was called before that
   request. The missing answer then need not come late: unless late answers were seen, the device may answer only one request
   per connection. */
static void abandon(struct modbus_link *link, bool cleared)
{
    if (!link->abandoned_ns)
        link->abandoned_ns = link->asked_ns;
    link->suspect |= !cleared || link->late_ns > 0;
}

/* Called after an answer with the transaction number of another request (a late or duplicate answer). Waits SETTLE_NS for more stray
 * answers, then repeats the request. A second wrong answer makes the caller disconnect. */
static int ask_again(struct modbus_link *link, const struct modbus_question *question, uint16_t *words)
{
    wait_for(-1, 0, link->stop_fd, clock_mono_ns() + SETTLE_NS);
    return ask(link, question, words);
}

/* Selects the Modbus unit for the next requests. Returns false if its number is invalid. Valid numbers are 0 to 247; over TCP also 255,
   which means the device at the IP address itself. */
static bool can_ask_unit(struct modbus_link *link, int unit)
{
    return link->modbus ? modbus_set_slave(link->modbus, unit) == 0 : (unit >= 0 && unit <= 247) || unit == 255;
}

int modbus_link_read(struct modbus_link *link, int unit, enum register_table table, int first, int count, uint16_t *words)
{
    const struct modbus_question question = { .unit = (uint8_t)unit, .table = table, .first = first, .count = count };
    if (!can_ask_unit(link, unit))
        return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    int status = -ETIMEDOUT;
    bool was_suspect = link->suspect, cleared = was_suspect && clear_line(link, &question, words);
    if (!was_suspect || cleared)
        status = ask(link, &question, words);
    if (status == -EBADMSG)
        status = ask_again(link, &question, words);
    if (status >= 0 && link->answers++ == 0)
        link->first_answered_ns = clock_mono_ns();
    if (status >= 0)
        link->late_ns = 0;
    /* marks the request as abandoned: a serial device server may send its late answer over the next connection */
    if (link->modbus && (status == -ETIMEDOUT || status == -EPROTO))
        abandon(link, cleared);
    /* waits for the late answer, only to measure how late it is */
    if (link->modbus && status == -ETIMEDOUT && wait_for(link->slot_fd, POLLIN, link->stop_fd, link->asked_ns + link->patience_ns) == 0 &&
        flush(link))
        link->late_ns = clock_mono_ns() - link->asked_ns;
    if (status < 0)
        close_link(link);
    return status == -EBADMSG ? -EPROTO : status;
}

void modbus_link_interrupt(struct modbus_link *link)
{
    shutdown(link->slot_fd, SHUT_RDWR);
}
