/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the log's formats: journal entries, lines with a priority, and JSON lines. Also tests the datagrams to a service
   manager (sd_notify). */
#include "base/log/log.h"

#include "tests/support/test.h"
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <jansson.h>

#include "base/clock.h"
#include "base/system/service_manager.h"

struct socket_place {
    char *path;
    int fd; /* a datagram socket bound to `path` */
};

static void begin(struct socket_place *place)
{
    struct sockaddr_un here = { .sun_family = AF_UNIX };
    place->path = temp_path(temp_folder(), "socket");
    snprintf(here.sun_path, sizeof(here.sun_path), "%s", place->path);
    place->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    assert_int_equal(bind(place->fd, (struct sockaddr *)&here, sizeof(here)), 0);
}

static void end(struct socket_place *place)
{
    close(place->fd);
    unsetenv("NOTIFY_SOCKET");
    unsetenv("JOURNAL_STREAM");
}

TEST_FIXTURE(struct socket_place, begin, end)

static size_t receive(const struct socket_place *place, char *out, size_t size)
{
    ssize_t count = recv(place->fd, out, size - 1, 0);
    out[count > 0 ? count : 0] = 0;
    return count > 0 ? (size_t)count : 0;
}

/* Logs an event, and returns what the log wrote to stderr. The caller frees the text with free(). */
static char *written(enum log_format format, const char *socket_path, enum log_level level, enum log_event event, const char *message)
{
    fflush(stderr);
    int kept = dup(STDERR_FILENO), ends[2];
    assert_int_equal(pipe(ends), 0);
    dup2(ends[1], STDERR_FILENO);
    close(ends[1]);
    struct log *log = log_create(LOG_INFO);
    log_set_format(log, format, socket_path);
    log_set_plant(log, "Two boxes");
    log_event(log, level, event, "%s", message);
    log_destroy(&log);
    dup2(kept, STDERR_FILENO);
    close(kept);
    char *text = calloc(1, 4096);
    assert_true(read(ends[0], text, 4095) >= 0);
    close(ends[0]);
    return text;
}

/* Returns how many times `part` occurs in the text. */
static int occurrences(const char *text, const char *part)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, part)); at++)
        count++;
    return count;
}

TEST(an_error_that_lasts_is_logged_once_until_it_changes)
{
    char text[4096] = "";
    fflush(stderr);
    int kept = dup(STDERR_FILENO), ends[2];
    assert_int_equal(pipe(ends), 0);
    dup2(ends[1], STDERR_FILENO);
    close(ends[1]);
    struct log *log = log_create(LOG_INFO);
    for (int i = 0; i < 10; i++) {
        log_lasting_err(log, "%s: %s", "a.sqlite", "disk is full");
        log_info(log, "another line %d", i);
        log_lasting_err(log, "%s: %s", "b.sqlite", "disk is full");
    }
    for (int i = 0; i < 40; i++)
        log_lasting_err(log, "file %d", i);
    log_destroy(&log);
    dup2(kept, STDERR_FILENO);
    close(kept);
    assert_true(read(ends[0], text, sizeof(text) - 1) > 0);
    close(ends[0]);
    assert_int_equal(occurrences(text, "error a.sqlite: disk is full\n"), 1);
    assert_int_equal(occurrences(text, "error b.sqlite: disk is full\n"), 1);
    assert_int_equal(occurrences(text, "another line"), 10);
    assert_int_equal(occurrences(text, "error file "), 40);
}

TEST_ON(const struct socket_place *place, an_entry_of_the_journal_has_its_priority_plant_and_message_id, set_up, tear_down)
{
    char got[2048], want[2048];
    char *text = written(LOG_JOURNAL, place->path, LOG_ERROR, EVENT_RELOAD_REFUSED, "it is wrong");
    assert_string_equal(text, "");
    receive(place, got, sizeof(got));
    snprintf(want, sizeof(want),
             "MESSAGE=it is wrong\nPRIORITY=3\nSYSLOG_IDENTIFIER=plantcastd\nPLANT=Two boxes\nEVENT=reload-refused\nMESSAGE_ID=%s\n",
             log_event_id(EVENT_RELOAD_REFUSED));
    assert_string_equal(got, want);
    free(text);
}

TEST_ON(const struct socket_place *place, a_message_of_two_lines_is_one_entry, set_up, tear_down)
{
    char got[2048];
    static const char want[] = "MESSAGE\n\3\0\0\0\0\0\0\0a\nb\nPRIORITY=6\n";
    char *text = written(LOG_JOURNAL, place->path, LOG_INFO, EVENT_NONE, "a\nb");
    assert_true(receive(place, got, sizeof(got)) > sizeof(want));
    assert_memory_equal(got, want, sizeof(want) - 1);
    free(text);
}

TEST(without_the_journals_socket_lines_begin_with_their_priority)
{
    static const char *const want[] = { "<3>text\n", "<4>text\n", "<6>text\n" };
    for (int level = LOG_ERROR; level <= LOG_INFO; level++) {
        char *text = written(LOG_JOURNAL, "/nowhere/socket", (enum log_level)level, EVENT_NONE, "text");
        assert_string_equal(text, want[level]);
        free(text);
    }
}

TEST(a_line_of_json_is_one_object_whatever_the_text)
{
    char *text = written(LOG_JSON, NULL, LOG_WARN, EVENT_CERTIFICATE_EXPIRES, "\"a\"\n\xff\xc3\xa4\x01");
    assert_ptr_equal(strchr(text, '\n'), text + strlen(text) - 1);
    json_t *object = test_json(json_loads(text, 0, NULL));
    assert_non_null(object);
    assert_string_equal(json_string_value(json_object_get(object, "level")), "warn");
    assert_string_equal(json_string_value(json_object_get(object, "message")), "\"a\"\n?\xc3\xa4\x01");
    assert_string_equal(json_string_value(json_object_get(object, "plant")), "Two boxes");
    assert_string_equal(json_string_value(json_object_get(object, "event")), "certificate-expires");
    assert_string_equal(json_string_value(json_object_get(object, "message_id")), log_event_id(EVENT_CERTIFICATE_EXPIRES));
    assert_int_equal(strlen(json_string_value(json_object_get(object, "time"))), strlen("2026-01-01T00:00:00.000Z"));
    free(text);
}

TEST(every_event_has_a_name_and_an_id_of_its_own)
{
    assert_null(log_event_name(EVENT_NONE));
    for (int i = 1; i < EVENT_COUNT; i++) {
        assert_int_equal(strspn(log_event_id((enum log_event)i), "0123456789abcdef"), 32);
        assert_non_null(log_event_name((enum log_event)i));
        for (int j = 1; j < i; j++)
            assert_string_not_equal(log_event_id((enum log_event)i), log_event_id((enum log_event)j));
    }
}

TEST_ON(const struct socket_place *place, the_journal_is_known_by_its_stream, set_up, tear_down)
{
    struct stat st;
    char stream[64];
    assert_int_equal(fstat(place->fd, &st), 0);
    snprintf(stream, sizeof(stream), "%llu:%llu", (unsigned long long)st.st_dev, (unsigned long long)st.st_ino);
    assert_false(service_is_journal(place->fd));
    setenv("JOURNAL_STREAM", stream, 1);
    assert_true(service_is_journal(place->fd));
    setenv("JOURNAL_STREAM", "1:1", 1);
    assert_false(service_is_journal(place->fd));
}

TEST_ON(const struct socket_place *place, the_manager_is_told_and_asked_for_patience, set_up, tear_down)
{
    char got[256];
    assert_false(service_notify("READY=1"));
    assert_null(service_patience_begin("reading", 600));
    setenv("NOTIFY_SOCKET", place->path, 1);
    assert_true(service_notify("READY=%d", 1));
    receive(place, got, sizeof(got));
    assert_string_equal(got, "READY=1");
    struct service_patience *patience = service_patience_begin("reading", 600);
    for (int i = 0; i < 500 && !receive(place, got, sizeof(got)); i++)
        usleep(10000);
    assert_string_equal(got, "EXTEND_TIMEOUT_USEC=60000000\nSTATUS=reading");
    service_patience_status(patience, "drawing");
    for (int i = 0; i < 500 && !receive(place, got, sizeof(got)); i++)
        usleep(10000);
    assert_string_equal(got, "EXTEND_TIMEOUT_USEC=60000000\nSTATUS=drawing");
    service_patience_end(&patience);
    assert_null(patience);
}

TEST(a_watchdog_is_ours_only_if_it_names_this_process)
{
    char pid[32];
    setenv("WATCHDOG_USEC", "5000000", 1);
    assert_int_equal(service_watchdog_ns(), 5 * NS_PER_S);
    setenv("WATCHDOG_PID", "1", 1);
    assert_int_equal(service_watchdog_ns(), 0);
    snprintf(pid, sizeof(pid), "%ld", (long)getpid());
    setenv("WATCHDOG_PID", pid, 1);
    assert_int_equal(service_watchdog_ns(), 5 * NS_PER_S);
    setenv("WATCHDOG_USEC", "none", 1);
    assert_int_equal(service_watchdog_ns(), 0);
    unsetenv("WATCHDOG_USEC");
    unsetenv("WATCHDOG_PID");
}
