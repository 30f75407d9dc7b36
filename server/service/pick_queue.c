/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two lists under one lock. */
#include "service/pick_queue.h"

#include <pthread.h>
#include <string.h>

#include "base/mem.h"

struct pick_queue {
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct pick_query *orders; /* oldest first */
    size_t count, capacity;
    struct pick_answer *answers, **last;
};

struct pick_queue *pick_queue_create(void)
{
    struct pick_queue *picks = mem_new(sizeof(*picks));
    pthread_mutex_init(&picks->lock, NULL);
    picks->last = &picks->answers;
    return picks;
}

void pick_queue_destroy(struct pick_queue **picks_ptr)
{
    struct pick_queue *picks = *picks_ptr;
    if (!picks)
        return;
    for (struct pick_answer *answer = picks->answers, *next; answer; answer = next) {
        next = answer->next;
        mem_free(answer);
    }
    pthread_mutex_destroy(&picks->lock);
    mem_free(picks->orders);
    mem_free(picks);
    *picks_ptr = NULL;
}

/* Under lock. */
static size_t find(const struct pick_queue *picks, uint64_t client)
{
    size_t i = 0;
    while (i < picks->count && picks->orders[i].client != client)
        i++;
    return i;
}

static void remove_at(struct pick_queue *picks, size_t i)
{
    picks->count--;
    memmove(&picks->orders[i], &picks->orders[i + 1], (picks->count - i) * sizeof(*picks->orders));
}

void pick_queue_ask(struct pick_queue *picks, const struct pick_query *order)
{
    pthread_mutex_lock(&picks->lock);
    size_t i = find(picks, order->client);
    if (i == picks->count)
        mem_grow(&picks->orders, &picks->capacity, ++picks->count, sizeof(*picks->orders));
    picks->orders[i] = *order;
    pthread_mutex_unlock(&picks->lock);
}

void pick_queue_forget(struct pick_queue *picks, uint64_t client)
{
    pthread_mutex_lock(&picks->lock);
    size_t i = find(picks, client);
    if (i < picks->count)
        remove_at(picks, i);
    pthread_mutex_unlock(&picks->lock);
}

bool pick_queue_has_query(struct pick_queue *picks)
{
    pthread_mutex_lock(&picks->lock);
    bool any = picks->count > 0;
    pthread_mutex_unlock(&picks->lock);
    return any;
}

bool pick_queue_take(struct pick_queue *picks, struct pick_query *out)
{
    pthread_mutex_lock(&picks->lock);
    bool any = picks->count > 0;
    if (any) {
        *out = picks->orders[0];
        remove_at(picks, 0);
    }
    pthread_mutex_unlock(&picks->lock);
    return any;
}

bool pick_queue_answer(struct pick_queue *picks, const struct pick_query *order, const struct pick *pick)
{
    struct pick_answer *answer = mem_new(sizeof(*answer));
    *answer = (struct pick_answer){ .order = *order, .pick = *pick };
    pthread_mutex_lock(&picks->lock);
    bool first = picks->answers == NULL;
    *picks->last = answer;
    picks->last = &answer->next;
    pthread_mutex_unlock(&picks->lock);
    return first;
}

struct pick_answer *pick_queue_collect(struct pick_queue *picks)
{
    pthread_mutex_lock(&picks->lock);
    struct pick_answer *answers = picks->answers;
    picks->answers = NULL;
    picks->last = &picks->answers;
    pthread_mutex_unlock(&picks->lock);
    return answers;
}
