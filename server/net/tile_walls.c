/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the sessions that are tiles of one wall, each showing its display's part of one picture. session/tiles/tile_sync.h
   makes the tiles show pictures together. */
#include <string.h>

#include "base/clock.h"
#include "net/stream.h"
#include "session/tiles/tile_sync.h"

/* maximum number of sessions of a wall's tiles. It exceeds the number of displays, because a display may be open several times,
   or reconnect before its old connection is found dead */
enum { MEMBERS = 4 * WALL_DISPLAYS };

static bool is_of(const struct stream *stream, const char *wall)
{
    return session_is_tile(stream->session) && !strcmp(stream->session->tile.place.wall, wall);
}

static struct tile_wall *find(struct server_context *server, const char *name)
{
    struct tile_wall *free_one = NULL;
    for (int i = 0; i < WALLS; i++) {
        struct tile_wall *wall = &server->tile_walls[i];
        if (!strcmp(wall->wall, name))
            return wall;
        bool used = false;
        for (const struct stream *stream = server->streams.first; stream && wall->wall[0]; stream = stream->next)
            used |= is_of(stream, wall->wall);
        if (!used && !free_one)
            free_one = wall;
    }
    if (free_one) {
        *free_one = (struct tile_wall){ 0 };
        snprintf(free_one->wall, sizeof(free_one->wall), "%s", name);
    }
    return free_one;
}

/* --- choosing the leader ------------------------------------------------------------------------------------------------------ */

static bool may_lead(const struct stream *stream, const struct stream *leaving)
{
    const struct session *session = stream->session;
    return stream != leaving && session->hello && !session->hidden && !session->close.code && !session->tile.late_us;
}

/* Chooses the leader: the first connected display, because it shows the picture's title and chosen parameters. If that display
   has several sessions, the present leader stays. */
static struct session *choose(struct server_context *server, const struct tile_wall *wall, const struct stream *leaving)
{
    struct session *first = NULL;
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        if (!is_of(stream, wall->wall) || !may_lead(stream, leaving))
            continue;
        int display = stream->session->tile.place.display;
        if (!first || display < first->tile.place.display || (display == first->tile.place.display && stream->session->id == wall->leader))
            first = stream->session;
    }
    return first;
}

static void take_lead(const struct server_context *server, struct tile_wall *wall, struct session *leader, const struct stream *leaving)
{
    const struct stream *before = wall->leader ? stream_find(server, wall->leader) : NULL;
    /* uses the pointer to the leaving stream, because the stream is no longer in the table in which stream_find() searches */
    if (leaving && leaving->session->id == wall->leader)
        before = leaving;
    if (before)
        session_inherit(leader, before->session);
    wall->leader = leader->id;
    if (leader->following.leader)
        session_follow(leader, NULL, clock_mono_ns());
}

static void tell(struct server_context *server, const struct tile_wall *wall, const struct stream *leaving)
{
    bool there[WALL_DISPLAYS] = { false };
    int64_t late_us[WALL_DISPLAYS] = { 0 };
    bool good[WALL_DISPLAYS] = { false };
    for (const struct stream *stream = server->streams.first; stream; stream = stream->next) {
        const struct session *session = stream->session;
        int at = session->tile.place.display - 1;
        bool is_there = stream != leaving && session->hello && !session->hidden && !session->close.code;
        if (!is_of(stream, wall->wall) || !is_there || at >= WALL_DISPLAYS)
            continue;
        there[at] = true;
        good[at] |= !session->tile.late_us;
        late_us[at] = good[at] ? 0 : session->tile.late_us;
    }
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (is_of(stream, wall->wall) && stream != leaving) {
            session_tile_tell(stream->session, there, late_us, stream->session->id == wall->leader);
            if (session_has_text(stream->session, clock_mono_ns()))
                lws_callback_on_writable(stream->wsi);
        }
}

/* Shifts the pictures of all tiles (displays that show parts of one picture) of a wall by the same few pixels, against burn-in.
   A new tile gets the shift before its first picture. */
static void move_all(struct server_context *server, const char *wall)
{
    struct burn_shift shift = burn_shift_at(clock_plant_ns(server->params.plant.clock));
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (is_of(stream, wall))
            session_tile_move(stream->session, shift, clock_mono_ns());
}

void tiles_gather(struct server_context *server, const char *name, const struct stream *leaving)
{
    struct tile_wall *wall = find(server, name);
    struct session *leader = wall ? choose(server, wall, leaving) : NULL;
    if (!wall)
        return;
    move_all(server, name);
    if (!leader)
        wall->leader = 0;
    else if (leader->id != wall->leader)
        take_lead(server, wall, leader, leaving);
    for (struct stream *stream = server->streams.first; stream && leader; stream = stream->next) {
        struct session *session = stream->session;
        if (!is_of(stream, name) || stream == leaving || session == leader || !session->hello || session->following.leader == leader)
            continue;
        session_follow(session, leader, clock_mono_ns());
    }
    tell(server, wall, leaving);
}

/* --- pictures ------------------------------------------------------------------------------------------------------------- */

static void request(struct server_context *server, struct tile_wall *wall, const struct session_tiles *tiles, int64_t now_ns)
{
    struct frame_request requests[MEMBERS];
    enum request_outcome outcomes[MEMBERS];
    uint64_t clients[MEMBERS];
    if (!session_tiles_next_request(tiles, wall->asked + 1, now_ns, requests))
        return;
    wall->asked++;
    for (size_t i = 0; i < tiles->count; i++)
        clients[i] = tiles->members[i]->id;
    render_service_request_all(server->params.plant.render_service, tiles->count, clients, requests, outcomes);
    for (size_t i = 0; i < tiles->count; i++)
        if (outcomes[i] != REQUEST_REFUSED)
            session_requested(tiles->members[i], &requests[i], outcomes[i] == REQUEST_REPLACED);
}

void tiles_pump(struct server_context *server, const struct stream *stream)
{
    struct tile_wall *wall = find(server, stream->session->tile.place.wall);
    struct stream *streams[MEMBERS];
    struct session *members[MEMBERS];
    struct session_tiles tiles = { .members = members, .made = wall ? &wall->made : NULL };
    int64_t now_ns = clock_mono_ns();
    for (struct stream *other = server->streams.first; other && wall; other = other->next) {
        struct session *session = other->session;
        if (tiles.count == MEMBERS || other->close_code || !is_of(other, wall->wall) || !session_tile_takes_part(session, now_ns) ||
            (session->id != wall->leader && (!session->following.leader || session->following.leader->id != wall->leader)))
            continue;
        if (session->id == wall->leader)
            tiles.leader = session;
        streams[tiles.count] = other;
        members[tiles.count++] = session;
    }
    if (!tiles.leader)
        return;
    session_tiles_present(&tiles, &wall->presented, now_ns, clock_plant_ns(server->params.plant.clock));
    request(server, wall, &tiles, now_ns);
    for (size_t i = 0; i < tiles.count; i++)
        if (stream_has_output(streams[i], now_ns))
            lws_callback_on_writable(streams[i]->wsi);
}

void tiles_on_tick(struct server_context *server)
{
    int64_t now_ns = clock_mono_ns(), now_utc_ns = clock_plant_ns(server->params.plant.clock);
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        struct session *session = stream->session;
        if (!session_is_tile(session) || !session->hello)
            continue;
        session_tile_judge(session, now_ns, now_utc_ns);
        server->streams.restless = true;
    }
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (session_is_tile(stream->session) && stream->session->hello)
            tiles_gather(server, stream->session->tile.place.wall, NULL);
}
