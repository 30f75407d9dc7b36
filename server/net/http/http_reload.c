/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plant reload over HTTP. */
#include <string.h>

#include "base/mem.h"
#include "net/http/http_impl.h"
#include "net/connection.h"

int ask_reload(struct server_context *server, struct http_exchange *request)
{
    request->close = true; /* closes the connection after the answer, because the client may send a body that nobody will read */
    if (!connection_origin_allowed(server, request->wsi))
        return request_refuse_foreign(server, request, RELOAD_PATH);
    if (!server->params.reload)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, "this plant cannot be reloaded\n");
    request_await(server, request);
    request->reload = server->params.reload(server->params.reload_arg, connection_who(connection_of(request->wsi)));
    return 0;
}

/* Answers the waiting requests for a reload with the numbers first..last; 0..0: those that wait for something else. */
static void answer_all(struct server_context *server, uint64_t first, uint64_t last, int status, const char *type, const char *text)
{
    for (struct http_exchange *request = server->http.waiting, *next; request; request = next) {
        next = request->next;
        if (request->reload < first || request->reload > last || request->recorded)
            continue;
        request_forget(server, request);
        request->reload = 0;
        /* an answer in pieces that has begun cannot be completed; closing the connection shows the client that it is incomplete */
        bool begun = request->pieces != PIECES_NONE;
        request_answered(request, begun ? -1 : request_answer(request, status, type, mem_strdup(text), strlen(text), NULL, NULL));
    }
}

void http_release_plant(struct server_context *server)
{
    answer_all(server, 0, 0, HTTP_STATUS_SERVICE_UNAVAILABLE, HTTP_TEXT, "the plant was reloaded during the request; try again\n");
}

void http_on_reloaded(struct server_context *server, uint64_t number, bool good, const char *text)
{
    answer_all(server, 1, number, good ? HTTP_STATUS_OK : 422, "application/json", text);
}
