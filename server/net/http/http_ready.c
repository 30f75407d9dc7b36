/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers /readyz: whether the daemon can show pictures, and which of its files need attention. */
#include <string.h>

#include "base/clock.h"
#include "base/files/database.h"
#include "base/mem.h"
#include "net/connection.h"
#include "net/core_end.h"
#include "net/http/http_impl.h"
#include "net/renderers.h"
#include "net/unread_files.h"

/* Returns whether the request is a load balancer's check whether the daemon may draw for a core (/readyz?role=render). */
static bool is_asked_as_renderer(struct http_exchange *request)
{
    char argument[16];
    return lws_hdr_copy_fragment(request->wsi, argument, sizeof(argument), WSI_TOKEN_HTTP_URI_ARGS, 0) > 0 &&
           !strcmp(argument, "role=render");
}

/* Learns from a header of the load balancer's check whether the balancer sends users to this node. Ignores requests with
   X-Forwarded-For, which come from clients and may be forged. */
static void hear_balancer(struct server_context *server, struct http_exchange *request)
{
    static const char header[] = "x-haproxy-server-state:";
    const struct connection *connection = connection_of(request->wsi);
    char state[512];
    if (connection->from_proxy && !connection->forwarded &&
        lws_hdr_custom_copy(request->wsi, state, sizeof(state), header, sizeof(header) - 1) > 0)
        core_loss_on_check(&server->life.core_loss, state, clock_mono_ns());
}

/* Appends that entries (`what`) are not recorded. error: -errno of the file that would contain them; 0: nothing is appended. */
static void add_unrecorded(struct text *text, const char *what, const char *file, int error)
{
    if (error == -DATABASE_NEWER)
        text_add(text,
                 "; %s are not recorded, because a newer Plantcast wrote %s: the log names the file and the command that moves it away",
                 what, file);
    else if (error)
        text_add(text, "; %s are not recorded: the log says why", what);
}

/* Appends the names of the files with users' entries that could not be read. */
static void add_unread(struct text *text, const struct plant_services *plant)
{
    const char *names[UNREAD_FILES];
    int count = unread_files(plant, names);
    for (int i = 0; i < count; i++)
        text_add(text, "%s%s", i > 0 ? ", " : "; these files are not used, because they cannot be read: ", names[i]);
    text_add(text, "%s", count > 0 ? ": the log says why" : "");
}

/* Answers 200, even if files cannot be used: a load balancer must not take pictures from users for that reason. */
static int answer_good(const struct server_context *server, struct http_exchange *request)
{
    const struct plant_services *plant = &server->params.plant;
    struct text text = { 0 };
    text_add(&text, "%s", server->params.keeper ? renderers_standby_texts(server)->ready : "ok");
    add_unrecorded(&text, "readings", "a history file", plant->historian ? historian_error(plant->historian) : 0);
    add_unrecorded(&text, "alarm events", "the alarm journal",
                   plant->alarm_service ? alarm_service_journal_error(plant->alarm_service) : 0);
    add_unrecorded(&text, "users' actions", "the audit trail", audit_error(server->params.audit));
    add_unread(&text, plant);
    text_add(&text, "\n");
    int result = request_answer_text(request, HTTP_STATUS_OK, text.at);
    text_finish(&text);
    return result;
}

int answer_ready(struct server_context *server, struct http_exchange *request)
{
    hear_balancer(server, request);
    if (server->params.keeper && !core_end_leads(server))
        return request_answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE, "not ready: this core is the standby and does not lead\n");
    if (is_asked_as_renderer(request) && !server->params.is_core && !server->params.plant.core_link)
        return request_answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE,
                                   "not a renderer: this daemon was started without --role render and polls the devices itself\n");
    if (is_asked_as_renderer(request) && server->life.drain_ns)
        return request_answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE,
                                   "not ready: this daemon moves its sessions to other daemons (drain)\n");
    if (render_service_ready(server->params.plant.render_service))
        return answer_good(server, request);
    return request_answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE, "the OpenGL context was lost; a new context is being created\n");
}
