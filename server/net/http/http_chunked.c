/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers whose body is sent in pieces. The next piece is made once the previous one was sent, so that a slow reader occupies memory for
   one piece only. */
#include <stdio.h>
#include <string.h>

#include "net/http/http_impl.h"

static const char END[] = "0\r\n\r\n";
/* CHUNK_FRAMING_BYTES: bytes reserved before and after each HTTP chunk for its length and line ends; WRITE_TIMEOUT_S: seconds allowed for
   one write; NEXT_PIECE_TIMEOUT_S: seconds allowed until the next piece is made */
enum { CHUNK_FRAMING_BYTES = 16, WRITE_TIMEOUT_S = 20, NEXT_PIECE_TIMEOUT_S = 60 };

/* HTTP/1.0 has no chunked bodies: there the end of the connection ends the body. */
int chunked_begin(struct http_exchange *request, const char *type)
{
    char version[16] = "";
    lws_hdr_copy(request->wsi, version, sizeof(version), WSI_TOKEN_HTTP);
    request->pieces = strstr(version, "1.0") ? PIECES_TO_END : PIECES_CHUNKED;
    request->close |= request->pieces == PIECES_TO_END;
    request->last_piece = false;
    if (!request_write_head(request, HTTP_STATUS_OK, type, NULL, NULL))
        return -1;
    return request->head ? request_done(request) : 0;
}

void chunked_append(struct http_exchange *request, char *body, size_t count, bool last)
{
    request_hold(request, body, count);
    request->last_piece = last;
    lws_set_timeout(request->wsi, PENDING_TIMEOUT_HTTP_CONTENT, WRITE_TIMEOUT_S);
    lws_callback_on_writable(request->wsi);
}

static bool write_chunk(struct server_context *server, struct http_exchange *request, size_t count, bool end)
{
    char *out = (char *)server->out + LWS_PRE;
    size_t n = 0;
    bool chunked = request->pieces == PIECES_CHUNKED;
    if (chunked && count > 0)
        n = (size_t)snprintf(out, CHUNK_FRAMING_BYTES, "%zx\r\n", count);
    memcpy(out + n, request->body + request->sent, count);
    n += count;
    if (chunked && count > 0) {
        memcpy(out + n, "\r\n", 2);
        n += 2;
    }
    if (chunked && end) {
        memcpy(out + n, END, sizeof(END) - 1);
        n += sizeof(END) - 1;
    }
    return lws_write(request->wsi, (unsigned char *)out, n, end ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) >= (int)n;
}

int chunked_write(struct server_context *server, struct http_exchange *request)
{
    size_t left = request->count - request->sent, most = SLICE_BYTES - 2 * CHUNK_FRAMING_BYTES, slice = left < most ? left : most;
    if (!request->body)
        return 0;
    if (!write_chunk(server, request, slice, slice == left && request->last_piece))
        return -1;
    request->sent += slice;
    lws_set_timeout(request->wsi, PENDING_TIMEOUT_HTTP_CONTENT, slice < left ? WRITE_TIMEOUT_S : NEXT_PIECE_TIMEOUT_S);
    if (slice < left) {
        lws_callback_on_writable(request->wsi);
    } else if (request->last_piece) {
        request_forget(server, request);
        return request_done(request);
    } else {
        request_hold(request, NULL, 0);
        history_queries_continue(server->history_queries, request->client);
    }
    return 0;
}
