/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The historian at work: what the store was told lies on disk a second later, also after kill -9, and when the disk was full. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/clock.h"
#include "base/mem.h"
#include "history/historian.h"
#include "history/history.h"
#include "history/month.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/temp.h"
#include "value/quality.h"

enum { TAGS = 50 };

struct setup {
    char *folder;
    struct log *log;
    struct counters *counters;
    struct plant *plant;
    struct store *store;
    struct historian *historian;
    struct history_tag *tags;
};

static int set_up(void **state)
{
    static struct setup s;
    s.folder = temp_folder_create();
    s.log = log_create(LOG_ERROR);
    s.counters = counters_create();
    s.plant = plant_by_hand_create(TAGS);
    s.plant->history = (struct plant_history){ .override_s = 600 };
    plant_by_hand_source(s.plant, "plc", 502);
    for (int i = 0; i < TAGS; i++) {
        char name[16];
        snprintf(name, sizeof(name), "T-%d", i);
        plant_by_hand_tag(s.plant, name, TABLE_HOLDING, 2 * i, DATA_FLOAT32)->deadband = 0;
    }
    s.store = store_create(s.plant);
    s.tags = history_tags(s.plant);
    *state = &s;
    return 0;
}

static void start(struct setup *s)
{
    char *folder = temp_path(s->folder, "history");
    const struct historian_params params = {
        .log = s->log, .counters = s->counters, .plant = s->plant, .store = s->store, .folder = folder
    };
    s->historian = historian_start(&params);
    assert_non_null(s->historian);
    mem_free(folder);
}

static int tear_down(void **state)
{
    struct setup *s = *state;
    historian_stop(&s->historian);
    mem_free(s->tags);
    store_destroy(&s->store);
    plant_by_hand_destroy(&s->plant);
    counters_destroy(&s->counters);
    log_destroy(&s->log);
    temp_folder_destroy(&s->folder);
    return 0;
}

/* When they came. */
static int64_t write_all(struct setup *s, double value)
{
    int64_t utc_ns = clock_utc_ns();
    struct sample samples[TAGS];
    for (int i = 0; i < TAGS; i++)
        samples[i] = (struct sample){ i, value + i, QUALITY_GOOD };
    store_write(s->store, samples, TAGS, clock_mono_ns(), utc_ns);
    return utc_ns;
}

static double counted(struct setup *s, const char *name)
{
    struct text text = { 0 };
    counters_print(s->counters, &text);
    char *line = mem_printf("\n%s ", name);
    const char *found = strstr(text.at, line);
    double value = found ? strtod(found + strlen(line), NULL) : NAN;
    mem_free(line);
    text_finish(&text);
    return value;
}

static void look(struct setup *s, int64_t utc_ns, struct snapshot *into)
{
    char *folder = temp_path(s->folder, "history");
    struct history_reader *reader = history_reader_create(s->log, folder);
    assert_int_equal(history_at(reader, s->tags, utc_ns / 1000, into), 0);
    history_reader_destroy(&reader);
    mem_free(folder);
}

static size_t points_of(struct setup *s, int tag, struct history_series *series)
{
    char *folder = temp_path(s->folder, "history");
    struct history_reader *reader = history_reader_create(s->log, folder);
    int64_t now_us = clock_utc_ns() / 1000;
    assert_int_equal(history_series(reader, s->tags[tag].name, now_us - 600 * US_PER_S, now_us, 1000000, series), 0);
    history_reader_destroy(&reader);
    mem_free(folder);
    return series->points.count;
}

/* Values without a deadband: every one of them is there, exactly, with links lost and found between. */
static void all_that_was_told_is_there(void **state)
{
    struct setup *s = *state;
    int64_t times_ns[40], lost_ns = 0;
    struct snapshot *snapshot = snapshot_create(TAGS);
    start(s);
    for (int i = 0; i < 40; i++) {
        times_ns[i] = write_all(s, i * i % 17);
        if (i == 20) {
            lost_ns = clock_utc_ns();
            store_link_lost(s->store, 0, clock_mono_ns());
        }
        clock_sleep_ns(30 * NS_PER_MS);
    }
    historian_stop(&s->historian);
    for (int i = 0; i < 40; i++) {
        look(s, times_ns[i], snapshot);
        for (int tag = 0; tag < TAGS; tag++)
            assert_true(snapshot->readings[tag].value == i * i % 17 + tag);
    }
    look(s, lost_ns + 10 * NS_PER_MS, snapshot);
    assert_int_equal(snapshot->readings[3].quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    snapshot_destroy(&snapshot);
}

static void quiet_readers_see_the_last_second(void **state)
{
    struct setup *s = *state;
    struct snapshot *snapshot = snapshot_create(TAGS);
    start(s);
    write_all(s, 42);
    clock_sleep_ns(2200 * NS_PER_MS); /* two ticks */
    look(s, clock_utc_ns(), snapshot);
    assert_int_equal(snapshot->readings[7].quality, QUALITY_GOOD);
    assert_true(snapshot->readings[7].value == 49);
    snapshot_destroy(&snapshot);
}

/* Writes until it is killed; says in shared memory what the store was told last. */
static void record_for_ever(struct setup *s, _Atomic int64_t *told)
{
    start(s);
    for (int64_t i = 1;; i++) {
        write_all(s, (double)(i % 1000));
        atomic_store(told, clock_utc_ns());
        clock_sleep_ns(5 * NS_PER_MS);
    }
}

/* KILLS=100 for make test-long. */
static void a_kill_takes_at_most_a_second(void **state)
{
    struct setup *s = *state;
    int kills = getenv("KILLS") ? atoi(getenv("KILLS")) : 2;
    _Atomic int64_t *told = mmap(NULL, sizeof(*told), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_true(told != MAP_FAILED);
    srand(7);
    for (int k = 0; k < kills; k++) {
        atomic_store(told, 0);
        pid_t child = fork();
        if (child == 0)
            record_for_ever(s, told);
        while (atomic_load(told) == 0)
            clock_sleep_ns(10 * NS_PER_MS);
        clock_sleep_ns((2300 + rand() % 1000) * NS_PER_MS);
        int64_t killed_ns = atomic_load(told);
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
        struct history_series series;
        size_t count = points_of(s, 3, &series);
        assert_true(count > 0);
        double lost_s = (double)(killed_ns / 1000 - series.points.at[count - 1].t_us) / 1e6;
        printf("# killed: %.3f s lost, %zu points\n", lost_s, count);
        assert_true(lost_s < 2); /* a second, and the writing on a busy machine */
        history_series_finish(&series);
    }
    munmap((void *)told, sizeof(*told));
}

/* The kernel itself refuses: no file may grow beyond what it has. Then it may again, and nothing is missing. */
static void a_full_disk_loses_nothing(void **state)
{
    struct setup *s = *state;
    struct rlimit unlimited;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    start(s);
    write_all(s, 1);
    clock_sleep_ns(1500 * NS_PER_MS);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){ 200000, unlimited.rlim_max }), 0);
    for (int i = 0; i < 200; i++) {
        write_all(s, i * i * 7919 % 1009);
        clock_sleep_ns(10 * NS_PER_MS);
    }
    bool was_good = counted(s, "plantcast_history_good") == 1;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    historian_stop(&s->historian);
    assert_false(was_good);
    assert_true(counted(s, "plantcast_history_lost_total") == 0);
    struct history_series series;
    size_t count = points_of(s, 0, &series);
    printf("# %zu points\n", count);
    assert_true(count > 195);
    history_series_finish(&series);
}

/* As where a folder is read-only for its owner: something else stands in its place. */
static void a_folder_that_comes_later_is_used(void **state)
{
    struct setup *s = *state;
    char *path = temp_write_text(s->folder, "history", "not a folder");
    start(s);
    write_all(s, 5);
    clock_sleep_ns(1300 * NS_PER_MS);
    assert_true(counted(s, "plantcast_history_good") == 0);
    assert_int_equal(unlink(path), 0);
    historian_stop(&s->historian);
    struct history_series series;
    assert_true(points_of(s, 0, &series) > 0);
    assert_true(series.points.at[0].value == 5);
    history_series_finish(&series);
    mem_free(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(all_that_was_told_is_there, set_up, tear_down),
        cmocka_unit_test_setup_teardown(quiet_readers_see_the_last_second, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_kill_takes_at_most_a_second, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_full_disk_loses_nothing, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_folder_that_comes_later_is_used, set_up, tear_down),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
