/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends datagrams to systemd: sd_notify(3) and the native journal protocol. */
#include "base/system/service_manager.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/text.h"

enum {
    FIRST_SOCKET = 3 /* number of the first descriptor that systemd passes: sd_listen_fds(3) */,
    EXTENSION_S = 60,
    EXTENSION_INTERVAL_S = 5,
    /* minimum number of requests for more start time within limit_s, the start's time limit in seconds; a short limit_s makes
       the interval between requests shorter than EXTENSION_INTERVAL_S */
    MIN_EXTENSIONS = 60
};
/* CPU time in nanoseconds: if the processes used less than this between two checks, they count as idle */
static const int64_t AT_WORK_NS = 20 * NS_PER_MS;

/* Sends a datagram to a Unix socket. path: path of the socket's file, or @NAME for an abstract socket. Returns false if it was not
   delivered. */
static bool send_to(const char *path, const char *bytes, size_t count)
{
    struct sockaddr_un to = { .sun_family = AF_UNIX };
    size_t length = strlen(path);
    if (length < 2 || length >= sizeof(to.sun_path) || (path[0] != '/' && path[0] != '@'))
        return false;
    memcpy(to.sun_path, path, length);
    if (path[0] == '@')
        to.sun_path[0] = 0;
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0)
        return false;
    ssize_t sent;
    do
        sent = sendto(fd, bytes, count, MSG_NOSIGNAL, (struct sockaddr *)&to, (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length));
    while (sent < 0 && errno == EINTR);
    close(fd);
    return sent == (ssize_t)count;
}

/* --- notification ----------------------------------------------------------------------------------------------------- */

bool service_notify(const char *fmt, ...)
{
    const char *path = getenv("NOTIFY_SOCKET");
    struct text text = { 0 };
    va_list ap;
    if (!path)
        return false;
    va_start(ap, fmt);
    text_add_v(&text, fmt, ap);
    va_end(ap);
    bool good = send_to(path, text.at, text.length);
    text_finish(&text);
    return good;
}

int64_t service_watchdog_ns(void)
{
    const char *us = getenv("WATCHDOG_USEC"), *pid = getenv("WATCHDOG_PID");
    if (!us || (pid && strtol(pid, NULL, 10) != (long)getpid()))
        return 0;
    long long value = strtoll(us, NULL, 10);
    return value > 0 && value < INT64_MAX / 1000 ? (int64_t)value * 1000 : 0;
}

int service_take_socket(void)
{
    const char *pid = getenv("LISTEN_PID"), *count = getenv("LISTEN_FDS");
    if (!pid || !count || strtol(pid, NULL, 10) != (long)getpid() || strtol(count, NULL, 10) < 1)
        return -1;
    bool one = strtol(count, NULL, 10) == 1;
    /* removes LISTEN_PID from the environment; otherwise plantcast-prep, which a reload starts, would take the socket for its own */
    unsetenv("LISTEN_PID");
    unsetenv("LISTEN_FDS");
    fcntl(FIRST_SOCKET, F_SETFD, FD_CLOEXEC);
    return one ? FIRST_SOCKET : -EINVAL;
}

struct service_patience {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    int64_t limit_ns, every_ns;
    int64_t used_ns; /* CPU time in nanoseconds that the processes had used at the last check; accessed only by this struct's thread */
    /* --- below: under `lock` */
    char *status;
    int64_t since_ns; /* monotonic time when the status text, which the service manager shows, was last set */
    bool ending;
};

/* Returns the CPU time in nanoseconds used by a process and its reaped children; 0: the process is gone, or belongs to another
   POSIX session. id: name of its entry in /proc. */
static int64_t used_by(const char *id)
{
    char path[32], line[1024];
    int session;
    unsigned long ticks[4];
    snprintf(path, sizeof(path), "/proc/%.20s/stat", id);
    FILE *file = fopen(path, "re");
    const char *after = file && fgets(line, sizeof(line), file) ? strrchr(line, ')') : NULL;
    bool known = after && sscanf(after, ") %*c %*d %*d %d %*d %*d %*u %*u %*u %*u %*u %lu %lu %lu %lu", &session, &ticks[0], &ticks[1],
                                 &ticks[2], &ticks[3]) == 5;
    if (file)
        fclose(file);
    return known && session == getsid(0) ? (int64_t)(ticks[0] + ticks[1] + ticks[2] + ticks[3]) * (NS_PER_S / sysconf(_SC_CLK_TCK)) : 0;
}

/* Returns true if any process of this session has used CPU time since the last call. */
static bool is_at_work(struct service_patience *patience)
{
    struct timespec own;
    int64_t used_ns = 0;
    DIR *folder = opendir("/proc");
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        if (entry->d_name[0] >= '1' && entry->d_name[0] <= '9')
            used_ns += used_by(entry->d_name);
    if (folder)
        closedir(folder);
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &own); /* subtracts the CPU time used by this check itself */
    used_ns -= own.tv_sec * NS_PER_S + own.tv_nsec;
    bool works = !folder || used_ns - patience->used_ns >= AT_WORK_NS;
    patience->used_ns = used_ns;
    return works;
}

/* Main function of the thread that periodically asks the service manager for more time to start. It stops asking while the
   processes use no CPU time, or once the status is too old, so that the manager kills a hanging start. */
static void *extend_start(void *arg)
{
    struct service_patience *patience = arg;
    int64_t begin_ns = clock_mono_ns(), logged_ns = begin_ns;
    bool works = true; /* true at first: even a quick start requests more time once and shows its status */
    pthread_mutex_lock(&patience->lock);
    do {
        int64_t now_ns = clock_mono_ns();
        if (works && now_ns - patience->since_ns < patience->limit_ns)
            service_notify("EXTEND_TIMEOUT_USEC=%lld\nSTATUS=%s", EXTENSION_S * 1000000ll, patience->status);
        /* writes the status to the journal, even if the start hangs */
        if (now_ns - logged_ns > EXTENSION_INTERVAL_S * NS_PER_S * 9 / 10) {
            fprintf(stderr, "%s: %s, for %.0f s so far\n", program_invocation_short_name, patience->status,
                    (double)(now_ns - begin_ns) / 1e9);
            logged_ns = now_ns;
        }
        int64_t until_ns = now_ns + patience->every_ns;
        struct timespec until = { until_ns / NS_PER_S, until_ns % NS_PER_S };
        works = patience->ending || pthread_cond_timedwait(&patience->wake, &patience->lock, &until) != ETIMEDOUT;
        if (!works)
            works = is_at_work(patience);
    } while (!patience->ending);
    pthread_mutex_unlock(&patience->lock);
    return NULL;
}

struct service_patience *service_patience_begin(const char *status, int limit_s)
{
    if (!getenv("NOTIFY_SOCKET"))
        return NULL;
    struct service_patience *patience = mem_new(sizeof(*patience));
    patience->status = mem_strdup(status);
    patience->limit_ns = limit_s * NS_PER_S;
    patience->every_ns =
        limit_s < EXTENSION_INTERVAL_S * MIN_EXTENSIONS ? patience->limit_ns / MIN_EXTENSIONS : EXTENSION_INTERVAL_S * NS_PER_S;
    patience->since_ns = clock_mono_ns();
    pthread_mutex_init(&patience->lock, NULL);
    clock_cond_init(&patience->wake);
    if (pthread_create(&patience->thread, NULL, extend_start, patience) == 0)
        return patience;
    pthread_cond_destroy(&patience->wake);
    pthread_mutex_destroy(&patience->lock);
    mem_free(patience->status);
    mem_free(patience);
    return NULL;
}

void service_patience_status(struct service_patience *patience, const char *status)
{
    if (!patience)
        return;
    pthread_mutex_lock(&patience->lock);
    mem_free(patience->status);
    patience->status = mem_strdup(status);
    patience->since_ns = clock_mono_ns();
    pthread_cond_signal(&patience->wake);
    pthread_mutex_unlock(&patience->lock);
}

void service_patience_end(struct service_patience **pointer)
{
    struct service_patience *patience = *pointer;
    if (!patience)
        return;
    pthread_mutex_lock(&patience->lock);
    patience->ending = true;
    pthread_cond_signal(&patience->wake);
    pthread_mutex_unlock(&patience->lock);
    pthread_join(patience->thread, NULL);
    pthread_cond_destroy(&patience->wake);
    pthread_mutex_destroy(&patience->lock);
    mem_free(patience->status);
    mem_free(patience);
    *pointer = NULL;
}

/* --- the journal ------------------------------------------------------------------------------------------------------ */

bool service_is_journal(int fd)
{
    const char *stream = getenv("JOURNAL_STREAM");
    unsigned long long device, inode;
    struct stat st;
    return stream && sscanf(stream, "%llu:%llu", &device, &inode) == 2 && fstat(fd, &st) == 0 && st.st_dev == (dev_t)device &&
           st.st_ino == (ino_t)inode;
}

/* Appends a field: NAME=VALUE or, if the value contains line breaks, NAME, the value's length as 8 bytes (little-endian), and the value. */
static void add_field(struct text *text, const struct service_field *field)
{
    size_t length = strlen(field->value);
    if (!strchr(field->value, '\n')) {
        text_add(text, "%s=%s\n", field->name, field->value);
        return;
    }
    unsigned char bytes[8];
    for (int i = 0; i < 8; i++)
        bytes[i] = (unsigned char)((uint64_t)length >> 8 * i);
    text_add(text, "%s\n", field->name);
    text_add_bytes(text, bytes, sizeof(bytes));
    text_add(text, "%s\n", field->value);
}

bool service_journal_send(const char *socket_path, const struct service_field *fields, size_t count)
{
    struct text text = { 0 };
    for (size_t i = 0; i < count; i++)
        if (fields[i].value)
            add_field(&text, &fields[i]);
    bool good = text.length > 0 && send_to(socket_path, text.at, text.length);
    text_finish(&text);
    return good;
}
