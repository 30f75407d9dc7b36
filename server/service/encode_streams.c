/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chains of packets and the clients in them. */
#include "service/encode_streams.h"

#include <string.h>

#include "base/clock.h"
#include "base/mem.h"

static const int64_t JOIN_NS = 2 * NS_PER_S, JOIN_MAX_NS = 64 * NS_PER_S; /* between pictures that stand alone only to let some in */
enum { CATCH_UP = ENCODE_STREAM_KEPT / 2 };                               /* packets; as many may be planned for while they are needed */
static const size_t KEPT_BYTES = 64 * 1024;                               /* at least; else as much as the last picture that stood alone */

/* --- who is where ------------------------------------------------------------------------------------------------------------ */

static size_t place_of(const struct encode_streams *chains, uint64_t client)
{
    size_t low = 0, high = chains->link_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (chains->links[middle].client < client)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static struct encode_stream_member *find(const struct encode_streams *chains, uint64_t client)
{
    size_t at = place_of(chains, client);
    return at < chains->link_count && chains->links[at].client == client ? &chains->links[at] : NULL;
}

static struct encode_stream_member *find_or_add(struct encode_streams *chains, uint64_t client)
{
    struct encode_stream_member *known = find(chains, client);
    if (known)
        return known;
    size_t at = place_of(chains, client);
    mem_grow(&chains->links, &chains->link_capacity, chains->link_count + 1, sizeof(*chains->links));
    memmove(chains->links + at + 1, chains->links + at, (chains->link_count++ - at) * sizeof(*chains->links));
    chains->links[at] = (struct encode_stream_member){ .client = client, .patience_ns = JOIN_NS };
    return &chains->links[at];
}

void encode_streams_forget(struct encode_streams *chains, uint64_t client)
{
    struct encode_stream_member *link = find(chains, client);
    if (!link)
        return;
    if (link->chain)
        link->chain->members--;
    memmove(link, link + 1, (size_t)(chains->links + --chains->link_count - link) * sizeof(*link));
}

/* --- what someone lacks -------------------------------------------------------------------------------------------------------- */

static bool same_coding(const struct encode_stream *chain, const struct frame *frame, const struct frame_request *wish)
{
    const struct frame_request *shown = &chain->shown;
    return shown->codec == wish->codec && shown->overlay == wish->overlay && shown->quality.quality == wish->quality.quality &&
           shown->quality.full_chroma == wish->quality.full_chroma && shown->view.width_px == frame->width_px &&
           shown->view.height_px == frame->height_px;
}

/* The first number that the client needs. */
static uint64_t lacks(const struct encode_stream *chain, const struct encode_stream_member *link, const struct request_ticket *order)
{
    uint64_t next = link && link->chain == chain && !order->wish.alone ? link->position + 1 : 1;
    return next > chain->key ? next : chain->key;
}

static bool reaches(const struct encode_stream *chain, const struct encode_stream_member *link, const struct request_ticket *order)
{
    uint64_t first = lacks(chain, link, order);
    return chain->key > 0 && first >= chain->oldest && chain->planned < first + CATCH_UP;
}

/* --- planning ------------------------------------------------------------------------------------------------------------------ */

/* The chain that most of them are in already and can go on with. */
static struct encode_stream *most_common(struct encode_streams *chains, const struct request_group *orders)
{
    struct encode_stream *best = NULL;
    for (struct encode_stream *chain = chains->first; chain; chain = chain->next)
        chain->present = 0;
    for (size_t i = 0; i < orders->count; i++) {
        struct encode_stream_member *link = find(chains, orders->orders[i].client);
        struct encode_stream *chain = link ? link->chain : NULL;
        if (!chain || chain->shown.codec != orders->orders[i].wish.codec || !reaches(chain, link, &orders->orders[i]))
            continue;
        if (++chain->present > (best ? best->present : 0))
            best = chain;
    }
    return best;
}

/* It shows this already, and all of it can still be had. */
static bool shows(const struct encode_stream *chain, const struct frame *frame, const struct frame_request *wish)
{
    return !wish->overlay && chain->key > 0 && chain->key >= chain->oldest && chain->planned < chain->key + CATCH_UP &&
           chain->content == frame->content && same_coding(chain, frame, wish);
}

/* One that shows this already; whole: by a picture that stands alone. */
static struct encode_stream *showing(const struct encode_streams *chains, const struct frame *frame, const struct frame_request *wish,
                                     bool whole)
{
    struct encode_stream *chain = chains->first;
    while (chain && !(shows(chain, frame, wish) && (!whole || chain->key == chain->planned)))
        chain = chain->next;
    return chain;
}

/* Most of those who have all of it look at something else. */
static bool belongs_to_others(const struct encode_streams *chains, const struct encode_stream *chain, const struct frame *frame)
{
    size_t all = 0;
    if (view_equal(&chain->shown.view, &frame->view))
        return false;
    for (size_t i = 0; i < chains->link_count; i++)
        all += chains->links[i].chain == chain && chains->links[i].position == chain->planned;
    return all > 2 * chain->present;
}

static struct encode_stream *add_chain(struct encode_streams *chains)
{
    struct encode_stream *chain = mem_new(sizeof(*chain));
    chain->next = chains->first;
    chain->oldest = 1;
    chains->first = chain;
    return chain;
}

/* A client that is alone in its chain, or in none, keeps what was made for it. */
static struct encode_stream *own_chain(const struct encode_streams *chains, const struct request_group *orders)
{
    const struct encode_stream_member *link = find(chains, orders->orders[0].client);
    struct encode_stream *chain = link ? link->chain : NULL;
    return chain && chain->members == 1 && chain->shown.codec == orders->orders[0].wish.codec ? chain : NULL;
}

struct outsiders {
    struct encode_streams *chains;
    const struct encode_stream *chain;
};

static bool is_outside(const struct request_ticket *order, void *arg)
{
    const struct outsiders *outsiders = arg;
    return !reaches(outsiders->chain, find(outsiders->chains, order->client), order);
}

static size_t count_outside(struct outsiders *outsiders, const struct request_group *orders, int64_t now_ns, bool *patient)
{
    size_t count = 0;
    *patient = true;
    for (size_t i = 0; i < orders->count; i++) {
        if (!is_outside(&orders->orders[i], outsiders))
            continue;
        const struct encode_stream_member *link = find(outsiders->chains, orders->orders[i].client);
        *patient &= link && now_ns < link->join_after_ns;
        count++;
    }
    return count;
}

/* Whether those outside may cost the others a picture that stands alone; else they go to rest. */
static bool let_in(struct encode_streams *chains, const struct encode_stream *chain, struct request_group *orders, int64_t now_ns,
                   struct request_group *rest)
{
    struct outsiders outsiders = { chains, chain };
    bool patient;
    size_t outside = count_outside(&outsiders, orders, now_ns, &patient);
    if (outside == 0)
        return false;
    if (outside >= orders->count - outside || (!patient && now_ns - chain->key_ns >= JOIN_NS))
        return true;
    request_group_split(orders, is_outside, &outsiders, rest);
    return false;
}

static void join(struct encode_stream_member *link, struct encode_stream *chain, int64_t now_ns)
{
    bool fell_out = link->chain == chain;
    if (fell_out && now_ns - link->joined_ns < JOIN_MAX_NS)
        link->patience_ns = link->patience_ns * 2 > JOIN_MAX_NS ? JOIN_MAX_NS : link->patience_ns * 2;
    else
        link->patience_ns = JOIN_NS;
    if (link->chain)
        link->chain->members--;
    link->chain = chain;
    chain->members++;
    link->joined_ns = now_ns;
    link->join_after_ns = now_ns + link->patience_ns;
}

/* Hands out what each lacks; all of them are up to date after it. */
static void give(struct encode_streams *chains, const struct request_group *orders, int64_t now_ns, struct encode_plan *plan)
{
    struct encode_stream *chain = plan->chain;
    mem_grow(&plan->from, &plan->from_capacity, orders->count, sizeof(*plan->from));
    for (size_t i = 0; i < orders->count; i++) {
        const struct request_ticket *order = &orders->orders[i];
        struct encode_stream_member *link = find_or_add(chains, order->client);
        bool was_in = link->chain == chain && !plan->key;
        plan->from[i] = lacks(chain, link, order);
        if (!was_in)
            join(link, chain, now_ns);
        link->position = chain->planned;
    }
}

static struct encode_stream *choose(struct encode_streams *chains, const struct frame *frame, const struct request_group *orders)
{
    const struct frame_request *wish = &orders->orders[0].wish;
    struct encode_stream *chain = most_common(chains, orders), *other = NULL;
    if (chain && !shows(chain, frame, wish))
        other = showing(chains, frame, wish, true);
    if (other)
        return other; /* made a moment ago for some who asked first: nobody needs another */
    if (!chain)
        chain = showing(chains, frame, wish, false);
    else if (chain->content != frame->content && belongs_to_others(chains, chain, frame))
        chain = NULL;
    if (!chain)
        chain = own_chain(chains, orders);
    return chain ? chain : add_chain(chains);
}

/* Someone has the same already, and shall have it once more; alone, it is given what was kept. */
static bool must_again(const struct request_group *orders)
{
    for (size_t i = 0; i < orders->count; i++)
        if (orders->orders[i].wish.always && !orders->orders[i].wish.alone)
            return true;
    return false;
}

/* Where all has moved, JPEG and PNG come whole anyway: everyone may come in, at no cost for the others. */
static bool is_whole(const struct encode_stream *chain, const struct frame *frame, const struct frame_request *wish)
{
    return wish->codec != WIRE_CODEC_H264 && !view_equal(&chain->shown.view, &frame->view);
}

void encode_streams_plan(struct encode_streams *chains, const struct frame *frame, struct request_group *orders, int64_t now_ns,
                         struct encode_plan *plan, struct request_group *rest)
{
    const struct frame_request *wish = &orders->orders[0].wish;
    struct encode_stream *chain = plan->chain = choose(chains, frame, orders);
    bool sized = chain->shown.view.width_px == frame->width_px && chain->shown.view.height_px == frame->height_px;
    rest->count = 0;
    plan->key = is_whole(chain, frame, wish) || let_in(chains, chain, orders, now_ns, rest) || chain->key == 0 || !sized;
    plan->again = must_again(orders);
    plan->encode = plan->key || plan->again || chain->content != frame->content || !same_coding(chain, frame, wish);
    if (plan->encode) {
        chain->planned++;
        chain->shown = *wish;
        chain->shown.view = frame->view;
        chain->content = frame->content;
    }
    if (plan->key) {
        chain->key = chain->planned;
        chain->key_ns = now_ns;
    }
    plan->number = chain->planned;
    give(chains, orders, now_ns, plan);
}

/* --- packets -------------------------------------------------------------------------------------------------------------------- */

static void drop_oldest(struct encode_stream *chain)
{
    if (chain->kept[0])
        chain->kept_bytes -= chain->kept[0]->count;
    packet_unref(&chain->kept[0]);
    memmove(chain->kept, chain->kept + 1, (size_t)--chain->kept_count * sizeof(chain->kept[0]));
    chain->oldest++;
}

static size_t most_bytes(const struct encode_stream *chain)
{
    return 2 * (chain->key_bytes > KEPT_BYTES ? chain->key_bytes : KEPT_BYTES);
}

void encode_stream_keep(struct encode_stream *chain, struct packet *packet, uint64_t needed)
{
    bool key = packet && packet->key;
    while (chain->kept_count > 0 && chain->oldest < needed &&
           (key || chain->kept_count == ENCODE_STREAM_KEPT || chain->kept_bytes > most_bytes(chain)))
        drop_oldest(chain);
    if (chain->kept_count == ENCODE_STREAM_KEPT) /* more than a client may have under way */
        drop_oldest(chain);
    chain->kept[chain->kept_count++] = packet ? packet_ref(packet) : NULL;
    chain->kept_bytes += packet ? packet->count : 0;
    if (key)
        chain->key_bytes = packet->count;
}

int encode_stream_catch_up(const struct encode_stream *chain, uint64_t from, uint64_t to, struct packet *out[ENCODE_STREAM_KEPT])
{
    int count = 0;
    if (from > to)
        return 0;
    bool lacks_some = from < chain->oldest;
    if (to < chain->oldest || to >= chain->oldest + (uint64_t)chain->kept_count)
        return -1;
    for (uint64_t number = lacks_some ? chain->oldest : from; number <= to; number++) {
        struct packet *packet = chain->kept[number - chain->oldest];
        if (packet && packet->key)
            count = 0;
        if (packet)
            out[count++] = packet;
    }
    if (lacks_some && !(count > 0 && out[0]->key))
        return -1;
    return count;
}

void encode_stream_break(struct encode_stream *chain)
{
    while (chain->kept_count > 0)
        drop_oldest(chain);
    chain->oldest++;
    if (chain->key < chain->oldest)
        chain->key = 0;
}

struct encode_stream *encode_streams_take_empty(struct encode_streams *chains, bool (*busy)(const struct encode_stream *chain))
{
    for (struct encode_stream **at = &chains->first; *at; at = &(*at)->next) {
        struct encode_stream *chain = *at;
        if (chain->members > 0 || busy(chain))
            continue;
        *at = chain->next;
        return chain;
    }
    return NULL;
}

void encode_stream_destroy(struct encode_stream **chain)
{
    while ((*chain)->kept_count > 0)
        drop_oldest(*chain);
    mem_free(*chain);
    *chain = NULL;
}
