/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each address has. */
#include "net/peers.h"

#include <arpa/inet.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"

struct peers {
    const struct quotas *quotas;
    struct peer **all; /* some thousands at most, and looked up once per connection */
    size_t count, capacity;
    uint64_t payers; /* numbers given */
    bool exempt;
};

struct peers *peers_create(const struct quotas *quotas, bool exempt)
{
    struct peers *peers = mem_new(sizeof(*peers));
    peers->quotas = quotas;
    peers->exempt = exempt;
    return peers;
}

void peers_destroy(struct peers **peers_ptr)
{
    struct peers *peers = *peers_ptr;
    if (!peers)
        return;
    for (size_t i = 0; i < peers->count; i++)
        mem_free(peers->all[i]);
    mem_free(peers->all);
    mem_free(peers);
    *peers_ptr = NULL;
}

static void read_address(const char *text, struct peer *out)
{
    static const uint8_t mapped[12] = { [10] = 0xff, [11] = 0xff };
    struct in6_addr six;
    struct in_addr four;
    char plain[64] = "";
    memcpy(plain, text, strcspn(text, "%") < sizeof(plain) ? strcspn(text, "%") : 0); /* fe80::1%eth0 */
    if (inet_pton(AF_INET, plain, &four) == 1) {
        memcpy(out->address, mapped, sizeof(mapped));
        memcpy(out->address + 12, &four, 4);
    } else if (inet_pton(AF_INET6, plain, &six) == 1) {
        bool is_four = IN6_IS_ADDR_V4MAPPED(&six), loopback = IN6_IS_ADDR_LOOPBACK(&six);
        memcpy(out->address, &six, is_four || loopback ? 16 : 8);
        out->local = loopback;
    }
    out->local |= memcmp(out->address, mapped, sizeof(mapped)) == 0 && out->address[12] == 127;
}

static bool is_exempt(const struct peers *peers, const struct peer *peer, enum quota quota)
{
    return peers->exempt && peer->local && !peers->quotas->given[quota];
}

struct peer *peers_ref(struct peers *peers, const char *address)
{
    struct peer read = { .refs = 1 };
    read_address(address, &read);
    for (size_t i = 0; i < peers->count; i++)
        if (!memcmp(peers->all[i]->address, read.address, sizeof(read.address))) {
            peers->all[i]->refs++;
            return peers->all[i];
        }
    mem_grow(&peers->all, &peers->capacity, peers->count + 1, sizeof(struct peer *));
    struct peer *peer = mem_new(sizeof(*peer));
    *peer = read;
    peer->share.payer = ++peers->payers;
    peer->share.exempt_pixels = is_exempt(peers, peer, QUOTA_ADDRESS_PIXELS);
    return peers->all[peers->count++] = peer;
}

void peers_unref(struct peers *peers, struct peer **peer_ptr)
{
    struct peer *peer = *peer_ptr;
    *peer_ptr = NULL;
    if (!peer || --peer->refs > 0)
        return;
    size_t i = 0;
    while (peers->all[i] != peer)
        i++;
    peers->all[i] = peers->all[--peers->count];
    mem_free(peer);
}

static bool below(const struct peers *peers, const struct peer *peer, enum quota quota, int64_t count)
{
    return is_exempt(peers, peer, quota) || count < peers->quotas->at[quota];
}

bool peers_may_connect(const struct peers *peers, const struct peer *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_CONNECTIONS, peer->connections);
}

bool peers_may_be_named(const struct peers *peers, const struct peer *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_CONNECTIONS, peer->named);
}

bool peers_may_stream(const struct peers *peers, const struct peer *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_SESSIONS, peer->sessions);
}

bool peers_may_ask(const struct peers *peers, const struct peer *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_QUESTIONS, peer->questions);
}

bool peers_may_hold(const struct peers *peers, const struct peer *peer, size_t count)
{
    return below(peers, peer, QUOTA_ADDRESS_ANSWER_BYTES, peer->answer_bytes + (int64_t)count);
}

bool peers_may_draw(const struct peers *peers, const struct peer *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_SNAPSHOTS, peer->pictures);
}

bool peers_count_message(const struct peers *peers, struct peer *peer, int64_t now_ns)
{
    if (now_ns - peer->rate_begin_ns >= NS_PER_S) {
        peer->rate_begin_ns = now_ns;
        peer->messages = 0;
    }
    return below(peers, peer, QUOTA_ADDRESS_MESSAGES, peer->messages++);
}

int peers_count(const struct peers *peers)
{
    return (int)peers->count;
}
