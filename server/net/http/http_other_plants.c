/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers wall displays that show pictures of other plants: sends the state and the picture of each such plant. */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "net/connection.h"
#include "net/http/http_impl.h"
#include "views/other_plants.h"

/* Returns the index of the other plant with that id, or -1. A paired device may only ask for plants that its display shows. */
static int find(const struct server_context *server, const struct http_exchange *request, const char *id)
{
    const struct plant *plant = server->params.plant.scene->plant;
    const struct token_holder *holder = &connection_of(request->wsi)->holder;
    if (holder->display && !wall_display_has(wall_display_find(plant, holder->wall, holder->display), PANE_SNAPSHOT, id))
        return -1;
    return other_plant_find(plant, id);
}

static int refuse_unknown(struct http_exchange *request)
{
    return request_answer_text(request, HTTP_STATUS_NOT_FOUND,
                               "the plant file has no such plant in `other_plants`, or this display does not show it\n");
}

int api_other_plants(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    int which[OTHER_PLANTS];
    size_t count = 0;
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    for (size_t i = 0; i < args.count; i++) {
        if (strncmp(args.list[i], "id=", 3) != 0 || count == OTHER_PLANTS)
            return request_answer_text(request, HTTP_STATUS_BAD_REQUEST,
                                       "the address needs id=ID with the ID of a plant, once for each plant\n");
        which[count] = find(server, request, args.list[i] + 3);
        if (which[count++] < 0)
            return refuse_unknown(request);
    }
    if (count == 0)
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST,
                                   "the address needs id=ID with the ID of a plant, once for each plant\n");
    return request_answer_json(request, other_plants_text(server->params.plant.other_plants, which, count, clock_mono_ns()));
}

int ask_other_picture(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    size_t bytes;
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    const char *id = arg_of(&args, "id"), *number = arg_of(&args, "picture");
    if (!id || !number)
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "the address needs id=ID with the ID of a plant, and picture=N\n");
    int which = find(server, request, id);
    if (which < 0)
        return refuse_unknown(request);
    char *png = other_plants_picture(server->params.plant.other_plants, which, strtoll(number, NULL, 10), clock_mono_ns(), &bytes);
    if (!png)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, "this picture was replaced by a newer picture\n");
    return request_answer(request, HTTP_STATUS_OK, "image/png", png, bytes, NULL, NULL);
}
