/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which clients share one stream of packets (encoded frames), and which of these packets each client needs. */
#include "service/encode_streams.h"

#include <string.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"

/* JOIN_NS: minimum time between key frames that are encoded only to let clients join an encode stream. It is doubled, up to
   JOIN_MAX_NS, for clients that often fall behind. */
static const int64_t JOIN_NS = 2 * NS_PER_S, JOIN_MAX_NS = 64 * NS_PER_S;
/* maximum number of packets that a client may lag behind its stream and still get all that it missed; also the maximum number
   of frames that are planned but not encoded yet */
enum { MAX_LAG_PACKETS = ENCODE_STREAM_KEPT / 2 };
/* limit on the bytes of sent packets that a stream keeps for clients that missed some: twice KEPT_BYTES or, if that is more,
   twice the bytes of the last key frame */
static const size_t KEPT_BYTES = 64 * 1024;

/* --- members of streams ----------------------------------------------------------------------------------------------- */

static size_t place_of(const struct encode_streams *streams, uint64_t client)
{
    size_t at;
    search_sorted(at, streams->link_count, streams->links[at].client < client);
    return at;
}

static struct encode_stream_member *find(const struct encode_streams *streams, uint64_t client)
{
    size_t at = place_of(streams, client);
    return at < streams->link_count && streams->links[at].client == client ? &streams->links[at] : NULL;
}

static struct encode_stream_member *find_or_add(struct encode_streams *streams, uint64_t client)
{
    struct encode_stream_member *known = find(streams, client);
    if (known)
        return known;
    size_t at = place_of(streams, client);
    mem_grow(&streams->links, &streams->link_capacity, streams->link_count + 1, sizeof(*streams->links));
    memmove(streams->links + at + 1, streams->links + at, (streams->link_count++ - at) * sizeof(*streams->links));
    streams->links[at] = (struct encode_stream_member){ .client = client, .patience_ns = JOIN_NS };
    return &streams->links[at];
}

void encode_streams_forget(struct encode_streams *streams, uint64_t client)
{
    struct encode_stream_member *link = find(streams, client);
    if (!link)
        return;
    if (link->stream)
        link->stream->members--;
    memmove(link, link + 1, (size_t)(streams->links + --streams->link_count - link) * sizeof(*link));
}

/* --- packets that a client has not received --------------------------------------------------------------------------- */

static bool same_coding(const struct encode_stream *stream, const struct frame *frame, const struct frame_request *request)
{
    const struct frame_request *shown = &stream->shown;
    return shown->codec == request->codec && shown->overlay == request->overlay && shown->record == request->record &&
           shown->quality.quality == request->quality.quality && shown->quality.full_chroma == request->quality.full_chroma &&
           shown->view.width_px == frame->width_px && shown->view.height_px == frame->height_px;
}

/* Returns the sequence number of the first packet of the stream that the client has not received. */
static uint64_t lacks(const struct encode_stream *stream, const struct encode_stream_member *link, const struct request_ticket *ticket)
{
    uint64_t next = link && link->stream == stream && !ticket->request.alone ? link->position + 1 : 1;
    return next > stream->key ? next : stream->key;
}

static bool reaches(const struct encode_stream *stream, const struct encode_stream_member *link, const struct request_ticket *ticket)
{
    uint64_t first = lacks(stream, link, ticket);
    return stream->key > 0 && first >= stream->oldest && stream->planned < first + MAX_LAG_PACKETS;
}

/* --- planning --------------------------------------------------------------------------------------------------------- */

/* Returns the encode stream to which most of these clients already belong, if the stream still keeps all packets that they missed. */
static struct encode_stream *most_common(struct encode_streams *streams, const struct request_group *tickets)
{
    struct encode_stream *best = NULL;
    for (struct encode_stream *stream = streams->first; stream; stream = stream->next)
        stream->present = 0;
    for (size_t i = 0; i < tickets->count; i++) {
        struct encode_stream_member *link = find(streams, tickets->tickets[i].client);
        struct encode_stream *stream = link ? link->stream : NULL;
        if (!stream || stream->shown.codec != tickets->tickets[i].request.codec || !reaches(stream, link, &tickets->tickets[i]))
            continue;
        if (++stream->present > (best ? best->present : 0))
            best = stream;
    }
    return best;
}

/* Returns whether a client of the group wants a depth grid, the frame has one, and none was sent with the stream's newest content. */
static bool brings_depth(const struct encode_stream *stream, const struct frame *frame, const struct request_group *tickets)
{
    return frame->depth[0] && !stream->has_depth && request_group_wants_depth(tickets);
}

/* Returns whether the stream's newest packet shows the same picture as this frame, and the packets from the key frame on are still kept. */
static bool shows(const struct encode_stream *stream, const struct frame *frame, const struct request_group *tickets)
{
    const struct frame_request *request = &tickets->tickets[0].request;
    return !request->overlay && stream->key > 0 && stream->key >= stream->oldest && stream->planned < stream->key + MAX_LAG_PACKETS &&
           stream->content == frame->content && same_coding(stream, frame, request) && !brings_depth(stream, frame, tickets);
}

/* Returns a stream whose newest packet shows the same picture as this frame; NULL: there is none. whole: true: the newest
   packet must be a key frame. */
static struct encode_stream *showing(const struct encode_streams *streams, const struct frame *frame, const struct request_group *tickets,
                                     bool whole)
{
    struct encode_stream *stream = streams->first;
    while (stream && !(shows(stream, frame, tickets) && (!whole || stream->key == stream->planned)))
        stream = stream->next;
    return stream;
}

/* Returns whether most of the stream's up-to-date clients now request another view. */
static bool belongs_to_others(const struct encode_streams *streams, const struct encode_stream *stream, const struct frame *frame)
{
    size_t all = 0;
    if (view_equal(&stream->shown.view, &frame->view))
        return false;
    for (size_t i = 0; i < streams->link_count; i++)
        all += streams->links[i].stream == stream && streams->links[i].position == stream->planned;
    return all > 2 * stream->present;
}

static struct encode_stream *add_chain(struct encode_streams *streams)
{
    struct encode_stream *stream = mem_new(sizeof(*stream));
    stream->next = streams->first;
    stream->oldest = 1;
    streams->first = stream;
    return stream;
}

/* Returns the encode stream that only this client uses, if its codec is the requested one, so that encoder and packets are
   reused; NULL: there is none. */
static struct encode_stream *own_chain(const struct encode_streams *streams, const struct request_group *tickets)
{
    const struct encode_stream_member *link = find(streams, tickets->tickets[0].client);
    struct encode_stream *stream = link ? link->stream : NULL;
    return stream && stream->members == 1 && stream->shown.codec == tickets->tickets[0].request.codec ? stream : NULL;
}

struct outsiders {
    struct encode_streams *streams;
    const struct encode_stream *stream;
};

static bool is_outside(const struct request_ticket *ticket, void *arg)
{
    const struct outsiders *outsiders = arg;
    return !reaches(outsiders->stream, find(outsiders->streams, ticket->client), ticket);
}

static size_t count_outside(struct outsiders *outsiders, const struct request_group *tickets, int64_t now_ns, bool *patient)
{
    size_t count = 0;
    *patient = true;
    for (size_t i = 0; i < tickets->count; i++) {
        if (!is_outside(&tickets->tickets[i], outsiders))
            continue;
        const struct encode_stream_member *link = find(outsiders->streams, tickets->tickets[i].client);
        *patient &= link && now_ns < link->join_after_ns;
        count++;
    }
    return count;
}

/* Returns whether clients of other streams may join this stream now. Joining takes a key frame, which uses bandwidth of the
   stream's other clients. If joining is refused, moves the tickets of these clients to `rest`. */
static bool let_in(struct encode_streams *streams, const struct encode_stream *stream, struct request_group *tickets, int64_t now_ns,
                   struct request_group *rest)
{
    struct outsiders outsiders = { streams, stream };
    bool patient;
    size_t outside = count_outside(&outsiders, tickets, now_ns, &patient);
    if (outside == 0)
        return false;
    if (outside >= tickets->count - outside || (!patient && now_ns - stream->key_ns >= JOIN_NS))
        return true;
    request_group_split(tickets, is_outside, &outsiders, rest);
    return false;
}

static void join(struct encode_stream_member *link, struct encode_stream *stream, int64_t now_ns)
{
    bool fell_out = link->stream == stream;
    if (fell_out && now_ns - link->joined_ns < JOIN_MAX_NS)
        link->patience_ns = link->patience_ns * 2 > JOIN_MAX_NS ? JOIN_MAX_NS : link->patience_ns * 2;
    else
        link->patience_ns = JOIN_NS;
    if (link->stream)
        link->stream->members--;
    link->stream = stream;
    stream->members++;
    link->joined_ns = now_ns;
    link->join_after_ns = now_ns + link->patience_ns;
}

/* Determines the packets that each client needs to show the newest frame, and counts these clients as up to date. */
static void give(struct encode_streams *streams, const struct request_group *tickets, int64_t now_ns, struct encode_plan *plan)
{
    struct encode_stream *stream = plan->stream;
    mem_grow(&plan->from, &plan->from_capacity, tickets->count, sizeof(*plan->from));
    for (size_t i = 0; i < tickets->count; i++) {
        const struct request_ticket *ticket = &tickets->tickets[i];
        struct encode_stream_member *link = find_or_add(streams, ticket->client);
        bool was_in = link->stream == stream && !plan->key;
        plan->from[i] = lacks(stream, link, ticket);
        if (!was_in)
            join(link, stream, now_ns);
        link->position = stream->planned;
    }
}

static struct encode_stream *choose(struct encode_streams *streams, const struct frame *frame, const struct request_group *tickets)
{
    struct encode_stream *stream = most_common(streams, tickets), *other = NULL;
    if (stream && !shows(stream, frame, tickets))
        other = showing(streams, frame, tickets, true);
    if (other)
        /* the newest packet of the stream `other` is a key frame of the same picture, so the clients join that stream at no extra cost */
        return other;
    if (!stream)
        stream = showing(streams, frame, tickets, false);
    else if (stream->content != frame->content && belongs_to_others(streams, stream, frame))
        stream = NULL;
    if (!stream)
        stream = own_chain(streams, tickets);
    return stream ? stream : add_chain(streams);
}

/* Returns whether a client of the group must get the frame although it already shows the same picture (`always`). Ignores
   requests that must decode without earlier packets (`alone`): their clients get the stored packets from the last key frame on. */
static bool must_again(const struct request_group *tickets)
{
    for (size_t i = 0; i < tickets->count; i++)
        if (tickets->tickets[i].request.always && !tickets->tickets[i].request.alone)
            return true;
    return false;
}

/* Returns whether every packet of this frame decodes without earlier packets: JPEG and PNG send the whole picture after a
   camera move. Clients can then join the stream without an additional key frame. */
static bool is_whole(const struct encode_stream *stream, const struct frame *frame, const struct frame_request *request)
{
    return request->codec != WIRE_CODEC_H264 && !view_equal(&stream->shown.view, &frame->view);
}

void encode_streams_plan(struct encode_streams *streams, const struct frame *frame, struct request_group *tickets, int64_t now_ns,
                         struct encode_plan *plan, struct request_group *rest)
{
    const struct frame_request *request = &tickets->tickets[0].request;
    struct encode_stream *stream = plan->stream = choose(streams, frame, tickets);
    bool sized = stream->shown.view.width_px == frame->width_px && stream->shown.view.height_px == frame->height_px;
    rest->count = 0;
    plan->key = is_whole(stream, frame, request) || let_in(streams, stream, tickets, now_ns, rest) || stream->key == 0 || !sized;
    plan->again = must_again(tickets) || brings_depth(stream, frame, tickets);
    plan->encode = plan->key || plan->again || stream->content != frame->content || !same_coding(stream, frame, request);
    if (plan->encode) {
        stream->planned++;
        stream->shown = *request;
        stream->shown.view = frame->view;
        stream->content = frame->content;
        stream->has_depth = frame->depth[0] != NULL;
    }
    if (plan->key) {
        stream->key = stream->planned;
        stream->key_ns = now_ns;
    }
    plan->number = stream->planned;
    give(streams, tickets, now_ns, plan);
}

/* --- packets ---------------------------------------------------------------------------------------------------------- */

static void drop_oldest(struct encode_stream *stream)
{
    if (stream->kept[0])
        stream->kept_bytes -= stream->kept[0]->count;
    packet_unref(&stream->kept[0]);
    memmove(stream->kept, stream->kept + 1, (size_t)--stream->kept_count * sizeof(stream->kept[0]));
    stream->oldest++;
}

static size_t most_bytes(const struct encode_stream *stream)
{
    return 2 * (stream->key_bytes > KEPT_BYTES ? stream->key_bytes : KEPT_BYTES);
}

void encode_stream_keep(struct encode_stream *stream, struct packet *packet, uint64_t needed)
{
    bool key = packet && packet->key;
    while (stream->kept_count > 0 && stream->oldest < needed &&
           (key || stream->kept_count == ENCODE_STREAM_KEPT || stream->kept_bytes > most_bytes(stream)))
        drop_oldest(stream);
    /* drops the oldest packet although clients still need all packets in the list: the list holds more packets than a client
       may have in flight, so the oldest one has arrived */
    if (stream->kept_count == ENCODE_STREAM_KEPT)
        drop_oldest(stream);
    stream->kept[stream->kept_count++] = packet ? packet_ref(packet) : NULL;
    stream->kept_bytes += packet ? packet->count : 0;
    if (key)
        stream->key_bytes = packet->count;
}

int encode_stream_catch_up(const struct encode_stream *stream, uint64_t from, uint64_t to, struct packet *out[ENCODE_STREAM_KEPT])
{
    int count = 0;
    if (from > to)
        return 0;
    bool lacks_some = from < stream->oldest;
    if (to < stream->oldest || to >= stream->oldest + (uint64_t)stream->kept_count)
        return -1;
    for (uint64_t number = lacks_some ? stream->oldest : from; number <= to; number++) {
        struct packet *packet = stream->kept[number - stream->oldest];
        if (packet && packet->key)
            count = 0;
        if (packet)
            out[count++] = packet;
    }
    if (lacks_some && !(count > 0 && out[0]->key))
        return -1;
    return count;
}

void encode_stream_break(struct encode_stream *stream)
{
    while (stream->kept_count > 0)
        drop_oldest(stream);
    stream->oldest++;
    if (stream->key < stream->oldest)
        stream->key = 0;
}

struct encode_stream *encode_streams_take_empty(struct encode_streams *streams, bool (*busy)(const struct encode_stream *stream))
{
    for (struct encode_stream **at = &streams->first; *at; at = &(*at)->next) {
        struct encode_stream *stream = *at;
        if (stream->members > 0 || busy(stream))
            continue;
        *at = stream->next;
        return stream;
    }
    return NULL;
}

void encode_stream_destroy(struct encode_stream **stream)
{
    while ((*stream)->kept_count > 0)
        drop_oldest(*stream);
    mem_free(*stream);
    *stream = NULL;
}
