/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Those that wait are in memory only: a device whose digits are forgotten is given others. */
#include "access/pairings.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/json_text.h"
#include "base/mem.h"
#include "views/kept_list.h"

enum { HASH_CHARS = 2 * TOKEN_HASH_BYTES, SECRET_CHARS = 3 + 64 };
static const int64_t WRONG_NS = 60 * NS_PER_S;

struct waiting {
    uint8_t hash[TOKEN_HASH_BYTES], address[16];
    char digits[PAIRING_DIGITS + 1], from[64];
    struct wall_place place;
    int64_t begun_ns, asked_ns;
};

struct pairings {
    struct kept_list kept; /* { id, hash, wall, display, from, by, time_us } */
    struct waiting waiting[PAIRINGS];
    size_t count;
    int64_t wrong_ns; /* when the first of the wrong digits of this minute came */
    int wrong;
};

/* --- the file --------------------------------------------------------------------------------------------------------------- */

static bool good_list(const json_t *list)
{
    static const char *const texts[] = { "id", "hash", "wall", "from", "by" };
    if (!json_is_array(list) || json_array_size(list) > PAIRED_DEVICES)
        return false;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *device = json_array_get(list, i);
        for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++)
            if (!json_is_string(json_object_get(device, texts[k])))
                return false;
        const char *id = json_string_value(json_object_get(device, "id"));
        if (json_string_length(json_object_get(device, "hash")) != HASH_CHARS || !tokens_name_valid(id) ||
            !json_is_integer(json_object_get(device, "display")) || !json_is_integer(json_object_get(device, "time_us")) ||
            kept_list_find(list, id) != i)
            return false;
    }
    return true;
}

static const struct kept_list_kind KIND = { PAIRINGS_FILE, "devices", "id, hash, wall, display, from, by and time_us", good_list };

struct pairings *pairings_open(struct log *log, const char *folder)
{
    struct pairings *pairings = mem_new(sizeof(*pairings));
    kept_list_open(&pairings->kept, log, folder, &KIND);
    return pairings;
}

void pairings_close(struct pairings **pairings_ptr)
{
    struct pairings *pairings = *pairings_ptr;
    if (!pairings)
        return;
    kept_list_close(&pairings->kept);
    mem_free(pairings);
    *pairings_ptr = NULL;
}

bool pairings_secret_valid(const char *secret)
{
    return strlen(secret) == SECRET_CHARS && !strncmp(secret, "pc_", 3) && strspn(secret + 3, "0123456789abcdef") == SECRET_CHARS - 3;
}

const char *pairings_refusal(const struct pairings *pairings)
{
    return kept_list_refusal(&pairings->kept);
}

/* --- devices that are paired ------------------------------------------------------------------------------------------------ */

static void print_hash(const uint8_t hash[TOKEN_HASH_BYTES], char text[HASH_CHARS + 1])
{
    for (int i = 0; i < TOKEN_HASH_BYTES; i++)
        snprintf(text + 2 * i, 3, "%02x", hash[i]);
}

/* Takes as long for every hash. */
static const json_t *find_device(const struct pairings *pairings, const uint8_t hash[TOKEN_HASH_BYTES])
{
    char text[HASH_CHARS + 1];
    const json_t *found = NULL;
    print_hash(hash, text);
    for (size_t i = 0; i < json_array_size(pairings->kept.list); i++) {
        const json_t *device = json_array_get(pairings->kept.list, i);
        if (CRYPTO_memcmp(json_string_value(json_object_get(device, "hash")), text, HASH_CHARS) == 0)
            found = device;
    }
    return found;
}

bool pairings_find(const void *pairings, const uint8_t hash[TOKEN_HASH_BYTES], struct token_holder *out)
{
    const json_t *device = find_device(pairings, hash);
    *out = (struct token_holder){ .role = device ? ROLE_VIEWER : ROLE_NOBODY };
    if (!device)
        return false;
    memcpy(out->hash, hash, TOKEN_HASH_BYTES);
    snprintf(out->name, sizeof(out->name), "%s", json_string_value(json_object_get(device, "id")));
    snprintf(out->wall, sizeof(out->wall), "%s", json_string_value(json_object_get(device, "wall")));
    out->display = (int)json_integer_value(json_object_get(device, "display"));
    out->until_utc_ns = INT64_MAX;
    out->unattended = true;
    return true;
}

const char *pairings_revoke(struct pairings *pairings, const char *id)
{
    const char *why = pairings_refusal(pairings);
    size_t at = kept_list_find(pairings->kept.list, id);
    if (why || at == json_array_size(pairings->kept.list))
        return why ? why : "there is no such device";
    json_t *list = json_copy(pairings->kept.list);
    json_array_remove(list, at);
    return kept_list_put(&pairings->kept, list);
}

char *pairings_text(const struct pairings *pairings)
{
    json_t *list = json_deep_copy(pairings->kept.list);
    for (size_t i = 0; i < json_array_size(list); i++)
        json_object_del(json_array_get(list, i), "hash");
    return json_text(json_pack("{s:o}", "list", list), 0);
}

/* --- those that wait -------------------------------------------------------------------------------------------------------- */

static void forget(struct pairings *pairings, size_t i)
{
    pairings->waiting[i] = pairings->waiting[--pairings->count];
}

static void forget_old(struct pairings *pairings, int64_t now_ns)
{
    for (size_t i = pairings->count; i-- > 0;)
        if (now_ns - pairings->waiting[i].begun_ns >= PAIRING_S * NS_PER_S ||
            now_ns - pairings->waiting[i].asked_ns >= PAIRING_QUIET_S * NS_PER_S)
            forget(pairings, i);
}

static struct waiting *find_digits(struct pairings *pairings, const char *digits)
{
    for (size_t i = 0; i < pairings->count; i++)
        if (!strcmp(pairings->waiting[i].digits, digits))
            return &pairings->waiting[i];
    return NULL;
}

/* Of that secret, for that display. */
static struct waiting *find_waiting(struct pairings *pairings, const uint8_t hash[TOKEN_HASH_BYTES], const struct wall_place *place)
{
    for (size_t i = 0; i < pairings->count; i++) {
        struct waiting *waiting = &pairings->waiting[i];
        if (CRYPTO_memcmp(waiting->hash, hash, TOKEN_HASH_BYTES) == 0 && waiting->place.display == place->display &&
            !strcmp(waiting->place.wall, place->wall))
            return waiting;
    }
    return NULL;
}

/* False: the system has no randomness. */
static bool draw_digits(struct pairings *pairings, char digits[PAIRING_DIGITS + 1])
{
    do {
        uint64_t random;
        if (RAND_bytes((uint8_t *)&random, sizeof(random)) != 1)
            return false;
        snprintf(digits, PAIRING_DIGITS + 1, "%06u", (unsigned)(random % 1000000));
    } while (find_digits(pairings, digits));
    return true;
}

/* NULL: too many wait. */
static struct waiting *begin(struct pairings *pairings, const uint8_t hash[TOKEN_HASH_BYTES], const struct pairing_request *request,
                             int64_t now_ns)
{
    size_t from = 0;
    for (size_t i = 0; i < pairings->count; i++)
        from += memcmp(pairings->waiting[i].address, request->address, sizeof(pairings->waiting[i].address)) == 0;
    if (pairings->count == PAIRINGS || from >= PAIRINGS_FROM)
        return NULL;
    struct waiting waiting = { .place = request->place, .begun_ns = now_ns };
    if (!draw_digits(pairings, waiting.digits))
        return NULL;
    memcpy(waiting.hash, hash, TOKEN_HASH_BYTES);
    memcpy(waiting.address, request->address, sizeof(waiting.address));
    snprintf(waiting.from, sizeof(waiting.from), "%s", request->from);
    log_info(pairings->kept.log, "pairing: %s wants to be display %d of wall %s", waiting.from, waiting.place.display, waiting.place.wall);
    pairings->waiting[pairings->count] = waiting;
    return &pairings->waiting[pairings->count++];
}

enum pairing pairings_ask(struct pairings *pairings, const struct pairing_request *request, int64_t now_ns, char digits[PAIRING_DIGITS + 1],
                          int *left_s)
{
    uint8_t hash[TOKEN_HASH_BYTES];
    struct token_holder paired;
    tokens_hash(request->secret, hash);
    if (pairings_find(pairings, hash, &paired))
        return paired.display == request->place.display && !strcmp(paired.wall, request->place.wall) ? PAIRING_DONE : PAIRING_OTHER;
    forget_old(pairings, now_ns);
    struct waiting *waiting = find_waiting(pairings, hash, &request->place);
    if (!waiting && !(waiting = begin(pairings, hash, request, now_ns)))
        return PAIRING_FULL;
    waiting->asked_ns = now_ns;
    strcpy(digits, waiting->digits);
    *left_s = (int)((waiting->begun_ns + PAIRING_S * NS_PER_S - now_ns) / NS_PER_S);
    return PAIRING_WAITS;
}

static const char *keep(struct pairings *pairings, const struct waiting *waiting, const char *id, const char *who, int64_t now_us)
{
    char hash[HASH_CHARS + 1];
    print_hash(waiting->hash, hash);
    json_t *device = json_pack("{s:s,s:s,s:s,s:i,s:s,s:s,s:I}", "id", id, "hash", hash, "wall", waiting->place.wall, "display",
                               waiting->place.display, "from", waiting->from, "by", who, "time_us", (json_int_t)now_us);
    if (!device)
        return "it is no UTF-8";
    json_t *list = json_copy(pairings->kept.list);
    json_array_append_new(list, device);
    return kept_list_put(&pairings->kept, list);
}

/* Whoever guesses has ten tries a minute for a million digits. */
static bool may_try(struct pairings *pairings, int64_t now_ns)
{
    if (now_ns - pairings->wrong_ns >= WRONG_NS)
        pairings->wrong = 0;
    return pairings->wrong < PAIRING_WRONG;
}

const char *pairings_approve(struct pairings *pairings, const char *digits, const char *who, int64_t now_ns, int64_t now_us,
                             char id[TOKEN_NAME_BYTES])
{
    const char *why = pairings_refusal(pairings);
    if (why)
        return why;
    if (!may_try(pairings, now_ns))
        return "too many wrong digits; try again in a minute";
    forget_old(pairings, now_ns);
    struct waiting *waiting = find_digits(pairings, digits);
    if (!waiting) {
        if (pairings->wrong++ == 0)
            pairings->wrong_ns = now_ns;
        return "no display shows these digits";
    }
    if (json_array_size(pairings->kept.list) == PAIRED_DEVICES)
        return "there are as many devices as there may be";
    int n = 0;
    do
        snprintf(id, TOKEN_NAME_BYTES, "%s.%d.%d", waiting->place.wall, waiting->place.display, ++n);
    while (kept_list_find(pairings->kept.list, id) < json_array_size(pairings->kept.list));
    why = keep(pairings, waiting, id, who, now_us);
    if (!why)
        forget(pairings, (size_t)(waiting - pairings->waiting));
    return why;
}
