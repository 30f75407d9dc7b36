/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `walls`: what each display of a control room shows. */
#include <string.h>

#include "base/mem.h"
#include "plant/parse/suggest.h"
#include "plant/plant_impl.h"
#include "plant/walls/wall.h"

const char *const pane_kind_names[] = {
    [PANE_VIEWS] = "views", [PANE_TREND] = "trend", [PANE_ALARMS] = "alarms", [PANE_TILES] = "tiles",
    [PANE_CLOCK] = "clock", [PANE_TEXT] = "text",   [PANE_TOUR] = "tour",     [PANE_SNAPSHOT] = "snapshot"
};

static const double MAX_BEZEL_MM = 200;

static void add_item(struct wall_pane *pane, const yaml_node_t *node)
{
    struct text_position place = yaml_place(node);
    pane->item_lines[pane->item_count] = place.line;
    pane->item_columns[pane->item_count] = place.column;
    pane->items[pane->item_count++] = mem_strdup(yaml_text(node));
}

/* Reads the content of a wall display's pane from the plant file: one text or a list of texts, such as names of views. */
static void read_items(struct yaml_reader *reader, yaml_node_t *node, struct wall_pane *pane)
{
    const char *name = pane_kind_names[pane->kind];
    bool one = node->type == YAML_SCALAR_NODE;
    int count = one ? 1 : yaml_list_count(reader, node, name);
    if (count == 0 || count > PANE_ITEMS)
        yaml_error(reader, yaml_place(node), "%s: expected 1 to %d, found %d", name, PANE_ITEMS, count);
    for (int i = 0; i < count && i < PANE_ITEMS; i++) {
        yaml_node_t *item = one ? node : yaml_list_item(reader, node, i);
        if (yaml_text(item) && *yaml_text(item))
            add_item(pane, item);
        else
            yaml_expected(reader, item, name, "text");
    }
}

#define READ_AS(name, of_kind)                                                                                                             \
    static void name(struct yaml_reader *reader, yaml_node_t *node, void *record)                                                          \
    {                                                                                                                                      \
        ((struct wall_pane *)record)->kind = (of_kind);                                                                                    \
        read_items(reader, node, record);                                                                                                  \
    }
READ_AS(read_views, PANE_VIEWS)
READ_AS(read_trend, PANE_TREND)
READ_AS(read_tiles, PANE_TILES)
READ_AS(read_text, PANE_TEXT)
READ_AS(read_alarms, PANE_ALARMS)
READ_AS(read_clock, PANE_CLOCK)
READ_AS(read_tour, PANE_TOUR)
READ_AS(read_snapshot, PANE_SNAPSHOT)

static bool grid_has(const struct wall_display *display, const char *area)
{
    size_t length = strlen(area);
    for (size_t i = 0; i < display->row_count; i++)
        for (const char *at = display->rows[i]; *at; at += strspn(at, " ")) {
            size_t word = strcspn(at, " ");
            if (word == length && !strncmp(at, area, length))
                return true;
            at += word;
        }
    return false;
}

static int word_count(const char *row)
{
    int count = 0;
    for (const char *at = row + strspn(row, " "); *at; at += strspn(at, " ")) {
        at += strcspn(at, " ");
        count++;
    }
    return count;
}

/* Returns the area name in a column (from 0) of a row of a display's grid; the row must have that many columns. */
static const char *word_at(const char *row, int column, size_t *length)
{
    const char *at = row + strspn(row, " ");
    for (int i = 0; i < column; i++) {
        at += strcspn(at, " ");
        at += strspn(at, " ");
    }
    *length = strcspn(at, " ");
    return at;
}

static bool same_word(const struct wall_display *display, size_t row, int column, const char *word, size_t length)
{
    size_t other_length;
    const char *other = word_at(display->rows[row], column, &other_length);
    return other_length == length && !strncmp(other, word, length);
}

static bool is_rectangle(const struct wall_display *display, int columns, const char *word, size_t length)
{
    size_t top = display->row_count, bottom = 0, count = 0;
    int left = columns, right = 0;
    for (size_t row = 0; row < display->row_count; row++)
        for (int column = 0; column < columns; column++) {
            if (!same_word(display, row, column, word, length))
                continue;
            top = row < top ? row : top;
            bottom = row;
            left = column < left ? column : left;
            right = column > right ? column : right;
            count++;
        }
    return count == (bottom - top + 1) * (size_t)(right - left + 1);
}

static bool is_first(const struct wall_display *display, size_t row, int column, int columns)
{
    size_t length;
    const char *word = word_at(display->rows[row], column, &length);
    for (size_t place = 0; place < row * (size_t)columns + (size_t)column; place++)
        if (same_word(display, place / (size_t)columns, (int)(place % (size_t)columns), word, length))
            return false;
    return !(length == 1 && *word == '.');
}

static void check_grid(struct yaml_reader *reader, struct text_position place, const struct wall_display *display)
{
    int columns = display->row_count ? word_count(display->rows[0]) : 0;
    for (size_t i = 0; i < display->row_count; i++)
        if (word_count(display->rows[i]) != columns || columns == 0) {
            yaml_error(reader, place, "grid: expected the same number of areas in each row, found %d in the first row and %d in '%.60s'",
                       columns, word_count(display->rows[i]), display->rows[i]);
            return;
        }
    for (size_t row = 0; row < display->row_count; row++)
        for (int column = 0; column < columns; column++) {
            size_t length;
            const char *word = word_at(display->rows[row], column, &length);
            if (is_first(display, row, column, columns) && !is_rectangle(display, columns, word, length))
                yaml_error(reader, place, "grid: the cells of area '%.*s' do not form one rectangle", (int)length, word);
        }
}

static void read_pane(struct yaml_reader *reader, yaml_node_t *node, struct wall_display *display, struct wall_pane *pane)
{
    static const struct yaml_choice yes[] = { { "no", 0 }, { "yes", 1 }, { 0 } };
    static const struct yaml_key keys[] = { { "area", KEY_NAME, true, offsetof(struct wall_pane, area), 0, 0, NULL, NULL },
                                            { "title", KEY_NAME, false, offsetof(struct wall_pane, title), 0, 0, NULL, NULL },
                                            { "every_s", KEY_NUMBER, false, offsetof(struct wall_pane, every_s), 5, 86400, NULL, NULL },
                                            { "hours", KEY_NUMBER, false, offsetof(struct wall_pane, hours), 0.1, 24 * 31, NULL, NULL },
                                            { "on_alarm", KEY_FLAG, false, offsetof(struct wall_pane, on_alarm), 0, 0, yes, NULL },
                                            { "views", KEY_CUSTOM, false, 0, 0, 0, NULL, read_views },
                                            { "trend", KEY_CUSTOM, false, 0, 0, 0, NULL, read_trend },
                                            { "alarms", KEY_CUSTOM, false, 0, 0, 0, NULL, read_alarms },
                                            { "tiles", KEY_CUSTOM, false, 0, 0, 0, NULL, read_tiles },
                                            { "clock", KEY_CUSTOM, false, 0, 0, 0, NULL, read_clock },
                                            { "text", KEY_CUSTOM, false, 0, 0, 0, NULL, read_text },
                                            { "tour", KEY_CUSTOM, false, 0, 0, 0, NULL, read_tour },
                                            { "snapshot", KEY_CUSTOM, false, 0, 0, 0, NULL, read_snapshot },
                                            { 0 } };
    struct yaml_map map;
    int kinds = 0;
    *pane = (struct wall_pane){ .every_s = 30, .hours = 8 };
    if (!yaml_map_read(reader, node, "a pane", keys, pane, &map))
        return;
    for (size_t i = 0; i < sizeof(pane_kind_names) / sizeof(*pane_kind_names); i++)
        kinds += yaml_map_has(&map, pane_kind_names[i]);
    if (kinds != 1)
        yaml_error(reader, map.place,
                   "pane: must have exactly one of views, trend, alarms, tiles, clock, text, tour and snapshot; this one has %d", kinds);
    else if ((pane->kind == PANE_TOUR || pane->kind == PANE_SNAPSHOT) && pane->item_count > 1)
        yaml_error(reader, yaml_map_place(&map, pane_kind_names[pane->kind]), "%s: expected one item, found %zu",
                   pane_kind_names[pane->kind], pane->item_count);
    else if (pane->on_alarm && pane->kind != PANE_VIEWS && pane->kind != PANE_TOUR)
        yaml_error(reader, yaml_map_place(&map, "on_alarm"), "on_alarm: allowed only for a pane with `views`");
    else if (pane->kind != PANE_VIEWS && yaml_map_has(&map, "every_s"))
        yaml_error(reader, yaml_map_place(&map, "every_s"), "every_s: allowed only for a pane with `views`");
    if (!pane->area)
        return;
    if (!grid_has(display, pane->area))
        yaml_error(reader, yaml_map_place(&map, "area"), "area: the grid has no area '%.40s'", pane->area);
    size_t other = 0;
    while (&display->panes[other] < pane && (!display->panes[other].area || strcmp(display->panes[other].area, pane->area) != 0))
        other++;
    if (&display->panes[other] < pane)
        yaml_error(reader, yaml_map_place(&map, "area"), "area: '%.40s' is used by two panes", pane->area);
}

static void read_grid(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct wall_display *display = record;
    int count = yaml_list_count(reader, node, "grid");
    if (count == 0 || count > WALL_ROWS)
        yaml_error(reader, yaml_place(node), "grid: expected 1 to %d rows, found %d", WALL_ROWS, count);
    for (int i = 0; i < count && i < WALL_ROWS; i++) {
        yaml_node_t *row = yaml_list_item(reader, node, i);
        const char *text = yaml_text(row);
        if (!text || text[strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789. ")] || strlen(text) > 400)
            yaml_expected(reader, row, "grid",
                          "the names of panes' areas (lower-case letters and digits), separated by blanks, such as 'main main alarms'");
        else
            display->rows[display->row_count++] = mem_strdup(text);
    }
    if ((int)display->row_count == count)
        check_grid(reader, yaml_place(node), display);
}

static void read_panes(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct wall_display *display = record;
    int count = plant_list_count(reader, node, "panes", WALL_PANES);
    for (int i = 0; i < count; i++)
        read_pane(reader, yaml_list_item(reader, node, i), display, &display->panes[display->pane_count++]);
}

/* Reads the width of bezels: one number for both directions, or two numbers (horizontal, vertical). */
static void read_bezel(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    double *bezel_mm = ((struct wall_tile *)record)->bezel_mm;
    if (node->type == YAML_SCALAR_NODE) {
        yaml_number(reader, node, "bezel_mm", 0, MAX_BEZEL_MM, &bezel_mm[0]);
        bezel_mm[1] = bezel_mm[0];
        return;
    }
    int count = yaml_list_count(reader, node, "bezel_mm");
    if (count != 2)
        yaml_error(reader, yaml_place(node), "bezel_mm: expected one number, or two: across and down; found %d", count);
    for (int i = 0; i < count && i < 2; i++)
        yaml_number(reader, yaml_list_item(reader, node, i), "bezel_mm", 0, MAX_BEZEL_MM, &bezel_mm[i]);
}

#define READ_TILE_AS(name, read)                                                                                                           \
    static void name(struct yaml_reader *reader, yaml_node_t *node, void *record)                                                          \
    {                                                                                                                                      \
        read(reader, node, &((struct wall_tile *)record)->pane);                                                                           \
    }
READ_TILE_AS(read_tile_views, read_views)
READ_TILE_AS(read_tile_tour, read_tour)

static void read_tile(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_choice yes[] = { { "no", 0 }, { "yes", 1 }, { 0 } };
    static const struct yaml_key keys[] = { { "columns", KEY_INT, true, offsetof(struct wall_tile, columns), 1, WALL_DISPLAYS, NULL, NULL },
                                            { "rows", KEY_INT, true, offsetof(struct wall_tile, rows), 1, WALL_DISPLAYS, NULL, NULL },
                                            { "bezel_mm", KEY_CUSTOM, false, 0, 0, 0, NULL, read_bezel },
                                            { "title", KEY_NAME, false, offsetof(struct wall_tile, pane.title), 0, 0, NULL, NULL },
                                            { "every_s", KEY_NUMBER, false, offsetof(struct wall_tile, pane.every_s), 5, 86400, NULL,
                                              NULL },
                                            { "on_alarm", KEY_FLAG, false, offsetof(struct wall_tile, pane.on_alarm), 0, 0, yes, NULL },
                                            { "views", KEY_CUSTOM, false, 0, 0, 0, NULL, read_tile_views },
                                            { "tour", KEY_CUSTOM, false, 0, 0, 0, NULL, read_tile_tour },
                                            { 0 } };
    struct wall_tile *tile = &((struct wall *)record)->tile;
    struct yaml_map map;
    tile->pane.every_s = 30;
    bool good = yaml_map_read(reader, node, "a tile", keys, tile, &map) && yaml_map_good(&map, "columns") && yaml_map_good(&map, "rows");
    int count = tile->columns * tile->rows;
    if (good && (count < 2 || count > WALL_DISPLAYS)) {
        yaml_error(reader, map.place, "tile: expected 2 to %d displays, found %d columns and %d rows", WALL_DISPLAYS, tile->columns,
                   tile->rows);
        good = false;
    }
    if (good && yaml_map_has(&map, "views") == yaml_map_has(&map, "tour")) {
        yaml_error(reader, map.place, "tile: expected views or a tour, not both");
        good = false;
    }
    if (good && tile->pane.kind == PANE_TOUR && tile->pane.item_count > 1)
        yaml_error(reader, yaml_map_place(&map, "tour"), "tour: expected one item, found %zu", tile->pane.item_count);
    if (good && tile->pane.kind == PANE_TOUR && yaml_map_has(&map, "every_s"))
        yaml_error(reader, yaml_map_place(&map, "every_s"), "every_s: not allowed with a tour, because each stop has its own time");
    if (!good)
        tile->columns = tile->rows = 0;
}

static void read_displays(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = { { "grid", KEY_CUSTOM, true, 0, 0, 0, NULL, read_grid },
                                            { "panes", KEY_CUSTOM, true, 0, 0, 0, NULL, read_panes },
                                            { 0 } };
    struct wall *wall = record;
    int count;
    wall->displays = plant_list_make(reader, node, "displays", 1, WALL_DISPLAYS, sizeof(*wall->displays), &count);
    for (int i = 0; i < count; i++) {
        struct yaml_map map;
        yaml_map_read(reader, yaml_list_item(reader, node, i), "a display", keys, &wall->displays[wall->display_count++], &map);
    }
}

static void read_dim(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct day_span *dim = &((struct wall *)record)->dim;
    plant_day_span_read(reader, node, "dim_hours", &dim->from_min, &dim->to_min);
}

static void pane_copy(const struct wall_pane *from, struct wall_pane *to)
{
    *to = *from;
    to->area = mem_strdup("main");
    to->title = from->title ? mem_strdup(from->title) : NULL;
    for (size_t i = 0; i < from->item_count; i++)
        to->items[i] = mem_strdup(from->items[i]);
}

/* Adds the displays of the wall's tiled picture (one picture across several displays) before the wall's other displays. */
static void add_tiles(struct yaml_reader *reader, const struct yaml_map *map, struct wall *wall)
{
    size_t tiles = (size_t)(wall->tile.columns * wall->tile.rows), others = wall->display_count;
    if (tiles == 0)
        return;
    if (tiles + others > WALL_DISPLAYS) {
        yaml_error(reader, yaml_map_place(map, "tile"),
                   "tile: a wall can have at most %d displays; `tile` defines %zu and `displays` lists %zu", WALL_DISPLAYS, tiles, others);
        wall->tile.columns = wall->tile.rows = 0;
        return;
    }
    struct wall_display *displays = mem_array(tiles + others, sizeof(*displays));
    for (size_t i = 0; i < tiles; i++) {
        displays[i] = (struct wall_display){ .row_count = 1, .pane_count = 1 };
        displays[i].rows[0] = mem_strdup("main");
        pane_copy(&wall->tile.pane, &displays[i].panes[0]);
    }
    if (others > 0)
        memcpy(displays + tiles, wall->displays, others * sizeof(*displays));
    mem_free(wall->displays);
    wall->displays = displays;
    wall->display_count = tiles + others;
}

void plant_walls_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    static const struct yaml_key keys[] = { { "id", KEY_NAME, true, offsetof(struct wall, id), 0, 0, NULL, NULL },
                                            { "inches", KEY_NUMBER, false, offsetof(struct wall, inches), 10, 400, NULL, NULL },
                                            { "distance_m", KEY_NUMBER, false, offsetof(struct wall, metres), 0.5, 50, NULL, NULL },
                                            { "dim_hours", KEY_CUSTOM, false, 0, 0, 0, NULL, read_dim },
                                            { "dim_percent", KEY_NUMBER, false, offsetof(struct wall, dim_percent), 20, 100, NULL, NULL },
                                            { "tile", KEY_CUSTOM, false, 0, 0, 0, NULL, read_tile },
                                            { "displays", KEY_CUSTOM, false, 0, 0, 0, NULL, read_displays },
                                            { 0 } };
    int count;
    plant->screens.walls = plant_list_make(reader, node, "walls", 0, WALLS, sizeof(*plant->screens.walls), &count);
    for (int i = 0; i < count; i++) {
        struct wall *wall = &plant->screens.walls[plant->screens.wall_count++];
        struct yaml_map map;
        *wall = (struct wall){ .inches = 55, .metres = 3, .dim_percent = 50, .line = yaml_place(yaml_list_item(reader, node, i)).line };
        if (!yaml_map_read(reader, yaml_list_item(reader, node, i), "a wall", keys, wall, &map))
            continue;
        if (wall->id && !named_view_id_valid(wall->id))
            yaml_error(reader, yaml_map_place(&map, "id"), "id: expected letters, digits, '_', '-' and '.', found '%.60s'", wall->id);
        if (!yaml_map_has(&map, "displays") && !yaml_map_has(&map, "tile"))
            yaml_error(reader, map.place, "a wall: expected displays, a tile, or both");
        add_tiles(reader, &map, wall);
        plant_list_check_id(reader, &map, "wall", plant->screens.walls, plant->screens.wall_count, sizeof(*wall),
                            offsetof(struct wall, line));
    }
}

const struct wall *wall_find(const struct plant *plant, const char *id)
{
    for (size_t i = 0; i < plant->screens.wall_count; i++)
        if (!strcmp(plant->screens.walls[i].id, id))
            return &plant->screens.walls[i];
    return NULL;
}

/* --- references in panes ------------------------------------------------------------------------------------------------------ */

static void check_items(const struct plant *plant, const struct wall_pane *pane, struct diag *diag)
{
    for (size_t i = 0; i < pane->item_count; i++) {
        const char *name = pane->items[i], *near = NULL;
        if (pane->kind == PANE_TREND || pane->kind == PANE_TILES) {
            if (plant_find_tag(plant, name) >= 0)
                continue;
            near = suggest_nearest(name, plant->tags, plant->tag_count, sizeof(*plant->tags));
            diag_error(diag, plant->files.path, pane->item_lines[i], pane->item_columns[i], "%s: there is no tag '%.60s'%s%s%s",
                       pane_kind_names[pane->kind], name, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        } else if (pane->kind == PANE_VIEWS) {
            if (named_view_find(plant, name))
                continue;
            near = suggest_nearest(name, plant->screens.views, plant->screens.view_count, sizeof(*plant->screens.views));
            diag_warning(diag, plant->files.path, pane->item_lines[i], pane->item_columns[i],
                         "views: `views` has no view '%.60s' (the id of a view saved on the page is also possible)%s%s%s", name,
                         near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        } else if (pane->kind == PANE_SNAPSHOT && other_plant_find(plant, name) < 0) {
            near =
                suggest_nearest(name, plant->screens.other_plants, plant->screens.other_plant_count, sizeof(*plant->screens.other_plants));
            diag_error(diag, plant->files.path, pane->item_lines[i], pane->item_columns[i],
                       "snapshot: `other_plants` has no plant '%.60s'%s%s%s", name, near ? "; did you mean '" : "", near ? near : "",
                       near ? "'?" : "");
        } else if (pane->kind == PANE_TOUR && !tour_find(plant, name)) {
            near = suggest_nearest(name, plant->screens.tours, plant->screens.tour_count, sizeof(*plant->screens.tours));
            diag_error(diag, plant->files.path, pane->item_lines[i], pane->item_columns[i], "tour: `tours` has no '%.60s'%s%s%s", name,
                       near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        }
    }
}

/* Returns how many displays of the tiled picture a check may skip: all but one, because all displays of the picture have the same panes. */
static size_t tiles_but_one(const struct wall *wall)
{
    int count = wall->tile.columns * wall->tile.rows;
    return count > 0 ? (size_t)count - 1 : 0;
}

void plant_walls_check(const struct plant *plant, struct diag *diag)
{
    for (size_t w = 0; w < plant->screens.wall_count; w++)
        for (size_t d = tiles_but_one(&plant->screens.walls[w]); d < plant->screens.walls[w].display_count; d++)
            for (size_t p = 0; p < plant->screens.walls[w].displays[d].pane_count; p++)
                check_items(plant, &plant->screens.walls[w].displays[d].panes[p], diag);
}

static void free_pane(struct wall_pane *pane)
{
    mem_free(pane->area);
    mem_free(pane->title);
    for (size_t k = 0; k < pane->item_count; k++)
        mem_free(pane->items[k]);
}

static void free_display(struct wall_display *display)
{
    for (size_t i = 0; i < display->row_count; i++)
        mem_free(display->rows[i]);
    for (size_t i = 0; i < display->pane_count; i++)
        free_pane(&display->panes[i]);
}

void plant_walls_free(struct plant *plant)
{
    for (size_t i = 0; i < plant->screens.wall_count; i++) {
        for (size_t d = 0; d < plant->screens.walls[i].display_count; d++)
            free_display(&plant->screens.walls[i].displays[d]);
        free_pane(&plant->screens.walls[i].tile.pane);
        mem_free(plant->screens.walls[i].displays);
        mem_free(plant->screens.walls[i].id);
    }
    mem_free(plant->screens.walls);
}

/* --- what a display shows ------------------------------------------------------------------------------------------------------ */

const struct wall_display *wall_display_find(const struct plant *plant, const char *wall, int number)
{
    for (size_t i = 0; i < plant->screens.wall_count; i++)
        if (!strcmp(plant->screens.walls[i].id, wall) && number >= 1 && (size_t)number <= plant->screens.walls[i].display_count)
            return &plant->screens.walls[i].displays[number - 1];
    return NULL;
}

bool wall_display_has(const struct wall_display *display, enum pane_kind kind, const char *item)
{
    for (size_t i = 0; display && i < display->pane_count; i++)
        for (size_t n = 0; display->panes[i].kind == kind && n < display->panes[i].item_count; n++)
            if (!item || !strcmp(display->panes[i].items[n], item))
                return true;
    return false;
}

bool wall_display_has_pictures(const struct wall_display *display)
{
    return wall_display_has(display, PANE_VIEWS, NULL) || wall_display_has(display, PANE_TOUR, NULL);
}

bool wall_display_shows_tag(const struct wall_display *display, const char *tag)
{
    return wall_display_has(display, PANE_TREND, tag) || wall_display_has(display, PANE_TILES, tag);
}

bool wall_display_shows_view(const struct plant *plant, const struct wall_display *display, const char *id)
{
    if (wall_display_has(display, PANE_VIEWS, id))
        return true;
    for (size_t t = 0; t < plant->screens.tour_count; t++)
        for (size_t s = 0; s < plant->screens.tours[t].stop_count && wall_display_has(display, PANE_TOUR, plant->screens.tours[t].id); s++)
            if (!strcmp(plant->screens.tours[t].stops[s].view, id))
                return true;
    return false;
}
