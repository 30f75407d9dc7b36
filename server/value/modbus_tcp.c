/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends read requests and receives their responses in Modbus TCP frames. */
#include "value/modbus_tcp.h"

#include <errno.h>
#include <poll.h>
#include <sys/socket.h>

#include "value/lookup.h"
#include "value/read_plan.h"

enum {
    HEADER_BYTES = 7, /* length in bytes of the frame header: transaction identifier, protocol, length of the rest, unit */
    REFUSED = 0x80,   /* bit of a response's function code that marks an exception (error) response */
    LAST_EXCEPTION = 11,
    /* maximum number of bytes of values in a response: two per register; READ_PLAN_MAX_BITS bits take as many */
    MAX_VALUE_BYTES = 2 * READ_PLAN_MAX_REGISTERS,
};

static uint8_t function_of(enum register_table table)
{
    switch (table) {
    case TABLE_COIL: return 1;
    case TABLE_DISCRETE: return 2;
    case TABLE_INPUT: return 4;
    default: return 3;
    }
}

static bool is_bits(enum register_table table)
{
    return table == TABLE_COIL || table == TABLE_DISCRETE;
}

static void put_word(uint8_t *at, int word)
{
    at[0] = (uint8_t)(word >> 8);
    at[1] = (uint8_t)word;
}

static int get_word(const uint8_t *at)
{
    return at[0] << 8 | at[1];
}

static int send_all(int fd, int stop_fd, int64_t deadline_ns, const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        ssize_t sent = send(fd, bytes, count, MSG_NOSIGNAL | MSG_DONTWAIT);
        int status = sent >= 0 || errno == EINTR ? 0 : errno == EAGAIN ? wait_for(fd, POLLOUT, stop_fd, deadline_ns) : -errno;
        if (status)
            return status;
        bytes += sent > 0 ? sent : 0;
        count -= sent > 0 ? (size_t)sent : 0;
    }
    return 0;
}

static int receive_all(int fd, int stop_fd, int64_t deadline_ns, uint8_t *bytes, size_t count, bool *began)
{
    while (count > 0) {
        int status = wait_for(fd, POLLIN, stop_fd, deadline_ns);
        if (status)
            return status;
        ssize_t got = recv(fd, bytes, count, MSG_DONTWAIT);
        if (got == 0)
            return -ECONNRESET;
        if (got < 0 && errno != EINTR && errno != EAGAIN)
            return -errno;
        *began |= got > 0;
        bytes += got > 0 ? got : 0;
        count -= got > 0 ? (size_t)got : 0;
    }
    return 0;
}

/* Returns the number of bytes that the values in the response to a request must take. */
static int value_bytes(const struct modbus_question *question)
{
    return is_bits(question->table) ? (question->count + 7) / 8 : 2 * question->count;
}

/* Returns true if a response may state this unit. Unit identifiers 0 and 255 mean the device at the IP address itself (MODBUS
   Messaging on TCP/IP V1.0b, 4.4.1.2). Many devices that are not gateways answer with one of these, regardless of the unit
   requested. */
static bool fits_unit(const struct modbus_question *question, uint8_t unit)
{
    bool itself = unit == 0 || unit == 255 || question->unit == 0 || question->unit == 255;
    return unit == question->unit || (question->any_unit && itself);
}

static int check_header(const struct modbus_question *question, const uint8_t *header)
{
    int length = get_word(header + 4);
    if (get_word(header + 2) != 0 || length < 3 || length > 3 + MAX_VALUE_BYTES)
        return -EPROTO;
    if ((uint16_t)(question->number - get_word(header)) > (uint16_t)(question->number - question->oldest))
        return -EBADMSG;
    bool sized = length == 3 || length == 3 + value_bytes(question);
    return sized && fits_unit(question, header[6]) ? 0 : -EPROTO;
}

/* Checks and decodes a response to a request. length: number of bytes from the function code on. Returns 0, a Modbus exception code, or
   -errno. */
static int take_answer(const struct modbus_question *question, const uint8_t *answer, int length, uint16_t *words)
{
    int function = function_of(question->table);
    if (length == 2 && answer[0] == (function | REFUSED) && answer[1] >= 1 && answer[1] <= LAST_EXCEPTION)
        return answer[1];
    if (answer[0] != function || length != 2 + value_bytes(question) || answer[1] != value_bytes(question))
        return -EPROTO;
    for (int i = 0; i < question->count; i++)
        words[i] = is_bits(question->table) ? answer[2 + i / 8] >> i % 8 & 1 : (uint16_t)get_word(answer + 2 + 2 * i);
    return 0;
}

int modbus_tcp_ask(int fd, int stop_fd, int64_t deadline_mono_ns, const struct modbus_question *question, uint16_t *words,
                   struct modbus_answered *answered)
{
    uint8_t asked[HEADER_BYTES + 5] = { 0 }, header[HEADER_BYTES], answer[2 + MAX_VALUE_BYTES];
    *answered = (struct modbus_answered){ 0 };
    put_word(asked, question->number);
    put_word(asked + 4, 6);
    asked[6] = question->unit;
    asked[7] = function_of(question->table);
    put_word(asked + 8, question->first);
    put_word(asked + 10, question->count);
    int status = send_all(fd, stop_fd, deadline_mono_ns, asked, sizeof(asked));
    if (!status)
        status = receive_all(fd, stop_fd, deadline_mono_ns, header, sizeof(header), &answered->began);
    if (!status)
        status = check_header(question, header);
    if (status)
        return status;
    answered->number = (uint16_t)get_word(header);
    answered->unit = header[6];
    int length = get_word(header + 4) - 1;
    status = receive_all(fd, stop_fd, deadline_mono_ns, answer, (size_t)length, &answered->began);
    return status ? status : take_answer(question, answer, length, words);
}
