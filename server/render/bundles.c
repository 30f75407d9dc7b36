/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts draws by state, keeping the order in which they came. */
#include "render/bundles.h"

#include <string.h>

#include "base/mem.h"

static const size_t NONE = SIZE_MAX;

void bundles_finish(struct bundles *bundles)
{
    GLuint buffers[] = { bundles->instance_buffer, bundles->command_buffer, bundles->place_buffer };
    glDeleteBuffers(sizeof(buffers) / sizeof(buffers[0]), buffers);
    mem_free(bundles->at);
    mem_free(bundles->instances);
    mem_free(bundles->commands);
    mem_free(bundles->sorted);
    mem_free(bundles->bundle_of);
    mem_free(bundles->place_of);
    mem_free(bundles->newest);
    *bundles = (struct bundles){ 0 };
}

void bundles_begin(struct bundles *bundles, size_t model_count)
{
    bundles->count = bundles->from = bundles->instance_count = bundles->command_count = 0;
    mem_grow(&bundles->newest, &bundles->newest_capacity, model_count, sizeof(*bundles->newest));
    for (size_t i = 0; i < model_count; i++)
        bundles->newest[i] = NONE;
}

uint32_t bundles_add_instance(struct bundles *bundles, const struct bundle_instance *instance)
{
    mem_grow(&bundles->instances, &bundles->instance_capacity, bundles->instance_count + 1, sizeof(*bundles->instances));
    bundles->instances[bundles->instance_count] = *instance;
    return (uint32_t)bundles->instance_count++;
}

static bool alike(const struct bundle_state *a, const struct bundle_state *b)
{
    return a->program == b->program && a->model == b->model && a->light == b->light && a->field == b->field && a->front == b->front &&
           a->material == b->material && a->alone == b->alone && a->two_sided == b->two_sided && a->mirrored == b->mirrored &&
           a->cut == b->cut && a->blend == b->blend;
}

size_t bundles_choose(struct bundles *bundles, const struct bundle_state *state, size_t model, bool in_order)
{
    size_t known = in_order ? bundles->count - 1 : bundles->newest[model];
    if (in_order && (bundles->count == bundles->from || !alike(&bundles->at[known].state, state)))
        known = NONE;
    while (!in_order && known != NONE && known >= bundles->from && !alike(&bundles->at[known].state, state))
        known = bundles->at[known].older;
    if (known != NONE && known >= bundles->from)
        return known;
    mem_grow(&bundles->at, &bundles->capacity, bundles->count + 1, sizeof(*bundles->at));
    bundles->at[bundles->count] = (struct bundle){ .state = *state, .older = bundles->newest[model] };
    bundles->newest[model] = bundles->count;
    return bundles->count++;
}

/* Of one asset, what follows in the buffer of indices is drawn as one. */
static void add(struct bundles *bundles, size_t bundle, uint32_t instance, uint32_t first_index, uint32_t count, uint32_t shown)
{
    size_t at = bundles->command_count;
    struct bundle_command *last = at > 0 ? &bundles->commands[at - 1] : NULL;
    if (last && bundles->bundle_of[at - 1] == bundle && last->base_instance == instance && last->first_index + last->count == first_index) {
        last->count += count;
        return;
    }
    mem_grow(&bundles->commands, &bundles->command_capacity, at + 1, sizeof(*bundles->commands));
    mem_grow(&bundles->bundle_of, &bundles->bundle_of_capacity, at + 1, sizeof(*bundles->bundle_of));
    bundles->commands[at] =
        (struct bundle_command){ .count = count, .instances = shown, .first_index = first_index, .base_instance = instance };
    bundles->bundle_of[at] = (uint32_t)bundle;
    bundles->at[bundle].count++;
    bundles->command_count++;
}

static uint32_t index_of(const struct model_batch *batch, GLsizei draw)
{
    return (uint32_t)((uintptr_t)batch->offsets[draw] / 4);
}

void bundles_add_batch(struct bundles *bundles, size_t bundle, const struct model_batch *batch, uint32_t instance, uint32_t shown)
{
    for (GLsizei i = 0; i < batch->draws; i++)
        add(bundles, bundle, instance, index_of(batch, i), (uint32_t)batch->counts[i], shown);
}

static size_t first_cluster(const struct asset_view *file, uint32_t first_index)
{
    size_t low = 0, high = file->header->cluster_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (file->clusters[middle].first_index < first_index)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int bundles_add_seen(struct bundles *bundles, size_t bundle, const struct model_batch *batch, uint32_t instance,
                     const struct culling *culling)
{
    const struct bundle_state *state = &bundles->at[bundle].state;
    const struct asset_view *file = &state->model->file->view;
    uint32_t indices = 0;
    for (GLsizei i = 0; i < batch->draws; i++) {
        uint32_t first = index_of(batch, i), end = first + (uint32_t)batch->counts[i];
        for (size_t c = first_cluster(file, first); c < file->header->cluster_count && file->clusters[c].first_index < end; c++)
            if (culling_sees(culling, &file->clusters[c], state->two_sided)) {
                add(bundles, bundle, instance, file->clusters[c].first_index, file->clusters[c].index_count, 1);
                indices += file->clusters[c].index_count;
            }
    }
    return (int)(indices / 3);
}

static void sort(struct bundles *bundles)
{
    size_t first = 0;
    mem_grow(&bundles->sorted, &bundles->sorted_capacity, bundles->command_count, sizeof(*bundles->sorted));
    mem_grow(&bundles->place_of, &bundles->place_capacity, bundles->command_count, sizeof(*bundles->place_of));
    for (size_t i = 0; i < bundles->count; i++) {
        bundles->at[i].first = first;
        first += bundles->at[i].count;
        bundles->at[i].count = 0;
    }
    for (size_t i = 0; i < bundles->command_count; i++) {
        struct bundle *bundle = &bundles->at[bundles->bundle_of[i]];
        size_t place = bundle->first + bundle->count++;
        bundles->sorted[place] = bundles->commands[i];
        bundles->place_of[i] = (uint32_t)place;
    }
}

bool bundles_refill(struct log *log, GLuint *buffer, size_t *room, size_t bytes, const void *data)
{
    if (*room < bytes) {
        glDeleteBuffers(1, buffer);
        *room = bytes + bytes / 2;
        *buffer = mesh_buffer(log, "what is drawn", *room, NULL, GL_DYNAMIC_STORAGE_BIT);
        if (!*buffer)
            *room = 0;
    }
    if (*buffer && bytes > 0)
        glNamedBufferSubData(*buffer, 0, (GLsizeiptr)bytes, data);
    return *buffer != 0 || bytes == 0;
}

bool bundles_upload(struct bundles *bundles, bool places)
{
    size_t commands = bundles->command_count;
    sort(bundles);
    return bundles_refill(bundles->log, &bundles->instance_buffer, &bundles->instance_room,
                          bundles->instance_count * sizeof(*bundles->instances), bundles->instances) &&
           bundles_refill(bundles->log, &bundles->command_buffer, &bundles->command_room, commands * sizeof(*bundles->sorted),
                          bundles->sorted) &&
           (!places || bundles_refill(bundles->log, &bundles->place_buffer, &bundles->place_room, commands * sizeof(*bundles->place_of),
                                      bundles->place_of));
}

void bundles_draw(const struct bundles *bundles, const struct bundle *bundle)
{
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, bundles->command_buffer);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, (const void *)(bundle->first * sizeof(struct bundle_command)),
                                (GLsizei)bundle->count, 0);
}
