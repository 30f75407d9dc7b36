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
   There is no data where nobody takes part, and where a configured sensor that does not is nearer than all that do (`fill` may ask to
   have such places filled; they are flagged uncertain). The value there is carried on from the nearest that takes part; else MIN.

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

struct field;
struct field *field_create(struct workers *workers, const struct scene *scene); /* both must outlive it */
void field_destroy(struct field **field);                                       /* &NULL is fine; leaves NULL */
struct workers *field_workers(const struct field *field);
/* Where differences look their baselines up; it must outlive the field. Without it, and for a baseline that was forgotten, a
   difference has no data anywhere. */
void field_set_baselines(struct field *field, struct baselines *baselines);
/* Where places that are tried out are looked up, likewise. Without it, and for a trial that is gone, sensors are where the plant has
   them. */
void field_set_trials(struct field *field, struct trials *trials);
/* The parameters that the field of this asset is kept under: without the trial, where it moves nothing there. `room` is for a copy. */
const struct field_params *field_params_of(struct field *field, int asset, const struct field_params *params, struct field_params *room);
/* What is tried out, held until trials_give. NULL: nothing. */
const struct trial *field_take_trial(struct field *field, const struct field_params *params);
void field_give_trial(struct field *field, const struct trial **trial);
/* What the difference is from. False: no difference is shown, or it was forgotten. */
bool field_baseline(const struct field *field, const struct field_params *params, struct baseline *out);
/* The bound on what is kept, FIELD_DEFAULT_BYTES at first. What the parameters asked for last need for themselves may pass it. */
#define FIELD_DEFAULT_BYTES ((size_t)512 << 20)
void field_set_cache_limit(struct field *field, size_t bytes);
size_t field_bytes(const struct field *field); /* kept now */
void field_clear_cache(struct field *field);   /* drops all that is kept */

/* The scalars of one asset, brought up to date with the snapshot: values, metres, or differences. Distances have no data where the
   surface does not lead (the value there is the largest). Belongs to `field`, valid until the next call with other parameters;
   scalars->version grows only when a value or a flag really changed. NULL: the asset has no sensor of the group (a distance: is not
   the sensor's own), or out of memory. Shared by all who ask with equal parameters; the least recently used are dropped beyond the
   bound. */
const struct scalars *field_scalars(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot);

/* The same, but only the first `count` vertices must be up to date (scalars->ready of them are): those of a level of detail. */
const struct scalars *field_scalars_of(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
                                       size_t count);
/* Brings these fields up to date side by side, each on one core: small ones are not worth waking another thread for each. What it leaves
   (large ones, trials, where memory is short) field_scalars_of does, which is to be called next for all of them. counts: by place in
   assets. */
void field_update_all(struct field *field, const int *assets, const size_t *counts, size_t asset_count, const struct field_params *params,
                      const struct snapshot *snapshot);
/* Works towards that for about so many nanoseconds of one core, so that much to do at once holds nobody up. True: it would be had at
   once now. While false comes, the readings are those of the first call, and these scalars must not be read. */
bool field_advance(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot, size_t count,
                   double work);

/* Whether there is something to show on that asset, were there enough memory. */
bool field_covers(struct field *field, int asset, const struct field_params *params);

/* What the field at any point of an asset is made of, for whoever works it out by himself. */
struct field_sensor {
    int tag;
    float surface_m[3];   /* as the asset file's positions */
    uint32_t column;      /* in the asset file's sensors; beyond them: it is tried out */
    const float *along_m; /* distances along the surface, of each vertex; NULL: not known yet */
    float strength, decay;
    float value;                        /* as it is summed: for `paper` 0..1, for a difference that of two */
    bool configured, usable, uncertain; /* configured: would take part, were it good */
};
/* Those of the asset, as field_scalars with these parameters has just taken them; *radius_m: R of `paper`. Belongs to whoever asked
   (mem_free). 0: there are none. */
size_t field_sensors(struct field *field, int asset, const struct field_params *params, struct field_sensor **out, float *radius_m);

#endif
