/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cache of computed fields (states) and of sensors' weights, with its eviction. */
#include "field/field_impl.h"
#include "field/update.h"

static void columns_drop(struct field *field, struct weights *weights)
{
    field->bytes -= weights_kept_bytes(weights);
    weights_drop_columns(weights);
}

struct weights **field_cache_bucket(struct field *field, uint64_t hash)
{
    return &field->weights[hash % FIELD_BUCKETS];
}

/* Removes the weights at *link from the hash table and destroys them. */
static void weights_remove(struct field *field, struct weights **link)
{
    struct weights *weights = *link;
    *link = weights->next;
    if (weights->columns)
        columns_drop(field, weights);
    field->bytes -= weights_bytes(weights->layout);
    weights_destroy(&weights);
}

void field_cache_release_weights(struct field_state *state)
{
    if (state->weights)
        state->weights->users--;
    state->weights = NULL;
}

void field_cache_remove_state(struct field *field, struct field_state **link)
{
    struct field_state *state = *link;
    *link = state->next;
    field_cache_release_weights(state);
    field->bytes -= state_bytes(state);
    update_forget(state);
    state_destroy(&state);
}

void field_clear_cache(struct field *field)
{
    for (size_t i = 0; i < field->scene->asset_count; i++)
        while (field->states[i])
            field_cache_remove_state(field, &field->states[i]);
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        while (field->weights[i])
            weights_remove(field, &field->weights[i]);
}

static bool weights_may_go(const struct weights *weights)
{
    return weights->users == 0 || weights->columns;
}

/* Returns the last use of the least recently used entry that may be evicted, as a number of calls (field->tick); UINT64_MAX:
   none may be evicted. */
static uint64_t oldest_use(const struct field *field, const struct field_params *keep)
{
    uint64_t oldest = UINT64_MAX;
    for (size_t i = 0; i < field->scene->asset_count; i++)
        for (const struct field_state *state = field->states[i]; state; state = state->next)
            if (state->used < oldest && !field_params_equal(&state->params, keep))
                oldest = state->used;
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        for (const struct weights *weights = field->weights[i]; weights; weights = weights->next)
            if (weights->used < oldest && weights_may_go(weights))
                oldest = weights->used;
    return oldest;
}

static void drop_used_before(struct field *field, const struct field_params *keep, uint64_t before)
{
    for (size_t i = 0; i < field->scene->asset_count; i++)
        for (struct field_state **link = &field->states[i]; *link;) {
            if ((*link)->used < before && !field_params_equal(&(*link)->params, keep))
                field_cache_remove_state(field, link);
            else
                link = &(*link)->next;
        }
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        for (struct weights **link = &field->weights[i]; *link;) {
            struct weights *weights = *link;
            if (weights->used < before && weights->users == 0) {
                weights_remove(field, link);
                continue;
            }
            if (weights->used < before && weights->columns)
                columns_drop(field, weights);
            link = &weights->next;
        }
}

bool field_cache_make_room(struct field *field, size_t need, const struct field_params *keep, uint64_t before)
{
    while (field->bytes + need > field->bound) {
        uint64_t oldest = oldest_use(field, keep);
        if (oldest >= before)
            return false;
        uint64_t until = oldest + (field->tick - oldest) / 8 + 1;
        drop_used_before(field, keep, until < before ? until : before);
    }
    return true;
}

/* Caches columns of G (one sensor's weights at all vertices) only when they are summed for the second time: while a user drags
   a slider, each set of weights is summed only once. To make room, evicts only entries last used before the previous use of
   these weights; otherwise two fields in constant use would evict each other forever. If not all columns fit, caches the parts
   for the first vertices, which all levels of detail use. */
void field_cache_keep_columns(struct field *field, struct weights *weights, const struct field_params *params, uint64_t previous)
{
    size_t bytes = weights_column_bytes(weights), had = weights_kept_bytes(weights);
    if (weights->sums == 0 || had == bytes)
        return;
    if (had == 0)
        field_cache_make_room(field, bytes < field->bound ? bytes : field->bound, params, previous);
    /* Some columns of G (a column is one sensor's weights) are cached already, but the cache has no room for all columns: keeps
       the cached columns and adds none. */
    else if (field->bytes - had + bytes > field->bound)
        return;
    else
        columns_drop(field, weights);
    if (field->bytes < field->bound)
        field->bytes += weights_keep(weights, field->bound - field->bytes);
}

void field_forget_trial_layout(struct field *field, const struct trial_layout *tried)
{
    for (struct field_state **link = &field->states[tried->asset]; *link;)
        if ((*link)->layout == tried->layout)
            field_cache_remove_state(field, link);
        else
            link = &(*link)->next;
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        for (struct weights **link = &field->weights[i]; *link;)
            if ((*link)->layout == tried->layout)
                weights_remove(field, link);
            else
                link = &(*link)->next;
}
