/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests basic functions of server/base: texts, reading and replacing files, memory, the order of diagnostics, counters for
   /metrics, and repeated log lines. */
#include "tests/support/test.h"
#include <errno.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/clock.h"
#include "base/metrics/counters.h"
#include "base/metrics/histogram.h"
#include "base/text/diag.h"
#include "base/log/log.h"
#include "base/text/text.h"

TEST(text_grows)
{
    struct text text = { 0 };
    for (int i = 0; i < 1000; i++)
        text_add(&text, "%d,", i);
    text_add_bytes(&text, "a\0b", 3);
    assert_int_equal(text.length, 10 * 2 + 90 * 3 + 900 * 4 + 3);
    assert_memory_equal(text.at, "0,1,2,", 6);
    assert_memory_equal(text.at + text.length - 3, "a\0b", 4);
    text_finish(&text);
    assert_null(text.at);
    assert_int_equal(text.length, 0);
}

/* A cell that begins like a formula is escaped, so that no spreadsheet executes text that a user entered. */
TEST(cells_are_no_formulas)
{
    static const char *const cells[][2] = { { "=1+1", "'=1+1" },
                                            { "@SUM(A1)", "'@SUM(A1)" },
                                            { "+cmd|x", "'+cmd|x" },
                                            { "-2", "'-2" },
                                            { "-", "-" },
                                            { "", "" },
                                            { "TI-1", "TI-1" },
                                            { "'quoted", "'quoted" },
                                            { "=\"a\",b", "\"'=\"\"a\"\",b\"" },
                                            { "\t=1", "'\t=1" } };
    for (size_t i = 0; i < sizeof(cells) / sizeof(cells[0]); i++) {
        struct text text = { 0 };
        text_add(&text, "%s", "");
        text_add_cell(&text, cells[i][0], ",\"");
        assert_string_equal(text.at, cells[i][1]);
        if (text.at[0] != '"')
            assert_string_equal(text_cell_read(text.at), cells[i][0]);
        text_finish(&text);
    }
}

TEST(texts_are_compared_without_their_numbers)
{
    assert_true(text_equal_but_numbers("", ""));
    assert_true(text_equal_but_numbers("timeout after 1000 ms, 12 bytes", "timeout after 2 ms, 345 bytes"));
    assert_true(text_equal_but_numbers("a1", "a22"));
    assert_false(text_equal_but_numbers("a1", "a"));
    assert_false(text_equal_but_numbers("a", "a1"));
    assert_false(text_equal_but_numbers("1a", "1b"));
    assert_false(text_equal_but_numbers("disk full", "disk is full"));
}

TEST(files_are_read_whole_and_replaced_at_once)
{
    char *folder = temp_folder(), *path = temp_path(folder, "f"), *nowhere = temp_path(folder, "no/f");
    size_t bytes = 99;
    assert_int_equal(atomic_file_put(path, "one\0two", 7), 0);
    assert_int_equal(atomic_file_put(path,
                                     "12\0"
                                     "456",
                                     6),
                     0);
    char *text = test_memory(text_read_file(path, 6, &bytes));
    assert_non_null(text);
    assert_int_equal(bytes, 6);
    assert_memory_equal(text,
                        "12\0"
                        "456",
                        7); /* compares 7 bytes: the 6 of the file, and the zero byte that text_read_file() appends */
    assert_null(text_read_file(path, 5, &bytes));
    assert_int_equal(errno, EFBIG);
    assert_null(text_read_file(nowhere, 5, &bytes));
    assert_int_equal(errno, ENOENT);
    assert_null(text_read_file(folder, 1 << 20, &bytes));
    assert_int_equal(errno, EISDIR);
    assert_int_equal(atomic_file_put(nowhere, "x", 1), -ENOENT);
    assert_int_equal(atomic_file_put(folder, "x", 1), -EISDIR);
    assert_int_equal(unlink(path), 0);
}

TEST(memory_is_zeroed_and_checked)
{
    int *numbers = NULL;
    size_t capacity = 0;
    mem_grow(&numbers, &capacity, 3, sizeof(*numbers));
    assert_true(capacity >= 3);
    numbers[2] = 7;
    mem_grow(&numbers, &capacity, 5000, sizeof(*numbers));
    assert_true(capacity >= 5000);
    for (size_t i = 0; i < capacity; i++)
        assert_int_equal(numbers[i], i == 2 ? 7 : 0);
    mem_free(numbers);
    assert_null(mem_try_array(SIZE_MAX / 2, 4));
    char *none = test_memory(mem_try_array(0, 0));
    assert_non_null(none);
    char *text = test_printf("%s-%d", "a", 5);
    assert_string_equal(text, "a-5");
}

TEST(findings_come_in_the_order_of_the_text)
{
    struct diag diag = { 0 };
    char *printed = NULL;
    size_t bytes = 0;
    FILE *out = open_memstream(&printed, &bytes);
    diag_error(&diag, "b", 1, 1, "last");
    diag_warning(&diag, "a", 10, 2, "third of %s", "a");
    diag_error(&diag, "a", 9, 30, "second");
    diag_error(&diag, "a", 10, 2, "fourth");
    diag_error(&diag, "a", 0, 0, "first");
    diag_print(&diag, out);
    fclose(out);
    assert_string_equal(printed, "a: error: first\n"
                                 "a:9:30: error: second\n"
                                 "a:10:2: warning: third of a\n"
                                 "a:10:2: error: fourth\n"
                                 "b:1:1: error: last\n");
    assert_int_equal(diag.errors, 4);
    assert_int_equal(diag.warnings, 1);
    free(printed);
    diag_finish(&diag);
    assert_int_equal(diag.count, 0);
}

/* 64 warnings with the same text except for the tag are printed as one line. Three such warnings are too few for that: each is
   printed. Errors are always printed in full. */
TEST(many_warnings_alike_are_one)
{
    struct diag diag = { 0 };
    char *printed = NULL;
    size_t bytes = 0;
    FILE *out = open_memstream(&printed, &bytes);
    for (int i = 0; i < 64; i++)
        diag_warning(&diag, "a", i < 60 ? 3 + i : 100 + 2 * i, 5, "'T%d' has no asset", i);
    for (int i = 0; i < 3; i++)
        diag_warning(&diag, "a", 1, 1 + i, "column %d", i);
    for (int i = 0; i < 5; i++)
        diag_error(&diag, "b", 1 + i, 0, "error %d", i);
    diag_warning(&diag, "b", 9, 5, "'T%d' has no asset", 99);
    diag_print(&diag, out);
    fclose(out);
    assert_string_equal(printed, "a:1:1: warning: column 0\na:1:2: warning: column 1\na:1:3: warning: column 2\n"
                                 "a:3:5: warning: 'T0' has no asset; 63 more like this (line 4-62 220 222 224 226)\n"
                                 "b:1: error: error 0\nb:2: error: error 1\nb:3: error: error 2\nb:4: error: error 3\n"
                                 "b:5: error: error 4\nb:9:5: warning: 'T99' has no asset\n");
    free(printed);
    diag_finish(&diag);
}

/* 2,000 errors with the same text except for the tag: only the first ones are printed. */
TEST(of_many_errors_alike_the_first_are_printed)
{
    struct diag diag = { 0 }, copy = { 0 };
    char *printed = NULL;
    size_t bytes = 0, lines = 0;
    FILE *out = open_memstream(&printed, &bytes);
    for (int i = 0; i < 2000; i++)
        diag_error(&diag, "a", 10 + i, 1, "'T%d' is there twice", i);
    diag_error(&diag, "a", 5, 1, "other");
    for (size_t i = 0; i < diag.count; i++)
        diag_copy(&copy, &diag.items[i]);
    diag_print(&copy, out);
    fclose(out);
    for (const char *at = printed; *at; at++)
        lines += *at == '\n';
    assert_int_equal(lines, 21);
    assert_non_null(strstr(printed, "a:5:1: error: other\na:10:1: error: 'T0' is there twice\n"));
    assert_non_null(strstr(printed, "a:29:1: error: 'T19' is there twice; 1980 more like this (line 30-2009)\n"));
    assert_int_equal(copy.errors, 2001);
    free(printed);
    diag_finish(&diag);
    diag_finish(&copy);
}

TEST(counters_are_printed_by_family)
{
    struct counters *counters = test_counters();
    struct text *text = test_text();
    counter *a = counters_add(counters, "reads_total{source=\"a\"}", "counter", "Reads.");
    counter_set(counters_add(counters, "sessions", "gauge", "Sessions."), 3);
    counter_inc(counters_add(counters, "reads_total{source=\"b\"}", "counter", "Reads."), 2);
    counter_inc(a, 40);
    assert_ptr_equal(counters_add(counters, "reads_total{source=\"a\"}", "counter", "Reads."), a);
    counter_inc(a, 2);
    counters_print(counters, text);
    assert_string_equal(text->at, "# HELP reads_total Reads.\n# TYPE reads_total counter\n"
                                  "reads_total{source=\"a\"} 42\nreads_total{source=\"b\"} 2\n"
                                  "# HELP sessions Sessions.\n# TYPE sessions gauge\nsessions 3\n");
}

static int lines_with(const char *text, const char *words)
{
    int count = 0;
    for (; (text = strstr(text, words)); text++)
        count++;
    return count;
}

TEST(repeats_in_the_log_are_counted)
{
    char *folder = temp_folder(), *path = temp_path(folder, "log");
    size_t bytes;
    fflush(stderr);
    int kept = dup(STDERR_FILENO);
    assert_non_null(freopen(path, "w", stderr));
    struct log *log = log_create(LOG_WARN);
    for (int i = 0; i < 5; i++)
        log_warn(log, "disk %d is full", 1);
    log_err(log, "other");
    log_info(log, "not at this level");
    log_warn(log, "disk %d is full", 1);
    log_warn(log, "disk %d is full", 1);
    log_destroy(&log);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    char *text = test_memory(text_read_file(path, 1 << 20, &bytes));
    assert_non_null(text);
    assert_null(log);
    assert_int_equal(lines_with(text, "warn  disk 1 is full\n"), 2);
    assert_int_equal(lines_with(text, "warn  disk 1 is full (4 more)\n"), 1);
    assert_int_equal(lines_with(text, "warn  disk 1 is full (1 more)\n"), 1);
    assert_int_equal(lines_with(text, "error other\n"), 1);
    assert_int_equal(lines_with(text, "\n"), 5);
}

TEST(durations_are_counted_by_bucket)
{
    struct counters *counters = test_counters();
    struct text *text = test_text();
    struct histogram *plain = counters_add_histogram(counters, "plain_seconds", "Plain.");
    struct histogram *labelled = counters_add_histogram(counters, "stage_seconds{stage=\"a\"}", "Stages.");
    assert_ptr_equal(counters_add_histogram(counters, "plain_seconds", "Plain."), plain);
    static const int64_t ms[] = { -5, 0, 1, 2, 2, 3, 5000 };
    for (size_t i = 0; i < sizeof(ms) / sizeof(ms[0]); i++)
        histogram_add(plain, ms[i] * NS_PER_MS);
    histogram_add(labelled, 25 * NS_PER_MS);
    counters_print(counters, text);
    static const char *const wanted[] = { "# TYPE plain_seconds histogram\n",
                                          "plain_seconds_bucket{le=\"0.0005\"} 2\n",
                                          "plain_seconds_bucket{le=\"0.002\"} 5\n",
                                          "plain_seconds_bucket{le=\"2.5\"} 6\n",
                                          "plain_seconds_bucket{le=\"+Inf\"} 7\n",
                                          "plain_seconds_sum 5.008000\n",
                                          "plain_seconds_count 7\n",
                                          "stage_seconds_bucket{stage=\"a\",le=\"0.016\"} 0\n",
                                          "stage_seconds_bucket{stage=\"a\",le=\"0.025\"} 1\n",
                                          "stage_seconds_sum{stage=\"a\"} 0.025000\n",
                                          "stage_seconds_count{stage=\"a\"} 1\n" };
    for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]); i++)
        assert_non_null(strstr(text->at, wanted[i]));
}

TEST(numbers_of_microseconds_are_printed_in_seconds)
{
    struct counters *counters = test_counters();
    struct text *text = test_text();
    counter_set(counters_add_seconds(counters, "spent_seconds_total", "counter", "Time."), 12345678);
    counters_print(counters, text);
    assert_string_equal(text->at, "# HELP spent_seconds_total Time.\n# TYPE spent_seconds_total counter\nspent_seconds_total 12.345678\n");
}
