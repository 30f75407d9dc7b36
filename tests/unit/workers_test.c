/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pool of worker threads: every job runs once and in the order of submission; parallel loops cover their whole range, also
   when a job starts them. */
#include "base/workers.h"

#include "tests/support/test.h"
#include <stdatomic.h>

#include "base/mem.h"

enum { COUNT = 10007 };

static void count_one(void *arg)
{
    atomic_fetch_add((_Atomic int *)arg, 1);
}

TEST(destroy_runs_what_was_submitted)
{
    for (int threads = 1; threads <= 4; threads++) {
        _Atomic int done = 0;
        struct workers *workers = workers_create(threads);
        assert_int_equal(workers_count(workers), threads);
        for (int i = 0; i < 1000; i++)
            workers_submit(workers, count_one, &done);
        workers_destroy(&workers);
        assert_null(workers);
        assert_int_equal(done, 1000);
    }
}

struct ordered {
    int *order, *next, number;
};

static void note_order(void *arg)
{
    struct ordered *job = arg;
    job->order[(*job->next)++] = job->number; /* not protected by a lock: with one worker no two jobs run at the same time */
}

TEST(one_worker_keeps_the_order)
{
    int order[100], next = 0;
    struct ordered jobs[100];
    struct workers *workers = workers_create(1);
    for (int i = 0; i < 100; i++) {
        jobs[i] = (struct ordered){ order, &next, i };
        workers_submit(workers, note_order, &jobs[i]);
    }
    workers_destroy(&workers);
    for (int i = 0; i < 100; i++)
        assert_int_equal(order[i], i);
}

struct range {
    _Atomic int *visits;
    size_t grain;
    _Atomic int too_long;
};

static void visit(void *arg, size_t begin, size_t end)
{
    struct range *range = arg;
    if (end - begin > range->grain)
        atomic_fetch_add(&range->too_long, 1);
    for (size_t i = begin; i < end; i++)
        atomic_fetch_add(&range->visits[i], 1);
}

TEST(a_loop_covers_its_range_once)
{
    static const size_t counts[] = { 0, 1, 7, 64, COUNT }, grains[] = { 1, 3, 64, 100000 };
    static _Atomic int visits[COUNT];
    struct workers *workers = workers_create(3);
    for (size_t c = 0; c < 5; c++)
        for (size_t g = 0; g < 4; g++) {
            struct range range = { .visits = visits, .grain = grains[g] };
            memset((void *)visits, 0, sizeof(visits));
            workers_for(workers, counts[c], grains[g], visit, &range);
            for (size_t i = 0; i < COUNT; i++)
                assert_int_equal(visits[i], i < counts[c]);
            assert_int_equal(range.too_long, 0);
        }
    workers_destroy(&workers);
}

struct nested {
    struct workers *workers;
    struct range range;
};

static void loop_in_a_job(void *arg)
{
    struct nested *nested = arg;
    workers_for(nested->workers, COUNT, 16, visit, &nested->range);
}

/* Eight jobs on two threads each run a parallel loop, and so does this thread. Each loop must end, although no thread may be free
   to help it. */
TEST(loops_inside_of_jobs_end)
{
    struct nested jobs[8];
    _Atomic int *visits = mem_array(8 * COUNT, sizeof(*visits));
    struct workers *workers = workers_create(2);
    for (int i = 0; i < 8; i++) {
        jobs[i] = (struct nested){ workers, { .visits = visits + i * COUNT, .grain = 16 } };
        workers_submit(workers, loop_in_a_job, &jobs[i]);
    }
    struct range mine = { .visits = visits, .grain = 16 };
    workers_for(workers, 100, 16, visit, &mine);
    workers_destroy(&workers);
    for (int i = 0; i < 8 * COUNT; i++)
        assert_int_equal(visits[i], i < 100 ? 2 : 1);
    mem_free(visits);
}

struct waiter {
    struct workers *workers;
    _Atomic int *done, *wrong;
};

/* A job that starts tasks and waits for them. All workers run such jobs, so no worker is free for the tasks, which must be run
   by the waiting job itself. */
static void begin_and_end(void *arg)
{
    const struct waiter *waiter = arg;
    struct workers_task *tasks[3];
    for (int i = 0; i < 3; i++)
        tasks[i] = workers_begin(waiter->workers, count_one, waiter->done);
    for (int i = 0; i < 3; i++) {
        workers_end(&tasks[i]);
        if (tasks[i] || *waiter->done <= i)
            atomic_fetch_add(waiter->wrong, 1);
    }
}

TEST(a_task_is_done_when_it_has_ended)
{
    for (int threads = 0; threads <= 3; threads++) {
        struct workers *workers = threads ? workers_create(threads) : NULL;
        _Atomic int done[20] = { 0 }, wrong = 0;
        struct waiter waiters[20];
        for (int i = 0; i < 20; i++) {
            waiters[i] = (struct waiter){ workers, &done[i], &wrong };
            if (workers)
                workers_submit(workers, begin_and_end, &waiters[i]);
            else
                begin_and_end(&waiters[i]);
        }
        workers_destroy(&workers);
        assert_int_equal(wrong, 0);
        for (int i = 0; i < 20; i++)
            assert_int_equal(done[i], 3);
    }
    workers_end(&(struct workers_task *){ NULL });
}
