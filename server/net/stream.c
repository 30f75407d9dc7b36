/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connections to /stream: opens and closes them, and passes their messages to their sessions. */
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/rand.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/utf8.h"
#include "message/view_query_write.h"
#include "net/stream.h"
#include "net/connection.h"
#include "session/tiles/tile_sync.h"

enum { STREAM_CLOSE_STALLED = 4000, LAST_WORDS_S = 2, BACK_MAX_S = 60, SILENT_S = 6 };
static const int64_t SILENT_NS = SILENT_S * NS_PER_S;
/* delay in nanoseconds from the start of a drain (moving sessions to other daemons) to the closing of the first session, so
   that load balancers notice the drain first */
static const int64_t DRAIN_DELAY_NS = 2 * NS_PER_S;
static const int64_t DRAIN_NS = 10 * NS_PER_S;
/* nanoseconds within which a node that has lost its core (daemon that reads the devices) closes all its sessions, so that they
   move to other nodes */
static const int64_t MOVE_NS = 1 * NS_PER_S;
/* nanoseconds after a user's input during which the session's camera counts as moving */
static const int64_t MOVING_NS = 200 * NS_PER_MS;

/* --- connecting and disconnecting ------------------------------------------------------------------------------------- */

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

static void pump(struct server_context *server, struct stream *stream);

/* Returns a random session number. Any client that knows the number may follow the session, so the number has 48 bits: too many
   to guess, but exact in any JSON parser. */
static uint64_t new_number(const struct server_context *server)
{
    uint64_t number = 0;
    while (number == 0 || stream_called(server, number)) {
        if (RAND_bytes((unsigned char *)&number, sizeof(number)) != 1)
            return 0; /* returns 0, with which the session cannot be followed, if the system supplies no random numbers */
        number >>= 16;
    }
    return number;
}

static void on_open(struct server_context *server, struct lws *wsi, struct stream **slot)
{
    const struct connection *connection = connection_of(wsi);
    struct stream *stream = mem_new(sizeof(*stream));
    *stream = (struct stream){ .wsi = wsi };
    stream->session = session_create(&server->session_context, server->streams.next_client++, clock_mono_ns());
    stream->usage = connection->client;
    session_introduce(stream->session, &(struct session_client){ .number = new_number(server),
                                                                 .address = stream->usage->address,
                                                                 .from = connection->address,
                                                                 .role = connection->role,
                                                                 .holder = &connection->holder,
                                                                 .token = connection->token,
                                                                 .share = &stream->usage->share });
    *slot = stream;
    stream_table_add(server, stream);
    counter_set(server->counters.sessions, server->streams.count);
    counter_inc(server->counters.sessions_all, 1);
    tune_socket(wsi);
    bool address_full = !address_limits_may_stream(server->room.addresses, stream->usage);
    stream->usage->sessions++;
    admission_join(&server->room.admission, &stream->usage->share);
    if (address_full)
        session_close(stream->session, 1013, "full: this address has reached its limit of sessions; try again later");
    else if (server->streams.count > server->room.quotas->at[QUOTA_SESSIONS])
        session_close(stream->session, 1013, "full: the server has reached its limit of sessions; try again later");
    pump(server, stream);
    log_debug(server->params.log, "session %llu: opened", (unsigned long long)stream->session->id);
}

static void count(struct server_context *server, struct stream *stream)
{
    const struct session *session = stream->session;
    counter_inc(server->counters.messages, session->stats.messages - stream->messages);
    counter_inc(server->counters.errors, session->stats.errors - stream->errors);
    counter_inc(server->counters.dropped, session->stats.dropped - stream->dropped);
    stream->messages = session->stats.messages;
    stream->errors = session->stats.errors;
    stream->dropped = session->stats.dropped;
}

/* Returns whether the session's view is stored so that a returning client can resume it. That is so after an accepted hello,
   unless the client was refused (close code 1008). */
static bool may_return(const struct stream *stream)
{
    return stream->session->hello && stream->session->close.code != 1008;
}

static void on_close(struct server_context *server, struct stream **slot)
{
    struct stream *stream = *slot;
    if (!stream)
        return;
    stream_table_remove(server, stream);
    counter_set(server->counters.sessions, server->streams.count);
    count(server, stream);
    if (session_is_tile(stream->session))
        tiles_gather(server, stream->session->tile.place.wall, stream);
    follow_forget(server, stream);
    if (stream->session->hello)
        session_record_leave(stream->session, stream->close_text);
    log_debug(server->params.log, "session %llu: closed (%lld messages, %lld errors)", (unsigned long long)stream->session->id,
              (long long)stream->messages, (long long)stream->errors);
    render_service_forget(server->params.plant.render_service, stream->session->id);
    if (server->history_loader)
        history_loader_forget(server->history_loader, stream->session->id);
    stream->usage->sessions--;
    session_leave(stream->session, may_return(stream), clock_mono_ns());
    admission_leave(&server->room.admission, &stream->usage->share);
    session_retire(&stream->session);
    encoded_frame_destroy(&stream->sending);
    text_finish(&stream->in);
    known_markers_finish(&stream->known);
    mem_free(stream);
    *slot = NULL;
}

/* --- work after each event of a session ------------------------------------------------------------------------------- */

/* Advances a session's playback, and requests the readings of the past instant to be shown. Following sessions show the same instant. */
static void travel(struct server_context *server, struct stream *stream, int64_t now_ns)
{
    struct session *session = stream->session;
    int64_t before_us = session->view.at_us, at_us;
    if (server->history_loader && session_wants_historical_snapshot(session, now_ns, clock_plant_ns(server->params.plant.clock), &at_us))
        history_loader_ask(server->history_loader, session->id, at_us);
    if (session->view.at_us != before_us)
        follow_spread(server, stream);
}

static void pump(struct server_context *server, struct stream *stream)
{
    struct session *session = stream->session;
    struct frame_request request;
    int64_t now_ns = clock_mono_ns();
    travel(server, stream, now_ns);
    if (session->close.code && session->owed.reply_count == 0 && !stream->close_code) {
        if (session->close.code == 1013)
            counter_inc(server->counters.refused, 1);
        close_with(stream, session->close.code, session->close.text);
    }
    if (stream->close_code)
        return;
    if (session_is_tile(session)) {
        tiles_pump(server, stream);
    } else if (session->hidden) {
        render_service_withdraw(server->params.plant.render_service, session->id);
    } else if (session_next_request(session, now_ns, &request)) {
        enum request_outcome answer = render_service_request(server->params.plant.render_service, session->id, &request);
        if (answer != REQUEST_REFUSED)
            session_requested(session, &request, answer == REQUEST_REPLACED);
    }
    struct pick_query query;
    if (session_next_pick(session, &query))
        render_service_pick(server->params.plant.render_service, &query);
    if (session->rate.exceeded != stream->throttled) {
        stream->throttled = session->rate.exceeded;
        lws_rx_flow_control(stream->wsi, !stream->throttled);
    }
    if (stream_has_output(stream, now_ns))
        lws_callback_on_writable(stream->wsi);
    server->streams.restless |= stream->sending || stream->cut || !session_rests(session, now_ns);
}

/* Returns whether the render thread is overloaded, that is, whether one refined frame for every session would take more than
   the second between two changes of readings. */
static bool is_loaded(const struct server_context *server)
{
    int count = 0;
    for (const struct stream *stream = server->streams.first; stream; stream = stream->next)
        count += stream->session->hello && !stream->session->hidden;
    return count * server->streams.still_ns > NS_PER_S;
}

static void count_moving(const struct server_context *server, int64_t now_ns)
{
    for (struct address_share *share = server->room.admission.shares; share; share = share->next)
        share->moving = 0;
    for (const struct stream *stream = server->streams.first; stream; stream = stream->next)
        stream->usage->share.moving += session_moves(stream->session, now_ns);
}

void streams_check_tokens(struct server_context *server, int64_t now_utc_ns)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        session_check_token(stream->session, clock_mono_ns(), now_utc_ns);
}

/* Logs that a client acknowledges no picture: once, after SILENT_NS. This is sooner than the page's own watchdog (watchdog.js)
   reloads the page, so the log shows the cause of the reload. */
static void log_silence(struct server_context *server, struct stream *stream, int64_t now_ns)
{
    const struct session *session = stream->session;
    char display[96] = "";
    if (!stream->silent_ns)
        stream->silent_ns = now_ns;
    if (now_ns - stream->silent_ns < SILENT_NS)
        return;
    stream->silent_ns = INT64_MAX;
    if (session->display.display > 0)
        snprintf(display, sizeof(display), ", display %d of wall %s", session->display.display, session->display.wall);
    log_warn(server->params.log, "session %llu (%s%s): no picture acknowledged for %d s: the page hangs, or the network is stalled",
             (unsigned long long)session->id, connection_of(stream->wsi)->address, display, SILENT_S + PACER_STALL_S);
}

/* Watches a client that acknowledges no frame: stops sending frames, cuts a half-sent frame short, and closes the session if
   the client acknowledges nothing for 15 s. */
static void watch_stall(struct server_context *server, struct stream *stream, int64_t now_ns)
{
    enum pacer_state state = session_state(stream->session, now_ns);
    if (state == PACER_FLOWS)
        stream->silent_ns = 0;
    if (state == PACER_FLOWS || stream->close_code)
        return;
    log_silence(server, stream, now_ns);
    stream_give_up(server, stream, now_ns);
    if (state != PACER_DEAD)
        return;
    counter_inc(server->counters.stalled, 1);
    close_with(stream, STREAM_CLOSE_STALLED, "closed, because the client acknowledged no frame for 15 s");
    /* closes the socket after a timeout, because the client may not even read the close frame */
    lws_set_timeout(stream->wsi, PENDING_TIMEOUT_CLOSE_SEND, LAST_WORDS_S);
}

void streams_on_readings(struct server_context *server, bool data_changed, bool links_changed)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        if (data_changed && session_view(stream->session)->at_us == 0)
            session_on_data(stream->session, server->readings.data_ns);
        if (links_changed)
            session_on_links(stream->session);
        pump(server, stream);
    }
}

/* Returns whether a session is due to be closed. The node closes its sessions at different instants within spread_ns after
   begun_ns, because the closed pages reconnect to other nodes immediately. */
static bool is_due(const struct stream *stream, int64_t begun_ns, int64_t spread_ns, int64_t now_ns)
{
    /* Fibonacci hashing gives each session its own instant: multiplying by 2^64 / golden ratio spreads consecutive ids evenly */
    uint64_t spread = (stream->session->id + 1) * 0x9E3779B97F4A7C15u >> 32;
    return now_ns - begun_ns > (int64_t)(spread % 1000) * (spread_ns / 1000);
}

/* Closes a session that must move to another node, because this node is being drained or has lost its core. After the loss of a
   core, only sessions that came through a load balancer are closed: others would reach the same node again. */
static void move_elsewhere(const struct server_context *server, const struct stream *stream, int64_t now_ns)
{
    int64_t drain_ns = server->life.drain_ns, moves_ns = server->life.core_loss.moves_ns;
    if (drain_ns && is_due(stream, drain_ns + DRAIN_DELAY_NS, DRAIN_NS, now_ns))
        session_close(stream->session, LWS_CLOSE_STATUS_GOINGAWAY, "this daemon moves its sessions to other daemons; retry after 0 s");
    if (moves_ns && connection_of(stream->wsi)->forwarded && is_due(stream, moves_ns, MOVE_NS, now_ns))
        session_close(stream->session, LWS_CLOSE_STATUS_GOINGAWAY, "this daemon has lost its core and shows no readings; retry after 0 s");
}

void streams_on_tick(struct server_context *server)
{
    int64_t now_ns = clock_mono_ns(), patience_ns = server->room.quotas->at[QUOTA_PATIENCE_S] * NS_PER_S;
    server->streams.restless = false;
    server->session_context.load.overloaded = is_loaded(server);
    count_moving(server, now_ns);
    follow_share_steps(server);
    follow_tell(server, now_ns);
    tiles_on_tick(server);
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        session_on_tick(stream->session, now_ns);
        move_elsewhere(server, stream, now_ns);
        if (stream->in_count > 0 && now_ns - stream->in_begin_ns > patience_ns)
            session_close(stream->session, 1008, "the client did not complete a message in time");
        count(server, stream);
        watch_stall(server, stream, now_ns);
        pump(server, stream);
    }
}

void streams_on_alarms(struct server_context *server)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        pump(server, stream);
}

void streams_settle(struct server_context *server)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (stream->session && session_settle(stream->session))
            pump(server, stream);
}

void streams_close(struct server_context *server)
{
    int back_s = server->life.start_s < BACK_MAX_S ? server->life.start_s : BACK_MAX_S;
    if (back_s > 0)
        snprintf(server->life.goodbye, sizeof(server->life.goodbye), "the server is stopping; retry after %d s", back_s);
    else
        snprintf(server->life.goodbye, sizeof(server->life.goodbye), "the server is stopping");
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        close_with(stream, LWS_CLOSE_STATUS_GOINGAWAY, server->life.goodbye);
}

static void take_frame(struct server_context *server, struct stream *stream, struct encoded_frame *encoded)
{
    admission_on_frame(&server->room.admission, &stream->usage->share, encoded);
    session_on_frame(stream->session, encoded);
    pump(server, stream);
}

/* Passes a frame to the signer if its client wants signed frames. Returns false if the frame cannot be signed; the client then gets it
   unsigned. */
static bool sign(struct server_context *server, struct stream *stream, struct encoded_frame *encoded)
{
    const struct packet *packet = encoded->packet;
    if (!packet || !packet->frame->record || !encoded->request.record)
        return false;
    const struct params_context context = { .scene = server->params.plant.scene, .baselines = server->params.plant.baselines };
    struct message_error error = { 0 };
    struct view_address args;
    bool good = view_query_write(&context, &packet->frame->view, &args, &error);
    if (good)
        picture_signer_ask(server->signing.signer, encoded,
                           &(struct picture_origin){ .scene = context.scene,
                                                     .args = (const char *const *)args.args,
                                                     .arg_count = args.count,
                                                     .overlay = "none",
                                                     .version = server->params.version });
    else
        session_not_signed(stream->session, &error);
    view_address_finish(&args);
    return good;
}

void stream_on_signed(struct server_context *server, struct signing *signing)
{
    struct stream *stream = stream_find(server, signing->encoded->client);
    struct message_error error = { 0 };
    message_refuse(&error, "not_signed", NULL, REFUSAL_UNSIGNED);
    if (signing->good)
        stream->session->codec.unsigned_said = false;
    else
        session_not_signed(stream->session, &error);
    take_frame(server, stream, signing->encoded);
    signing->encoded = NULL;
}

void stream_on_frame(struct server_context *server, struct encoded_frame *encoded)
{
    struct stream *stream = stream_find(server, encoded->client);
    const struct frame *frame = encoded->packet ? encoded->packet->frame : NULL;
    if (frame && frame->view.tier == TIER_REFINED && encoded->request.urgency >= URGENCY_REFINE)
        server->streams.still_ns = frame->render_ns + frame->readback_ns;
    if (!sign(server, stream, encoded))
        take_frame(server, stream, encoded);
}

void stream_on_pick(struct server_context *server, const struct pick_answer *answer)
{
    struct stream *stream = stream_find(server, answer->query.client);
    session_on_pick(stream->session, answer);
    pump(server, stream);
}

/* --- input ------------------------------------------------------------------------------------------------------------ */

static void pump_followers(struct server_context *server, const struct stream *leader)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (stream->session->following.leader == leader->session)
            pump(server, stream);
}

void stream_on_coverage(struct server_context *server, const struct sensor_coverage_answer *answer)
{
    struct stream *stream = stream_find(server, answer->client);
    if (!stream)
        return;
    session_on_coverage(stream->session, answer);
    pump(server, stream);
}

void streams_on_placed(struct server_context *server)
{
    int64_t now_ns = clock_mono_ns();
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (stream->session->placement.set) {
            session_on_placed(stream->session, now_ns);
            pump(server, stream);
        }
}

void stream_say(struct server_context *server, uint64_t client, const char *text)
{
    struct stream *stream = stream_find(server, client);
    if (!stream)
        return;
    session_say(stream->session, text);
    pump(server, stream);
}

/* Records in the log and the audit trail that a user logged in over this stream: once per admitted session, and for each refused token. */
static void note_login(struct server_context *server, struct stream *stream, bool was_in)
{
    const struct session *session = stream->session;
    bool good = login_is_good(session->identity.login);
    struct token_holder holder = session->identity.holder;
    if (was_in || (good && !session->hello))
        return;
    if (good)
        holder.role = session->identity.role;
    /* does not count a login that throttling left unchecked (LOGIN_HELD, close code 1013): pump() counts it as refused */
    if (!good)
        counter_inc(server->counters.refused, session->identity.login != LOGIN_HELD);
    if (!good || session->identity.role > ROLE_OPEN || holder.name[0])
        connection_log_login(server, stream->wsi, "stream", &holder, good ? LOGIN_GOOD_NEW : session->identity.login);
}

/* Passes a tag list to be saved to the reload thread. */
static void save_resolve(struct server_context *server, struct session *session)
{
    struct tag_save *save = session_take_save(session);
    if (!save)
        return;
    save->client = session->id;
    server->session_context.records.saving = true;
    server->params.save(server->params.reload_arg, save);
}

static void on_message(struct server_context *server, struct stream *stream)
{
    struct session *session = stream->session;
    int64_t now_ns = clock_mono_ns();
    bool was_in = session->hello || session->close.code, was_hidden = session->hidden;
    if (!address_limits_count_message(server->room.addresses, stream->usage, now_ns))
        session_too_fast(session, server->room.quotas->at[QUOTA_ADDRESS_MESSAGES], "of this address ");
    net_refresh_readings(server);
    if (stream->in_count > (size_t)server->room.quotas->at[QUOTA_MESSAGE_BYTES])
        session_on_oversize(session, stream->in_count, now_ns);
    else
        session_on_message(session, stream->in.at ? stream->in.at : "", stream->in.length, now_ns,
                           clock_plant_ns(server->params.plant.clock));
    note_login(server, stream, was_in);
    follow_resolve(server, stream);
    if (session_is_tile(session) && (!was_in || session->hidden != was_hidden))
        tiles_gather(server, session->tile.place.wall, NULL);
    save_resolve(server, session);
    const struct pacer *pacer = session_take_shown(session);
    if (pacer)
        latency_stages_shown(&server->latency, pacer);
    if (session->demand.input_ns == now_ns) {
        server->session_context.load.moving_until_ns = now_ns + MOVING_NS;
        if (follow_spread(server, stream))
            pump_followers(server, stream);
    }
    stream->in.length = 0;
    stream->in_count = 0;
    if (stream->in.capacity > 4096)
        text_finish(&stream->in);
}

static bool is_utf8(const struct text *text)
{
    size_t at = 0, length = 1;
    while (at < text->length && length > 0) {
        length = text->at[at] ? utf8_length(text->at + at, text->length - at) : 1;
        at += length;
    }
    return length > 0;
}

/* Receives a part of a message. Checks here that a complete text is UTF-8: libwebsockets' own check would also reject a pong
   after the text, whose bytes need not be UTF-8. */
static void on_receive(struct server_context *server, struct stream *stream, const void *bytes, size_t len)
{
    if (server->life.hands_over)
        return;
    if (stream->in_count == 0)
        stream->in_begin_ns = clock_mono_ns();
    stream->in_count += len;
    if (stream->in_count > SESSION_MAX_INPUT_BYTES) {
        close_with(stream, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "a message is larger than 1 MiB");
        lws_rx_flow_control(stream->wsi, 0);
        return;
    }
    bool is_whole = stream->in_count <= (size_t)server->room.quotas->at[QUOTA_MESSAGE_BYTES];
    if (is_whole)
        text_add_bytes(&stream->in, bytes, len);
    if (lws_remaining_packet_payload(stream->wsi) == 0 && lws_is_final_fragment(stream->wsi)) {
        if (is_whole && !lws_frame_is_binary(stream->wsi) && !is_utf8(&stream->in)) {
            close_with(stream, LWS_CLOSE_STATUS_INVALID_PAYLOAD, "a text message is not UTF-8");
            lws_rx_flow_control(stream->wsi, 0);
            return;
        }
        on_message(server, stream);
        pump(server, stream);
    }
}

void stream_on_historical_snapshot(struct server_context *server, const struct history_loader_answer *answer)
{
    struct stream *stream = stream_find(server, answer->client);
    session_on_historical_snapshot(stream->session, answer->at_us, answer->good, clock_mono_ns());
    if (follow_spread(server, stream))
        pump_followers(server, stream);
    pump(server, stream);
}

/* --- libwebsockets events --------------------------------------------------------------------------------------------- */

/* Returns whether answers to actions must still be sent. At shutdown, connections are closed only after these answers: a client
   that lacks an answer cannot tell whether its action took effect. */
static bool owes_answer(const struct stream *stream)
{
    return stream->close_code == LWS_CLOSE_STATUS_GOINGAWAY && stream->session->owed.reply_count > 0;
}

static int on_writeable(struct server_context *server, struct stream *stream)
{
    if (owes_answer(stream)) {
        lws_callback_on_writable(stream->wsi);
        return stream_send(server, stream) ? 0 : -1;
    }
    if (stream->close_code) {
        lws_close_reason(stream->wsi, (enum lws_close_status)stream->close_code, (unsigned char *)stream->close_text,
                         strlen(stream->close_text));
        return -1;
    }
    if (!stream_send(server, stream))
        return -1;
    pump(server, stream);
    render_service_wake(server->params.plant.render_service);
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
        render_service_wake(server_context_of(wsi)->params.plant.render_service);
        break;
    case LWS_CALLBACK_RECEIVE_PONG:
        stream_on_pong(*slot, in, len);
        pump(server_context_of(wsi), *slot);
        render_service_wake(server_context_of(wsi)->params.plant.render_service);
        break;
    case LWS_CALLBACK_SERVER_WRITEABLE: return on_writeable(server_context_of(wsi), *slot);
    default: break;
    }
    return 0;
}
