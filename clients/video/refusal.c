/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An answer before the body, and a close after which the peer has still read it. */
#include "refusal.h"

static const char SOCKET[] = "plantcast-socket"; /* kept with the peer's address: all that libsoup hands back of a connection */

enum { SKIP_BYTES = 16 * 1024, LINGER_S = 5 };

struct refusal {
    GIOStream *stream;
    GSocket *socket; /* NULL: not known */
    gint64 until_us;
    GBytes *answer;
    char skipped[SKIP_BYTES]; /* read by g_input_stream_read_async: g_input_stream_skip_async waits for all that it is to skip */
};

static void refusal_free(struct refusal *refusal)
{
    g_io_stream_close(refusal->stream, NULL, NULL);
    g_object_unref(refusal->stream);
    g_clear_object(&refusal->socket);
    g_bytes_unref(refusal->answer);
    g_free(refusal);
}

static void skip(struct refusal *refusal);

static void on_skipped(GObject *input, GAsyncResult *result, gpointer data)
{
    struct refusal *refusal = data;
    if (g_input_stream_read_finish(G_INPUT_STREAM(input), result, NULL) > 0)
        skip(refusal);
    else
        refusal_free(refusal);
}

/* To close a socket with bytes that were not read resets the connection, and the peer would lose the answer. */
static void skip(struct refusal *refusal)
{
    if (g_get_monotonic_time() < refusal->until_us)
        g_input_stream_read_async(g_io_stream_get_input_stream(refusal->stream), refusal->skipped, SKIP_BYTES, G_PRIORITY_LOW, NULL,
                                  on_skipped, refusal);
    else
        refusal_free(refusal);
}

static void on_written(GObject *output, GAsyncResult *result, gpointer data)
{
    struct refusal *refusal = data;
    if (!g_output_stream_write_all_finish(G_OUTPUT_STREAM(output), result, NULL, NULL) || !refusal->socket ||
        !g_socket_shutdown(refusal->socket, FALSE, TRUE, NULL))
        refusal_free(refusal);
    else
        skip(refusal);
}

static GBytes *response(SoupServerMessage *message)
{
    SoupMessageHeaders *headers = soup_server_message_get_response_headers(message);
    GBytes *body = soup_message_body_flatten(soup_server_message_get_response_body(message));
    SoupMessageHeadersIter iter;
    const char *name, *value;
    GString *text = g_string_new("");
    soup_message_headers_replace(headers, "Connection", "close");
    soup_message_headers_set_content_length(headers, (goffset)g_bytes_get_size(body));
    g_string_printf(text, "HTTP/1.1 %u %s\r\n", soup_server_message_get_status(message), soup_server_message_get_reason_phrase(message));
    soup_message_headers_iter_init(&iter, headers);
    while (soup_message_headers_iter_next(&iter, &name, &value))
        g_string_append_printf(text, "%s: %s\r\n", name, value);
    g_string_append(text, "\r\n");
    g_string_append_len(text, g_bytes_get_data(body, NULL), (gssize)g_bytes_get_size(body));
    g_bytes_unref(body);
    return g_string_free_to_bytes(text);
}

void refusal_know(GSocketAddress *peer, GSocket *socket)
{
    g_object_set_data_full(G_OBJECT(peer), SOCKET, g_object_ref(socket), g_object_unref);
}

void refusal_send(SoupServer *server, SoupServerMessage *message)
{
    struct refusal *refusal = g_new0(struct refusal, 1);
    GSocket *socket = g_object_get_data(G_OBJECT(soup_server_message_get_remote_address(message)), SOCKET);
    g_object_ref(message);
    *refusal = (struct refusal){
        .socket = socket ? g_object_ref(socket) : NULL,
        .until_us = g_get_monotonic_time() + LINGER_S * G_USEC_PER_SEC,
        .answer = response(message),
    };
    refusal->stream = soup_server_message_steal_connection(message);
    g_signal_emit_by_name(server, "request-aborted", message); /* of one that was stolen libsoup says nothing */
    g_object_unref(message);
    GOutputStream *output = g_io_stream_get_output_stream(refusal->stream);
    gsize count = 0;
    const void *bytes = g_bytes_get_data(refusal->answer, &count);
    g_output_stream_write_all_async(output, bytes, count, G_PRIORITY_DEFAULT, NULL, on_written, refusal);
}
