/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A WebSocket client that knows no more than a daemon's stream needs: RFC 6455 without extensions. */
#include "bare.h"

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

/* The nonce of RFC 6455's own example, and its answer. */
static const char KEY[] = "dGhlIHNhbXBsZSBub25jZQ==", ACCEPT[] = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";
enum { OP_TEXT = 1, OP_BINARY = 2, OP_CLOSE = 8, OP_PING = 9, OP_PONG = 10, MAX_HEAD_BYTES = 4096, MAX_TEXT_BYTES = 16 << 20 };

struct bare {
    int fd;
    enum { ASKING, ASKED, OPEN } state;
    char request[1024];
    struct text head;     /* of the server's answer */
    unsigned char in[10]; /* of a frame's header, so far */
    size_t in_count;
    bool in_payload, final;
    int opcode;           /* of the frame */
    size_t left;          /* of its payload */
    bool binary, begun;   /* the message that it belongs to */
    struct text message, control;
    size_t count;         /* of the message's bytes so far */
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

struct bare *bare_connect(const struct daemon_url *url, const char **why)
{
    const char *authorization = daemon_authorization();
    bool six = strchr(url->host, ':') != NULL;
    int fd = open_socket(url, why);
    if (fd < 0)
        return NULL;
    struct bare *bare = mem_new(sizeof(*bare));
    bare->fd = fd;
    snprintf(bare->request, sizeof(bare->request),
             "GET /stream HTTP/1.1\r\nHost: %s%s%s:%d\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: %s\r\n"
             "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: %s\r\n%s%s%s\r\n",
             six ? "[" : "", url->host, six ? "]" : "", url->port, KEY, WIRE_SUBPROTOCOL, authorization ? "Authorization: " : "",
             authorization ? authorization : "", authorization ? "\r\n" : "");
    return bare;
}

/* Whole or not at all: what is said is short. */
static bool send_all(const struct bare *bare, const void *bytes, size_t count)
{
    return send(bare->fd, bytes, count, MSG_NOSIGNAL) == (ssize_t)count;
}

static bool send_frame(const struct bare *bare, int opcode, const char *bytes, size_t count)
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
    memset(out + head - 4, 0, 4); /* a mask of zeros: nothing to be hidden from a cache on the way */
    memcpy(out + head, bytes, count);
    return send_all(bare, out, head + count);
}

bool bare_say(struct bare *bare, const char *text, size_t count)
{
    return send_frame(bare, OP_TEXT, text, count);
}

/* --- what comes ------------------------------------------------------------------------------------------------------------------ */

/* As read(), but 0 for nothing yet, and -1 for the end. bytes NULL: dropped. */
static ssize_t take(const struct bare *bare, void *bytes, size_t count, const char **why)
{
    ssize_t got = recv(bare->fd, bytes, count, bytes ? 0 : MSG_TRUNC);
    if (got > 0)
        return got;
    if (got < 0 && (errno == EAGAIN || errno == EINTR))
        return 0;
    *why = got == 0 ? "the daemon closed the connection" : strerror(errno);
    return -1;
}

/* The answer to the request, a byte at a time: what follows is no part of it. */
static int read_head(struct bare *bare, const char **why)
{
    char byte;
    for (ssize_t got; (got = take(bare, &byte, 1, why)) != 0;) {
        if (got < 0)
            return -1;
        text_add_bytes(&bare->head, &byte, 1);
        if (bare->head.length >= 4 && !memcmp(bare->head.at + bare->head.length - 4, "\r\n\r\n", 4))
            break;
        if (bare->head.length > MAX_HEAD_BYTES)
            break;
    }
    if (bare->head.length < 4 || memcmp(bare->head.at + bare->head.length - 4, "\r\n\r\n", 4) != 0)
        return bare->head.length > MAX_HEAD_BYTES ? (*why = "no WebSocket answers there", -1) : 0;
    if (strncmp(bare->head.at, "HTTP/1.1 101", 12) != 0 || !strstr(bare->head.at, ACCEPT)) {
        bare->head.at[strcspn(bare->head.at, "\r\n")] = 0;
        *why = bare->head.at;
        return -1;
    }
    bare->state = OPEN;
    return 0;
}

static size_t header_bytes(const struct bare *bare)
{
    int length = bare->in_count < 2 ? 0 : bare->in[1] & 127;
    return length < 126 ? 2 : length == 126 ? 4 : 10;
}

static void begin_payload(struct bare *bare)
{
    bare->final = (bare->in[0] & 0x80) != 0;
    bare->opcode = bare->in[0] & 15;
    bare->left = bare->in_count == 2 ? bare->in[1] & 127 : 0;
    for (size_t i = 2; i < bare->in_count; i++)
        bare->left = bare->left << 8 | bare->in[i];
    bare->in_count = 0;
    bare->in_payload = true;
    if (bare->opcode != OP_TEXT && bare->opcode != OP_BINARY)
        return;
    bare->binary = bare->opcode == OP_BINARY;
    bare->message.length = bare->count = 0;
}

/* As take(); above 0: it is complete. */
static ssize_t read_frame_header(struct bare *bare, const char **why)
{
    while (bare->in_count < header_bytes(bare)) {
        ssize_t got = take(bare, bare->in + bare->in_count, header_bytes(bare) - bare->in_count, why);
        if (got <= 0)
            return got;
        bare->in_count += (size_t)got;
    }
    begin_payload(bare);
    return 1;
}

/* As take(). */
static ssize_t read_payload(struct bare *bare, const char **why)
{
    static char bytes[64 * 1024];
    bool control = bare->opcode >= OP_CLOSE;
    struct text *into = control ? &bare->control : &bare->message;
    size_t keep = control || !bare->binary ? bare->left : into->length < BARE_KEPT_BYTES ? BARE_KEPT_BYTES - into->length : 0;
    if (into->length + keep > MAX_TEXT_BYTES) {
        *why = "a message without end";
        return -1;
    }
    size_t count = keep > 0 && keep < bare->left ? keep : bare->left;
    if (keep > 0 && count > sizeof(bytes))
        count = sizeof(bytes);
    ssize_t got = take(bare, keep > 0 ? bytes : NULL, count, why);
    if (got > 0 && keep > 0)
        text_add_bytes(into, bytes, (size_t)got);
    if (got > 0) {
        bare->left -= (size_t)got;
        bare->count += control ? 0 : (size_t)got;
    }
    return got;
}

/* False: it was the last. */
static bool on_control(struct bare *bare, const char **why)
{
    const char *bytes = bare->control.at ? bare->control.at : "";
    if (bare->opcode == OP_PING)
        send_frame(bare, OP_PONG, bytes, bare->control.length);
    if (bare->opcode == OP_CLOSE)
        *why = bare->control.length > 2 ? bytes + 2 : "the daemon closed the connection";
    bare->control.length = 0;
    return bare->opcode != OP_CLOSE;
}

int bare_read(struct bare *bare, struct bare_message *message, const char **why)
{
    if (bare->state == ASKING) {
        if (!send_all(bare, bare->request, strlen(bare->request)))
            return errno == ENOTCONN || errno == EAGAIN ? 0 : (*why = strerror(errno), -1);
        bare->state = ASKED;
    }
    if (bare->state == ASKED && read_head(bare, why) < 0)
        return -1;
    while (bare->state == OPEN) {
        ssize_t got = bare->in_payload ? 1 : read_frame_header(bare, why);
        while (got > 0 && bare->left > 0)
            got = read_payload(bare, why);
        if (got <= 0)
            return got < 0 ? -1 : 0;
        bare->in_payload = false;
        if (bare->opcode >= OP_CLOSE) {
            if (!on_control(bare, why))
                return -1;
        } else if (bare->final) {
            const char *at = bare->message.at ? bare->message.at : "";
            *message = (struct bare_message){ .binary = bare->binary, .count = bare->count, .at = at };
            return 1;
        }
    }
    return 0;
}

/* --- life -------------------------------------------------------------------------------------------------------------------------- */

bool bare_is_open(const struct bare *bare)
{
    return bare->state == OPEN;
}

int bare_fd(const struct bare *bare)
{
    return bare->fd;
}

void bare_destroy(struct bare **bare_ptr)
{
    struct bare *bare = *bare_ptr;
    if (!bare)
        return;
    if (bare->state == OPEN)
        send_frame(bare, OP_CLOSE, "\x03\xe8", 2);
    close(bare->fd);
    text_finish(&bare->head);
    text_finish(&bare->message);
    text_finish(&bare->control);
    mem_free(bare);
    *bare_ptr = NULL;
}
