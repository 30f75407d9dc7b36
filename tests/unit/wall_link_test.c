/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connections of the player of walls come back: for ever, each at its own time, and never later than they may. Many that lose their
   server at once, by real sockets: twice, with PLANTCAST_LONG=1 200 times, with LOSSES=N so often. */
#include <libwebsockets.h>
#include <math.h>
#include <netinet/in.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/clock.h"
#include "clients/wall/link.h"
#include "tests/support/ports.h"
#include "tests/support/sweep.h"

enum { DRAWS = 2000, PATIENCE_S = 120, SLOTS = 12 };
static const double SLOT_S = 0.25;

static void waits_are_bounded_and_staggered(void **state)
{
    (void)state;
    for (int tries = 0; tries <= 4; tries++) {
        double usual_s = fmin(8, 0.5 * pow(2, tries)), spread_s = tries == 0 ? 2 : 0, least = INFINITY, most = 0;
        int slots[10] = { 0 };
        for (int i = 0; i < DRAWS; i++) {
            double wait_s = link_wait_s(tries, 0), share = (wait_s - 0.75 * usual_s) / (0.5 * usual_s + spread_s);
            assert_true(share >= 0 && share <= 1);
            slots[(int)fmin(9, 10 * share)]++;
            least = fmin(least, wait_s);
            most = fmax(most, wait_s);
        }
        assert_true(most - least > 0.8 * (0.5 * usual_s + spread_s));
        for (int i = 0; i < 10 && tries > 0; i++) /* even */
            assert_true(slots[i] > DRAWS / 20 && slots[i] < DRAWS / 5);
    }
    for (int i = 0; i < DRAWS; i++) { /* as the server says */
        double wait_s = link_wait_s(3, 30);
        assert_true(wait_s >= 22.5 && wait_s <= 37.5);
    }
}

/* --- a server that is lost and found ---------------------------------------------------------------------------------------- */

struct server {
    struct lws_context *context;
    pthread_t thread;
    pthread_mutex_t lock;
    /* --- below: under lock */
    bool ends, there; /* not there: whoever comes is sent away */
    int open;         /* how many are let in */
};

struct visit {
    bool welcomed;
};

static int on_visit(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    static const char welcome[] = "{\"type\":\"welcome\"}";
    struct server *server = lws_context_user(lws_get_context(wsi));
    struct visit *visit = user;
    unsigned char buffer[LWS_PRE + sizeof(welcome)];
    int status = 0;
    (void)in;
    (void)len;
    pthread_mutex_lock(&server->lock);
    if (reason == LWS_CALLBACK_EVENT_WAIT_CANCELLED) {
        lws_callback_on_writable_all_protocol(server->context, lws_get_protocol(wsi));
    } else if (reason == LWS_CALLBACK_ESTABLISHED) {
        lws_callback_on_writable(wsi);
    } else if (reason == LWS_CALLBACK_SERVER_WRITEABLE && !server->there) {
        status = -1;
    } else if (reason == LWS_CALLBACK_SERVER_WRITEABLE && !visit->welcomed) {
        memcpy(buffer + LWS_PRE, welcome, sizeof(welcome) - 1);
        status = lws_write(wsi, buffer + LWS_PRE, sizeof(welcome) - 1, LWS_WRITE_TEXT) < 0 ? -1 : 0;
        visit->welcomed = status == 0;
        server->open += visit->welcomed;
    } else if (reason == LWS_CALLBACK_CLOSED) {
        server->open -= visit->welcomed;
        visit->welcomed = false;
    }
    pthread_mutex_unlock(&server->lock);
    return status;
}

static void *serve(void *arg)
{
    struct server *server = arg;
    for (bool ends = false; !ends;) {
        lws_service(server->context, 0);
        pthread_mutex_lock(&server->lock);
        ends = server->ends;
        pthread_mutex_unlock(&server->lock);
    }
    return NULL;
}

static int server_start(struct server *server)
{
    static const struct lws_protocols protocols[] = {
        { .name = WIRE_SUBPROTOCOL, .callback = on_visit, .per_session_data_size = sizeof(struct visit) },
        { 0 },
    };
    struct lws_context_creation_info info = {
        .iface = "127.0.0.1", .protocols = protocols, .gid = -1, .uid = -1, .user = server, .options = LWS_SERVER_OPTION_DISABLE_IPV6
    };
    pthread_mutex_init(&server->lock, NULL);
    info.port = free_port();
    server->there = true;
    lws_set_log_level(0, NULL);
    server->context = lws_create_context(&info);
    assert_non_null(server->context);
    assert_int_equal(pthread_create(&server->thread, NULL, serve, server), 0);
    return info.port;
}

/* Lets all in from now on, or none, and those who are in are sent away. */
static void server_be(struct server *server, bool there)
{
    pthread_mutex_lock(&server->lock);
    server->there = there;
    pthread_mutex_unlock(&server->lock);
    lws_cancel_service(server->context);
}

static int server_open(struct server *server)
{
    pthread_mutex_lock(&server->lock);
    int open = server->open;
    pthread_mutex_unlock(&server->lock);
    return open;
}

static json_t *hello(struct link *link)
{
    (void)link;
    return json_pack("{s:s}", "type", "hello");
}

static void text(struct link *link, const json_t *message)
{
    (void)link;
    (void)message;
}

static bool frame(struct link *link, const struct wire_frame *head, const uint8_t *payload)
{
    (void)link;
    (void)head;
    (void)payload;
    return true;
}

static void refused(struct link *link)
{
    (void)link;
    fail_msg("it was refused");
}

static void rest(void)
{
    nanosleep(&(struct timespec){ .tv_nsec = 5000000 }, NULL);
}

/* Waits until all are in again. Of each, first_s is when it comes after its loss, in seconds from now; nobody waits longer than it may. */
static void await_all(struct links *links, struct server *server, double first_s[LINKS_MOST])
{
    int64_t begun_ns = clock_mono_ns();
    do {
        int64_t now_ns = clock_mono_ns();
        assert_true(now_ns - begun_ns < PATIENCE_S * NS_PER_S);
        pthread_mutex_lock(links->lock);
        for (int i = 0; i < LINKS_MOST; i++) {
            const struct link *link = &links->at[i];
            assert_true((double)(link->retry_ns - now_ns) / 1e9 <= 10);
            if (first_s[i] == 0 && link->state == LINK_WAITING && link->tries == 1)
                first_s[i] = (double)(link->retry_ns - begun_ns) / 1e9;
        }
        pthread_mutex_unlock(links->lock);
        rest();
    } while (server_open(server) < LINKS_MOST);
}

static void each_loss_ends_by_itself(void **state)
{
    static const struct link_events events = { hello, text, text, frame, refused };
    static struct links links;
    static struct daemon_url url = { .host = "127.0.0.1" };
    pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    struct server server = { 0 };
    const char *given = getenv("LOSSES");
    int losses = given ? atoi(given) : sweep(200, 2), most_at_once = 0;
    (void)state;
    url.port = server_start(&server);
    links.lock = &lock;
    links.url = &url;
    for (int i = 0; i < LINKS_MOST; i++)
        links.at[i] = (struct link){ .links = &links, .events = &events, .index = i, .wanted = true };
    assert_true(links_start(&links));
    await_all(&links, &server, (double[LINKS_MOST]){ 0 });
    for (int n = 0; n < losses; n++) {
        double first_s[LINKS_MOST] = { 0 };
        int slots[SLOTS] = { 0 }, known = 0;
        server_be(&server, false);
        while (server_open(&server) > 0)
            rest();
        bool stays = n % 2; /* away for a while, so that those who come early wait again */
        if (stays)
            nanosleep(&(struct timespec){ .tv_sec = 1 }, NULL);
        server_be(&server, true);
        await_all(&links, &server, first_s);
        for (int i = 0; i < LINKS_MOST && !stays; i++)
            if (first_s[i] > 0) {
                known++;
                slots[(int)fmin(SLOTS - 1, first_s[i] / SLOT_S)]++;
            }
        for (int i = 0; i < SLOTS; i++)
            most_at_once = slots[i] > most_at_once ? slots[i] : most_at_once;
        assert_true(stays || known > LINKS_MOST / 2);
    }
    printf("# %d losses of %d connections, at most %d tries within %.2f s\n", losses, LINKS_MOST, most_at_once, SLOT_S);
    assert_true(most_at_once <= LINKS_MOST / 2);
    links_stop(&links);
    pthread_mutex_lock(&server.lock);
    server.ends = true;
    pthread_mutex_unlock(&server.lock);
    lws_cancel_service(server.context);
    pthread_join(server.thread, NULL);
    lws_context_destroy(server.context);
}

/* Takes connections, and nothing else: as one that is frozen, or that the machine gives no time. */
static int listen_only(int *port)
{
    struct sockaddr_in address = { .sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    *port = free_port();
    address.sin_port = htons((uint16_t)*port);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof(address)), 0);
    assert_int_equal(listen(fd, LINKS_MOST), 0);
    return fd;
}

static void a_server_that_answers_nothing_is_left(void **state)
{
    static const struct link_events events = { hello, text, text, frame, refused };
    static struct links links;
    static struct daemon_url url = { .host = "127.0.0.1" };
    pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    int tries[2] = { 0 }, fd = listen_only(&url.port);
    int64_t begun_ns = clock_mono_ns();
    (void)state;
    links.lock = &lock;
    links.url = &url;
    for (int i = 0; i < 2; i++)
        links.at[i] = (struct link){ .links = &links, .events = &events, .index = i, .wanted = true };
    assert_true(links_start(&links));
    do {
        assert_true(clock_mono_ns() - begun_ns < PATIENCE_S * NS_PER_S);
        rest();
        pthread_mutex_lock(&lock);
        for (int i = 0; i < 2; i++)
            tries[i] = links.at[i].tries;
        pthread_mutex_unlock(&lock);
    } while (tries[0] == 0 || tries[1] == 0);
    links_stop(&links);
    close(fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waits_are_bounded_and_staggered),
        cmocka_unit_test(each_loss_ends_by_itself),
        cmocka_unit_test(a_server_that_answers_nothing_is_left),
    };
    srand((unsigned)sweep_seed());
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
