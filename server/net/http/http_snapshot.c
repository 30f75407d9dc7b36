/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers HTTP requests for pictures and for picks (what is at a pixel), of the present or of a past instant. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/http/http_impl.h"
#include "message/json_fields.h"
#include "message/view_address.h"
#include "message/view_query.h"
#include "plant/walls/wall.h"
#include "session/reply/reply.h"
#include "net/connection.h"

enum { NAME_BYTES = 256 };
enum { LEGEND_LEAST_PX = 256 }; /* smallest width in pixels of a picture that has room for a legible legend */

static const struct encoder_params LOSSLESS = { .quality = 100, .full_chroma = true };

static struct params_context context_of(const struct server_context *server)
{
    return (struct params_context){ .scene = server->params.plant.scene,
                                    .baselines = server->params.plant.baselines,
                                    .now_us = clock_plant_ns(server->params.plant.clock) / 1000 };
}

/* Adds an argument of the request's own query to the arguments of the saved view that the query names. Returns false with
   *error if the user may not use the argument, or there is no room. */
static bool add_own(struct view_address *out, const struct connection *connection, const char *arg, struct message_error *error)
{
    char name[48];
    bool of_size = view_address_is_named(arg, "width") || view_address_is_named(arg, "height") || view_address_is_named(arg, "language");
    if (view_address_is_named(arg, "view"))
        return true;
    if ((connection->holder.views[0] || connection->role < ROLE_VIEWER) && !of_size) {
        message_fail(error, "bad_field", "argument '%s' is not allowed together with view; allowed are width, height and language",
                     quoted(arg, name));
        return false;
    }
    if (!role_may_ask(connection->role, arg, error))
        return false;
    if (view_address_set(out, arg))
        return true;
    message_fail(error, "bad_field", "view: the view and the query together have more than %d arguments", VIEW_ADDRESS_ARGS);
    return false;
}

/* Reads from a query the requested view and, for a pick, the pixel. If the query names a saved view, *address receives that
   view's arguments, even ones that only engineers may send. It also receives the query's own arguments, which the user's role
   must permit; free it with view_address_finish(). Otherwise the arguments stay in *args. place: as for view_query_parse().
   Returns false with *error if the request is not valid. */
static bool read_query(struct server_context *server, struct lws *wsi, struct args *args, struct view_address *address, struct view *view,
                       double place[2], struct message_error *error)
{
    const struct params_context context = context_of(server);
    const struct connection *connection = connection_of(wsi);
    if (!request_args(wsi, args, error))
        return false;
    const char *id = arg_of(args, "view");
    if (!id && !connection->holder.views[0])
        return view_query_parse(&context, connection->role, args->list, args->count, view, place, error);
    const char *named =
        session_scope_find_view(&server->params.plant, connection->role, &connection->holder, id ? id : "", "view", error);
    bool good = named && view_address_read(address, named, error);
    for (size_t i = 0; i < args->count && good; i++)
        good = add_own(address, connection, args->list[i], error);
    return good && view_query_parse(&context, ROLE_ENGINEER, (const char *const *)address->args, address->count, view, place, error);
}

static void keep_args(struct asked *asked, const char *const *list, size_t count)
{
    asked->args = mem_array(count, sizeof(*asked->args));
    asked->arg_count = count;
    for (size_t i = 0; i < count; i++)
        asked->args[i] = mem_strdup(list[i]);
}

static struct view *asked_view(struct asked *asked)
{
    return asked->picks ? &asked->pick.view : &asked->frame_request.view;
}

/* Requests the frame or pick: at once if it shows the present, or after the readings of its past instant were loaded. */
static void begin(struct server_context *server, struct http_exchange *request)
{
    struct asked *asked = request->asked;
    if (asked_view(asked)->at_us && !asked->historical) {
        history_loader_ask(server->history_loader, request->client, asked_view(asked)->at_us);
    } else if (asked->picks) {
        render_service_pick(server->params.plant.render_service, &asked->pick);
    } else {
        render_service_request(server->params.plant.render_service, request->client, &asked->frame_request);
        render_service_wake(server->params.plant.render_service);
    }
}

/* Returns whether the request may wait for its picture. If not, the request is answered here, and *result is the result for the
   libwebsockets callback. */
static bool may_ask(struct server_context *server, struct http_exchange *request, const struct view *view, int *result)
{
    if (view->at_us && !server->history_loader) {
        *result = request_refuse(request, HTTP_STATUS_NOT_FOUND, REFUSAL_UNRECORDED);
        return false;
    }
    const char *why = server->http.pictures >= server->room.quotas->at[QUOTA_SNAPSHOTS] ? "too many pictures are being drawn; try again\n"
                      : address_limits_may_draw(server->room.addresses, connection_of(request->wsi)->client)
                          ? NULL
                          : "too many pictures for this address are in progress; try again later\n";
    if (why)
        *result = request_answer_later(request, why);
    return !why;
}

static struct asked *await_picture(struct server_context *server, struct http_exchange *request)
{
    request_await(server, request);
    request->asked = mem_new(sizeof(*request->asked));
    request->usage->pictures++;
    server->http.pictures++;
    return request->asked;
}

static int draw_picture(struct server_context *server, struct http_exchange *request, struct frame_request *frame_request,
                        const char *const *args, size_t arg_count)
{
    int result;
    if (frame_request->view.width_px < LEGEND_LEAST_PX)
        frame_request->overlay = OVERLAY_NONE;
    if (!may_ask(server, request, &frame_request->view, &result))
        return result;
    frame_request->asked_ns = frame_request->view.input_ns = clock_mono_ns();
    frame_request->account = connection_of(request->wsi)->client->share.account;
    struct asked *asked = await_picture(server, request);
    asked->frame_request = *frame_request;
    if (server->params.signing_key)
        keep_args(asked, args, arg_count);
    begin(server, request);
    return 0;
}

/* Answers an invalid query. Records in the audit trail if the user's role does not permit it. */
static int refuse_query(struct server_context *server, struct http_exchange *request, const char *path, const struct message_error *error)
{
    if (!strcmp(error->code, "not_allowed"))
        connection_record_refusal(server, request->wsi, path, error->text);
    return request_answer_error(request, error);
}

int ask_snapshot(struct server_context *server, struct http_exchange *request)
{
    struct frame_request frame_request = { .codec = WIRE_CODEC_PNG, .quality = LOSSLESS, .urgency = URGENCY_SNAPSHOT, .always = true };
    struct message_error error = { 0 };
    struct view_address address = { .count = 0 };
    struct args args;
    int result;
    frame_request.overlay = connection_of(request->wsi)->role == ROLE_OPEN ? OVERLAY_BARE : OVERLAY_FULL;
    if (read_query(server, request->wsi, &args, &address, &frame_request.view, NULL, &error)) {
        bool named = address.count > 0;
        result = draw_picture(server, request, &frame_request, named ? (const char *const *)address.args : args.list,
                              named ? address.count : args.count);
    } else {
        result = refuse_query(server, request, "/snapshot.png", &error);
    }
    view_address_finish(&address);
    return result;
}

/* Adds a header with the age of the readings in the picture and the time zone of its clock, for programs that process the picture. */
static void say_values(const struct plant *plant, const struct frame *frame, struct text *out)
{
    text_add(out, "data_time_us=%lld, oldest_age_ms=", (long long)(frame->data_utc_ns / 1000));
    if (frame->oldest_age_ns == INT64_MAX)
        text_add(out, "none");
    else
        text_add(out, "%lld", (long long)(frame->oldest_age_ns / 1000000));
    if (frame->drawn_error[0] > 0)
        text_add(out, ", drawn_error=%g", frame->drawn_error[0]);
    if (frame->drawn_error[1] > 0)
        text_add(out, ", drawn_error_right=%g", frame->drawn_error[1]);
    text_add(out, ", shows_readings=%s, past=%s, time_zone=%s", view_shows_readings(&frame->view) ? "yes" : "no",
             frame->view.at_us ? "yes" : "no", plant->time_zone);
}

/* Adds a header with the plant's name, if the client may know the name and the name has at most NAME_BYTES. */
static void say_plant(const struct server_context *server, const struct http_exchange *request, struct text *out)
{
    const char *name = server->params.plant.scene->plant->name;
    if (connection_of(request->wsi)->role == ROLE_OPEN || strlen(name) > NAME_BYTES)
        return;
    text_add(out, ", plant=");
    text_add_escaped(out, name);
}

/* Answers with the picture. packet NULL: the picture could not be made. */
static void answer_picture(struct server_context *server, struct http_exchange *request, const struct packet *packet)
{
    char *body = packet ? memcpy(mem_array(packet->count, 1), packet->bytes, packet->count) : NULL;
    struct text values = { 0 };
    text_add(&values, "%s", "");
    if (packet) {
        say_values(server->params.plant.scene->plant, packet->frame, &values);
        say_plant(server, request, &values);
    }
    request_forget(server, request);
    int status = body ? request_answer(request, HTTP_STATUS_OK, "image/png", body, packet->count, "plantcast-frame:", values.at)
                      : request_answer_text(request, HTTP_STATUS_INTERNAL_SERVER_ERROR,
                                            "the picture could not be drawn: the server's log says why\n");
    request_answered(request, status);
    text_finish(&values);
}

/* Signs the picture if a signing key exists and the picture has a legend. Takes ownership of the frame. */
static void sign(struct server_context *server, const struct asked *asked, struct encoded_frame *encoded)
{
    const struct picture_origin origin = { .scene = server->params.plant.scene,
                                           .args = (const char *const *)asked->args,
                                           .arg_count = asked->arg_count,
                                           .bare = asked->frame_request.overlay == OVERLAY_BARE,
                                           .overlay = asked->frame_request.overlay == OVERLAY_BARE ? "bare" : "full",
                                           .version = server->params.version };
    picture_signer_ask(server->signing.signer, encoded, &origin);
}

void http_on_frame(struct server_context *server, struct encoded_frame *encoded)
{
    struct http_exchange *request = request_find(server, encoded->client);
    const struct packet *packet = encoded->packet;
    if (request && packet && packet->frame->record) {
        sign(server, request->asked, encoded);
        return;
    }
    if (request)
        answer_picture(server, request, packet);
    encoded_frame_destroy(&encoded);
}

void http_on_signed(struct server_context *server, struct signing *signing)
{
    struct http_exchange *request = request_find(server, signing->encoded->client);
    if (request)
        answer_picture(server, request, signing->good ? signing->encoded->packet : NULL);
}

int ask_pick(struct server_context *server, struct http_exchange *request)
{
    struct pick_query query = { 0 };
    struct message_error error = { 0 };
    struct args args;
    double place[2];
    int result;
    struct view_address address = { .count = 0 };
    bool good = read_query(server, request->wsi, &args, &address, &query.view, place, &error);
    view_address_finish(&address);
    if (!good)
        return refuse_query(server, request, "/api/v1/pick", &error);
    if (!may_ask(server, request, &query.view, &result))
        return result;
    struct asked *asked = await_picture(server, request);
    query.client = request->client;
    query.x_px = place[0];
    query.y_px = place[1];
    asked->picks = true;
    asked->pick = query;
    begin(server, request);
    return 0;
}

void http_on_pick(struct server_context *server, const struct pick_answer *pick)
{
    struct http_exchange *request = request_find(server, pick->query.client);
    if (!request)
        return;
    request_forget(server, request);
    request_answered(request, request_answer_json(request, reply_picked_text(server->params.plant.scene->plant, pick)));
}

void http_on_historical_snapshot(struct server_context *server, const struct history_loader_answer *history_loader)
{
    struct http_exchange *request = request_find(server, history_loader->client);
    if (!request)
        return;
    if (request->asks_instant) {
        answer_instant(server, request, history_loader);
        return;
    }
    struct asked *asked = request->asked;
    asked->historical = history_loader->good ? snapshot_cache_take(server->params.plant.snapshot_cache, history_loader->at_us) : NULL;
    if (asked->historical) {
        view_set_instant(asked_view(asked), history_loader->at_us, asked->historical->slot);
        begin(server, request);
        return;
    }
    request_forget(server, request);
    request_answered(request, request_answer_unreadable(server, request));
}
