/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends audit lines to a syslog server over TLS; libcurl makes the connection. */
#include "audit/audit_syslog.h"

#include <curl/curl.h>
#include <poll.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/timestamp.h"

enum { MAX_QUEUED = 10000, TIMEOUT_S = 10, AUDIT_FACILITY = 13, NOTICE = 5, WARNING = 4 };
static const int64_t RETRY_NS = 2 * NS_PER_S, LAST_NS = 3 * NS_PER_S;

struct framed {
    struct text text;
    struct framed *next;
};

struct audit_syslog {
    struct audit_params params;
    char *url, host[256];
    pthread_t thread;
    counter *good, *lost;
    CURL *connection; /* libcurl's handle of the connection, used only by the thread; NULL: not connected */
    bool failing;     /* used only by the thread: true while the oldest queued line could not be sent */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: protected by `lock` */
    struct framed *first, **last;
    size_t waiting;
    int64_t stop_ns; /* monotonic time at which the thread must end; 0: it need not end */
};

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

static void disconnect(struct audit_syslog *syslog)
{
    curl_easy_cleanup(syslog->connection);
    syslog->connection = NULL;
}

static void say(struct audit_syslog *syslog, const char *why)
{
    if (why && !syslog->failing)
        log_event(syslog->params.log, LOG_ERROR, EVENT_AUDIT_NOT_SENT,
                  "audit: syslog server %s cannot be reached: %s; audit lines are queued and sent later", syslog->params.syslog, why);
    else if (!why && syslog->failing)
        log_info(syslog->params.log, "audit: syslog server %s accepts audit lines again", syslog->params.syslog);
    syslog->failing = why != NULL;
    counter_set(syslog->good, !syslog->failing);
}

static bool connect_now(struct audit_syslog *syslog)
{
    const struct audit_params *params = &syslog->params;
    char why[CURL_ERROR_SIZE] = "";
    CURL *handle = syslog->connection = curl_easy_init();
    if (!handle)
        return false;
    curl_easy_setopt(handle, CURLOPT_URL, syslog->url);
    curl_easy_setopt(handle, CURLOPT_CONNECT_ONLY, 1L);
    curl_easy_setopt(handle, CURLOPT_SSL_ENABLE_ALPN, 0L);
    curl_easy_setopt(handle, CURLOPT_PROXY, "");
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_QUICK_EXIT, 1L);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)TIMEOUT_S);
    curl_easy_setopt(handle, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, why);
    if (params->syslog_ca)
        curl_easy_setopt(handle, CURLOPT_CAINFO, params->syslog_ca);
    if (params->syslog_cert) {
        curl_easy_setopt(handle, CURLOPT_SSLCERT, params->syslog_cert);
        curl_easy_setopt(handle, CURLOPT_SSLKEY, params->syslog_key);
    }
    CURLcode code = curl_easy_perform(handle);
    if (code == CURLE_OK)
        return true;
    say(syslog, why[0] ? why : curl_easy_strerror(code));
    disconnect(syslog);
    return false;
}

/* Returns true if the connection is still open. Called before each line, because a line sent to a server that has closed the connection
   would be lost unnoticed. */
static bool is_alive(CURL *connection)
{
    char byte;
    size_t n = 0;
    CURLcode code = curl_easy_recv(connection, &byte, 1, &n);
    return code == CURLE_AGAIN || (code == CURLE_OK && n > 0);
}

static bool send_all(struct audit_syslog *syslog, const struct text *text)
{
    curl_socket_t fd = -1;
    size_t at = 0;
    curl_easy_getinfo(syslog->connection, CURLINFO_ACTIVESOCKET, &fd);
    while (at < text->length) {
        size_t n = 0;
        CURLcode code = curl_easy_send(syslog->connection, text->at + at, text->length - at, &n);
        at += n;
        struct pollfd ready = { .fd = fd, .events = POLLOUT };
        if (code == CURLE_AGAIN && poll(&ready, 1, TIMEOUT_S * 1000) == 1)
            continue;
        if (code != CURLE_OK) {
            say(syslog, curl_easy_strerror(code));
            return false;
        }
    }
    return true;
}

static bool deliver(struct audit_syslog *syslog, const struct text *text)
{
    if (syslog->connection && !is_alive(syslog->connection))
        disconnect(syslog);
    if (!syslog->connection && !connect_now(syslog))
        return false;
    bool sent = send_all(syslog, text);
    if (sent)
        say(syslog, NULL);
    else
        disconnect(syslog);
    return sent;
}

/* --- the thread ----------------------------------------------------------------------------------------------------------- */

static void free_first(struct audit_syslog *syslog)
{
    struct framed *first = syslog->first;
    syslog->first = first->next;
    if (!syslog->first)
        syslog->last = &syslog->first;
    syslog->waiting--;
    text_finish(&first->text);
    mem_free(first);
}

static void *audit_syslog_main(void *arg)
{
    struct audit_syslog *syslog = arg;
    pthread_mutex_lock(&syslog->lock);
    for (;;) {
        while (!syslog->first && !syslog->stop_ns)
            pthread_cond_wait(&syslog->wake, &syslog->lock);
        if (syslog->stop_ns && (!syslog->first || clock_mono_ns() >= syslog->stop_ns))
            break;
        /* the line stays valid without the lock, because only this thread removes lines from the queue */
        struct framed *first = syslog->first;
        pthread_mutex_unlock(&syslog->lock);
        bool sent = deliver(syslog, &first->text);
        pthread_mutex_lock(&syslog->lock);
        if (sent)
            free_first(syslog);
        else if (!syslog->stop_ns)
            clock_cond_wait(&syslog->wake, &syslog->lock, clock_mono_ns() + RETRY_NS);
        else
            break;
    }
    pthread_mutex_unlock(&syslog->lock);
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
        *syslog->last = framed;
        syslog->last = &framed->next;
        if (syslog->waiting++ == 0)
            pthread_cond_signal(&syslog->wake);
    }
    pthread_mutex_unlock(&syslog->lock);
}

struct audit_syslog *audit_syslog_start(const struct audit_params *params)
{
    struct audit_syslog *syslog = mem_new(sizeof(*syslog));
    const char *end = strrchr(params->syslog, ']'), *colon = strchr(end ? end : params->syslog, ':');
    *syslog = (struct audit_syslog){ .params = *params, .last = &syslog->first };
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
    while (syslog->first)
        free_first(syslog);
    pthread_cond_destroy(&syslog->wake);
    pthread_mutex_destroy(&syslog->lock);
    mem_free(syslog->url);
    mem_free(syslog);
    *pointer = NULL;
}
