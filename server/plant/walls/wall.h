/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant file's `views`, `tours`, `other_plants` and `walls`: named views, sequences of views, and the displays of a control
   room. Immutable once loaded. Call from any thread. */
#ifndef PLANT_WALLS_WALL_H
#define PLANT_WALLS_WALL_H
#include <stdbool.h>
#include <stddef.h>

#include "plant/parse/yaml_reader.h"

enum {
    NAMED_VIEW_ID_BYTES = 49, NAMED_VIEW_TITLE_BYTES = 121, NAMED_VIEW_ADDRESS_BYTES = 2049, /* sizes include the terminating 0 */
    NAMED_VIEWS = 256, WALLS = 16, WALL_DISPLAYS = 16, WALL_PANES = 24, WALL_ROWS = 12, PANE_ITEMS = 16,
    TOURS = 32, TOUR_STOPS = 64, TOUR_TEXT_BYTES = 241, OTHER_PLANTS = 16
};

struct named_view {
    char *id, *title;
    char *address; /* part of the page's URL after `#`: camera, group, parameters */
    int line;
};

struct tour_stop {
    char *view, *text; /* view: id of a view; text: shown with the view, NULL: no text */
    double dwell_s;
    struct text_position place; /* position of the view's id in the plant file, for messages */
};

struct tour {
    char *id;
    struct tour_stop *stops;
    size_t stop_count;
    int line;
};

/* A plant with a server of its own, whose pictures appear in panes of wall displays. */
struct other_plant {
    char *id, *url;
    char *token_file, *ca_file; /* paths; NULL: none */
    char *view;                 /* id of a view in the other plant's file; NULL: the whole plant */
    double every_s;             /* interval in seconds between queries of the other plant's server */
    int width_px, height_px;
    int line;
};

enum pane_kind { PANE_VIEWS, PANE_TREND, PANE_ALARMS, PANE_TILES, PANE_CLOCK, PANE_TEXT, PANE_TOUR, PANE_SNAPSHOT };
extern const char *const pane_kind_names[]; /* names of the kinds of panes, by enum pane_kind; these are keys of a pane in the plant file */

struct wall_pane {
    char *area, *title; /* area: name of the area in the display's grid that the pane fills; title NULL: no title */
    enum pane_kind kind;
    /* content of the pane, depending on `kind`: names of views, shown in turn; names of tags of a trend or of tiles; the text; the name of
       a tour; or the name of another plant */
    char *items[PANE_ITEMS];
    size_t item_count;
    int item_lines[PANE_ITEMS], item_columns[PANE_ITEMS];
    double every_s; /* seconds for which the pane shows one of its views before it shows the next */
    double hours;   /* hours that a trend covers */
    /* true: when an alarm is raised, the pane shows the view that belongs to the alarm; only for panes that show views or a
       tour */
    bool on_alarm;
};

struct wall_display {
    char *rows[WALL_ROWS]; /* layout of the display's panes: rows of a grid, each with area names separated by blanks */
    size_t row_count;
    struct wall_pane panes[WALL_PANES];
    size_t pane_count;
};

/* A time span of the day in minutes; if to_min is before from_min, the span ends on the next day. */
struct day_span {
    int from_min, to_min;
};

/* One picture that spans the first columns * rows displays of a wall, which are numbered row by row. */
struct wall_tile {
    int columns, rows;     /* number of displays horizontally and vertically; 0: the wall has no picture across displays */
    double bezel_mm[2];    /* millimetres between the picture areas of two neighbouring displays: horizontally, vertically */
    struct wall_pane pane; /* pane whose content the picture shows: views or a tour */
};

struct wall {
    char *id;
    double inches, metres; /* diagonal of each display in inches, and viewing distance in metres */
    struct wall_tile tile;
    struct day_span dim;           /* daily time span in which the displays are dimmed; equal ends: they are never dimmed */
    double dim_percent;            /* brightness in percent while dimmed */
    struct wall_display *displays; /* all displays of the wall; those of `tile` come first, each with a single pane `main` */
    size_t display_count;
    int line;
};

/* Returns whether an id may be part of a URL: letters, digits, `_`, `-` and `.`, at most NAMED_VIEW_ID_BYTES - 1. */
bool named_view_id_valid(const char *id);
struct plant;
/* Each function returns the entry of the plant file that has this id, or NULL. */
const struct named_view *named_view_find(const struct plant *plant, const char *id);
const struct tour *tour_find(const struct plant *plant, const char *id);
const struct wall *wall_find(const struct plant *plant, const char *id);
int other_plant_find(const struct plant *plant, const char *id); /* Returns the index of the other plant with this id, or -1. */
/* Returns a display of a wall of the plant file, NULL if the wall has no such display. number: from 1. */
const struct wall_display *wall_display_find(const struct plant *plant, const char *wall, int number);
/* Each function answers one question about a wall's display: whether it has a pane of views or a tour; whether one of its
   trends or tiles shows the tag; whether one of its panes shows the view with that id. All return false for a NULL display. */
bool wall_display_has_pictures(const struct wall_display *display);
bool wall_display_shows_tag(const struct wall_display *display, const char *tag);
bool wall_display_shows_view(const struct plant *plant, const struct wall_display *display, const char *id);
/* Returns whether a display has a pane of that kind. item not NULL: the pane must also show that item (a view, tag, tour or
   other plant, depending on the kind). */
bool wall_display_has(const struct wall_display *display, enum pane_kind kind, const char *item);
/* Returns what is wrong with a title or a view address (static text), or NULL. */
const char *named_view_title_wrong(const char *title);
const char *named_view_address_wrong(const char *address);

#endif
