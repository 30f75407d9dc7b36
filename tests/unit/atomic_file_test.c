/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Atomic replacement of files: readers see the old or the new content, a failure leaves nothing behind, and the new content is
   never written through existing files or links. */
#include "base/files/atomic_file.h"

#include "tests/support/test.h"
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/file_writer.h"
#include "base/text/text.h"

struct atomic_file_fixture {
    char *folder, *path;
};

static void begin(struct atomic_file_fixture *f)
{
    f->folder = temp_folder();
    f->path = temp_write_text(f->folder, "f", "old");
}

TEST_FIXTURE(struct atomic_file_fixture, begin, NULL)

#define CASE(name) TEST_ON(struct atomic_file_fixture *f, name, set_up, tear_down)

static void assert_text(const char *path, const char *want)
{
    size_t bytes;
    char *text = test_memory(text_read_file(path, 100, &bytes));
    assert_string_equal(text, want);
}

static void assert_nothing_beside(const struct atomic_file_fixture *f)
{
    char *look = test_printf("test -z \"$(ls '%s' | grep new)\"", f->folder);
    assert_int_equal(system(look), 0);
}

CASE(the_old_file_stays_until_the_new_one_is_whole)
{
    struct atomic_file file;
    for (int durable = 0; durable < 2; durable++) {
        assert_int_equal(atomic_file_begin(&file, f->path, 0600), 0);
        assert_int_equal(atomic_file_write(&file, "n", 1), 0);
        assert_int_equal(atomic_file_write(&file, "ew", 2), 0);
        assert_text(f->path, durable ? "new" : "old");
        assert_int_equal(atomic_file_commit(&file, durable), 0);
        atomic_file_abandon(&file); /* does nothing any more */
        assert_text(f->path, "new");
    }
    struct stat st;
    assert_int_equal(stat(f->path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0600);
    assert_nothing_beside(f);
}

CASE(one_that_is_given_up_leaves_nothing)
{
    struct atomic_file file;
    assert_int_equal(atomic_file_begin(&file, f->path, 0600), 0);
    assert_int_equal(atomic_file_write(&file, "x", 1), 0);
    atomic_file_abandon(&file);
    assert_text(f->path, "old");
    assert_nothing_beside(f);
}

/* An attacker has put a symlink at the path of the temporary file. It leads to a file that only this program may write, which
   must stay unchanged. */
CASE(links_and_files_beside_are_not_written_through)
{
    char *secret = temp_write_text(f->folder, "secret", "secret"), *link = test_printf("%s.%ld.new", f->path, (long)getpid());
    assert_int_equal(symlink(secret, link), 0);
    assert_int_equal(atomic_file_put(f->path, "new", 3), 0);
    assert_text(f->path, "new");
    assert_text(secret, "secret");
    struct stat st;
    assert_int_equal(lstat(f->path, &st), 0);
    assert_true(S_ISREG(st.st_mode));
    assert_int_equal(unlink(link), 0);
    assert_nothing_beside(f);
}

/* --- file_writer.c: a thread that replaces files atomically, so that the event loop does not wait for the disk ------------------------ */

struct held_job {
    struct file_job job;   /* first member */
    pthread_mutex_t *gate; /* lock that the test holds to keep the writer thread from writing this file; NULL: the thread does not wait */
    /* error: result to be returned by the write, 0 or -errno; *finished receives the result, and is ENOENT before */
    int error, *finished;
};

static int write_held(struct file_job *job)
{
    struct held_job *own = (struct held_job *)job;
    if (own->gate) {
        pthread_mutex_lock(own->gate);
        pthread_mutex_unlock(own->gate);
    }
    return own->error;
}

static void finish_held(struct file_job *job, int error)
{
    struct held_job *own = (struct held_job *)job;
    *own->finished = job->owner ? error : -ECANCELED;
    mem_free(own);
}

static int queue_held(struct file_writer *writer, const void *owner, pthread_mutex_t *gate, int error, int *finished)
{
    struct held_job *own = mem_new(sizeof(*own));
    *own = (struct held_job){ { .write = write_held, .finish = finish_held, .owner = owner }, gate, error, finished };
    *finished = ENOENT;
    return file_writer_queue(writer, &own->job);
}

static void on_written(void *arg)
{
    atomic_fetch_add((atomic_int *)arg, 1);
}

TEST(a_failed_write_fails_those_that_build_on_it)
{
    struct log *log = test_log();
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    atomic_int written = 0;
    struct file_writer *writer = file_writer_start(log, on_written, &written);
    int one, two, other, late, owner_a = 0, owner_b = 0;
    pthread_mutex_lock(&gate);
    struct settling_ticket first = file_writer_begin(writer), second, none = first;
    assert_int_equal(queue_held(writer, &owner_a, &gate, -ENOSPC, &one), 0);
    file_writer_end(writer, &first);
    second = file_writer_begin(writer);
    assert_int_equal(queue_held(writer, &owner_a, NULL, 0, &two), 0);
    file_writer_end(writer, &second);
    assert_int_equal(queue_held(writer, &owner_b, NULL, 0, &other), 0);
    assert_int_equal(file_writer_settled(writer, &first), -EINPROGRESS);
    assert_false(file_writer_wait(writer, NS_PER_MS));
    first.until_ns = 0; /* a second later */
    assert_int_equal(file_writer_settled(writer, &first), -ETIMEDOUT);
    pthread_mutex_unlock(&gate);
    assert_true(file_writer_wait(writer, 60 * NS_PER_S));
    /* still ENOENT: the thread has finished the job, but results are delivered only by file_writer_collect() */
    assert_int_equal(one, ENOENT);
    assert_int_equal(queue_held(writer, &owner_a, NULL, 0, &late), -ENOSPC); /* builds on what failed */
    assert_int_equal(late, -ENOSPC);
    assert_true(file_writer_collect(writer));
    assert_false(file_writer_collect(writer));
    assert_int_equal(one, -ENOSPC);
    assert_int_equal(two, -ENOSPC);
    assert_int_equal(other, 0);
    assert_int_equal(file_writer_settled(writer, &first), -ENOSPC);
    assert_int_equal(file_writer_settled(writer, &second), -ENOSPC);
    assert_int_equal(file_writer_settled(writer, &none), 0);
    /* after the failure was collected, the next job is accepted, because it starts from the content on disk */
    assert_int_equal(queue_held(writer, &owner_a, NULL, 0, &late), 0);
    file_writer_destroy(&writer);
    assert_int_equal(late, 0);
    /* three of the jobs were written; the one that was queued after the failed job for the same file was not */
    assert_int_equal(atomic_load(&written), 3);
}

TEST(a_disk_that_hangs_fills_the_queue_and_owners_may_leave)
{
    struct log *log = test_log();
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    atomic_int written = 0;
    struct file_writer *writer = file_writer_start(log, on_written, &written);
    int results[200], owner = 0, leaver = 0, left, count = 0;
    pthread_mutex_lock(&gate);
    assert_int_equal(queue_held(writer, &leaver, &gate, 0, &left), 0);
    while (count < 200 && queue_held(writer, &owner, NULL, 0, &results[count]) == 0)
        count++;
    assert_in_range(count, 63, 64);
    assert_int_equal(results[count], -ETIMEDOUT); /* the queue is full, so this job was refused at once; the earlier jobs still wait */
    assert_int_equal(results[count - 1], ENOENT);
    file_writer_forget(writer, &leaver);
    pthread_mutex_unlock(&gate);
    file_writer_destroy(&writer);
    assert_int_equal(left, -ECANCELED);
    for (int i = 0; i < count; i++)
        assert_int_equal(results[i], 0);
}
