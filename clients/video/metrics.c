/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serves metrics over HTTP. Each connection has its own thread, which reads one request up to the blank line, answers and closes. */
#include "metrics.h"

#include <gio/gio.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { MAX_REQUEST_BYTES = 4096, IDLE_S = 5, MAX_CONNECTIONS = 8 };

struct metrics {
    GSocketService *service;
    gint connections; /* open connections; atomic */
    GMutex lock;
    /* --- below: under lock */
    char *text;
};

struct metrics_request {
    struct metrics *metrics;
    GSocketConnection *connection;
};

static void metrics_clear(gpointer data)
{
    struct metrics *metrics = data;
    g_free(metrics->text);
    g_mutex_clear(&metrics->lock);
}

/* Drops a reference to the metrics; the last one frees them. Threads that still answer requests may outlive metrics_destroy(). */
static void metrics_unref(struct metrics *metrics)
{
    g_atomic_rc_box_release_full(metrics, metrics_clear);
}

static bool read_request(GInputStream *in, char request[MAX_REQUEST_BYTES + 1])
{
    gsize n = 0;
    request[0] = 0;
    while (n < MAX_REQUEST_BYTES && !strstr(request, "\r\n\r\n")) {
        gssize count = g_input_stream_read(in, request + n, MAX_REQUEST_BYTES - n, NULL, NULL);
        if (count <= 0)
            return false;
        n += (gsize)count;
        request[n] = 0;
    }
    return true;
}

static void answer(struct metrics *metrics, GOutputStream *out, bool known)
{
    g_mutex_lock(&metrics->lock);
    char *body = g_strdup(known ? metrics->text : "Not found: expected GET /metrics\n");
    g_mutex_unlock(&metrics->lock);
    g_output_stream_printf(out, NULL, NULL, NULL,
                           "HTTP/1.1 %s\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: %zu\r\n"
                           "Cache-Control: no-store\r\nConnection: close\r\n\r\n%s",
                           known ? "200 OK" : "404 Not Found", strlen(body), body);
    g_free(body);
}

static gpointer serve(gpointer data)
{
    struct metrics_request *request = data;
    GIOStream *stream = G_IO_STREAM(request->connection);
    char text[MAX_REQUEST_BYTES + 1];
    if (read_request(g_io_stream_get_input_stream(stream), text))
        answer(request->metrics, g_io_stream_get_output_stream(stream), g_str_has_prefix(text, "GET /metrics "));
    g_io_stream_close(stream, NULL, NULL);
    g_object_unref(stream);
    g_atomic_int_add(&request->metrics->connections, -1);
    metrics_unref(request->metrics);
    g_free(request);
    return NULL;
}

/* Starts a thread that answers a connection. GLib's GThreadedSocketService would do this, but in GLib 2.74 it crashes at its connection
   limit. */
static gboolean on_connection(GSocketService *service, GSocketConnection *connection, GObject *from, gpointer data)
{
    struct metrics *metrics = data;
    (void)service;
    (void)from;
    if (g_atomic_int_get(&metrics->connections) >= MAX_CONNECTIONS)
        return TRUE; /* closes the connection */
    g_socket_set_timeout(g_socket_connection_get_socket(connection), IDLE_S);
    struct metrics_request *request = g_new(struct metrics_request, 1);
    *request = (struct metrics_request){ .metrics = g_atomic_rc_box_acquire(metrics), .connection = g_object_ref(connection) };
    g_atomic_int_inc(&metrics->connections);
    g_thread_unref(g_thread_new("metrics", serve, request));
    return TRUE;
}

struct metrics *metrics_create(int port)
{
    GError *error = NULL;
    GSocketAddress *address = g_inet_socket_address_new_from_string("127.0.0.1", (guint)port);
    struct metrics *metrics = g_atomic_rc_box_new0(struct metrics);
    g_mutex_init(&metrics->lock);
    metrics->text = g_strdup("");
    metrics->service = g_socket_service_new();
    g_signal_connect(metrics->service, "incoming", G_CALLBACK(on_connection), metrics);
    if (!g_socket_listener_add_address(G_SOCKET_LISTENER(metrics->service), address, G_SOCKET_TYPE_STREAM, G_SOCKET_PROTOCOL_TCP, NULL,
                                       NULL, &error)) {
        fprintf(stderr, "plantcast-video: --http %d: %s\n", port, error->message);
        g_error_free(error);
        metrics_destroy(&metrics);
    }
    g_object_unref(address);
    return metrics;
}

void metrics_destroy(struct metrics **pointer)
{
    struct metrics *metrics = *pointer;
    if (!metrics)
        return;
    *pointer = NULL;
    g_socket_service_stop(metrics->service);
    g_socket_listener_close(G_SOCKET_LISTENER(metrics->service));
    g_signal_handlers_disconnect_by_data(metrics->service, metrics);
    g_object_unref(metrics->service);
    metrics_unref(metrics);
}

void metrics_set(struct metrics *metrics, char *text)
{
    g_mutex_lock(&metrics->lock);
    char *earlier = metrics->text;
    metrics->text = text;
    g_mutex_unlock(&metrics->lock);
    g_free(earlier);
}
