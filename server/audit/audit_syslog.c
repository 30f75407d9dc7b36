/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends audit lines to a syslog server over TLS, through libcurl. */
#include "audit/audit_syslog.h"

#include <curl/curl.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/timestamp.h"

enum { MAX_QUEUED = 10000, TIMEOUT_S = 10, UNANSWERED_MS = 30000, AUDIT_FACILITY = 13, NOTICE = 5, WARNING = 4 };
static const int64_t RETRY_NS = 2 * NS_PER_S, LAST_NS = 3 * NS_PER_S;
/* A line counts as delivered if the connection is still open this long after sending it. Syslog has no acknowledgements, and
   with TLS 1.3 a server may refuse our certificate after our side has completed the handshake. */
static const int64_t PROOF_NS = 5 * NS_PER_S;
/* how often the connection to the syslog server is checked while lines sent over it are not yet delivered */
static const int64_t CHECK_NS = NS_PER_S / 4;

struct framed {
    struct text text;
    int64_t sent_ns; /* monotonic time when the audit line was sent to the syslog server */
    struct framed *next;
};

struct lines {
    struct framed *first, **last;
};

struct audit_syslog {
    struct audit_params params;
    char *url, host[256];
    pthread_t thread;
    counter *good, *lost;
    /* --- below: members that only the syslog thread uses */
    CURL *connection;          /* libcurl handle of the connection to the syslog server; NULL: not connected */
    char why[CURL_ERROR_SIZE]; /* libcurl's text for the last error on the connection to the syslog server */
    struct lines sent;         /* lines sent over the connection but not yet delivered; requeued if the connection breaks */
    bool proven;               /* true: at least one audit line was delivered over the present connection */
    int refusals;              /* number of consecutive connections that the syslog server closed before an audit line was delivered */
    bool failing;              /* true: the syslog server is unreachable or accepts no lines */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: protected by `lock` */
    struct lines queue; /* audit lines to be sent to the syslog server; only the syslog thread removes lines */
    size_t waiting;     /* number of audit lines in `queue` and `sent` together */
    int64_t stop_ns;    /* monotonic deadline by which the syslog thread must end; 0: it need not end */
};

/* --- lists of lines ------------------------------------------------------------------------------------------------------- */

static void lines_add(struct lines *lines, struct framed *line)
{
    line->next = NULL;
    *lines->last = line;
    lines->last = &line->next;
}

static struct framed *lines_take(struct lines *lines)
{
    struct framed *first = lines->first;
    lines->first = first->next;
    if (!lines->first)
        lines->last = &lines->first;
    return first;
}

/* Moves all audit lines of the list `from` to the front of the list `lines`. */
static void lines_put_back(struct lines *lines, struct lines *from)
{
    if (!from->first)
        return;
    *from->last = lines->first;
    if (!lines->first)
        lines->last = from->last;
    lines->first = from->first;
    *from = (struct lines){ .last = &from->first };
}

static void lines_drop_first(struct lines *lines)
{
    struct framed *first = lines_take(lines);
    text_finish(&first->text);
    mem_free(first);
}

void audit_syslog_frame(struct text *out, const struct syslog_message *message)
{
    char at[TIMESTAMP_BYTES];
    timestamp_print(message->utc_us, at);
    char *head = mem_printf("<%d>1 %s %s plantcastd %d %s - ", AUDIT_FACILITY * 8 + (message->good ? NOTICE : WARNING), at, message->host,
                            message->pid, message->event);
    text_add(out, "%zu %s", strlen(head) + message->count, head);
    text_add_bytes(out, message->line, message->count);
    mem_free(head);
}

/* --- the connection ------------------------------------------------------------------------------------------------------- */

/* Closes the connection. Lines that were sent but not delivered are queued again. */
static void disconnect(struct audit_syslog *syslog)
{
    curl_easy_cleanup(syslog->connection);
    syslog->connection = NULL;
    syslog->proven = false;
    pthread_mutex_lock(&syslog->lock);
    lines_put_back(&syslog->queue, &syslog->sent);
    pthread_mutex_unlock(&syslog->lock);
}

/* Logs the first failure to reach the syslog server after a success. what: for example "cannot be reached"; why: libcurl's
   error. */
static void report_failure(struct audit_syslog *syslog, const char *what, const char *why)
{
    if (!syslog->failing)
        log_event(syslog->params.log, LOG_ERROR, EVENT_AUDIT_NOT_SENT,
                  "audit: syslog server %s %s: %s; audit lines are queued and sent later", syslog->params.syslog, what, why);
    syslog->failing = true;
    counter_set(syslog->good, 0);
}

static void report_success(struct audit_syslog *syslog)
{
    if (syslog->failing)
        log_info(syslog->params.log, "audit: syslog server %s accepts audit lines again", syslog->params.syslog);
    syslog->failing = false;
    counter_set(syslog->good, 1);
}

static const char *error_of(const struct audit_syslog *syslog, CURLcode code)
{
    return syslog->why[0] ? syslog->why : curl_easy_strerror(code);
}

static curl_socket_t socket_of(const struct audit_syslog *syslog)
{
    curl_socket_t fd = -1;
    curl_easy_getinfo(syslog->connection, CURLINFO_ACTIVESOCKET, &fd);
    return fd;
}

static bool connect_now(struct audit_syslog *syslog)
{
    const struct audit_params *params = &syslog->params;
    const unsigned unanswered_ms = UNANSWERED_MS;
    CURL *handle = syslog->connection = curl_easy_init();
    if (!handle)
        return false;
    syslog->why[0] = 0;
    curl_easy_setopt(handle, CURLOPT_URL, syslog->url);
    curl_easy_setopt(handle, CURLOPT_CONNECT_ONLY, 1L);
    curl_easy_setopt(handle, CURLOPT_SSL_ENABLE_ALPN, 0L);
    curl_easy_setopt(handle, CURLOPT_PROXY, "");
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_QUICK_EXIT, 1L);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)TIMEOUT_S);
    curl_easy_setopt(handle, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, syslog->why);
    if (params->syslog_ca)
        curl_easy_setopt(handle, CURLOPT_CAINFO, params->syslog_ca);
    if (params->syslog_cert) {
        curl_easy_setopt(handle, CURLOPT_SSLCERT, params->syslog_cert);
        curl_easy_setopt(handle, CURLOPT_SSLKEY, params->syslog_key);
    }
    CURLcode code = curl_easy_perform(handle);
    if (code == CURLE_OK) {
        /* breaks the connection if the server's machine does not acknowledge our bytes; by default the system would wait many minutes */
        setsockopt(socket_of(syslog), IPPROTO_TCP, TCP_USER_TIMEOUT, &unanswered_ms, sizeof(unanswered_ms));
        return true;
    }
    syslog->refusals = 0;
    report_failure(syslog, "cannot be reached", error_of(syslog, code));
    disconnect(syslog);
    return false;
}

/* Returns why the connection to the syslog server ended; NULL: it is open. */
static const char *why_closed(struct audit_syslog *syslog)
{
    char byte;
    size_t n = 0;
    CURLcode code = curl_easy_recv(syslog->connection, &byte, 1, &n);
    if (code == CURLE_OK && n == 0)
        return "the server closed the connection";
    return code == CURLE_OK || code == CURLE_AGAIN ? NULL : error_of(syslog, code);
}

/* Removes the lines that count as delivered: those sent more than PROOF_NS ago, if the server's machine has acknowledged all bytes. */
static void drop_delivered(struct audit_syslog *syslog, int64_t now_ns)
{
    int unacknowledged = 0;
    if (ioctl(socket_of(syslog), SIOCOUTQ, &unacknowledged) != 0 || unacknowledged > 0)
        return;
    while (syslog->sent.first && syslog->sent.first->sent_ns + PROOF_NS <= now_ns) {
        lines_drop_first(&syslog->sent);
        pthread_mutex_lock(&syslog->lock);
        syslog->waiting--;
        pthread_mutex_unlock(&syslog->lock);
        syslog->proven = true;
        syslog->refusals = 0;
        report_success(syslog);
    }
}

/* Closes a connection that has ended, and removes delivered lines. Returns false if the server closed this connection and the
   previous one before any line was delivered: the caller must then wait before it reconnects. A server that shuts down closes
   only one. */
static bool check_connection(struct audit_syslog *syslog)
{
    const char *why = syslog->connection ? why_closed(syslog) : NULL;
    bool refused = why && syslog->sent.first && !syslog->proven && ++syslog->refusals > 1;
    if (refused)
        report_failure(syslog, "does not accept audit lines; check --audit-cert and the certificates that the server permits", why);
    if (why)
        disconnect(syslog);
    else if (syslog->connection)
        drop_delivered(syslog, clock_mono_ns());
    return !refused;
}

static bool send_all(struct audit_syslog *syslog, const struct text *text)
{
    size_t at = 0;
    while (at < text->length) {
        size_t n = 0;
        CURLcode code = curl_easy_send(syslog->connection, text->at + at, text->length - at, &n);
        at += n;
        struct pollfd ready = { .fd = socket_of(syslog), .events = POLLOUT };
        if (code == CURLE_AGAIN && poll(&ready, 1, TIMEOUT_S * 1000) == 1)
            continue;
        if (code != CURLE_OK) {
            report_failure(syslog, "cannot be written to", error_of(syslog, code));
            return false;
        }
    }
    return true;
}

/* Sends the first audit line of the queue, if any, to the syslog server. */
static bool send_next(struct audit_syslog *syslog)
{
    pthread_mutex_lock(&syslog->lock);
    struct framed *first = syslog->queue.first;
    pthread_mutex_unlock(&syslog->lock);
    if (!first)
        return true;
    if (!syslog->connection && !connect_now(syslog))
        return false;
    /* the audit line stays valid without the lock, because only this thread removes lines from the queue */
    if (!send_all(syslog, &first->text)) {
        disconnect(syslog);
        return false;
    }
    pthread_mutex_lock(&syslog->lock);
    lines_add(&syslog->sent, lines_take(&syslog->queue));
    pthread_mutex_unlock(&syslog->lock);
    first->sent_ns = clock_mono_ns();
    return true;
}

/* --- the thread ----------------------------------------------------------------------------------------------------------- */

/* Returns true if the thread must end: all lines are sent and their connection has proven to deliver, or the time is up. */
static bool must_end(const struct audit_syslog *syslog)
{
    bool open = syslog->queue.first || (syslog->sent.first && !syslog->proven);
    return syslog->stop_ns && (!open || clock_mono_ns() >= syslog->stop_ns);
}

static void *audit_syslog_main(void *arg)
{
    struct audit_syslog *syslog = arg;
    pthread_mutex_lock(&syslog->lock);
    for (;;) {
        while (!syslog->queue.first && !syslog->sent.first && !syslog->stop_ns)
            pthread_cond_wait(&syslog->wake, &syslog->lock);
        if (must_end(syslog))
            break;
        pthread_mutex_unlock(&syslog->lock);
        bool good = check_connection(syslog) && send_next(syslog);
        pthread_mutex_lock(&syslog->lock);
        if (!good && syslog->stop_ns)
            break;
        if (!good)
            clock_cond_wait(&syslog->wake, &syslog->lock, clock_mono_ns() + RETRY_NS);
        else if (!syslog->queue.first && !must_end(syslog))
            clock_cond_wait(&syslog->wake, &syslog->lock, clock_mono_ns() + CHECK_NS);
    }
    pthread_mutex_unlock(&syslog->lock);
    while (syslog->proven && syslog->sent.first)
        lines_drop_first(&syslog->sent);
    disconnect(syslog);
    return NULL;
}

void audit_syslog_send(struct audit_syslog *syslog, const char *event, bool good, int64_t utc_us, const char *line, size_t count)
{
    pthread_mutex_lock(&syslog->lock);
    if (syslog->waiting >= MAX_QUEUED) {
        counter_inc(syslog->lost, 1);
    } else {
        struct framed *framed = mem_new(sizeof(*framed));
        const struct syslog_message message = { syslog->host, (int)getpid(), event, good, utc_us, line, count };
        audit_syslog_frame(&framed->text, &message);
        /* the syslog thread needs no signal while older lines wait: it is sending, or waiting to reconnect */
        if (!syslog->queue.first)
            pthread_cond_signal(&syslog->wake);
        lines_add(&syslog->queue, framed);
        syslog->waiting++;
    }
    pthread_mutex_unlock(&syslog->lock);
}

struct audit_syslog *audit_syslog_start(const struct audit_params *params)
{
    struct audit_syslog *syslog = mem_new(sizeof(*syslog));
    const char *end = strrchr(params->syslog, ']'), *colon = strchr(end ? end : params->syslog, ':');
    *syslog = (struct audit_syslog){ .params = *params };
    syslog->sent.last = &syslog->sent.first;
    syslog->queue.last = &syslog->queue.first;
    syslog->url = mem_printf("https://%s%s", params->syslog, colon ? "" : ":6514");
    if (gethostname(syslog->host, sizeof(syslog->host) - 1) != 0 || !syslog->host[0] || strpbrk(syslog->host, " \t"))
        strcpy(syslog->host, "-");
    syslog->good = counters_add(params->counters, "plantcast_audit_syslog_good", "gauge", "1 while the syslog server accepts audit lines.");
    syslog->lost = counters_add(params->counters, "plantcast_audit_syslog_lost_total", "counter",
                                "Audit lines not sent to the syslog server: queue full.");
    counter_set(syslog->good, 1);
    pthread_mutex_init(&syslog->lock, NULL);
    clock_cond_init(&syslog->wake);
    if (curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK && pthread_create(&syslog->thread, NULL, audit_syslog_main, syslog) == 0)
        return syslog;
    log_err(params->log, "audit: cannot start sending to the syslog server: libcurl or a thread cannot be started");
    mem_free(syslog->url);
    mem_free(syslog);
    return NULL;
}

void audit_syslog_stop(struct audit_syslog **pointer)
{
    struct audit_syslog *syslog = *pointer;
    if (!syslog)
        return;
    pthread_mutex_lock(&syslog->lock);
    syslog->stop_ns = clock_mono_ns() + LAST_NS;
    pthread_cond_signal(&syslog->wake);
    pthread_mutex_unlock(&syslog->lock);
    pthread_join(syslog->thread, NULL);
    size_t left = 0;
    for (; syslog->queue.first; left++)
        lines_drop_first(&syslog->queue);
    if (left)
        log_event(syslog->params.log, LOG_ERROR, EVENT_AUDIT_NOT_SENT,
                  "audit: the last %zu audit lines were not delivered to syslog server %s; they are only in %s", left,
                  syslog->params.syslog, syslog->params.path);
    pthread_cond_destroy(&syslog->wake);
    pthread_mutex_destroy(&syslog->lock);
    mem_free(syslog->url);
    mem_free(syslog);
    *pointer = NULL;
}
