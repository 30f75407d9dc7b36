/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairs devices that show a display of a wall of displays. A device that waits for approval shows six digits. Waiting devices
   are kept in memory only, so they get new digits after a restart. */
#include "access/pairings.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/hex.h"
#include "base/text/json_text.h"
#include "views/kept_list.h"

enum { HASH_CHARS = 2 * TOKEN_HASH_BYTES, SECRET_CHARS = 3 + 64 };
static const int64_t WRONG_NS = 60 * NS_PER_S;

struct pending_pairing {
    uint8_t hash[TOKEN_HASH_BYTES], address[16];
    char digits[PAIRING_DIGITS + 1], from[64];
    struct wall_place place;
    int64_t begun_ns, asked_ns;
};

struct pairings {
    struct kept_list kept; /* content of devices.json, the list of paired devices, each { id, hash, wall, display, from, by, time_us } */
    struct pending_pairing waiting[PAIRINGS];
    size_t count;
    uint64_t number;  /* sequence number of the list of waiting devices; increases with each change of the list */
    int64_t wrong_ns; /* monotonic start of the current minute, in which wrong digits are counted */
    int wrong;
};

/* --- the file --------------------------------------------------------------------------------------------------------------- */

static bool good_device(const json_t *device)
{
    return json_string_length(json_object_get(device, "hash")) == HASH_CHARS &&
           tokens_name_valid(json_string_value(json_object_get(device, "id")));
}

static const struct kept_list_kind KIND = {
    PAIRINGS_FILE, "devices", "the keys id, hash, wall, display, from, by and time_us",
    PAIRED_DEVICES, { "id", "hash", "wall", "from", "by" }, { "display", "time_us" }, good_device
};

struct pairings *pairings_open(struct log *log, const char *folder, struct file_writer *writer)
{
    struct pairings *pairings = mem_new(sizeof(*pairings));
    kept_list_open(&pairings->kept, log, folder, &KIND, writer);
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

const char *pairings_unread_file(const struct pairings *pairings)
{
    return kept_list_unread_file(&pairings->kept);
}

bool pairings_secret_valid(const char *secret)
{
    return strlen(secret) == SECRET_CHARS && !strncmp(secret, "pc_", 3) && strspn(secret + 3, "0123456789abcdef") == SECRET_CHARS - 3;
}

enum refusal_code pairings_refusal(const struct pairings *pairings)
{
    return kept_list_refusal(&pairings->kept);
}

/* --- paired devices ------------------------------------------------------------------------------------------------------------- */

/* Finds a device in a list of paired devices by the hash of its secret. Takes the same time for every hash, so that the timing
   reveals nothing about the stored hashes. */
static const json_t *find_device(const json_t *list, const uint8_t hash[TOKEN_HASH_BYTES])
{
    char text[HASH_CHARS + 1];
    const json_t *found = NULL;
    hex_print(hash, TOKEN_HASH_BYTES, text);
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *device = json_array_get(list, i);
        if (CRYPTO_memcmp(json_string_value(json_object_get(device, "hash")), text, HASH_CHARS) == 0)
            found = device;
    }
    return found;
}

bool pairings_find(const void *of, const uint8_t hash[TOKEN_HASH_BYTES], struct token_holder *out)
{
    const struct pairings *pairings = of;
    const json_t *device = find_device(pairings->kept.list, hash);
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

enum refusal_code pairings_revoke(struct pairings *pairings, const char *id)
{
    enum refusal_code why = pairings_refusal(pairings);
    json_t *newest = kept_list_newest(&pairings->kept);
    size_t at = kept_list_find(newest, id);
    if (why || at == json_array_size(newest))
        return why ? why : REFUSAL_DEVICELESS;
    json_t *list = json_copy(newest);
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

/* --- waiting devices ------------------------------------------------------------------------------------------------------------ */

static void forget(struct pairings *pairings, size_t i)
{
    pairings->waiting[i] = pairings->waiting[--pairings->count];
    pairings->number++;
}

static void forget_old(struct pairings *pairings, int64_t now_ns)
{
    for (size_t i = pairings->count; i-- > 0;)
        if (now_ns - pairings->waiting[i].begun_ns >= PAIRING_S * NS_PER_S ||
            now_ns - pairings->waiting[i].asked_ns >= PAIRING_QUIET_S * NS_PER_S)
            forget(pairings, i);
}

static struct pending_pairing *find_digits(struct pairings *pairings, const char *digits)
{
    for (size_t i = 0; i < pairings->count; i++)
        if (!strcmp(pairings->waiting[i].digits, digits))
            return &pairings->waiting[i];
    return NULL;
}

/* Returns the index of the waiting device that has that hash of its secret and shows that display; pairings->count if there is none. */
static size_t find_waiting(const struct pairings *pairings, const uint8_t hash[TOKEN_HASH_BYTES], const struct wall_place *place)
{
    size_t i = 0;
    for (; i < pairings->count; i++) {
        const struct pending_pairing *waiting = &pairings->waiting[i];
        if (CRYPTO_memcmp(waiting->hash, hash, TOKEN_HASH_BYTES) == 0 && waiting->place.display == place->display &&
            !strcmp(waiting->place.wall, place->wall))
            break;
    }
    return i;
}

/* Draws six random digits that no other waiting device is showing. Returns false if the system's random number generator failed. */
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

static size_t count_from(const struct pairings *pairings, const uint8_t address[16])
{
    size_t from = 0;
    for (size_t i = 0; i < pairings->count; i++)
        from += memcmp(pairings->waiting[i].address, address, sizeof(pairings->waiting[i].address)) == 0;
    return from;
}

/* Frees an entry in the full table of waiting devices, so that a few addresses cannot lock out the others. The address with the
   most waiting devices loses its newest one. This requires that it has at least two more than the address that requests an
   entry, which has `from` waiting devices. Returns false if no address has that many. */
static bool make_room(struct pairings *pairings, size_t from)
{
    size_t most = from + 1, victim = pairings->count;
    for (size_t i = 0; i < pairings->count; i++) {
        size_t count = count_from(pairings, pairings->waiting[i].address);
        bool newer = victim < pairings->count && count == most && pairings->waiting[i].begun_ns > pairings->waiting[victim].begun_ns;
        if (count > most || newer) {
            most = count;
            victim = i;
        }
    }
    if (victim == pairings->count)
        return false;
    log_info(pairings->kept.log,
             "pairing: all %d pairing codes are in use; cancelled the newest pairing request from %s, which had %zu requests waiting",
             PAIRINGS, pairings->waiting[victim].from, most);
    forget(pairings, victim);
    return true;
}

/* Adds a device that waits for approval. Returns NULL if too many are waiting or the system's random number generator failed. */
static struct pending_pairing *begin(struct pairings *pairings, const uint8_t hash[TOKEN_HASH_BYTES], const struct pairing_request *request,
                                     int64_t now_ns)
{
    size_t from = count_from(pairings, request->address);
    if (from >= PAIRINGS_FROM || (pairings->count == PAIRINGS && !make_room(pairings, from)))
        return NULL;
    struct pending_pairing waiting = { .place = request->place, .begun_ns = now_ns };
    if (!draw_digits(pairings, waiting.digits))
        return NULL;
    memcpy(waiting.hash, hash, TOKEN_HASH_BYTES);
    memcpy(waiting.address, request->address, sizeof(waiting.address));
    snprintf(waiting.from, sizeof(waiting.from), "%s", request->from);
    log_info(pairings->kept.log, "pairing: %s asks to become display %d of video wall %s", waiting.from, waiting.place.display,
             waiting.place.wall);
    pairings->waiting[pairings->count] = waiting;
    pairings->number++;
    return &pairings->waiting[pairings->count++];
}

/* Returns PAIRING_DONE for a device paired with the requested display, PAIRING_OTHER for one paired with another display, and
   PAIRING_WAITS for an unpaired device. */
static enum pairing find_paired(const struct pairings *pairings, const uint8_t hash[TOKEN_HASH_BYTES], const struct wall_place *place)
{
    struct token_holder paired;
    if (!pairings_find(pairings, hash, &paired))
        return PAIRING_WAITS;
    return paired.display == place->display && !strcmp(paired.wall, place->wall) ? PAIRING_DONE : PAIRING_OTHER;
}

static void tell_digits(const struct pending_pairing *waiting, int64_t now_ns, char digits[PAIRING_DIGITS + 1], int *left_s)
{
    strcpy(digits, waiting->digits);
    *left_s = (int)((waiting->begun_ns + PAIRING_S * NS_PER_S - now_ns) / NS_PER_S);
}

/* Returns the state of a device that requests its digits or asks whether it is approved; adds the device to the waiting list if
   it is new. Identifies the device by `hash`, because a request forwarded by a renderer does not contain the secret. */
static enum pairing ask(struct pairings *pairings, const uint8_t hash[TOKEN_HASH_BYTES], const struct pairing_request *request,
                        int64_t now_ns, char digits[PAIRING_DIGITS + 1], int *left_s)
{
    enum pairing paired = find_paired(pairings, hash, &request->place);
    if (paired != PAIRING_WAITS)
        return paired;
    digits[0] = 0;
    *left_s = 0;
    /* the device was approved, but the devices.json that lists it is not on disk yet; its digits are no longer valid */
    if (find_device(kept_list_newest(&pairings->kept), hash))
        return PAIRING_WAITS;
    forget_old(pairings, now_ns);
    size_t at = find_waiting(pairings, hash, &request->place);
    struct pending_pairing *waiting = at < pairings->count ? &pairings->waiting[at] : begin(pairings, hash, request, now_ns);
    if (!waiting)
        return PAIRING_FULL;
    waiting->asked_ns = now_ns;
    tell_digits(waiting, now_ns, digits, left_s);
    return PAIRING_WAITS;
}

enum pairing pairings_ask(struct pairings *pairings, const struct pairing_request *request, int64_t now_ns, char digits[PAIRING_DIGITS + 1],
                          int *left_s)
{
    uint8_t hash[TOKEN_HASH_BYTES];
    tokens_hash(request->secret, hash);
    return ask(pairings, hash, request, now_ns, digits, left_s);
}

static enum refusal_code keep(struct pairings *pairings, const struct pending_pairing *waiting, const char *id, const char *who,
                              int64_t now_us)
{
    char hash[HASH_CHARS + 1];
    hex_print(waiting->hash, TOKEN_HASH_BYTES, hash);
    json_t *device = json_pack("{s:s,s:s,s:s,s:i,s:s,s:s,s:I}", "id", id, "hash", hash, "wall", waiting->place.wall, "display",
                               waiting->place.display, "from", waiting->from, "by", who, "time_us", (json_int_t)now_us);
    if (!device)
        return REFUSAL_NOT_UTF8;
    json_t *list = json_copy(kept_list_newest(&pairings->kept));
    json_array_append_new(list, device);
    return kept_list_put(&pairings->kept, list);
}

/* Returns false if engineers have entered wrong digits ten times in this minute. At that rate, guessing one of the million
   possible numbers takes weeks. */
static bool may_try(struct pairings *pairings, int64_t now_ns)
{
    if (now_ns - pairings->wrong_ns >= WRONG_NS)
        pairings->wrong = 0;
    return pairings->wrong < PAIRING_WRONG;
}

enum refusal_code pairings_approve(struct pairings *pairings, const char *digits, const char *who, int64_t now_ns, int64_t now_us,
                                   char id[TOKEN_NAME_BYTES])
{
    enum refusal_code why = pairings_refusal(pairings);
    if (why)
        return why;
    if (!may_try(pairings, now_ns))
        return REFUSAL_GUESSES;
    forget_old(pairings, now_ns);
    struct pending_pairing *waiting = find_digits(pairings, digits);
    if (!waiting) {
        if (pairings->wrong++ == 0)
            pairings->wrong_ns = now_ns;
        return REFUSAL_DIGITS;
    }
    const json_t *newest = kept_list_newest(&pairings->kept);
    if (json_array_size(newest) == PAIRED_DEVICES)
        return REFUSAL_DEVICES;
    int n = 0;
    do
        snprintf(id, TOKEN_NAME_BYTES, "%s.%d.%d", waiting->place.wall, waiting->place.display, ++n);
    while (kept_list_find(newest, id) < json_array_size(newest));
    why = keep(pairings, waiting, id, who, now_us);
    if (!why)
        forget(pairings, (size_t)(waiting - pairings->waiting));
    return why;
}

/* --- the lists of devices as JSON, for renderers and standby cores -------------------------------------------------------------- */

static bool read_bytes(const json_t *text, uint8_t *bytes, size_t count)
{
    const char *at = json_string_value(text);
    return at && strspn(at, "0123456789abcdef") == 2 * count && hex_read(at, bytes, count);
}

static bool read_place(const json_t *o, struct wall_place *place)
{
    const char *wall = json_string_value(json_object_get(o, "wall"));
    json_int_t display = json_integer_value(json_object_get(o, "display"));
    *place = (struct wall_place){ .display = (int)display };
    if (!wall || strlen(wall) >= sizeof(place->wall) || display < 1 || display > WALL_DISPLAYS)
        return false;
    strcpy(place->wall, wall);
    return true;
}

uint64_t pairings_number(const struct pairings *pairings)
{
    return pairings->kept.number + pairings->number;
}

json_t *pairings_told(const struct pairings *pairings, int64_t now_ns)
{
    json_t *waiting = json_array();
    for (size_t i = 0; i < pairings->count; i++) {
        const struct pending_pairing *one = &pairings->waiting[i];
        char hash[HASH_CHARS + 1], digits[PAIRING_DIGITS + 1];
        int left_s;
        hex_print(one->hash, TOKEN_HASH_BYTES, hash);
        tell_digits(one, now_ns, digits, &left_s);
        if (left_s <= 0) /* skips a waiting device whose digits have expired; the next pairing request removes its entry */
            continue;
        json_array_append_new(waiting, json_pack("{s:s,s:s,s:s,s:i,s:i}", "hash", hash, "digits", digits, "wall", one->place.wall,
                                                 "display", one->place.display, "left_s", left_s));
    }
    return json_pack("{s:O,s:o}", "devices", pairings->kept.list, "waiting", waiting);
}

bool pairings_mirror(struct pairings *pairings, const json_t *told, int64_t now_ns)
{
    const json_t *waiting = json_object_get(told, "waiting"), *one;
    size_t i;
    if (!json_is_array(waiting) || json_array_size(waiting) > PAIRINGS ||
        !kept_list_mirror(&pairings->kept, json_object_get(told, "devices")))
        return false;
    pairings->count = 0;
    json_array_foreach(waiting, i, one)
    {
        struct pending_pairing *at = &pairings->waiting[pairings->count];
        const char *digits = json_string_value(json_object_get(one, "digits"));
        int64_t left_s = json_integer_value(json_object_get(one, "left_s"));
        *at = (struct pending_pairing){ .begun_ns = now_ns - (PAIRING_S - left_s) * NS_PER_S, .asked_ns = now_ns };
        if (!digits || strlen(digits) != PAIRING_DIGITS || left_s < 0 || left_s > PAIRING_S || !read_place(one, &at->place) ||
            !read_bytes(json_object_get(one, "hash"), at->hash, sizeof(at->hash)))
            return false;
        strcpy(at->digits, digits);
        pairings->count++;
    }
    return true;
}

enum pairing pairings_look(const struct pairings *pairings, const struct pairing_request *request, int64_t now_ns,
                           char digits[PAIRING_DIGITS + 1], int *left_s)
{
    uint8_t hash[TOKEN_HASH_BYTES];
    tokens_hash(request->secret, hash);
    size_t at = find_waiting(pairings, hash, &request->place);
    const struct pending_pairing *waiting = at < pairings->count ? &pairings->waiting[at] : NULL;
    digits[0] = 0;
    *left_s = 0;
    if (waiting && now_ns - waiting->begun_ns < PAIRING_S * NS_PER_S)
        tell_digits(waiting, now_ns, digits, left_s);
    return find_paired(pairings, hash, &request->place);
}

char *pairings_request_text(const struct pairing_request *request)
{
    uint8_t hash[TOKEN_HASH_BYTES];
    char text[HASH_CHARS + 1], address[2 * 16 + 1];
    tokens_hash(request->secret, hash);
    hex_print(hash, TOKEN_HASH_BYTES, text);
    hex_print(request->address, 16, address);
    return json_text(json_pack("{s:s,s:s,s:s,s:i,s:s,s:s}", "type", "pairing", "hash", text, "wall", request->place.wall, "display",
                               request->place.display, "address", address, "from", request->from),
                     0);
}

void pairings_ask_for(struct pairings *pairings, const json_t *request, int64_t now_ns)
{
    const char *from = json_string_value(json_object_get(request, "from"));
    uint8_t hash[TOKEN_HASH_BYTES], address[16];
    char digits[PAIRING_DIGITS + 1];
    int left_s;
    struct pairing_request asked = { .address = address, .from = from ? from : "" };
    if (!pairings_refusal(pairings) && read_place(request, &asked.place) &&
        read_bytes(json_object_get(request, "hash"), hash, sizeof(hash)) &&
        read_bytes(json_object_get(request, "address"), address, sizeof(address)))
        ask(pairings, hash, &asked, now_ns, digits, &left_s);
}
