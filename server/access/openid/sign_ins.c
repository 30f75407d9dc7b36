/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of log-ins in progress and of signed-in users. */
#include "access/openid/sign_ins.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"

/* maximum time in nanoseconds between the beginning of a log-in and the browser's return from the provider */
static const int64_t LOG_IN_TIMEOUT_NS = 600 * NS_PER_S;

struct sign_ins {
    struct sign_in *begun;
    size_t begun_count, begun_capacity;
    struct person *people; /* signed-in users in the order of their sign-in */
    size_t count, capacity;
    uint64_t next_number;
};

/* --- secrets -------------------------------------------------------------------------------------------------------------- */

static void to_base64url(const uint8_t bytes[32], char out[SIGN_IN_SECRET_CHARS + 1])
{
    char padded[48];
    EVP_EncodeBlock((unsigned char *)padded, bytes, 32);
    for (int i = 0; i < SIGN_IN_SECRET_CHARS; i++)
        out[i] = padded[i] == '+' ? '-' : padded[i] == '/' ? '_' : padded[i];
    out[SIGN_IN_SECRET_CHARS] = 0;
}

/* Writes a secret of 256 random bits in base64url. Returns false if the system's random number generator failed. */
static bool make_secret(char out[SIGN_IN_SECRET_CHARS + 1])
{
    uint8_t bytes[32];
    if (RAND_bytes(bytes, sizeof(bytes)) != 1)
        return false;
    to_base64url(bytes, out);
    OPENSSL_cleanse(bytes, sizeof(bytes));
    return true;
}

void sign_in_challenge(const char *verifier, char out[SIGN_IN_SECRET_CHARS + 1])
{
    uint8_t hash[TOKEN_HASH_BYTES];
    tokens_hash(verifier, hash);
    to_base64url(hash, out);
}

bool sign_in_path_good(const char *path)
{
    for (const char *at = path; *at; at++)
        if ((unsigned char)*at <= ' ' || (unsigned char)*at >= 0x7f || *at == '\\')
            return false;
    return path[0] == '/' && path[1] != '/' && strlen(path) < SIGN_IN_PATH_BYTES;
}

/* --- log-ins in progress ------------------------------------------------------------------------------------------------------ */

struct sign_ins *sign_ins_create(void)
{
    return mem_new(sizeof(struct sign_ins));
}

static void free_person(struct person *person)
{
    char *const texts[] = { person->sub, person->refresh_token, person->access_token, person->id_token };
    for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++) {
        if (texts[i])
            OPENSSL_cleanse(texts[i], strlen(texts[i]));
        mem_free(texts[i]);
    }
}

void sign_ins_destroy(struct sign_ins **pointer)
{
    struct sign_ins *table = *pointer;
    if (!table)
        return;
    for (size_t i = 0; i < table->count; i++)
        free_person(&table->people[i]);
    mem_free(table->people);
    mem_free(table->begun);
    mem_free(table);
    *pointer = NULL;
}

/* Returns the table entry to use for a new log-in from that address: a free or expired one, or a new one. An address with
   SIGN_INS_OF_ADDRESS log-ins in progress loses its oldest log-in instead; a full table loses the oldest log-in of all. */
static struct sign_in *find_place(struct sign_ins *table, const uint8_t address[16], int64_t now_ns)
{
    struct sign_in *oldest = NULL, *own = NULL, *unused = NULL;
    int of_address = 0;
    for (size_t i = 0; i < table->begun_count; i++) {
        struct sign_in *one = &table->begun[i];
        if (one->began_ns == 0 || now_ns - one->began_ns > LOG_IN_TIMEOUT_NS) {
            unused = one;
            continue;
        }
        if (!oldest || one->began_ns < oldest->began_ns)
            oldest = one;
        if (memcmp(one->address, address, sizeof(one->address)) != 0)
            continue;
        of_address++;
        if (!own || one->began_ns < own->began_ns)
            own = one;
    }
    if (of_address >= SIGN_INS_OF_ADDRESS)
        return own;
    if (unused || table->begun_count >= SIGN_INS)
        return unused ? unused : oldest;
    mem_grow(&table->begun, &table->begun_capacity, table->begun_count + 1, sizeof(*table->begun));
    return &table->begun[table->begun_count++];
}

const struct sign_in *sign_ins_begin(struct sign_ins *table, const uint8_t address[16], const char *path, int64_t now_ns)
{
    struct sign_in *one = find_place(table, address, now_ns);
    *one = (struct sign_in){ .began_ns = 0 };
    if (!make_secret(one->state) || !make_secret(one->nonce) || !make_secret(one->verifier) || !make_secret(one->binding))
        return NULL;
    memcpy(one->address, address, sizeof(one->address));
    strcpy(one->path, sign_in_path_good(path) ? path : "/");
    one->began_ns = now_ns;
    return one;
}

static bool is_same(const char *a, const char *b)
{
    return strlen(a) == SIGN_IN_SECRET_CHARS && strlen(b) == SIGN_IN_SECRET_CHARS && CRYPTO_memcmp(a, b, SIGN_IN_SECRET_CHARS) == 0;
}

bool sign_ins_take(struct sign_ins *table, const char *state, const char *binding, int64_t now_ns, struct sign_in *out)
{
    for (size_t i = 0; i < table->begun_count; i++) {
        struct sign_in *one = &table->begun[i];
        if (one->began_ns == 0 || !is_same(one->state, state) || !is_same(one->binding, binding))
            continue;
        *out = *one;
        *one = (struct sign_in){ .began_ns = 0 };
        return now_ns - out->began_ns <= LOG_IN_TIMEOUT_NS;
    }
    return false;
}

/* --- people --------------------------------------------------------------------------------------------------------------- */

void sign_ins_remove(struct sign_ins *table, struct person *person)
{
    size_t i = (size_t)(person - table->people);
    free_person(person);
    table->count--;
    memmove(person, person + 1, (table->count - i) * sizeof(*person));
}

/* Makes room for one more session: removes the user's oldest session if the user has too many, or the oldest of all if there
   are too many in total. *left receives the removed session's refresh token, which must be revoked. */
static void make_room(struct sign_ins *table, const char *sub, char **left)
{
    struct person *same = NULL;
    int count = 0;
    for (size_t i = table->count; i-- > 0;)
        if (!strcmp(table->people[i].sub, sub)) {
            same = &table->people[i];
            count++;
        }
    struct person *goes = count >= PEOPLE_SAME ? same : table->count >= PEOPLE ? table->people : NULL;
    if (!goes)
        return;
    *left = goes->refresh_token;
    goes->refresh_token = NULL;
    sign_ins_remove(table, goes);
}

bool sign_ins_add_person(struct sign_ins *table, struct person *person, char cookie[SIGN_IN_SECRET_CHARS + 1], char **left)
{
    *left = NULL;
    if (!make_secret(cookie)) {
        *left = person->refresh_token;
        person->refresh_token = NULL;
        free_person(person);
        return false;
    }
    make_room(table, person->sub, left);
    tokens_hash(cookie, person->holder.hash);
    person->number = ++table->next_number;
    mem_grow(&table->people, &table->capacity, table->count + 1, sizeof(*table->people));
    table->people[table->count++] = *person;
    return true;
}

struct person *sign_ins_find_hash(struct sign_ins *table, const uint8_t hash[TOKEN_HASH_BYTES])
{
    struct person *found = NULL;
    for (size_t i = 0; i < table->count; i++)
        if (CRYPTO_memcmp(table->people[i].holder.hash, hash, TOKEN_HASH_BYTES) == 0)
            found = &table->people[i];
    return found;
}

struct person *sign_ins_find(struct sign_ins *table, const char *cookie)
{
    uint8_t hash[TOKEN_HASH_BYTES];
    if (strlen(cookie) != SIGN_IN_SECRET_CHARS)
        return NULL;
    tokens_hash(cookie, hash);
    return sign_ins_find_hash(table, hash);
}

struct person *sign_ins_numbered(struct sign_ins *table, uint64_t number)
{
    for (size_t i = 0; i < table->count; i++)
        if (table->people[i].number == number)
            return &table->people[i];
    return NULL;
}

struct person *sign_ins_next_check(struct sign_ins *table)
{
    struct person *next = NULL;
    for (size_t i = 0; i < table->count; i++)
        if (!table->people[i].checking && (!next || table->people[i].check_ns < next->check_ns))
            next = &table->people[i];
    return next;
}

size_t sign_ins_count(const struct sign_ins *table)
{
    return table->count;
}
