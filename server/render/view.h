/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A session's view: everything that its picture depends on except the readings. A plain struct without pointers, which is copied between
   threads. */
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
    /* the field in its legend colours, which shading changes by at most 7 in CIELAB L*; assets without a field with PBR
       (physically based shading) */
    LOOK_DEFAULT,
    /* PBR with the field as albedo (Fig. 13 of Kim & Suh, Electronics 2025, 14(15), 2938); labelled in the picture, since shading changes
       the colours */
    LOOK_GLOSSY,
    LOOK_FLAT,     /* no shading */
    LOOK_MATERIALS /* no field; all assets in full colour with the materials of their models */
};
/* form in which directions of sensors (such as flow) are drawn: arrows, strokes (short streamlines), or not at all */
enum directions_look { DIRECTIONS_ARROWS, DIRECTIONS_STROKES, DIRECTIONS_NONE };
enum tier { TIER_PREVIEW, TIER_REFINED };
#define VIEW_MAX_SIDE_PX 8192
#define VIEW_MAX_PIXELS (16 * 1024 * 1024)

enum { VIEW_LINES = PLANT_ISOLINES };
struct color_scale { /* settings of a view's colour scale, apart from colour map, range and colour step; all zero: the default settings */
    bool log;
    double breaks[SCALE_BREAKS]; /* ascending values that separate bands of uniform colour; used instead of a continuous ramp */
    int break_count;
    double lines[VIEW_LINES]; /* values of the isolines, ascending; the edges of colour bands (breaks) always get lines as well */
    int line_count;
};

enum { VIEW_SPLIT_LEAST_PX = 64 };
struct split_half { /* content of the right half of a split view; members are the same as in struct view */
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
    uint32_t camera_seq; /* the client's sequence number of this camera, echoed in the frame */
    uint32_t params_seq; /* the client's sequence number of the parameters, echoed in the frame */
    int64_t input_ns;    /* arrival time of the user's newest input, on the monotonic clock */
    /* device pixels per CSS pixel of the page. The size of the area in which a click picks a marker is proportional to this; 0:
       counts as 1 */
    double pixel_ratio;
    struct field_params field;
    int colormap;                /* index of the colour map */
    double ramp_interval;        /* width of a colour step in engineering units; 0: continuous */
    /* values, in engineering units, at the two ends of the colour map: the range that the plant file states for the group of
       sensors, unless the client sets other values */
    double range_min, range_max;
    struct color_scale color_scale;
    enum look look;
    enum tier tier;
    int selected_asset;  /* outlined; -1: none */
    double light_dir[3]; /* unit vector towards the sun, in the plant frame */
    /* true: the backdrop (sky and ground) is dark; the colours of the field are the same on a dark and on a bright backdrop */
    bool dark;
    enum directions_look directions;
    enum language language; /* language of the texts in the overlay (legend, clock and markers drawn over the picture), if one is drawn */
    bool strip;             /* true: frames get a machine-readable copy of the legend in their lowest rows (legend strip) */
    int environment;        /* index of the environment map: 0: the built-in sky; 1 and up: those of the plant file */
    struct visibility visibility;
    int64_t at_us;           /* instant that the view shows, UTC microseconds; 0: now. Set it with view_set_instant() */
    bool split;              /* true: two halves side by side under one camera: this struct is the left half, `right` the right half */
    struct split_half right; /* content of the right half; all zero if the view is not split */
};

/* Returns the unit of the shown values: the group's unit, or "m" for distances. */
const char *view_unit(const struct plant *plant, const struct view *view);
void view_default(const struct scene *scene, int width_px, int height_px, struct view *view);
/* Writes the light_dir of a new view to `towards`. */
void view_default_light(const struct scene *scene, double towards[3]);
/* Sets the default scale for the quantity that the view shows: the group's range, isolines and logarithm, or those for
   distances or for differences from a baseline. */
void view_default_scale(const struct scene *scene, struct view *view);
/* Returns the colour map that a view of this kind of number has by default. */
int view_default_colormap(const struct plant *plant, enum field_show show);
/* Returns whether the view shows values relative to their alarm limits (SHOW_OPERATOR). Such a view has its own colours, isolines and
   legend, and ignores colormap and color_scale. */
bool view_is_operator(const struct view *view);
/* Returns whether the view, or at least one half of a split view, shows values that depend on readings. false: it shows only distances or
   materials, so its frames have no age of readings. */
bool view_shows_readings(const struct view *view);
void view_scale(const struct plant *plant, const struct view *view, struct scale *scale);
/* Fills `lines` with the values at which a line is drawn, ascending: isolines, and edges of colour bands within the range.
   Returns the number of lines. */
enum { VIEW_ALL_LINES = VIEW_LINES + SCALE_EDGES };
int view_lines(const struct view *view, double lines[VIEW_ALL_LINES]);
/* Copies half 0 (the whole of an unsplit view) or half 1 into `out` as a view of its own. */
void view_half(const struct view *view, int half, struct view *out);
/* Sets the instant that the view shows; 0: now. slot: index of the instant's snapshot in the cache of historical snapshots
   (value/snapshot_cache.h); 0: now, or not loaded yet. The slot is stored in the field parameters of both halves: call this again after
   replacing them. */
void view_set_instant(struct view *view, int64_t at_us, int slot);
/* Sets the trial whose sensor positions the view uses (field/trials.h), in both halves; 0: the plant's positions. Call this again after
   replacing the field parameters. */
void view_set_trial(struct view *view, uint32_t trial);
/* returns the width of the left half in pixels, which is the x coordinate of the right half */
int view_left_px(const struct view *view);
/* Splits the view into two halves. right: an unsplit view, for example from view_half(); the right half shows its content. */
void view_split(struct view *view, const struct view *right);
/* Returns whether both views show the same picture; ignores sequence numbers and input time. A new member that changes the picture must be
   compared here. */
bool view_equal(const struct view *a, const struct view *b);

#endif
