/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From readings to a scalar at every vertex. Algorithm 1 of Kim & Suh, Electronics 2025, 14(15), 2938 (`paper`) and inverse
   distance weights (Shepard, 1968; `shepard`), on Euclidean or geodesic distance, with the truth rules of the design.

   paper:    w_i = exp(d_i s_i) / sum_k exp(d_k s_k),  value = sum_i v~_i w_i d_i^o_i,  d = max(0, 1 - D/R),
             v~ = clamp((v - MIN)/(MAX - MIN));  the scalar handed out is MIN + value (MAX - MIN)
   shepard:  value = sum_i s_i v_i / D_i^p  /  sum_i s_i / D_i^p; exactly v_i where D_i = 0

   A sensor takes part at a point if it is of the group and the asset, its quality is not Bad, D is finite and D <= reach_m. Towards its
   reach it counts less and less: where reach_m is set, weights are (1 - D/reach_m)^2 times those above (for shepard's p = 2 these are the
   weights of Franke and Nielson, 1980), so that the field has no edge where a sensor leaves the sums. The nearest one's is never seen to
   fade, since weights are divided by their sum.
   In shepard a sensor of strength 0 never takes part; a common factor on all strengths cancels out, and decay has no part.
   Sensors whose place is assumed (`Place: equipment`) never paint a gradient. Where the group has a sensor on the asset whose place is
   known, they take no part. Where it has none, one of them stands for the whole asset, evenly: the one whose reading is nearest to trouble
   (by its own limits, else the farthest from the middle of the group's range), never a mean; while all are Bad there is no data.
   There is no data where nobody takes part, and where a configured sensor that does not is nearer than all that do (`fill` may ask to
   have such places filled; they are flagged uncertain). The value there is carried on from the nearest that takes part; else MIN.

   harmonic, fin: sum_i H_i v_i with H from the asset's influence file (protocol/ASSET.md), fin above what is around. Lost sensors have the
   values that follow from the others (field/influence_fill.h), so that H is that of all sensors, whichever are lost. Not where places are
   tried out. Where fin's H add up to less than a tenth there is no data.

   gp: the same with weights that add up to 1 on each body and may be negative (preprocess/influence/gaussian.h). There is no data where
   sensors take away less than a tenth of the prior's variance. Its standard deviation (uncertainty), and the smallest hot spot that the
   nearest good sensor would show (blind), depend on which sensors are good alone.

   What is shown may also be the distance from one sensor, in metres, or the difference from a baseline: the field of now less the
   field of then, both over the sensors that may be used in both (Algorithm 1 clamps readings, so there clamped ones are subtracted).

   Or, for operators, the places of the readings between their own tags' limits (field/limits.h), interpolated with the same weights; paper
   falls to 0 there, which is the middle. A sensor whose tag has no limits has no place and takes no part; where it is the nearest, the
   scalar is flagged so.

   Both are linear in the readings: value = G v / G 1. G is kept in a bounded cache or made anew for each sum, with the same bits;
   a changed reading adds one column times its change, a changed quality sums all anew.
   Thread: one at a time per field (it spreads its work over `workers`). */
#ifndef FIELD_FIELD_H
#define FIELD_FIELD_H
#include "base/workers.h"
#include "field/params.h"
#include "field/trials.h"
#include "field/scalars.h"
#include "plant/plant.h"
#include "scene/scene.h"
#include "value/baselines.h"
#include "value/snapshot.h"

/* Computes the scalars of all assets of a scene, and caches them by parameters. Thread: one at a time. */
struct field;
/* Creates an empty field. workers and scene must outlive it. The caller destroys it. */
struct field *field_create(struct workers *workers, const struct scene *scene);
/* Frees the field and its cache. &NULL is fine; leaves NULL. */
void field_destroy(struct field **field);
/* Returns the scene it was created with. */
const struct scene *field_scene(const struct field *field);
/* Returns the workers it was created with. */
struct workers *field_workers(const struct field *field);
/* Sets where differences look up their baselines; they must outlive the field. Without it, or for a forgotten baseline, a difference has no
   data. */
void field_set_baselines(struct field *field, struct baselines *baselines);
/* Sets where trial positions of sensors are looked up; they must outlive the field. Without it, or for a trial that is gone, sensors are
   where the plant has them. */
void field_set_trials(struct field *field, struct trials *trials);
/* Returns the parameters under which the field of this asset is cached: params, or a copy in *room without the trial, where the trial moves
   nothing on this asset, and with those of a constant field, where the places of all sensors are assumed. */
const struct field_params *field_params_of(struct field *field, int asset, const struct field_params *params, struct field_params *room);
/* Returns the trial that params name, held until field_give_trial(); NULL if there is none. */
const struct trial *field_take_trial(struct field *field, const struct field_params *params);
/* Releases a trial. &NULL is fine; leaves NULL. */
void field_give_trial(struct field *field, const struct trial **trial);
/* Looks up the baseline of a difference into *out. Returns false if params show no difference or the baseline was forgotten. */
bool field_baseline(const struct field *field, const struct field_params *params, struct baseline *out);
/* The bound on what is kept, FIELD_DEFAULT_BYTES at first. What the parameters asked for last need for themselves may pass it. */
#define FIELD_DEFAULT_BYTES ((size_t)512 << 20)
/* Sets the limit of the cache in bytes, FIELD_DEFAULT_BYTES at first. What the parameters asked for last need for themselves may exceed
   it. */
void field_set_cache_limit(struct field *field, size_t bytes);
/* Returns the bytes that are cached now. */
size_t field_bytes(const struct field *field);
/* Drops everything that is cached. */
void field_clear_cache(struct field *field);

/* Brings the scalars of one asset up to date with the snapshot and returns them. They belong to the field, are shared by all who ask with
   equal parameters, and are valid until the next call with other parameters; scalars->version grows only when a value or flag really
   changed. Distances have no data where the surface does not lead (their value there is the largest). Returns NULL if the asset has no
   sensor of the group (for a distance: not that sensor), or out of memory. */
const struct scalars *field_scalars(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot);

/* As field_scalars(), but brings only the first `count` vertices up to date, those of a level of detail: scalars->ready of them are
   valid. */
const struct scalars *field_scalars_of(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
                                       size_t count);
/* Brings the fields of several small assets up to date side by side, one core each. What it leaves (large fields, trials, or where memory
   is short) field_scalars_of() does, which must be called next for all of them. counts: vertices wanted, by place in assets. */
void field_update_all(struct field *field, const int *assets, const size_t *counts, size_t asset_count, const struct field_params *params,
                      const struct snapshot *snapshot);
/* Works towards field_scalars_of() for about `work` nanoseconds of one core, so that a large update blocks nobody. Returns true when that
   call would now return at once. While it returns false, the readings are those of the first call and the scalars must not be read. */
bool field_advance(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot, size_t count,
                   double work);

/* Returns whether one sensor stands for the whole asset, since the places of all are assumed. */
bool field_is_assumed(struct field *field, int asset, const struct field_params *params);
/* Returns whether there is anything to show on the asset with these parameters, given enough memory. */
bool field_covers(struct field *field, int asset, const struct field_params *params);

/* A place on the surface: in a triangle of the asset's file, by barycentric coordinates. */
struct field_place {
    uint32_t corners[3];
    double parts[3];
};
struct field_point {
    double value; /* in the unit of what is shown */
    bool no_data, uncertain;
    double drawn_error; /* bound on the error of the pictures around this place; 0: less than 1/255 of the range */
};
/* Computes the field at a place from the readings: exactly for distances through space, along the surface from the distances at the
   triangle's corners. harmonic, fin and gp exist only as solutions on a mesh: they are interpolated between the vertices of the finest
   level, and drawn_error says how far that may be from the exact solution. Returns false if the asset has no field with these
   parameters. */
bool field_at(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
              const struct field_place *place, struct field_point *out);

/* Inputs of the field on an asset, for callers that evaluate the field themselves. */
struct field_sensor {
    int tag;
    float surface_m[3];   /* as the asset file's positions */
    uint32_t column;      /* in the asset file's sensors; beyond them: it is tried out */
    bool in_file;         /* its distances along the surface are those of its column in the file; else */
    const float *along_m; /* these, of each vertex; NULL: not known yet, or straight ones are shown */
    float strength, decay;
    float value;                        /* as it is summed: for `paper` 0..1, for a difference that of two */
    bool configured, usable, uncertain; /* configured: would take part, were it good */
};
/* Lists the inputs of the field on an asset, as the last field_scalars() with these parameters took them, for a caller that evaluates the
   field itself; *radius_m receives R of Algorithm 1. Returns their number; the caller frees *out (mem_free). 0: there are none. */
size_t field_sensors(struct field *field, int asset, const struct field_params *params, struct field_sensor **out, float *radius_m);

#endif
