/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the plant file's `views`, `tours`, `other_plants` and `walls` say: views with names, in turn, and on displays of a control room.
   Immutable once loaded. Thread: any. */
#ifndef PLANT_WALLS_WALL_H
#define PLANT_WALLS_WALL_H
#include <stdbool.h>
#include <stddef.h>

#include "plant/parse/yaml_reader.h"

enum {
    NAMED_VIEW_ID_BYTES = 49, NAMED_VIEW_TITLE_BYTES = 121, NAMED_VIEW_ADDRESS_BYTES = 2049, /* with their 0 */
    NAMED_VIEWS = 256, WALLS = 16, WALL_DISPLAYS = 16, WALL_PANES = 24, WALL_ROWS = 12, PANE_ITEMS = 16,
    TOURS = 32, TOUR_STOPS = 64, TOUR_TEXT_BYTES = 241, OTHER_PLANTS = 16
};

struct named_view {
    char *id, *title;
    char *address; /* what the page's address has after `#`: camera, group, parameters */
    int line;
};

struct tour_stop {
    char *view, *text; /* id of a view; what is said about it, or NULL */
    double dwell_s;
    struct text_position place; /* position of the view's id in the file */
};

struct tour {
    char *id;
    struct tour_stop *stops;
    size_t stop_count;
    int line;
};

/* A plant with a server of its own, whose picture panes show. */
struct other_plant {
    char *id, *url;
    char *token_file, *ca_file; /* NULL: none */
    char *view;                 /* the id of a view of its plant file; NULL: all of the plant */
    double every_s;             /* how often its server is asked */
    int width_px, height_px;
    int line;
};

enum pane_kind { PANE_VIEWS, PANE_TREND, PANE_ALARMS, PANE_TILES, PANE_CLOCK, PANE_TEXT, PANE_TOUR, PANE_SNAPSHOT };
extern const char *const pane_kind_names[]; /* by pane_kind: keys of a pane */

struct wall_pane {
    char *area, *title; /* letters of the grid; title NULL: none */
    enum pane_kind kind;
    char *items[PANE_ITEMS]; /* names of views, in turn; tags of a trend or of tiles; the text; a tour; another plant */
    size_t item_count;
    int item_lines[PANE_ITEMS], item_columns[PANE_ITEMS];
    double every_s; /* of views: how long each is shown */
    double hours;   /* of a trend */
    bool on_alarm;  /* of views and tours: the view of an alarm comes here */
};

struct wall_display {
    char *rows[WALL_ROWS]; /* of the grid: names of areas, with blanks between them */
    size_t row_count;
    struct wall_pane panes[WALL_PANES];
    size_t pane_count;
};

/* A part of the day, in minutes of it; one that ends before it begins ends on the next day. */
struct day_span {
    int from_min, to_min;
};

/* One picture over the first columns * rows displays of a wall, row by row. */
struct wall_tile {
    int columns, rows;     /* 0: there is none */
    double bezel_mm[2];    /* between the pictures of two neighbours: across, down */
    struct wall_pane pane; /* what it shows: views or a tour */
};

struct wall {
    char *id;
    double inches, metres; /* of each display: its diagonal, and from how far it is read */
    struct wall_tile tile;
    struct day_span dim;   /* when it is darker; equal ends: never */
    double dim_percent;    /* of its light, then */
    struct wall_display *displays; /* those of `tile` first: each is one pane, `main` */
    size_t display_count;
    int line;
};

/* Returns whether an id may stand in an address: letters, digits, `_`, `-` and `.`, at most NAMED_VIEW_ID_BYTES - 1. */
bool named_view_id_valid(const char *id);
struct plant;
/* Return what the plant file has by that id, or NULL. */
const struct named_view *named_view_find(const struct plant *plant, const char *id);
const struct tour *tour_find(const struct plant *plant, const char *id);
const struct wall *wall_find(const struct plant *plant, const char *id);
int other_plant_find(const struct plant *plant, const char *id); /* an index, or -1 */
/* Returns a display of a wall of the plant file, NULL if it has none such. number: from 1. */
const struct wall_display *wall_display_find(const struct plant *plant, const char *wall, int number);
/* Return whether a display has a pane of views or a tour; whether a trend or a tile of it is of that tag; whether the
   view with that id is in one. NULL: no. */
bool wall_display_has_pictures(const struct wall_display *display);
bool wall_display_shows_tag(const struct wall_display *display, const char *tag);
bool wall_display_shows_view(const struct plant *plant, const struct wall_display *display, const char *id);
/* Returns whether it has a pane of that kind, with that item; item NULL: with any. */
bool wall_display_has(const struct wall_display *display, enum pane_kind kind, const char *item);
/* Returns what is wrong with a title or with an address (static), or NULL. */
const char *named_view_title_wrong(const char *title);
const char *named_view_address_wrong(const char *address);

#endif
