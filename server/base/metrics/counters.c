/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named numbers for /metrics. */
#include "base/metrics/counters.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdbool.h>
#include <string.h>

#include "base/mem.h"

struct counter_entry {
    char *name, *type, *help;
    counter value;
    bool microseconds;           /* true: the number is in microseconds but printed in seconds */
    struct histogram *histogram; /* histogram of durations; NULL: the metric is a single value */
    struct counter_entry *next;
};

struct counters {
    pthread_mutex_t lock;
    /* --- below: protected by `lock`; entries are never removed --- */
    struct counter_entry *first, **last;
};

struct counters *counters_create(void)
{
    struct counters *counters = mem_new(sizeof(*counters));
    pthread_mutex_init(&counters->lock, NULL);
    counters->last = &counters->first;
    return counters;
}

void counters_destroy(struct counters **counters)
{
    if (!*counters)
        return;
    for (struct counter_entry *e = (*counters)->first, *next; e; e = next) {
        next = e->next;
        mem_free(e->name);
        mem_free(e->type);
        mem_free(e->help);
        mem_free(e->histogram);
        mem_free(e);
    }
    pthread_mutex_destroy(&(*counters)->lock);
    mem_free(*counters);
    *counters = NULL;
}

static struct counter_entry *find_or_add(struct counters *counters, const char *name, const char *type, const char *help)
{
    bool distribution = !strcmp(type, "histogram");
    pthread_mutex_lock(&counters->lock);
    struct counter_entry *e = counters->first;
    while (e && strcmp(e->name, name) != 0)
        e = e->next;
    if (!e) {
        e = mem_new(sizeof(*e));
        e->name = mem_strdup(name);
        e->type = mem_strdup(type);
        e->help = mem_strdup(help);
        e->histogram = distribution ? mem_new(sizeof(*e->histogram)) : NULL;
        *counters->last = e;
        counters->last = &e->next;
    }
    pthread_mutex_unlock(&counters->lock);
    return e;
}

counter *counters_add(struct counters *counters, const char *name, const char *type, const char *help)
{
    return &find_or_add(counters, name, type, help)->value;
}

struct histogram *counters_add_histogram(struct counters *counters, const char *name, const char *help)
{
    return find_or_add(counters, name, "histogram", help)->histogram;
}

counter *counters_add_seconds(struct counters *counters, const char *name, const char *type, const char *help)
{
    struct counter_entry *e = find_or_add(counters, name, type, help);
    e->microseconds = true;
    return &e->value;
}

static size_t family_length(const char *name)
{
    return strcspn(name, "{");
}

static bool same_family(const struct counter_entry *a, const struct counter_entry *b)
{
    size_t n = family_length(a->name);
    return n == family_length(b->name) && !strncmp(a->name, b->name, n);
}

static bool family_printed(const struct counter_entry *first, const struct counter_entry *e)
{
    for (; first != e; first = first->next)
        if (same_family(first, e))
            return true;
    return false;
}

static void print_entry(struct counter_entry *e, struct text *out)
{
    int64_t value = atomic_load_explicit(&e->value, memory_order_relaxed);
    if (e->histogram)
        histogram_print(e->histogram, e->name, out);
    else if (e->microseconds)
        text_add(out, "%s %.6f\n", e->name, (double)value / 1e6);
    else
        text_add(out, "%s %" PRId64 "\n", e->name, value);
}

void counters_print(struct counters *counters, struct text *out)
{
    pthread_mutex_lock(&counters->lock);
    for (struct counter_entry *e = counters->first; e; e = e->next) {
        if (family_printed(counters->first, e))
            continue;
        int n = (int)family_length(e->name);
        text_add(out, "# HELP %.*s %s\n# TYPE %.*s %s\n", n, e->name, e->help, n, e->name, e->type);
        for (struct counter_entry *f = e; f; f = f->next)
            if (same_family(e, f))
                print_entry(f, out);
    }
    pthread_mutex_unlock(&counters->lock);
}
