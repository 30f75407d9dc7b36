/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the player of walls draws, without a window. */
#include "wall_source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "clients/wall/player.h"
#include "clients/wall/words.h"

static const int64_t LOST_NS = 2700000000; /* what is drawn reaches who watches within 3 s */

struct wall_source {
    const struct options *options;
    struct player player;
    char title[200], headline[300];
    char zone_name[64];
    GTimeZone *zone;
    bool card;
    gint64 since_us; /* UTC: that there are no values; 0: there are */
};

struct wall_source *wall_source_create(const struct options *options)
{
    struct wall_source *source = g_new0(struct wall_source, 1);
    source->options = options;
    source->zone = g_time_zone_new_utc();
    source->player.wall_id = options->wall;
    source->player.display = options->display;
    source->player.width_px = source->player.display_width_px = options->width_px;
    source->player.height_px = source->player.display_height_px = canvas_picture_px(options->height_px);
    source->player.lost_ns = LOST_NS;
    setenv("TZ", "UTC", 1); /* until the plant's own is known */
    srand((unsigned)g_random_int());
    if (!daemon_set_options(options->token_path, options->ca_path) ||
        !daemon_url_parse(options->url, &source->player.url) || !player_start(&source->player))
        wall_source_destroy(&source);
    return source;
}

void wall_source_destroy(struct wall_source **pointer)
{
    struct wall_source *source = *pointer;
    if (!source)
        return;
    if (source->player.surface)
        player_finish(&source->player);
    g_time_zone_unref(source->zone);
    g_free(source);
    *pointer = NULL;
}

static void take_zone(struct wall_source *source, const char *name)
{
    if (!strcmp(source->zone_name, name))
        return;
    g_strlcpy(source->zone_name, name, sizeof(source->zone_name));
    GTimeZone *zone = g_time_zone_new_identifier(name[0] ? name : "UTC");
    g_time_zone_unref(source->zone);
    source->zone = zone ? zone : g_time_zone_new_utc();
}

/* The age of the oldest value of any group that has one. */
static int64_t oldest_ns(const struct model *model, int64_t now_ns)
{
    int64_t oldest_ns = -1;
    for (int i = 0; i < (int)model->plant.group_count; i++)
        oldest_ns = MAX(oldest_ns, model_oldest_ns(model, NULL, 0, i, now_ns));
    return oldest_ns;
}

/* Its own card, that it has no server or no right; or that the server has no values: a picture of before would be the last one. */
static void say_card(struct wall_source *source)
{
    const struct player *player = &source->player;
    const char *text = player->card.at ? strchr(player->card.at, '\n') : NULL;
    source->card = player->card.length > 0 || !player->model.live;
    g_strlcpy(source->headline, player->card.length > 0 && text ? text + 1 : say("health.nodata", NULL), sizeof(source->headline));
    source->headline[strcspn(source->headline, "\n")] = 0;
    if (!source->card || player->card.length > 0) /* the latter says itself since when */
        source->since_us = 0;
    else if (!source->since_us)
        source->since_us = g_get_real_time();
}

/* A tile goes on in others: it has all of the video, and no strip. */
static bool fit(struct wall_source *source)
{
    bool tile = player_is_tile(&source->player);
    int height_px = tile ? source->options->height_px : canvas_picture_px(source->options->height_px);
    if (height_px != source->player.height_px) {
        pthread_mutex_lock(&source->player.lock);
        source->player.display_height_px = height_px;
        pthread_mutex_unlock(&source->player.lock);
        player_resize(&source->player, source->options->width_px, height_px);
    }
    return tile;
}

void wall_source_look(struct wall_source *source, struct shown *out)
{
    struct player *player = &source->player;
    bool tile = fit(source);
    int64_t now_ns = clock_mono_ns();
    struct box dirty;
    player_draw(player, now_ns, &dirty);
    pthread_mutex_lock(&player->lock);
    say_card(source);
    take_zone(source, player->model.welcome ? player->model.plant.time_zone : "");
    snprintf(source->title, sizeof(source->title), "%s%s%s \u00b7 %d", player->model.welcome ? player->model.plant.name : "",
             player->model.welcome ? " \u00b7 " : "", player->wall_id, player->display);
    int64_t age_ns = source->card ? -1 : oldest_ns(&player->model, now_ns);
    pthread_mutex_unlock(&player->lock);
    struct burn_shift shift = player_shift(player);
    *out = (struct shown){
        .picture = source->card ? NULL : player->surface,
        .headline = source->headline,
        .detail = "",
        .since_us = source->since_us,
        .title = source->options->title ? source->options->title : source->title,
        .age_ms = age_ns < 0 ? -1 : age_ns / 1000000,
        .zone = source->zone,
        .shift_x = shift.x_px,
        .shift_y = shift.y_px,
        .dim = source->card ? 0 : 1 - player_brightness(player),
        .whole = tile,
    };
}

guint64 wall_source_pictures(const struct wall_source *source)
{
    guint64 count = 0;
    for (int i = 0; i < source->player.pane_count; i++)
        count += source->player.panes[i].view.frames;
    return count;
}
