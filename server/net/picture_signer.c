/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signs queued pictures on a thread of its own, which moves them from the list of unsigned pictures to the list of signed ones.
   The quota on unanswered picture requests keeps both lists short. */
#include "net/picture_signer.h"

#include "base/mem.h"
#include "base/thread.h"

struct picture_signer {
    struct thread thread;
    const struct signing_key *key;
    void (*notify)(void *arg);
    void *arg;
    pthread_cond_t settled;
    /* cached by the signing thread, which alone uses it: the last unsigned frame and its signed form, so that sessions of one
       view share one signature */
    struct packet *last, *last_signed;
    bool last_bare;
    /* --- below: protected by thread.lock */
    struct signing *waiting, *done;
    bool busy;
};

void signing_free(struct signing **signing_ptr)
{
    struct signing *signing = *signing_ptr;
    for (size_t i = 0; i < signing->origin.arg_count; i++)
        mem_free((char *)signing->origin.args[i]);
    mem_free((void *)signing->origin.args);
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

static struct packet *make_signed(const struct picture_signer *signer, const struct signing *signing)
{
    const struct packet *packet = signing->encoded->packet;
    size_t count;
    uint8_t *png = signed_picture_make(signer->key, &signing->origin, packet, &count);
    struct packet *made = png ? packet_create(packet->frame, WIRE_CODEC_PNG, true, png, count) : NULL;
    mem_free(png);
    if (made) {
        made->is_signed = true;
        made->encode_ns = packet->encode_ns;
    }
    return made;
}

static void forget_last(struct picture_signer *signer)
{
    packet_unref(&signer->last);
    packet_unref(&signer->last_signed);
}

static void sign(struct picture_signer *signer, struct signing *signing)
{
    struct packet **packet = &signing->encoded->packet;
    if (*packet != signer->last || signing->origin.bare != signer->last_bare) {
        forget_last(signer);
        signer->last = packet_ref(*packet);
        signer->last_bare = signing->origin.bare;
        signer->last_signed = make_signed(signer, signing);
    }
    signing->good = signer->last_signed != NULL;
    if (!signing->good)
        return;
    packet_unref(packet);
    *packet = packet_ref(signer->last_signed);
}

static void *picture_signer_main(void *arg)
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
    if (!thread_start(&signer->thread, log, "signing of pictures", picture_signer_main, signer))
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
    forget_last(signer);
    pthread_cond_destroy(&signer->settled);
    thread_finish(&signer->thread);
    mem_free(signer);
    *signer_ptr = NULL;
}

void picture_signer_ask(struct picture_signer *signer, struct encoded_frame *encoded, const struct picture_origin *origin)
{
    struct signing *signing = mem_new(sizeof(*signing));
    char **args = mem_array(origin->arg_count, sizeof(*args));
    for (size_t i = 0; i < origin->arg_count; i++)
        args[i] = mem_strdup(origin->args[i]);
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
    /* the cache of the last signed picture belongs to the signing thread, but may be freed here, because that thread is idle
       now */
    forget_last(signer);
    free_all(signer->done);
    signer->done = NULL;
    pthread_mutex_unlock(&signer->thread.lock);
}
