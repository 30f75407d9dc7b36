/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Updates the fields (values interpolated between sensors) of many assets in parallel. */
#include "base/mem.h"
#include "field/field_impl.h"
#include "field/update.h"

struct together {
    struct field_state **states;
    size_t count;
};

static void update_some(void *arg, size_t begin, size_t end)
{
    const struct together *together = arg;
    for (size_t i = begin; i < end; i++)
        update_run(together->states[i]);
}

/* Updates the fields of several assets in parallel, but only those whose weights are completely computed: other updates would
   compute weights that instances of one asset share, so that two threads might write the same weights */
void field_update_all(struct field *field, const int *assets, const size_t *counts, size_t asset_count, const struct field_params *params,
                      const struct snapshot *snapshot)
{
    if (asset_count < 2 || params->show == SHOW_DISTANCE || field_params_cover(params) || params->trial)
        return;
    struct together together = { mem_array(asset_count, sizeof(*together.states)), 0 };
    size_t begun = 0;
    for (size_t i = 0; i < asset_count; i++) {
        field->tick++;
        struct field_state *state = field_state(field, assets[i], params);
        if (!state || state->update)
            continue;
        state->used = field->tick;
        state->wanted = state->wanted > counts[i] ? state->wanted : counts[i];
        if (field_begin_update(field, state, snapshot, counts[i]) && state->update)
            together.states[begun++] = state;
    }
    /* calls update_is_light() only after all updates have begun: it needs the state's cached weights complete, and the beginning of
       another state's update may still evict them */
    for (size_t i = 0; i < begun; i++)
        if (update_is_light(together.states[i]))
            together.states[together.count++] = together.states[i];
    workers_for(field->workers, together.count, 1, update_some, &together);
    for (size_t i = 0; i < together.count; i++)
        update_end(together.states[i], &field->versions);
    mem_free(together.states);
}
