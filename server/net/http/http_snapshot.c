/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures and picks over HTTP, of now or of an instant. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/http/http_impl.h"
#include "message/view_query.h"
#include "session/reply.h"
#include "net/connection.h"

static const struct encoder_params LOSSLESS = { .quality = 100, .full_chroma = true };

/* place: x and y of a pick; NULL: none is asked. */
static bool read_query(struct server_context *hub, struct lws *wsi, struct view *view, double place[2], struct message_error *error)
{
    const struct params_context world = { .scene = hub->params.plant.scene,
                                          .baselines = hub->params.plant.baselines,
                                          .now_us = clock_utc_ns() / 1000 };
    struct args args;
    return request_args(wsi, &args, error) && view_query_parse(&world, connection_of(wsi)->role, args.list, args.count, view, place, error);
}

static struct view *asked_view(struct asked *asked)
{
    return asked->picks ? &asked->pick.view : &asked->wish.view;
}

/* Of now at once; of an instant when it was read. */
static void begin(struct server_context *hub, struct request *request)
{
    struct asked *asked = request->asked;
    if (asked_view(asked)->at_us && !asked->historical) {
        history_loader_ask(hub->past, request->client, asked_view(asked)->at_us);
    } else if (asked->picks) {
        render_service_pick(hub->params.plant.painter, &asked->pick);
    } else {
        render_service_request(hub->params.plant.painter, request->client, &asked->wish);
        render_service_wake(hub->params.plant.painter);
    }
}

/* Whether it may be, before it waits; if not, *result is what came of the answer. */
static bool may_ask(struct server_context *hub, struct request *request, const struct view *view, int *result)
{
    if (view->at_us && !hub->past) {
        *result = request_answer_text(request, HTTP_STATUS_NOT_FOUND, HTTP_NOTHING_RECORDED);
        return false;
    }
    const char *why = hub->picture_count >= hub->quotas->at[QUOTA_SNAPSHOTS] ? "too many pictures are being made; try again\n"
                      : address_limits_may_draw(hub->peers, connection_of(request->wsi)->client)
                          ? NULL
                          : "as many pictures are being made for this address as one may have; try again\n";
    if (why)
        *result = request_answer_later(request, why);
    return !why;
}

static struct asked *await_picture(struct server_context *hub, struct request *request)
{
    request_await(hub, request);
    request->asked = mem_new(sizeof(*request->asked));
    request->peer->pictures++;
    hub->picture_count++;
    return request->asked;
}

int ask_snapshot(struct server_context *hub, struct request *request)
{
    struct frame_request wish = { .codec = WIRE_CODEC_PNG, .quality = LOSSLESS, .urgency = URGENCY_SNAPSHOT, .always = true };
    struct message_error error = { 0 };
    int result;
    wish.overlay = connection_of(request->wsi)->role == ROLE_OPEN ? OVERLAY_BARE : OVERLAY_FULL;
    if (!read_query(hub, request->wsi, &wish.view, NULL, &error))
        return request_answer_error(request, &error);
    if (!may_ask(hub, request, &wish.view, &result))
        return result;
    wish.asked_ns = wish.view.input_ns = clock_mono_ns();
    wish.payer = connection_of(request->wsi)->client->share.payer;
    await_picture(hub, request)->wish = wish;
    begin(hub, request);
    return 0;
}

void http_on_frame(struct server_context *hub, struct encoded_frame *picture)
{
    struct request *request = request_find(hub, picture->client);
    if (request) {
        int status;
        request_forget(hub, request);
        if (picture->packet) {
            char *body = mem_array(picture->packet->count, 1);
            memcpy(body, picture->packet->bytes, picture->packet->count);
            status = request_answer(request, HTTP_STATUS_OK, "image/png", body, picture->packet->count, NULL, NULL);
        } else {
            status = request_answer_text(request, HTTP_STATUS_INTERNAL_SERVER_ERROR, "the picture could not be made\n");
        }
        request_answered(request, status);
    }
    encoded_frame_destroy(&picture);
}

int ask_pick(struct server_context *hub, struct request *request)
{
    struct pick_query order = { 0 };
    struct message_error error = { 0 };
    double place[2];
    int result;
    if (!read_query(hub, request->wsi, &order.view, place, &error))
        return request_answer_error(request, &error);
    if (!may_ask(hub, request, &order.view, &result))
        return result;
    struct asked *asked = await_picture(hub, request);
    order.client = request->client;
    order.x_px = place[0];
    order.y_px = place[1];
    asked->picks = true;
    asked->pick = order;
    begin(hub, request);
    return 0;
}

void http_on_pick(struct server_context *hub, const struct pick_answer *pick)
{
    struct request *request = request_find(hub, pick->order.client);
    if (!request)
        return;
    request_forget(hub, request);
    request_answered(request, request_answer_json(request, reply_picked_text(hub->params.plant.scene->plant, pick)));
}

void http_on_historical_snapshot(struct server_context *hub, const struct history_loader_answer *past)
{
    struct request *request = request_find(hub, past->client);
    if (!request)
        return;
    struct asked *asked = request->asked;
    asked->historical = past->good ? snapshot_cache_take(hub->params.plant.snapshot_cache, past->at_us) : NULL;
    if (asked->historical) {
        view_set_instant(asked_view(asked), past->at_us, asked->historical->slot);
        begin(hub, request);
        return;
    }
    request_forget(hub, request);
    request_answered(request, request_answer_text(request, HTTP_STATUS_INTERNAL_SERVER_ERROR, HTTP_UNREADABLE));
}
