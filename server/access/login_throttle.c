/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts wrong tokens per client address, and delays further attempts from addresses that sent too many. */
#include "access/login_throttle.h"

#include <string.h>

#include "base/clock.h"
#include "base/mem.h"

static const int64_t WINDOW_NS = 60 * NS_PER_S, WAIT_NS = LOGIN_WAIT_S * NS_PER_S, LOG_INTERVAL_NS = 600 * NS_PER_S;
enum { MAX_KNOWN_TOKENS = 256 };

/* token that was accepted earlier from the same client address; it is checked even while the address is throttled, so that
   other users of the address cannot lock its holder out */
struct known_token {
    uint8_t hash[TOKEN_HASH_BYTES];
    int64_t reported_ns, used_ns; /* reported_ns: time at which the login was last reported as new (LOGIN_GOOD_NEW) */
};

struct throttle_entry {
    uint8_t address[16];
    int64_t heard_ns;
    int64_t failed_ns[LOGIN_FAILURES]; /* ring buffer: times of the last wrong tokens from this address */
    int64_t failures;                  /* wrong tokens of this address in total; modulo LOGIN_FAILURES, the next index in failed_ns */
    int64_t slowed_until_ns, next_try_ns;
    struct known_token *known; /* the MAX_KNOWN_TOKENS tokens last accepted from this address */
    size_t known_count, known_capacity;
};

struct login_throttle {
    struct throttle_entry *entries;
    size_t count, capacity;
};

struct login_throttle *login_throttle_create(void)
{
    return mem_new(sizeof(struct login_throttle));
}

void login_throttle_destroy(struct login_throttle **logins_ptr)
{
    struct login_throttle *throttle = *logins_ptr;
    if (!throttle)
        return;
    for (size_t i = 0; i < throttle->count; i++)
        mem_free(throttle->entries[i].known);
    mem_free(throttle->entries);
    mem_free(throttle);
    *logins_ptr = NULL;
}

static struct throttle_entry *find(const struct login_throttle *throttle, const uint8_t address[16])
{
    for (size_t i = 0; i < throttle->count; i++)
        if (!memcmp(throttle->entries[i].address, address, sizeof(throttle->entries[i].address)))
            return &throttle->entries[i];
    return NULL;
}

static struct throttle_entry *find_or_make(struct login_throttle *throttle, const uint8_t address[16])
{
    struct throttle_entry *entry = find(throttle, address);
    if (entry)
        return entry;
    if (throttle->count < LOGIN_ADDRESSES) {
        mem_grow(&throttle->entries, &throttle->capacity, throttle->count + 1, sizeof(*throttle->entries));
        entry = &throttle->entries[throttle->count++];
    } else {
        entry = throttle->entries;
        for (size_t i = 1; i < throttle->count; i++)
            if (throttle->entries[i].heard_ns < entry->heard_ns)
                entry = &throttle->entries[i];
        mem_free(entry->known);
    }
    *entry = (struct throttle_entry){ .failures = 0 };
    memcpy(entry->address, address, sizeof(entry->address));
    return entry;
}

static struct known_token *find_known(struct throttle_entry *entry, const uint8_t *hash)
{
    for (size_t i = 0; i < entry->known_count; i++)
        if (!memcmp(entry->known[i].hash, hash, TOKEN_HASH_BYTES))
            return &entry->known[i];
    return NULL;
}

/* Returns a place for a new token; if there are MAX_KNOWN_TOKENS, that of the token which was not used for the longest time. */
static struct known_token *known_place(struct throttle_entry *entry)
{
    if (entry->known_count < MAX_KNOWN_TOKENS) {
        mem_grow(&entry->known, &entry->known_capacity, entry->known_count + 1, sizeof(*entry->known));
        return &entry->known[entry->known_count++];
    }
    struct known_token *oldest = entry->known;
    for (size_t i = 1; i < entry->known_count; i++)
        if (entry->known[i].used_ns < oldest->used_ns)
            oldest = &entry->known[i];
    return oldest;
}

static enum login let_in(struct throttle_entry *entry, const uint8_t *hash, int64_t now_ns)
{
    struct known_token *known = find_known(entry, hash);
    if (known)
        known->used_ns = now_ns;
    if (known && now_ns - known->reported_ns < LOG_INTERVAL_NS)
        return LOGIN_GOOD;
    if (!known) {
        known = known_place(entry);
        memcpy(known->hash, hash, TOKEN_HASH_BYTES);
    }
    known->reported_ns = known->used_ns = now_ns;
    return LOGIN_GOOD_NEW;
}

static int failures(const struct throttle_entry *entry, int64_t now_ns)
{
    int count = 0;
    for (int i = 0; i < LOGIN_FAILURES && i < entry->failures; i++)
        count += now_ns - entry->failed_ns[i] < WINDOW_NS;
    return count;
}

static enum login fail(struct throttle_entry *entry, int64_t now_ns)
{
    bool was_slowed = now_ns < entry->slowed_until_ns;
    entry->failed_ns[entry->failures++ % LOGIN_FAILURES] = now_ns;
    if (!was_slowed && failures(entry, now_ns) < LOGIN_FAILURES)
        return LOGIN_WRONG;
    entry->slowed_until_ns = now_ns + WINDOW_NS;
    if (!was_slowed)
        entry->next_try_ns = now_ns + WAIT_NS;
    return was_slowed ? LOGIN_WRONG : LOGIN_WRONG_SLOWS;
}

/* Returns true if the address is throttled and its next token must not be checked yet. */
static bool holds(struct throttle_entry *entry, int64_t now_ns)
{
    bool slowed = now_ns < entry->slowed_until_ns, too_soon = now_ns < entry->next_try_ns;
    if (slowed && !too_soon)
        entry->next_try_ns = now_ns + WAIT_NS;
    return slowed && too_soon;
}

enum login login_throttle_judge(struct login_throttle *throttle, const uint8_t address[16], const uint8_t *hash, int64_t now_ns)
{
    struct throttle_entry *entry = find_or_make(throttle, address);
    entry->heard_ns = now_ns;
    if (!(hash && find_known(entry, hash)) && holds(entry, now_ns))
        return LOGIN_HELD;
    return hash ? let_in(entry, hash, now_ns) : fail(entry, now_ns);
}

enum login login_throttle_begin(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns)
{
    struct throttle_entry *entry = find(throttle, address);
    return entry && holds(entry, now_ns) ? LOGIN_HELD : LOGIN_NONE;
}

enum login login_throttle_fail(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns)
{
    struct throttle_entry *entry = find_or_make(throttle, address);
    entry->heard_ns = now_ns;
    return fail(entry, now_ns);
}

int login_throttle_failures(const struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns)
{
    const struct throttle_entry *entry = find(throttle, address);
    return entry ? failures(entry, now_ns) : 0;
}

int login_throttle_slowed(const struct login_throttle *throttle, int64_t now_ns)
{
    int count = 0;
    for (size_t i = 0; i < throttle->count; i++)
        count += now_ns < throttle->entries[i].slowed_until_ns;
    return count;
}
