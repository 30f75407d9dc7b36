/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields with trial sensor positions: creates, finds and drops their layouts. */
#include <math.h>

#include "base/mem.h"
#include "field/field_impl.h"
#include "plant/influence.h"

void field_set_trials(struct field *field, struct trials *trials)
{
    field->trials = trials;
}

const struct trial *field_take_trial(struct field *field, const struct field_params *params)
{
    return params->trial && field->trials ? trials_take(field->trials, params->trial) : NULL;
}

void field_give_trial(struct field *field, const struct trial **trial)
{
    if (*trial)
        trials_give(field->trials, trial);
}

static void tried_remove(struct field *field, struct trial_layout **link)
{
    struct trial_layout *tried = *link;
    *link = tried->next;
    if (tried->layout)
        field_forget_trial_layout(field, tried);
    layout_destroy(&tried->layout);
    trials_give(field->trials, &tried->trial);
    mem_free(tried);
}

void field_trials_finish(struct field *field)
{
    while (field->tried)
        tried_remove(field, &field->tried);
}

/* Frees the layouts of dropped trials, except that of trial `keep`. Otherwise layouts would pile up, because each step of
   dragging a sensor creates a trial. */
static void forget_dropped(struct field *field, uint32_t keep)
{
    for (struct trial_layout **link = &field->tried; *link;)
        if ((*link)->trial->id != keep && !trials_live(field->trials, (*link)->trial->id))
            tried_remove(field, link);
        else
            link = &(*link)->next;
}

static struct trial_layout *find(const struct field *field, int asset, const struct field_params *params)
{
    struct trial_layout *tried = field->tried;
    while (tried && (tried->trial->id != params->trial || tried->asset != asset || tried->group != params->group))
        tried = tried->next;
    return tried;
}

/* Returns parameters for a constant field on the asset. All sensor positions there are assumed, so one sensor gives the value
   everywhere, and the group's parameters have no effect. */
static const struct field_params *even_params(struct field *field, int asset, const struct field_params *params, struct field_params *room)
{
    const struct field_layout *layout = field_layout(field, asset, params);
    if (!layout || !layout->assumed || params->show == SHOW_DISTANCE || field_params_cover(params))
        return params;
    if (room != params)
        *room = *params;
    room->interpolation = INTERPOLATION_SHEPARD;
    room->distance = DISTANCE_EUCLIDEAN;
    room->reach_m = INFINITY;
    room->fill = FILL_NONE;
    room->strength = room->decay = 1;
    room->radius_m = 0;
    room->override_count = 0;
    return room;
}

static const struct field_params *trial_params(struct field *field, int asset, const struct field_params *params, struct field_params *room)
{
    if (!params->trial || find(field, asset, params))
        return params;
    const struct trial *trial = field_take_trial(field, params);
    bool touched = layout_is_touched(field->scene, asset, params->group, trial);
    if (touched) {
        struct trial_layout *tried = mem_new(sizeof(*tried));
        forget_dropped(field, params->trial);
        *tried = (struct trial_layout){ .trial = trial, .asset = asset, .group = params->group, .next = field->tried };
        tried->layout = layout_create(field->scene, asset, params->group, trial);
        field->tried = tried;
        return params;
    }
    field_give_trial(field, &trial);
    *room = *params;
    room->trial = 0;
    return room;
}

/* Returns parameters for SHOW_BLIND (size of the smallest detectable hot spot), which depends only on distances, even if the
   group uses an interpolation whose weights plantcast-prep has computed. */
static const struct field_params *blind_params(const struct field_params *params, struct field_params *room)
{
    if (params->show != SHOW_BLIND)
        return params;
    if (room != params)
        *room = *params;
    room->distance = interpolation_distance(room->interpolation, room->distance);
    if (interpolation_is_prepared(room->interpolation))
        room->interpolation = INTERPOLATION_SHEPARD;
    room->reach_m = INFINITY;
    return room;
}

const struct field_params *field_params_of(struct field *field, int asset, const struct field_params *params, struct field_params *room)
{
    return blind_params(even_params(field, asset, trial_params(field, asset, params, room), room), room);
}

struct field_layout *field_layout(struct field *field, int asset, const struct field_params *params)
{
    struct field_layout **at = &field->layouts[(size_t)asset * field->scene->plant->group_count + (size_t)params->group];
    if (params->trial && interpolation_is_prepared(params->interpolation) && params->show != SHOW_DISTANCE)
        /* plantcast-prep has computed no weights for positions that a user tries out: shows no data instead of the previous
           field */
        return NULL;
    if (params->trial)
        return find(field, asset, params)->layout;
    if (!*at)
        *at = layout_create(field->scene, asset, params->group, NULL);
    return *at;
}
