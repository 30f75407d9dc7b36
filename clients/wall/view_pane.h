/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pane that shows the plant: a session of its own, the picture that came last, and what is drawn over it. Under the player's lock, but
   for
   view_pane_decode(). */
#ifndef WALL_VIEW_PANE_H
#define WALL_VIEW_PANE_H
#include <cairo.h>

#include "clients/link/decoder.h"
#include "link.h"
#include "model.h"
#include "plant/burn_shift.h"
#include "render/frame.h"
#include "view_sight.h"
#include "view_tile.h"

enum { TOLD_COMING = 8, MARKERS_COMING = 32 };
struct told_view {
    uint32_t params_seq; /* of the pictures that are drawn by it */
    bool known;          /* the player knows what it says */
    struct view view;
};

struct view_pane {
    struct link *link;
    int width_px, height_px; /* of its picture */
    double unit;
    bool missed;  /* something was said while the plant was another one: it is to be said again */
    bool greeted; /* by this connection's server */
    bool engineer;
    char configuration[40];          /* of the plant that its markers are of */
    json_t *start;                   /* the parameters that a view begins with */
    uint32_t camera_seq, params_seq; /* the newest that were asked for */
    uint32_t view_seq;               /* those of the parameters that the picture must have to be of the view; later ones make ghosts */
    struct view told;                /* what the server says is in force, by its answer number told_seq */
    uint32_t told_seq;
    struct told_view coming[TOLD_COMING]; /* of a tile: of pictures that are not shown yet, the newest last */
    int coming_count;
    json_t *coming_markers;    /* likewise, messages */
    uint32_t shown_params_seq; /* of a tile's picture */
    char refused[200];         /* why the server does not show what was asked for; "": it does */
    cairo_surface_t *picture;  /* of `pixels`; NULL: none came yet */
    uint8_t *pixels;
    bool is_current; /* the picture is of what was asked for */
    bool overlay_due;
    int64_t shown_ns; /* when the last picture came */
    uint32_t frames;
    struct frame frame; /* what the picture shows; its pixels are not used */
    bool by_gpu;
    struct burn_shift shift; /* of a tile: of what stands at the edges of the display; the picture comes moved */
    struct view_tile tile;
    struct view_sight sight;
    /* --- below: of the network's thread */
    struct decoder *decoder;
    uint8_t *canvas;    /* what parts of pictures are put together in; NULL: none yet */
    bool canvas_is_old; /* it holds the picture before the one that is seen, or none */
    int canvas_width_px, canvas_height_px;
};

/* Sets up a pane of that size. Its decoder and buffers stay for the next one of the same place. */
void view_pane_init(struct view_pane *pane, struct link *link, int width_px, int height_px, double unit, bool by_gpu);
/* Forgets what it shows. */
void view_pane_clear(struct view_pane *pane);
void view_pane_finish(struct view_pane *pane);
/* Returns its first message. */
json_t *view_pane_hello(const struct view_pane *pane);
/* Takes in a message of its session. */
void view_pane_hear(struct view_pane *pane, const struct model *model, const json_t *message);
/* Decodes a frame and keeps the picture, under that lock. Returns false if it cannot. The network's thread. */
bool view_pane_decode(struct view_pane *pane, pthread_mutex_t *lock, const struct wire_frame *frame, const uint8_t *payload);
/* Asks for a view: what a page's address has after `#`. One without a camera shows the whole plant. */
void view_pane_show(struct view_pane *pane, const struct model *model, const char *address);
/* Asks for the place of a tag, and then for another side of it where something stands before it. */
void view_pane_show_tag(struct view_pane *pane, const struct model *model, int tag);
/* To be called as time goes by. */
void view_pane_tick(struct view_pane *pane, int64_t now_ns);
/* Returns whether it speaks of the same plant as the model. */
bool view_pane_fits(const struct view_pane *pane, const struct model *model);
/* Of a tile: moves what stands at the edges of the display. */
void view_pane_move(struct view_pane *pane, struct burn_shift shift);
/* Of a tile: shows the picture whose time has come. Returns whether one came. */
bool view_pane_flip(struct view_pane *pane, const struct model *model, int64_t now_us);
/* Draws picture and overlay onto an image, all of them within it, with the upper left corner there. Returns false if there is no picture of
   what was asked for. */
bool view_pane_draw(struct view_pane *pane, const struct model *model, cairo_t *cairo, int x, int y);
/* Returns whether a place of the plant is in the picture, which for a tile goes on beyond its pane; where it is in pixels of the pane. */
bool view_pane_project(const struct view_pane *pane, const double place_m[3], double *x, double *y);

#endif
