/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of other plants, as this plant's server hands them on; in letters, why there is none. */
#include "player.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "brush.h"
#include "clients/link/png.h"
#include "words.h"

static const int64_t ASK_NS = NS_PER_S, UNHEARD_NS = 5 * NS_PER_S;
static const double LETTERS = 13; /* units */

void snapshot_finish(struct snapshot_pane *snapshot)
{
    cairo_surface_destroy(snapshot->picture);
    cairo_surface_destroy(snapshot->fitted);
    *snapshot = (struct snapshot_pane){ 0 };
}

static bool is_snapshot(const struct pane *pane)
{
    return pane->known && pane->kind == PANE_SNAPSHOT;
}

static const char *id_of(const struct pane *pane)
{
    const char *id = json_string_value(json_array_get(pane->items, 0));
    return id ? id : "";
}

/* --- asking ------------------------------------------------------------------------------------------------------------------------- */

static void ask_states(struct player *player, int64_t now_ns)
{
    struct text path = { 0 };
    text_add(&path, "/api/v1/other_plants");
    bool first = true;
    for (int i = 0; i < player->pane_count; i++) {
        if (!is_snapshot(&player->panes[i]))
            continue;
        text_add(&path, first ? "?id=" : "&id=");
        text_add_escaped(&path, id_of(&player->panes[i]));
        first = false;
    }
    player->others_asked_ns = now_ns;
    links_ask(&player->links, GET_OTHER_PLANTS, path.at);
    text_finish(&path);
}

static void ask_picture(struct player *player, struct pane *pane)
{
    struct text path = { 0 };
    text_add(&path, "/api/v1/other_plants/picture?id=");
    text_add_escaped(&path, id_of(pane));
    text_add(&path, "&picture=%lld", (long long)pane->snapshot.told);
    pane->snapshot.asks = true;
    pane->snapshot.asked = pane->snapshot.told;
    pane->snapshot.asked_age_ns = pane->snapshot.age_ns;
    pane->snapshot.asked_ns = pane->snapshot.heard_ns;
    links_ask(&player->links, GET_OTHER_PICTURE, path.at);
    text_finish(&path);
}

void snapshots_ask(struct player *player, int64_t now_ns)
{
    struct pane *next = NULL;
    bool any = false, asks = false;
    for (int i = 0; i < player->pane_count; i++) {
        struct pane *pane = &player->panes[i];
        if (!is_snapshot(pane))
            continue;
        any = true;
        asks |= pane->snapshot.asks;
        if (!next && pane->snapshot.told && pane->snapshot.told != pane->snapshot.shown && pane->snapshot.told != pane->snapshot.failed)
            next = pane;
    }
    if (any && now_ns - player->others_asked_ns >= ASK_NS)
        ask_states(player, now_ns);
    if (next && !asks) /* one at a time */
        ask_picture(player, next);
}

static void take_state(struct snapshot_pane *snapshot, const json_t *state, int64_t asked_ns)
{
    const char *name = json_string_value(json_object_get(state, "name")), *why = json_string_value(json_object_get(state, "why"));
    const json_t *age = json_object_get(state, "age_ms");
    int64_t told = json_integer_value(json_object_get(state, "picture"));
    if (told != snapshot->told)
        snapshot->changed_ns = asked_ns;
    snapshot->told = told;
    snapshot->heard_ns = asked_ns; /* what it took to answer counts as age */
    snapshot->age_ns = json_is_integer(age) ? json_integer_value(age) * NS_PER_MS : -1;
    snapshot->since_us = json_integer_value(json_object_get(state, "since_us"));
    snprintf(snapshot->name, sizeof(snapshot->name), "%s", name ? name : "");
    snprintf(snapshot->why, sizeof(snapshot->why), "%s", why ? why : "");
}

void snapshots_take(struct player *player, const json_t *answer)
{
    const json_t *list = json_object_get(answer, "list");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *state = json_array_get(list, i);
        const char *id = json_string_value(json_object_get(state, "id"));
        for (int k = 0; k < player->pane_count && id; k++)
            if (is_snapshot(&player->panes[k]) && !strcmp(id_of(&player->panes[k]), id))
                take_state(&player->panes[k].snapshot, state, player->others_asked_ns);
    }
}

void snapshots_take_picture(struct player *player, const struct text *body)
{
    for (int i = 0; i < player->pane_count; i++) {
        struct snapshot_pane *snapshot = &player->panes[i].snapshot;
        if (!snapshot->asks)
            continue;
        cairo_surface_t *picture = png_read(body->at, body->length);
        snapshot->asks = false;
        if (!picture) { /* also where it has been followed by another one */
            snapshot->failed = snapshot->asked;
            continue;
        }
        cairo_surface_destroy(snapshot->picture);
        cairo_surface_destroy(snapshot->fitted);
        snapshot->picture = picture;
        snapshot->fitted = NULL;
        snapshot->shown = snapshot->asked;
        snapshot->shown_ns = snapshot->asked_ns;
        snapshot->shown_age_ns = snapshot->asked_age_ns;
    }
}

/* --- what is seen ----------------------------------------------------------------------------------------------------------------- */

/* Why its picture is not shown, a key of the page's words; "": it is. */
static const char *why_not(const struct snapshot_pane *snapshot, int64_t now_ns)
{
    if (!snapshot->heard_ns)
        return "waiting";
    if (now_ns - snapshot->heard_ns > UNHEARD_NS)
        return "unheard";
    if (!snapshot->told)
        return snapshot->why;
    if (!snapshot->shown)
        return "waiting";
    return snapshot->shown == snapshot->told || now_ns - snapshot->changed_ns < UNHEARD_NS ? "" : "unheard";
}

void snapshot_say(struct player *player, const struct pane *pane, int64_t now_ns, struct text *said)
{
    const struct snapshot_pane *snapshot = &pane->snapshot;
    const char *why = why_not(snapshot, now_ns), *name = snapshot->name[0] ? snapshot->name : id_of(pane);
    text_add(said, "%s\n%s", pane->title ? pane->title : name, pane->title ? name : "");
    if (*why) {
        char key[64];
        snprintf(key, sizeof(key), "others.%s", why);
        bool waits = !strcmp(why, "waiting");
        const char *gone = waits ? "" : say("others.gone", "name", name, "time", player_time(player, snapshot->since_us), NULL);
        text_add(said, "\n%s\n%s", gone, say(key, NULL));
        return;
    }
    int64_t age_ns = snapshot->shown_age_ns < 0 ? -1 : snapshot->shown_age_ns + now_ns - snapshot->shown_ns;
    text_add(said, "%s%s\n%lld", pane->title ? " \u00b7 " : "", say("walls.age", "age", say_age(age_ns), NULL), (long long)snapshot->shown);
}

/* As large as there is room for; scaled once. */
static void fit(struct snapshot_pane *snapshot, const struct box *body)
{
    int width = (int)body->width, height = (int)body->height;
    double wide = cairo_image_surface_get_width(snapshot->picture), high = cairo_image_surface_get_height(snapshot->picture);
    double scale = fmin(width / wide, height / high);
    snapshot->fitted = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    cairo_t *cairo = cairo_create(snapshot->fitted);
    brush_fill(cairo, &(struct box){ 0, 0, width, height }, SURFACE);
    cairo_translate(cairo, 0.5 * (width - scale * wide), 0.5 * (height - scale * high));
    cairo_scale(cairo, scale, scale);
    cairo_set_source_surface(cairo, snapshot->picture, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_GOOD);
    cairo_paint(cairo);
    cairo_destroy(cairo);
}

static void draw_card(const struct player *player, cairo_t *cairo, const struct box *body, const char *gone, const char *why)
{
    double size = LETTERS * player->unit, large = 1.9 * size, pad = size;
    brush_fill(cairo, body, 0x000000);
    double above = *gone ? 2.4 * large : size;
    struct box box = { body->x + pad, body->y + fmax(0, 0.5 * body->height - above), body->width - 2 * pad, body->height };
    if (*gone) {
        double high = brush_text(cairo, &box, large, true, WHITE, ALIGN_CENTRE, true, gone).height;
        box.y += high + 0.5 * size;
    }
    box.height = fmax(size, body->y + body->height - box.y);
    brush_text(cairo, &box, size, false, WHITE, ALIGN_CENTRE, true, why);
}

void snapshot_draw(struct player *player, struct pane *pane, cairo_t *cairo, const struct box *body, int64_t now_ns)
{
    struct snapshot_pane *snapshot = &pane->snapshot;
    const char *why = why_not(snapshot, now_ns);
    if (*why) {
        const char *gone = strchr(strchr(pane->said.at, '\n') + 1, '\n') + 1, *reason = strchr(gone, '\n') + 1;
        char line[256];
        snprintf(line, sizeof(line), "%.*s", (int)strcspn(gone, "\n"), gone);
        draw_card(player, cairo, body, line, reason);
        return;
    }
    if (!snapshot->fitted)
        fit(snapshot, body);
    cairo_set_source_surface(cairo, snapshot->fitted, body->x, body->y);
    cairo_paint(cairo);
}
