/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table of all connections to /stream, searchable by session id. */
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "net/stream.h"

/* Returns the index of a session in server->streams.by_client, or the index at which the session would be inserted. */
static size_t place_of(const struct server_context *server, uint64_t client)
{
    size_t at;
    search_sorted(at, server->streams.count, server->streams.by_client[at]->session->id < client);
    return at;
}

/* Returns the stream of that session; NULL if it is not connected. */
struct stream *stream_find(const struct server_context *server, uint64_t client)
{
    size_t place = place_of(server, client);
    bool there = place < (size_t)server->streams.count && server->streams.by_client[place]->session->id == client;
    return there ? server->streams.by_client[place] : NULL;
}

struct stream *stream_called(const struct server_context *server, uint64_t number)
{
    struct stream *stream = server->streams.first;
    while (stream && stream->session->identity.number != number)
        stream = stream->next;
    return stream;
}

bool stream_owns(const struct server_context *server, uint64_t client)
{
    return stream_find(server, client) != NULL;
}

void stream_table_add(struct server_context *server, struct stream *stream)
{
    stream->next = server->streams.first;
    server->streams.first = stream;
    mem_grow(&server->streams.by_client, &server->streams.by_client_capacity, (size_t)server->streams.count + 1, sizeof(struct stream *));
    server->streams.by_client[server->streams.count++] = stream; /* appends the stream: session ids ascend, so the array stays sorted */
}

void stream_table_remove(struct server_context *server, const struct stream *stream)
{
    struct stream **at = &server->streams.first;
    while (*at != stream)
        at = &(*at)->next;
    *at = stream->next;
    size_t place = place_of(server, stream->session->id), behind = (size_t)server->streams.count - place - 1;
    memmove(server->streams.by_client + place, server->streams.by_client + place + 1, behind * sizeof(struct stream *));
    server->streams.count--;
}
