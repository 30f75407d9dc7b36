/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What field.c and field_ask.c share. Private to field/. */
#ifndef FIELD_FIELD_IMPL_H
#define FIELD_FIELD_IMPL_H
#include "field/field.h"
#include "field/state.h"

#define FIELD_BUCKETS 256

struct field {
    struct workers *workers;
    const struct scene *scene;
    struct layout **layouts;                /* [asset][group]; NULL: not looked for, or none */
    struct state **states;                  /* by asset: a list */
    struct weights *weights[FIELD_BUCKETS]; /* all of them, by hash of the key */
    struct baselines *baselines;            /* NULL: none */
    struct trials *trials;                  /* NULL: none */
    struct trial_layout {                   /* layouts with places that are tried out */
        const struct trial *trial;          /* held */
        int asset, group;
        struct layout *layout; /* NULL: no sensor is left there */
        struct trial_layout *next;
    } * tried;
    size_t bytes, bound;
    uint64_t tick; /* counts calls: what was used last */
    uint64_t versions;
};

/* NULL: no sensor of the group on the asset. trial: as in field_params_of, which params have been through. */
struct layout *field_layout(struct field *field, int asset, const struct field_params *params);
/* field_trials.c: what the trial makes of it. */
struct layout *field_trial_layout(struct field *field, int asset, const struct field_params *params);
void field_forget_trial_layout(struct field *field, const struct trial_layout *tried); /* in field.c: all that is made of its layout */
void field_trials_finish(struct field *field);
/* Found or made; not brought up to date. NULL: no sensor of the group on the asset, or out of memory. */
struct state *field_state(struct field *field, int asset, const struct field_params *params);

/* Looks at the readings; begins what there is to do. False: out of memory, the state is gone. */
bool field_begin_update(struct field *field, struct state *state, const struct snapshot *snapshot, size_t count);

#endif
