/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts what each client address uses (connections, requests, bytes), and compares it with the quotas. */
#include "net/address_limits.h"

#include <arpa/inet.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"

struct address_limits {
    const struct quotas *quotas;
    /* usage of quotas by each known client address; a few thousand addresses at most, because each new connection searches the
       array linearly */
    struct address_usage **all;
    size_t count, capacity;
    uint64_t payers; /* last id assigned to an address (address_share.account); ids count up from 1 */
    bool exempt;
};

struct address_limits *address_limits_create(const struct quotas *quotas, bool exempt)
{
    struct address_limits *limits = mem_new(sizeof(*limits));
    limits->quotas = quotas;
    limits->exempt = exempt;
    return limits;
}

void address_limits_destroy(struct address_limits **limits_ptr)
{
    struct address_limits *limits = *limits_ptr;
    if (!limits)
        return;
    for (size_t i = 0; i < limits->count; i++)
        mem_free(limits->all[i]);
    mem_free(limits->all);
    mem_free(limits);
    *limits_ptr = NULL;
}

static void read_address(const char *text, struct address_usage *out)
{
    static const uint8_t mapped[12] = { [10] = 0xff, [11] = 0xff };
    struct in6_addr six;
    struct in_addr four;
    char plain[64] = "";
    /* drops the zone index of a link-local address, such as %eth0 in fe80::1%eth0 */
    memcpy(plain, text, strcspn(text, "%") < sizeof(plain) ? strcspn(text, "%") : 0);
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

static bool is_exempt(const struct address_limits *limits, const struct address_usage *usage, enum quota quota)
{
    return limits->exempt && usage->local && !limits->quotas->given[quota];
}

struct address_usage *address_limits_ref(struct address_limits *limits, const char *address)
{
    struct address_usage read = { .refs = 1 };
    read_address(address, &read);
    for (size_t i = 0; i < limits->count; i++)
        if (!memcmp(limits->all[i]->address, read.address, sizeof(read.address))) {
            limits->all[i]->refs++;
            return limits->all[i];
        }
    mem_grow(&limits->all, &limits->capacity, limits->count + 1, sizeof(struct address_usage *));
    struct address_usage *usage = mem_new(sizeof(*usage));
    *usage = read;
    usage->share.account = ++limits->payers;
    usage->share.exempt_pixels = is_exempt(limits, usage, QUOTA_ADDRESS_PIXELS);
    return limits->all[limits->count++] = usage;
}

void address_limits_unref(struct address_limits *limits, struct address_usage **peer_ptr)
{
    struct address_usage *usage = *peer_ptr;
    *peer_ptr = NULL;
    if (!usage || --usage->refs > 0)
        return;
    size_t i = 0;
    while (limits->all[i] != usage)
        i++;
    limits->all[i] = limits->all[--limits->count];
    mem_free(usage);
}

static bool below(const struct address_limits *limits, const struct address_usage *usage, enum quota quota, int64_t count)
{
    return is_exempt(limits, usage, quota) || count < limits->quotas->at[quota];
}

bool address_limits_may_connect(const struct address_limits *limits, const struct address_usage *usage)
{
    return below(limits, usage, QUOTA_ADDRESS_CONNECTIONS, usage->connections);
}

bool address_limits_may_be_named(const struct address_limits *limits, const struct address_usage *usage)
{
    return below(limits, usage, QUOTA_ADDRESS_CONNECTIONS, usage->named);
}

bool address_limits_may_stream(const struct address_limits *limits, const struct address_usage *usage)
{
    return below(limits, usage, QUOTA_ADDRESS_SESSIONS, usage->sessions);
}

bool address_limits_may_ask(const struct address_limits *limits, const struct address_usage *usage)
{
    return below(limits, usage, QUOTA_ADDRESS_QUESTIONS, usage->questions);
}

bool address_limits_may_hold(const struct address_limits *limits, const struct address_usage *usage, size_t count)
{
    return below(limits, usage, QUOTA_ADDRESS_ANSWER_BYTES, usage->answer_bytes + (int64_t)count);
}

bool address_limits_may_draw(const struct address_limits *limits, const struct address_usage *usage)
{
    return below(limits, usage, QUOTA_ADDRESS_SNAPSHOTS, usage->pictures);
}

bool address_limits_count_message(const struct address_limits *limits, struct address_usage *usage, int64_t now_ns)
{
    if (now_ns - usage->rate_begin_ns >= NS_PER_S) {
        usage->rate_begin_ns = now_ns;
        usage->messages = 0;
    }
    return below(limits, usage, QUOTA_ADDRESS_MESSAGES, usage->messages++);
}
