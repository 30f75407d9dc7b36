/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A minimal WebSocket client for a daemon's stream: RFC 6455 without extensions. */
#include "raw_websocket.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/mem.h"
#include "protocol/wire.h"

/* fixed handshake key and its accept value, from the example in RFC 6455 */
static const char KEY[] = "dGhlIHNhbXBsZSBub25jZQ==", ACCEPT[] = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";
enum { OP_TEXT = 1, OP_BINARY = 2, OP_CLOSE = 8, OP_PING = 9, OP_PONG = 10, MAX_HEAD_BYTES = 4096, MAX_TEXT_BYTES = 16 << 20 };

struct raw_websocket {
    int fd;
    enum { ASKING, ASKED, OPEN } state;
    char request[1024];
    struct text head;     /* status line and headers of the server's HTTP response */
    unsigned char in[10]; /* header of the current WebSocket frame; in_count bytes have arrived */
    size_t in_count;
    bool in_payload, final;
    int opcode;         /* opcode of the current frame */
    size_t left;        /* payload bytes still to come */
    bool binary, begun; /* binary: the current message is binary; begun: its first frame has arrived */
    struct text message, control;
    size_t count; /* number of bytes of the current message that have arrived */
};

/* --- connecting ---------------------------------------------------------------------------------------------------------------- */

static int open_socket(const struct daemon_url *url, const char **why)
{
    struct addrinfo hints = { .ai_socktype = SOCK_STREAM }, *found = NULL;
    char port[16];
    int fd = -1, on = 1;
    snprintf(port, sizeof(port), "%d", url->port);
    int error = getaddrinfo(url->host, port, &hints, &found);
    if (error) {
        *why = gai_strerror(error);
        return -1;
    }
    for (struct addrinfo *at = found; at && fd < 0; at = at->ai_next) {
        fd = socket(at->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
        if (fd >= 0 && connect(fd, at->ai_addr, at->ai_addrlen) != 0 && errno != EINPROGRESS) {
            close(fd);
            fd = -1;
        }
    }
    freeaddrinfo(found);
    if (fd < 0)
        *why = strerror(errno);
    else
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    return fd;
}

struct raw_websocket *raw_websocket_connect(const struct daemon_url *url, const char **why)
{
    const char *authorization = url->access->authorization;
    bool six = strchr(url->host, ':') != NULL;
    int fd = open_socket(url, why);
    if (fd < 0)
        return NULL;
    struct raw_websocket *raw = mem_new(sizeof(*raw));
    raw->fd = fd;
    snprintf(raw->request, sizeof(raw->request),
             "GET %s/stream HTTP/1.1\r\nHost: %s%s%s:%d\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: %s\r\n"
             "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: %s\r\n%s%s%s\r\n",
             url->base, six ? "[" : "", url->host, six ? "]" : "", url->port, KEY, WIRE_SUBPROTOCOL,
             *authorization ? "Authorization: " : "", authorization, *authorization ? "\r\n" : "");
    return raw;
}

/* Sends all bytes. Returns false if they do not fit into the socket's send buffer, which is rare because messages are short. */
static bool send_all(const struct raw_websocket *raw, const void *bytes, size_t count)
{
    return send(raw->fd, bytes, count, MSG_NOSIGNAL) == (ssize_t)count;
}

static bool send_frame(const struct raw_websocket *raw, int opcode, const char *bytes, size_t count)
{
    unsigned char out[1024 + 8];
    size_t head = count < 126 ? 6 : 8;
    if (count > sizeof(out) - head)
        return false;
    out[0] = (unsigned char)(0x80 | opcode);
    out[1] = (unsigned char)(0x80 | (count < 126 ? count : 126));
    if (count >= 126) {
        out[2] = (unsigned char)(count >> 8);
        out[3] = (unsigned char)count;
    }
    /* RFC 6455 requires clients to mask payloads by XOR, to protect HTTP caches; a mask of zeros complies and leaves the data unchanged */
    memset(out + head - 4, 0, 4);
    memcpy(out + head, bytes, count);
    return send_all(raw, out, head + count);
}

bool raw_websocket_send(struct raw_websocket *raw, const char *text, size_t count)
{
    return send_frame(raw, OP_TEXT, text, count);
}

/* --- receiving ------------------------------------------------------------------------------------------------------------------- */

/* Like recv(), but returns 0 if no data is available and -1 with *why if the connection has ended. bytes NULL: reads and drops the data. */
static ssize_t take(const struct raw_websocket *raw, void *bytes, size_t count, const char **why)
{
    ssize_t got = recv(raw->fd, bytes, count, bytes ? 0 : MSG_TRUNC);
    if (got > 0)
        return got;
    if (got < 0 && (errno == EAGAIN || errno == EINTR))
        return 0;
    *why = got == 0 ? "the daemon closed the connection" : strerror(errno);
    return -1;
}

/* Reads the HTTP response byte by byte, because any bytes after its end belong to WebSocket frames. Returns 0, with raw->state
   OPEN once the response is complete; or a negative number with *why. */
static int read_head(struct raw_websocket *raw, const char **why)
{
    char byte;
    for (ssize_t got; (got = take(raw, &byte, 1, why)) != 0;) {
        if (got < 0)
            return -1;
        text_add_bytes(&raw->head, &byte, 1);
        if (raw->head.length >= 4 && !memcmp(raw->head.at + raw->head.length - 4, "\r\n\r\n", 4))
            break;
        if (raw->head.length > MAX_HEAD_BYTES)
            break;
    }
    if (raw->head.length < 4 || memcmp(raw->head.at + raw->head.length - 4, "\r\n\r\n", 4) != 0)
        return raw->head.length > MAX_HEAD_BYTES
                   ? (*why = "the server does not accept WebSockets at this URL: its response header is too long", -1)
                   : 0;
    if (strncmp(raw->head.at, "HTTP/1.1 101", 12) != 0 || !strstr(raw->head.at, ACCEPT)) {
        raw->head.at[strcspn(raw->head.at, "\r\n")] = 0;
        *why = raw->head.at;
        return -1;
    }
    raw->state = OPEN;
    return 0;
}

static size_t header_bytes(const struct raw_websocket *raw)
{
    int length = raw->in_count < 2 ? 0 : raw->in[1] & 127;
    return length < 126 ? 2 : length == 126 ? 4 : 10;
}

static void begin_payload(struct raw_websocket *raw)
{
    raw->final = (raw->in[0] & 0x80) != 0;
    raw->opcode = raw->in[0] & 15;
    raw->left = raw->in_count == 2 ? raw->in[1] & 127 : 0;
    for (size_t i = 2; i < raw->in_count; i++)
        raw->left = raw->left << 8 | raw->in[i];
    raw->in_count = 0;
    raw->in_payload = true;
    if (raw->opcode != OP_TEXT && raw->opcode != OP_BINARY)
        return;
    raw->binary = raw->opcode == OP_BINARY;
    raw->message.length = raw->count = 0;
}

/* Reads the header of a WebSocket frame. Returns > 0 once the header is complete, 0 if no more data is available now, or -1 with *why if
   the connection has ended. */
static ssize_t read_frame_header(struct raw_websocket *raw, const char **why)
{
    while (raw->in_count < header_bytes(raw)) {
        ssize_t got = take(raw, raw->in + raw->in_count, header_bytes(raw) - raw->in_count, why);
        if (got <= 0)
            return got;
        raw->in_count += (size_t)got;
    }
    begin_payload(raw);
    return 1;
}

/* Reads a part of a WebSocket frame's payload. Returns the number of bytes read, 0 if no data is available now, or -1 with *why if the
   connection has ended or the message is too long. */
static ssize_t read_payload(struct raw_websocket *raw, const char **why)
{
    char bytes[64 * 1024];
    bool control = raw->opcode >= OP_CLOSE;
    struct text *into = control ? &raw->control : &raw->message;
    size_t keep = control || !raw->binary                   ? raw->left
                  : into->length < RAW_WEBSOCKET_KEPT_BYTES ? RAW_WEBSOCKET_KEPT_BYTES - into->length
                                                            : 0;
    if (into->length + keep > MAX_TEXT_BYTES) {
        *why = "the daemon sent a message of more than 64 MiB, the most that this program accepts";
        return -1;
    }
    size_t count = keep > 0 && keep < raw->left ? keep : raw->left;
    if (keep > 0 && count > sizeof(bytes))
        count = sizeof(bytes);
    ssize_t got = take(raw, keep > 0 ? bytes : NULL, count, why);
    if (got > 0 && keep > 0)
        text_add_bytes(into, bytes, (size_t)got);
    if (got > 0) {
        raw->left -= (size_t)got;
        raw->count += control ? 0 : (size_t)got;
    }
    return got;
}

/* Handles a control frame (close, ping, pong). Returns false if it closes the connection. */
static bool on_control(struct raw_websocket *raw, const char **why)
{
    const char *bytes = raw->control.at ? raw->control.at : "";
    if (raw->opcode == OP_PING)
        send_frame(raw, OP_PONG, bytes, raw->control.length);
    if (raw->opcode == OP_CLOSE)
        *why = raw->control.length > 2 ? bytes + 2 : "the daemon closed the connection";
    raw->control.length = 0;
    return raw->opcode != OP_CLOSE;
}

int raw_websocket_read(struct raw_websocket *raw, struct raw_websocket_message *message, const char **why)
{
    if (raw->state == ASKING) {
        if (!send_all(raw, raw->request, strlen(raw->request)))
            return errno == ENOTCONN || errno == EAGAIN ? 0 : (*why = strerror(errno), -1);
        raw->state = ASKED;
    }
    if (raw->state == ASKED && read_head(raw, why) < 0)
        return -1;
    while (raw->state == OPEN) {
        ssize_t got = raw->in_payload ? 1 : read_frame_header(raw, why);
        while (got > 0 && raw->left > 0)
            got = read_payload(raw, why);
        if (got <= 0)
            return got < 0 ? -1 : 0;
        raw->in_payload = false;
        if (raw->opcode >= OP_CLOSE) {
            if (!on_control(raw, why))
                return -1;
        } else if (raw->final) {
            const char *at = raw->message.at ? raw->message.at : "";
            *message = (struct raw_websocket_message){ .binary = raw->binary, .count = raw->count, .at = at };
            return 1;
        }
    }
    return 0;
}

/* --- creating and destroying ------------------------------------------------------------------------------------------------------- */

bool raw_websocket_is_open(const struct raw_websocket *raw)
{
    return raw->state == OPEN;
}

int raw_websocket_fd(const struct raw_websocket *raw)
{
    return raw->fd;
}

void raw_websocket_destroy(struct raw_websocket **raw_websocket_ptr)
{
    struct raw_websocket *raw = *raw_websocket_ptr;
    if (!raw)
        return;
    if (raw->state == OPEN)
        send_frame(raw, OP_CLOSE, "\x03\xe8", 2);
    close(raw->fd);
    text_finish(&raw->head);
    text_finish(&raw->message);
    text_finish(&raw->control);
    mem_free(raw);
    *raw_websocket_ptr = NULL;
}
