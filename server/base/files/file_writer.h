/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A thread that writes small files for the event loop, which must never wait for the disk. Jobs are written in order, and the
   loop receives the result of each. Call only in the event loop, except where a comment names another one. */
#ifndef BASE_FILES_FILE_WRITER_H
#define BASE_FILES_FILE_WRITER_H
#include <stdbool.h>

#include "base/files/settling.h"
#include "base/log/log.h"

/* A job of the file writer. Embed it as the first member of a struct with the job's data, and set `write`, `finish` and `owner`. */
struct file_job {
    int (*write)(struct file_job *job); /* writes the file; returns 0 or -errno. Called in the writer's thread */
    /* Ends the job on the event loop: if `error` is 0, puts the saved change into effect, else discards it; then frees the job.
       If `owner` is NULL (file_writer_forget()), only frees the job. */
    void (*finish)(struct file_job *job, int error);
    /* identifies the object whose changes the job saves. Such changes build on each other: if one job fails, later jobs of the
       same owner fail, too */
    const void *owner;
    uint64_t number;
    int error;
    struct file_job *next;
};

struct file_writer;
/* Starts the thread. After each job the thread calls notify(arg), which must make the event loop call file_writer_collect(). Returns NULL
   if the thread cannot start (logged). */
struct file_writer *file_writer_start(struct log *log, void (*notify)(void *arg), void *arg);
/* Writes all queued jobs, finishes them and ends the thread. Owners of jobs may still call file_writer_forget() afterwards.
   NULL is a no-op. */
void file_writer_stop(struct file_writer *writer);
/* Stops and frees the writer; free the owners of its jobs first. Accepts a pointer to NULL; sets *writer to NULL. */
void file_writer_destroy(struct file_writer **writer);
/* Queues a job. writer NULL: writes and finishes the job at once. Returns 0 or -errno; on error the job is already finished. */
int file_writer_queue(struct file_writer *writer, struct file_job *job);
/* Finishes all jobs that were written since the last call. Returns true if there were any. */
bool file_writer_collect(struct file_writer *writer);
/* Waits until all jobs are written, for at most timeout_ns. Returns true if no job is left to write. Any thread. */
bool file_writer_wait(struct file_writer *writer, int64_t timeout_ns);
/* Detaches the unfinished jobs of an owner that is about to be freed: their files are still written, but `finish` only frees the jobs. */
void file_writer_forget(struct file_writer *writer, const void *owner);
/* file_writer_begin(), file_writer_end() and file_writer_settled() tell whether the jobs queued between `begin` and `end` are
   on disk (base/files/settling.h). writer NULL: the jobs count as on disk. */
struct settling_ticket file_writer_begin(const struct file_writer *writer);
void file_writer_end(const struct file_writer *writer, struct settling_ticket *ticket);
int file_writer_settled(const struct file_writer *writer, const struct settling_ticket *ticket);

#endif
