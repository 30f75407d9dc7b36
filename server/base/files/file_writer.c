/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queue of jobs for the writer thread, and the results of the newest jobs. */
#include "base/files/file_writer.h"

#include <errno.h>

#include "base/mem.h"
#include "base/thread.h"

/* MAX_QUEUED: maximum number of queued jobs, reached only if the disk hangs. RESULTS: number of newest jobs whose results are
   stored. That is enough, because callers ask for a job's result (settling_ticket) for at most a second. */
enum { MAX_QUEUED = 64, RESULTS = 1024 };

struct file_writer {
    struct thread thread;
    void (*notify)(void *arg);
    void *arg;
    /* --- protected by thread.lock */
    struct file_job *queued, *running, *done;
    int queued_count;
    /* --- below: members that only the event loop uses */
    uint64_t count; /* number of the newest job */
    /* results of the newest jobs, indexed by job number modulo RESULTS: 0, -errno, or -EINPROGRESS while the job is unfinished */
    int results[RESULTS];
};

static void append(struct file_job **list, struct file_job *job)
{
    while (*list)
        list = &(*list)->next;
    job->next = NULL;
    *list = job;
}

/* Moves a written job to the list `done`. If it failed, queued jobs of the same owner fail with the same error. The caller
   holds the lock. */
static void put_done(struct file_writer *writer, struct file_job *job, int error)
{
    job->error = error;
    append(&writer->done, job);
    if (!error || !job->owner)
        return;
    for (struct file_job **at = &writer->queued, *next; (next = *at);)
        if (next->owner == job->owner) {
            *at = next->next;
            writer->queued_count--;
            next->error = error;
            append(&writer->done, next);
        } else {
            at = &next->next;
        }
}

static void *file_writer_main(void *arg)
{
    struct file_writer *writer = arg;
    struct thread *thread = &writer->thread;
    pthread_mutex_lock(&thread->lock);
    for (;;) {
        while (!writer->queued && !thread->stopping)
            pthread_cond_wait(&thread->wake, &thread->lock);
        struct file_job *job = writer->running = writer->queued;
        if (!job)
            break;
        writer->queued = job->next;
        writer->queued_count--;
        pthread_mutex_unlock(&thread->lock);
        int error = job->write(job);
        pthread_mutex_lock(&thread->lock);
        writer->running = NULL;
        put_done(writer, job, error);
        pthread_cond_broadcast(&thread->wake);
        pthread_mutex_unlock(&thread->lock);
        writer->notify(writer->arg);
        pthread_mutex_lock(&thread->lock);
    }
    pthread_mutex_unlock(&thread->lock);
    return NULL;
}

struct file_writer *file_writer_start(struct log *log, void (*notify)(void *arg), void *arg)
{
    struct file_writer *writer = mem_new(sizeof(*writer));
    thread_init(&writer->thread);
    writer->notify = notify;
    writer->arg = arg;
    if (!thread_start(&writer->thread, log, "file writer", file_writer_main, writer))
        file_writer_destroy(&writer);
    return writer;
}

void file_writer_stop(struct file_writer *writer)
{
    if (!writer)
        return;
    thread_stop(&writer->thread);
    file_writer_collect(writer);
}

void file_writer_destroy(struct file_writer **pointer)
{
    struct file_writer *writer = *pointer;
    if (!writer)
        return;
    file_writer_stop(writer);
    thread_finish(&writer->thread);
    mem_free(writer);
    *pointer = NULL;
}

/* Returns the error of a failed job of that owner that the event loop has not collected yet; 0: there is none. */
static int failed_before(const struct file_writer *writer, const void *owner)
{
    int error = 0;
    for (const struct file_job *job = writer->done; job && !error; job = job->next)
        error = job->owner == owner ? job->error : 0;
    return error;
}

int file_writer_queue(struct file_writer *writer, struct file_job *job)
{
    int error;
    if (!writer) {
        error = job->write(job);
        job->finish(job, error);
        return error;
    }
    pthread_mutex_lock(&writer->thread.lock);
    error = failed_before(writer, job->owner);
    if (!error && writer->queued_count == MAX_QUEUED)
        error = -ETIMEDOUT; /* the queue of jobs is full because the disk hangs */
    if (!error) {
        job->number = ++writer->count;
        writer->results[job->number % RESULTS] = -EINPROGRESS;
        append(&writer->queued, job);
        writer->queued_count++;
        pthread_cond_broadcast(&writer->thread.wake);
    }
    pthread_mutex_unlock(&writer->thread.lock);
    if (error)
        job->finish(job, error);
    return error;
}

bool file_writer_collect(struct file_writer *writer)
{
    pthread_mutex_lock(&writer->thread.lock);
    struct file_job *job = writer->done;
    writer->done = NULL;
    pthread_mutex_unlock(&writer->thread.lock);
    bool any = job;
    for (struct file_job *next; job; job = next) {
        next = job->next;
        writer->results[job->number % RESULTS] = job->error;
        job->finish(job, job->error);
    }
    return any;
}

bool file_writer_wait(struct file_writer *writer, int64_t timeout_ns)
{
    int64_t until_ns = clock_mono_ns() + timeout_ns;
    pthread_mutex_lock(&writer->thread.lock);
    while ((writer->queued || writer->running) && clock_cond_wait(&writer->thread.wake, &writer->thread.lock, until_ns))
        continue;
    bool idle = !writer->queued && !writer->running;
    pthread_mutex_unlock(&writer->thread.lock);
    return idle;
}

static void forget_in(struct file_job *job, const void *owner)
{
    for (; job; job = job->next)
        if (job->owner == owner)
            job->owner = NULL;
}

void file_writer_forget(struct file_writer *writer, const void *owner)
{
    if (!writer)
        return;
    pthread_mutex_lock(&writer->thread.lock);
    forget_in(writer->queued, owner);
    forget_in(writer->done, owner);
    if (writer->running && writer->running->owner == owner)
        writer->running->owner = NULL;
    pthread_mutex_unlock(&writer->thread.lock);
}

struct settling_ticket file_writer_begin(const struct file_writer *writer)
{
    return (struct settling_ticket){ .first = writer ? writer->count : 0 };
}

void file_writer_end(const struct file_writer *writer, struct settling_ticket *ticket)
{
    ticket->last = writer ? writer->count : 0;
    ticket->until_ns = clock_mono_ns() + NS_PER_S;
}

int file_writer_settled(const struct file_writer *writer, const struct settling_ticket *ticket)
{
    int state = 0;
    for (uint64_t number = ticket->first + 1; writer && number <= ticket->last && !state; number++)
        state = writer->results[number % RESULTS];
    return state == -EINPROGRESS && clock_mono_ns() >= ticket->until_ns ? -ETIMEDOUT : state;
}
