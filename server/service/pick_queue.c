/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores pick queries ("what is at this pixel?") and their answers in two lists under one lock. */
#include "service/pick_queue.h"

#include <pthread.h>
#include <string.h>

#include "base/mem.h"

struct pick_queue {
    pthread_mutex_t lock;
    /* --- below: protected by `lock` */
    struct pick_query *queries; /* waiting pick queries, oldest first */
    size_t count, capacity;
    struct pick_answer *answers, **last;
};

struct pick_queue *pick_queue_create(void)
{
    struct pick_queue *queue = mem_new(sizeof(*queue));
    pthread_mutex_init(&queue->lock, NULL);
    queue->last = &queue->answers;
    return queue;
}

void pick_queue_destroy(struct pick_queue **picks_ptr)
{
    struct pick_queue *queue = *picks_ptr;
    if (!queue)
        return;
    for (struct pick_answer *answer = queue->answers, *next; answer; answer = next) {
        next = answer->next;
        mem_free(answer);
    }
    pthread_mutex_destroy(&queue->lock);
    mem_free(queue->queries);
    mem_free(queue);
    *picks_ptr = NULL;
}

/* Returns the index of the client's pick query (what is at a pixel), or the list's count if the client has none. The caller
   holds the lock. */
static size_t find(const struct pick_queue *queue, uint64_t client)
{
    size_t i = 0;
    while (i < queue->count && queue->queries[i].client != client)
        i++;
    return i;
}

static void remove_at(struct pick_queue *queue, size_t i)
{
    queue->count--;
    memmove(&queue->queries[i], &queue->queries[i + 1], (queue->count - i) * sizeof(*queue->queries));
}

void pick_queue_ask(struct pick_queue *queue, const struct pick_query *query)
{
    pthread_mutex_lock(&queue->lock);
    size_t i = find(queue, query->client);
    if (i == queue->count)
        mem_grow(&queue->queries, &queue->capacity, ++queue->count, sizeof(*queue->queries));
    queue->queries[i] = *query;
    pthread_mutex_unlock(&queue->lock);
}

void pick_queue_forget(struct pick_queue *queue, uint64_t client)
{
    pthread_mutex_lock(&queue->lock);
    size_t i = find(queue, client);
    if (i < queue->count)
        remove_at(queue, i);
    pthread_mutex_unlock(&queue->lock);
}

bool pick_queue_has_query(struct pick_queue *queue)
{
    pthread_mutex_lock(&queue->lock);
    bool any = queue->count > 0;
    pthread_mutex_unlock(&queue->lock);
    return any;
}

bool pick_queue_take(struct pick_queue *queue, struct pick_query *out)
{
    pthread_mutex_lock(&queue->lock);
    bool any = queue->count > 0;
    if (any) {
        *out = queue->queries[0];
        remove_at(queue, 0);
    }
    pthread_mutex_unlock(&queue->lock);
    return any;
}

bool pick_queue_answer(struct pick_queue *queue, const struct pick_query *query, const struct pick *pick)
{
    struct pick_answer *answer = mem_new(sizeof(*answer));
    *answer = (struct pick_answer){ .query = *query, .pick = *pick };
    pthread_mutex_lock(&queue->lock);
    bool first = queue->answers == NULL;
    *queue->last = answer;
    queue->last = &answer->next;
    pthread_mutex_unlock(&queue->lock);
    return first;
}

struct pick_answer *pick_queue_collect(struct pick_queue *queue)
{
    pthread_mutex_lock(&queue->lock);
    struct pick_answer *answers = queue->answers;
    queue->answers = NULL;
    queue->last = &queue->answers;
    pthread_mutex_unlock(&queue->lock);
    return answers;
}
