/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the audit trail: its hash chain must reveal every changed, removed or moved line, also after a restart and a rotation.
   A full disk must be reported, and syslog must get well-formed messages. */
#include "tests/support/test.h"
#include <sys/resource.h>
#include <signal.h>
#include <unistd.h>

#include "audit/audit.h"
#include "audit/audit_file.h"
#include "audit/audit_head.h"
#include "audit/audit_syslog.h"

static const int64_t AT_US = INT64_C(1795000000000000);
static const struct audit_entry ENTRY = { .event = "alarm", .result = "done", .who = "Kim \"A\"", .what = "acknowledge TT-101 HH" };

/* Opens the file, appends `count` lines and closes it, like one run of a daemon; most_bytes: size at which a new file begins.
   Returns what opening found wrong with the existing file, or NULL; free with mem_free. */
static char *write_lines(const char *path, int count, size_t most_bytes)
{
    struct audit_file file;
    struct text *lines = test_text();
    char *found, *later;
    assert_int_equal(audit_file_open(&file, path, most_bytes, &found), 0);
    for (int i = 0; i < count; i++) {
        assert_int_equal(audit_file_append(&file, &ENTRY, AT_US + i, lines, &later), 0);
        assert_null(later);
    }
    audit_file_close(&file);
    return found;
}

static void expect_good(const char *path, size_t files, size_t lines)
{
    struct audit_chain none;
    struct audit_report report;
    audit_chain_init(&none);
    audit_file_verify(path, &none, &report);
    if (report.text)
        fprintf(stderr, "%s\n", report.text);
    assert_true(report.good);
    assert_int_equal(report.files, files);
    assert_int_equal(report.lines, lines);
    mem_free(report.text);
}

static void expect_fault(const char *path, const struct audit_chain *known, const char *text)
{
    struct audit_chain none;
    struct audit_report report;
    audit_chain_init(&none);
    audit_file_verify(path, known ? known : &none, &report);
    assert_false(report.good);
    if (!strstr(report.text, text))
        fprintf(stderr, "'%s' is not in '%s'\n", text, report.text);
    assert_non_null(strstr(report.text, text));
    mem_free(report.text);
}

static void put(const char *path, const char *bytes, size_t count)
{
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, count, out), count);
    fclose(out);
}

TEST(test_any_changed_byte)
{
    char *dir = temp_folder(), *path = test_printf("%s/a", dir);
    size_t count;
    struct audit_chain none;
    assert_null(write_lines(path, 5, 1 << 20));
    expect_good(path, 1, 5);
    audit_chain_init(&none);
    char *bytes = test_memory(text_read_file(path, 1 << 20, &count));
    for (size_t i = 0; i < count; i++) {
        struct audit_report report;
        bytes[i] ^= 1;
        put(path, bytes, count);
        audit_file_verify(path, &none, &report);
        if (report.good)
            fprintf(stderr, "byte %zu of %zu may be changed\n", i, count);
        assert_false(report.good);
        mem_free(report.text);
        bytes[i] ^= 1;
    }
    put(path, bytes, count);
    expect_good(path, 1, 5);
}

/* Finds where lines begin in a file of `count` bytes: starts[] receives the offset of each line, then `count`. Returns the
   number of lines. */
static size_t starts_of(const char *bytes, size_t count, size_t starts[])
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        if (i == 0 || bytes[i - 1] == '\n')
            starts[found++] = i;
    starts[found] = count;
    return found;
}

TEST(test_lines_removed_and_moved)
{
    char *dir = temp_folder(), *path = test_printf("%s/a", dir), *head_path = test_printf("%s.head", path);
    size_t count, starts[8];
    mem_free(write_lines(path, 5, 1 << 20));
    char *bytes = test_memory(text_read_file(path, 1 << 20, &count)), *copy = test_memory(mem_array(count, 1));
    assert_int_equal(starts_of(bytes, count, starts), 5);
    /* removes the third line */
    memcpy(copy, bytes, starts[2]);
    memcpy(copy + starts[2], bytes + starts[3], count - starts[3]);
    put(path, copy, count - (starts[3] - starts[2]));
    expect_fault(path, NULL, ":3: lines before this line were removed or inserted");
    /* removes the first line: the rest is still valid, because earlier lines may be in another file; the report states the
       first line's number */
    struct audit_chain known, none;
    struct audit_report report;
    audit_chain_init(&none);
    put(path, bytes + starts[1], count - starts[1]);
    audit_file_verify(path, &none, &report);
    assert_true(report.good);
    assert_int_equal(report.first_seq, 2);
    /* removes the last two lines */
    put(path, bytes, starts[3]);
    expect_fault(path, NULL, "the last 2 lines were removed");
    /* also removes the head file, which states the last line's number: the missing lines cannot be detected then, except by
       somebody who kept a later line */
    known = report.end;
    unlink(head_path);
    expect_fault(path, NULL, "cannot be detected");
    mem_free(write_lines(path, 0, 1 << 20));
    audit_file_verify(path, &none, &report);
    assert_false(report.good);
    mem_free(report.text);
    struct audit_chain third;
    audit_chain_init(&third);
    const char *why;
    assert_true(audit_chain_check(&third, bytes + starts[2], starts[3] - starts[2] - 1, true, &why));
    assert_true(audit_head_write(head_path, &third));
    expect_good(path, 1, 3);
    expect_fault(path, &known, "before line 5 of --known");
    memset(third.hash, 'a', AUDIT_HASH_CHARS);
    expect_fault(path, &third, "line 3 differs from the line recorded in --known");
}

/* When a daemon starts with a truncated audit trail, it reports the gap and goes on; verifying the trail must still find the
   gap later. */
TEST(test_next_start)
{
    char *dir = temp_folder(), *path = test_printf("%s/a", dir), *finding;
    size_t count, starts[8];
    mem_free(write_lines(path, 3, 1 << 20));
    assert_null(write_lines(path, 2, 1 << 20));
    expect_good(path, 1, 5);
    char *bytes = test_memory(text_read_file(path, 1 << 20, &count));
    starts_of(bytes, count, starts);
    assert_int_equal(truncate(path, (off_t)starts[3]), 0);
    finding = write_lines(path, 1, 1 << 20);
    assert_non_null(strstr(finding, "lines were removed"));
    mem_free(finding);
    expect_fault(path, NULL, ":4: lines before this line were removed or inserted");
    /* an incomplete last line, as a crash leaves it */
    put(path, bytes, count - 10);
    char *head_path = test_printf("%s.head", path);
    struct audit_chain fourth;
    const char *why;
    audit_chain_init(&fourth);
    assert_true(audit_chain_check(&fourth, bytes + starts[3], starts[4] - starts[3] - 1, true, &why));
    audit_head_write(head_path, &fourth);
    finding = write_lines(path, 1, 1 << 20);
    assert_non_null(strstr(finding, "an incomplete last line"));
    mem_free(finding);
    expect_good(path, 1, 5);
}

TEST(test_rotation)
{
    char *dir = temp_folder(), *path = test_printf("%s/a", dir), *full = test_printf("%s.000000000004", path), *later;
    struct text *lines = test_text();
    struct audit_file file;
    /* writes ten lines of about 280 bytes with at most 1,000 bytes per file, so that the trail continues in further files */
    assert_null(write_lines(path, 10, 1000));
    assert_int_equal(access(full, F_OK), 0);
    expect_good(path, 3, 10);
    assert_null(write_lines(path, 1, 1000));
    expect_good(path, 3, 11);
    /* another program moves the file away while it is open */
    char *moved = test_printf("%s.000000000012", path);
    assert_int_equal(audit_file_open(&file, path, 1 << 20, &later), 0);
    assert_int_equal(audit_file_append(&file, &ENTRY, AT_US, lines, &later), 0);
    assert_int_equal(rename(path, moved), 0);
    assert_int_equal(audit_file_append(&file, &ENTRY, AT_US, lines, &later), 0);
    assert_null(later);
    expect_good(path, 4, 13);
    /* another program truncates the audit trail while the daemon has it open */
    assert_int_equal(truncate(path, 0), 0);
    assert_int_equal(audit_file_append(&file, &ENTRY, AT_US, lines, &later), 0);
    assert_non_null(strstr(later, "another program changed the file"));
    mem_free(later);
    expect_fault(path, NULL, "lines before this line were removed or inserted");
    /* another program removes the audit trail while the daemon has it open */
    unlink(path);
    assert_int_equal(audit_file_append(&file, &ENTRY, AT_US, lines, &later), 0);
    assert_non_null(strstr(later, "was removed"));
    mem_free(later);
    audit_file_close(&file);
    /* removes a full, rotated file */
    unlink(full);
    unlink(moved);
    expect_fault(path, NULL, "lines before this line were removed or inserted");
}

/* While the file cannot grow (full disk), appending fails and must leave no partial line. Once it can grow again, the next line
   must follow the last complete one, without a gap in the chain. */
TEST(test_full_disk)
{
    char *dir = temp_folder(), *path = test_printf("%s/a", dir), *later;
    struct rlimit before, less;
    struct text *lines = test_text();
    struct audit_file file;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(audit_file_open(&file, path, 1 << 20, &later), 0);
    assert_int_equal(audit_file_append(&file, &ENTRY, AT_US, lines, &later), 0);
    size_t bytes = lines->length;
    getrlimit(RLIMIT_FSIZE, &before);
    less = before;
    less.rlim_cur = bytes + 100;
    setrlimit(RLIMIT_FSIZE, &less);
    for (int i = 0; i < 3; i++)
        assert_true(audit_file_append(&file, &ENTRY, AT_US, lines, &later) < 0);
    assert_int_equal(lines->length, bytes);
    setrlimit(RLIMIT_FSIZE, &before);
    expect_good(path, 1, 1);
    assert_int_equal(audit_file_append(&file, &ENTRY, AT_US, lines, &later), 0);
    assert_null(later);
    expect_good(path, 1, 2);
    audit_file_close(&file);
}

/* A full disk refuses one row, and takes the next one a moment later. A caller that waits for both must still get the error. */
TEST(test_an_error_outlasts_the_next_success)
{
    struct settling settling = { .queued = 0 };
    struct settling_ticket ticket = settling_begin(&settling);
    settling.queued = 2;
    settling_end(&settling, &ticket, 0);
    assert_int_equal(settling_state(&settling, &ticket, 0), -EINPROGRESS);
    settling_wrote(&settling, 0, -ENOSPC);
    settling_wrote(&settling, 1, 0);
    assert_int_equal(settling_state(&settling, &ticket, 0), -ENOSPC);
    settling_wrote(&settling, 1, 0);
    assert_int_equal(settling_state(&settling, &ticket, 0), 0);
}

/* Text from strangers is escaped, and the entry stays one line of JSON. */
TEST(test_strangers_texts)
{
    struct audit_chain chain, read;
    struct text *out = test_text();
    char *longest = test_memory(mem_array(5001, 1));
    const char *why;
    memset(longest, '"', 5000);
    audit_chain_init(&chain);
    audit_chain_init(&read);
    const struct audit_entry entry = { .event = "login", .result = "refused", .who = "a\nb\xff\x01\xed\xa0\x80", .what = longest };
    audit_chain_add(&chain, &entry, AT_US, out);
    assert_int_equal(strcspn(out->at, "\n"), out->length - 1);
    assert_non_null(strstr(out->at, "\"who\":\"a?b??"));
    assert_true(out->length < AUDIT_LINE_BYTES);
    assert_true(audit_chain_check(&read, out->at, out->length - 1, false, &why));
}

TEST(test_syslog_frame)
{
    struct text out = { 0 };
    audit_syslog_frame(&out, &(struct syslog_message){ "host.example", 17, "login", false, AT_US, "{}", 2 });
    assert_int_equal(atoi(out.at), strlen(strchr(out.at, ' ') + 1));
    assert_string_equal(strchr(out.at, ' ') + 1, "<108>1 2026-11-18T11:06:40.000Z host.example plantcastd 17 login - {}");
    text_finish(&out);
    audit_syslog_frame(&out, &(struct syslog_message){ "-", 17, "login", true, AT_US, "{}", 2 });
    assert_non_null(strstr(out.at, "<109>1 "));
    text_finish(&out);
}

/* Several threads record entries at once; every entry is in the file, in order. */
TEST(test_daemon)
{
    char *dir = temp_folder(), *path = test_printf("%s/a", dir);
    struct log *log = test_log();
    struct counters *counters = test_counters();
    struct audit *audit = audit_start(&(struct audit_params){ .log = log, .counters = counters, .path = path });
    assert_non_null(audit);
    for (int i = 0; i < 200; i++)
        audit_say(audit, &ENTRY);
    audit_say(NULL, &ENTRY);
    audit_stop(&audit);
    expect_good(path, 1, 200);
    assert_null(audit_start(&(struct audit_params){ .log = log, .counters = counters, .path = "/nowhere/a" }));
    struct text *metrics = test_text();
    counters_print(counters, metrics);
    assert_non_null(strstr(metrics->at, "plantcast_audit_lines_total 200"));
}
