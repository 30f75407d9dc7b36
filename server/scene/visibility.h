/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visibility of a view: which assets it shows or ghosts, and what is cut away. Plain data. Call from any thread. */
#ifndef SCENE_VISIBILITY_H
#define SCENE_VISIBILITY_H
#include <stdbool.h>
#include <stdint.h>

enum { ASSET_SET_MAX = 4096, CLIP_MAX_PLANES = 6 };

struct asset_set { /* set of assets, by index in scene->assets; zero: empty */
    uint64_t words[ASSET_SET_MAX / 64];
    int count;
};
void asset_set_add(struct asset_set *set, int asset); /* asset: 0..ASSET_SET_MAX - 1 */
bool asset_set_has(const struct asset_set *set, int asset);

struct clip { /* section planes, which cut the model: only what lies on the inner side of all planes is shown */
    int plane_count;
    /* true: the planes are those of an axis-aligned box, in the order min x, max x, min y, max y, min z, max z */
    bool is_box;
    double planes[CLIP_MAX_PLANES][4]; /* (n.x, n.y, n.z, d): points p with n . p + d >= 0 are kept; n: unit normal in the plant frame */
};
/* Writes the plane for cutting geometry: slightly outside of the plane that was set, so that a surface exactly in that plane is
   kept whole. */
void clip_plane(const struct clip *clip, int index, double out[4]);
void clip_box(struct clip *clip, const double min_m[3], const double max_m[3]);
void clip_get_box(const struct clip *clip, double min_m[3], double max_m[3]);
bool clip_keeps(const struct clip *clip, const double point_m[3]);
/* clip_drops() returns whether the whole box is cut away, clip_touches() whether at least a part of the box is cut away */
bool clip_drops(const struct clip *clip, const double min_m[3], const double max_m[3]);
bool clip_touches(const struct clip *clip, const double min_m[3], const double max_m[3]);
/* Limits the range low <= t <= high of a ray (origin + t direction) to the space that the section planes leave. Returns false
   if none of the range is in this space. */
bool clip_ray(const struct clip *clip, const double origin[3], const double direction[3], double *low, double *high);

struct visibility {
    struct asset_set hidden, isolated, ghosts;
    struct clip clip;
};
enum asset_look {
    ASSET_SHOWN,
    ASSET_GHOST, /* the asset is drawn transparent, without a field */
    ASSET_HIDDEN /* the asset is not shown: the user has hidden it, or has isolated other assets without ghosting this one */
};
enum asset_look visibility_of(const struct visibility *visibility, int asset);
struct plant;
void visibility_start(const struct plant *plant, struct visibility *out); /* sets the initial visibility of a view of the plant */
bool visibility_equal(const struct visibility *a, const struct visibility *b);

#endif
