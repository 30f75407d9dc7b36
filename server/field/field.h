/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the field of an asset: a scalar at every vertex, interpolated from the readings of the asset's sensors. Symbols: v_i
   is the reading of sensor i, s_i its strength, o_i its decay, and D_i the distance from the sensor to the vertex (Euclidean or
   geodesic). p is the power, R the radius, and MIN to MAX the range of the group. Interpolations: - shepard (inverse distance
   weighting, Shepard 1968): value = (sum_i s_i v_i / D_i^p) / (sum_i s_i / D_i^p), and exactly v_i at distance 0. A sensor of
   strength 0 never contributes. Only ratios of strengths matter. Decay has no effect. - paper (Algorithm 1 of Kim & Suh,
   Electronics 2025, 14(15), 2938): d_i = max(0, 1 - D_i/R), w_i = exp(d_i s_i) / sum_k exp(d_k s_k), u_i = clamp((v_i -
   MIN)/(MAX - MIN)), value = sum_i u_i w_i d_i^o_i. The scalar is MIN + value (MAX - MIN). - harmonic, fin: value = sum_i H_i
   v_i, with weights H from the asset's influence file (protocol/ASSET.md). For fin, values are relative to the ambient value.
   There is no data where the weights of fin add up to less than a tenth. - gp: like harmonic, but the weights add up to 1 on
   each body and may be negative (preprocess/influence/gaussian.h). There is no data where the sensors reduce the prior's
   variance by less than a tenth. H is prepared for all sensors: a lost sensor gets the value that the other sensors predict for
   it (field/influence_fill.h). Trial positions of sensors have no prepared weights. Which sensors contribute: those of the
   group and the asset whose quality is not Bad, with finite D_i <= reach_m. If reach_m is set, the weight is multiplied by (1 -
   D_i/reach_m)^2, so that the field has no edge at that distance (with p = 2: the weights of Franke & Nielson 1980). Weights
   are normalised, so the field of a single sensor does not fade towards reach_m. There is no data where no sensor contributes,
   and where the nearest sensor is Bad but would contribute otherwise. The parameter `fill` fills these places, flagged as
   uncertain. Otherwise they store the scalar of the nearest contributing sensor, or MIN. Sensors with an assumed position
   (`Place: equipment`) never produce a gradient. They are ignored if the asset has a sensor of the group with a known position.
   Otherwise one sensor, never a mean, gives the value of the whole asset: the one closest to its own limits, or farthest beyond
   them; without limits, the one farthest from the middle of the group's range. If all are Bad, there is no data. Quantities
   other than the value (`show`): the distance from one sensor in metres; the difference from a baseline, over the sensors
   usable both now and then (paper subtracts clamped readings); for operators, the position of readings between their own limits
   (field/limits.h), interpolated with the same weights. Sensors without limits do not contribute to that position, and vertices
   nearest to such a sensor are flagged. The uncertainty (standard deviation of gp) and the blind spots (smallest hot spot that
   the nearest Good sensor would show) depend only on which sensors are Good. The field is linear in the readings: value = G v /
   G 1, with weights G before normalisation, and 1 a vector of ones. A bounded cache keeps G; without it, G is recomputed with
   identical bits. A changed reading adds its change times one column of G. A changed quality recomputes the sum. Call from one
   thread at a time per field (work is spread over `workers`). */
#ifndef FIELD_FIELD_H
#define FIELD_FIELD_H
#include "base/workers.h"
#include "field/params.h"
#include "field/pixel_field.h"
#include "field/trials.h"
#include "field/scalars.h"
#include "plant/plant.h"
#include "scene/scene.h"
#include "value/baselines.h"
#include "value/snapshot.h"

/* Computes the scalars of all assets of a scene, and caches them by their parameters. Call from one thread at a time. */
struct field;
/* Creates an empty field. Both workers and scene must outlive it. The caller destroys it. */
struct field *field_create(struct workers *workers, const struct scene *scene);
/* Frees the field and its cache. Accepts a pointer to NULL; sets the pointer to NULL. */
void field_destroy(struct field **field);
const struct scene *field_scene(const struct field *field);
struct workers *field_workers(const struct field *field);
/* Sets the registry of baselines for differences; it must outlive the field. Without a registry, or if the baseline was
   forgotten, a difference has no data. */
void field_set_baselines(struct field *field, struct baselines *baselines);
/* Sets the registry of sensors' trial positions; it must outlive the field. Without a registry, or if the trial no longer
   exists, sensors have the plant's positions. */
void field_set_trials(struct field *field, struct trials *trials);
/* Returns the parameters under which this asset's field is cached: `params` itself or, if fewer parameters affect this asset, a
   modified copy in *room. The copy drops a trial that moves no sensor of this asset. If all sensor positions are assumed, the
   copy has the parameters of a constant field. */
const struct field_params *field_params_of(struct field *field, int asset, const struct field_params *params, struct field_params *room);
/* Returns the trial (set of moved sensors) whose id is params->trial; the caller releases it with field_give_trial(). NULL: the id is 0, or
   the trial no longer exists. */
const struct trial *field_take_trial(struct field *field, const struct field_params *params);
/* Ends the caller's use of a trial from field_take_trial(), which may be freed afterwards. Accepts a pointer to NULL; sets the
   pointer to NULL. */
void field_give_trial(struct field *field, const struct trial **trial);
/* If params show the difference from a baseline, writes that baseline to *out. Returns false if they show no difference, or if
   the baseline was forgotten. */
bool field_baseline(const struct field *field, const struct field_params *params, struct baseline *out);
#define FIELD_DEFAULT_BYTES ((size_t)512 << 20)
/* Sets the limit of the cache in bytes, initially FIELD_DEFAULT_BYTES. The field last requested is kept even if it exceeds the
   limit by itself. */
void field_set_cache_limit(struct field *field, size_t bytes);
/* Returns the size in bytes of the field's cache. */
size_t field_bytes(const struct field *field);
/* Frees all fields and sensors' weights that the cache of this field object holds. */
void field_clear_cache(struct field *field);

/* Updates the scalars of the first `count` vertices of one asset, which are those of one level of detail, to the snapshot, and
   returns them: the first scalars->ready vertices are valid. The scalars are owned by the field, shared by all callers with
   equal parameters, and valid until the next call with other parameters. scalars->version grows only when a value or flag has
   changed. For SHOW_DISTANCE, vertices that no path reaches have no data (their stored value is the largest distance). Returns
   NULL if the asset has no sensor of the group (for a distance: not that sensor), or when out of memory. */
const struct scalars *field_scalars_of(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
                                       size_t count);
/* Updates the fields of several small assets in parallel, each on one core. Skips large fields, fields of trials, and fields
   for which memory is short: the caller must call field_scalars_of() for all assets afterwards. counts: for each index in
   `assets`, the number of vertices whose values are wanted. */
void field_update_all(struct field *field, const int *assets, const size_t *counts, size_t asset_count, const struct field_params *params,
                      const struct snapshot *snapshot);
/* Does the work of field_scalars_of() in steps of about `work` nanoseconds (of one core), so that a large update does not block
   the thread. Returns true when the update is complete. Until then, it uses the readings of the first call, and the scalars
   must not be read. */
bool field_advance(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot, size_t count,
                   double work);

/* Returns true if one sensor gives the value of the whole asset, because all its sensors have assumed positions. */
bool field_is_assumed(struct field *field, int asset, const struct field_params *params);
/* Returns true if, given enough memory, the asset has a field to show with these parameters. */
bool field_covers(struct field *field, int asset, const struct field_params *params);

/* A point on the surface: barycentric coordinates in a triangle of the asset's file. */
struct field_place {
    uint32_t corners[3];
    double parts[3];
};
struct field_point {
    double value; /* value of the field at the point, in the unit of the quantity that is shown */
    bool no_data, uncertain;
    double drawn_error; /* error bound of the values drawn on this triangle, in the unit of `value`; 0: less than 1/255 of the range */
};
/* Computes the field at a point from the readings: exactly for straight-line distances; geodesic distances are derived from
   those at the triangle's corners. harmonic, fin and gp exist only as solutions on a mesh: they are interpolated between the
   vertices of the finest level, and drawn_error bounds the deviation from the exact solution. Returns false if the asset has no
   field with these parameters. */
bool field_at(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
              const struct field_place *place, struct field_point *out);

/* One sensor's inputs to the field of an asset, for callers that evaluate the field themselves. */
struct field_sensor {
    int tag;
    float surface_m[3]; /* position of the sensor in metres, in the coordinates of the asset file */
    /* index of the sensor in the asset file; sensors on trial that the file lacks have the indices after those of the file's
       sensors */
    uint32_t column;
    bool in_file;       /* true: a column of the file has the sensor's geodesic distances; false: along_m has them */
    /* [vertex]: geodesic distance from the sensor in metres, if the asset file lacks it; NULL: not computed yet, or
       straight-line distances are used */
    const float *along_m;
    float strength, decay;
    /* the sensor's value in the weighted sum; scaled to 0..1 for interpolation `paper` (Algorithm 1 of Kim & Suh); for a
       difference, the reading minus the baseline's reading */
    float value;
    bool configured, usable, uncertain; /* configured: the sensor would contribute if its quality were good; usable: it contributes;
                                           uncertain: its quality is Uncertain */
};
/* Lists the sensors of an asset's field with their inputs (struct field_sensor), as used by the last field_scalars_of() with
   these parameters. *radius_m receives the radius R of Algorithm 1 (Kim & Suh). Returns the number of inputs; 0: no sensor
   contributes. The caller frees *out (mem_free). */
size_t field_sensors(struct field *field, int asset, const struct field_params *params, struct field_sensor **out, float *radius_m);
/* Returns the distances in metres from the place to the sensors of field_sensors(), in their order, as the field measures them
   (layout_distances()). NULL: no sensor. The caller frees them (mem_free). */
float *field_distances_at(struct field *field, int asset, const struct field_params *params, const struct field_place *place);
/* Fills *out with the sensors and readings from which renderers evaluate the field at each pixel, as used by the last
   field_scalars_of() with these parameters. out->count is 0 if the field must be interpolated between vertices, or is the same
   everywhere. The caller frees the sensors with pixel_field_finish(). */
void field_pixels(struct field *field, int asset, const struct field_params *params, struct pixel_field *out);
/* Returns how many of `count` vertices need values for a picture: 0 if the field is evaluated at each pixel. */
size_t field_vertices(struct field *field, int asset, const struct field_params *params, size_t count);

#endif
