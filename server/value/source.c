/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kinds of sources (Modbus, MQTT and so on), and functions that start and end a source's thread. */
#include "value/source.h"

#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/mem.h"
#include "value/source_impl.h"

static const struct source_impl *const table[] = {
    &modbus_impl,
    &mqtt_impl,
    &replay_impl,
#ifdef PLANTCAST_OPCUA
    &opcua_impl,
#endif
};

static const struct source_impl *find_impl(const char *kind)
{
    for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
        if (!strcmp(table[i]->kind, kind))
            return table[i];
    return NULL;
}

static void *thread_main(void *arg)
{
    struct source *source = arg;
    source->impl->run(source);
    return NULL;
}

struct source *source_begin(const struct source *params, const char *what, struct counters *counters)
{
    struct source base = *params;
    base.stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (base.stop_fd < 0) {
        log_err(base.log, "%s: cannot create an eventfd: %s", what, strerror(errno));
        return NULL;
    }
    struct source *made = base.impl->create(&base, counters);
    if (!made) {
        close(base.stop_fd);
        return NULL;
    }
    int error = pthread_create(&made->thread, NULL, thread_main, made);
    made->has_thread = !error;
    if (error) {
        log_err(base.log, "%s: cannot start a thread: %s", what, strerror(error));
        source_stop(&made);
    }
    return made;
}

struct source *source_start(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters)
{
    const struct plant_source *config = &plant->sources[source];
    const struct source base = {
        .impl = find_impl(config->kind), .log = log, .plant = plant, .config = config, .index = source, .store = store
    };
    if (!base.impl) {
        log_err(log, "source %s: unknown kind %s", config->id, config->kind);
        return NULL;
    }
    char *what = mem_printf("source %s", config->id);
    struct source *made = source_begin(&base, what, counters);
    mem_free(what);
    return made;
}

void source_stop(struct source **source_ptr)
{
    struct source *source = *source_ptr;
    if (!source)
        return;
    int stop_fd = source->stop_fd;
    if (source->has_thread) {
        eventfd_write(stop_fd, 1);
        if (source->impl->interrupt)
            source->impl->interrupt(source);
        pthread_join(source->thread, NULL);
    }
    source->impl->destroy(source);
    close(stop_fd);
    *source_ptr = NULL;
}
