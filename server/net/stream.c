/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /stream: connections come and go, and what they say goes to their sessions. */
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/rand.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/stream.h"
#include "net/connection.h"

enum { STREAM_CLOSE_STALLED = 4000, LAST_WORDS_S = 2 };
static const int64_t MOVING_NS = 200 * NS_PER_MS; /* after an input somebody is taken to be moving */

/* --- coming and going ------------------------------------------------------------------------------------------------------- */

static void tune_socket(struct lws *wsi)
{
    int fd = lws_get_socket_fd(wsi), on = 1, low = SLICE_BYTES;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &low, sizeof(low));
}

static void close_with(struct stream *stream, int code, const char *text)
{
    if (stream->close_code)
        return;
    stream->close_code = code;
    stream->close_text = text;
    lws_callback_on_writable(stream->wsi);
}

static void pump(struct server_context *hub, struct stream *stream);

/* Where it is, or would be, in hub->by_client. */
static size_t place_of(const struct server_context *hub, uint64_t client)
{
    size_t low = 0, high = (size_t)hub->stream_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (hub->by_client[middle]->session->id < client)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Whoever has it may follow. 48 bits: more than anyone can try, and exact in any JSON. */
static uint64_t new_number(const struct server_context *hub)
{
    uint64_t number = 0;
    while (number == 0 || stream_called(hub, number)) {
        if (RAND_bytes((unsigned char *)&number, sizeof(number)) != 1)
            return 0; /* then nobody follows it */
        number >>= 16;
    }
    return number;
}

static void on_open(struct server_context *hub, struct lws *wsi, struct stream **slot)
{
    struct stream *stream = mem_new(sizeof(*stream));
    *stream = (struct stream){ .wsi = wsi, .next = hub->streams };
    stream->session = session_create(&hub->world, hub->next_client++, clock_mono_ns());
    stream->session->called = new_number(hub);
    stream->session->starting = true;
    stream->peer = connection_of(wsi)->client;
    memcpy(stream->session->address, stream->peer->address, sizeof(stream->session->address));
    stream->session->role = connection_of(wsi)->role;
    stream->session->holder = connection_of(wsi)->holder;
    *slot = hub->streams = stream;
    mem_grow(&hub->by_client, &hub->by_client_capacity, (size_t)hub->stream_count + 1, sizeof(struct stream *));
    hub->by_client[hub->stream_count++] = stream; /* numbers go up */
    counter_set(hub->counters.sessions, hub->stream_count);
    counter_inc(hub->counters.sessions_all, 1);
    tune_socket(wsi);
    bool address_full = !address_limits_may_stream(hub->peers, stream->peer);
    stream->peer->sessions++;
    stream->session->share = &stream->peer->share;
    admission_join(&hub->admission, stream->session->share);
    if (address_full)
        session_close(stream->session, 1013, "full: this address has as many sessions as one may have; try again later");
    else if (hub->stream_count > hub->quotas->at[QUOTA_SESSIONS])
        session_close(stream->session, 1013, "full: as many sessions as there may be; try again later");
    pump(hub, stream);
    log_debug(hub->params.log, "session %llu: opened", (unsigned long long)stream->session->id);
}

static void count(struct server_context *hub, struct stream *stream)
{
    const struct session *session = stream->session;
    counter_inc(hub->counters.messages, session->messages - stream->messages);
    counter_inc(hub->counters.errors, session->errors - stream->errors);
    counter_inc(hub->counters.dropped, session->dropped - stream->dropped);
    stream->messages = session->messages;
    stream->errors = session->errors;
    stream->dropped = session->dropped;
}

/* Who was sent away is not kept, but who could not be served any longer is. */
static bool may_return(const struct stream *stream)
{
    return stream->session->hello && stream->session->close_code != 1008;
}

static void on_close(struct server_context *hub, struct stream **slot)
{
    struct stream *stream = *slot, **at = &hub->streams;
    if (!stream)
        return;
    while (*at != stream)
        at = &(*at)->next;
    *at = stream->next;
    size_t place = place_of(hub, stream->session->id);
    memmove(hub->by_client + place, hub->by_client + place + 1, ((size_t)hub->stream_count-- - place - 1) * sizeof(struct stream *));
    counter_set(hub->counters.sessions, hub->stream_count);
    count(hub, stream);
    follow_forget(hub, stream);
    log_debug(hub->params.log, "session %llu: closed (%lld messages, %lld errors)", (unsigned long long)stream->session->id,
              (long long)stream->messages, (long long)stream->errors);
    render_service_forget(hub->params.plant.painter, stream->session->id);
    if (hub->past)
        history_loader_forget(hub->past, stream->session->id);
    stream->peer->sessions--;
    session_leave(stream->session, may_return(stream), clock_mono_ns());
    admission_leave(&hub->admission, stream->session->share);
    session_destroy(&stream->session);
    encoded_frame_destroy(&stream->sending);
    text_finish(&stream->in);
    known_markers_finish(&stream->said);
    mem_free(stream);
    *slot = NULL;
}

/* --- after anything happened to a session ---------------------------------------------------------------------------------- */

/* Play goes on; those who follow come along. */
static void travel(struct server_context *hub, struct stream *stream, int64_t now_ns)
{
    struct session *session = stream->session;
    int64_t before_us = session->view.at_us, at_us;
    if (hub->past && session_wants_historical_snapshot(session, now_ns, clock_utc_ns(), &at_us))
        history_loader_ask(hub->past, session->id, at_us);
    if (session->view.at_us != before_us)
        follow_spread(hub, stream);
}

static void pump(struct server_context *hub, struct stream *stream)
{
    struct session *session = stream->session;
    struct frame_request wish;
    int64_t now_ns = clock_mono_ns();
    travel(hub, stream, now_ns);
    if (session->close_code && session->reply_count == 0 && !stream->close_code) {
        if (session->close_code == 1013)
            counter_inc(hub->counters.refused, 1);
        close_with(stream, session->close_code, session->close_text);
    }
    if (stream->close_code)
        return;
    if (session_next_request(session, now_ns, &wish)) {
        enum request_outcome answer = render_service_request(hub->params.plant.painter, session->id, &wish);
        if (answer != REQUEST_REFUSED)
            session_requested(session, &wish, answer == REQUEST_REPLACED);
        hub->asked = true;
    }
    struct pick_query order;
    if (session_next_pick(session, &order))
        render_service_pick(hub->params.plant.painter, &order);
    if (session->too_fast != stream->throttled) {
        stream->throttled = session->too_fast;
        lws_rx_flow_control(stream->wsi, !stream->throttled);
    }
    if (stream_has_output(stream, now_ns))
        lws_callback_on_writable(stream->wsi);
}

/* When every session is refined for every change of a reading, and there is one each second. */
static bool is_loaded(const struct server_context *hub)
{
    int count = 0;
    for (const struct stream *stream = hub->streams; stream; stream = stream->next)
        count += stream->session->hello && !stream->session->hidden;
    return count * hub->still_ns > NS_PER_S;
}

static void count_moving(const struct server_context *hub, int64_t now_ns)
{
    for (struct address_share *share = hub->admission.shares; share; share = share->next)
        share->moving = 0;
    for (const struct stream *stream = hub->streams; stream; stream = stream->next)
        stream->session->share->moving += stream->session->hello && now_ns - stream->session->input_ns < NS_PER_S;
}

void streams_check_tokens(struct server_context *hub, int64_t now_utc_ns)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        session_check_token(stream->session, now_utc_ns);
}

/* Who takes nothing gets nothing, and keeps nothing of the server's but its view; then it is closed. */
static void watch_stall(struct server_context *hub, struct stream *stream, int64_t now_ns)
{
    enum pacer_state state = session_state(stream->session, now_ns);
    if (state == PACER_FLOWS || stream->close_code)
        return;
    stream_give_up(hub, stream, now_ns);
    if (state != PACER_DEAD)
        return;
    counter_inc(hub->counters.stalled, 1);
    close_with(stream, STREAM_CLOSE_STALLED, "nothing was acknowledged for 15 s");
    lws_set_timeout(stream->wsi, PENDING_TIMEOUT_CLOSE_SEND, LAST_WORDS_S); /* its socket may take not even that */
}

void streams_on_tick(struct server_context *hub, bool data_changed, bool links_changed)
{
    int64_t now_ns = clock_mono_ns(), patience_ns = hub->quotas->at[QUOTA_PATIENCE_S] * NS_PER_S;
    hub->world.loaded = is_loaded(hub);
    count_moving(hub, now_ns);
    follow_share_steps(hub);
    follow_tell(hub, now_ns);
    for (struct stream *stream = hub->streams; stream; stream = stream->next) {
        session_on_tick(stream->session, now_ns);
        if (stream->in_count > 0 && now_ns - stream->in_begin_ns > patience_ns)
            session_close(stream->session, 1008, "half a message, and for too long no more of it");
        if (data_changed && session_view(stream->session)->at_us == 0)
            session_on_data(stream->session, hub->data_ns);
        stream->session->owes_status |= links_changed;
        count(hub, stream);
        watch_stall(hub, stream, now_ns);
        pump(hub, stream);
    }
}

void streams_on_alarms(struct server_context *hub)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        pump(hub, stream);
}

void streams_close(struct server_context *hub)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        close_with(stream, LWS_CLOSE_STATUS_GOINGAWAY, "the server goes down");
}

/* NULL: not connected. */
static struct stream *find_stream(const struct server_context *hub, uint64_t client)
{
    size_t place = place_of(hub, client);
    bool there = place < (size_t)hub->stream_count && hub->by_client[place]->session->id == client;
    return there ? hub->by_client[place] : NULL;
}

struct stream *stream_called(const struct server_context *hub, uint64_t number)
{
    struct stream *stream = hub->streams;
    while (stream && stream->session->called != number)
        stream = stream->next;
    return stream;
}

bool stream_owns(const struct server_context *hub, uint64_t client)
{
    return find_stream(hub, client) != NULL;
}

void stream_on_frame(struct server_context *hub, struct encoded_frame *picture)
{
    struct stream *stream = find_stream(hub, picture->client);
    const struct frame *frame = picture->packet ? picture->packet->frame : NULL;
    if (frame && frame->view.tier == TIER_REFINED && picture->wish.urgency >= URGENCY_REFINE)
        hub->still_ns = frame->render_ns + frame->readback_ns;
    admission_on_frame(&hub->admission, stream->session->share, picture);
    session_on_frame(stream->session, picture);
    pump(hub, stream);
}

void stream_on_pick(struct server_context *hub, const struct pick_answer *answer)
{
    struct stream *stream = find_stream(hub, answer->order.client);
    session_on_pick(stream->session, answer);
    pump(hub, stream);
}

/* --- input ------------------------------------------------------------------------------------------------------------------ */

static void pump_followers(struct server_context *hub, const struct stream *leader)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        if (stream->session->leader == leader->session)
            pump(hub, stream);
}

void stream_on_gaps(struct server_context *hub, const struct sensor_coverage_answer *answer)
{
    struct stream *stream = find_stream(hub, answer->client);
    if (!stream)
        return;
    session_on_gaps(stream->session, answer);
    pump(hub, stream);
}

void streams_on_placed(struct server_context *hub)
{
    int64_t now_ns = clock_mono_ns();
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        if (stream->session->places) {
            session_on_placed(stream->session, now_ns);
            pump(hub, stream);
        }
}

void stream_say(struct server_context *hub, uint64_t client, const char *text)
{
    struct stream *stream = find_stream(hub, client);
    if (!stream)
        return;
    session_say(stream->session, text);
    pump(hub, stream);
}

/* Once for each session that was let in, and for each token that was not. */
static void note_login(struct server_context *hub, struct stream *stream, bool was_in)
{
    const struct session *session = stream->session;
    bool good = login_is_good(session->login);
    struct token_holder holder = session->holder;
    if (was_in || (good && !session->hello))
        return;
    if (good)
        holder.role = session->role;
    if (!good)
        counter_inc(hub->counters.refused, session->login != LOGIN_HELD); /* whoever gets 1013 is counted there */
    if (!good || session->role > ROLE_OPEN)
        connection_log_login(hub, stream->wsi, "stream", &holder, good ? LOGIN_GOOD_NEW : session->login);
}

/* It goes to the thread that loads the plant anew. */
static void save_resolve(struct server_context *hub, struct session *session)
{
    struct tag_save *save = session->save;
    if (!save)
        return;
    session->save = NULL;
    save->client = session->id;
    hub->world.saving = true;
    hub->params.save(hub->params.reload_arg, save);
}

static void on_message(struct server_context *hub, struct stream *stream)
{
    struct session *session = stream->session;
    int64_t now_ns = clock_mono_ns();
    bool was_in = session->hello || session->close_code;
    if (!address_limits_count_message(hub->peers, stream->peer, now_ns))
        session_too_fast(session, hub->quotas->at[QUOTA_ADDRESS_MESSAGES], "of this address ");
    if (stream->in_count > (size_t)hub->quotas->at[QUOTA_MESSAGE_BYTES])
        session_on_oversize(session, stream->in_count, now_ns);
    else
        session_on_message(session, stream->in.at ? stream->in.at : "", stream->in.length, now_ns, clock_utc_ns());
    note_login(hub, stream, was_in);
    follow_resolve(hub, stream);
    save_resolve(hub, session);
    if (session->measured)
        latency_stages_shown(&hub->stages, &session->pacer);
    session->measured = false;
    if (session->input_ns == now_ns) {
        hub->world.moving_until_ns = now_ns + MOVING_NS;
        if (follow_spread(hub, stream))
            pump_followers(hub, stream);
    }
    stream->in.length = 0;
    stream->in_count = 0;
    if (stream->in.capacity > 4096)
        text_finish(&stream->in);
}

static void on_receive(struct server_context *hub, struct stream *stream, const void *bytes, size_t len)
{
    if (stream->in_count == 0)
        stream->in_begin_ns = clock_mono_ns();
    stream->in_count += len;
    if (stream->in_count > SESSION_MAX_INPUT_BYTES) {
        close_with(stream, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "a message is larger than 1 MiB");
        lws_rx_flow_control(stream->wsi, 0);
        return;
    }
    if (stream->in_count <= (size_t)hub->quotas->at[QUOTA_MESSAGE_BYTES])
        text_add_bytes(&stream->in, bytes, len);
    if (lws_remaining_packet_payload(stream->wsi) == 0 && lws_is_final_fragment(stream->wsi))
        on_message(hub, stream);
    pump(hub, stream);
}

void stream_on_historical_snapshot(struct server_context *hub, const struct history_loader_answer *answer)
{
    struct stream *stream = find_stream(hub, answer->client);
    session_on_historical_snapshot(stream->session, answer->at_us, answer->good, clock_mono_ns());
    if (follow_spread(hub, stream))
        pump_followers(hub, stream);
    pump(hub, stream);
}

/* --- lws --------------------------------------------------------------------------------------------------------------------- */

static int on_writeable(struct server_context *hub, struct stream *stream)
{
    if (stream->close_code) {
        lws_close_reason(stream->wsi, (enum lws_close_status)stream->close_code, (unsigned char *)stream->close_text,
                         strlen(stream->close_text));
        return -1;
    }
    if (!stream_send(hub, stream))
        return -1;
    pump(hub, stream);
    net_wake_render_service(hub);
    return 0;
}

int stream_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct stream **slot = user;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED: on_open(server_context_of(wsi), wsi, slot); break;
    case LWS_CALLBACK_CLOSED: on_close(server_context_of(wsi), slot); break;
    case LWS_CALLBACK_RECEIVE:
        on_receive(server_context_of(wsi), *slot, in, len);
        net_wake_render_service(server_context_of(wsi));
        break;
    case LWS_CALLBACK_RECEIVE_PONG:
        stream_on_pong(*slot, in, len);
        pump(server_context_of(wsi), *slot);
        net_wake_render_service(server_context_of(wsi));
        break;
    case LWS_CALLBACK_SERVER_WRITEABLE: return on_writeable(server_context_of(wsi), *slot);
    default: break;
    }
    return 0;
}
