/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects draw commands into batches of equal GL state; commands within a batch keep their order. */
#include "render/gl/draw_batches.h"

#include "base/math/search.h"
#include "base/mem.h"

static const size_t NONE = SIZE_MAX;

void draw_batches_finish(struct draw_batches *batches)
{
    GLuint buffers[] = { batches->instance_buffer, batches->command_buffer, batches->place_buffer };
    glDeleteBuffers(sizeof(buffers) / sizeof(buffers[0]), buffers);
    mem_free(batches->at);
    mem_free(batches->instances);
    mem_free(batches->commands);
    mem_free(batches->sorted);
    mem_free(batches->batch_of);
    mem_free(batches->place_of);
    mem_free(batches->newest);
    *batches = (struct draw_batches){ 0 };
}

void draw_batches_begin(struct draw_batches *batches, size_t model_count)
{
    batches->count = batches->from = batches->instance_count = batches->command_count = 0;
    mem_grow(&batches->newest, &batches->newest_capacity, model_count, sizeof(*batches->newest));
    for (size_t i = 0; i < model_count; i++)
        batches->newest[i] = NONE;
}

uint32_t draw_batches_add_instance(struct draw_batches *batches, const struct draw_instance *instance)
{
    mem_grow(&batches->instances, &batches->instance_capacity, batches->instance_count + 1, sizeof(*batches->instances));
    batches->instances[batches->instance_count] = *instance;
    return (uint32_t)batches->instance_count++;
}

static bool alike(const struct draw_batch_state *a, const struct draw_batch_state *b)
{
    return a->program == b->program && a->model == b->model && a->light == b->light && a->field == b->field && a->front == b->front &&
           a->material == b->material && a->alone == b->alone && a->two_sided == b->two_sided && a->mirrored == b->mirrored &&
           a->cut == b->cut && a->blend == b->blend;
}

size_t draw_batches_choose(struct draw_batches *batches, const struct draw_batch_state *state, size_t model, bool in_order)
{
    size_t known = in_order ? batches->count - 1 : batches->newest[model];
    if (in_order && (batches->count == batches->from || !alike(&batches->at[known].state, state)))
        known = NONE;
    while (!in_order && known != NONE && known >= batches->from && !alike(&batches->at[known].state, state))
        known = batches->at[known].older;
    if (known != NONE && known >= batches->from)
        return known;
    mem_grow(&batches->at, &batches->capacity, batches->count + 1, sizeof(*batches->at));
    batches->at[batches->count] = (struct draw_batch){ .state = *state, .older = batches->newest[model] };
    batches->newest[model] = batches->count;
    return batches->count++;
}

/* Adds a draw command. Merges it with the last command if both belong to one asset and their index ranges are contiguous. */
static void add_command(struct draw_batches *batches, size_t batch, uint32_t instance, uint32_t first_index, uint32_t count, uint32_t shown)
{
    size_t at = batches->command_count;
    struct draw_command *last = at > 0 ? &batches->commands[at - 1] : NULL;
    if (last && batches->batch_of[at - 1] == batch && last->base_instance == instance && last->first_index + last->count == first_index) {
        last->count += count;
        return;
    }
    mem_grow(&batches->commands, &batches->command_capacity, at + 1, sizeof(*batches->commands));
    mem_grow(&batches->batch_of, &batches->batch_of_capacity, at + 1, sizeof(*batches->batch_of));
    batches->commands[at] =
        (struct draw_command){ .count = count, .instances = shown, .first_index = first_index, .base_instance = instance };
    batches->batch_of[at] = (uint32_t)batch;
    batches->at[batch].count++;
    batches->command_count++;
}

static uint32_t index_of(const struct model_submesh *submesh, GLsizei draw)
{
    return (uint32_t)((uintptr_t)submesh->offsets[draw] / 4);
}

void draw_batches_add_submesh(struct draw_batches *batches, size_t batch, const struct model_submesh *submesh, uint32_t instance,
                              uint32_t shown)
{
    for (GLsizei i = 0; i < submesh->draws; i++)
        add_command(batches, batch, instance, index_of(submesh, i), (uint32_t)submesh->counts[i], shown);
}

static size_t first_cluster(const struct asset_view *file, uint32_t first_index)
{
    size_t at;
    search_sorted(at, file->header->cluster_count, file->clusters[at].first_index < first_index);
    return at;
}

int draw_batches_add_seen(struct draw_batches *batches, size_t batch, const struct model_submesh *submesh, uint32_t instance,
                          const struct culling *culling)
{
    const struct draw_batch_state *state = &batches->at[batch].state;
    const struct asset_view *file = &state->model->file->view;
    uint32_t indices = 0;
    for (GLsizei i = 0; i < submesh->draws; i++) {
        uint32_t first = index_of(submesh, i), end = first + (uint32_t)submesh->counts[i];
        for (size_t c = first_cluster(file, first); c < file->header->cluster_count && file->clusters[c].first_index < end; c++)
            if (culling_sees(culling, &file->clusters[c], state->two_sided)) {
                add_command(batches, batch, instance, file->clusters[c].first_index, file->clusters[c].index_count, 1);
                indices += file->clusters[c].index_count;
            }
    }
    return (int)(indices / 3);
}

static void sort(struct draw_batches *batches)
{
    size_t first = 0;
    mem_grow(&batches->sorted, &batches->sorted_capacity, batches->command_count, sizeof(*batches->sorted));
    mem_grow(&batches->place_of, &batches->place_capacity, batches->command_count, sizeof(*batches->place_of));
    for (size_t i = 0; i < batches->count; i++) {
        batches->at[i].first = first;
        first += batches->at[i].count;
        batches->at[i].count = 0;
    }
    for (size_t i = 0; i < batches->command_count; i++) {
        struct draw_batch *batch = &batches->at[batches->batch_of[i]];
        size_t place = batch->first + batch->count++;
        batches->sorted[place] = batches->commands[i];
        batches->place_of[i] = (uint32_t)place;
    }
}

bool draw_batches_refill(struct log *log, GLuint *buffer, size_t *room, size_t bytes, const void *data)
{
    if (*room < bytes) {
        glDeleteBuffers(1, buffer);
        *room = bytes + bytes / 2;
        *buffer = mesh_buffer(log, "draw commands", *room, NULL, GL_DYNAMIC_STORAGE_BIT);
        if (!*buffer)
            *room = 0;
    }
    if (*buffer && bytes > 0)
        glNamedBufferSubData(*buffer, 0, (GLsizeiptr)bytes, data);
    return *buffer != 0 || bytes == 0;
}

bool draw_batches_upload(struct draw_batches *batches, bool places)
{
    size_t commands = batches->command_count;
    sort(batches);
    return draw_batches_refill(batches->log, &batches->instance_buffer, &batches->instance_room,
                               batches->instance_count * sizeof(*batches->instances), batches->instances) &&
           draw_batches_refill(batches->log, &batches->command_buffer, &batches->command_room, commands * sizeof(*batches->sorted),
                               batches->sorted) &&
           (!places || draw_batches_refill(batches->log, &batches->place_buffer, &batches->place_room,
                                           commands * sizeof(*batches->place_of), batches->place_of));
}

void draw_batches_draw(const struct draw_batches *batches, const struct draw_batch *batch)
{
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, batches->command_buffer);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, (const void *)(batch->first * sizeof(struct draw_command)),
                                (GLsizei)batch->count, 0);
}
