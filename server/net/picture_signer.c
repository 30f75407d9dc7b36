/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two lists: what waits, and what is done. The quota on pictures keeps both short. */
#include "net/picture_signer.h"

#include "base/mem.h"
#include "base/thread.h"

struct picture_signer {
    struct thread thread;
    const struct signing_key *key;
    void (*notify)(void *arg);
    void *arg;
    pthread_cond_t settled;
    /* --- below: under thread.lock */
    struct signing *waiting, *done;
    bool busy;
};

void signing_free(struct signing **signing_ptr)
{
    struct signing *signing = *signing_ptr;
    for (size_t i = 0; i < signing->origin.arg_count; i++)
        mem_free((char *)signing->origin.args[i]);
    mem_free((void *)signing->origin.args);
    mem_free(signing->png);
    encoded_frame_destroy(&signing->encoded);
    mem_free(signing);
    *signing_ptr = NULL;
}

static void free_all(struct signing *list)
{
    for (struct signing *next; list; list = next) {
        next = list->next;
        signing_free(&list);
    }
}

static void append(struct signing **list, struct signing *signing)
{
    while (*list)
        list = &(*list)->next;
    *list = signing;
}

static void sign(struct picture_signer *signer, struct signing *signing)
{
    signing->png = signed_picture_make(signer->key, &signing->origin, signing->encoded->packet, &signing->count);
}

static void *run(void *arg)
{
    struct picture_signer *signer = arg;
    pthread_mutex_lock(&signer->thread.lock);
    while (!signer->thread.stopping) {
        struct signing *signing = signer->waiting;
        if (!signing) {
            pthread_cond_wait(&signer->thread.wake, &signer->thread.lock);
            continue;
        }
        signer->waiting = signing->next;
        signing->next = NULL;
        signer->busy = true;
        pthread_mutex_unlock(&signer->thread.lock);
        sign(signer, signing);
        pthread_mutex_lock(&signer->thread.lock);
        signer->busy = false;
        append(&signer->done, signing);
        pthread_cond_signal(&signer->settled);
        signer->notify(signer->arg);
    }
    pthread_mutex_unlock(&signer->thread.lock);
    return NULL;
}

struct picture_signer *picture_signer_create(struct log *log, const struct signing_key *key, void (*notify)(void *arg), void *arg)
{
    struct picture_signer *signer = mem_new(sizeof(*signer));
    signer->key = key;
    signer->notify = notify;
    signer->arg = arg;
    thread_init(&signer->thread);
    pthread_cond_init(&signer->settled, NULL);
    if (!thread_start(&signer->thread, log, "signing of pictures", run, signer))
        picture_signer_destroy(&signer);
    return signer;
}

void picture_signer_destroy(struct picture_signer **signer_ptr)
{
    struct picture_signer *signer = *signer_ptr;
    if (!signer)
        return;
    thread_stop(&signer->thread);
    free_all(signer->waiting);
    free_all(signer->done);
    pthread_cond_destroy(&signer->settled);
    thread_finish(&signer->thread);
    mem_free(signer);
    *signer_ptr = NULL;
}

void picture_signer_ask(struct picture_signer *signer, struct encoded_frame *encoded, const struct picture_origin *origin, char **args)
{
    struct signing *signing = mem_new(sizeof(*signing));
    *signing = (struct signing){ .encoded = encoded, .origin = *origin };
    signing->origin.args = (const char *const *)args;
    pthread_mutex_lock(&signer->thread.lock);
    append(&signer->waiting, signing);
    pthread_cond_signal(&signer->thread.wake);
    pthread_mutex_unlock(&signer->thread.lock);
}

struct signing *picture_signer_collect(struct picture_signer *signer)
{
    pthread_mutex_lock(&signer->thread.lock);
    struct signing *done = signer->done;
    signer->done = NULL;
    pthread_mutex_unlock(&signer->thread.lock);
    return done;
}

void picture_signer_settle(struct picture_signer *signer)
{
    pthread_mutex_lock(&signer->thread.lock);
    free_all(signer->waiting);
    signer->waiting = NULL;
    while (signer->busy)
        pthread_cond_wait(&signer->settled, &signer->thread.lock);
    free_all(signer->done);
    signer->done = NULL;
    pthread_mutex_unlock(&signer->thread.lock);
}
