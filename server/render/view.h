/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one session wants to see: a small struct, copied from thread to thread. */
#ifndef RENDER_VIEW_H
#define RENDER_VIEW_H
#include <stdbool.h>
#include <stdint.h>

#include "field/field.h"
#include "field/limits.h"
#include "field/scale.h"
#include "scene/camera.h"
#include "scene/visibility.h"

enum look {
    LOOK_DEFAULT,  /* field colours shaded only by an additive L* within +-7; PBR elsewhere */
    LOOK_GLOSSY,   /* PBR with the field as albedo (the paper's Fig. 13); labelled, since shading changes the colours */
    LOOK_FLAT,     /* no shading */
    LOOK_MATERIALS /* no field: all assets as their models say, in full colour */
};
enum directions_look { DIRECTIONS_ARROWS, DIRECTIONS_STROKES, DIRECTIONS_NONE }; /* of a group that has them */
enum tier { TIER_PREVIEW, TIER_REFINED };
#define VIEW_MAX_SIDE_PX 8192
#define VIEW_MAX_PIXELS (16 * 1024 * 1024)

enum { VIEW_LINES = PLANT_ISOLINES };
struct color_scale { /* beside colour map, range and ramp: which colour a value has, and where lines run. Zero: nothing of it */
    bool log;
    double breaks[SCALE_BREAKS]; /* ascending; instead of the ramp */
    int break_count;
    double lines[VIEW_LINES]; /* isolines, ascending; the edges of bands have lines in any case */
    int line_count;
};

enum { VIEW_SPLIT_LEAST_PX = 64 };
struct split_half { /* what the right half of a split view shows; the names are those of the view itself */
    struct field_params field;
    int colormap;
    double ramp_interval, range_min, range_max;
    struct color_scale color_scale;
    enum look look;
};

enum language { LANGUAGE_EN, LANGUAGE_KO, LANGUAGE_DE, LANGUAGES };

struct view {
    int width_px, height_px; /* 16..VIEW_MAX_SIDE_PX, at most VIEW_MAX_PIXELS */
    struct camera camera;
    uint32_t camera_seq; /* the client's number of this camera, echoed */
    uint32_t params_seq; /* likewise of the parameters */
    int64_t input_ns;    /* monotonic: when the newest input came in */
    double pixel_ratio;  /* device pixels to one that a hand aims at; 0: 1. Of picks only */
    struct field_params field;
    int colormap;                /* index */
    double ramp_interval;        /* engineering units; 0 = continuous */
    double range_min, range_max; /* of the colour map; the group's unless the client says otherwise */
    struct color_scale color_scale;
    enum look look;
    enum tier tier;
    int selected_asset;  /* outlined; -1: none */
    double light_dir[3]; /* towards the sun, plant frame, unit length */
    bool dark;           /* a dark backdrop; colours of the field stay what they are */
    enum directions_look directions;
    enum language language; /* of what an overlay says, where one is drawn */
    bool strip;          /* a legend strip for programs, where an overlay is drawn */
    int environment;     /* surroundings: 0 the built-in sky, then the plant's own */
    struct visibility visibility;
    int64_t at_us;           /* the instant that is shown, UTC; 0: now. Set by view_set_instant */
    bool split;              /* two halves beside each other under one camera: this view left, `right` right */
    struct split_half right; /* zero where it is not split */
};

/* The unit of what the view shows: its group's, or "m". */
const char *view_unit(const struct plant *plant, const struct view *view);
void view_default(const struct scene *scene, int width_px, int height_px, struct view *view);
/* The scale that what is shown has by itself: the group's range, isolines and logarithm, or those of a distance or a difference. */
void view_default_scale(const struct scene *scene, struct view *view);
/* Shows places between limits (SHOW_OPERATOR): colours, lines and legend are its own, whatever the rest of the view says. */
bool view_is_operator(const struct view *view);
void view_scale(const struct view *view, struct scale *scale);
/* All values that have a line, ascending: isolines and the edges of bands. Returns how many. */
enum { VIEW_ALL_LINES = VIEW_LINES + SCALE_EDGES };
int view_lines(const struct view *view, double lines[VIEW_ALL_LINES]);
/* Half 0 (all of it, where it is not split) or 1 as a view of its own. */
void view_half(const struct view *view, int half, struct view *out);
/* Sets the instant that the view shows; 0: now. slot: of the instant's historical snapshot (value/snapshot_cache.h); 0: now, or not loaded
   yet. The field of each half keeps it: whoever assigns a field anew calls this again. */
void view_set_instant(struct view *view, int64_t at_us, int slot);
/* Likewise: with sensors where somebody tries them out (field/trials.h); 0: where the plant has them. */
void view_set_trial(struct view *view, uint32_t trial);
int view_left_px(const struct view *view); /* width of the left half; x at which the right one begins */
/* Splits, with a half that was taken by view_half (or a whole view) on the right. */
void view_split(struct view *view, const struct view *right);
/* Both ask for the same picture: everything but who asked, and when. Every new field that changes the picture belongs here. */
bool view_equal(const struct view *a, const struct view *b);

#endif
