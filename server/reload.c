/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that reloads the plant: reads the plant again, compares it with the old one, and switches the daemon to the new one. */
#include "reload.h"

#include <inttypes.h>
#include <jansson.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "access/tokens.h"
#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "base/files/file_writer.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "base/thread.h"
#include "corelink/core_tags.h"
#include "import_job.h"
#include "plant/plant_diff.h"
#include "plant/plant_folder.h"
#include "plant/recipe.h"
#include "helper_program.h"

enum { MAX_FIRST_VIEWS = 16 }; /* maximum number of views drawn with the new plant before the switch */
/* time limit in nanoseconds for writing a user's action to disk; afterwards the user is told that the action is not kept */
static const int64_t SETTLE_NS = NS_PER_S;
/* nanoseconds. FOLLOW_NS: how long a renderer waits for its core to switch to the new plant; LOOK_NS: interval at which it
   checks whether the core has. */
static const int64_t FOLLOW_NS = 120 * NS_PER_S, LOOK_NS = 20 * NS_PER_MS;
/* interval in nanoseconds at which a node tries again to get its core's tag list */
static const int64_t MATCH_AGAIN_NS = 5 * NS_PER_S, MATCH_RARELY_NS = 300 * NS_PER_S;
/* time limit in milliseconds: a reload waits this long for another program to finish changing the plant's folder */
enum { WAIT_MS = 3000 };

struct reload {
    const struct plant_runtime_context *context;
    struct plant_runtime **runtime;
    struct net *net;
    struct supervision *supervision;
    struct plant_import *import;   /* importer of plants; NULL: import is off */
    int64_t begun_ns;              /* monotonic time when the reload that is running began */
    uint64_t following;            /* connection to the core that must end before the running reload activates the plant; 0: none */
    char expected[17];             /* hash that the configuration must have after the running reload; empty: any */
    char by[TOKEN_NAME_BYTES];     /* user who requested the running reload */
    const struct tag_save *saving; /* tag list that the running reload saves; NULL: none */
    const char *kept;              /* path under which the previous version of the tag list is kept */
    uint64_t answers;              /* number of the newest request that the running reload answers; 0: it answers none */
    char *failure;                 /* reason why the last reload that failed did so; NULL: none failed yet */
    char *unmatched;               /* last reported reason why this node has not got its core's files; NULL: none */
    char *refused;                 /* errors of the last refused reload with the core's files; NULL: none since they became equal */
    bool matching;                 /* true: the running reload is an attempt to get the core's files, which record_match() records */
    int failed_matches;            /* number of failed attempts to get the core's files since the last success */
    _Atomic bool stops;            /* true: the daemon ends, so a transfer of a tag list must end */
    struct refusal refusal;        /* reason why the running reload could not save the tag list; REFUSAL_NONE: it was saved */
    /* held while a reload replaces the runtime, and while this core becomes the leader (which polls devices), so that these
       never overlap */
    pthread_mutex_t put_lock;
    bool ended; /* true: this core's lead has ended, so no new plant may be activated; protected by put_lock */
    /* thread that starts and ends this core's work as the leader; separate from the reload thread, so that neither waits for
       the other */
    struct thread leader;
    bool leads, ends; /* orders for that thread: take the lead; end the lead; protected by leader.lock */
    struct thread thread;
    /* --- below: protected by thread.lock */
    bool asked, imports; /* asked: a user or a signal requested a reload */
    uint64_t requests;   /* number of reloads that users and signals have requested since the start */
    struct follow_order {
        bool given; /* true: the core loads or has loaded its plant, so this node loads its own (reload_follow()) */
        uint64_t session;
        char expects[17], loads[17]; /* as in struct core_follow; empty: any, or not known */
    } follow;
    char who[TOKEN_NAME_BYTES]; /* user who requested the next reload */
    struct tag_save *save;      /* tag list that the next reload saves; NULL: none */
    struct core_match {
        struct core_files files;
        char configuration[17]; /* the core's configuration; empty: there is no order */
        int64_t due_ns;         /* monotonic time at which to carry out the order */
        int64_t pause_ns;       /* time between the last two attempts; 0: there was at most one attempt */
    } match;                    /* order to make this node's files equal to its core's */
    char agreed[17];            /* hash of the tag list that both cores have, to be recorded; empty: none */
};

void reload_count(struct counters *counters, const char *hash, bool in_force)
{
    char *name = mem_printf("plantcast_configuration_info{hash=\"%s\"}", hash);
    counter_set(counters_add(counters, name, "gauge",
                             "Always 1; the label `hash` identifies the active configuration (plant file and tag list)."),
                in_force);
    mem_free(name);
}

/* --- reporting the result --------------------------------------------------------------------------------------------- */

struct verdict {
    struct net *net;
    uint64_t answers; /* number of the newest request that is answered; 0: none is */
    bool good;
    char *text;
    uint64_t client; /* id of the client that saved a tag list */
    char *saved;     /* message for the client that saved a tag list; NULL: no tag list was saved */
};

static void say(void *arg)
{
    struct verdict *verdict = arg;
    if (verdict->answers)
        net_report_reload(verdict->net, verdict->answers, verdict->good, verdict->text);
    if (verdict->saved)
        net_report_save(verdict->net, verdict->client, verdict->saved);
}

/* Returns the message for the client that saved a tag list. */
static char *saved_text(const struct reload *reload, bool good, const json_t *object)
{
    json_t *said = json_pack("{s:s,s:I,s:b}", "type", "tags_saved", "seq", (json_int_t)reload->saving->seq, "saved", good);
    static const char *const names[] = { "configuration", "changes", "errors", "unaudited", "unaudited_refusal" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (json_object_get(object, names[i]))
            json_object_set(said, names[i], json_object_get(object, names[i]));
    if (reload->refusal.code)
        json_object_set_new(said, "refusal", refusal_json(&reload->refusal));
    if (good)
        json_object_set_new(said, "kept", json_string(strrchr(reload->kept, '/') + 1));
    return json_text(said, 0);
}

static void record(const struct reload *reload, bool good, const json_t *object)
{
    const char *configuration = json_string_value(json_object_get(object, "configuration"));
    const char *error = json_string_value(json_array_get(json_object_get(object, "errors"), 0));
    char *what = mem_printf("%sconfiguration %s is active",
                            !reload->saving ? ""
                            : good          ? "tag list saved: "
                                            : "tag list not saved: ",
                            configuration);
    audit_say(reload->context->audit,
              &(struct audit_entry){
                  .event = "reload", .result = good ? "done" : "failed", .who = reload->by, .what = what, .why = error });
    mem_free(what);
}

/* Reports the reload's result to the clients that requested it; takes ownership of `object`. Only requests that this reload serves
   are answered. */
static void answer(struct reload *reload, bool good, json_t *object)
{
    struct verdict verdict = { .net = reload->net, .answers = reload->answers, .good = good };
    json_object_set_new(object, "by", json_string(reload->by));
    struct settling_ticket ticket = audit_begin(reload->context->audit);
    if (!reload->matching)
        record(reload, good, object);
    audit_end(reload->context->audit, &ticket);
    int error = audit_wait(reload->context->audit, &ticket);
    if (error)
        refusal_add_unaudited(object, atomic_file_not_kept(error));
    if (reload->saving) {
        verdict.client = reload->saving->client;
        verdict.saved = saved_text(reload, good, object);
    }
    char *text = json_text(object, 0);
    verdict.text = mem_printf("%s\n", text);
    supervision_reloaded(reload->supervision, good, reload->begun_ns, reload->answers ? text : NULL);
    net_call(reload->net, say, &verdict);
    mem_free(verdict.text);
    mem_free(verdict.saved);
    mem_free(text);
}

/* Returns the level at which a refusal is logged. Nobody requests a repeated attempt to get the core's files, so its errors are
   logged as errors only if they differ from those of the attempt before. */
static enum log_level refusal_level(struct reload *reload, const struct diag *diag, const char *why)
{
    struct text errors = { 0 };
    if (!reload->matching)
        return LOG_ERROR;
    for (size_t i = 0; i < diag->count; i++)
        if (diag->items[i].severity == DIAG_ERROR)
            text_add(&errors, "%s: %s\n", diag->items[i].file, diag->items[i].text);
    text_add(&errors, "%s\n", why ? why : "");
    bool repeated = reload->refused && text_equal_but_numbers(errors.at, reload->refused);
    mem_free(reload->refused);
    reload->refused = mem_strdup(errors.at);
    text_finish(&errors);
    return repeated ? LOG_DEBUG : LOG_ERROR;
}

static void refuse(struct reload *reload, const struct diag *diag, const char *why)
{
    struct log *log = reload->context->log;
    enum log_level level = refusal_level(reload, diag, why);
    json_t *errors = json_array();
    mem_free(reload->failure);
    reload->failure = mem_strdup(why ? why : "the plant has errors; the log says which");
    for (size_t i = 0; i < diag->count; i++) {
        const struct diag_item *item = &diag->items[i];
        if (item->severity != DIAG_ERROR)
            continue;
        char *line = mem_printf("%s:%d:%d: %s", item->file, item->line, item->column, item->text);
        log_at(log, level, "reload: %s", line);
        json_array_append_new(errors, json_string(line));
        mem_free(line);
    }
    if (why)
        json_array_append_new(errors, json_string(why));
    log_event(log, level, EVENT_RELOAD_REFUSED, "reload: refused, so the daemon keeps the configuration %s%s%s",
              (*reload->runtime)->plant->files.hash, why ? ": " : "", why ? why : "");
    answer(reload, false,
           json_pack("{s:b,s:s,s:o}", "reloaded", false, "configuration", (*reload->runtime)->plant->files.hash, "errors", errors));
}

/* --- the switch ------------------------------------------------------------------------------------------------------- */

struct swap {
    struct net *net;
    struct plant_runtime *after;
    struct view first[MAX_FIRST_VIEWS];
    size_t first_count;
};

/* Collects the sessions' views, because the new plant draws its first frames for them. Runs in the event loop. */
static void look_at_views(void *arg)
{
    struct swap *swap = arg;
    swap->first_count = net_views(swap->net, &swap->after->services, swap->first, MAX_FIRST_VIEWS);
}

/* Starts the new plant's render service while the old one still draws, so that the first frames of the new plant come quickly. */
static bool start_render_service(struct reload *reload, struct plant_runtime *after)
{
    struct swap swap = { .net = reload->net, .after = after };
    store_adopt(after->services.store, (*reload->runtime)->services.store);
    return net_call(reload->net, look_at_views, &swap) && plant_runtime_start_render_service(after, swap.first, swap.first_count);
}

/* Drops the pointers to the historian and the notifier, which are about to be destroyed. Runs in the event loop. */
static void release_recording(void *arg)
{
    net_release_recording(arg);
}

/* Switches the sessions from the old plant's services to the new plant's. Runs in the event loop. */
static void swap(void *arg)
{
    struct swap *swap = arg;
    /* The new plant reads the files that users' actions change, so these actions must be on disk. Only the newest ones may
       still be unwritten, because put_in_force() has waited for the others. */
    file_writer_wait(swap->after->context->file_writer, SETTLE_NS);
    file_writer_collect(swap->after->context->file_writer);
    plant_runtime_open_lists(swap->after);
    net_release_plant(swap->net);
    net_take_plant(swap->net, &swap->after->services);
}

static void say_difference(struct reload *reload, const struct plant_diff *diff, const char *before, double took_s)
{
    struct log *log = reload->context->log;
    json_t *changes = json_array();
    for (size_t i = 0; i < diff->count; i++) {
        log_info(log, "reload: %s", diff->lines[i]);
        json_array_append_new(changes, json_string(diff->lines[i]));
    }
    log_event(log, LOG_INFO, EVENT_RELOADED, "reload: configuration %s replaced %s after %.1f s, requested by %s",
              (*reload->runtime)->plant->files.hash, before, took_s, reload->by);
    answer(reload, true,
           json_pack("{s:b,s:s,s:s,s:o}", "reloaded", true, "configuration", (*reload->runtime)->plant->files.hash, "before", before,
                     "changes", changes));
}

/* Switches the daemon to the new plant. The old plant's sources end in this function, so it cannot be undone: if a thread of
   the new plant cannot be created, the daemon ends. begun_ns: when the reload was requested. */
static void put_in_force(struct reload *reload, struct plant_runtime *after, const struct plant_diff *diff, int64_t begun_ns)
{
    struct plant_runtime *before = *reload->runtime;
    struct swap both = { .net = reload->net, .after = after };
    char *hash = mem_strdup(before->plant->files.hash);
    pthread_mutex_lock(&reload->put_lock);
    bool ended = reload->ended, good = !ended && net_call(reload->net, release_recording, reload->net);
    if (good) {
        plant_runtime_hand_over(before, after->plant);
        file_writer_wait(reload->context->file_writer, SETTLE_NS);
        good = plant_runtime_start_recording(after, before) && plant_runtime_start_sources(after) && net_call(reload->net, swap, &both);
    }
    if (good)
        *reload->runtime = after;
    pthread_mutex_unlock(&reload->put_lock);
    if (good) {
        plant_runtime_destroy(&before);
        malloc_trim(0);
        reload_count(reload->context->counters, hash, false);
        reload_count(reload->context->counters, after->plant->files.hash, true);
        say_difference(reload, diff, hash, (double)(clock_mono_ns() - begun_ns) / 1e9);
    } else if (ended) {
        plant_runtime_destroy(&after);
    } else {
        log_err(reload->context->log, "reload: recording or the sources of the changed plant could not be started; the daemon exits and "
                                      "loads the changed plant at its next start");
        net_stop(reload->net);
        plant_runtime_destroy(&after);
    }
    mem_free(hash);
}

/* --- the plant's folder ------------------------------------------------------------------------------------------------- */

/* Locks the plant's folder, so that no other program changes it. Returns the descriptor that holds the lock, or a negative
   number with the reason in *why (mem_free). */
static int lock_folder(const struct reload *reload, char **why)
{
    char *folder = plant_folder_of(reload->context->params->plant_path), *cause = NULL;
    int lock = plant_folder_lock(&(struct plant_folder_params){ .folder = folder, .wait_ms = WAIT_MS }, &cause);
    if (lock < 0)
        *why = mem_printf("the plant's folder %s cannot be locked: %s; try again later", folder, cause);
    mem_free(cause);
    mem_free(folder);
    return lock;
}

struct announcement {
    struct net *net;
    char configuration[17]; /* hash of the plant file and tag list that this core loads */
};

/* Tells the renderers that a reload begins. Runs in the event loop. */
static void announce(void *arg)
{
    struct announcement *announcement = arg;
    net_announce_reload(announcement->net, announcement->configuration);
}

static void announce_reload(struct reload *reload)
{
    struct announcement announcement = { .net = reload->net };
    plant_hash_on_disk((*reload->runtime)->plant, announcement.configuration);
    net_call(reload->net, announce, &announcement);
}

/* Returns whether the running reload must wait, because this renderer's core has not yet switched to its new plant. */
static bool must_wait(struct reload *reload)
{
    pthread_mutex_lock(&reload->put_lock); /* locks, because a standby that takes the lead frees its link to the core */
    struct core_link *link = (*reload->runtime)->services.core_link;
    bool waits = reload->following && link && core_link_session(link) == reload->following;
    pthread_mutex_unlock(&reload->put_lock);
    return waits;
}

/* On a renderer, waits until the core, which loads the plant too, has switched to it and thus ended the connection: the core
   refuses a renderer that switches earlier. Returns false if the core does not switch. */
static bool wait_for_core(struct reload *reload)
{
    struct thread *thread = &reload->thread;
    int64_t end_ns = clock_mono_ns() + FOLLOW_NS;
    bool stopping = false;
    while (must_wait(reload) && !stopping && clock_mono_ns() < end_ns) {
        pthread_mutex_lock(&thread->lock);
        clock_cond_wait(&thread->wake, &thread->lock, clock_mono_ns() + LOOK_NS);
        stopping = thread->stopping;
        pthread_mutex_unlock(&thread->lock);
    }
    return !must_wait(reload);
}

/* Reloads the plant. Returns false if an error, already reported, prevented that; the daemon then continues with the old plant. */
static bool reload_now(struct reload *reload)
{
    struct diag diag = { 0 };
    struct plant_diff diff = { 0 };
    int64_t begun_ns = clock_mono_ns();
    if (reload->context->params->role == SERVER_CORE)
        announce_reload(reload);
    struct plant_runtime *before = *reload->runtime, *after = plant_runtime_read(reload->context, &diag);
    const char *why = after         ? plant_needs_restart(before->plant, after->plant)
                      : diag.errors ? NULL
                                    : "the changed plant cannot be loaded; the daemon's log says why";
    if (after && !why && reload->expected[0] && strcmp(after->plant->files.hash, reload->expected) != 0)
        why = "the plant file and tag list on this machine differ from the core's: copy them from the core to this machine, then reload";
    if (after && !why && !start_render_service(reload, after))
        why = "the changed plant cannot be drawn; the daemon's log says why";
    if (after && !why && !wait_for_core(reload))
        why = "the core did not load its changed plant file or tag list; the core's log says why";
    bool good = after && !why;
    if (good) {
        plant_diff(before->plant, after->plant, &diff);
        put_in_force(reload, after, &diff, begun_ns);
    } else {
        refuse(reload, &diag, why);
        plant_runtime_destroy(&after);
    }
    plant_diff_finish(&diff);
    diag_finish(&diag);
    return good;
}

/* Waits at most WAIT_MS until no other program is replacing the plant's files. Returns false like reload_now(). */
static bool settle_folder(struct reload *reload)
{
    struct diag none = { 0 };
    char *folder = plant_folder_of(reload->context->params->plant_path), *why = NULL;
    bool good = plant_folder_settle(&(struct plant_folder_params){ .folder = folder, .wait_ms = WAIT_MS }, &why);
    if (!good) {
        char *line = mem_printf("the plant's folder %s cannot be locked: %s; try again later", folder, why);
        refuse(reload, &none, line);
        mem_free(line);
    }
    mem_free(why);
    mem_free(folder);
    return good;
}

/* Reloads the plant as soon as no other program is replacing its files. Returns false like reload_now(). */
static bool reload_settled(struct reload *reload)
{
    return settle_folder(reload) && reload_now(reload);
}

/* Loads the plant because the core loads it, unless this node lacks the files that the core loads. */
static void follow_now(struct reload *reload, const struct follow_order *order)
{
    char own[17];
    if (!settle_folder(reload))
        return;
    plant_hash_on_disk((*reload->runtime)->plant, own);
    if (order->loads[0] && strcmp(order->loads, own) != 0) {
        log_info(reload->context->log,
                 "reload: the core loads configuration %s, but the files of this node have %s: this node continues with its present "
                 "configuration until the core has changed",
                 order->loads, own);
        return;
    }
    reload_now(reload);
}

/* --- saving a tag list ----------------------------------------------------------------------------------------------------- */

static bool is_stopping(void *arg)
{
    struct reload *reload = arg;
    return thread_is_stopping(&reload->thread);
}

static bool prepare(struct reload *reload)
{
    const struct plant_runtime_context *context = reload->context;
    char *folder = plant_runtime_prepared_folder(context->params, (*reload->runtime)->plant);
    char *why = helper_prepare(&(struct helper_params){ .stop = is_stopping, .arg = reload, .log = context->log }, folder,
                               context->params->plant_path, &context->params->access.quotas);
    if (why)
        log_err(context->log, "%s", why);
    bool good = !why;
    mem_free(why);
    mem_free(folder);
    return good;
}

static void put_back(struct reload *reload, const struct tag_save *save, const char *kept)
{
    char *why = NULL;
    if (!tag_file_put_back(save, kept, &why))
        log_err(reload->context->log, "tag list: %s", why);
    else
        prepare(reload); /* makes prepared files for the restored tag list; quick, because those from before the save still exist */
    mem_free(why);
}

/* Saves a tag list and activates it. Returns false if that fails; reload->failure then has the reason. */
static bool save_now(struct reload *reload, const struct tag_save *save)
{
    bool good = false;
    struct log *log = reload->context->log;
    struct diag none = { 0 };
    char *kept = NULL, *why = NULL;
    int lock = lock_folder(reload, &why);
    reload->saving = save;
    reload->refusal = (struct refusal){ .code = REFUSAL_NONE };
    if (lock < 0) {
        refuse(reload, &none, why);
    } else if (!tag_file_put(save, &kept, &reload->refusal)) {
        char text[REFUSAL_TEXT_BYTES];
        refusal_text(&reload->refusal, text);
        refuse(reload, &none, text);
    } else {
        reload->kept = kept;
        log_info(log, "tag list %s was saved by %s; the previous list is kept as %s", save->path, save->who, kept);
        if (!prepare(reload)) {
            put_back(reload, save, kept);
            refuse(reload, &none,
                   "plantcast-prep could not prepare the plant with this tag list, so the previous list is restored; the daemon's log says "
                   "why");
        } else if (!reload_now(reload)) {
            put_back(reload, save, kept);
        } else {
            good = true;
        }
    }
    reload->saving = NULL;
    reload->kept = NULL;
    if (lock >= 0)
        close(lock);
    mem_free(kept);
    mem_free(why);
    return good;
}

/* --- getting the core's files ---------------------------------------------------------------------------------------------- */

static bool has_hash(const char *path, const char *hash)
{
    uint64_t is;
    char text[17] = "";
    if (plant_model_hash(path, &is))
        snprintf(text, sizeof(text), "%016" PRIx64, is);
    return !strcmp(text, hash);
}

/* Requests the core's tag list. Returns its text (mem_free), or NULL with the reason in *why (mem_free). */
static char *get_tags(struct reload *reload, const char *hash, char **why)
{
    struct http_request request = { 0 };
    pthread_mutex_lock(&reload->put_lock); /* a standby that takes the lead frees its link to the core */
    struct core_link *link = (*reload->runtime)->services.core_link;
    bool good = link && core_tags_begin(&request, link, &reload->stops);
    pthread_mutex_unlock(&reload->put_lock);
    char is[17] = "", *text = good ? core_tags_get(&request, why) : NULL;
    http_request_finish(&request);
    if (text)
        tag_file_hash(text, is);
    if (!good) {
        *why = mem_strdup("no leading core is known");
    } else if (text && strcmp(is, hash) != 0) {
        *why = mem_strdup("the leading core's tag list is not the one that this core has loaded: it is being saved, or was changed without "
                          "a reload of the leading core");
        mem_free(text);
        text = NULL;
    }
    return text;
}

/* Returns the folder with the record of the tag lists that this node has had in common with its core (mem_free). */
static char *record_folder(const struct reload *reload)
{
    const struct plant_runtime *runtime = *reload->runtime;
    return runtime->services.history_folder ? mem_strdup(runtime->services.history_folder)
                                            : plant_runtime_prepared_folder(reload->context->params, runtime->plant);
}

/* Gets the core's tag list and activates it. Returns NULL on success, otherwise the reason (mem_free). *again: true: the next
   attempt may succeed without a person's help. */
static char *take_tags(struct reload *reload, const struct core_files *files, bool *again)
{
    const struct plant *plant = (*reload->runtime)->plant;
    const char *node = reload->context->params->node;
    char *why = NULL, hash[17] = "", *real = realpath(plant->files.tags_path, NULL), *folder = record_folder(reload);
    struct refusal unread;
    struct tag_save save = { .path = real ? real : plant->files.tags_path, .who = reload->by };
    save.before = tag_file_read(save.path, &unread);
    if (save.before)
        tag_file_hash(save.before, hash);
    *again = true;
    if (!save.before) {
        char text[REFUSAL_TEXT_BYTES];
        refusal_text(&unread, text);
        why = mem_printf("%s on node %s: %s", save.path, node, text);
    } else if (!core_tags_agreed(folder, hash)) {
        *again = false;
        why = mem_printf("%s on node %s was edited there, or never was equal to the core's list, so it is not replaced: make it equal to "
                         "the leading core's list, and reload the plant on %s",
                         save.path, node, node);
    } else if ((save.after = get_tags(reload, files->tags, &why))) {
        int error = core_tags_expect(folder, files->tags);
        if (error)
            why = mem_printf("cannot write to the folder %s on node %s: %s", folder, node, strerror(-error));
        else if (!save_now(reload, &save))
            why = mem_printf("%s: %s", save.path, reload->failure);
    }
    mem_free(folder);
    mem_free(save.before);
    mem_free(save.after);
    free(real);
    return why;
}

/* Returns whether this is the first failure to get the core's files, or has another cause than the last one. */
static bool is_new_cause(const struct reload *reload, const char *why)
{
    return !reload->unmatched || !text_equal_but_numbers(why, reload->unmatched);
}

/* Records an attempt to get the core's files in the audit trail. Attempts are repeated for as long as they fail, so a failure is
   recorded only if its cause is new. why: reason of the failure; NULL: this node now has the files. */
static void record_match(struct reload *reload, const char *why)
{
    reload->failed_matches += why != NULL;
    if (why && !is_new_cause(reload, why))
        return;
    const char *hash = (*reload->runtime)->plant->files.hash;
    char *what = why ? mem_printf("the files of the leading core are not active: this node keeps configuration %s", hash)
                 : reload->failed_matches
                     ? mem_printf("the files of the leading core: configuration %s is active, after %d failed attempts", hash,
                                  reload->failed_matches)
                     : mem_printf("the files of the leading core: configuration %s is active", hash);
    audit_say(reload->context->audit,
              &(struct audit_entry){ .event = "reload", .result = why ? "failed" : "done", .who = reload->by, .what = what, .why = why });
    mem_free(what);
}

/* Logs and reports why this node has not got its core's files; takes ownership of `why`. NULL: this node has them. */
static void report_unmatched(struct reload *reload, char *why)
{
    if (why && is_new_cause(reload, why))
        log_err(reload->context->log, "core: this node has not got its core's files: %s", why);
    pthread_mutex_lock(&reload->put_lock);
    struct core_link *link = (*reload->runtime)->services.core_link;
    if (why && link && reload->context->params->role == SERVER_CORE)
        core_link_report_files(link, why);
    pthread_mutex_unlock(&reload->put_lock);
    if (!why) {
        if (link && reload->unmatched)
            log_info(reload->context->log, "core: this node has got its core's files, after %d failed attempts", reload->failed_matches);
        reload->failed_matches = 0;
        mem_free(reload->refused);
        reload->refused = NULL;
    }
    mem_free(reload->unmatched);
    reload->unmatched = why;
}

static bool follows_core(struct reload *reload)
{
    pthread_mutex_lock(&reload->put_lock);
    bool follows = (*reload->runtime)->services.core_link;
    pthread_mutex_unlock(&reload->put_lock);
    return follows;
}

/* Makes this node's files equal to its core's. Returns false if another attempt may succeed later. */
static bool match_now(struct reload *reload, const struct core_match *match)
{
    const struct plant_files *own = &(*reload->runtime)->plant->files;
    bool again = false;
    char *why = NULL;
    if (!follows_core(reload) || !strcmp(own->hash, match->configuration)) {
        /* this core leads by now, or has loaded the core's files meanwhile */
        report_unmatched(reload, NULL);
        return true;
    }
    reload->matching = true;
    if (!has_hash(own->path, match->files.plant)) {
        why = mem_printf("the core has another plant file than %s on node %s: copy the core's plant file, tag list and models to that "
                         "machine, run plantcast-prep, and reload the plant there",
                         own->path, reload->context->params->node);
    } else if (!has_hash(own->tags_path, match->files.tags)) {
        why = take_tags(reload, &match->files, &again);
    } else {
        snprintf(reload->expected, sizeof(reload->expected), "%s", match->configuration);
        if (!reload_settled(reload))
            why = mem_printf("%s is equal to the core's, but cannot be activated: %s", own->tags_path, reload->failure);
        reload->expected[0] = 0;
    }
    reload->matching = false;
    if (why && is_stopping(reload)) { /* the daemon's end is no cause of a failure */
        mem_free(why);
        return true;
    }
    record_match(reload, why);
    report_unmatched(reload, why);
    return !again || !why;
}

/* Records that this node and its core have this tag list. */
static void agree_now(struct reload *reload, const char *hash)
{
    report_unmatched(reload, NULL);
    char *folder = record_folder(reload);
    /* while this node got a later list, the core may have returned to this one: then the file holds the later list, whose record stays */
    bool is_saved = has_hash((*reload->runtime)->plant->files.tags_path, hash);
    int error = is_saved ? core_tags_agree(folder, hash) : core_tags_expect(folder, hash);
    if (error)
        log_warn(reload->context->log,
                 "core: %s: cannot record that this node and its core have the same tag list (%s): this node will not get the next one "
                 "from the core",
                 folder, strerror(-error));
    mem_free(folder);
}

/* --- importing a plant -------------------------------------------------------------------------------------------------- */

static bool is_cancelled(void *arg)
{
    struct reload *reload = arg;
    return plant_import_cancelled(reload->import) || is_stopping(reload);
}

/* Undoes a failed import. Takes ownership of the reason `why`, appends errors of the undo to it, and returns it. */
static char *undo_import(struct reload *reload, struct import_job *job, char *why)
{
    char *worse = import_job_undo(job), *both = worse ? mem_printf("%s; and the import cannot be undone: %s", why, worse) : NULL;
    if (!worse && import_job_prepares(job))
        prepare(reload); /* makes prepared files for the restored plant files; quick, because those from before the import still exist */
    if (both)
        mem_free(why);
    mem_free(worse);
    log_err(reload->context->log, "import: %s", both ? both : why);
    return both ? both : why;
}

static void record_import(const struct reload *reload, const struct import_order *order, const char *why)
{
    audit_say(reload->context->audit, &(struct audit_entry){ .event = "import",
                                                             .result = why ? "failed" : "done",
                                                             .who = reload->by,
                                                             .what = order->anew           ? "the plant was created again from its exports"
                                                                     : order->models       ? "models were read and tags matched"
                                                                     : order->decides      ? "decisions about tags were applied"
                                                                     : *order->source.host ? "a source was set"
                                                                                           : "tags were matched",
                                                             .why = why });
}

/* Runs an import. This daemon has locked the plant's folder on behalf of the import's programs. */
static void import_locked(struct reload *reload, struct import_order *order, int lock)
{
    const struct plant_runtime_context *context = reload->context;
    char *folder = plant_runtime_prepared_folder(context->params, (*reload->runtime)->plant);
    const struct import_job_params params = { .log = context->log,
                                              .import = reload->import,
                                              .plant_path = context->params->plant_path,
                                              .tags_path = (*reload->runtime)->plant->files.tags_path,
                                              .prepared = folder,
                                              .lock = lock,
                                              .quotas = &context->params->access.quotas,
                                              .stop = is_cancelled,
                                              .arg = reload };
    struct import_job *job = import_job_begin(&params);
    if (order->anew) /* keeps the present plant's data source if the import creates a new plant file */
        order->source = import_source_of_plant((*reload->runtime)->plant);
    char *remark, *why = import_job_run(job, order, &remark);
    if (!why) {
        plant_import_set_phase(reload->import, IMPORT_LOADING);
        why = reload_now(reload)
                  ? NULL
                  : mem_strdup("the daemon refused to load the imported plant, so the import is undone; the daemon's log says why");
    }
    if (why)
        why = undo_import(reload, job, why);
    record_import(reload, order, why);
    plant_import_end(reload->import, !why, why ? why : remark);
    import_job_end(&job);
    mem_free(remark);
    mem_free(why);
    mem_free(folder);
}

static void import_now(struct reload *reload, struct import_order *order)
{
    char *why = NULL;
    int lock = lock_folder(reload, &why);
    if (lock >= 0) {
        import_locked(reload, order, lock);
        close(lock);
        return;
    }
    log_err(reload->context->log, "import: %s", why);
    record_import(reload, order, why);
    plant_import_end(reload->import, false, why);
    mem_free(why);
}

/* --- taking the lead from another core --------------------------------------------------------------------------------- */

/* Gives the plant's services to the event loop while this core takes the lead. Runs in the event loop. */
static void lead_in_loop(void *arg)
{
    struct reload *reload = arg;
    net_lead(reload->net, &(*reload->runtime)->services);
}

/* Logs that this core leads. The stated time is how long the plant had no leader, as far as this core knows: it begins with the
   previous leader's last sign of life. */
static void say_lead(const struct reload *reload)
{
    struct log *log = reload->context->log;
    int64_t age_ns = lease_keeper_heard_age_ns(reload->context->keeper);
    if (age_ns >= 0)
        log_info(log,
                 "core: this core took over the lead %.1f s after the previous leader's last sign of life: it now polls devices and "
                 "evaluates alarms",
                 (double)age_ns / 1e9);
    else
        log_info(log, "core: this core took the lead; since its start it has seen no other core lead: it now polls devices and evaluates "
                      "alarms");
}

static void lead_now(struct reload *reload)
{
    pthread_mutex_lock(&reload->put_lock);
    struct plant_runtime *runtime = *reload->runtime;
    plant_runtime_stop_following(runtime);
    bool open = net_call(reload->net, lead_in_loop, reload);
    bool good = open && plant_runtime_lead(runtime) && net_call(reload->net, lead_in_loop, reload);
    pthread_mutex_unlock(&reload->put_lock);
    if (good) {
        say_lead(reload);
    } else if (open) {
        log_err(reload->context->log, "core: this core cannot take over: polling or the alarms could not be started (see the messages "
                                      "above); the daemon exits");
        net_stop(reload->net);
    }
}

/* Drops the pointer to the historian, which is about to be destroyed. Runs in the event loop. */
static void release_historian(void *arg)
{
    net_release_historian(arg);
}

static void end_leading_now(struct reload *reload)
{
    pthread_mutex_lock(&reload->put_lock);
    if (net_call(reload->net, release_historian, reload->net))
        plant_runtime_end_leading(*reload->runtime);
    reload->ended = true;
    pthread_mutex_unlock(&reload->put_lock);
    net_on_lead_ended(reload->net);
}

/* Waits until *order is set. Returns false if the thread must end. */
static bool wait_for_order(struct thread *thread, const bool *order)
{
    pthread_mutex_lock(&thread->lock);
    while (!*order && !thread->stopping)
        pthread_cond_wait(&thread->wake, &thread->lock);
    bool good = !thread->stopping;
    pthread_mutex_unlock(&thread->lock);
    return good;
}

static void *run_leader(void *arg)
{
    struct reload *reload = arg;
    if (!wait_for_order(&reload->leader, &reload->leads))
        return NULL;
    lead_now(reload);
    if (wait_for_order(&reload->leader, &reload->ends))
        end_leading_now(reload);
    return NULL;
}

/* --- life cycle -------------------------------------------------------------------------------------------------------- */

/* Waits until the thread has something to do. Call with the thread's lock. */
static void wait_for_work(struct reload *reload)
{
    while (!reload->asked && !reload->follow.given && !reload->imports && !reload->save && !reload->agreed[0] && !reload->thread.stopping)
        if (!reload->match.configuration[0])
            pthread_cond_wait(&reload->thread.wake, &reload->thread.lock);
        else if (clock_mono_ns() < reload->match.due_ns)
            clock_cond_wait(&reload->thread.wake, &reload->thread.lock, reload->match.due_ns);
        else
            break;
}

/* Returns the order to match the core's files if it is due, and clears it; otherwise returns an empty order. Call with the
   thread's lock. */
static struct core_match take_match(struct reload *reload)
{
    struct core_match match = { .configuration = "" };
    if (reload->match.configuration[0] && clock_mono_ns() >= reload->match.due_ns) {
        match = reload->match;
        reload->match.configuration[0] = 0;
    }
    return match;
}

/* Carries out an order to match the core's files. If that fails, the order becomes due again later, unless a newer one waits. */
static void carry_out(struct reload *reload, struct core_match *match)
{
    snprintf(reload->by, sizeof(reload->by), "the core");
    bool done = match_now(reload, match);
    int64_t doubled_ns = match->pause_ns ? 2 * match->pause_ns : MATCH_AGAIN_NS;
    match->pause_ns = doubled_ns < MATCH_RARELY_NS ? doubled_ns : MATCH_RARELY_NS;
    match->due_ns = clock_mono_ns() + match->pause_ns;
    pthread_mutex_lock(&reload->thread.lock);
    if (!done && !reload->match.configuration[0] && !reload->agreed[0]) /* agreed: the core has accepted this node meanwhile */
        reload->match = *match;
    pthread_mutex_unlock(&reload->thread.lock);
}

static void *reload_main(void *arg)
{
    struct reload *reload = arg;
    char who[TOKEN_NAME_BYTES];
    for (;;) {
        pthread_mutex_lock(&reload->thread.lock);
        wait_for_work(reload);
        struct core_match match = take_match(reload);
        char agreed[sizeof(reload->agreed)];
        memcpy(agreed, reload->agreed, sizeof(agreed));
        reload->agreed[0] = 0;
        bool stopping = reload->thread.stopping, asked = reload->asked;
        uint64_t requests = reload->requests;
        struct tag_save *save = reload->save;
        struct import_order order;
        struct follow_order follow = reload->follow;
        reload->asked = reload->imports = false;
        reload->follow = (struct follow_order){ .given = false };
        reload->save = NULL;
        snprintf(who, sizeof(who), "%s", reload->who);
        pthread_mutex_unlock(&reload->thread.lock);
        snprintf(reload->by, sizeof(reload->by), "%s", save ? save->who : who);
        reload->begun_ns = clock_mono_ns();
        if (save && !stopping)
            save_now(reload, save);
        tag_save_free(save);
        if (stopping)
            return NULL;
        if (agreed[0])
            agree_now(reload, agreed);
        if (match.configuration[0])
            carry_out(reload, &match);
        snprintf(reload->by, sizeof(reload->by), "%s", who);
        if (reload->import && plant_import_next(reload->import, &order))
            import_now(reload, &order);
        reload->following = follow.session;
        if (asked) {
            reload->answers = requests;
            reload_settled(reload);
            reload->answers = 0;
        } else if (follow.given) {
            snprintf(reload->by, sizeof(reload->by), "the core");
            memcpy(reload->expected, follow.expects, sizeof(follow.expects));
            follow_now(reload, &follow);
        }
        reload->following = 0;
        reload->expected[0] = 0;
    }
}

struct reload *reload_create(const struct plant_runtime_context *context, struct plant_runtime **runtime, struct net *net,
                             struct supervision *supervision, struct plant_import *import)
{
    struct reload *reload = mem_new(sizeof(*reload));
    reload->import = import;
    reload->context = context;
    reload->runtime = runtime;
    reload->net = net;
    reload->supervision = supervision;
    pthread_mutex_init(&reload->put_lock, NULL);
    thread_init(&reload->thread);
    thread_init(&reload->leader);
    if (!thread_start(&reload->thread, context->log, "reload", reload_main, reload) ||
        (context->keeper && !thread_start(&reload->leader, context->log, "leader", run_leader, reload)))
        reload_destroy(&reload);
    return reload;
}

void reload_destroy(struct reload **pointer)
{
    struct reload *reload = *pointer;
    if (!reload)
        return;
    atomic_store(&reload->stops, true);
    thread_stop(&reload->leader);
    thread_stop(&reload->thread);
    tag_save_free(reload->save);
    thread_finish(&reload->leader);
    thread_finish(&reload->thread);
    pthread_mutex_destroy(&reload->put_lock);
    mem_free(reload->failure);
    mem_free(reload->unmatched);
    mem_free(reload->refused);
    mem_free(reload);
    *pointer = NULL;
}

uint64_t reload_ask(struct reload *reload, const char *who)
{
    pthread_mutex_lock(&reload->thread.lock);
    uint64_t number = ++reload->requests;
    reload->asked = true;
    snprintf(reload->who, sizeof(reload->who), "%s", who);
    pthread_cond_signal(&reload->thread.wake);
    pthread_mutex_unlock(&reload->thread.lock);
    return number;
}

void reload_follow(struct reload *reload, const struct core_follow *follow)
{
    struct follow_order order = { .given = true, .session = follow->session };
    snprintf(order.expects, sizeof(order.expects), "%s", follow->expects ? follow->expects : "");
    snprintf(order.loads, sizeof(order.loads), "%s", follow->loads ? follow->loads : "");
    pthread_mutex_lock(&reload->thread.lock);
    reload->follow = order;
    pthread_cond_signal(&reload->thread.wake);
    pthread_mutex_unlock(&reload->thread.lock);
}

void reload_match(struct reload *reload, const struct core_files *files, const char *configuration)
{
    pthread_mutex_lock(&reload->thread.lock);
    reload->match = (struct core_match){ .files = *files };
    snprintf(reload->match.configuration, sizeof(reload->match.configuration), "%s", configuration);
    pthread_cond_signal(&reload->thread.wake);
    pthread_mutex_unlock(&reload->thread.lock);
}

void reload_agree(struct reload *reload, const char *tags_hash)
{
    pthread_mutex_lock(&reload->thread.lock);
    snprintf(reload->agreed, sizeof(reload->agreed), "%s", tags_hash);
    reload->match.configuration[0] = 0; /* the core has accepted this node's files: an earlier order no longer holds */
    pthread_cond_signal(&reload->thread.wake);
    pthread_mutex_unlock(&reload->thread.lock);
}

static void order(struct thread *thread, bool *order)
{
    pthread_mutex_lock(&thread->lock);
    *order = true;
    pthread_cond_signal(&thread->wake);
    pthread_mutex_unlock(&thread->lock);
}

void reload_lead(struct reload *reload)
{
    order(&reload->leader, &reload->leads);
}

void reload_end_leading(struct reload *reload)
{
    order(&reload->leader, &reload->ends);
}

void reload_save(struct reload *reload, struct tag_save *save)
{
    pthread_mutex_lock(&reload->thread.lock);
    /* frees a tag list that no reload has taken yet; normally there is none, because the event loop accepts only one save at a
       time */
    tag_save_free(reload->save);
    reload->save = save;
    pthread_cond_signal(&reload->thread.wake);
    pthread_mutex_unlock(&reload->thread.lock);
}

void reload_import(struct reload *reload, const char *who)
{
    pthread_mutex_lock(&reload->thread.lock);
    reload->imports = true;
    snprintf(reload->who, sizeof(reload->who), "%s", who);
    pthread_cond_signal(&reload->thread.wake);
    pthread_mutex_unlock(&reload->thread.lock);
}
