/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The historian, which records samples: they are on disk one second after they reach the store. This must hold after kill -9,
   with a full, read-only, slow or damaged disk, and when the clock is set. */
#include "tests/support/test.h"
#include <fcntl.h>
#include <glob.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <sqlite3.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "base/text/text.h"
#include "corelink/core_samples.h"
#include "history/historian.h"
#include "history/history.h"
#include "history/month.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

enum { TAGS = 50 };

/* Begin of this test's own clock, which replaces the historian's UTC clock and can be set by tests; the machine's clock stays
   unchanged. It is mid-month, because each month has its own file and most tests look into one file only. */
static const int64_t MID_MONTH_S = 1781524800; /* 2026-06-15T12:00Z */
static _Atomic int64_t clock_off_ns;
int64_t __real_clock_utc_ns(void);
int64_t __wrap_clock_utc_ns(void);
int64_t __wrap_clock_utc_ns(void)
{
    return __real_clock_utc_ns() + atomic_load(&clock_off_ns);
}

struct historian_setup {
    char *folder;
    struct log *log;
    struct counters *counters;
    struct plant *plant;
    struct store *store;
    struct historian *historian;
    struct history_tag *tags;
};

static void begin(struct historian_setup *s)
{
    atomic_store(&clock_off_ns, MID_MONTH_S * NS_PER_S - __real_clock_utc_ns());
    s->folder = temp_folder();
    s->log = test_log();
    s->counters = test_counters();
    s->plant = plant_by_hand_create(TAGS);
    s->plant->history = (struct plant_history){ .override_s = 600 };
    plant_by_hand_source(s->plant, "plc", 502);
    for (int i = 0; i < TAGS; i++)
        plant_by_hand_tag(s->plant, test_printf("T-%02d", i), TABLE_HOLDING, 2 * i, DATA_FLOAT32)->deadband = 0;
    s->store = test_store(s->plant);
    s->tags = history_tags(s->plant);
}

static void start_with_limit(struct historian_setup *s, size_t max_waiting)
{
    char *folder = temp_path(s->folder, "history");
    const struct historian_params params = {
        .log = s->log, .counters = s->counters, .plant = s->plant, .store = s->store, .folder = folder, .max_waiting = max_waiting
    };
    s->historian = historian_start(&params);
    assert_non_null(s->historian);
}

static void start(struct historian_setup *s)
{
    start_with_limit(s, 0);
}

static void end(struct historian_setup *s)
{
    historian_stop(&s->historian);
    mem_free(s->tags);
    /* unmounts the disk of a test that mounted one and failed before it could unmount it */
    char *disk = temp_path(s->folder, "history");
    (void)umount2(disk, MNT_DETACH);
}

TEST_FIXTURE(struct historian_setup, begin, end)

#define CASE(name) TEST_ON(struct historian_setup *s, name, set_up, tear_down)

/* Returns the i-th value of a series of which no three values lie on a line, because history stores no points inside straight
   lines. */
static double bent(int i)
{
    return i * i * 7919 % 1009;
}

/* Writes a sample of each tag; the value of tag i is `value` plus i. Returns the UTC time of the samples. */
static int64_t write_all(struct historian_setup *s, double value)
{
    int64_t utc_ns = clock_utc_ns();
    struct sample samples[TAGS];
    for (int i = 0; i < TAGS; i++)
        samples[i] = (struct sample){ i, value + i, QUALITY_GOOD };
    store_write(s->store, samples, TAGS, clock_mono_ns(), utc_ns);
    return utc_ns;
}

static double counted(struct historian_setup *s, const char *name)
{
    struct text *text = test_text();
    counters_print(s->counters, text);
    char *line = test_printf("\n%s ", name);
    const char *found = strstr(text->at, line);
    double value = found ? strtod(found + strlen(line), NULL) : NAN;
    return value;
}

static void look(struct historian_setup *s, int64_t utc_ns, struct snapshot *into)
{
    char *folder = temp_path(s->folder, "history");
    struct history_reader *reader = history_reader_create(s->log, folder);
    assert_int_equal(history_at(reader, s->tags, utc_ns / 1000, into), 0);
    history_reader_destroy(&reader);
}

static size_t points_around(struct historian_setup *s, int tag, int64_t around_us, struct history_series *series)
{
    char *folder = temp_path(s->folder, "history");
    struct history_reader *reader = history_reader_create(s->log, folder);
    int64_t from_us = around_us - 7200 * US_PER_S, to_us = around_us + 7200 * US_PER_S;
    assert_int_equal(history_series(reader, s->tags[tag].name, from_us, to_us, 1000000, series), 0);
    test_series(series);
    history_reader_destroy(&reader);
    return series->points.count;
}

static size_t points_of(struct historian_setup *s, int tag, struct history_series *series)
{
    return points_around(s, tag, clock_utc_ns() / 1000, series);
}

/* Returns how many events of this kind are in the file of the month to which utc_ns belongs. */
static int events_of(struct historian_setup *s, const char *kind, int64_t utc_ns)
{
    char name[MONTH_NAME_BYTES], *query = test_printf("SELECT count(*) FROM event WHERE kind = '%s'", kind);
    month_name(month_of(utc_ns / 1000), name);
    char *path = test_printf("%s/history/%s", s->folder, name);
    sqlite3 *db;
    sqlite3_stmt *statement;
    assert_int_equal(sqlite3_open_v2(path, &db, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, query, -1, &statement, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(statement), SQLITE_ROW);
    int count = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    sqlite3_close(db);
    return count;
}

static void wait_until_counted(struct historian_setup *s, const char *name, double wanted)
{
    int64_t end_ns = clock_mono_ns() + 30 * NS_PER_S;
    while (counted(s, name) != wanted && clock_mono_ns() < end_ns)
        sleep_ns(20 * NS_PER_MS);
    assert_true(counted(s, name) == wanted);
}

/* Tags have no deadband, so every value must be recorded exactly. Between the values, the connection is lost several times. */
CASE(all_that_was_told_is_there)
{
    int64_t times_ns[40], lost_ns = 0;
    struct snapshot *snapshot = test_snapshot(TAGS);
    start(s);
    for (int i = 0; i < 40; i++) {
        times_ns[i] = write_all(s, i * i % 17);
        if (i == 20) {
            lost_ns = clock_utc_ns();
            store_link_lost(s->store, 0, clock_mono_ns());
        }
        sleep_ns(30 * NS_PER_MS);
    }
    historian_stop(&s->historian);
    for (int i = 0; i < 40; i++) {
        look(s, times_ns[i], snapshot);
        for (int tag = 0; tag < TAGS; tag++)
            assert_true(snapshot->readings[tag].value == i * i % 17 + tag);
    }
    look(s, lost_ns + 10 * NS_PER_MS, snapshot);
    assert_int_equal(snapshot->readings[3].quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
}

/* Passes samples from a leading core to the historian of its standby, in messages as between two cores. */
static void pass_on(struct core_samples *link, struct historian *standby)
{
    struct text *bytes = test_text();
    struct sample_event *samples;
    size_t count;
    while (core_samples_write(link, bytes) > 0) {
        assert_null(core_samples_read(&samples, &count, TAGS, bytes->at, bytes->length, clock_mono_ns()));
        historian_mirror(standby, samples, count);
        mem_free(samples);
        bytes->length = 0;
    }
}

static void read_series(struct historian_setup *s, const char *name, int tag, struct history_series *series)
{
    int64_t now_us = clock_utc_ns() / 1000;
    char *folder = temp_path(s->folder, name);
    struct history_reader *reader = history_reader_create(s->log, folder);
    int error = history_series(reader, s->tags[tag].name, now_us - 7200 * US_PER_S, now_us + 7200 * US_PER_S, 10000, series);
    assert_int_equal(error, 0);
    test_series(series);
    history_reader_destroy(&reader);
}

static bool has_quality(const struct history_series *series, uint32_t quality)
{
    for (size_t i = 0; i < series->points.count; i++)
        if (series->points.at[i].quality == quality)
            return true;
    return false;
}

/* The historian of a standby gets only samples. It must nevertheless record that readings become stale and that a device was
   lost which never sent a sample, exactly as the leader's historian does. */
CASE(a_standby_records_what_time_alone_changes)
{
    struct history_series here, there;
    char *folder = temp_path(s->folder, "standby");
    for (int i = 0; i < TAGS; i++)
        s->plant->tags[i].validity.stale_s = i < TAGS / 2 ? 0.5 : 3600;
    s->store = test_store(s->plant);
    struct store *mirror = test_store(s->plant);
    struct historian *standby = historian_start(&(struct historian_params){
        .log = s->log, .counters = s->counters, .plant = s->plant, .store = mirror, .folder = folder, .stands_by = true });
    struct core_samples *link = core_samples_listen(s->store);
    /* this source has never sent a sample, so the store reports its loss without a time of a last sample */
    store_link_lost(s->store, 0, clock_mono_ns());
    start(s);
    do {
        sleep_ns(50 * NS_PER_MS);
        read_series(s, "history", TAGS - 1, &here);
    } while (!has_quality(&here, QUALITY_BAD_NO_COMMUNICATION));
    int64_t before_us = write_all(s, 7) / 1000, after_us = clock_utc_ns() / 1000;
    do {
        sleep_ns(50 * NS_PER_MS);
        read_series(s, "history", 0, &here);
    } while (!has_quality(&here, QUALITY_BAD_COMMUNICATION_ERROR));
    historian_stop(&s->historian);
    pass_on(link, standby);
    historian_stop(&standby);
    for (int i = 0; i < TAGS; i++) {
        read_series(s, "history", i, &here);
        read_series(s, "standby", i, &there);
        assert_true(here.points.count >= 2);
        assert_int_equal(here.points.count, there.points.count);
        /* The last point must have the time at which the reading became stale, not the time at which the historian noticed. 25
           ms are allowed for the difference of monotonic and UTC clock. */
        int64_t stale_us = here.points.at[here.points.count - 1].t_us - 500000;
        assert_true(i >= TAGS / 2 || (stale_us >= before_us - 25000 && stale_us <= after_us + 25000));
        for (size_t k = 0; k < here.points.count; k++) {
            assert_int_equal(here.points.at[k].t_us, there.points.at[k].t_us);
            assert_int_equal(here.points.at[k].quality, there.points.at[k].quality);
        }
    }
    core_samples_end(&link);
}

/* Writes a Good sample of one tag. */
static void write_one(struct historian_setup *s, int tag, double value)
{
    store_write(s->store, &(struct sample){ tag, value, QUALITY_GOOD }, 1, clock_mono_ns(), clock_utc_ns());
}

/* Writes a sample of a tag that its source dates utc_ns, a time in the past. */
static void write_old(struct historian_setup *s, int tag, double value, int64_t utc_ns)
{
    int64_t age_ns = clock_utc_ns() - utc_ns;
    store_write(s->store, &(struct sample){ tag, value, QUALITY_GOOD }, 1, clock_mono_ns() - age_ns, utc_ns);
}

/* Sets the tags so that their readings never become stale, as with OPC UA, whose servers send only changes. */
static void never_stale(struct historian_setup *s)
{
    for (int i = 0; i < TAGS; i++)
        s->plant->tags[i].validity.stale_s = PLANT_NEVER_STALE_S;
    s->store = test_store(s->plant); /* a store takes over the tags' stale times when it is created */
    mem_free(s->tags);
    s->tags = history_tags(s->plant);
}

/* Waits until the newest recorded reading of a tag has this quality. Returns false if it has not after 30 s. */
static bool tag_comes_to(struct historian_setup *s, int tag, uint32_t quality)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    int64_t end_ns = clock_mono_ns() + 30 * NS_PER_S;
    do {
        sleep_ns(50 * NS_PER_MS);
        look(s, clock_utc_ns(), snapshot);
    } while (snapshot->readings[tag].quality != quality && clock_mono_ns() < end_ns);
    return snapshot->readings[tag].quality == quality;
}

static bool comes_to(struct historian_setup *s, uint32_t quality)
{
    return tag_comes_to(s, 0, quality);
}

/* An OPC UA server dates a value by its last change. After a lost connection or a restart of the daemon it sends the same value
   again, dated before the loss. The value must then be recorded as Good again. */
CASE(a_value_with_an_old_time_is_good_again)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    int64_t changed_ns = clock_utc_ns() - 3600 * NS_PER_S;
    never_stale(s);
    start(s);
    write_old(s, 0, 42, changed_ns);
    assert_true(comes_to(s, QUALITY_GOOD));
    store_tags_dead(s->store, &(int){ 0 }, 1, clock_mono_ns());
    assert_true(comes_to(s, QUALITY_BAD_COMMUNICATION_ERROR));
    /* the historian dates a change of quality by the beginning of its tick, which may be earlier on a busy machine: looks half a second
       before the change */
    sleep_ns(1200 * NS_PER_MS);
    int64_t lost_ns = clock_utc_ns();
    write_old(s, 0, 42, changed_ns);
    assert_true(comes_to(s, QUALITY_GOOD));
    look(s, lost_ns - NS_PER_S / 2, snapshot);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_BAD_COMMUNICATION_ERROR);
    historian_stop(&s->historian);
    int64_t ended_ns = clock_utc_ns();
    atomic_fetch_add(&clock_off_ns, 600 * NS_PER_S);
    s->store = test_store(s->plant);
    start(s);
    write_old(s, 0, 42, changed_ns);
    /* the value is recorded together with the end of the previous run's lines */
    int64_t end_ns = clock_mono_ns() + 30 * NS_PER_S;
    do {
        sleep_ns(50 * NS_PER_MS);
        look(s, ended_ns + 300 * NS_PER_S, snapshot);
    } while (snapshot->readings[0].quality != QUALITY_BAD_NO_COMMUNICATION && clock_mono_ns() < end_ns);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_BAD_NO_COMMUNICATION);
    assert_true(comes_to(s, QUALITY_GOOD));
    look(s, clock_utc_ns(), snapshot);
    assert_true(snapshot->readings[0].value == 42);
}

static const int64_t MONTH_NS = 31 * 86400 * NS_PER_S;

/* Tag 0 gets one sample. Then a source sends a value of tag 1 that it dates a month ago, and the process is killed. After the next
   start, the value of tag 0 must end when the process was killed. */
CASE(a_value_of_last_month_leaves_other_lines_alone)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    never_stale(s);
    pid_t child = fork();
    if (child == 0) {
        start(s);
        write_one(s, 0, 42);
        bool good = tag_comes_to(s, 0, QUALITY_GOOD);
        write_old(s, 1, 7, clock_utc_ns() - MONTH_NS);
        good = good && tag_comes_to(s, 1, QUALITY_GOOD);
        write_one(s, 2, 1);
        _exit(good && tag_comes_to(s, 2, QUALITY_GOOD) ? 0 : 1);
    }
    int status;
    waitpid(child, &status, 0);
    assert_int_equal(status, 0);
    int64_t killed_ns = clock_utc_ns();
    atomic_fetch_add(&clock_off_ns, 600 * NS_PER_S);
    start(s);
    write_one(s, 2, 0);
    wait_until_counted(s, "plantcast_history_good", 1);
    historian_stop(&s->historian);
    for (int tag = 0; tag < 2; tag++) {
        look(s, killed_ns + 300 * NS_PER_S, snapshot);
        assert_int_equal(snapshot->readings[tag].quality, QUALITY_BAD_NO_COMMUNICATION);
    }
    look(s, killed_ns - MONTH_NS + 600 * NS_PER_S, snapshot);
    assert_int_equal(snapshot->readings[1].quality, QUALITY_GOOD);
    assert_true(snapshot->readings[1].value == 7);
}

/* A source whose clock is a month behind sends values of tag 1 all the time. The historian must not take this for a change of
   month, at which it records a point of each tag: the constant values of tag 0 need two. */
CASE(a_clock_of_last_month_adds_no_points_of_other_tags)
{
    struct history_series series;
    never_stale(s);
    start(s);
    for (int i = 0; i < 40; i++) {
        write_one(s, 0, 42);
        write_old(s, 1, bent(i), clock_utc_ns() - MONTH_NS);
        sleep_ns(100 * NS_PER_MS);
    }
    historian_stop(&s->historian);
    assert_in_range(points_of(s, 0, &series), 1, 2);
    assert_true(points_around(s, 1, (clock_utc_ns() - MONTH_NS) / 1000, &series) >= 40);
}

/* After its first sample, tag 0 gets none, and neither does tag 2, whose value is Uncertain, while tag 1 gets samples all the
   time. The histories of tags 0 and 2 must continue until the daemon ends, also into the file of the next month. */
CASE(a_value_without_samples_holds_until_the_end)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    int64_t july_ns = month_begin_us(month_of(clock_utc_ns() / 1000) + 1) * 1000;
    never_stale(s);
    atomic_fetch_add(&clock_off_ns, july_ns - 3 * NS_PER_S - clock_utc_ns());
    start(s);
    write_old(s, 0, 42, july_ns - 20 * NS_PER_S);
    store_write(s->store, &(struct sample){ 2, 17, QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE }, 1, clock_mono_ns(), clock_utc_ns());
    int64_t last_ns = 0;
    for (int i = 0; last_ns < july_ns + 2 * NS_PER_S; i++) {
        sleep_ns(100 * NS_PER_MS);
        last_ns = clock_utc_ns();
        store_write(s->store, &(struct sample){ 1, bent(i), QUALITY_GOOD }, 1, clock_mono_ns(), last_ns);
    }
    historian_stop(&s->historian);
    atomic_fetch_add(&clock_off_ns, 600 * NS_PER_S);
    s->store = test_store(s->plant);
    start(s);
    write_one(s, 1, 0);
    wait_until_counted(s, "plantcast_history_good", 1);
    historian_stop(&s->historian);
    look(s, last_ns, snapshot);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_GOOD);
    assert_true(snapshot->readings[0].value == 42);
    look(s, last_ns + 300 * NS_PER_S, snapshot);
    for (int tag = 0; tag < 3; tag++)
        assert_int_equal(snapshot->readings[tag].quality, QUALITY_BAD_NO_COMMUNICATION);
    assert_int_equal(unlink(temp_path(s->folder, "history/history-2026-06.sqlite")), 0);
    look(s, last_ns, snapshot);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_GOOD);
    assert_int_equal(snapshot->readings[2].quality, QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE);
    assert_true(snapshot->readings[2].value == 17);
}

CASE(quiet_readers_see_the_last_second)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    start(s);
    write_all(s, 42);
    assert_true(comes_to(s, QUALITY_GOOD));
    look(s, clock_utc_ns(), snapshot);
    assert_int_equal(snapshot->readings[7].quality, QUALITY_GOOD);
    assert_true(snapshot->readings[7].value == 49);
}

/* Records samples until this process is killed. *told, which is shared memory, receives the time of the last sample that was
   given to the store. */
static void record_for_ever(struct historian_setup *s, _Atomic int64_t *told)
{
    start(s);
    for (int64_t i = 1;; i++) {
        write_all(s, (double)(i % 1000));
        atomic_store(told, clock_utc_ns());
        sleep_ns(5 * NS_PER_MS);
    }
}

/* Starts a process that records, and kills it at a random time. Returns the seconds between the last sample given to the store
   and the last one on disk. */
static double kill_one(struct historian_setup *s, _Atomic int64_t *told, unsigned *seed)
{
    struct history_series series;
    atomic_store(told, 0);
    pid_t child = fork();
    if (child == 0)
        record_for_ever(s, told);
    while (atomic_load(told) == 0)
        sleep_ns(10 * NS_PER_MS);
    sleep_ns((2300 + rand_r(seed) % 1000) * NS_PER_MS);
    int64_t killed_ns = atomic_load(told);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    size_t count = points_of(s, 3, &series);
    assert_true(count > 0);
    double lost_s = (double)(killed_ns / 1000 - series.points.at[count - 1].t_us) / 1e6;
    printf("# killed: %.3f s lost, %zu points\n", lost_s, count);
    return lost_s;
}

/* A kill may lose the samples of one second and of the duration of a write. A write may take seconds on a busy machine, so a
   kill with a larger loss is repeated a few times. KILLS: number of successful kills, 100 in `make test-long`. */
CASE(a_kill_takes_at_most_a_second)
{
    unsigned seed = (unsigned)sweep_seed();
    int kills = getenv("KILLS") ? atoi(getenv("KILLS")) : 2, tries = 0, good = 0;
    _Atomic int64_t *told = mmap(NULL, sizeof(*told), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_true(told != MAP_FAILED);
    while (good < kills && tries++ < kills + 6)
        good += kill_one(s, told, &seed) < 2;
    assert_int_equal(good, kills);
    munmap((void *)told, sizeof(*told));
}

/* A limit on file sizes (RLIMIT_FSIZE) acts like a full disk: no file can grow. After the limit is lifted, all samples must be
   recorded. */
CASE(a_full_disk_loses_nothing)
{
    struct rlimit unlimited;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    start(s);
    write_all(s, 1);
    wait_until_counted(s, "plantcast_history_good", 1);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){ 20000, unlimited.rlim_max }), 0);
    for (int i = 0; i < 200; i++) {
        write_all(s, bent(i));
        sleep_ns(10 * NS_PER_MS);
    }
    wait_until_counted(s, "plantcast_history_good", 0);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    historian_stop(&s->historian);
    assert_true(counted(s, "plantcast_history_lost_total") == 0);
    struct history_series series;
    size_t count = points_of(s, 0, &series);
    printf("# %zu points\n", count);
    assert_true(count > 195);
}

/* A file at the path of the history folder makes the folder unusable, like a read-only one. Once the file is removed, a
   restarted historian must create the folder and use it. */
CASE(a_folder_that_comes_later_is_used)
{
    char *path = temp_write_text(s->folder, "history", "not a folder");
    start(s);
    write_all(s, 5);
    sleep_ns(1300 * NS_PER_MS);
    assert_true(counted(s, "plantcast_history_good") == 0);
    assert_int_equal(unlink(path), 0);
    historian_stop(&s->historian);
    struct history_series series;
    assert_true(points_of(s, 0, &series) > 0);
    assert_true(series.points.at[0].value == 5);
}

/* The disk cannot be written for so long that no more points fit into memory. The lost time must have no values, although the tags never
   become stale, and the gap must be noted. */
CASE(lost_samples_leave_a_gap)
{
    char *path = temp_write_text(s->folder, "history", "not a folder");
    struct history_series series;
    never_stale(s);
    start_with_limit(s, 8 * TAGS);
    for (int i = 0; i < 20; i++) {
        write_all(s, bent(i));
        sleep_ns(100 * NS_PER_MS);
    }
    sleep_ns(1200 * NS_PER_MS);
    assert_true(counted(s, "plantcast_history_lost_total") > 0);
    assert_int_equal(unlink(path), 0);
    wait_until_counted(s, "plantcast_history_good", 1);
    sleep_ns(1200 * NS_PER_MS);
    int64_t after_ns = write_all(s, 5);
    historian_stop(&s->historian);
    size_t count = points_of(s, 0, &series), gaps = 0;
    for (size_t i = 0; i < count; i++)
        gaps += isnan(series.points.at[i].value) && series.points.at[i].quality == QUALITY_BAD_NO_COMMUNICATION &&
                series.points.at[i].t_us < after_ns / 1000;
    assert_int_equal(gaps, 1);
    assert_int_equal(events_of(s, "gap", after_ns), 1);
}

/* While samples are lost, all tags become Uncertain, and one sample arrives with a source time of an hour ago. No tag's values before
   and after the loss may be joined, the noted gap must not have the length of an hour, and each tag's present reading must be
   recorded after the loss although no sample arrives. */
CASE(a_loss_begins_when_samples_are_lost)
{
    char *path = temp_write_text(s->folder, "history", "not a folder");
    never_stale(s);
    start_with_limit(s, 4 * TAGS);
    int64_t newest_ns = 0;
    for (int i = 0; i < 5; i++) {
        newest_ns = write_all(s, i % 2 ? 100 : 5);
        sleep_ns(NS_PER_MS);
    }
    wait_until_counted(s, "plantcast_history_waiting_points", 4 * TAGS);
    store_write(s->store, &(struct sample){ 0, 7, QUALITY_GOOD }, 1, clock_mono_ns(), clock_utc_ns() - 3600 * NS_PER_S);
    store_link_lost(s->store, 0, clock_mono_ns());
    wait_until_counted(s, "plantcast_history_lost_total", 2 * TAGS + 1);
    assert_int_equal(unlink(path), 0);
    wait_until_counted(s, "plantcast_history_good", 1);
    sleep_ns(1200 * NS_PER_MS);
    historian_stop(&s->historian);
    for (int tag = 0; tag < 2; tag++) {
        struct history_series series;
        const size_t count = points_of(s, tag, &series);
        const struct history_point *points = series.points.at;
        size_t gap = 0;
        while (gap < count && !isnan(points[gap].value))
            gap++;
        assert_true(gap > 0 && gap + 1 < count);
        assert_true(points[gap - 1].t_us == newest_ns / 1000 && points[gap - 1].value == 5 + tag);
        assert_true(points[gap].t_us > points[gap - 1].t_us && points[gap + 1].t_us > points[gap].t_us);
        assert_true(points[gap + 1].value == (tag == 0 ? 7 : 5 + tag)); /* later points: the lost link has made the tags Bad */
    }
    assert_int_equal(events_of(s, "gap", newest_ns), 1);
}

/* The daemon ends while samples are lost. Its end must not count further samples as lost, and each tag's values must end. */
CASE(a_loss_ends_with_the_daemon)
{
    struct rlimit unlimited;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    never_stale(s);
    start_with_limit(s, 4 * TAGS);
    write_all(s, 1);
    assert_true(comes_to(s, QUALITY_GOOD)); /* the month's file exists */
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){ 20000, unlimited.rlim_max }), 0);
    for (int i = 0; i < 20; i++) {
        write_all(s, bent(i));
        sleep_ns(NS_PER_MS);
    }
    wait_until_counted(s, "plantcast_history_samples_total", 21 * TAGS);
    wait_until_counted(s, "plantcast_history_good", 0); /* a write has failed */
    const double lost = counted(s, "plantcast_history_lost_total");
    assert_true(lost > 0);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    historian_stop(&s->historian);
    assert_true(counted(s, "plantcast_history_lost_total") == lost);
    assert_int_equal(events_of(s, "gap", clock_utc_ns()), 1);
    for (int tag = 0; tag < TAGS; tag++) {
        struct history_series series;
        const size_t count = points_of(s, tag, &series);
        assert_true(count > 1 && isnan(series.points.at[count - 1].value) && !isnan(series.points.at[count - 2].value));
    }
}

static bool has_point(const struct history_series *series, int64_t utc_ns, double value)
{
    for (size_t i = 0; i < series->points.count; i++)
        if (series->points.at[i].t_us == utc_ns / 1000 && series->points.at[i].value == value)
            return true;
    return false;
}

static void expect_spooled_run(struct historian_setup *s, int64_t first_ns, int64_t last_ns)
{
    struct history_series series;
    start(s);
    for (int i = 0; i < 200 && counted(s, "plantcast_history_good") != 1; i++)
        sleep_ns(20 * NS_PER_MS);
    historian_stop(&s->historian);
    assert_true(points_of(s, 3, &series) >= 2);
    assert_true(has_point(&series, first_ns, 5 + 3) && has_point(&series, last_ns, 7 + 3));
    struct snapshot *snapshot = test_snapshot(TAGS);
    look(s, last_ns, snapshot);
    assert_true(snapshot->readings[3].value == 10);
    assert_true(events_of(s, "gap", last_ns) >= 1); /* a gap is recorded that begins at the end of the previous run */
}

/* The history folder is unusable until the daemon ends. Samples that could not be written must be stored in a spool file in
   another folder, and recorded at the next start with a usable folder. */
CASE(what_waits_at_the_end_comes_with_the_next_start)
{
    char *path = temp_write_text(s->folder, "history", "not a folder"), *spool = temp_path(s->folder, "history.spool");
    setenv("RUNTIME_DIRECTORY", s->folder, 1);
    start(s);
    int64_t first_ns = write_all(s, 5);
    sleep_ns(1300 * NS_PER_MS);
    int64_t last_ns = write_all(s, 7);
    historian_stop(&s->historian);
    assert_int_equal(access(spool, R_OK), 0);
    start(s); /* starts and stops the historian again, without a usable folder: the spool file must not be lost */
    sleep_ns(300 * NS_PER_MS);
    historian_stop(&s->historian);
    assert_int_equal(access(spool, R_OK), 0);
    assert_int_equal(unlink(path), 0);
    expect_spooled_run(s, first_ns, last_ns);
    assert_int_not_equal(access(spool, R_OK), 0);
    unsetenv("RUNTIME_DIRECTORY");
}

/* --- clocks ------------------------------------------------------------------------------------------------------------------- */

/* The clock is set forward by an hour. All samples before and after that must be recorded, and the skipped hour must contain no
   values. */
CASE(a_clock_set_forward_leaves_its_hour_empty)
{
    struct snapshot *snapshot = test_snapshot(TAGS);
    struct history_series series;
    start(s);
    int64_t before_ns = write_all(s, 1);
    wait_until_counted(s, "plantcast_history_samples_total", TAGS);
    int64_t second_ns = write_all(s, 2);
    atomic_fetch_add(&clock_off_ns, 3600 * NS_PER_S);
    int64_t after_ns = write_all(s, 9);
    /* waits until the samples after the change are recorded */
    wait_until_counted(s, "plantcast_history_samples_total", 3 * TAGS);
    historian_stop(&s->historian);
    assert_true(points_of(s, 3, &series) >= 4);
    assert_true(has_point(&series, before_ns, 4) && has_point(&series, second_ns, 5) && has_point(&series, after_ns, 12));
    look(s, second_ns, snapshot);
    assert_true(snapshot->readings[3].value == 5 && snapshot->readings[3].quality == QUALITY_GOOD);
    for (int minute = 1; minute < 60; minute += 7) {
        look(s, second_ns + minute * 60 * NS_PER_S, snapshot);
        assert_int_equal(snapshot->readings[3].quality, QUALITY_BAD_NO_COMMUNICATION);
    }
    look(s, after_ns, snapshot);
    assert_true(snapshot->readings[3].value == 12 && snapshot->readings[3].quality == QUALITY_GOOD);
    assert_int_equal(events_of(s, "clock", after_ns), 1);
}

/* The clock is set forward by two years while the daemon is stopped. No recorded month may be deleted for its age. */
CASE(a_clock_set_far_forward_deletes_nothing)
{
    char *june = temp_path(s->folder, "history/history-2026-06.sqlite");
    s->plant->history.keep_days = 30;
    start(s);
    write_all(s, 1);
    wait_until_counted(s, "plantcast_history_good", 1);
    historian_stop(&s->historian);
    atomic_fetch_add(&clock_off_ns, INT64_C(2) * 365 * 86400 * NS_PER_S);
    for (int i = 0; i < 2; i++) {
        start(s);
        int64_t utc_ns = write_all(s, bent(i));
        wait_until_counted(s, "plantcast_history_good", 1);
        historian_stop(&s->historian);
        struct history_series series;
        points_of(s, 3, &series);
        assert_true(has_point(&series, utc_ns, bent(i) + 3));
    }
    assert_int_equal(access(temp_path(s->folder, "history/history-2028-06.sqlite"), F_OK), 0);
    assert_int_equal(access(june, F_OK), 0);
}

/* The clock is set back by an hour, so this hour of clock time occurs twice. All samples of both must be recorded. */
CASE(a_clock_set_back_loses_nothing)
{
    int64_t times_ns[6];
    struct history_series series;
    start(s);
    for (int i = 0; i < 6; i++) {
        if (i == 3)
            atomic_fetch_sub(&clock_off_ns, 3600 * NS_PER_S);
        times_ns[i] = write_all(s, bent(i));
        sleep_ns(2 * NS_PER_MS);
        if (i == 2 || i == 3)
            wait_until_counted(s, "plantcast_history_samples_total", (i + 1) * TAGS);
    }
    historian_stop(&s->historian);
    points_of(s, 3, &series);
    for (int i = 0; i < 6; i++)
        assert_true(has_point(&series, times_ns[i], bent(i) + 3));
    assert_int_equal(events_of(s, "clock", times_ns[5]), 1);
    assert_true(counted(s, "plantcast_history_lost_total") == 0);
}

/* Local time jumps from 02:00 to 03:00 in spring, and from 03:00 to 02:00 in autumn. The history, which uses UTC, must be
   recorded without a gap. */
TEST_WITH(summer_time_comes_and_goes, set_up, tear_down)
{
    static const int64_t changes_s[] = { 1774746000, 1792890000 }; /* 2026-03-29T01:00Z and 2026-10-25T01:00Z, Europe/Berlin */
    setenv("TZ", "Europe/Berlin", 1);
    tzset();
    for (int k = 0; k < 2; k++) {
        struct historian_setup *s = *state;
        int64_t times_ns[10], change_ns = changes_s[k] * NS_PER_S;
        struct history_series series;
        /* sets the test's clock to one second before the change of local time */
        atomic_store(&clock_off_ns, change_ns - NS_PER_S - __real_clock_utc_ns());
        start(s);
        for (int i = 0; i < 10; i++) {
            while (i == 5 && clock_utc_ns() <= change_ns)
                sleep_ns(5 * NS_PER_MS);
            times_ns[i] = write_all(s, i * i);
            sleep_ns(5 * NS_PER_MS);
        }
        historian_stop(&s->historian);
        assert_true(times_ns[0] < change_ns && times_ns[5] > change_ns);
        points_around(s, 3, changes_s[k] * US_PER_S, &series);
        for (int i = 0; i < 10; i++)
            assert_true(has_point(&series, times_ns[i], i * i + 3) && (i == 0 || times_ns[i] > times_ns[i - 1]));
        assert_int_equal(events_of(s, "clock", change_ns), 0);
        assert_int_equal(events_of(s, "gap", change_ns), 0);
    }
    unsetenv("TZ");
    tzset();
}

/* --- disks -------------------------------------------------------------------------------------------------------------------- */

/* Mounts a tmpfs of 100 MB on the folder, visible only to this thread and to threads that it starts. Returns false if the
   process is not permitted to mount. */
static bool mount_disk(const char *folder)
{
    return mkdir(folder, 0777) == 0 && unshare(CLONE_NEWNS) == 0 && mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0 &&
           mount("history", folder, "tmpfs", 0, "size=100m") == 0;
}

/* Fills the remaining space of the disk with one file, and returns its path. */
static char *fill_disk(const char *folder)
{
    char *path = temp_path(folder, "filler");
    int fd = open(path, O_WRONLY | O_CREAT, 0600);
    assert_true(fd >= 0);
    off_t at = 0;
    for (off_t step = 1 << 20; step >= 4096;)
        if (posix_fallocate(fd, at, step) == 0)
            at += step;
        else
            step /= 2;
    close(fd);
    return path;
}

/* The disk is full, and no other folder is available, as after a reboot. Unwritten samples must be stored in the file that the
   historian has reserved for this case, and recorded later. */
CASE(a_full_disk_has_room_for_a_spool)
{
    char *folder = temp_path(s->folder, "history");
    if (!mount_disk(folder)) {
        print_message("# no file system can be mounted here\n");
        skip();
    }
    /* an empty reserve file, as left by a process that was killed before it gave the file its size; the historian must complete
       it */
    char *reserve = temp_write_text(folder, "spool.reserve", "");
    char *spool = temp_path(folder, "unwritten.spool");
    struct stat st = { 0 };
    start(s);
    write_all(s, 1);
    for (int i = 0; i < 500 && (stat(reserve, &st) != 0 || st.st_size == 0); i++)
        sleep_ns(10 * NS_PER_MS);
    assert_true(st.st_size >= 1 << 20);
    char *filler = fill_disk(folder);
    int64_t times_ns[400];
    for (int i = 0; i < 400; i++) {
        times_ns[i] = write_all(s, bent(i));
        sleep_ns(5 * NS_PER_MS);
    }
    historian_stop(&s->historian);
    assert_int_equal(access(spool, R_OK), 0);
    assert_int_not_equal(access(reserve, F_OK), 0);
    assert_int_equal(unlink(filler), 0);
    start(s);
    for (int i = 0; i < 500 && access(reserve, F_OK) != 0; i++) /* waits until the historian has created a new reserve file */
        sleep_ns(10 * NS_PER_MS);
    historian_stop(&s->historian);
    assert_int_not_equal(access(spool, R_OK), 0);
    assert_int_equal(access(reserve, F_OK), 0);
    struct history_series series;
    points_of(s, 3, &series);
    for (int i = 0; i < 400; i++)
        assert_true(has_point(&series, times_ns[i], bent(i) + 3));
    assert_true(counted(s, "plantcast_history_lost_total") == 0);
    assert_int_equal(umount2(folder, MNT_DETACH), 0);
}

/* Writes the file of a month, with a point at the beginning of each of its first days. */
static void record_days(struct historian_setup *s, const char *folder, int month, int days)
{
    int error;
    struct history_point points[31];
    struct month_file *file = month_file_open(s->log, folder, month, s->tags, TAGS, &error);
    assert_non_null(file);
    for (int i = 0; i < days; i++)
        points[i] = (struct history_point){ month_begin_us(month) + i * 86400 * US_PER_S, i, QUALITY_GOOD };
    assert_int_equal(month_file_import(file, 0, points, (size_t)days), 0);
    month_file_close(&file);
}

/* The disk is full, and has a month older than keep_days. The historian must delete that month, and then record again. */
CASE(a_full_disk_gets_room_from_old_months)
{
    char *folder = temp_path(s->folder, "history"), *old = temp_path(folder, "history-2026-01.sqlite");
    const int june = month_of(clock_utc_ns() / 1000);
    if (!mount_disk(folder)) {
        print_message("# no file system can be mounted here\n");
        skip();
    }
    char *month = test_memory(mem_array(4 << 20, 1));
    assert_int_equal(atomic_file_put(old, month, 4 << 20), 0);
    record_days(s, folder, june - 1, 31);
    record_days(s, folder, june, 14);
    char *filler = fill_disk(folder);
    s->plant->history.keep_days = 30;
    start(s);
    int64_t utc_ns = write_all(s, 1);
    for (int64_t end_ns = clock_mono_ns() + 30 * NS_PER_S; access(old, F_OK) == 0 && clock_mono_ns() < end_ns;)
        sleep_ns(20 * NS_PER_MS);
    assert_int_not_equal(access(old, F_OK), 0);
    wait_until_counted(s, "plantcast_history_good", 1);
    assert_int_equal(access(filler, F_OK), 0);
    historian_stop(&s->historian);
    struct history_series series;
    points_of(s, 3, &series);
    assert_true(has_point(&series, utc_ns, 4));
    assert_int_equal(umount2(folder, MNT_DETACH), 0);
}

CASE(a_read_only_disk_loses_nothing)
{
    char *folder = temp_path(s->folder, "history");
    struct history_series series;
    int64_t times_ns[3];
    if (!mount_disk(folder)) {
        print_message("# no file system can be mounted here\n");
        skip();
    }
    start(s);
    times_ns[0] = write_all(s, 1);
    historian_stop(&s->historian);
    assert_int_equal(mount(NULL, folder, NULL, MS_REMOUNT | MS_RDONLY, NULL), 0);
    start(s);
    times_ns[1] = write_all(s, 2);
    wait_until_counted(s, "plantcast_history_good", 0);
    times_ns[2] = write_all(s, 7);
    points_of(s, 0, &series); /* recorded history stays readable */
    assert_true(has_point(&series, times_ns[0], 1));
    assert_int_equal(mount(NULL, folder, NULL, MS_REMOUNT, NULL), 0);
    historian_stop(&s->historian);
    points_of(s, 0, &series);
    for (int i = 0; i < 3; i++)
        assert_true(has_point(&series, times_ns[i], i == 2 ? 7 : i + 1));
    assert_true(counted(s, "plantcast_history_lost_total") == 0);
    assert_int_equal(umount2(folder, MNT_DETACH), 0);
}

static void month_path(struct historian_setup *s, char *path, size_t bytes)
{
    char name[MONTH_NAME_BYTES];
    month_name(month_of(clock_utc_ns() / 1000), name);
    snprintf(path, bytes, "%s/history/%s", s->folder, name);
}

static size_t count_set_aside(struct historian_setup *s)
{
    glob_t found;
    char *pattern = test_printf("%s/history/history-*.damaged-*.sqlite", s->folder);
    size_t count = glob(pattern, 0, NULL, &found) == 0 ? found.gl_pathc : 0;
    if (count)
        globfree(&found);
    return count;
}

/* The file of the present month contains garbage when the daemon starts. The historian must move it aside and record all new
   samples in a new file. */
CASE(a_corrupt_month_is_set_aside_and_recording_goes_on)
{
    char path[300], *folder = temp_path(s->folder, "history");
    struct history_series series;
    assert_int_equal(mkdir(folder, 0777), 0);
    month_path(s, path, sizeof(path));
    char rubbish[30000];
    memset(rubbish, 'x', sizeof(rubbish));
    assert_int_equal(atomic_file_put(path, rubbish, sizeof(rubbish)), 0);
    start(s);
    int64_t first_ns = write_all(s, 1);
    wait_until_counted(s, "plantcast_history_points_total", TAGS);
    int64_t second_ns = write_all(s, 2);
    historian_stop(&s->historian);
    assert_int_equal(count_set_aside(s), 1);
    assert_true(counted(s, "plantcast_history_good") == 1 && counted(s, "plantcast_history_lost_total") == 0);
    points_of(s, 3, &series);
    assert_true(has_point(&series, first_ns, 4) && has_point(&series, second_ns, 5));
}

/* Another process locks the database file for more than a second. Threads that write to the store, or that read from it, must
   not wait for that. */
CASE(a_disk_that_hangs_holds_up_nobody)
{
    char path[300];
    sqlite3 *db;
    struct snapshot *snapshot = test_snapshot(TAGS);
    struct history_series series;
    start(s);
    write_all(s, 1);
    month_path(s, path, sizeof(path));
    for (int i = 0; i < 500 && access(path, F_OK) != 0; i++)
        sleep_ns(20 * NS_PER_MS);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    sqlite3_busy_timeout(db, 10000);
    assert_int_equal(sqlite3_exec(db, "BEGIN IMMEDIATE", NULL, NULL, NULL), SQLITE_OK);
    int64_t times_ns[50], longest_ns = 0;
    for (int i = 0; i < 50; i++) {
        int64_t begun_ns = clock_mono_ns();
        times_ns[i] = write_all(s, bent(i));
        store_snapshot(s->store, clock_mono_ns(), clock_utc_ns(), snapshot);
        assert_true(snapshot->readings[3].value == bent(i) + 3);
        int64_t took_ns = clock_mono_ns() - begun_ns;
        longest_ns = took_ns > longest_ns ? took_ns : longest_ns;
        sleep_ns(50 * NS_PER_MS);
    }
    assert_int_equal(sqlite3_exec(db, "ROLLBACK", NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(db);
    historian_stop(&s->historian);
    print_message("# longest %.1f ms, while the disk hung for 2.5 s\n", (double)longest_ns / 1e6);
    assert_true(longest_ns < NS_PER_S);
    points_of(s, 3, &series);
    for (int i = 0; i < 50; i++)
        assert_true(has_point(&series, times_ns[i], bent(i) + 3));
}
