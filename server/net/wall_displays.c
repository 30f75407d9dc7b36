/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures how current each wall display is, by the age of the oldest picture among its panes (areas of the screen). A
   disconnected display stays listed, and its age keeps growing. */
#include "net/wall_displays.h"

#include <stdio.h>
#include <string.h>

#include "net/stream.h"

static struct wall_seen *find(struct server_context *server, const struct wall_place *display)
{
    struct wall_displays *all = &server->displays;
    for (size_t i = 0; i < all->count; i++)
        if (all->at[i].display == display->display && !strcmp(all->at[i].wall, display->wall))
            return &all->at[i];
    if (all->count == WALL_DISPLAYS_SEEN)
        return NULL;
    char name[160];
    struct wall_seen *seen = &all->at[all->count++];
    snprintf(seen->wall, sizeof(seen->wall), "%s", display->wall);
    seen->display = display->display;
    snprintf(name, sizeof(name), "plantcast_wall_frame_age_seconds{wall=\"%s\",display=\"%d\"}", display->wall, display->display);
    seen->age = counters_add_seconds(server->params.counters, name, "gauge",
                                     "Age of the picture on a display of a wall; keeps rising while the display is disconnected.");
    return seen;
}

void wall_displays_count(struct server_context *server, int64_t now_ns)
{
    struct wall_displays *all = &server->displays;
    for (size_t i = 0; i < all->count; i++)
        all->at[i].connected_ns = 0;
    for (const struct stream *stream = server->streams.first; stream; stream = stream->next) {
        const struct session *session = stream->session;
        struct wall_seen *seen = session->display.display > 0 ? find(server, &session->display) : NULL;
        int64_t fresh_ns = seen ? session_fresh_ns(session) : 0;
        if (seen && fresh_ns > 0 && (!seen->connected_ns || fresh_ns < seen->connected_ns))
            seen->connected_ns = fresh_ns;
    }
    for (size_t i = 0; i < all->count; i++) {
        struct wall_seen *seen = &all->at[i];
        if (seen->connected_ns)
            seen->fresh_ns = seen->connected_ns;
        counter_set(seen->age, seen->fresh_ns ? (now_ns - seen->fresh_ns) / 1000 : 0);
        wall_remote_see(server->params.plant.wall_remote, seen->wall, seen->display, seen->connected_ns != 0);
    }
}
