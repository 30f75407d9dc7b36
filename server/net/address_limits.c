/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each address has. */
#include "net/address_limits.h"

#include <arpa/inet.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"

struct address_limits {
    const struct quotas *quotas;
    struct address_usage **all; /* some thousands at most, and looked up once per connection */
    size_t count, capacity;
    uint64_t payers; /* numbers given */
    bool exempt;
};

struct address_limits *address_limits_create(const struct quotas *quotas, bool exempt)
{
    struct address_limits *peers = mem_new(sizeof(*peers));
    peers->quotas = quotas;
    peers->exempt = exempt;
    return peers;
}

void address_limits_destroy(struct address_limits **peers_ptr)
{
    struct address_limits *peers = *peers_ptr;
    if (!peers)
        return;
    for (size_t i = 0; i < peers->count; i++)
        mem_free(peers->all[i]);
    mem_free(peers->all);
    mem_free(peers);
    *peers_ptr = NULL;
}

static void read_address(const char *text, struct address_usage *out)
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

static bool is_exempt(const struct address_limits *peers, const struct address_usage *peer, enum quota quota)
{
    return peers->exempt && peer->local && !peers->quotas->given[quota];
}

struct address_usage *address_limits_ref(struct address_limits *peers, const char *address)
{
    struct address_usage read = { .refs = 1 };
    read_address(address, &read);
    for (size_t i = 0; i < peers->count; i++)
        if (!memcmp(peers->all[i]->address, read.address, sizeof(read.address))) {
            peers->all[i]->refs++;
            return peers->all[i];
        }
    mem_grow(&peers->all, &peers->capacity, peers->count + 1, sizeof(struct address_usage *));
    struct address_usage *peer = mem_new(sizeof(*peer));
    *peer = read;
    peer->share.payer = ++peers->payers;
    peer->share.exempt_pixels = is_exempt(peers, peer, QUOTA_ADDRESS_PIXELS);
    return peers->all[peers->count++] = peer;
}

void address_limits_unref(struct address_limits *peers, struct address_usage **peer_ptr)
{
    struct address_usage *peer = *peer_ptr;
    *peer_ptr = NULL;
    if (!peer || --peer->refs > 0)
        return;
    size_t i = 0;
    while (peers->all[i] != peer)
        i++;
    peers->all[i] = peers->all[--peers->count];
    mem_free(peer);
}

static bool below(const struct address_limits *peers, const struct address_usage *peer, enum quota quota, int64_t count)
{
    return is_exempt(peers, peer, quota) || count < peers->quotas->at[quota];
}

bool address_limits_may_connect(const struct address_limits *peers, const struct address_usage *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_CONNECTIONS, peer->connections);
}

bool address_limits_may_be_named(const struct address_limits *peers, const struct address_usage *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_CONNECTIONS, peer->named);
}

bool address_limits_may_stream(const struct address_limits *peers, const struct address_usage *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_SESSIONS, peer->sessions);
}

bool address_limits_may_ask(const struct address_limits *peers, const struct address_usage *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_QUESTIONS, peer->questions);
}

bool address_limits_may_hold(const struct address_limits *peers, const struct address_usage *peer, size_t count)
{
    return below(peers, peer, QUOTA_ADDRESS_ANSWER_BYTES, peer->answer_bytes + (int64_t)count);
}

bool address_limits_may_draw(const struct address_limits *peers, const struct address_usage *peer)
{
    return below(peers, peer, QUOTA_ADDRESS_SNAPSHOTS, peer->pictures);
}

bool address_limits_count_message(const struct address_limits *peers, struct address_usage *peer, int64_t now_ns)
{
    if (now_ns - peer->rate_begin_ns >= NS_PER_S) {
        peer->rate_begin_ns = now_ns;
        peer->messages = 0;
    }
    return below(peers, peer, QUOTA_ADDRESS_MESSAGES, peer->messages++);
}

int address_limits_count(const struct address_limits *peers)
{
    return (int)peers->count;
}
