/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One display of a wall: its panes, what they show and when, and what it says when it hears nothing. */
#ifndef WALL_PLAYER_H
#define WALL_PLAYER_H
#include <cairo.h>
#include <pthread.h>

#include "base/text.h"
#include "link.h"
#include "model.h"
#include "notes.h"
#include "pairing.h"
#include "plant/burn_shift.h"
#include "plant/wall.h"
#include "render/overlay/labels.h"
#include "rules.h"
#include "view_pane.h"

#define PLAYER_LOST_NS 3000000000LL /* so long nothing is heard before it is said */

/* What a pane of a trend shows: what was recorded of its tags. */
struct trend {
    double hours;
    json_t *answer; /* of /api/v1/history; NULL: none came yet */
    int64_t due_ns; /* monotonic: when it is to be asked for next */
    bool asks;      /* it waits for an answer */
    bool failed;    /* the last time */
    uint32_t count; /* of answers */
};

/* What a pane of another plant shows. Pictures have numbers; 0: none. */
struct snapshot_pane {
    cairo_surface_t *picture, *fitted; /* as it came, and as large as there is room for; NULL: none */
    int64_t told;                      /* the picture that the server says is to be shown */
    int64_t asked, failed, shown;      /* the one that it was asked for last; that could not be shown; that is shown */
    bool asks;                         /* it waits for `asked` */
    int64_t heard_ns, changed_ns;      /* when the server was asked what it said last; 0: it said nothing. Since when it says `told` */
    int64_t age_ns, asked_age_ns, shown_age_ns; /* of the readings in it at heard_ns, asked_ns, shown_ns; -1: there are none */
    int64_t asked_ns, shown_ns;
    int64_t since_us; /* since when there is none */
    char name[260], why[32];
};

struct pane {
    enum pane_kind kind;
    bool known;                           /* false: of a kind that this player does not know */
    const char *kind_name, *area, *title; /* title NULL: none. All three belong to the player's `wall`, as the next two do */
    const json_t *items, *stops;          /* stops: of a tour, how long each item is shown and what is said about it; else NULL */
    struct box box;                       /* all of it, in pixels */
    struct text said;                     /* what was drawn last: when it differs, the pane is drawn anew */
    double title_px;                      /* height of its title */
    struct view_pane view;
    size_t at;          /* of views: which of the items */
    int64_t changed_ns; /* 0: never */
    double every_s;
    struct trend trend;
    struct snapshot_pane snapshot;
    bool on_alarm, called;
    struct text wanted; /* what was asked for */
    struct text words;  /* its title now */
    struct text wrong;  /* why the view that it is to show cannot be shown as it is written; of length 0: it can */
    struct text state;  /* of views, likewise: what is seen below the title */
};

struct player {
    struct daemon_url url;
    const char *wall_id;
    int display;
    bool by_gpu, dark;
    int64_t lost_ns;                                              /* so long nothing is heard before it is said; 0: PLAYER_LOST_NS */
    int width_px, height_px, display_width_px, display_height_px; /* of the window, and of all of the display */
    struct pairing pairing; /* by main.c; not enabled: what is refused stays dark */
    pthread_mutex_t lock;
    struct links links;
    pthread_cond_t woken; /* with the lock: there is news */
    /* --- below: under lock */
    bool news; /* a picture came since player_wait() */
    struct model model;
    json_t *wall, *walls; /* that which is shown, NULL: none; and all */
    struct pane panes[WALL_PANES];
    int pane_count;
    double unit;
    char wrong[600]; /* what is wrong, instead of panes */
    struct rules_call call;
    int64_t others_asked_ns;   /* when the server was last asked about other plants */
    int64_t begun_ns, said_ns; /* said: when the server of the words last spoke */
    bool denied;
    uint32_t ground;  /* what is around the picture: the drawing thread alone */
    bool all_due;     /* everything is to be drawn anew */
    struct text card; /* what lies over everything; "": nothing */
    cairo_surface_t *surface;
    struct pane *pointed; /* at which a desk points; NULL: none */
    char pointed_by[256]; /* who, from which desk */
    double pointed_m[3];
    int64_t pointed_ns;
};

/* Sets up a player for a window of that size, and begins to connect. url, wall_id, display, by_gpu and the sizes are set. Returns false
   with
   the reason printed. */
bool player_start(struct player *player);
void player_finish(struct player *player);
/* Draws what has changed into player->surface. Returns whether anything has, with the part of it in *dirty. */
bool player_draw(struct player *player, int64_t now_ns, struct box *dirty);
/* Returns whether the display is a tile of one picture over many. */
bool player_is_tile(struct player *player);
/* Returns whether a tile is to show a picture at an instant that is near. */
bool player_waits(struct player *player);
/* Returns by how much player->surface is to be moved now. A tile is not: the server moves its picture within the one that all tiles share,
   so that there is no gap beside it, and player_draw() what lies over it. */
struct burn_shift player_shift(struct player *player);
/* Waits until that time, monotonic, or until a picture comes. */
void player_wait(struct player *player, int64_t until_ns);
/* Returns how bright the display is to be now, up to 1. */
double player_brightness(struct player *player);
/* Has it fit another size. */
void player_resize(struct player *player, int width_px, int height_px);

/* Parts of player_draw(), under the lock (panes.c): sets what a pane says, and draws it in its box. */
void pane_say(struct player *player, struct pane *pane, int64_t now_ns, struct text *said);
void pane_draw(struct player *player, struct pane *pane, cairo_t *cairo, int64_t now_ns);
/* Draws the title of a pane, with the age of its data at its end. */
void pane_draw_title(struct player *player, const struct pane *pane, cairo_t *cairo, const char *text, const char *about, int priority,
                     bool hollow);
/* Writes how many alarms there are, and that it is a flood; "" where there is none. */
void pane_count_alarms(const struct player *player, char out[200]);
/* Returns the plant's time of an instant, "10:05:00", in a buffer that is used again after 8 others. */
const char *player_time(const struct player *player, int64_t us);
/* Chooses what a pane of views shows, and asks for it (view_choice.c). */
void pane_choose(struct player *player, struct pane *pane, int64_t now_ns);
/* Of trends (trend.c): asks for what was recorded when it is due; takes it in, for the pane that asked last (NULL: there is no answer);
   says what is shown, and draws it. */
void trend_ask(struct player *player, struct pane *pane, int64_t now_ns);
void trend_take(struct player *player, const json_t *answer);
void trend_say(struct player *player, const struct pane *pane, int64_t now_ns, struct text *said);
void trend_finish(struct trend *trend); /* leaves it empty */
void trend_draw(struct player *player, const struct pane *pane, cairo_t *cairo, const struct box *body);
/* Of panes of other plants (snapshot.c): ask for what is due; take in what was answered; say what is shown, and draw it. */
void snapshots_ask(struct player *player, int64_t now_ns);
void snapshots_take(struct player *player, const json_t *answer);
void snapshots_take_picture(struct player *player, const struct text *body);
void snapshot_say(struct player *player, const struct pane *pane, int64_t now_ns, struct text *said);
void snapshot_draw(struct player *player, struct pane *pane, cairo_t *cairo, const struct box *body, int64_t now_ns);
void snapshot_finish(struct snapshot_pane *snapshot); /* leaves it empty */
/* Makes the panes of the display anew, out of player->walls, or says what is wrong (layout.c). */
void layout_build(struct player *player);
/* Returns the list of alarms as the rules have it, which the caller frees with mem_free(). */
struct rules_alarm *player_rules_alarms(const struct player *player);

#endif
