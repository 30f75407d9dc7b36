/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread on a renderer or standby that connects to a core, handles the core's messages and sends queued ones. */
#include "corelink/core_link.h"

#include <arpa/inet.h>
#include <errno.h>
#include <libwebsockets.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/files/secret.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "base/thread.h"
#include "corelink/core_alarms.h"
#include "corelink/core_identity.h"
#include "corelink/core_readings.h"
#include "corelink/core_samples.h"
#include "notify/notifier.h"
#include "value/backoff.h"
#include "value/lookup.h"

enum { CORE_ACT_BYTES = 200 * 1024 /* maximum length in bytes of an act (a user's action that a renderer forwards to the core); below the
                                      core's own limit */ };
/* MAX_MESSAGE_BYTES: largest message accepted from the core */
enum { MAX_MESSAGE_BYTES = 64 << 20, TOKEN_BYTES = 256, WHY_BYTES = 300, LOOK_US = 200000, ADDRESSES = 8 };
static const int64_t CONNECT_NS = 4 * NS_PER_S, CLOCKS_NS = 2 * NS_PER_S /* CLOCKS_NS: clock difference between core and renderer above
                                                                            which a warning is logged */;
/* if the plant clock of this daemon (already adjusted to the core) differs from the core's clock by no more than this, it is
   not adjusted again, so that the clock on the pages does not jump */
static const int64_t STEP_NS = 500 * NS_PER_MS;
/* limit on the network's delay: more delayed messages of the core are not used to compare the two machines' clocks */
static const int64_t QUICK_NS = 100 * NS_PER_MS;

struct pending_request {
    uint64_t id, client; /* ids of a forwarded action and of the client that sent it; id 0: the entry is free */
};

struct core_link {
    struct core_link_params params;
    /* value of the HTTP header `Authorization` that the link sends to the core; empty: the header is not sent */
    char authorization[TOKEN_BYTES + sizeof("Bearer ")];
    int stop_fd;
    counter *up[CORE_URLS], *connects, *refused, *behind;
    /* --- below: members that only the link's thread uses */
    struct mirrored *readings; /* buffer with room for one reading of each tag, into which messages are parsed */
    struct text in;
    struct lws *wsi;
    struct host_turn turn;
    struct {
        /* count: number of addresses of the core's host name, at most ADDRESSES; index: the address to try next */
        int count, index;
        /* by address of the core's host: last logged reason why the link could not connect to the address */
        char said[ADDRESSES][WHY_BYTES];
    } hosts[CORE_URLS];
    int address;                                       /* index of the core's address that the link is trying */
    /* heard_ns: time of the core's newest message. least_ns: smallest difference between the two machines' monotonic clocks on
       this connection. readings_ns: arrival time of the previous message with readings. core_readings_read() uses and updates
       the last two */
    int64_t heard_ns, begun_ns, least_ns, readings_ns;
    /* votes: this standby gets no readings over the connection, but promises the leader, when asked, not to take over */
    bool ended, taken, votes, introduced, clock_said;
    /* true: the connection failed because this node or the core is misconfigured; false: the connection was lost */
    bool at_fault;
    char why[WHY_BYTES]; /* why this connection ended */
    struct thread thread;
    /* --- below: under thread.lock */
    struct lws_context *context; /* libwebsockets context for the connection to the core; NULL: not connected */
    bool is_up;
    bool is_known;    /* true: this connection's core has accepted this node, or keeps the connection so that this core votes */
    int leader_index; /* index in params.urls of the core that last accepted this node or refused its configuration; -1: none yet */
    uint64_t session; /* number of the connection that delivers readings, unique among all links of this process */
    int up_index;     /* index in params.urls of the core that sends this daemon readings */
    struct text *out; /* messages queued for sending to the core */
    size_t out_count, out_capacity;
    struct pending_request waiting[CORE_ACTS];
    uint64_t last_id;
    struct core_arrival *arrivals, **last_arrival;
};

/* --- functions that the event loop calls ------------------------------------------------------------------------------------ */

static void arrive(struct core_link *link, uint64_t client, char *text)
{
    struct core_arrival *arrival = mem_new(sizeof(*arrival));
    *arrival = (struct core_arrival){ .client = client, .text = text };
    pthread_mutex_lock(&link->thread.lock);
    *link->last_arrival = arrival;
    link->last_arrival = &arrival->next;
    pthread_mutex_unlock(&link->thread.lock);
    link->params.notify(link->params.notify_arg);
}

struct core_arrival *core_link_collect(struct core_link *link)
{
    pthread_mutex_lock(&link->thread.lock);
    struct core_arrival *arrivals = link->arrivals;
    link->arrivals = NULL;
    link->last_arrival = &link->arrivals;
    pthread_mutex_unlock(&link->thread.lock);
    return arrivals;
}

void core_arrival_free(struct core_arrival *arrival)
{
    mem_free(arrival->text);
    mem_free(arrival);
}

bool core_link_is_up(struct core_link *link)
{
    pthread_mutex_lock(&link->thread.lock);
    bool up = link->is_up;
    pthread_mutex_unlock(&link->thread.lock);
    return up;
}

uint64_t core_link_session(struct core_link *link)
{
    pthread_mutex_lock(&link->thread.lock);
    uint64_t session = link->is_up ? link->session : 0;
    pthread_mutex_unlock(&link->thread.lock);
    return session;
}

/* Queues a message to the core; takes ownership of `text`. Call with the lock held. */
static void queue(struct core_link *link, char *text)
{
    mem_grow(&link->out, &link->out_capacity, link->out_count + 1, sizeof(*link->out));
    struct text *out = &link->out[link->out_count++];
    const char room[LWS_PRE] = { 0 };
    *out = (struct text){ 0 };
    text_add_bytes(out, room, sizeof(room)); /* libwebsockets writes the frame header to this space in front of the text */
    text_add_bytes(out, text, strlen(text));
    mem_free(text);
}

/* Packs a forwarded user action into a message. Returns NULL if the message would be too long, because the core would then
   close the connection. */
static char *pack_act(const struct core_act *act, uint64_t id)
{
    json_t *message = json_loads(act->text, 0, NULL);
    if (!message)
        return NULL;
    json_t *all = json_pack("{s:s,s:I,s:s,s:s*,s:s*,s:o}", "type", "act", "id", (json_int_t)id, "from", act->from, "token", act->token,
                            "id_token", act->id_token, "message", message);
    char *text = json_text(all, 0);
    json_t *again = text && strlen(text) <= CORE_ACT_BYTES ? json_loads(text, 0, NULL) : NULL;
    if (!again)
        mem_free(text);
    bool good = again;
    json_decref(again);
    return good ? text : NULL;
}

bool core_link_act(struct core_link *link, const struct core_act *act)
{
    size_t free_at = 0;
    pthread_mutex_lock(&link->thread.lock);
    while (free_at < CORE_ACTS && link->waiting[free_at].id)
        free_at++;
    char *text = link->is_up && free_at < CORE_ACTS ? pack_act(act, link->last_id + 1) : NULL;
    if (text) {
        link->waiting[free_at] = (struct pending_request){ ++link->last_id, act->client };
        queue(link, text);
        lws_cancel_service(link->context);
    }
    pthread_mutex_unlock(&link->thread.lock);
    return text;
}

bool core_link_tell(struct core_link *link, const char *text)
{
    pthread_mutex_lock(&link->thread.lock);
    bool up = link->is_up;
    if (up) {
        queue(link, mem_strdup(text));
        lws_cancel_service(link->context);
    }
    pthread_mutex_unlock(&link->thread.lock);
    return up;
}

void core_link_report_files(struct core_link *link, const char *why)
{
    char *text = mem_strdup(why);
    utf8_drop_invalid(text); /* paths and a core's answer may contain any bytes, JSON may not */
    pthread_mutex_lock(&link->thread.lock);
    if (link->is_known && link->context) {
        queue(link, json_text(json_pack("{s:s,s:s}", "type", "files", "why", text), 0));
        lws_cancel_service(link->context);
    }
    pthread_mutex_unlock(&link->thread.lock);
    mem_free(text);
}

/* --- handling messages from the core ------------------------------------------------------------------------------------------ */

static void end(struct core_link *link, const char *why)
{
    if (!link->why[0])
        snprintf(link->why, sizeof(link->why), "%s", why);
    link->ended = true;
}

/* Ends the connection because the core reported a fault or sent faulty messages. */
static void refuse(struct core_link *link, const char *why)
{
    counter_inc(link->refused, 1);
    link->at_fault = true;
    end(link, why);
}

/* Restricts the connection to one purpose: this standby promises the leader, when asked, not to take the lead. The leader needs
   these promises to renew its lease. The readings that the leader sends cannot be used, because its configuration differs from
   this daemon's. takes_over: true: this daemon takes the lead all the same if the leader fails. */
static void stay_to_vote(struct core_link *link, const char *why, bool takes_over)
{
    char *said = link->hosts[link->turn.index].said[link->address], text[WHY_BYTES];
    snprintf(text, sizeof(text), "%s", why);
    link->votes = true;
    counter_inc(link->refused, 1);
    if (strcmp(text, said) != 0)
        log_err(link->params.log,
                "core: %s: no readings: %s; the other core leads; this core %s take over and only confirms the leader's lease",
                link->params.urls[link->turn.index], text, takes_over ? "can" : "cannot");
    memcpy(said, text, sizeof(text));
}

/* Notes that this connection's core leads. stays: the core keeps the connection open. */
static void note_leader(struct core_link *link, bool stays)
{
    pthread_mutex_lock(&link->thread.lock);
    link->is_known = stays;
    link->leader_index = link->turn.index;
    pthread_mutex_unlock(&link->thread.lock);
}

static void on_refused(struct core_link *link, const json_t *message)
{
    const char *why = json_string_value(json_object_get(message, "why"));
    if (json_object_get(message, "configuration"))
        note_leader(link, json_is_true(json_object_get(message, "votes")));
    arrive(link, 0, mem_strdup(link->in.at));
    bool takes_over = json_is_true(json_object_get(message, "takes_over"));
    if (link->params.keeper && !takes_over)
        lease_keeper_set_refused(link->params.keeper, why ? why : "no reason given");
    if (link->params.keeper && json_is_true(json_object_get(message, "votes")))
        stay_to_vote(link, why ? why : "the core refuses this node without a reason", takes_over);
    else
        refuse(link, why ? why : "the core refuses this node without a reason");
}

static struct core_identity own_identity(const struct core_link *link)
{
    const struct plant *plant = link->params.plant;
    return (struct core_identity){ link->params.version, plant->name, plant->files.hash, core_files_of(plant, link->params.models_hash) };
}

static void on_core(struct core_link *link, const json_t *message)
{
    const struct core_identity own = own_identity(link);
    char *why = core_identity_difference(message, "core", &own);
    if (why) {
        refuse(link, why);
    } else {
        link->taken = true;
        if (link->params.keeper)
            lease_keeper_set_refused(link->params.keeper, NULL);
        if (link->params.historian)
            historian_follow(link->params.historian);
        note_leader(link, true);
        arrive(link, 0, mem_strdup(link->in.at));
    }
    mem_free(why);
}

static void on_links(struct core_link *link, const json_t *message)
{
    const json_t *up = json_object_get(message, "up");
    int64_t now_ns = clock_mono_ns();
    if (json_array_size(up) != link->params.plant->source_count) {
        refuse(link, "the core's plant file has more or fewer sources than this plant file: copy the core's file to this machine, then "
                     "reload");
        return;
    }
    for (size_t i = 0; i < json_array_size(up); i++)
        if (json_is_true(json_array_get(up, i)))
            store_link_up(link->params.store, (int)i, now_ns);
        else
            store_link_down(link->params.store, (int)i, now_ns);
}

/* Frees the entry of an answered action. Returns the id of the client that waits for the answer; 0: none does any more. */
static uint64_t take_waiting(struct core_link *link, uint64_t id)
{
    uint64_t client = 0;
    pthread_mutex_lock(&link->thread.lock);
    for (size_t i = 0; i < CORE_ACTS && id; i++)
        if (link->waiting[i].id == id) {
            client = link->waiting[i].client;
            link->waiting[i].id = 0;
        }
    pthread_mutex_unlock(&link->thread.lock);
    return client;
}

static void on_answer(struct core_link *link, const json_t *message)
{
    uint64_t client = take_waiting(link, (uint64_t)json_integer_value(json_object_get(message, "id")));
    const json_t *text;
    size_t i;
    json_array_foreach(json_object_get(message, "texts"), i, text)
    {
        if (client && json_is_string(text))
            arrive(link, client, mem_strdup(json_string_value(text)));
    }
}

/* Answers the leader's request for a promise not to take the lead; sends nothing if this core cannot promise it. */
static void on_lease(struct core_link *link, const json_t *message)
{
    const json_t *number = json_object_get(message, "number"), *sent = json_object_get(message, "sent_age_ms");
    if (link->params.historian && json_is_integer(sent) && json_integer_value(sent) >= 0)
        historian_sent_elsewhere(link->params.historian, json_integer_value(sent) * NS_PER_MS);
    if (!link->params.keeper || !json_is_integer(number) || !lease_keeper_promise(link->params.keeper))
        return;
    pthread_mutex_lock(&link->thread.lock);
    queue(link, json_text(json_pack("{s:s,s:O}", "type", "promise", "number", number), 0));
    pthread_mutex_unlock(&link->thread.lock);
    lws_callback_on_writable(link->wsi);
}

/* Stores the leader's record of which recipients were notified of which alarms, so that no alarm is announced twice if this
   core takes the lead. */
static void on_told(struct core_link *link, const json_t *message)
{
    const char *kept = json_string_value(json_object_get(message, "kept"));
    int error = kept && link->params.keeper && link->params.folder ? notifier_put_kept(link->params.folder, kept) : 0;
    if (error)
        log_err(link->params.log,
                "notify: the file notify.json, which records sent alarms, cannot be written (%s); alarms may be sent twice",
                strerror(-error));
}

static void on_text(struct core_link *link)
{
    json_t *message = json_loadb(link->in.at, link->in.length, JSON_REJECT_DUPLICATES, NULL);
    const char *type = json_string_value(json_object_get(message, "type")), *why = NULL;
    if (!type)
        refuse(link, "the core's message is not JSON; do both nodes run the same version?");
    else if (!strcmp(type, "refused"))
        on_refused(link, message);
    else if (!strcmp(type, "standby"))
        end(link, "this core is the standby, which sends no readings: the leading core does");
    else if (!strcmp(type, "core"))
        on_core(link, message);
    else if (!strcmp(type, "lease") && (link->taken || link->votes))
        on_lease(link, message);
    else if (!link->taken)
        refuse(link, "the core's first message is not an introduction (type core); do both nodes run the same version?");
    else if (!strcmp(type, "told"))
        on_told(link, message);
    else if (!strcmp(type, "links"))
        on_links(link, message);
    else if (!strcmp(type, "alarms"))
        why = core_alarms_take(link->params.alarm_service, message);
    else if (!strcmp(type, "answer"))
        on_answer(link, message);
    else if (!strcmp(type, "lists") || !strcmp(type, "reloading"))
        arrive(link, 0, mem_strdup(link->in.at));
    if (why)
        refuse(link, why);
    json_decref(message);
}

/* Adjusts the clock shown on the pages to the core's clock. Readings need no common clock, because the core sends them with
   their ages. */
static void compare_clocks(struct core_link *link, int64_t core_utc_ns, int64_t late_ns)
{
    int64_t ahead_ns = core_utc_ns - clock_utc_ns();
    if (late_ns < QUICK_NS && llabs(core_utc_ns - clock_plant_ns(link->params.clock)) > STEP_NS)
        clock_follow(link->params.clock, ahead_ns);
    bool differ = llabs(ahead_ns) > CLOCKS_NS;
    counter_set(link->behind, ahead_ns / 1000);
    if (differ && !link->clock_said)
        log_warn(link->params.log,
                 "core: the core's clock is %.1f s %s this machine's clock: pages show the core's time; synchronise both clocks",
                 (double)llabs(ahead_ns) / 1e9, ahead_ns > 0 ? "ahead of" : "behind");
    link->clock_said = differ;
}

static void set_up(struct core_link *link)
{
    pthread_mutex_lock(&link->thread.lock);
    link->is_up = true;
    link->session = (uint64_t)clock_mono_ns();
    link->up_index = link->turn.index;
    pthread_mutex_unlock(&link->thread.lock);
    counter_set(link->up[link->turn.index], 1);
    counter_inc(link->connects, 1);
    host_turn_succeeded(&link->turn);
    log_info(link->params.log, "core: %s: receiving readings", link->params.urls[link->turn.index]);
    for (int i = 0; i < CORE_URLS; i++)
        for (int k = 0; k < ADDRESSES; k++)
            link->hosts[i].said[k][0] = 0;
}

static void on_samples(struct core_link *link)
{
    struct sample_event *samples;
    size_t count;
    const char *why = core_samples_read(&samples, &count, link->params.plant->tag_count, link->in.at, link->in.length, clock_mono_ns());
    if (why)
        refuse(link, why);
    else if (link->params.historian)
        historian_mirror(link->params.historian, samples, count);
    mem_free(samples);
}

static void on_bytes(struct core_link *link)
{
    struct core_readings readings = { .at = link->readings, .least_ns = link->least_ns, .at_ns = link->readings_ns };
    int64_t now_ns = clock_mono_ns();
    const char *why = !link->taken ? "the core's first message is not an introduction (type core); do both nodes run the same version?"
                                   : core_readings_read(&readings, link->params.plant->tag_count, link->in.at, link->in.length, now_ns);
    if (why) {
        refuse(link, why);
        return;
    }
    link->least_ns = readings.least_ns;
    link->readings_ns = readings.at_ns;
    /* rejects readings that are too old: a slow network delayed them, or this machine slept when they arrived */
    if (readings.late_ns > CORE_SILENT_NS) {
        end(link, "readings from the core arrive more than 2 s late");
        return;
    }
    store_mirror(link->params.store, readings.at, readings.count, now_ns);
    compare_clocks(link, readings.utc_ns, readings.late_ns);
    if (!link->is_up)
        set_up(link);
}

static void on_receive(struct core_link *link, const void *bytes, size_t count)
{
    link->heard_ns = clock_mono_ns();
    if (link->in.length + count > MAX_MESSAGE_BYTES) {
        refuse(link, "the core's message is larger than 64 MiB; do both nodes run the same version?");
        return;
    }
    text_add_bytes(&link->in, bytes, count);
    if (lws_remaining_packet_payload(link->wsi) != 0 || !lws_is_final_fragment(link->wsi))
        return;
    if (lws_frame_is_binary(link->wsi) && link->taken && core_samples_is(link->in.at, link->in.length))
        on_samples(link);
    else if (lws_frame_is_binary(link->wsi))
        on_bytes(link);
    else
        on_text(link);
    link->in.length = 0;
}

/* --- libwebsockets callbacks -------------------------------------------------------------------------------------------------- */

static int send_next(struct core_link *link)
{
    struct text out = { 0 };
    pthread_mutex_lock(&link->thread.lock);
    if (link->out_count > 0) {
        out = link->out[0];
        memmove(link->out, link->out + 1, --link->out_count * sizeof(*link->out));
    }
    bool more = link->out_count > 0;
    pthread_mutex_unlock(&link->thread.lock);
    int count = (int)(out.length - LWS_PRE), written = count;
    if (out.at)
        written = lws_write(link->wsi, (unsigned char *)out.at + LWS_PRE, (size_t)count, LWS_WRITE_TEXT);
    text_finish(&out);
    if (more)
        lws_callback_on_writable(link->wsi);
    return written < count ? -1 : 0;
}

static void introduce(struct core_link *link, struct lws *wsi)
{
    const struct core_identity own = own_identity(link);
    json_t *message = core_identity_message("renderer", &own);
    json_object_set_new(message, "node", json_string(link->params.node));
    if (link->params.keeper) {
        json_object_set_new(message, "standby", json_true());
        json_object_set_new(message, "id", json_string(lease_keeper_id(link->params.keeper)));
    }
    pthread_mutex_lock(&link->thread.lock);
    queue(link, json_text(message, 0));
    pthread_mutex_unlock(&link->thread.lock);
    link->wsi = wsi;
    link->heard_ns = clock_mono_ns();
    link->introduced = true;
    lws_callback_on_writable(wsi);
}

static int add_token(const struct core_link *link, struct lws *wsi, void *in, size_t len)
{
    unsigned char **at = in;
    const char *value = link->authorization;
    return *value && lws_add_http_header_by_token(wsi, WSI_TOKEN_HTTP_AUTHORIZATION, (const unsigned char *)value, (int)strlen(value), at,
                                                  *at + len)
               ? -1
               : 0;
}

static void on_failure(struct core_link *link, const char *why)
{
    char text[WHY_BYTES];
    bool answered = why && strstr(why, "HS:"), untrusted = why && (strstr(why, "SSL") || strstr(why, "cert") || strstr(why, "tls="));
    const char *role = link->params.keeper ? "standby" : "renderer";
    snprintf(text, sizeof(text), "%s%s%s", why ? why : "no connection",
             untrusted ? ": check that the core's certificate is trusted (--core-ca) and valid for this host name"
             : answered
                 ? ": the core refuses this node: check that the core runs with --role core, and that this node's token has the role "
                 : "",
             answered && !untrusted ? role : "");
    if (answered || untrusted)
        refuse(link, text);
    else
        end(link, text);
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct core_link *link = lws_context_user(lws_get_context(wsi));
    (void)user;
    switch (reason) {
    case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER: return add_token(link, wsi, in, len);
    case LWS_CALLBACK_CLIENT_ESTABLISHED: introduce(link, wsi); break;
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR: on_failure(link, in); break;
    case LWS_CALLBACK_CLIENT_RECEIVE: on_receive(link, in, len); return link->ended ? -1 : 0;
    case LWS_CALLBACK_CLIENT_WRITEABLE: return send_next(link);
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED: /* another thread interrupted lws_service(): a message is queued or this thread must end */
        if (link->wsi)
            lws_callback_on_writable(link->wsi);
        break;
    case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
        if (len > 2)
            snprintf(link->why, sizeof(link->why), "%.*s", (int)(len - 2), (const char *)in + 2);
        break;
    case LWS_CALLBACK_CLIENT_CLOSED: end(link, "the connection to the core was lost"); break;
    default: break;
    }
    return 0;
}

static const struct lws_protocols protocols[] = { { .name = CORE_SUBPROTOCOL, .callback = on_event, .rx_buffer_size = 65536 }, { 0 } };

struct link_wakeup {
    lws_sorted_usec_list_t sul;
    struct core_link *link;
};

/* Does nothing. The timer makes lws_service() return regularly, so that the link's loop can do its work. */
static void on_look(lws_sorted_usec_list_t *sul)
{
    struct link_wakeup *look = lws_container_of(sul, struct link_wakeup, sul);
    lws_sul_schedule(look->link->context, 0, sul, on_look, LOOK_US);
}

/* --- one connection ----------------------------------------------------------------------------------------------------------- */

struct core_url {
    bool tls;
    char host[256];
    int port;
};

static bool parse_url(const char *text, struct core_url *url)
{
    const char *scheme, *host, *path;
    char *copy = mem_strdup(text);
    bool good = lws_parse_uri(copy, &scheme, &host, &url->port, &path) == 0 && host[0] && strlen(host) < sizeof(url->host) &&
                (!path[0] || !strcmp(path, "/")) && url->port > 0 && url->port < 65536;
    url->tls = good && (!strcmp(scheme, "wss") || !strcmp(scheme, "https"));
    good = good && (url->tls || !strcmp(scheme, "ws") || !strcmp(scheme, "http"));
    if (good)
        strcpy(url->host, host);
    mem_free(copy);
    return good;
}

bool core_link_url_good(const char *url)
{
    struct core_url parsed;
    return parse_url(url, &parsed);
}

/* Writes the address of the core with this index; -1: none. Returns false if there is none. */
static bool peer_at(const struct core_link *link, int index, struct core_peer *out)
{
    struct core_url url;
    if (index < 0 || !parse_url(link->params.urls[index], &url))
        return false;
    bool address = strchr(url.host, ':'); /* true: the host is an IPv6 address, which a URL encloses in brackets */
    snprintf(out->url, sizeof(out->url), "http%s://%s%s%s:%d", url.tls ? "s" : "", address ? "[" : "", url.host, address ? "]" : "",
             url.port);
    out->authorization = link->authorization;
    out->ca_path = link->params.ca_path;
    return true;
}

bool core_link_peer(struct core_link *link, struct core_peer *out)
{
    pthread_mutex_lock(&link->thread.lock);
    int index = link->is_up ? link->up_index : -1;
    pthread_mutex_unlock(&link->thread.lock);
    return peer_at(link, index, out);
}

bool core_link_leader(struct core_link *link, struct core_peer *out)
{
    pthread_mutex_lock(&link->thread.lock);
    int index = link->leader_index;
    pthread_mutex_unlock(&link->thread.lock);
    return peer_at(link, index, out);
}

/* Resolves a core's host name with a timeout, which the system's resolver and libwebsockets lack. Each call returns the next of
   the host's addresses. Returns false with the reason in link->why. */
static bool resolve(struct core_link *link, const struct core_url *url, char address[INET6_ADDRSTRLEN])
{
    struct lookup *lookup = lookup_start(url->host, url->port);
    const struct addrinfo *found = NULL;
    int status = lookup_wait(lookup, link->stop_fd, clock_mono_ns() + CONNECT_NS, &found), count = 0;
    for (const struct addrinfo *at = found; at && count < ADDRESSES; at = at->ai_next)
        count++;
    link->hosts[link->turn.index].count = count;
    link->address = count ? link->hosts[link->turn.index].index % count : 0;
    for (int i = 0; i < link->address; i++)
        found = found->ai_next;
    bool good = status == 0 && getnameinfo(found->ai_addr, found->ai_addrlen, address, INET6_ADDRSTRLEN, NULL, 0, NI_NUMERICHOST) == 0;
    if (!good)
        end(link, status == -ETIMEDOUT ? "the host name could not be resolved" : "unknown host name");
    lookup_destroy(&lookup);
    return good;
}

static bool connect_to(struct core_link *link, const struct core_url *url)
{
    char address[INET6_ADDRSTRLEN];
    if (!resolve(link, url, address))
        return false;
    struct lws_context_creation_info info = { .port = CONTEXT_PORT_NO_LISTEN,
                                              .protocols = protocols,
                                              .user = link,
                                              .gid = -1,
                                              .uid = -1,
                                              .timeout_secs = 4,
                                              .vhost_name = "plantcast-core" };
    if (url->tls) {
        info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
        info.client_ssl_ca_filepath = link->params.ca_path;
    }
    struct lws_context *context = lws_create_context(&info);
    pthread_mutex_lock(&link->thread.lock);
    link->context = context;
    pthread_mutex_unlock(&link->thread.lock);
    struct lws_client_connect_info connect = { .context = context,
                                               .address = address,
                                               .host = url->host,
                                               .port = url->port,
                                               .path = CORE_PATH,
                                               .protocol = CORE_SUBPROTOCOL,
                                               .ssl_connection = url->tls ? LCCSCF_USE_SSL : 0,
                                               .alpn = "http/1.1" };
    return context && lws_client_connect_via_info(&connect);
}

static void disconnect(struct core_link *link)
{
    pthread_mutex_lock(&link->thread.lock);
    struct lws_context *context = link->context;
    link->context = NULL;
    link->is_up = link->is_known = false;
    for (size_t i = 0; i < link->out_count; i++)
        text_finish(&link->out[i]);
    link->out_count = 0;
    pthread_mutex_unlock(&link->thread.lock);
    if (context)
        lws_context_destroy(context);
    link->wsi = NULL;
    text_finish(&link->in);
}

static void watch_silence(struct core_link *link)
{
    int64_t now_ns = clock_mono_ns();
    if (!link->introduced && now_ns - link->begun_ns > CONNECT_NS)
        end(link, "the core did not answer within 4 s");
    if (link->introduced && now_ns - link->heard_ns > CORE_SILENT_NS)
        end(link, "nothing received from the core for 2 s");
    if (link->is_up && now_ns - link->readings_ns > CORE_SILENT_NS)
        end(link, "no readings received from the core for 2 s");
}

/* Runs one connection to a core until it ends, and leaves the reason in link->why. */
static void run_connection(struct core_link *link)
{
    struct core_url url;
    struct link_wakeup look = { .link = link };
    link->ended = link->taken = link->votes = link->introduced = link->at_fault = false;
    link->why[0] = 0;
    link->begun_ns = clock_mono_ns();
    link->least_ns = INT64_MAX;
    link->readings_ns = 0;
    if (!parse_url(link->params.urls[link->turn.index], &url) || !connect_to(link, &url)) {
        end(link, "no connection");
    } else {
        lws_sul_schedule(link->context, 0, &look.sul, on_look, LOOK_US);
        while (!link->ended && !thread_is_stopping(&link->thread) && lws_service(link->context, 0) >= 0)
            watch_silence(link);
        lws_sul_cancel(&look.sul);
    }
    disconnect(link);
}

/* --- the thread --------------------------------------------------------------------------------------------------------------- */

/* Tells all clients that wait for the result of a forwarded action that its outcome is unknown. */
static void answer_waiting(struct core_link *link)
{
    for (size_t i = 0; i < CORE_ACTS; i++) {
        uint64_t client = take_waiting(link, link->waiting[i].id);
        if (client)
            arrive(link, client,
                   json_text(json_pack("{s:s,s:s,s:s}", "type", "error", "code", "core_lost", "text",
                                       "the connection to the core was lost: once it is restored, check whether the action was done"),
                             0));
    }
}

/* Makes all readings Bad, because the connection to the core is lost. */
static void lost(struct core_link *link)
{
    const struct plant *plant = link->params.plant;
    int64_t now_ns = clock_mono_ns();
    int *all = mem_array(plant->tag_count + 1, sizeof(*all));
    for (size_t i = 0; i < plant->tag_count; i++)
        all[i] = (int)i;
    store_tags_dead(link->params.store, all, plant->tag_count, now_ns);
    for (size_t i = 0; i < plant->source_count; i++)
        store_link_lost(link->params.store, (int)i, now_ns);
    mem_free(all);
    counter_set(link->up[link->turn.index], 0);
    answer_waiting(link);
    char *said = link->hosts[link->turn.index].said[link->address];
    if (strcmp(link->why, said) != 0)
        log_at(link->params.log, link->at_fault ? LOG_ERROR : LOG_WARN, "core: %s: no readings: %s", link->params.urls[link->turn.index],
               link->why);
    memcpy(said, link->why, WHY_BYTES);
}

/* Selects the next address to connect to: the next one of this core's host name or, after its last one, of the next core.
   Returns the monotonic time at which to try it. */
static int64_t take_turn(struct core_link *link)
{
    int *index = &link->hosts[link->turn.index].index, count = link->hosts[link->turn.index].count;
    *index = count ? (link->address + 1) % count : 0;
    if (*index)
        return clock_mono_ns();
    /* limits the delay before the next connection attempt to about a second, because operators are waiting for readings */
    if (link->turn.backoff.failures > 1)
        link->turn.backoff.failures = 1;
    return host_turn_next_ns(&link->turn, link->params.url_count, clock_mono_ns());
}

static void *core_link_main(void *arg)
{
    struct core_link *link = arg;
    while (!thread_is_stopping(&link->thread)) {
        run_connection(link);
        if (thread_is_stopping(&link->thread))
            break;
        lost(link);
        if (wait_for(-1, 0, link->stop_fd, take_turn(link)) == -ECANCELED)
            break;
    }
    lost(link);
    return NULL;
}

static bool read_token(struct core_link *link)
{
    const char *path = link->params.token_path;
    const char *why = path ? secret_read_bearer(path, link->authorization, sizeof(link->authorization)) : NULL;
    if (why)
        log_err(link->params.log, "core: %s: %s", path, why);
    return !why;
}

static void add_up_counters(struct core_link *link)
{
    for (int i = 0; i < CORE_URLS && link->params.urls[i]; i++) {
        char *name = mem_printf("plantcast_core_up{core=\"%s\"}", link->params.urls[i]);
        link->up[i] = counters_add(link->params.counters, name, "gauge", CORE_UP_HELP);
        mem_free(name);
    }
}

struct core_link *core_link_start(const struct core_link_params *params)
{
    struct core_link *link = mem_new(sizeof(*link));
    struct counters *c = params->counters;
    link->params = *params;
    link->last_arrival = &link->arrivals;
    link->leader_index = -1;
    link->readings = mem_array(params->plant->tag_count + 1, sizeof(*link->readings));
    add_up_counters(link);
    link->connects =
        counters_add(c, "plantcast_core_connects_total", "counter", "Connections from this daemon to a core that delivered readings.");
    link->refused = counters_add(
        c, "plantcast_core_refused_total", "counter",
        "Connections from this daemon to a core that ended because the core differed in version or plant, or refused this daemon.");
    link->behind = counters_add_seconds(c, "plantcast_core_clock_ahead_seconds", "gauge",
                                        "Seconds by which the core's clock is ahead of this machine's clock.");
    /* lets libwebsockets log only errors and warnings; the link's own loop logs its connections */
    lws_set_log_level(LLL_ERR | LLL_WARN, NULL);
    /* the leader may have refused this node because of its old plant; with the plant just loaded, that refusal no longer keeps
       this node from taking the lead */
    if (params->keeper)
        lease_keeper_set_refused(params->keeper, NULL);
    thread_init(&link->thread);
    link->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (link->stop_fd < 0)
        log_err(params->log, "core: cannot create an eventfd: %s", strerror(errno));
    if (link->stop_fd < 0 || !read_token(link) || !thread_start(&link->thread, params->log, "core", core_link_main, link))
        core_link_stop(&link);
    return link;
}

void core_link_halt(struct core_link *link)
{
    if (link->stop_fd >= 0)
        eventfd_write(link->stop_fd, 1);
    pthread_mutex_lock(&link->thread.lock);
    link->thread.stopping = true;
    if (link->context)
        lws_cancel_service(link->context);
    pthread_mutex_unlock(&link->thread.lock);
    thread_stop(&link->thread);
}

void core_link_stop(struct core_link **pointer)
{
    struct core_link *link = *pointer;
    if (!link)
        return;
    core_link_halt(link);
    for (struct core_arrival *arrival = core_link_collect(link), *next; arrival; arrival = next) {
        next = arrival->next;
        core_arrival_free(arrival);
    }
    if (link->stop_fd >= 0)
        close(link->stop_fd);
    thread_finish(&link->thread);
    mem_free(link->readings);
    mem_free(link->out);
    mem_free(link);
    *pointer = NULL;
}
