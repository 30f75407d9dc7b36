/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the server says goes to the model and to panes; what is seen is drawn out of them. */
#include "player.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"
#include "brush.h"
#include "words.h"

static const int64_t POINT_NS = 4 * NS_PER_S, PAIRING_EVERY_NS = 2 * NS_PER_S;
static const char WALLS_PATH[] = "/api/v1/walls";

/* --- what comes: on the network's thread, under the lock ----------------------------------------------------------------------- */

static void want_views(struct player *player)
{
    for (int i = 0; i < WALL_PANES; i++) {
        bool wanted = i < player->pane_count && player->panes[i].known && player->panes[i].kind == PANE_VIEWS && !player->denied;
        if (player->links.at[1 + i].wanted && !wanted)
            view_pane_clear(&player->panes[i].view);
        player->links.at[1 + i].wanted = wanted;
    }
}

static json_t *words_hello(struct link *link)
{
    (void)link;
    return json_pack("{s:s,s:i,s:i,s:[s]}", "type", "hello", "width", 16, "height", 16, "codecs", "jpeg"); /* it is there for the words */
}

/* What is for one picture over many displays stands under the first of them. */
static bool is_for_us(const struct player *player, const struct pane *pane, const json_t *place)
{
    const char *wall = json_string_value(json_object_get(place, "wall")), *area = json_string_value(json_object_get(place, "area"));
    return wall && !strcmp(wall, player->wall_id) && area && !strcmp(area, pane->area) &&
           json_integer_value(json_object_get(place, "display")) == (pane->view.tile.display ? 1 : player->display);
}

static void on_pointed(struct player *player, const json_t *message)
{
    const json_t *list = json_object_get(message, "list");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *one = json_array_get(list, i), *place = json_object_get(one, "position");
        const char *by = json_string_value(json_object_get(one, "by"));
        int at = 0;
        while (at < player->pane_count && !is_for_us(player, &player->panes[at], one))
            at++;
        if (at == player->pane_count)
            continue;
        player->pointed = json_array_size(place) == 3 ? &player->panes[at] : NULL;
        for (size_t c = 0; c < 3; c++)
            player->pointed_m[c] = json_number_value(json_array_get(place, c));
        snprintf(player->pointed_by, sizeof(player->pointed_by), "%s", by ? by : "");
        player->pointed_ns = clock_mono_ns();
    }
}

static void words_text(struct link *link, const json_t *message)
{
    struct player *player = link->arg;
    const char *type = json_string_value(json_object_get(message, "type"));
    if (!model_hear(&player->model, message, clock_mono_ns()))
        link_restart(link);
    if (!strcmp(type, "welcome")) {
        player->denied = false;
        pairing_welcomed(&player->pairing);
        want_views(player);
        link_post(link, json_pack("{s:s,s:s,s:i}", "type", "display", "wall", player->wall_id, "display", player->display));
        links_ask(&player->links, GET_WALLS, WALLS_PATH);
        for (int i = 0; i < player->pane_count; i++)
            if (player->panes[i].view.greeted && (player->panes[i].view.missed || !view_pane_fits(&player->panes[i].view, &player->model)))
                link_restart(&player->links.at[1 + i]);
    } else if (!strcmp(type, "pointed")) {
        on_pointed(player, message);
    } else if (!strcmp(type, "error")) {
        fprintf(stderr, "plantcast-wall: the server answers: %s\n", json_string_value(json_object_get(message, "text")));
    }
    if (!strcmp(type, "alarms") || !strcmp(type, "welcome"))
        for (int i = 0; i < player->pane_count; i++)
            player->panes[i].view.overlay_due = true;
}

static void words_pong(struct link *link, const json_t *message)
{
    struct player *player = link->arg;
    model_pong(&player->model, message, clock_mono_ns());
}

static bool words_frame(struct link *link, const struct wire_frame *frame, const uint8_t *payload)
{
    (void)link;
    (void)frame;
    (void)payload;
    return true;
}

static void choose_token(void *arg)
{
    struct player *player = arg;
    pairing_choose_token(&player->pairing);
}

static void on_pairing(struct player *player, const json_t *answer)
{
    if (pairing_take(&player->pairing, &player->links, answer, clock_mono_ns()))
        link_restart(&player->links.at[0]);
}

/* The display is dark but for digits until there is a token that is let in. */
static void refused(struct link *link)
{
    struct player *player = link->arg;
    player->denied = true;
    if (link->index == 0 && player->pairing.enabled)
        pairing_refused(&player->pairing, &player->links, clock_mono_ns());
    if (link->index > 0)
        link_restart(&player->links.at[0]); /* it is for that one to say whether we are let in again */
    want_views(player);
    for (int i = 0; i < player->pane_count; i++)
        view_pane_clear(&player->panes[i].view);
}

static struct pane *pane_of(struct link *link)
{
    struct player *player = link->arg;
    return &player->panes[link->index - 1];
}

static json_t *view_hello(struct link *link)
{
    return view_pane_hello(&pane_of(link)->view);
}

static void view_text(struct link *link, const json_t *message)
{
    struct player *player = link->arg;
    struct pane *pane = pane_of(link);
    view_pane_hear(&pane->view, &player->model, message);
    if (!strcmp(json_string_value(json_object_get(message, "type")), "welcome"))
        text_finish(&pane->wanted); /* it is to be asked for again */
}

static void view_pong(struct link *link, const json_t *message)
{
    (void)link;
    (void)message;
}

static bool view_frame(struct link *link, const struct wire_frame *frame, const uint8_t *payload)
{
    struct player *player = link->arg;
    bool good = view_pane_decode(&pane_of(link)->view, &player->lock, frame, payload);
    pthread_mutex_lock(&player->lock);
    player->news = true;
    pthread_cond_signal(&player->woken);
    pthread_mutex_unlock(&player->lock);
    return good;
}

static void on_walls(struct player *player, const json_t *walls)
{
    if (!json_is_array(walls)) {
        links_ask(&player->links, GET_WALLS, WALLS_PATH);
        return;
    }
    if (player->walls && json_equal(player->walls, walls))
        return;
    json_decref(player->walls);
    player->walls = json_deep_copy(walls);
    layout_build(player);
    want_views(player);
}

static void on_got(void *arg, enum links_get what, const json_t *answer, const struct text *body)
{
    struct player *player = arg;
    switch (what) {
    case GET_WALLS: on_walls(player, json_object_get(answer, "walls")); break;
    case GET_HISTORY: trend_take(player, answer); break;
    case GET_OTHER_PLANTS: snapshots_take(player, answer); break;
    case GET_PAIRING: on_pairing(player, answer); break;
    default: snapshots_take_picture(player, body); break;
    }
}

/* --- life ------------------------------------------------------------------------------------------------------------------------- */

bool player_start(struct player *player)
{
    static const struct link_events words = { words_hello, words_text, words_pong, words_frame, refused };
    static const struct link_events views = { view_hello, view_text, view_pong, view_frame, refused };
    pthread_mutex_init(&player->lock, NULL);
    clock_cond_init(&player->woken);
    model_init(&player->model);
    player->call.shown = -1;
    player->lost_ns = player->lost_ns ? player->lost_ns : PLAYER_LOST_NS;
    player->begun_ns = clock_mono_ns();
    player->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, player->width_px, player->height_px);
    player->all_due = true;
    player->links.lock = &player->lock;
    player->links.url = &player->url;
    player->links.got = on_got;
    player->links.arg = player;
    player->links.choose_token = player->pairing.enabled ? choose_token : NULL;
    for (int i = 0; i < 1 + WALL_PANES; i++)
        player->links.at[i] =
            (struct link){ .links = &player->links, .events = i ? &views : &words, .arg = player, .index = i, .wanted = !i };
    return cairo_surface_status(player->surface) == CAIRO_STATUS_SUCCESS && links_start(&player->links);
}

void player_finish(struct player *player)
{
    links_stop(&player->links);
    for (int i = 0; i < WALL_PANES; i++) {
        view_pane_finish(&player->panes[i].view);
        text_finish(&player->panes[i].said);
        text_finish(&player->panes[i].state);
        text_finish(&player->panes[i].wanted);
        text_finish(&player->panes[i].words);
        text_finish(&player->panes[i].wrong);
        trend_finish(&player->panes[i].trend);
        snapshot_finish(&player->panes[i].snapshot);
    }
    model_finish(&player->model);
    json_decref(player->wall);
    json_decref(player->walls);
    text_finish(&player->card);
    cairo_surface_destroy(player->surface);
    pthread_cond_destroy(&player->woken);
    pthread_mutex_destroy(&player->lock);
}

void player_resize(struct player *player, int width_px, int height_px)
{
    pthread_mutex_lock(&player->lock);
    cairo_surface_destroy(player->surface);
    player->width_px = width_px;
    player->height_px = height_px;
    player->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
    if (player->walls)
        layout_build(player);
    want_views(player);
    player->all_due = true;
    pthread_mutex_unlock(&player->lock);
}

static int minute_of(const struct player *player)
{
    time_t seconds = (time_t)(model_now_us(&player->model) / 1000000);
    struct tm local;
    return localtime_r(&seconds, &local) ? local.tm_hour * 60 + local.tm_min : 0;
}

static bool is_tile(const struct player *player)
{
    return player->pane_count > 0 && player->panes[0].view.tile.display > 0;
}

static struct burn_shift shift_now(const struct player *player)
{
    return burn_shift_at(model_now_us(&player->model) * 1000);
}

struct burn_shift player_shift(struct player *player)
{
    pthread_mutex_lock(&player->lock);
    bool moves_within = is_tile(player) && player->card.length == 0;
    struct burn_shift shift = moves_within ? (struct burn_shift){ 0 } : shift_now(player);
    pthread_mutex_unlock(&player->lock);
    return shift;
}

bool player_is_tile(struct player *player)
{
    pthread_mutex_lock(&player->lock);
    bool tile = is_tile(player);
    pthread_mutex_unlock(&player->lock);
    return tile;
}

bool player_waits(struct player *player)
{
    bool waits = false;
    pthread_mutex_lock(&player->lock);
    for (int i = 0; i < player->pane_count; i++)
        waits |= player->panes[i].view.tile.order_count > 0;
    pthread_mutex_unlock(&player->lock);
    return waits;
}

void player_wait(struct player *player, int64_t until_ns)
{
    pthread_mutex_lock(&player->lock);
    while (!player->news && clock_cond_wait(&player->woken, &player->lock, until_ns))
        continue;
    player->news = false;
    pthread_mutex_unlock(&player->lock);
}

double player_brightness(struct player *player)
{
    pthread_mutex_lock(&player->lock);
    const json_t *dim = json_object_get(player->wall, "dim");
    bool calls = player->card.length > 0; /* what is said in large letters is not dimmed */
    for (size_t i = 0; i < player->model.list_count; i++)
        calls |= player->model.list[i].waiting;
    double light =
        dim ? rules_brightness(json_number_value(json_object_get(dim, "from_min")), json_number_value(json_object_get(dim, "to_min")),
                               json_number_value(json_object_get(dim, "percent")), minute_of(player), calls)
            : 1;
    pthread_mutex_unlock(&player->lock);
    return light;
}

/* --- drawing ---------------------------------------------------------------------------------------------------------------------- */

static void add_dirty(struct box *dirty, const struct box *more)
{
    double right = fmax(dirty->x + dirty->width, more->x + more->width), bottom = fmax(dirty->y + dirty->height, more->y + more->height);
    if (!(dirty->width > 0)) {
        *dirty = *more;
        return;
    }
    dirty->x = fmin(dirty->x, more->x);
    dirty->y = fmin(dirty->y, more->y);
    dirty->width = right - dirty->x;
    dirty->height = bottom - dirty->y;
}

/* Keeps the new text. Returns whether it is another one. */
static bool differs(struct text *kept, struct text *now)
{
    bool same = kept->at && now->at && !strcmp(kept->at, now->at);
    text_finish(kept);
    *kept = *now;
    *now = (struct text){ 0 };
    return !same;
}

/* What it never heard of, or was not let in to: it knows who it is, and since when it waits, by its own clock. */
static void say_self(const struct player *player, int64_t since_ns, struct text *card)
{
    char display[16], time[24] = "?";
    const struct daemon_url *url = &player->url;
    time_t begun = (time_t)((clock_utc_ns() - (clock_mono_ns() - since_ns)) / NS_PER_S);
    struct tm utc;
    snprintf(display, sizeof(display), "%d", player->display);
    if (gmtime_r(&begun, &utc))
        strftime(time, sizeof(time), "%H:%M:%S UTC", &utc);
    text_add(card, "lost\n%s\n%s\nhttp%s://%s:%d%s/", say("walls.never", NULL),
             say("walls.self", "wall", player->wall_id, "display", display, "time", time, NULL), url->tls ? "s" : "", url->host, url->port,
             url->base);
}

/* While it is not let in: what to do, the digits, and how long they are good, for which display. */
static void say_pairing(const struct player *player, int64_t now_ns, struct text *card)
{
    static const char *const keys[] = { [PAIRING_NOT] = "walls.denied",      [PAIRING_ASKS] = "walls.asks",
                                        [PAIRING_SHOWS] = "walls.digits",    [PAIRING_CROWDED] = "walls.crowded",
                                        [PAIRING_NOWHERE] = "walls.nowhere", [PAIRING_NEVER] = "walls.denied" };
    const struct pairing *pairing = &player->pairing;
    char display[16], left[16];
    int left_s = (int)fmax(0, ceil((double)(pairing->until_ns - now_ns) / 1e9));
    snprintf(display, sizeof(display), "%d", player->display);
    snprintf(left, sizeof(left), "%d:%02d", left_s / 60, left_s % 60);
    const char *text = say(keys[pairing->state], "wall", player->wall_id, "display", display, NULL);
    if (pairing->state == PAIRING_SHOWS)
        text_add(card, "digits\n%s\n%.3s %s\n%s\n%s", text, pairing->digits, pairing->digits + 3, say("walls.left", "time", left, NULL),
                 say("walls.place", "wall", player->wall_id, "display", display, NULL));
    else
        text_add(card, "denied\n%s", text);
}

/* Whoever is not let in is answered every few seconds. */
static bool pairing_is_lost(const struct player *player, int64_t now_ns)
{
    return player->pairing.enabled && now_ns - player->pairing.heard_ns >= player->lost_ns + PAIRING_EVERY_NS;
}

/* A word of what it is, then what it says, and below that in small letters what else there is to say; "" where nothing lies over
   everything. */
static void say_card(const struct player *player, int64_t now_ns, struct text *card)
{
    int64_t heard_ns = player->links.at[0].heard_ns;
    text_add(card, "%s", "");
    if (player->denied && pairing_is_lost(player, now_ns))
        say_self(player, player->pairing.heard_ns, card);
    else if (player->denied)
        say_pairing(player, now_ns, card);
    else if (now_ns - (heard_ns ? heard_ns : player->begun_ns) >= player->lost_ns && heard_ns && player->model.welcome)
        text_add(card, "lost\n%s",
                 say("walls.lost", "time", player_time(player, model_now_us(&player->model) - (now_ns - heard_ns) / 1000), NULL));
    else if (now_ns - (heard_ns ? heard_ns : player->begun_ns) >= player->lost_ns)
        say_self(player, player->begun_ns, card);
    else if (player->wrong[0])
        text_add(card, "wrong\n%s", player->wrong);
    else if (!player->wall || !player->model.welcome)
        text_add(card, "wait\n%s", say("health.connecting", NULL));
}

/* What to do, the digits as large as there is room for, and small lines below. */
static void draw_digits(const struct player *player, cairo_t *cairo)
{
    double width = player->width_px, height = player->height_px, small = fmin(width, height) / 26, gap = small / 2;
    char lines[4][sizeof(player->wrong)] = { "" };
    const char *at = player->card.at;
    for (int i = 0; i < 4 && (at = strchr(at, '\n')) != NULL; i++, at++)
        snprintf(lines[i], sizeof(lines[i]), "%.*s", (int)strcspn(at + 1, "\n"), at + 1);
    double size = fmin(0.3 * height, 0.3 * height * 0.9 * width / fmax(1, brush_measure(cairo, 0.3 * height, true, lines[1]).width));
    double sizes[] = { small, size, small, small }, heights[4], all = 3 * gap;
    for (int i = 0; i < 4; i++)
        all += heights[i] = brush_measure_wrapped(cairo, 0.92 * width, sizes[i], i == 1, lines[i]).height;
    struct box box = { 0.04 * width, fmax(0, 0.5 * (height - all)), 0.92 * width, 0 };
    brush_fill(cairo, &(struct box){ 0, 0, width, height }, 0x000000);
    for (int i = 0; i < 4; i++) {
        box.height = heights[i] + 1;
        brush_text(cairo, &box, sizes[i], i == 1, WHITE, ALIGN_CENTRE, i != 1, lines[i]);
        box.y += heights[i] + gap;
    }
}

static void draw_card(const struct player *player, cairo_t *cairo)
{
    if (!strncmp(player->card.at, "digits", 6)) {
        draw_digits(player, cairo);
        return;
    }
    double width = player->width_px, height = player->height_px;
    const json_t *inches = json_object_get(player->wall, "inches");
    double mm = rules_millimetres(inches ? json_number_value(inches) : 55, player->display_width_px, player->display_height_px);
    bool large = !strncmp(player->card.at, "lost", 4);
    double size = large ? fmin(100 / mm / 0.72, width / 12) : fmin(width, height) / 28;
    char text[sizeof(player->wrong) + 1];
    const char *said = strchr(player->card.at, '\n') + 1, *more = large ? strchr(said, '\n') : NULL;
    snprintf(text, sizeof(text), "%.*s", (int)(more ? more - said : (long)strlen(said)), said);
    struct box box = { 0.04 * width, 0, 0.92 * width, height };
    brush_fill(cairo, &(struct box){ 0, 0, width, height }, 0x000000);
    cairo_push_group(cairo); /* measured */
    double high = brush_text(cairo, &box, size, large, WHITE, ALIGN_CENTRE, true, text).height;
    cairo_pattern_destroy(cairo_pop_group(cairo));
    box.y = fmax(0, 0.5 * (height - high));
    box.height = height - box.y;
    brush_text(cairo, &box, size, large, WHITE, ALIGN_CENTRE, true, text);
    box.y += high + size / 2;
    box.height = height - box.y;
    if (more && box.height > 0)
        brush_text(cairo, &box, fmin(width, height) / 28, false, WHITE, ALIGN_CENTRE, true, more + 1);
}

static struct box body_of(const struct pane *pane)
{
    return (struct box){ pane->box.x, pane->box.y + pane->title_px, pane->box.width, pane->box.height - pane->title_px };
}

/* Over the picture: it is there, but what it shows is not what it seems. */
static void draw_banner(const struct player *player, cairo_t *cairo, const struct box *body, const char *text)
{
    double size = 18 * player->unit, wide = brush_measure(cairo, size, true, text).width + 2 * size;
    struct box box = { body->x + 0.5 * (body->width - wide), body->y + 0.6 * size, wide, 1.9 * size };
    brush_fill(cairo, &box, 0xa81f1a);
    box.y += 0.25 * size;
    brush_text(cairo, &box, size, true, WHITE, ALIGN_CENTRE, false, text);
}

/* On the first tile alone. It is moved, and its ground goes on to the display's edge. */
static void draw_tile_title(const struct player *player, const struct pane *pane, cairo_t *cairo)
{
    double size = 13 * player->unit;
    char title[512] = "";
    const char *about = pane->said.at ? strchr(pane->said.at, '\n') : NULL;
    if (about)
        snprintf(title, sizeof(title), "%.*s%s%s", (int)(about - pane->said.at - 2), pane->said.at + 2, about[1] ? " \u00b7 " : "",
                 about + 1);
    if (!title[0])
        return;
    const struct burn_shift *shift = &pane->view.shift;
    struct box box = { 0, 0, shift->x_px + brush_measure(cairo, size, true, title).width + 2 * size, shift->y_px + 1.9 * size };
    brush_fill(cairo, &box, SURFACE);
    box.x += shift->x_px + size;
    box.y += shift->y_px + 0.25 * size;
    brush_text(cairo, &box, size, true, INK, ALIGN_LEFT, false, title);
}

/* What is seen below its title, as a word; of "picture" also which. */
static void say_state(const struct player *player, const struct pane *pane, int64_t now_ns, struct text *state)
{
    const struct link *link = pane->view.link;
    const char *wrong = pane->wrong.length > 0 ? pane->wrong.at : NULL;
    bool lost = link->heard_ns && now_ns - link->heard_ns >= player->lost_ns;
    if (lost)
        text_add(state, "lost\n%s",
                 say("walls.lost", "time", player_time(player, model_now_us(&player->model) - (now_ns - link->heard_ns) / 1000), NULL));
    else if (pane->view.tile.late_us)
        text_add(state, "lost\n%s", say("walls.late", "time", player_time(player, pane->view.tile.late_us), NULL));
    else if (pane->view.refused[0] || (wrong && !pane->view.tile.display))
        text_add(state, "refused\n%s", wrong ? wrong : pane->view.refused);
    else if (!pane->view.picture || !pane->view.is_current)
        text_add(state, "wait\n%s", pane->view.greeted ? "\u2026" : say("health.connecting", NULL));
    else {
        bool incomplete = pane->view.tile.leads && pane->view.tile.missing[0];
        text_add(state, "picture %u", pane->view.frames);
        if (player->pointed == pane && now_ns - player->pointed_ns < POINT_NS)
            text_add(state, " %s %.3f %.3f %.3f", player->pointed_by, player->pointed_m[0], player->pointed_m[1], player->pointed_m[2]);
        notes_say(&player->model, state);
        text_add(state, "\n%s",
                 !player->model.live ? say("health.nodata", NULL)
                 : incomplete        ? say("walls.missing", "displays", pane->view.tile.missing, NULL)
                 : wrong             ? wrong
                                     : "");
    }
}

static void draw_state(struct player *player, struct pane *pane, cairo_t *cairo, int64_t now_ns)
{
    struct box body = body_of(pane);
    const char *text = strchr(pane->state.at, '\n') + 1;
    bool is_picture = !strncmp(pane->state.at, "picture", 7);
    cairo_save(cairo);
    cairo_rectangle(cairo, body.x, body.y, body.width, body.height);
    cairo_clip(cairo);
    struct box moved = { body.x + pane->view.shift.x_px, body.y + pane->view.shift.y_px, body.width, body.height };
    if (is_picture && view_pane_draw(&pane->view, &player->model, cairo, (int)body.x, (int)body.y)) {
        notes_draw(&pane->view, &player->model, cairo, body.x, body.y);
        if (player->pointed == pane && now_ns - player->pointed_ns < POINT_NS)
            notes_draw_pointer(&pane->view, cairo, body.x, body.y, player->pointed_m, player->pointed_by);
        if (*text)
            draw_banner(player, cairo, &moved, text);
        if (pane->view.tile.display == 1)
            draw_tile_title(player, pane, cairo);
    } else {
        bool lost = !strncmp(pane->state.at, "lost", 4);
        double size = (lost ? 24 : 13) * player->unit;
        brush_fill(cairo, &body, lost ? 0x000000 : SURFACE);
        struct box box = { moved.x + size, moved.y + 0.4 * body.height, body.width - 2 * size, 0.6 * body.height };
        brush_text(cairo, &box, size, lost, lost ? WHITE : INK_2, ALIGN_CENTRE, true, is_picture ? "\u2026" : text);
    }
    if (pane->called) {
        double line = 3 * player->unit;
        cairo_rectangle(cairo, body.x + line / 2, body.y - pane->title_px, body.width - line, body.height + pane->title_px - line / 2);
        brush_colour(cairo, ALERT);
        cairo_set_line_width(cairo, line);
        cairo_stroke(cairo);
    }
    cairo_restore(cairo);
}

static void say_view_title(const struct player *player, const struct pane *pane, int64_t now_ns, struct text *said)
{
    const struct model *model = &player->model;
    bool shown = pane->view.is_current && (pane->wrong.length == 0 || pane->view.tile.display);
    int group = shown ? pane->view.told.field.group : -1;
    char counts[200] = "";
    if (pane->view.tile.display) /* no list of alarms is beside it */
        pane_count_alarms(player, counts);
    text_add(said, "%d %s%s%s\n", pane->called, pane->words.at ? pane->words.at : "", counts[0] ? " \u00b7 " : "", counts);
    if (group >= 0 && (size_t)group < model->plant.group_count)
        text_add(said, "%s \u00b7 %s%s%s", model->plant.groups[group].quantity,
                 say("walls.age", "age", say_age(model_oldest_ns(model, NULL, 0, group, now_ns)), NULL), model->simulated ? " \u00b7 " : "",
                 model->simulated ? say("simulated.all", NULL) : "");
}

static void draw_view(struct player *player, struct pane *pane, cairo_t *cairo, int64_t now_ns, bool all, struct box *dirty)
{
    struct text said = { 0 }, state = { 0 };
    pane_choose(player, pane, now_ns);
    if (pane->view.tile.display) {
        view_pane_move(&pane->view, shift_now(player));
        view_pane_flip(&pane->view, &player->model, model_now_us(&player->model));
    }
    say_view_title(player, pane, now_ns, &said);
    say_state(player, pane, now_ns, &state);
    bool was_called = pane->said.at && pane->said.at[0] == '1';
    bool body_due = differs(&pane->state, &state) || pane->view.overlay_due || all || was_called != pane->called;
    if (differs(&pane->said, &said) || all) {
        const char *about = strchr(pane->said.at, '\n') + 1;
        const struct model_alarm *alarm = NULL;
        char title[512];
        snprintf(title, sizeof(title), "%.*s", (int)strcspn(pane->said.at + 2, "\n"), pane->said.at + 2);
        for (size_t i = 0; i < player->model.list_count && pane->called && !alarm; i++)
            if (player->model.list[i].tag * ALARM_KINDS + (int)player->model.list[i].kind == player->call.shown)
                alarm = &player->model.list[i];
        if (pane->title_px > 0)
            pane_draw_title(player, pane, cairo, title, about, alarm ? alarm->priority : 0,
                            alarm && alarm_status_is_cleared(alarm->status));
        body_due |= pane->called || pane->title_px <= 0; /* its frame goes around both */
        add_dirty(dirty, &(struct box){ pane->box.x, pane->box.y, pane->box.width, pane->title_px });
    }
    if (body_due) {
        draw_state(player, pane, cairo, now_ns);
        add_dirty(dirty, &(struct box){ pane->box.x, pane->box.y + pane->title_px, pane->box.width, pane->box.height - pane->title_px });
    }
}

static void draw_other(struct player *player, struct pane *pane, cairo_t *cairo, int64_t now_ns, bool all, struct box *dirty)
{
    struct text said = { 0 };
    if (pane->known && pane->kind == PANE_TREND)
        trend_ask(player, pane, now_ns);
    pane_say(player, pane, now_ns, &said);
    if (!differs(&pane->said, &said) && !all)
        return;
    cairo_save(cairo);
    cairo_rectangle(cairo, pane->box.x, pane->box.y, pane->box.width, pane->box.height);
    cairo_clip(cairo);
    pane_draw(player, pane, cairo, now_ns);
    cairo_restore(cairo);
    add_dirty(dirty, &pane->box);
}

/* The zone was set once before any thread began, so that this only changes a value. */
static void take_zone(const struct player *player)
{
    static char zone[64];
    const char *now = player->model.welcome && player->model.plant.time_zone[0] ? player->model.plant.time_zone : "UTC";
    if (!strcmp(zone, now))
        return;
    snprintf(zone, sizeof(zone), "%s", now);
    setenv("TZ", zone, 1);
    tzset();
}

bool player_draw(struct player *player, int64_t now_ns, struct box *dirty)
{
    struct text card = { 0 };
    *dirty = (struct box){ 0 };
    pthread_mutex_lock(&player->lock);
    take_zone(player);
    player->said_ns = player->links.at[0].heard_ns;
    say_card(player, now_ns, &card);
    bool all = differs(&player->card, &card) || player->all_due;
    player->all_due = false;
    player->ground = player->card.length > 0 || is_tile(player) ? 0 : GROUND;
    cairo_t *cairo = cairo_create(player->surface);
    struct box whole = { 0, 0, player->width_px, player->height_px };
    if (all)
        add_dirty(dirty, &whole);
    if (player->card.length > 0) {
        if (all)
            draw_card(player, cairo);
    } else {
        if (all)
            brush_fill(cairo, &whole, GROUND);
        snapshots_ask(player, now_ns);
        for (int i = 0; i < player->pane_count; i++) {
            struct pane *pane = &player->panes[i];
            bool is_view = pane->known && pane->kind == PANE_VIEWS;
            (is_view ? draw_view : draw_other)(player, pane, cairo, now_ns, all, dirty);
        }
    }
    cairo_destroy(cairo);
    cairo_surface_flush(player->surface);
    pthread_mutex_unlock(&player->lock);
    return dirty->width > 0;
}
