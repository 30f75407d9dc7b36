/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From what the plant file says of a wall to panes and their places. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "player.h"
#include "words.h"

static const double EDGE_PX = 4, GAP = 3, TITLE = 21; /* the latter in units */

static const json_t *find_wall(const struct player *player, char known[300])
{
    known[0] = 0;
    for (size_t i = 0; i < json_array_size(player->walls); i++) {
        const json_t *wall = json_array_get(player->walls, i);
        const char *id = json_string_value(json_object_get(wall, "id"));
        if (id && !strcmp(id, player->wall_id))
            return wall;
        snprintf(known + strlen(known), 300 - strlen(known), "%s%s", known[0] ? ", " : "", id ? id : "?");
    }
    return NULL;
}

static void say_wrong(struct player *player, const char *text)
{
    if (strcmp(player->wrong, text) != 0)
        fprintf(stderr, "plantcast-wall: %s\n", text);
    snprintf(player->wrong, sizeof(player->wrong), "%s", text);
}

/* The cells of the grid that an area takes: first and last column and row. Returns how many columns the grid has. */
static int find_cells(const json_t *grid, const char *area, int cells[4])
{
    int columns = 0;
    cells[0] = cells[2] = INT32_MAX;
    cells[1] = cells[3] = -1;
    for (size_t row = 0; row < json_array_size(grid); row++) {
        const char *at = json_string_value(json_array_get(grid, row));
        int column = 0;
        for (at = at ? at + strspn(at, " ") : ""; *at; at += strspn(at, " "), column++) {
            size_t length = strcspn(at, " ");
            if (length == strlen(area) && !strncmp(at, area, length)) {
                cells[0] = column < cells[0] ? column : cells[0];
                cells[1] = column > cells[1] ? column : cells[1];
                cells[2] = (int)row < cells[2] ? (int)row : cells[2];
                cells[3] = (int)row > cells[3] ? (int)row : cells[3];
            }
            at += length;
        }
        columns = column > columns ? column : columns;
    }
    return columns;
}

static bool place(const struct player *player, const json_t *grid, struct pane *pane)
{
    int cells[4], columns = find_cells(grid, pane->area, cells), rows = (int)json_array_size(grid);
    double gap = GAP * player->unit, width = (player->width_px - 2 * EDGE_PX + gap) / fmax(columns, 1),
           height = (player->height_px - 2 * EDGE_PX + gap) / fmax(rows, 1);
    if (cells[1] < 0)
        return false;
    pane->box.x = round(EDGE_PX + cells[0] * width);
    pane->box.y = round(EDGE_PX + cells[2] * height);
    pane->box.width = round(EDGE_PX + (cells[1] + 1) * width - gap) - pane->box.x;
    pane->box.height = round(EDGE_PX + (cells[3] + 1) * height - gap) - pane->box.y;
    pane->title_px = round(TITLE * player->unit);
    return pane->box.width >= 32 && pane->box.height >= pane->title_px + 32;
}

static void read_kind(struct pane *pane)
{
    static const char *const names[] = {
        [PANE_VIEWS] = "views", [PANE_ALARMS] = "alarms", [PANE_TILES] = "tiles",
        [PANE_CLOCK] = "clock", [PANE_TEXT] = "text",     [PANE_TREND] = "trend",
        [PANE_SNAPSHOT] = "snapshot",
    };
    pane->known = false;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (names[i] && !strcmp(names[i], pane->kind_name)) {
            pane->kind = (enum pane_kind)i;
            pane->known = true;
        }
}

static const char *string_or(const json_t *o, const char *name, const char *otherwise)
{
    const char *text = json_string_value(json_object_get(o, name));
    return text ? text : otherwise;
}

static void add_pane(struct player *player, const json_t *o, const json_t *grid)
{
    struct pane *pane = &player->panes[player->pane_count];
    struct link *link = &player->links.at[1 + player->pane_count];
    pane->area = string_or(o, "area", "");
    pane->title = string_or(o, "title", NULL);
    pane->kind_name = string_or(o, "kind", "?");
    pane->items = json_object_get(o, "items");
    pane->stops = json_object_get(o, "stops");
    pane->every_s = fmax(1, json_number_value(json_object_get(o, "every_s")));
    trend_finish(&pane->trend);
    snapshot_finish(&pane->snapshot);
    pane->trend.hours = json_number_value(json_object_get(o, "hours"));
    pane->on_alarm = json_is_true(json_object_get(o, "on_alarm"));
    pane->at = 0;
    pane->changed_ns = 0;
    pane->called = false;
    read_kind(pane);
    const json_t *tile = json_object_get(o, "tile");
    pane->view.tile.display = (int)json_integer_value(json_object_get(tile, "number"));
    pane->view.tile.columns = (int)json_integer_value(json_object_get(tile, "columns"));
    pane->view.tile.rows = (int)json_integer_value(json_object_get(tile, "rows"));
    pane->view.tile.wall = player->wall_id;
    if (tile) { /* from edge to edge */
        pane->box = (struct box){ 0, 0, player->width_px, player->height_px };
        pane->title_px = 0;
    } else if (!place(player, grid, pane)) {
        return;
    }
    text_finish(&pane->said);
    text_finish(&pane->state);
    text_finish(&pane->wanted);
    view_pane_init(&pane->view, link, (int)pane->box.width, (int)(pane->box.height - pane->title_px), player->unit, player->by_gpu);
    link_restart(link);
    player->pane_count++;
}

void layout_build(struct player *player)
{
    char known[300], number[16], count[16];
    const json_t *wall = find_wall(player, known);
    const json_t *displays = json_object_get(wall, "displays");
    const json_t *display = player->display >= 1 ? json_array_get(displays, (size_t)player->display - 1) : NULL;
    player->pane_count = 0;
    player->pointed = NULL;
    player->all_due = true;
    json_decref(player->wall);
    player->wall = wall ? json_deep_copy(wall) : NULL;
    snprintf(number, sizeof(number), "%d", player->display);
    snprintf(count, sizeof(count), "%zu", json_array_size(displays));
    if (!wall) {
        say_wrong(player, say("walls.unknown", "id", player->wall_id, "known", known[0] ? known : say("none", NULL), NULL));
        return;
    }
    if (!display) {
        say_wrong(player, say("walls.display", "n", number, "id", player->wall_id, "count", count, NULL));
        return;
    }
    player->wrong[0] = 0;
    display = json_array_get(json_object_get(player->wall, "displays"), (size_t)player->display - 1); /* of our own copy */
    player->unit = rules_unit(json_number_value(json_object_get(player->wall, "inches")),
                              json_number_value(json_object_get(player->wall, "distance_m")), player->display_width_px,
                              player->display_height_px, player->width_px, player->height_px);
    const json_t *panes = json_object_get(display, "panes");
    for (size_t i = 0; i < json_array_size(panes) && player->pane_count < WALL_PANES; i++)
        add_pane(player, json_array_get(panes, i), json_object_get(display, "grid"));
}
