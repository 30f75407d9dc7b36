/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asks the kernel (TCP_INFO) how many bytes a connection received and how long ago the last byte arrived. */
#include "net/http/stuck_head.h"

#include <linux/tcp.h>
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

#include "base/clock.h"
#include "net/connection.h"

/* QUIET_MS: time without a byte after which a request counts as stalled. It exceeds 1 s, the time within which a lost packet is
   retransmitted unless the retransmission is lost as well */
enum { CHECK_INTERVAL_US = 500000, QUIET_MS = 2000 };
static const uint64_t NOT_WATCHED = UINT64_MAX;

static bool tcp_info_of(struct lws *wsi, struct tcp_info *info)
{
    socklen_t size = sizeof(*info);
    memset(info, 0, sizeof(*info));
    return getsockopt((int)lws_get_socket_fd(wsi), IPPROTO_TCP, TCP_INFO, info, &size) == 0;
}

void stuck_head_await(struct lws *wsi, bool first)
{
    struct tcp_info info;
    connection_of(wsi)->received_before_head = !tcp_info_of(wsi, &info) ? NOT_WATCHED : first ? 0 : info.tcpi_bytes_received;
    lws_set_timer_usecs(wsi, CHECK_INTERVAL_US);
}

/* Stops waiting for the rest of the request's head. The timer stays set and fires one last time: libwebsockets 4.1 cannot
   cancel a timer, and a delay of -1 makes it fire immediately. */
void stuck_head_arrived(struct lws *wsi)
{
    connection_of(wsi)->received_before_head = NOT_WATCHED;
}

/* Writes the HTTP answer 408 (request timeout) in one call; bytes that the socket does not accept at once are lost. */
static void tell(struct lws *wsi)
{
    static const char body[] = "408 Request Timeout: the request's headers are incomplete. Is the name of a header truncated?\n";
    char text[256];
    int length = snprintf(text, sizeof(text),
                          "HTTP/1.1 408 Request Timeout\r\ncontent-type: text/plain; charset=utf-8\r\ncontent-length: %zu\r\n"
                          "connection: close\r\n\r\n%s",
                          sizeof(body) - 1, body);
    SSL *ssl = lws_get_ssl(wsi);
    if (ssl)
        SSL_write(ssl, text, length);
    else
        send((int)lws_get_socket_fd(wsi), text, (size_t)length, MSG_NOSIGNAL | MSG_DONTWAIT);
}

static void note(struct server_context *server, struct lws *wsi)
{
    char address[64] = "", more[LOG_PACE_BYTES];
    server->http.stuck_heads.first_ns = server->http.stuck_heads.longest_ns = 60 * NS_PER_S;
    if (!log_pace_take(&server->http.stuck_heads, clock_mono_ns(), more))
        return;
    lws_get_peer_simple(wsi, address, sizeof(address));
    log_warn(server->params.log, "http: a request from %s was closed with status 408: its headers were incomplete after %d s%s", address,
             QUIET_MS / 1000, more);
}

/* Returns whether libwebsockets has read the request's first line. Received bytes alone do not show that a request has begun:
   over TLS they include the handshake. */
static bool has_request_line(struct lws *wsi)
{
    return lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0 || lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0 ||
           lws_hdr_total_length(wsi, WSI_TOKEN_POST_URI) > 0;
}

int stuck_head_look(struct server_context *server, struct lws *wsi)
{
    struct tcp_info info;
    SSL *ssl = lws_get_ssl(wsi);
    if (!connection_of(wsi) || connection_of(wsi)->received_before_head == NOT_WATCHED)
        return 0;
    bool begun = tcp_info_of(wsi, &info) && info.tcpi_bytes_received > connection_of(wsi)->received_before_head;
    if (!begun || info.tcpi_last_data_recv < QUIET_MS || (ssl && !has_request_line(wsi))) {
        lws_set_timer_usecs(wsi, CHECK_INTERVAL_US);
        return 0;
    }
    note(server, wsi);
    tell(wsi);
    return -1;
}
