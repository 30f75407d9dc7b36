/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uses libpq without its blocking calls: all waiting is done by poll() on the socket, with a timeout. */
#include "history/postgres/postgres_link.h"

#include <endian.h>
#include <math.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/files/login_file.h"
#include "base/mem.h"

static const int64_t CONNECT_NS = 10 * NS_PER_S, ANSWER_NS = 60 * NS_PER_S, STOP_NS = 2 * NS_PER_S;
static const int64_t EPOCH_US = 946684800000000; /* 2000-01-01 in microseconds since 1970: the epoch of PostgreSQL timestamps */
/* Keepalive settings: if this machine disappears, the database server closes the connection within half a minute. That releases
   the lock of the only writer. */
static const char set_up[] = "SET client_min_messages = warning; SET synchronous_commit = on; SET tcp_keepalives_idle = 10;"
                             "SET tcp_keepalives_interval = 5; SET tcp_keepalives_count = 3";

struct postgres_link {
    PGconn *library;
    int stop_fd;
    int64_t stop_by_ns;            /* monotonic deadline for all waits once stop_fd is readable; 0: the program is not ending */
    int64_t connect_ns, answer_ns; /* timeouts in nanoseconds: for connecting, and for each answer */
    struct {
        char *at;
        size_t length, capacity;
    } copy;
    char why[POSTGRES_WHY_BYTES];
};

/* --- waiting ------------------------------------------------------------------------------------------------------------------ */

static bool fail(struct postgres_link *link, const char *text)
{
    snprintf(link->why, sizeof(link->why), "%.*s", (int)strcspn(text, "\n"), *text ? text : "no reason given");
    return false;
}

static bool fail_as_library(struct postgres_link *link)
{
    return fail(link, PQerrorMessage(link->library));
}

/* Waits until the connection's socket is ready. Returns false on timeout. */
static bool wait_for(struct postgres_link *link, short events, int64_t until_ns)
{
    for (;;) {
        int64_t now_ns = clock_mono_ns(), end_ns = link->stop_by_ns && link->stop_by_ns < until_ns ? link->stop_by_ns : until_ns;
        struct pollfd fds[] = { { .fd = PQsocket(link->library), .events = events },
                                { .fd = link->stop_by_ns ? -1 : link->stop_fd, .events = POLLIN } };
        if (now_ns >= end_ns)
            return fail(link, "the PostgreSQL server did not answer within the time limit");
        int count = poll(fds, 2, (int)((end_ns - now_ns) / NS_PER_MS) + 1);
        if (count > 0 && fds[1].revents)
            link->stop_by_ns = now_ns + STOP_NS;
        if (count > 0 && fds[0].revents)
            return true;
    }
}

static bool flush(struct postgres_link *link)
{
    const int64_t until_ns = clock_mono_ns() + link->answer_ns;
    for (int left; (left = PQflush(link->library)) != 0;)
        if (left < 0 || !PQconsumeInput(link->library))
            return fail_as_library(link);
        else if (!wait_for(link, POLLIN | POLLOUT, until_ns))
            return false;
    return true;
}

/* Returns the next result of a query. NULL with *good true: there are no more; NULL with *good false: the connection failed. */
static PGresult *next_result(struct postgres_link *link, bool *good)
{
    const int64_t until_ns = clock_mono_ns() + link->answer_ns;
    *good = true;
    while (*good && PQisBusy(link->library))
        if (!wait_for(link, POLLIN, until_ns))
            *good = false;
        else if (!PQconsumeInput(link->library))
            *good = fail_as_library(link);
    return *good ? PQgetResult(link->library) : NULL;
}

static bool is_good(const PGresult *result)
{
    ExecStatusType status = PQresultStatus(result);
    return status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK || status == PGRES_COPY_IN || status == PGRES_EMPTY_QUERY;
}

/* Reads all results of a query. Returns the last one, or NULL if any result is an error. */
static PGresult *last_result(struct postgres_link *link)
{
    PGresult *last = NULL;
    bool good = flush(link), failed = !good;
    for (PGresult *next; good && (next = next_result(link, &good)); last = next) {
        PQclear(last);
        if (!is_good(next) && !failed)
            failed = !fail(link, PQresultErrorMessage(next));
        if (PQresultStatus(next) == PGRES_COPY_IN) {
            last = next;
            break;
        }
    }
    if (good && !failed && last)
        return last;
    if (good && !failed)
        fail_as_library(link);
    PQclear(last);
    return NULL;
}

/* --- connecting --------------------------------------------------------------------------------------------------------------- */

static void ignore_notice(void *arg, const PGresult *result)
{
    (void)arg;
    (void)result;
}

static bool connect_now(struct postgres_link *link)
{
    const int64_t until_ns = clock_mono_ns() + link->connect_ns;
    if (PQstatus(link->library) == CONNECTION_BAD)
        return fail_as_library(link);
    PQsetNoticeReceiver(link->library, ignore_notice, NULL);
    for (PostgresPollingStatusType next = PGRES_POLLING_WRITING; next != PGRES_POLLING_OK; next = PQconnectPoll(link->library))
        if (next == PGRES_POLLING_FAILED)
            return fail_as_library(link);
        else if (!wait_for(link, next == PGRES_POLLING_READING ? POLLIN : POLLOUT, until_ns))
            return false;
    return (PQsetnonblocking(link->library, 1) == 0 || fail_as_library(link)) && postgres_link_run(link, set_up);
}

struct postgres_link *postgres_link_open(const struct plant_postgres *postgres, int stop_fd, char why[POSTGRES_WHY_BYTES])
{
    return postgres_link_open_within(postgres, stop_fd, 0, why);
}

struct postgres_link *postgres_link_open_within(const struct plant_postgres *postgres, int stop_fd, int64_t patience_ns,
                                                char why[POSTGRES_WHY_BYTES])
{
    struct login_file login = { 0 };
    if (postgres->login && !login_file_read(postgres->login, &login, why))
        return NULL;
    struct postgres_link *link = mem_new(sizeof(*link));
    const char *keys[] = { "dbname",           "fallback_application_name",
                           "keepalives_idle",  "keepalives_interval",
                           "keepalives_count", "tcp_user_timeout",
                           "client_encoding",  login.user ? "user" : NULL,
                           "password",         NULL };
    const char *values[] = { postgres->url, "plantcast", "10", "5", "3", "30000", "UTF8", login.user, login.password, NULL };
    link->stop_fd = stop_fd;
    link->connect_ns = patience_ns ? patience_ns : CONNECT_NS;
    link->answer_ns = patience_ns ? patience_ns : ANSWER_NS;
    link->library = PQconnectStartParams(keys, values, 1);
    login_file_forget(&login);
    if (link->library ? connect_now(link) : fail(link, "out of memory"))
        return link;
    snprintf(why, POSTGRES_WHY_BYTES, "%s", link->why);
    postgres_link_close(&link);
    return NULL;
}

void postgres_link_close(struct postgres_link **link)
{
    if (!*link)
        return;
    PQfinish((*link)->library);
    mem_free((*link)->copy.at);
    mem_free(*link);
    *link = NULL;
}

void postgres_link_set_patience(struct postgres_link *link, int64_t patience_ns)
{
    link->answer_ns = patience_ns;
}

const char *postgres_link_why(const struct postgres_link *link)
{
    return link->why;
}

/* --- statements --------------------------------------------------------------------------------------------------------------- */

bool postgres_link_run(struct postgres_link *link, const char *sql)
{
    PGresult *result = PQsendQuery(link->library, sql) ? last_result(link) : NULL;
    bool good = result || (*link->why ? false : fail_as_library(link));
    PQclear(result);
    return good;
}

bool postgres_link_runf(struct postgres_link *link, const char *fmt, ...)
{
    va_list args;
    char *sql;
    va_start(args, fmt);
    bool good = vasprintf(&sql, fmt, args) >= 0;
    va_end(args);
    good = good && postgres_link_run(link, sql);
    free(sql);
    return good;
}

PGresult *postgres_link_ask(struct postgres_link *link, const char *sql, int count, const char *const *parameters)
{
    if (PQsendQueryParams(link->library, sql, count, NULL, parameters, NULL, NULL, 1))
        return last_result(link);
    fail_as_library(link);
    return NULL;
}

/* --- COPY --------------------------------------------------------------------------------------------------------------------- */

static void put(struct postgres_link *link, const void *bytes, size_t count)
{
    mem_grow(&link->copy.at, &link->copy.capacity, link->copy.length + count, 1);
    memcpy(link->copy.at + link->copy.length, bytes, count);
    link->copy.length += count;
}

static void put_int32(struct postgres_link *link, int32_t value)
{
    uint32_t big = htobe32((uint32_t)value);
    put(link, &big, sizeof(big));
}

static void put_int64(struct postgres_link *link, int64_t value)
{
    uint64_t big = htobe64((uint64_t)value);
    put(link, &big, sizeof(big));
}

bool postgres_copy_begin(struct postgres_link *link, const char *table)
{
    /* file header of COPY BINARY; the zeros after the signature are the flags and the length of the header extension */
    static const char head[19] = "PGCOPY\n\377\r\n\0";
    link->copy.length = 0;
    put(link, head, sizeof(head));
    return postgres_link_runf(link, "COPY %s FROM STDIN (FORMAT binary)", table);
}

void postgres_copy_row(struct postgres_link *link, int columns)
{
    uint16_t big = htobe16((uint16_t)columns);
    put(link, &big, sizeof(big));
}

void postgres_copy_int32(struct postgres_link *link, int32_t value)
{
    put_int32(link, sizeof(value));
    put_int32(link, value);
}

void postgres_copy_int64(struct postgres_link *link, int64_t value)
{
    put_int32(link, sizeof(value));
    put_int64(link, value);
}

void postgres_copy_time(struct postgres_link *link, int64_t t_us)
{
    postgres_copy_int64(link, t_us - EPOCH_US);
}

void postgres_copy_double(struct postgres_link *link, double value)
{
    int64_t bits;
    memcpy(&bits, &value, sizeof(bits));
    if (isnan(value))
        put_int32(link, -1);
    else
        postgres_copy_int64(link, bits);
}

void postgres_copy_text(struct postgres_link *link, const char *text)
{
    put_int32(link, (int32_t)strlen(text));
    put(link, text, strlen(text));
}

void postgres_copy_bool(struct postgres_link *link, bool value)
{
    put_int32(link, 1);
    put(link, &(char){ value }, 1);
}

bool postgres_copy_end(struct postgres_link *link)
{
    const int64_t until_ns = clock_mono_ns() + link->answer_ns;
    int put_now;
    postgres_copy_row(link, -1);
    while ((put_now = PQputCopyData(link->library, link->copy.at, (int)link->copy.length)) == 0)
        if (!wait_for(link, POLLOUT, until_ns))
            return false;
    while (put_now == 1 && (put_now = PQputCopyEnd(link->library, NULL)) == 0)
        if (!wait_for(link, POLLOUT, until_ns))
            return false;
    PGresult *result = put_now == 1 ? last_result(link) : NULL;
    bool good = result || (put_now != 1 ? fail_as_library(link) : false);
    PQclear(result);
    return good;
}

/* --- rows --------------------------------------------------------------------------------------------------------------------- */

int32_t postgres_int32(const PGresult *result, int row, int column)
{
    uint32_t big = 0;
    if (PQgetlength(result, row, column) == sizeof(big))
        memcpy(&big, PQgetvalue(result, row, column), sizeof(big));
    return (int32_t)be32toh(big);
}

int64_t postgres_int64(const PGresult *result, int row, int column)
{
    uint64_t big = 0;
    if (PQgetlength(result, row, column) == sizeof(big))
        memcpy(&big, PQgetvalue(result, row, column), sizeof(big));
    return (int64_t)be64toh(big);
}

int64_t postgres_time(const PGresult *result, int row, int column)
{
    return postgres_int64(result, row, column) + EPOCH_US;
}

double postgres_double(const PGresult *result, int row, int column)
{
    int64_t bits = postgres_int64(result, row, column);
    double value;
    memcpy(&value, &bits, sizeof(value));
    return PQgetisnull(result, row, column) ? NAN : value;
}
