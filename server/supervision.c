/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports the daemon's state to the service manager, to metrics and to `plantcast reload`. */
#include "supervision.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/system/service_manager.h"
#include "commit.h"
#include "version.h"

/* interval in nanoseconds at which the render thread is checked; also the minimum time between two watchdog messages */
static const int64_t CHECK_INTERVAL_NS = 2 * NS_PER_S;
enum { START_LIMIT_S = 600 }; /* time limit in seconds for one step of the daemon's start */

struct supervision {
    struct log *log;
    struct counters *all;
    struct {
        counter *reload_good, *reloaded_s;
    } counters;
    /* object with which this daemon asks the service manager for more time to start; NULL once the start is over */
    struct service_patience *patience;
    char *runtime;                     /* runtime folder of the service; NULL: there is none */
    int64_t watchdog_ns;               /* interval in nanoseconds at which the service manager expects watchdog messages; 0: off */
    /* refused: the last reload failed; reloaded: the result of a finished reload must still be reported */
    _Atomic bool refused, reloaded;
    /* --- below: used only by the event loop */
    int64_t looked_ns;
    bool ready, stuck, said_refused;
    size_t said_sessions;
    const char *said_core; /* last reported role of this core (static text), as in struct net_status */
};

struct supervision *supervision_create(struct log *log, struct counters *counters)
{
    struct supervision *supervision = mem_new(sizeof(*supervision));
    const char *runtime = getenv("RUNTIME_DIRECTORY");
    supervision->log = log;
    supervision->all = counters;
    supervision->counters.reload_good = counters_add(counters, "plantcast_reload_good", "gauge",
                                                     "1 unless the daemon refused the last reload of its plant file and tag list.");
    supervision->counters.reloaded_s =
        counters_add(counters, "plantcast_configuration_loaded_timestamp_seconds", "gauge",
                     "Time at which the active configuration (plant file and tag list) was loaded, in seconds since 1970.");
    counter_set(supervision->counters.reload_good, 1);
    counter_set(supervision->counters.reloaded_s, clock_utc_ns() / NS_PER_S);
    counter_set(counters_add(counters, "plantcast_build_info{version=\"" PLANTCAST_VERSION "\",commit=\"" PLANTCAST_COMMIT "\"}", "gauge",
                             "Always 1; the labels name the version of this daemon."),
                1);
    if (runtime && *runtime)
        supervision->runtime = mem_printf("%.*s", (int)strcspn(runtime, ":"), runtime);
    supervision->watchdog_ns = service_watchdog_ns();
    supervision->patience = service_patience_begin("starting", START_LIMIT_S);
    return supervision;
}

void supervision_destroy(struct supervision **pointer)
{
    struct supervision *supervision = *pointer;
    if (!supervision)
        return;
    service_patience_end(&supervision->patience);
    mem_free(supervision->runtime);
    mem_free(supervision);
    *pointer = NULL;
}

void supervision_starting(struct supervision *supervision, const char *what)
{
    service_patience_status(supervision->patience, what);
}

static void say_ready(struct supervision *supervision, const char *core)
{
    service_patience_end(&supervision->patience);
    service_notify("READY=1\nSTATUS=%s", core ? core : "ready");
    supervision->ready = true;
}

static void say_status(struct supervision *supervision, size_t sessions, const char *core)
{
    bool refused = atomic_load(&supervision->refused);
    if (!atomic_exchange(&supervision->reloaded, false) && refused == supervision->said_refused && sessions == supervision->said_sessions &&
        core == supervision->said_core)
        return;
    supervision->said_refused = refused;
    supervision->said_sessions = sessions;
    supervision->said_core = core;
    service_notify("STATUS=%s%s%zu session%s%s", core ? core : "", core ? "; " : "", sessions, sessions == 1 ? "" : "s",
                   refused ? "; the last reload was refused, so an older configuration is active" : "");
}

/* Sends the watchdog message from the event loop, but only while the render thread is alive. So the service manager restarts
   the daemon if either hangs. */
static void look(struct supervision *supervision, struct render_service *render_service, int64_t now_ns)
{
    bool stuck = render_service_is_stuck(render_service, now_ns);
    if (stuck && !supervision->stuck)
        log_err(supervision->log, "the thread that draws pictures makes no progress%s",
                supervision->watchdog_ns ? "; the service manager will start the daemon again" : "");
    supervision->stuck = stuck;
    if (!stuck && supervision->watchdog_ns)
        service_notify("WATCHDOG=1");
}

void supervision_tick(struct supervision *supervision, const struct net_status *status)
{
    int64_t now_ns = clock_mono_ns(), every_ns = supervision->watchdog_ns ? supervision->watchdog_ns / 4 : CHECK_INTERVAL_NS;
    if (!supervision->ready && render_service_ready(status->render_service))
        say_ready(supervision, status->core);
    if (!supervision->ready || now_ns - supervision->looked_ns < (every_ns < CHECK_INTERVAL_NS ? every_ns : CHECK_INTERVAL_NS))
        return;
    supervision->looked_ns = now_ns;
    say_status(supervision, status->sessions, status->core);
    look(supervision, status->render_service, now_ns);
    if (status->certificate_ends_s)
        counter_set(counters_add(supervision->all, "plantcast_certificate_expiry_timestamp_seconds", "gauge",
                                 "Expiry time of this server's TLS certificate, in seconds since 1970."),
                    status->certificate_ends_s);
}

void supervision_reloaded(struct supervision *supervision, bool good, int64_t begun_ns, const char *json)
{
    atomic_store(&supervision->refused, !good);
    atomic_store(&supervision->reloaded, true);
    counter_set(supervision->counters.reload_good, good);
    if (good)
        counter_set(supervision->counters.reloaded_s, clock_utc_ns() / NS_PER_S);
    if (!supervision->runtime || !json)
        return;
    char *path = mem_printf("%s/reload.json", supervision->runtime);
    char *text = mem_printf("{\"begun_ns\":%" PRId64 ",\"result\":%s}\n", begun_ns, json);
    int error = atomic_file_put(path, text, strlen(text));
    if (error)
        log_warn(supervision->log, "%s: %s", path, strerror(-error));
    mem_free(text);
    mem_free(path);
}

void supervision_stopping(struct supervision *supervision)
{
    service_patience_end(&supervision->patience);
    service_notify("STOPPING=1\nSTATUS=stopping");
}
