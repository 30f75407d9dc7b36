/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests to the service manager for more time to start: they must be sent only while the program makes progress. */
#include "tests/support/test.h"
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/system/service_manager.h"

enum { EVERY_MS = 500, LIMIT_S = 30 }; /* sixty requests within the limit */

struct service_manager_setup {
    char *path;
    int fd;
};

static void begin(struct service_manager_setup *s)
{
    struct sockaddr_un address = { .sun_family = AF_UNIX };
    /* gives the test a session of its own, because progress is measured as the processor time of all processes in the session
       */
    setsid();
    s->path = temp_path(temp_folder(), "notify");
    memcpy(address.sun_path, s->path, strlen(s->path));
    s->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    assert_int_equal(bind(s->fd, (struct sockaddr *)&address, sizeof(address)), 0);
    setenv("NOTIFY_SOCKET", s->path, 1);
}

static void end(struct service_manager_setup *s)
{
    close(s->fd);
    unsetenv("NOTIFY_SOCKET");
}

TEST_FIXTURE(struct service_manager_setup, begin, end)

#define CASE(name) TEST_ON(struct service_manager_setup *s, name, set_up, tear_down)

/* Returns how many requests for more time the fake service manager has received since the last call. */
static int asked(const struct service_manager_setup *s)
{
    char line[200];
    int count = 0;
    for (ssize_t n; (n = recv(s->fd, line, sizeof(line) - 1, 0)) >= 0;) {
        line[n] = 0;
        count += strstr(line, "EXTEND_TIMEOUT_USEC=60000000\nSTATUS=") != NULL;
    }
    return count;
}

static void work_ms(int ms)
{
    int64_t end_ns = clock_mono_ns() + ms * NS_PER_MS;
    for (volatile unsigned i = 0; clock_mono_ns() < end_ns;)
        i++;
}

static void rest_ms(int ms)
{
    usleep((useconds_t)ms * 1000);
}

CASE(it_asks_while_it_works_and_not_while_it_hangs)
{
    struct service_patience *patience = service_patience_begin("working", LIMIT_S);
    work_ms(5 * EVERY_MS);
    assert_true(asked(s) >= 3);
    /* waits and ignores one request that may still follow from work before the pause */
    rest_ms(EVERY_MS + EVERY_MS / 2);
    asked(s);
    rest_ms(3 * EVERY_MS);
    assert_int_equal(asked(s), 0);
    service_patience_status(patience, "the next step");
    rest_ms(EVERY_MS);
    assert_int_equal(asked(s), 1);
    service_patience_end(&patience);
}

CASE(what_it_started_works_for_it)
{
    struct service_patience *patience = service_patience_begin("waiting", LIMIT_S);
    pid_t child = fork();
    if (child == 0) {
        setpgid(0, 0);
        work_ms(5 * EVERY_MS);
        _exit(0);
    }
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_true(asked(s) >= 3);
    service_patience_end(&patience);
}

CASE(one_step_may_not_last_for_ever)
{
    struct service_patience *patience = service_patience_begin("going round in circles", 3);
    int64_t before_ns = clock_work_ns();
    work_ms(3100);
    int asks = asked(s);
    if (clock_work_ns() - before_ns > 1500 * NS_PER_MS)
        assert_true(asks >= 5);
    else /* not judged: on a busy machine the thread got too little processor time, so few requests prove nothing */
        print_message("# not judged: asked %d times in %lld ms of a processor\n", asks,
                      (long long)((clock_work_ns() - before_ns) / NS_PER_MS));
    rest_ms(200); /* ignores one request that may have waited for room in the socket */
    asked(s);
    work_ms(1000);
    assert_int_equal(asked(s), 0);
    service_patience_end(&patience);
}
