/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A core's connections to its renderers and its standby: sends each an introduction, then everything that changed. */
#include "net/renderers.h"

#include <openssl/rand.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/hex.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "corelink/core_alarms.h"
#include "corelink/core_identity.h"
#include "corelink/core_readings.h"
#include "corelink/core_samples.h"
#include "message/loop_check_message.h"
#include "message/names.h"
#include "net/connection.h"
#include "net/core_end.h"
#include "session/session_proxy.h"

#define ACTED "acted_ns" /* JSON key of a queued answer: monotonic time at which the answered action was on disk; removed before sending */
enum { TICK_US = 200000, MAX_MESSAGE_BYTES = 256 * 1024 /* maximum size of one message */, MAX_ANSWERS = 1024, SEND_TIMEOUT_S = 5 };
static const int64_t MAX_READINGS_DELAY_NS = 500 * NS_PER_MS, STANDBY_TIMEOUT_NS = 2 * NS_PER_S;

struct lists_seen {
    uint64_t views, notes, walls, pointed, pairings, links, loop_checks;
};

struct deed {
    struct session *session; /* session that was created to carry out this one forwarded action (session_proxy.h) */
    json_t *id;              /* id of the action's message, chosen by the renderer and repeated in the answer */
    struct deed *next;
};

struct renderer_peer {
    struct lws *wsi;
    struct renderer_peer *next;
    char name[64];                /* name of the renderer or standby at the other end, as it reports itself */
    /* if the peer is a standby: the id under which it would take the leadership lease; it distinguishes two nodes with the same name */
    char lease[LEASE_NODE_BYTES];
    struct text in, out;          /* in: message being received; out: message being built, after LWS_PRE spare bytes */
    /* state of the peer. RENDERER_VOTES: a core that may only vote about which core leads. It may not follow this core, for
       example because its version differs, but its promises not to take the lead are valid (corelink/lease.h) */
    enum { RENDERER_NEW, RENDERER_TAKEN, RENDERER_VOTES, RENDERER_REFUSED } state;
    char *refusal;     /* reason why the peer is refused; NULL: the peer is not refused */
    bool refusal_sent; /* true: the peer, which may only vote, was sent the reason of its refusal */
    bool other_configuration; /* true: the peer is refused only because its configuration differs from this core's */
    unsigned differing;       /* mask of enum core_file: the peer's files that differ from this core's */
    char *behind;             /* standby: the reason that it states why it has not got this core's files; NULL: none */
    struct core_sent sent;
    bool alarms_sent, lists_sent, links_sent;
    bool stands_by; /* true: the peer is a standby, a core that follows this one and can take over */
    /* true: the last message with samples had all waiting samples, so the next message has readings, which resets the flag */
    bool samples_sent;
    bool reloads; /* true: the peer must still be told that this core loads the plant again, so that a renderer does the same */
    bool asks;    /* true: the peer must still be asked whether it promises not to take the lead for a while (lease, corelink/lease.h) */
    /* standby: when this core ends, it asks the standby a last time, after all other messages, to promise not to take the lead.
       Number of this question; 0: not sent */
    uint64_t last_question;
    bool is_complete;             /* true: the standby core has answered last_question, so it has received all messages before */
    struct core_samples *samples; /* samples for the peer's history, to be sent; NULL: none */
    uint64_t told;                /* for a standby core: sequence number of the newest state of alarm notifications that was sent to it */
    uint64_t rows;                /* for a standby core: sequence number of the last row of the alarm journal that was sent to it */
    uint64_t alarms;              /* sequence number of the last change of alarms that was sent to the peer */
    struct lists_seen lists;
    bool *links;   /* [source]: state of the connection to the source, as last sent to the peer */
    json_t *hello; /* this core's introduction, the first message to the peer; NULL: already sent */
    /* answers to forwarded actions that are still to be sent, ordered by their JSON member ACTED (time at which the action was on disk) */
    json_t *answers;
    struct deed *deeds;     /* forwarded actions whose answers wait until the actions are on disk */
    int64_t told_ns;        /* monotonic time when readings were last sent to the peer */
    int64_t since_ns;       /* monotonic time since which a message has waited because the peer does not read; 0: no message waits */
    const char *close_text; /* reason to close the connection; NULL: the connection stays open */
};

/* Returns whether the peer is on this machine and needs no token; such a peer has the rights of an engineer. */
static bool is_local(const struct connection *connection)
{
    return connection->role == ROLE_ENGINEER && !connection->holder.name[0];
}

const char *renderers_refusal(const struct server_context *server, struct lws *wsi)
{
    const struct connection *connection = connection_of(wsi);
    if (!server->params.is_core)
        return "this daemon is not a core: start it with --role core\n";
    return role_is_node(connection->role) || is_local(connection) ? NULL
                                                                  : "this connection needs a token of the role renderer or standby\n";
}

void renderers_make_key(struct server_context *server)
{
    uint8_t key[VIEW_TOKEN_KEY_BYTES];
    if (RAND_bytes(key, sizeof(key)) != 1)
        return;
    hex_print(key, sizeof(key), server->core.key);
}

/* --- connecting and disconnecting ----------------------------------------------------------------------------------------------------- */

static struct core_identity own_identity(const struct server_context *server)
{
    const struct plant *plant = server->session_context.plant;
    return (struct core_identity){ server->params.version, plant->name, plant->files.hash,
                                   core_files_of(plant, server->params.plant.scene->models_hash) };
}

/* Returns whether the other core's promises not to take the lead for a while (corelink/lease.h) count. A core with other plant
   files cannot be a standby, but its promise is just as valid. */
static bool is_witness(const struct renderer_peer *renderer)
{
    return renderer->stands_by && (renderer->state == RENDERER_TAKEN || renderer->state == RENDERER_VOTES);
}

/* Returns whether a core can be the standby: its version, plant and configuration equal this core's. */
static bool is_standby(const struct renderer_peer *renderer)
{
    return renderer->stands_by && renderer->state == RENDERER_TAKEN;
}

bool renderers_have_standby(const struct server_context *server)
{
    const struct renderer_peer *renderer = server->core.renderers;
    while (renderer && !is_standby(renderer))
        renderer = renderer->next;
    return renderer;
}

static const struct renderer_peer *find_witness(const struct server_context *server)
{
    const struct renderer_peer *witness = NULL;
    for (const struct renderer_peer *renderer = server->core.renderers; renderer; renderer = renderer->next)
        if (is_witness(renderer))
            witness = renderer;
    return witness;
}

/* Returns whether this core of a pair takes the lead if the leader fails. A core that is refused only because its version differs
   does, because the two cores of a pair are upgraded one after the other. */
static bool takes_over(const struct renderer_peer *renderer)
{
    return is_standby(renderer) || (renderer->state == RENDERER_VOTES && !renderer->other_configuration);
}

/* Returns the node that this core has just refused and that may be the standby; NULL: none. */
static const struct denial *find_denied(const struct server_context *server)
{
    return denials_recent(&server->core.denials, clock_mono_ns());
}

void renderers_deny(struct server_context *server, const char *who, int status, const char *why)
{
    char more[LOG_PACE_BYTES];
    if (!server->params.keeper || !core_end_leads(server))
        return;
    int64_t now_ns = clock_mono_ns();
    struct denial *node = denials_note(&server->core.denials, who, why, status == 429, now_ns);
    if (denials_log(node, now_ns, more))
        log_err(server->params.log, "core: the connection of %s to this core is refused: %s%s", who, node->why, more);
    renderers_describe_standby(server);
}

const struct standby_texts *renderers_standby_texts(const struct server_context *server)
{
    static const struct standby_texts
        follows = { "ok; a standby follows", "leads; a standby follows" },
        models = { "ok; a standby follows, but its models differ: the log says why",
                   "leads; a standby follows, but its models differ: the log says why" },
        version = { "ok; the standby has another version: it gets no data, but can take over",
                    "leads; the standby has another version: it gets no data, but can take over" },
        files = { "ok; the standby has another plant file or tag list and cannot take over: the log says why",
                  "leads; the standby has another plant file or tag list and cannot take over: the log says why" },
        denied = { "ok; no standby is connected; this core refuses a node: the log says why",
                   "leads; no standby is connected; this core refuses a node: the log says why" },
        none = { "ok; no standby is connected", "leads; no standby is connected" };
    const struct renderer_peer *standby = find_witness(server);
    if (!standby)
        return find_denied(server) ? &denied : &none;
    if (!is_standby(standby))
        return takes_over(standby) ? &version : &files;
    return standby->differing ? &models : &follows;
}

/* Describes the standby for engineers' pages (`standby` in the message `status`). NULL: this core leads no pair. */
static json_t *describe_standby(const struct server_context *server)
{
    const struct renderer_peer *standby = find_witness(server);
    if (!server->params.keeper || !core_end_leads(server))
        return NULL;
    json_t *text = json_pack("{s:b,s:o}", "connected", standby != NULL, "files", core_files_keys(standby ? standby->differing : 0));
    const struct denial *denied = standby ? NULL : find_denied(server);
    if (denied) {
        json_object_set_new(text, "node", json_string(denied->who));
        json_object_set_new(text, "why", json_string(denied->why));
    }
    if (!standby)
        return text;
    json_object_set_new(text, "node", json_string(standby->name));
    const char *why = standby->behind ? standby->behind : standby->refusal && !standby->other_configuration ? standby->refusal : NULL;
    if (why)
        json_object_set_new(text, "why", json_string(why));
    json_object_set_new(text, "takes_over", json_boolean(takes_over(standby)));
    return text;
}

void renderers_describe_standby(struct server_context *server)
{
    json_t *standby = describe_standby(server), *before = server->session_context.standby;
    const json_t *files = json_object_get(standby, "files");
    counter_set(server->counters.standby_files, (int64_t)json_array_size(files));
    bool changed = standby && before ? !json_equal(standby, before) : standby != before;
    server->session_context.standby = standby;
    server->readings.links_changed |= changed;
    json_decref(before);
}

/* Tells the lease keeper which core is the standby, because only its promise not to take the lead is a vote. */
static void name_standby(struct server_context *server)
{
    const struct renderer_peer *witness = find_witness(server);
    if (server->params.keeper)
        lease_keeper_set_standby(server->params.keeper, witness ? witness->lease : "", witness && is_standby(witness));
    renderers_describe_standby(server);
}

const char *renderers_complete_standby(const struct server_context *server)
{
    const struct renderer_peer *renderer = server->core.renderers;
    while (renderer && !renderer->is_complete)
        renderer = renderer->next;
    return renderer && !server->kept_answers.waiting && !renderers_owe_answers(server) ? renderer->lease : NULL;
}

static void count(struct server_context *server)
{
    int taken = 0;
    for (const struct renderer_peer *renderer = server->core.renderers; renderer; renderer = renderer->next)
        taken += renderer->state == RENDERER_TAKEN && !renderer->stands_by;
    counter_set(server->counters.renderers, taken);
}

static void on_open(struct server_context *server, struct lws *wsi, struct renderer_peer **slot)
{
    struct renderer_peer *renderer = mem_new(sizeof(*renderer));
    *renderer = (struct renderer_peer){ .wsi = wsi, .next = server->core.renderers, .answers = json_array() };
    server->core.renderers = *slot = renderer;
    lws_set_timer_usecs(wsi, TICK_US);
}

static void end_deed(struct deed *deed)
{
    if (deed->session)
        session_retire(&deed->session);
    json_decref(deed->id);
    mem_free(deed);
}

/* Queues the answers to forwarded actions that have reached the disk or could not be written. */
static void settle(struct renderer_peer *renderer)
{
    for (struct deed **at = &renderer->deeds, *deed; (deed = *at);) {
        json_t *texts = session_answers_of(&deed->session);
        if (!texts) {
            at = &deed->next;
            continue;
        }
        json_array_append_new(renderer->answers, json_pack("{s:s,s:O,s:o,s:I}", "type", "answer", "id", deed->id, "texts", texts, ACTED,
                                                           (json_int_t)clock_mono_ns()));
        *at = deed->next;
        end_deed(deed);
        lws_callback_on_writable(renderer->wsi);
    }
}

void renderers_settle(struct server_context *server)
{
    for (struct renderer_peer *renderer = server->core.renderers; renderer; renderer = renderer->next)
        settle(renderer);
}

bool renderers_owe_answers(const struct server_context *server)
{
    for (const struct renderer_peer *renderer = server->core.renderers; renderer; renderer = renderer->next)
        if (renderer->deeds || json_array_size(renderer->answers) > 0)
            return true;
    return false;
}

static void on_close(struct server_context *server, struct renderer_peer **slot)
{
    struct renderer_peer *renderer = *slot, **at = &server->core.renderers;
    if (!renderer)
        return;
    while (*at != renderer)
        at = &(*at)->next;
    *at = renderer->next;
    if (renderer->state == RENDERER_TAKEN)
        log_warn(server->params.log, renderer->stands_by ? "standby %s: disconnected" : "renderer %s: disconnected", renderer->name);
    core_samples_end(&renderer->samples);
    core_sent_finish(&renderer->sent);
    text_finish(&renderer->in);
    text_finish(&renderer->out);
    json_decref(renderer->hello);
    for (struct deed *deed = renderer->deeds, *next; deed; deed = next) {
        next = deed->next;
        end_deed(deed);
    }
    json_decref(renderer->answers);
    mem_free(renderer->links);
    mem_free(renderer->refusal);
    mem_free(renderer->behind);
    mem_free(renderer);
    *slot = NULL;
    name_standby(server);
    count(server);
}

void renderers_on_change(struct server_context *server)
{
    for (struct renderer_peer *renderer = server->core.renderers; renderer; renderer = renderer->next)
        lws_callback_on_writable(renderer->wsi);
}

void renderers_announce_reload(struct server_context *server, const char *configuration)
{
    snprintf(server->core.loads, sizeof(server->core.loads), "%s", configuration);
    for (struct renderer_peer *renderer = server->core.renderers; renderer; renderer = renderer->next)
        renderer->reloads = true;
    renderers_on_change(server);
}

void renderers_close(struct server_context *server, const char *why)
{
    for (struct renderer_peer *renderer = server->core.renderers; renderer; renderer = renderer->next) {
        renderer->close_text = why;
        /* ends the peer's queue of samples, because the store that fills the queue is about to be destroyed */
        core_samples_end(&renderer->samples);
        lws_callback_on_writable(renderer->wsi);
    }
}

/* --- sending -------------------------------------------------------------------------------------------------------------------------- */

static void begin(struct renderer_peer *renderer)
{
    const char room[LWS_PRE] = { 0 };
    renderer->out.length = 0;
    text_add_bytes(&renderer->out, room, sizeof(room));
}

/* Sends the message in renderer->out. libwebsockets buffers what the socket does not accept, and calls back only once all is sent.
   Returns false if the connection is lost. */
static bool send_out(struct renderer_peer *renderer, enum lws_write_protocol how)
{
    size_t count = renderer->out.length - LWS_PRE;
    bool good = lws_write(renderer->wsi, (unsigned char *)renderer->out.at + LWS_PRE, count, how) >= (int)count;
    if (renderer->out.capacity > MAX_MESSAGE_BYTES)
        text_finish(&renderer->out);
    return good;
}

/* Sends a JSON message; takes ownership of `message`. Returns false if the connection is gone. */
static bool send_message(struct renderer_peer *renderer, json_t *message)
{
    char *text = json_text(message, 0);
    begin(renderer);
    text_add_bytes(&renderer->out, text, strlen(text));
    mem_free(text);
    return send_out(renderer, LWS_WRITE_TEXT);
}

/* Tells the renderer that this core is only a standby, so that it looks for the leading core. Returns false if the connection is gone. */
static bool send_standby(struct renderer_peer *renderer)
{
    renderer->close_text = "this core is the standby: connect to the leading core";
    return send_message(renderer, json_pack("{s:s}", "type", "standby"));
}

/* Returns whether the standby was sent all state that it needs to take over. Samples count as sent only if one more message of
   readings was sent after lead_ended_ns (the time when this core's state stopped changing): send_next() looks for waiting
   samples only after that message. */
static bool has_all(const struct server_context *server, const struct renderer_peer *renderer)
{
    int64_t ended_ns = server->life.lead_ended_ns;
    return is_standby(renderer) && ended_ns && renderer->told_ns >= ended_ns && !renderer->last_question;
}

static bool send_reloading(const struct server_context *server, struct renderer_peer *renderer)
{
    renderer->reloads = false;
    return send_message(renderer, json_pack("{s:s,s:s}", "type", "reloading", "configuration", server->core.loads));
}

static bool send_question(const struct server_context *server, struct renderer_peer *renderer, bool last)
{
    uint64_t number = lease_keeper_ask(server->params.keeper);
    renderer->asks = false;
    renderer->last_question = last ? number : renderer->last_question;
    json_t *message = json_pack("{s:s,s:I}", "type", "lease", "number", (json_int_t)number);
    int64_t age_ns = server->params.plant.historian ? historian_sent_age_ns(server->params.plant.historian) : INT64_MAX;
    if (age_ns != INT64_MAX)
        json_object_set_new(message, "sent_age_ms", json_integer(age_ns / NS_PER_MS + 1));
    return send_message(renderer, message);
}

static bool send_refusal(const struct server_context *server, struct renderer_peer *renderer)
{
    bool votes = renderer->state == RENDERER_VOTES;
    renderer->refusal_sent = true;
    renderer->close_text = votes ? NULL : "the core refused this node: the message before says why";
    json_t *message =
        json_pack("{s:s,s:s,s:b,s:b}", "type", "refused", "why", renderer->refusal, "votes", votes, "takes_over", takes_over(renderer));
    if (renderer->other_configuration) {
        const struct core_identity own = own_identity(server);
        json_object_set_new(message, "configuration", json_string(own.configuration));
        json_object_set_new(message, "files", core_files_json(&own.files));
    }
    return send_message(renderer, message);
}

/* Sends the next message to a core that may only vote about who leads: the reason of its refusal, then questions for its promise not to
   take the lead (corelink/lease.h), and nothing else. Returns false if the connection is gone. */
static bool send_to_voter(const struct server_context *server, struct renderer_peer *renderer)
{
    return !renderer->refusal_sent ? send_refusal(server, renderer) : !renderer->asks || send_question(server, renderer, false);
}

static bool links_differ(const struct server_context *server, const struct renderer_peer *renderer)
{
    size_t count = server->session_context.plant->source_count;
    return !renderer->links_sent || memcmp(renderer->links, server->readings.links_up, count * sizeof(*renderer->links)) != 0;
}

static bool send_links(const struct server_context *server, struct renderer_peer *renderer)
{
    json_t *up = json_array();
    for (size_t i = 0; i < server->session_context.plant->source_count; i++) {
        renderer->links[i] = server->readings.links_up[i];
        json_array_append_new(up, json_boolean(renderer->links[i]));
    }
    renderer->links_sent = true;
    return send_message(renderer, json_pack("{s:s,s:o}", "type", "links", "up", up));
}

static struct lists_seen lists_now(const struct server_context *server)
{
    const struct plant_services *plant = &server->params.plant;
    return (struct lists_seen){ named_views_number(plant->named_views),
                                notes_number(plant->notes),
                                wall_remote_number(plant->wall_remote),
                                wall_remote_pointer_number(plant->wall_remote),
                                pairings_number(plant->pairings),
                                short_links_number(plant->short_links),
                                plant->loop_checks ? loop_checks_number(plant->loop_checks) : 0 };
}

static bool send_lists(const struct server_context *server, struct renderer_peer *renderer)
{
    const struct plant_services *plant = &server->params.plant;
    char *pointed = wall_remote_pointers_text(plant->wall_remote, renderer->lists.pointed);
    json_t *message = json_pack("{s:s,s:O,s:O,s:O,s:o,s:o}", "type", "lists", "views", named_views_list(plant->named_views), "notes",
                                notes_list(plant->notes), "walls", wall_remote_list(plant->wall_remote), "pointed",
                                json_loads(pointed, 0, NULL), "pairings", pairings_told(plant->pairings, clock_mono_ns()));
    if (!renderer->lists_sent || renderer->lists.links != short_links_number(plant->short_links))
        json_object_set(message, "links", short_links_list(plant->short_links));
    if (plant->loop_checks && (!renderer->lists_sent || renderer->lists.loop_checks != loop_checks_number(plant->loop_checks)))
        json_object_set_new(message, "proofs",
                            loop_checks_message(plant->loop_checks, server->session_context.plant, renderer->lists.loop_checks,
                                                !renderer->lists_sent));
    renderer->lists = lists_now(server);
    renderer->lists_sent = true;
    mem_free(pointed);
    return send_message(renderer, message);
}

static bool send_alarms(const struct server_context *server, struct renderer_peer *renderer)
{
    uint64_t since = renderer->alarms_sent ? renderer->alarms : 0;
    renderer->alarms_sent = true;
    json_t *message = core_alarms_message(server->params.plant.alarm_service, since, clock_utc_ns(), &renderer->alarms);
    if (renderer->stands_by)
        core_alarms_add_rows(message, server->params.plant.alarm_service, &renderer->rows);
    return send_message(renderer, message);
}

static bool send_told(struct notifier *notifier, struct renderer_peer *renderer)
{
    renderer->told = notifier_number(notifier);
    char *kept = notifier_kept(notifier);
    json_t *message = json_pack("{s:s,s:s}", "type", "told", "kept", kept);
    mem_free(kept);
    return send_message(renderer, message);
}

static bool lacks_told(const struct server_context *server, const struct renderer_peer *renderer)
{
    struct notifier *notifier = server->params.plant.notifier;
    return renderer->stands_by && notifier && renderer->told != notifier_number(notifier);
}

static bool send_answer(struct renderer_peer *renderer)
{
    json_t *answer = json_incref(json_array_get(renderer->answers, 0));
    json_array_remove(renderer->answers, 0);
    json_object_del(answer, ACTED);
    return send_message(renderer, answer);
}

/* Sends a message with samples to a standby. After a message with all waiting samples, the next message has readings even if
   new samples have arrived: on a slow network there would always be new ones. Returns false if the standby must be
   disconnected. */
static bool send_samples(const struct server_context *server, struct renderer_peer *renderer)
{
    begin(renderer);
    int count = core_samples_write(renderer->samples, &renderer->out);
    renderer->samples_sent = count < CORE_SAMPLES_AT_ONCE;
    if (count < 0)
        log_err(server->params.log,
                "standby %s: disconnected: it read samples too slowly; it will read the missing samples from PostgreSQL", renderer->name);
    return count < 0 ? false : count == 0 || send_out(renderer, LWS_WRITE_BINARY);
}

static bool send_readings(struct server_context *server, struct renderer_peer *renderer)
{
    begin(renderer);
    renderer->told_ns = clock_mono_ns();
    core_readings_write(&renderer->out, server->readings.snapshot, &renderer->sent);
    return send_out(renderer, LWS_WRITE_BINARY);
}

/* Lets those connections send again whose answers wait until a standby core has received the state that the answered actions
   changed. */
static void wake_answers(const struct server_context *server)
{
    for (const struct renderer_peer *one = server->core.renderers; one; one = one->next)
        if (json_array_size(one->answers) > 0)
            lws_callback_on_writable(one->wsi);
}

/* Returns whether users' latest actions are not yet sent to the standby. Until then no client is told that its action is done:
   the standby might take over without the action. The core does not wait for a standby that is too slow. */
static bool standby_lacks(const struct server_context *server)
{
    struct lists_seen lists = lists_now(server);
    for (const struct renderer_peer *one = server->core.renderers; one; one = one->next)
        if (one->stands_by && one->state == RENDERER_TAKEN && !one->close_text && one->alarms_sent && one->lists_sent &&
            clock_mono_ns() - one->told_ns < STANDBY_TIMEOUT_NS &&
            (memcmp(&lists, &one->lists, sizeof(lists)) != 0 || one->alarms != alarm_service_number(server->params.plant.alarm_service)))
            return true;
    return false;
}

/* Returns whether the next answer may be sent: the lease must have been confirmed after the action. Otherwise a core that is
   cut off from standby and database would confirm actions that the next leader never receives. */
static bool may_answer(const struct server_context *server, const struct renderer_peer *renderer)
{
    const json_t *acted = json_object_get(json_array_get(renderer->answers, 0), ACTED);
    struct lease_keeper *keeper = server->params.keeper;
    return acted && !standby_lacks(server) &&
           (!keeper || lease_keeper_confirmed_age_ns(keeper) < clock_mono_ns() - json_integer_value(acted));
}

static bool send_hello(struct renderer_peer *renderer)
{
    json_t *hello = renderer->hello;
    renderer->hello = NULL;
    return send_message(renderer, hello);
}

/* Sends one message. Alarms and other rarely changing state go first and readings last, so that readings are never newer than
   the alarms sent before them. But readings that have waited too long go first: without readings the renderer assumes that the
   core is lost. Returns false if the renderer must be disconnected. */
static bool send_next(struct server_context *server, struct renderer_peer *renderer)
{
    struct lists_seen lists = lists_now(server);
    renderer->since_ns = 0;
    if (renderer->state == RENDERER_NEW)
        return true;
    if (renderer->state == RENDERER_VOTES)
        return send_to_voter(server, renderer);
    if (renderer->state == RENDERER_REFUSED)
        return renderer->refusal ? send_refusal(server, renderer) : send_standby(renderer);
    bool good, more = true, waits = renderer->told_ns && clock_mono_ns() - renderer->told_ns > MAX_READINGS_DELAY_NS;
    if (renderer->hello)
        good = send_hello(renderer);
    else if (renderer->asks)
        good = send_question(server, renderer, false);
    else if (renderer->reloads)
        good = send_reloading(server, renderer);
    else if (waits)
        good = send_readings(server, renderer);
    else if (may_answer(server, renderer))
        good = send_answer(renderer);
    else if (links_differ(server, renderer))
        good = send_links(server, renderer);
    else if (!renderer->lists_sent || memcmp(&lists, &renderer->lists, sizeof(lists)) != 0)
        good = send_lists(server, renderer);
    else if (!renderer->alarms_sent || renderer->alarms != alarm_service_number(server->params.plant.alarm_service))
        good = send_alarms(server, renderer);
    else if (lacks_told(server, renderer))
        good = send_told(server->params.plant.notifier, renderer);
    else if (renderer->samples && !renderer->samples_sent)
        good = send_samples(server, renderer);
    else if (has_all(server, renderer))
        good = send_question(server, renderer, true);
    else
        more = renderer->samples_sent = false, good = send_readings(server, renderer);
    if (good && renderer->stands_by && !more)
        wake_answers(server);
    if (good && more)
        lws_callback_on_writable(renderer->wsi);
    return good;
}

/* --- receiving ------------------------------------------------------------------------------------------------------------------------ */

/* Returns an error message if the peer's token has the wrong role, otherwise NULL; the caller frees the message with mem_free. A standby
   may not use a renderer's token, because it may become the core. */
static char *role_refusal(const struct renderer_peer *one)
{
    const struct connection *connection = connection_of(one->wsi);
    enum role role = one->stands_by ? ROLE_STANDBY : ROLE_RENDERER;
    if (connection->role == role || is_local(connection))
        return NULL;
    return mem_printf(
        "the token %s has the role %s, but a %s needs a token of the role %s (plantcast token add FILE --role %s --name NAME)",
        connection->holder.name, name_of(names_role, (int)connection->role), name_of(names_role, (int)role), name_of(names_role, (int)role),
        name_of(names_role, (int)role));
}

/* Returns the reason why peer `one` cannot be a standby, or NULL; the caller frees the text with mem_free. Only one standby is
   accepted, and not under this core's own name, so that it is clear which core made a promise not to take the lead. matches:
   `one` has this core's version and files, and may replace a core that only votes. */
static char *standby_refusal(const struct server_context *server, struct renderer_peer *one, const char *id, bool matches)
{
    if (!server->params.keeper)
        return mem_strdup("this core has no standby: it was started without --core");
    if (!strcmp(one->name, server->params.node_name))
        return mem_printf("both cores have the name %.63s: give each core its own name with --node", one->name);
    for (const struct renderer_peer *other = server->core.renderers; other; other = other->next)
        if (other != one && (matches ? is_standby(other) : is_witness(other)))
            return mem_printf("%.63s is already the standby", other->name);
    if (!id || !lease_name(one->lease, one->name, id))
        return mem_printf("the standby %.63s sent no id, or one that is too long", one->name);
    return NULL;
}

/* Logs a refusal unless it equals the last one logged: a refused peer tries again every second. */
static void say_refusal(struct server_context *server, const struct renderer_peer *renderer)
{
    char said[sizeof(server->core.refused)];
    bool votes = renderer->state == RENDERER_VOTES;
    snprintf(said, sizeof(said), "%s %s: refused: %s%s", renderer->stands_by ? "standby" : "renderer", renderer->name, renderer->refusal,
             takes_over(renderer)  ? "; the standby can take over, and confirms the leader's lease"
             : votes               ? "; the standby cannot take over, but still confirms the leader's lease"
             : renderer->stands_by ? "; the standby cannot take over"
                                   : "");
    if (strcmp(said, server->core.refused) != 0)
        log_err(server->params.log, "%s", said);
    memcpy(server->core.refused, said, sizeof(said));
}

/* Closes the connections of cores that may only vote, once a standby with this core's version and plant files has connected. */
static void end_voters(struct server_context *server)
{
    for (struct renderer_peer *one = server->core.renderers; one; one = one->next)
        if (one->state == RENDERER_VOTES) {
            one->state = RENDERER_REFUSED;
            one->close_text = "another core is the standby";
            lws_callback_on_writable(one->wsi);
        }
}

/* Decides whether to accept a renderer or standby that has introduced itself. A standby whose plant has the same name, but
   other files or another version, is accepted only as a voter: it may be about to be upgraded or reloaded, before or after this
   core. */
static void judge(struct server_context *server, struct renderer_peer *renderer, const json_t *message, const struct core_identity *own)
{
    const char *plant = json_string_value(json_object_get(message, "plant")), *id = json_string_value(json_object_get(message, "id"));
    struct core_files files;
    renderer->differing = core_files_read(message, &files) ? core_files_differing(&own->files, &files) : 0;
    char *cannot_follow = core_identity_difference(message, "renderer", own);
    char *cannot_stand_by = role_refusal(renderer);
    renderer->other_configuration = core_identity_is_other_configuration(message, own);
    if (!cannot_stand_by && renderer->stands_by)
        cannot_stand_by = standby_refusal(server, renderer, id, !cannot_follow);
    bool votes = cannot_follow && renderer->stands_by && !cannot_stand_by && plant && !strcmp(plant, own->plant);
    renderer->refusal = cannot_follow && (votes || !cannot_stand_by) ? cannot_follow : cannot_stand_by;
    renderer->state = !renderer->refusal ? RENDERER_TAKEN : votes ? RENDERER_VOTES : RENDERER_REFUSED;
    mem_free(renderer->refusal == cannot_stand_by ? cannot_follow : cannot_stand_by);
    if (is_standby(renderer))
        end_voters(server);
}

static void introduce(struct server_context *server, struct renderer_peer *renderer, const json_t *message)
{
    const struct core_identity own = own_identity(server);
    const struct plant *plant = server->session_context.plant;
    const char *node = json_string_value(json_object_get(message, "node"));
    snprintf(renderer->name, sizeof(renderer->name), "%s", node ? node : "");
    renderer->stands_by = json_is_true(json_object_get(message, "standby"));
    if (!core_end_leads(server)) {
        renderer->state = RENDERER_REFUSED;
        return;
    }
    judge(server, renderer, message, &own);
    if (renderer->state == RENDERER_REFUSED && renderer->stands_by)
        denials_note(&server->core.denials, renderer->name[0] ? renderer->name : connection_of(renderer->wsi)->address, renderer->refusal,
                     false, clock_mono_ns());
    if (is_standby(renderer))
        denials_forget(&server->core.denials);
    name_standby(server);
    if (renderer->state != RENDERER_TAKEN) {
        say_refusal(server, renderer);
        return;
    }
    core_sent_init(&renderer->sent, plant->tag_count);
    renderer->links = mem_array(plant->source_count + 1, sizeof(*renderer->links));
    renderer->hello = core_identity_message("core", &own);
    json_object_set_new(renderer->hello, "key", json_string(server->core.key));
    if (renderer->stands_by && server->params.agree)
        server->params.agree(server->params.reload_arg, own.files.tags);
    if (renderer->stands_by && server->params.plant.historian)
        historian_on_standby(server->params.plant.historian);
    if (renderer->stands_by)
        renderer->samples = core_samples_listen(server->params.plant.store);
    log_info(server->params.log, renderer->stands_by ? "standby %s: follows" : "renderer %s: connected", renderer->name);
    if (renderer->differing)
        log_err(server->params.log,
                "%s %s: its models differ from this core's, so its pictures show another plant: copy the models to its machine, run "
                "plantcast-prep and reload the plant there",
                renderer->stands_by ? "standby" : "renderer", renderer->name);
    net_refresh_readings(server);
    count(server);
}

/* Verifies the user who sent a message through a renderer. The renderer's own token gives no right to act. Returns NULL and the
 * user in `out`, or the reason of the refusal (static text). */
static const char *verify_person(const struct server_context *server, const struct renderer_peer *renderer, const json_t *message,
                                 struct token_holder *out)
{
    const char *token = json_string_value(json_object_get(message, "token"));
    const char *id_token = json_string_value(json_object_get(message, "id_token"));
    *out = (struct token_holder){ .role = ROLE_NOBODY };
    if (token && server->logins.tokens)
        return !tokens_find(server->logins.tokens, token, clock_utc_ns(), out) ? "the core does not accept this token (its --tokens file)"
               : role_is_node(out->role)                                       ? "this is a daemon's token, which permits no user actions"
                                                                               : NULL;
    if (id_token && server->logins.openid) {
        const char *why = openid_vouch(server->logins.openid, id_token, out);
        connection_tell_apart(server, out);
        return why;
    }
    if (is_local(connection_of(renderer->wsi))) {
        out->role = ROLE_ENGINEER;
        return NULL;
    }
    return id_token ? "the core cannot identify the signed-in user, because the core runs without --openid"
                    : "the core cannot verify the user: use a token, or sign in";
}

static void act(struct server_context *server, struct renderer_peer *renderer, const json_t *message)
{
    const char *from = json_string_value(json_object_get(message, "from"));
    const char *node_token = connection_of(renderer->wsi)->holder.name;
    struct token_holder holder;
    char through[sizeof((struct session_identity){ 0 }.through)];
    snprintf(through, sizeof(through), "node %s, %s%s", renderer->name, node_token[0] ? "token " : "without a token", node_token);
    struct session_person person = { .holder = &holder, .from = from ? from : "", .through = through };
    person.refusal = verify_person(server, renderer, message, &holder);
    char *text = json_dumps(json_object_get(message, "message"), JSON_COMPACT);
    struct deed *deed = mem_new(sizeof(*deed)), **last = &renderer->deeds;
    *deed = (struct deed){ session_do_for(&server->session_context, &person, text ? text : "", clock_mono_ns(), clock_utc_ns()),
                           json_incref(json_object_get(message, "id")), NULL };
    while (*last)
        last = &(*last)->next;
    *last = deed;
    settle(renderer);
    free(text);
    streams_on_alarms(server);
    renderers_on_change(server);
}

static void on_promise(const struct server_context *server, struct renderer_peer *renderer, uint64_t number)
{
    renderer->is_complete |= number && number == renderer->last_question;
    lease_keeper_promised(server->params.keeper, renderer->lease, number);
}

/* Handles a standby's message that it cannot get this core's files. */
static void take_files(struct server_context *server, struct renderer_peer *renderer, const char *why)
{
    if (!why || !renderer->differing || (renderer->behind && !strcmp(renderer->behind, why)))
        return;
    char *files = core_files_text(renderer->differing);
    if (!renderer->behind || !text_equal_but_numbers(renderer->behind, why))
        log_err(server->params.log, "standby %s: has not got this core's %s: %s", renderer->name, files, why);
    mem_free(files);
    mem_free(renderer->behind);
    renderer->behind = mem_strdup(why);
    renderers_describe_standby(server);
}

static const char *on_message(struct server_context *server, struct renderer_peer *renderer)
{
    json_t *message = json_loadb(renderer->in.at, renderer->in.length, JSON_REJECT_DUPLICATES, NULL);
    const char *type = json_string_value(json_object_get(message, "type")), *why = NULL;
    if (!type)
        why = "the renderer or standby sent a message that is not JSON; do both nodes run the same version?";
    else if (!strcmp(type, "renderer") && renderer->state == RENDERER_NEW)
        introduce(server, renderer, message);
    else if (!strcmp(type, "promise") && is_witness(renderer) && server->params.keeper)
        on_promise(server, renderer, (uint64_t)json_integer_value(json_object_get(message, "number")));
    else if (!strcmp(type, "files") && is_witness(renderer))
        take_files(server, renderer, json_string_value(json_object_get(message, "why")));
    else if (renderer->state != RENDERER_TAKEN)
        why = "the first message of the renderer or standby is not an introduction (type renderer)";
    else if (server->life.hands_over)
        /* Ignores the forwarded action, because this core is handing over the lead. When the connection ends, the renderer
           tells the user that the connection was lost. */
        why = NULL;
    else if (!strcmp(type, "act") && json_is_integer(json_object_get(message, "id")))
        act(server, renderer, message);
    else if (!strcmp(type, "pairing") && server->logins.tokens)
        pairings_ask_for(server->params.plant.pairings, message, clock_mono_ns());
    json_decref(message);
    return json_array_size(renderer->answers) > MAX_ANSWERS
               ? "too many unread answers: the renderer or standby does not read this core's answers"
               : why;
}

/* Handles bytes received from a renderer or standby. Returns -1 if the connection must end. */
static int on_receive(struct server_context *server, struct renderer_peer *renderer, const void *bytes, size_t count_bytes)
{
    const char *why = NULL;
    if (renderer->in.length + count_bytes > MAX_MESSAGE_BYTES)
        why = "the renderer or standby sent a message of more than 256 kB; do both nodes run the same version?";
    else
        text_add_bytes(&renderer->in, bytes, count_bytes);
    if (!why && lws_remaining_packet_payload(renderer->wsi) == 0 && lws_is_final_fragment(renderer->wsi)) {
        why = on_message(server, renderer);
        renderer->in.length = 0;
        lws_callback_on_writable(renderer->wsi);
    }
    if (why)
        log_err(server->params.log, "renderer %s: disconnected: %s", renderer->name, why);
    return why ? -1 : 0;
}

/* --- libwebsockets events ------------------------------------------------------------------------------------------------------------- */

/* Sends readings regularly even if nothing changes: their age grows, and a renderer takes silence for the loss of the core.
   Returns -1 if the renderer must be disconnected, else 0. */
static int on_beat(struct server_context *server, struct renderer_peer *renderer)
{
    int64_t now_ns = clock_mono_ns();
    const struct token_holder *holder = &connection_of(renderer->wsi)->holder;
    if (server->logins.tokens && holder->name[0] && tokens_role(server->logins.tokens, holder, clock_utc_ns()) != holder->role) {
        log_warn(server->params.log, "renderer %s: disconnected: its token no longer has the role %s", renderer->name,
                 name_of(names_role, (int)holder->role));
        return -1;
    }
    net_refresh_readings(server);
    renderer->asks = is_witness(renderer);
    renderer->since_ns = renderer->since_ns ? renderer->since_ns : now_ns;
    lws_callback_on_writable(renderer->wsi);
    lws_set_timer_usecs(renderer->wsi, TICK_US);
    if (now_ns - renderer->since_ns < SEND_TIMEOUT_S * NS_PER_S)
        return 0;
    log_warn(server->params.log, "renderer %s: disconnected: the renderer read nothing for %d s", renderer->name, SEND_TIMEOUT_S);
    return -1;
}

static int on_writeable(struct server_context *server, struct renderer_peer *renderer)
{
    if (!renderer->close_text)
        return send_next(server, renderer) ? 0 : -1;
    /* keeps the connection open until the answers to these forwarded actions are sent; settle() and on_beat() request the next
       callback then */
    if (renderer->deeds)
        return 0;
    if (json_array_size(renderer->answers) > 0 && !server->life.goes_down) {
        if (!may_answer(server, renderer))
            return 0;
        lws_callback_on_writable(renderer->wsi);
        return send_answer(renderer) ? 0 : -1;
    }
    lws_close_reason(renderer->wsi, LWS_CLOSE_STATUS_GOINGAWAY, (unsigned char *)renderer->close_text, strlen(renderer->close_text));
    return -1;
}

int renderer_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct renderer_peer **slot = user;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED: on_open(server_context_of(wsi), wsi, slot); break;
    case LWS_CALLBACK_CLOSED: on_close(server_context_of(wsi), slot); break;
    case LWS_CALLBACK_RECEIVE: return on_receive(server_context_of(wsi), *slot, in, len);
    case LWS_CALLBACK_TIMER: return on_beat(server_context_of(wsi), *slot);
    case LWS_CALLBACK_SERVER_WRITEABLE: return on_writeable(server_context_of(wsi), *slot);
    default: break;
    }
    return 0;
}
