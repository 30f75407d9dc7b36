/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection of a renderer: an introduction, then whatever is newer than what it was sent last. */
#include "net/renderers.h"

#include <openssl/rand.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/hex.h"
#include "base/text/json_text.h"
#include "corelink/core_alarms.h"
#include "corelink/core_identity.h"
#include "corelink/core_readings.h"
#include "corelink/core_samples.h"
#include "message/names.h"
#include "net/connection.h"
#include "net/core_end.h"
#include "session/session_proxy.h"

enum { BEAT_US = 200000, MOST_BYTES = 256 * 1024 /* of one message */, MOST_ANSWERS = 1024, PATIENCE_S = 5 };
static const int64_t READINGS_NS = 500 * NS_PER_MS, PATIENT_NS = 2 * NS_PER_S;

struct lists_seen {
    uint64_t views, notes, walls, pointed, pairings;
};

struct deed {
    struct session *session; /* session_proxy.h */
    json_t *id;              /* id of the message, for the answer */
    struct deed *next;
};

struct renderer_peer {
    struct lws *wsi;
    struct renderer_peer *next;
    char name[64];           /* of its node, as it says */
    char lease[LEASE_NODE_BYTES]; /* of a standby: what tells it from others of its name */
    struct text in, out;     /* out: what is being made, behind LWS_PRE bytes */
    enum { RENDERER_NEW, RENDERER_TAKEN, RENDERER_VOTES, RENDERER_REFUSED } state; /* votes: is refused all but its promises */
    char *refusal;           /* why; NULL: it is not refused */
    bool refusal_sent;       /* to one that votes */
    struct core_sent sent;
    bool alarms_sent, lists_sent, links_sent;
    bool stands_by;          /* a core that follows this one, and takes its place */
    bool samples_sent;       /* all of them, since the last readings */
    bool asks;               /* it is to be asked for its promise */
    struct core_samples *samples; /* that it is sent, for its history; NULL: none */
    int64_t journal_utc_ns;  /* of a standby: the newest change that its journal has */
    uint64_t told;           /* of a standby: likewise, of what the notifier keeps */
    uint64_t rows;           /* of a standby: likewise, of the journal */
    uint64_t alarms;         /* the number of the last change that was sent */
    struct lists_seen lists;
    bool *links;             /* by source, as sent */
    json_t *hello;           /* who this core is, before anything else; NULL: it was sent */
    json_t *answers;         /* that wait to be sent */
    struct deed *deeds;      /* actions that are not on disk yet */
    int64_t told_ns;         /* monotonic: when readings were sent last */
    int64_t since_ns;        /* monotonic: since when something waits to be sent; 0: nothing */
    const char *close_text;  /* NULL: it stays */
};

/* Returns whether the peer is on this machine and needs no token; its role is engineer. */
static bool is_local(const struct connection *connection)
{
    return connection->role == ROLE_ENGINEER && !connection->holder.name[0];
}

const char *renderers_refusal(const struct server_context *server, struct lws *wsi)
{
    const struct connection *connection = connection_of(wsi);
    if (!server->params.is_core)
        return "this daemon is no core: it has no --role core\n";
    return role_is_node(connection->role) || is_local(connection) ? NULL : "this takes a token of the role renderer or standby\n";
}

void renderers_make_key(struct server_context *server)
{
    uint8_t key[VIEW_TOKEN_KEY_BYTES];
    if (RAND_bytes(key, sizeof(key)) != 1)
        return;
    hex_print(key, sizeof(key), server->core_key);
}

/* --- coming and going --------------------------------------------------------------------------------------------------------- */

static struct core_identity own_identity(const struct server_context *server)
{
    const struct plant *plant = server->session_context.plant;
    return (struct core_identity){ server->params.version, plant->name, plant->hash };
}

/* Returns whether promises of the other core count: with other files it is no standby, and as good a witness that it does not lead. */
static bool is_witness(const struct renderer_peer *renderer)
{
    return renderer->stands_by && (renderer->state == RENDERER_TAKEN || renderer->state == RENDERER_VOTES);
}

/* Returns whether a core holds the standby's seat: it has this core's version, plant and configuration. */
static bool is_standby(const struct renderer_peer *renderer)
{
    return renderer->stands_by && renderer->state == RENDERER_TAKEN;
}

/* Names the core whose promises count, of which there is one at most. */
static void name_standby(struct server_context *server)
{
    const struct renderer_peer *witness = NULL;
    for (const struct renderer_peer *renderer = server->renderers; renderer; renderer = renderer->next)
        if (is_witness(renderer))
            witness = renderer;
    if (server->params.keeper)
        lease_keeper_set_standby(server->params.keeper, witness ? witness->lease : "", witness && is_standby(witness));
}

bool renderers_have_standby(const struct server_context *server)
{
    const struct renderer_peer *renderer = server->renderers;
    while (renderer && !is_standby(renderer))
        renderer = renderer->next;
    return renderer;
}

static void count(struct server_context *server)
{
    int taken = 0;
    for (const struct renderer_peer *renderer = server->renderers; renderer; renderer = renderer->next)
        taken += renderer->state == RENDERER_TAKEN;
    counter_set(server->counters.renderers, taken);
}

static void on_open(struct server_context *server, struct lws *wsi, struct renderer_peer **slot)
{
    struct renderer_peer *renderer = mem_new(sizeof(*renderer));
    *renderer = (struct renderer_peer){ .wsi = wsi, .next = server->renderers, .answers = json_array() };
    server->renderers = *slot = renderer;
    lws_set_timer_usecs(wsi, BEAT_US);
}

static void end_deed(struct deed *deed)
{
    session_destroy(&deed->session);
    json_decref(deed->id);
    mem_free(deed);
}

/* Answers actions that are on disk, or cannot be kept. */
static void settle(struct renderer_peer *renderer)
{
    for (struct deed **at = &renderer->deeds, *deed; (deed = *at);) {
        json_t *texts = session_answers_of(&deed->session);
        if (!texts) {
            at = &deed->next;
            continue;
        }
        json_array_append_new(renderer->answers, json_pack("{s:s,s:O,s:o}", "type", "answer", "id", deed->id, "texts", texts));
        *at = deed->next;
        end_deed(deed);
        lws_callback_on_writable(renderer->wsi);
    }
}

void renderers_settle(struct server_context *server)
{
    for (struct renderer_peer *renderer = server->renderers; renderer; renderer = renderer->next)
        settle(renderer);
}

static void on_close(struct server_context *server, struct renderer_peer **slot)
{
    struct renderer_peer *renderer = *slot, **at = &server->renderers;
    if (!renderer)
        return;
    while (*at != renderer)
        at = &(*at)->next;
    *at = renderer->next;
    if (renderer->state == RENDERER_TAKEN)
        log_warn(server->params.log, renderer->stands_by ? "standby %s: gone" : "renderer %s: gone", renderer->name);
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
    mem_free(renderer);
    *slot = NULL;
    name_standby(server);
    count(server);
}

void renderers_on_change(struct server_context *server)
{
    for (struct renderer_peer *renderer = server->renderers; renderer; renderer = renderer->next)
        lws_callback_on_writable(renderer->wsi);
}

void renderers_close(struct server_context *server, const char *why)
{
    for (struct renderer_peer *renderer = server->renderers; renderer; renderer = renderer->next) {
        renderer->close_text = why;
        core_samples_end(&renderer->samples); /* their store ends */
        lws_callback_on_writable(renderer->wsi);
    }
}

/* --- what goes ---------------------------------------------------------------------------------------------------------------- */

static void begin(struct renderer_peer *renderer)
{
    const char room[LWS_PRE] = { 0 };
    renderer->out.length = 0;
    text_add_bytes(&renderer->out, room, sizeof(room));
}

/* lws keeps what the socket does not take, and asks for nothing more until that is gone. */
static bool send_out(struct renderer_peer *renderer, enum lws_write_protocol how)
{
    size_t count = renderer->out.length - LWS_PRE;
    bool good = lws_write(renderer->wsi, (unsigned char *)renderer->out.at + LWS_PRE, count, how) >= (int)count;
    if (renderer->out.capacity > MOST_BYTES)
        text_finish(&renderer->out);
    return good;
}

/* Takes the message. */
static bool send_message(struct renderer_peer *renderer, json_t *message)
{
    char *text = json_text(message, 0);
    begin(renderer);
    text_add_bytes(&renderer->out, text, strlen(text));
    mem_free(text);
    return send_out(renderer, LWS_WRITE_TEXT);
}

/* It goes on looking for who leads. */
static bool send_standby(struct renderer_peer *renderer)
{
    renderer->close_text = "it stands by";
    return send_message(renderer, json_pack("{s:s}", "type", "standby"));
}

static bool send_question(const struct server_context *server, struct renderer_peer *renderer)
{
    renderer->asks = false;
    json_int_t number = (json_int_t)lease_keeper_ask(server->params.keeper);
    json_t *message = json_pack("{s:s,s:I}", "type", "lease", "number", number);
    int64_t age_ns = server->params.plant.historian ? historian_sent_age_ns(server->params.plant.historian) : INT64_MAX;
    if (age_ns != INT64_MAX)
        json_object_set_new(message, "sent_age_ms", json_integer(age_ns / NS_PER_MS + 1));
    return send_message(renderer, message);
}

static bool send_refusal(struct renderer_peer *renderer)
{
    bool votes = renderer->state == RENDERER_VOTES;
    renderer->refusal_sent = true;
    renderer->close_text = votes ? NULL : "it is refused";
    return send_message(renderer, json_pack("{s:s,s:s,s:b}", "type", "refused", "why", renderer->refusal, "votes", votes));
}

/* Nothing else of this core is for one that votes. */
static bool send_to_voter(const struct server_context *server, struct renderer_peer *renderer)
{
    return !renderer->refusal_sent ? send_refusal(renderer) : !renderer->asks || send_question(server, renderer);
}

static bool links_differ(const struct server_context *server, const struct renderer_peer *renderer)
{
    size_t count = server->session_context.plant->source_count;
    return !renderer->links_sent || memcmp(renderer->links, server->links_up, count * sizeof(*renderer->links)) != 0;
}

static bool send_links(const struct server_context *server, struct renderer_peer *renderer)
{
    json_t *up = json_array();
    for (size_t i = 0; i < server->session_context.plant->source_count; i++) {
        renderer->links[i] = server->links_up[i];
        json_array_append_new(up, json_boolean(renderer->links[i]));
    }
    renderer->links_sent = true;
    return send_message(renderer, json_pack("{s:s,s:o}", "type", "links", "up", up));
}

static struct lists_seen lists_now(const struct server_context *server)
{
    const struct net_plant *plant = &server->params.plant;
    return (struct lists_seen){ named_views_number(plant->named_views), notes_number(plant->notes), wall_remote_number(plant->wall_remote),
                                wall_remote_pointer_number(plant->wall_remote), pairings_number(plant->pairings) };
}

static bool send_lists(const struct server_context *server, struct renderer_peer *renderer)
{
    const struct net_plant *plant = &server->params.plant;
    char *pointed = wall_remote_pointers_text(plant->wall_remote, renderer->lists.pointed);
    json_t *message = json_pack("{s:s,s:O,s:O,s:O,s:o,s:o}", "type", "lists", "views", named_views_list(plant->named_views), "notes",
                                notes_list(plant->notes), "walls", wall_remote_list(plant->wall_remote), "pointed",
                                json_loads(pointed, 0, NULL), "pairings", pairings_told(plant->pairings, clock_mono_ns()));
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
        core_alarms_add_rows(message, server->params.plant.alarm_service, &renderer->rows, renderer->journal_utc_ns);
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
    return send_message(renderer, answer);
}

/* Once it has sent less than a whole message, readings are next, also where new samples have come meanwhile: else, on a slow network, new
   ones always would have. */
static bool send_samples(const struct server_context *server, struct renderer_peer *renderer)
{
    begin(renderer);
    int count = core_samples_write(renderer->samples, &renderer->out);
    renderer->samples_sent = count < CORE_SAMPLES_AT_ONCE;
    if (count < 0)
        log_err(server->params.log, "standby %s: ended: it took its samples too slowly; it reads them from PostgreSQL", renderer->name);
    return count < 0 ? false : count == 0 || send_out(renderer, LWS_WRITE_BINARY);
}

static bool send_readings(struct server_context *server, struct renderer_peer *renderer)
{
    begin(renderer);
    renderer->told_ns = clock_mono_ns();
    core_readings_write(&renderer->out, server->snapshot, &renderer->sent);
    return send_out(renderer, LWS_WRITE_BINARY);
}

/* Of those that waited for a standby. */
static void wake_answers(const struct server_context *server)
{
    for (const struct renderer_peer *one = server->renderers; one; one = one->next)
        if (json_array_size(one->answers) > 0)
            lws_callback_on_writable(one->wsi);
}

/* Until the one that would take our place was sent what somebody did, nobody is told that it is done; a slow one is not waited for. */
static bool standby_lacks(const struct server_context *server)
{
    struct lists_seen lists = lists_now(server);
    for (const struct renderer_peer *one = server->renderers; one; one = one->next)
        if (one->stands_by && one->state == RENDERER_TAKEN && !one->close_text && one->alarms_sent && one->lists_sent &&
            clock_mono_ns() - one->told_ns < PATIENT_NS &&
            (memcmp(&lists, &one->lists, sizeof(lists)) != 0 || one->alarms != alarm_service_number(server->params.plant.alarm_service)))
            return true;
    return false;
}

static bool send_hello(struct renderer_peer *renderer)
{
    json_t *hello = renderer->hello;
    renderer->hello = NULL;
    return send_message(renderer, hello);
}

/* One message at a time: what changed most rarely first, readings last, which so are never newer than the alarms beside them; but readings
   that the others kept waiting come first, for without them the core counts as lost. */
static bool send_next(struct server_context *server, struct renderer_peer *renderer)
{
    struct lists_seen lists = lists_now(server);
    renderer->since_ns = 0;
    if (renderer->state == RENDERER_NEW)
        return true;
    if (renderer->state == RENDERER_VOTES)
        return send_to_voter(server, renderer);
    if (renderer->state == RENDERER_REFUSED)
        return renderer->refusal ? send_refusal(renderer) : send_standby(renderer);
    bool good, more = true, waits = renderer->told_ns && clock_mono_ns() - renderer->told_ns > READINGS_NS;
    if (renderer->hello)
        good = send_hello(renderer);
    else if (renderer->asks)
        good = send_question(server, renderer);
    else if (waits)
        good = send_readings(server, renderer);
    else if (json_array_size(renderer->answers) > 0 && !standby_lacks(server))
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
    else
        more = renderer->samples_sent = false, good = send_readings(server, renderer);
    if (good && renderer->stands_by && !more)
        wake_answers(server);
    if (good && more)
        lws_callback_on_writable(renderer->wsi);
    return good;
}

/* --- what comes --------------------------------------------------------------------------------------------------------------- */

/* Returns why the peer's token has the wrong role, or NULL (mem_free). A renderer's token must not open the standby's seat, whose holder
   takes over as core. */
static char *role_refusal(const struct renderer_peer *one)
{
    const struct connection *connection = connection_of(one->wsi);
    enum role role = one->stands_by ? ROLE_STANDBY : ROLE_RENDERER;
    if (connection->role == role || is_local(connection))
        return NULL;
    return mem_printf("its token %s has the role %s, and a %s takes one of the role %s (plantcast token add FILE --role %s --name NAME)",
                      connection->holder.name, name_of(names_role, (int)connection->role), name_of(names_role, (int)role),
                      name_of(names_role, (int)role), name_of(names_role, (int)role));
}

/* Returns why `one` cannot stand by, or NULL (mem_free). Names are unique and there is one standby, so that each promise has one author.
   matches: `one` has this core's version and files, and may replace a core that only votes. */
static char *standby_refusal(const struct server_context *server, struct renderer_peer *one, const char *id, bool matches)
{
    if (!server->params.keeper)
        return mem_strdup("this core has no standby: it was started without --core");
    if (!strcmp(one->name, server->params.node_name))
        return mem_printf("both cores have the name %.63s: --node names them", one->name);
    for (const struct renderer_peer *other = server->renderers; other; other = other->next)
        if (other != one && (matches ? is_standby(other) : is_witness(other)))
            return mem_printf("%.63s stands by already", other->name);
    if (!id || !lease_name(one->lease, one->name, id))
        return mem_printf("the standby %.63s does not tell its id, or it is too long", one->name);
    return NULL;
}

/* It comes again every second. */
static void say_refusal(struct server_context *server, const struct renderer_peer *renderer)
{
    char said[sizeof(server->renderer_refused)];
    bool votes = renderer->state == RENDERER_VOTES;
    snprintf(said, sizeof(said), "%s %s: refused: %s%s", renderer->stands_by ? "standby" : "renderer", renderer->name, renderer->refusal,
             votes                 ? "; it is no standby, but its promises count"
             : renderer->stands_by ? "; it is no standby"
                                   : "");
    if (strcmp(said, server->renderer_refused) != 0)
        log_err(server->params.log, "%s", said);
    memcpy(server->renderer_refused, said, sizeof(said));
}

/* Closes cores that only vote, once a standby with this version and these files has come. */
static void end_voters(struct server_context *server)
{
    for (struct renderer_peer *one = server->renderers; one; one = one->next)
        if (one->state == RENDERER_VOTES) {
            one->state = RENDERER_REFUSED;
            one->close_text = "another core stands by";
            lws_callback_on_writable(one->wsi);
        }
}

/* Of a standby of this plant that has other files, or another version, for it is loaded anew or replaced before or after this core, the
   promise counts. */
static void judge(struct server_context *server, struct renderer_peer *renderer, const json_t *message, const struct core_identity *own)
{
    const char *plant = json_string_value(json_object_get(message, "plant")), *id = json_string_value(json_object_get(message, "id"));
    char *cannot_follow = core_identity_difference(message, "renderer", own);
    char *cannot_stand_by = role_refusal(renderer);
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
    name_standby(server);
    if (renderer->state != RENDERER_TAKEN) {
        say_refusal(server, renderer);
        return;
    }
    core_sent_init(&renderer->sent, plant->tag_count);
    renderer->links = mem_array(plant->source_count + 1, sizeof(*renderer->links));
    renderer->hello = core_identity_message("core", &own);
    json_object_set_new(renderer->hello, "key", json_string(server->core_key));
    if (renderer->stands_by && server->params.plant.historian)
        historian_on_standby(server->params.plant.historian);
    renderer->journal_utc_ns = json_integer_value(json_object_get(message, "journal"));
    if (renderer->stands_by)
        renderer->samples = core_samples_listen(server->params.plant.store);
    log_info(server->params.log, renderer->stands_by ? "standby %s: follows" : "renderer %s: connected", renderer->name);
    net_refresh_readings(server);
    count(server);
}

/* Verifies who sent a message through a renderer. The renderer's own token grants no right to act. Returns NULL and the person in *out, or
   the reason of the refusal (static). */
static const char *verify_person(const struct server_context *server, const struct renderer_peer *renderer, const json_t *message,
                                 struct token_holder *out)
{
    const char *token = json_string_value(json_object_get(message, "token"));
    const char *id_token = json_string_value(json_object_get(message, "id_token"));
    *out = (struct token_holder){ .role = ROLE_NOBODY };
    if (token && server->tokens)
        return !tokens_find(server->tokens, token, clock_utc_ns(), out) ? "the core does not let this token in (its --tokens file)"
               : role_is_node(out->role)                                ? "a daemon's token lets nobody act"
                                                                        : NULL;
    if (id_token && server->openid) {
        const char *why = openid_vouch(server->openid, id_token, out);
        connection_tell_apart(server, out);
        return why;
    }
    if (is_local(connection_of(renderer->wsi))) {
        out->role = ROLE_ENGINEER;
        return NULL;
    }
    return id_token ? "the core cannot tell who is signed in: it has no --openid"
                    : "the core cannot tell who this is: it takes a token, or somebody who is signed in";
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

static const char *on_message(struct server_context *server, struct renderer_peer *renderer)
{
    json_t *message = json_loadb(renderer->in.at, renderer->in.length, JSON_REJECT_DUPLICATES, NULL);
    const char *type = json_string_value(json_object_get(message, "type")), *why = NULL;
    if (!type)
        why = "what it says is no JSON";
    else if (!strcmp(type, "renderer") && renderer->state == RENDERER_NEW)
        introduce(server, renderer, message);
    else if (!strcmp(type, "promise") && is_witness(renderer) && server->params.keeper)
        lease_keeper_promised(server->params.keeper, renderer->lease, (uint64_t)json_integer_value(json_object_get(message, "number")));
    else if (renderer->state != RENDERER_TAKEN)
        why = "it did not say who it is";
    else if (!strcmp(type, "act") && json_is_integer(json_object_get(message, "id")))
        act(server, renderer, message);
    else if (!strcmp(type, "pairing") && server->tokens)
        pairings_ask_for(server->params.plant.pairings, message, clock_mono_ns());
    json_decref(message);
    return json_array_size(renderer->answers) > MOST_ANSWERS ? "it reads no answers" : why;
}

/* Returns -1 if the connection is to end. */
static int on_receive(struct server_context *server, struct renderer_peer *renderer, const void *bytes, size_t count_bytes)
{
    const char *why = NULL;
    if (renderer->in.length + count_bytes > MOST_BYTES)
        why = "a message of more than 256 kB";
    else
        text_add_bytes(&renderer->in, bytes, count_bytes);
    if (!why && lws_remaining_packet_payload(renderer->wsi) == 0 && lws_is_final_fragment(renderer->wsi)) {
        why = on_message(server, renderer);
        renderer->in.length = 0;
        lws_callback_on_writable(renderer->wsi);
    }
    if (why)
        log_err(server->params.log, "renderer %s: ended: %s", renderer->name, why);
    return why ? -1 : 0;
}

/* --- lws ---------------------------------------------------------------------------------------------------------------------- */

/* Steady readings get older, too; and silence would mean that the core is lost. */
static int on_beat(struct server_context *server, struct renderer_peer *renderer)
{
    int64_t now_ns = clock_mono_ns();
    const struct token_holder *holder = &connection_of(renderer->wsi)->holder;
    if (server->tokens && holder->name[0] && tokens_role(server->tokens, holder, clock_utc_ns()) != holder->role) {
        log_warn(server->params.log, "renderer %s: ended: its token is no longer one of a %s", renderer->name,
                 name_of(names_role, (int)holder->role));
        return -1;
    }
    net_refresh_readings(server);
    renderer->asks = is_witness(renderer);
    renderer->since_ns = renderer->since_ns ? renderer->since_ns : now_ns;
    lws_callback_on_writable(renderer->wsi);
    lws_set_timer_usecs(renderer->wsi, BEAT_US);
    if (now_ns - renderer->since_ns < PATIENCE_S * NS_PER_S)
        return 0;
    log_warn(server->params.log, "renderer %s: ended: it took nothing for %d s", renderer->name, PATIENCE_S);
    return -1;
}

static int on_writeable(struct server_context *server, struct renderer_peer *renderer)
{
    if (!renderer->close_text)
        return send_next(server, renderer) ? 0 : -1;
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
