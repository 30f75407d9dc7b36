/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simulates a Modbus device for tests. On request it misbehaves in the ways in which real devices do. */
#include "modbus_device.h"

#include <modbus.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <pty.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"

enum { MAX_CLIENTS = 8, REGISTERS = 2000 };

struct device_thread {
    pthread_t thread;
    struct modbus_device *device;
    modbus_t *modbus;
    modbus_mapping_t *mapping, *wrong;
    int listen_fd, stop_fd;
    /* file descriptor of the pseudo terminal's slave end (DEVICE_LINE); kept open because the terminal is lost when nobody has
       that end open */
    int line_fd;
    int header;  /* number of bytes in a request before the function code; the last of these bytes is the unit number */
    int clients[MAX_CLIENTS];
    struct {
        int64_t since_ns, heard_ns;
        int answers;
    } of[MAX_CLIENTS]; /* state of the client with the same index in clients[] */
    size_t client_count;
    int64_t away_until_ns;
};

static void must(bool condition, const char *what)
{
    if (condition)
        return;
    perror(what);
    abort();
}

static int bound_port(int fd)
{
    struct sockaddr_in at;
    socklen_t bytes = sizeof(at);
    must(getsockname(fd, (struct sockaddr *)&at, &bytes) == 0, "getsockname");
    return ntohs(at.sin_port);
}

static void drop_client(struct device_thread *t, size_t index, bool reset)
{
    struct linger linger = { .l_onoff = 1 };
    if (reset)
        setsockopt(t->clients[index], SOL_SOCKET, SO_LINGER, &linger, sizeof(linger));
    close(t->clients[index]);
    t->of[index] = t->of[--t->client_count];
    t->clients[index] = t->clients[t->client_count];
    if (t->device->away_ms) { /* stops listening for away_ms, so that new connections are refused */
        t->away_until_ns = clock_mono_ns() + t->device->away_ms * NS_PER_MS;
        close(t->listen_fd);
        t->listen_fd = -1;
    }
}

static bool stopped_within(struct device_thread *t, int ms)
{
    struct pollfd stop = { .fd = t->stop_fd, .events = POLLIN };
    return poll(&stop, 1, ms) > 0;
}

/* Stores in `reply` the answer to a request that libmodbus would send. libmodbus can only write to a socket, so the function
   passes it one end of a socket pair. Returns the number of bytes. */
static int catch_reply(struct device_thread *t, const uint8_t *request, int bytes, modbus_mapping_t *mapping, uint8_t *reply)
{
    int pair[2], fd = modbus_get_socket(t->modbus);
    must(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) == 0, "socketpair");
    modbus_set_socket(t->modbus, pair[0]);
    modbus_reply(t->modbus, request, bytes, mapping);
    modbus_set_socket(t->modbus, fd);
    ssize_t got = recv(pair[1], reply, MODBUS_TCP_MAX_ADU_LENGTH, MSG_DONTWAIT);
    close(pair[0]);
    close(pair[1]);
    return got > 0 ? (int)got : 0;
}

static void drip(struct device_thread *t, int fd, const uint8_t *request, int bytes)
{
    uint8_t reply[MODBUS_TCP_MAX_ADU_LENGTH];
    int count = catch_reply(t, request, bytes, t->mapping, reply);
    for (int i = 0; i < count && !stopped_within(t, 300); i++)
        if (write(fd, reply + i, 1) != 1)
            break;
}

/* Sends an answer with wrong values. Over TCP, it has the transaction number of the request that came `behind` requests
   earlier. */
static void reply_wrong(struct device_thread *t, int fd, const uint8_t *request, int bytes, int behind)
{
    uint8_t reply[MODBUS_TCP_MAX_ADU_LENGTH];
    int count = catch_reply(t, request, bytes, t->wrong, reply);
    int number = ((reply[0] << 8) + reply[1] - behind) & 0xFFFF;
    if (t->device->wire == DEVICE_TCP) {
        reply[0] = (uint8_t)(number >> 8);
        reply[1] = (uint8_t)number;
    }
    (void)!write(fd, reply, (size_t)count); /* the client may have closed the connection */
}

/* Stores in `reply` an answer that appears to come from another unit (slave number); over RTU, the checksum matches that
   number. Returns the number of bytes. */
static int catch_foreign(struct device_thread *t, const uint8_t *request, int bytes, uint8_t *reply)
{
    uint8_t foreign[MODBUS_TCP_MAX_ADU_LENGTH];
    memcpy(foreign, request, (size_t)bytes);
    foreign[t->header - 1] ^= 7;
    modbus_set_slave(t->modbus, foreign[t->header - 1]);
    int count = catch_reply(t, foreign, bytes, t->wrong, reply);
    modbus_set_slave(t->modbus, request[t->header - 1]);
    return count;
}

/* Sends an answer that is corrupted in the way that `manner` selects, such as shortened or from another unit. */
static void reply_spoilt(struct device_thread *t, int fd, const uint8_t *request, int bytes, int manner)
{
    uint8_t reply[MODBUS_TCP_MAX_ADU_LENGTH];
    int count = manner == DEVICE_FOREIGN ? catch_foreign(t, request, bytes, reply)
                                         : catch_reply(t, request, bytes, manner == DEVICE_MEASURED ? t->wrong : t->mapping, reply);
    if (manner == DEVICE_SHORT)
        count--;
    if (manner == DEVICE_LONG)
        reply[t->header + 1] = (uint8_t)(reply[t->header + 1] + 2);
    if (manner == DEVICE_RENAMED)
        reply[t->header - 1] = (uint8_t)t->device->said_unit;
    if (manner == DEVICE_MEASURED) {
        reply[4] = (uint8_t)(t->device->said_length >> 8);
        reply[5] = (uint8_t)t->device->said_length;
    }
    for (int i = 0; i < count && manner == DEVICE_GARBAGE; i++)
        reply[i] = (uint8_t)rand();
    (void)!write(fd, reply, (size_t)count);
}

/* Updates the device's statistics: the shortest pause between an answer and the next request, and the numbers of registers
   requested. */
static void note_request(struct device_thread *t, const uint8_t *request)
{
    struct modbus_device *device = t->device;
    int64_t gap_ns = clock_mono_ns() - device->last_ns;
    int count = request[t->header + 3] << 8 | request[t->header + 4];
    if (device->last_ns && (!device->least_gap_ns || gap_ns < device->least_gap_ns))
        device->least_gap_ns = gap_ns;
    if (count > device->most)
        device->most = count;
    atomic_fetch_add(&device->requests, 1);
    atomic_fetch_or(&device->functions, 1 << (request[t->header] & 31));
}

static bool asks_for(const uint8_t *request, int header, int wanted)
{
    int first = request[header + 1] << 8 | request[header + 2], count = request[header + 3] << 8 | request[header + 4];
    return wanted >= first && wanted < first + count;
}

static void refuse(struct device_thread *t, const uint8_t *request, int code)
{
    atomic_fetch_add(&t->device->refused, 1);
    modbus_reply_exception(t->modbus, request, (unsigned)code);
}

/* Simulates devices that do not answer new connections for a while, or that fail after some time or number of answers. Returns
   whether the device answers now. */
static bool answers_at_its_age(struct device_thread *t, size_t index)
{
    struct modbus_device *device = t->device;
    int64_t now_ns = clock_mono_ns();
    if (now_ns - t->of[index].since_ns < device->deaf_ms * NS_PER_MS)
        return false;
    if (device->hushes && device->answers_per_connection && t->of[index].answers >= device->answers_per_connection)
        return false;
    return t->of[index].answers++ > 0 || !device->first_late_ms || !stopped_within(t, device->first_late_ms);
}

static void accept_client(struct device_thread *t)
{
    t->of[t->client_count].since_ns = t->of[t->client_count].heard_ns = clock_mono_ns();
    t->of[t->client_count].answers = 0;
    t->clients[t->client_count++] = accept4(t->listen_fd, NULL, NULL, SOCK_CLOEXEC);
    atomic_fetch_add(&t->device->connections, 1);
}

/* Makes the newest connection receive the answer. A serial device server behaves like this: it forwards all bytes of its serial
   line to the connection that was opened last. */
static void turn_to_newest(struct device_thread *t)
{
    struct pollfd pending = { .fd = t->listen_fd, .events = POLLIN };
    while (t->client_count < MAX_CLIENTS && poll(&pending, 1, 0) > 0)
        accept_client(t);
    modbus_set_socket(t->modbus, t->clients[t->client_count - 1]);
}

/* Answers a request as the device's `manner` says. Returns false if the caller shall reset the connection. */
static bool answer(struct device_thread *t, int fd, const uint8_t *request, int bytes)
{
    struct modbus_device *device = t->device;
    int unit = request[t->header - 1], manner = device->manner;
    note_request(t, request);
    if (manner == DEVICE_RESETTING)
        return false;
    if (device->mute_register && asks_for(request, t->header, device->mute_register))
        return true;
    if (manner == DEVICE_SILENT || (device->silent_unit && unit == device->silent_unit))
        return true;
    if (device->dead_unit && (unit == device->dead_unit || device->dead_unit == -1)) {
        if (device->dead_late_ms && stopped_within(t, device->dead_late_ms))
            return true;
        refuse(t, request, MODBUS_EXCEPTION_GATEWAY_TARGET);
        return true;
    }
    if (device->bad_code && asks_for(request, t->header, device->bad_register)) {
        refuse(t, request, device->bad_code);
        if (device->bad_times && atomic_fetch_sub(&device->bad_times, 1) == 1)
            device->bad_code = 0;
        return true;
    }
    if (manner == DEVICE_DRIPPING) {
        drip(t, fd, request, bytes);
        return true;
    }
    if (manner >= DEVICE_SHORT) {
        reply_spoilt(t, fd, request, bytes, manner);
        return true;
    }
    if (manner == DEVICE_LATE && stopped_within(t, device->late_ms))
        return true;
    if (manner == DEVICE_LATE && device->wire == DEVICE_RTU_TCP)
        turn_to_newest(t);
    if (manner == DEVICE_BEHIND)
        reply_wrong(t, fd, request, bytes, 1);
    /* taken before the answer is sent: taken after it, the time is late if the thread waits for a processor in between, and the rest
       that the client keeps seems too short */
    device->last_ns = clock_mono_ns();
    modbus_reply(t->modbus, request, bytes, t->mapping);
    if (manner == DEVICE_TWICE && !stopped_within(t, device->late_ms))
        reply_wrong(t, fd, request, bytes, 0);
    return true;
}

static void serve(struct device_thread *t, size_t index)
{
    uint8_t request[MODBUS_TCP_MAX_ADU_LENGTH];
    modbus_set_socket(t->modbus, t->clients[index]);
    if (t->device->wire != DEVICE_TCP)
        modbus_set_slave(t->modbus, 1);
    int bytes = modbus_receive(t->modbus, request);
    if (bytes < 0 && t->line_fd >= 0)
        tcflush(t->clients[index], TCIOFLUSH);
    else if (bytes < 0)
        drop_client(t, index, false);
    else if (bytes > 0) {
        t->of[index].heard_ns = clock_mono_ns();
        bool answers = answers_at_its_age(t, index), last = t->of[index].answers == t->device->answers_per_connection;
        if (!answers)
            note_request(t, request);
        else if (!answer(t, t->clients[index], request, bytes))
            drop_client(t, index, true);
        else if (last && t->device->answers_per_connection && !t->device->hushes)
            drop_client(t, index, t->device->resets);
    }
}

static void open_socket(struct device_thread *t)
{
    modbus_t *listener = modbus_new_tcp(t->device->address ? t->device->address : "127.0.0.1", t->device->port);
    t->listen_fd = modbus_tcp_listen(listener, MAX_CLIENTS);
    must(t->listen_fd >= 0, "modbus_tcp_listen");
    t->device->port = bound_port(t->listen_fd);
    modbus_free(listener);
}

/* Closes connections that were idle for idle_ms, and begins to listen again when away_ms is over. */
static void tend(struct device_thread *t)
{
    int64_t now_ns = clock_mono_ns();
    for (size_t i = t->client_count; t->device->idle_ms && i-- > 0;)
        if (now_ns - t->of[i].heard_ns > t->device->idle_ms * NS_PER_MS)
            drop_client(t, i, false);
    if (t->listen_fd < 0 && now_ns >= t->away_until_ns)
        open_socket(t);
}

static void *device_main(void *arg)
{
    struct device_thread *t = arg;
    for (;;) {
        tend(t);
        struct pollfd fds[2 + MAX_CLIENTS] = { { .fd = t->stop_fd, .events = POLLIN }, { .fd = t->listen_fd, .events = POLLIN } };
        size_t count = t->client_count;
        for (size_t i = 0; i < count; i++)
            fds[2 + i] = (struct pollfd){ .fd = t->clients[i], .events = POLLIN };
        poll(fds, (nfds_t)(2 + count), t->listen_fd < 0 || t->device->idle_ms ? 10 : -1);
        if (fds[0].revents)
            return NULL;
        for (size_t i = count; i-- > 0;)
            if (fds[2 + i].revents)
                serve(t, i);
        struct pollfd pending = { .fd = t->listen_fd, .events = POLLIN };
        if (fds[1].revents && t->client_count < MAX_CLIENTS && poll(&pending, 1, 0) > 0)
            accept_client(t);
    }
}

/* Opens a pseudo terminal as the serial line; its master end takes the place of the only client. */
static void open_line(struct device_thread *t)
{
    struct termios raw = { 0 };
    /* a descriptor that never becomes readable instead of a listening socket, because a serial line has no further clients */
    t->listen_fd = eventfd(0, EFD_CLOEXEC);
    cfmakeraw(&raw);
    must(openpty(&t->clients[0], &t->line_fd, t->device->line, &raw, NULL) == 0, "openpty");
    t->client_count = 1;
}

void device_start(struct modbus_device *device)
{
    struct device_thread *t = mem_new(sizeof(*t));
    t->device = device;
    signal(SIGPIPE, SIG_IGN); /* without this, writing an answer to a client that has closed its connection would end the process */
    t->line_fd = -1;
    t->header = device->wire == DEVICE_TCP ? 7 : 1;
    t->modbus = device->wire == DEVICE_TCP ? modbus_new_tcp("127.0.0.1", 502) : modbus_new_rtu("/dev/null", 9600, 'N', 8, 1);
    if (device->wire == DEVICE_LINE)
        open_line(t);
    else
        open_socket(t);
    t->mapping = modbus_mapping_new(REGISTERS, REGISTERS, REGISTERS, REGISTERS);
    t->wrong = modbus_mapping_new(REGISTERS, REGISTERS, REGISTERS, REGISTERS);
    for (int i = 0; i < REGISTERS; i++) {
        t->mapping->tab_registers[i] = (uint16_t)i;
        t->mapping->tab_input_registers[i] = (uint16_t)(10000 + i);
        t->mapping->tab_bits[i] = i % 3 == 0;
        t->mapping->tab_input_bits[i] = i % 3 == 1;
        t->wrong->tab_registers[i] = DEVICE_WRONG_VALUE;
    }
    t->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    device->thread = t;
    must(pthread_create(&t->thread, NULL, device_main, t) == 0, "pthread_create");
}

void device_stop(struct modbus_device *device)
{
    struct device_thread *t = device->thread;
    eventfd_write(t->stop_fd, 1);
    pthread_join(t->thread, NULL);
    while (t->client_count)
        /* closes connections with RST instead of FIN, so that none stays in TIME_WAIT and the port can be reused at once */
        drop_client(t, 0, true);
    if (t->listen_fd >= 0)
        close(t->listen_fd);
    if (t->line_fd >= 0)
        close(t->line_fd);
    close(t->stop_fd);
    modbus_free(t->modbus);
    modbus_mapping_free(t->mapping);
    modbus_mapping_free(t->wrong);
    mem_free(t);
    device->thread = NULL;
}
