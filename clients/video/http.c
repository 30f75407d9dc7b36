/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP by libsoup. */
#include "http.h"

#include <libsoup/soup.h>
#include <stdio.h>
#include <string.h>

#include "readers.h"
#include "refusal.h"

enum {
    IDLE_S = 10,           /* a connection on which nothing moves for so long is closed */
    MORE_CONNECTIONS = 32, /* than there may be readers: one that is kept open waits for its next request */
};

struct http {
    SoupServer *server;
    GSocketService *service;
    int *connections; /* that are open; shared with them, by g_rc_box */
    const struct options *options;
    void (*metrics)(GString *out, void *data);
    void *data;
    int under_way; /* requests that are being answered */
};

static void answer_text(SoupServerMessage *message, guint status, const char *text)
{
    soup_server_message_set_status(message, status, NULL);
    soup_server_message_set_response(message, "text/plain; charset=utf-8", SOUP_MEMORY_COPY, text, strlen(text));
}

static bool is_get(SoupServerMessage *message)
{
    const char *method = soup_server_message_get_method(message);
    if (!strcmp(method, "GET") || !strcmp(method, "HEAD"))
        return true;
    answer_text(message, SOUP_STATUS_METHOD_NOT_ALLOWED, "GET is expected\n");
    return false;
}

static void on_metrics(SoupServer *server, SoupServerMessage *message, const char *path, GHashTable *query, gpointer data)
{
    struct http *http = data;
    (void)server;
    (void)path;
    (void)query;
    if (!is_get(message))
        return;
    GString *out = g_string_new("");
    http->metrics(out, http->data);
    answer_text(message, SOUP_STATUS_OK, out->str);
    g_string_free(out, TRUE);
}

/* Of the folder's own files only. */
static bool is_plain(const char *name)
{
    return name[0] && name[0] != '.' && strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-.") == strlen(name);
}

static void on_hls(SoupServer *server, SoupServerMessage *message, const char *path, GHashTable *query, gpointer data)
{
    struct http *http = data;
    const char *name = path + strlen("/hls/");
    char *content = NULL;
    gsize count = 0;
    (void)server;
    (void)query;
    if (!is_get(message))
        return;
    if (http->under_way > http->options->most_readers) {
        answer_text(message, SOUP_STATUS_SERVICE_UNAVAILABLE, "too many are reading\n");
        return;
    }
    char *file = strlen(path) > strlen("/hls/") && is_plain(name) ? g_build_filename(http->options->hls_path, name, NULL) : NULL;
    if (!file || !g_file_get_contents(file, &content, &count, NULL)) {
        answer_text(message, SOUP_STATUS_NOT_FOUND, "there is no such file\n");
    } else {
        bool list = g_str_has_suffix(name, ".m3u8");
        soup_message_headers_replace(soup_server_message_get_response_headers(message), "Cache-Control", list ? "no-store" : "max-age=60");
        soup_server_message_set_status(message, SOUP_STATUS_OK, NULL);
        soup_server_message_set_response(message, list ? "application/vnd.apple.mpegurl" : "video/mp2t", SOUP_MEMORY_TAKE, content, count);
    }
    g_free(file);
}

static void on_begun(SoupServer *server, SoupServerMessage *message, struct http *http)
{
    (void)server;
    (void)message;
    http->under_way++;
}

static void on_done(SoupServer *server, SoupServerMessage *message, struct http *http)
{
    (void)server;
    (void)message;
    http->under_way--;
}

static gboolean may_read(SoupAuthDomain *domain, SoupServerMessage *message, const char *user, const char *password, gpointer data)
{
    const struct http *http = data;
    (void)domain;
    return reader_may(http->options, message, user, password);
}

static void on_closed(gpointer data, GObject *connection)
{
    int *connections = data;
    (void)connection;
    --*connections;
    g_rc_box_release(connections);
}

/* libsoup itself would keep one that says nothing for ever, and any number of them. */
static gboolean on_connection(GSocketService *service, GSocketConnection *connection, GObject *from, gpointer data)
{
    struct http *http = data;
    (void)service;
    (void)from;
    if (*http->connections >= http->options->most_readers + MORE_CONNECTIONS)
        return TRUE;
    GSocketAddress *here = g_socket_connection_get_local_address(connection, NULL);
    GSocketAddress *there = g_socket_connection_get_remote_address(connection, NULL);
    if (here && there) {
        GSocket *socket = g_socket_connection_get_socket(connection);
        g_socket_set_timeout(socket, IDLE_S);
        refusal_know(there, socket);
        ++*http->connections;
        g_object_weak_ref(G_OBJECT(connection), on_closed, g_rc_box_acquire(http->connections));
        soup_server_accept_iostream(http->server, G_IO_STREAM(connection), here, there, NULL);
    }
    g_clear_object(&here);
    g_clear_object(&there);
    return TRUE;
}

static bool listen_at(struct http *http)
{
    GError *error = NULL;
    GSocketAddress *address = g_inet_socket_address_new_from_string(http->options->listen, (guint)http->options->http_port);
    bool good = g_socket_listener_add_address(G_SOCKET_LISTENER(http->service), address, G_SOCKET_TYPE_STREAM, G_SOCKET_PROTOCOL_TCP, NULL,
                                              NULL, &error);
    if (!good)
        fprintf(stderr, "plantcast-video: --http %d: %s\n", http->options->http_port, error->message);
    g_clear_error(&error);
    g_object_unref(address);
    return good;
}

struct http *http_create(const struct options *options, struct whep *whep, void (*metrics)(GString *out, void *data), void *data)
{
    struct http *http = g_new0(struct http, 1);
    *http = (struct http){
        .server = soup_server_new("server-header", "plantcast-video", NULL),
        .service = g_socket_service_new(),
        .connections = g_rc_box_new0(int),
        .options = options,
        .metrics = metrics,
        .data = data,
    };
    g_socket_listener_set_backlog(G_SOCKET_LISTENER(http->service), 128);
    g_signal_connect(http->service, "incoming", G_CALLBACK(on_connection), http);
    g_signal_connect(http->server, "request-started", G_CALLBACK(on_begun), http);
    g_signal_connect(http->server, "request-finished", G_CALLBACK(on_done), http);
    g_signal_connect(http->server, "request-aborted", G_CALLBACK(on_done), http);
    soup_server_add_handler(http->server, "/metrics", on_metrics, http, NULL);
    if (options->hls_path)
        soup_server_add_handler(http->server, "/hls", on_hls, http, NULL);
    if (whep)
        whep_serve(whep, http->server);
    if (options->user) {
        SoupAuthDomain *domain = soup_auth_domain_basic_new("realm", "plantcast", "auth-callback", may_read, "auth-data", http, NULL);
        soup_auth_domain_add_path(domain, "/");
        soup_auth_domain_remove_path(domain, "/whep"); /* it looks itself: a browser asks first whether it may */
        soup_server_add_auth_domain(http->server, domain);
        g_object_unref(domain);
    }
    if (!listen_at(http))
        http_destroy(&http);
    return http;
}

void http_destroy(struct http **pointer)
{
    struct http *http = *pointer;
    if (!http)
        return;
    g_socket_service_stop(http->service);
    g_socket_listener_close(G_SOCKET_LISTENER(http->service));
    g_signal_handlers_disconnect_by_data(http->service, http);
    g_object_unref(http->service);
    soup_server_disconnect(http->server);
    g_signal_handlers_disconnect_by_data(http->server, http);
    g_object_unref(http->server);
    g_rc_box_release(http->connections);
    g_free(http);
    *pointer = NULL;
}
