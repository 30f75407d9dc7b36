/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairing of displays by six digits, which the display shows and an operator confirms. Pairings survive a restart and can be
   revoked; the numbers of pending requests and of wrong guesses are limited. */
#include "access/pairings.h"

#include "tests/support/test.h"
#include <sys/stat.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"

static const struct wall_place ROOM = { "room", "", 2 };

struct pairings_fixture {
    struct log *log;
    char *folder;
    struct pairings *pairings;
};

static void begin(struct pairings_fixture *f)
{
    f->log = test_log();
    f->folder = temp_folder();
    f->pairings = pairings_open(f->log, f->folder, NULL);
}

static void end(struct pairings_fixture *f)
{
    pairings_close(&f->pairings);
}

TEST_FIXTURE(struct pairings_fixture, begin, end)

#define CASE(name) TEST_ON(struct pairings_fixture *f, name, set_up, tear_down)

static void print_secret(int i, char secret[TOKEN_MAX_CHARS + 1])
{
    snprintf(secret, TOKEN_MAX_CHARS + 1, "pc_%064x", (unsigned)i);
    assert_true(pairings_secret_valid(secret));
}

/* Requests a pairing for display i. Displays 0 to 7 have one address, 8 to 15 another, and so on (PAIRINGS_FROM displays per
   address). */
static enum pairing ask(struct pairings_fixture *f, int i, int64_t now_ns, char digits[PAIRING_DIGITS + 1])
{
    char secret[TOKEN_MAX_CHARS + 1];
    uint8_t address[16] = { (uint8_t)(i / PAIRINGS_FROM) };
    int left_s;
    print_secret(i, secret);
    return pairings_ask(f->pairings, &(struct pairing_request){ secret, ROOM, address, "10.0.0.5" }, now_ns, digits, &left_s);
}

static bool is_found(const struct pairings_fixture *f, int i)
{
    char secret[TOKEN_MAX_CHARS + 1];
    uint8_t hash[TOKEN_HASH_BYTES];
    struct token_holder holder;
    print_secret(i, secret);
    tokens_hash(secret, hash);
    return pairings_find(f->pairings, hash, &holder);
}

static enum refusal_code approve(struct pairings_fixture *f, const char *digits, int64_t now_ns)
{
    char id[TOKEN_NAME_BYTES];
    return pairings_approve(f->pairings, digits, "eve", now_ns, 7, id);
}

CASE(a_device_is_bound_kept_and_revoked)
{
    char digits[PAIRING_DIGITS + 1], again[PAIRING_DIGITS + 1], secret[TOKEN_MAX_CHARS + 1], path[512];
    struct token_holder holder;
    assert_int_equal(ask(f, 1, NS_PER_S, digits), PAIRING_WAITS);
    assert_int_equal(strspn(digits, "0123456789"), PAIRING_DIGITS);
    assert_int_equal(ask(f, 1, 3 * NS_PER_S, again), PAIRING_WAITS);
    assert_string_equal(digits, again);
    assert_false(is_found(f, 1));
    assert_int_equal(approve(f, digits, 3 * NS_PER_S), REFUSAL_NONE);
    assert_int_equal(ask(f, 1, 4 * NS_PER_S, again), PAIRING_DONE);
    print_secret(1, secret);
    struct pairing_request other = { secret, ROOM, (const uint8_t[16]){ 0 }, "10.0.0.5" };
    int left_s;
    other.place.display++;
    assert_int_equal(pairings_ask(f->pairings, &other, 4 * NS_PER_S, again, &left_s), PAIRING_OTHER);
    other.place = ROOM;
    strcpy(other.place.wall, "hall");
    assert_int_equal(pairings_ask(f->pairings, &other, 4 * NS_PER_S, again, &left_s), PAIRING_OTHER);
    assert_int_not_equal(approve(f, digits, 4 * NS_PER_S), REFUSAL_NONE); /* digits are valid once only */
    pairings_close(&f->pairings);
    f->pairings = pairings_open(f->log, f->folder, NULL);
    snprintf(path, sizeof(path), "%s/tokens", f->folder);
    assert_int_equal(atomic_file_put(path, "", 0), 0);
    assert_int_equal(chmod(path, 0600), 0);
    struct tokens *tokens = tokens_create(f->log, path);
    print_secret(1, secret);
    assert_false(tokens_find(tokens, secret, 0, &holder));
    tokens_set_pairings(tokens, pairings_find, f->pairings);
    assert_true(tokens_find(tokens, secret, 0, &holder));
    assert_int_equal(holder.role, ROLE_VIEWER);
    assert_string_equal(holder.wall, "room");
    assert_int_equal(holder.display, 2);
    assert_true(holder.unattended);
    assert_int_equal(tokens_role(tokens, &holder, 0), ROLE_VIEWER);
    char *text = test_memory(pairings_text(f->pairings));
    assert_non_null(strstr(text, "\"from\":\"10.0.0.5\""));
    assert_null(strstr(text, "hash"));
    assert_int_not_equal(pairings_revoke(f->pairings, "nobody"), REFUSAL_NONE);
    assert_int_equal(pairings_revoke(f->pairings, holder.name), REFUSAL_NONE);
    assert_int_equal(tokens_role(tokens, &holder, 0), ROLE_NOBODY);
    tokens_destroy(&tokens);
}

CASE(digits_expire)
{
    char digits[PAIRING_DIGITS + 1], others[PAIRING_DIGITS + 1];
    ask(f, 1, 0, digits);
    /* refused: the display has not asked for PAIRING_QUIET_S, so its request has expired */
    assert_int_not_equal(approve(f, digits, PAIRING_QUIET_S * NS_PER_S), REFUSAL_NONE);
    int64_t now_ns = 1000 * NS_PER_S, begun_ns = now_ns;
    ask(f, 1, now_ns, digits);
    for (; now_ns < begun_ns + PAIRING_S * NS_PER_S; now_ns += 2 * NS_PER_S)
        assert_int_equal(ask(f, 1, now_ns, others), PAIRING_WAITS);
    assert_string_equal(digits, others);
    ask(f, 1, now_ns, others);
    assert_string_not_equal(digits, others); /* new digits differ from the old ones, except by a chance of one in a million */
    assert_int_not_equal(approve(f, digits, now_ns), REFUSAL_NONE);
    assert_int_equal(approve(f, others, now_ns), REFUSAL_NONE);
}

CASE(few_wait_and_few_guesses_are_judged)
{
    char digits[PAIRING_DIGITS + 1], more[PAIRING_DIGITS + 1];
    for (int i = 0; i < PAIRINGS; i++)
        assert_int_equal(ask(f, i, 0, digits), PAIRING_WAITS);
    /* The requests of eight addresses fill the table. A ninth address must nevertheless get its share of seven places, which
       are taken from the other addresses. */
    for (int i = 0; i < PAIRINGS_FROM - 1; i++)
        assert_int_equal(ask(f, PAIRINGS + i, 0, more), PAIRING_WAITS);
    assert_int_equal(ask(f, PAIRINGS + PAIRINGS_FROM - 1, 0, more), PAIRING_FULL);
    /* the first address has lost one of its places to the ninth; it now has as many as the others, so it gets none back */
    assert_int_equal(ask(f, 0, 0, more), PAIRING_FULL);
    assert_int_equal(ask(f, PAIRINGS, PAIRING_QUIET_S * NS_PER_S, more), PAIRING_WAITS); /* all other requests have expired */
    for (int i = 0; i < PAIRINGS_FROM - 1; i++)
        assert_int_equal(ask(f, PAIRINGS + 1 + i, PAIRING_QUIET_S * NS_PER_S, digits), PAIRING_WAITS);
    assert_string_not_equal(digits, more);
    char secret[TOKEN_MAX_CHARS + 1];
    int left_s;
    print_secret(999, secret);
    const uint8_t address[16] = { PAIRINGS / PAIRINGS_FROM };
    assert_int_equal(pairings_ask(f->pairings, &(struct pairing_request){ secret, ROOM, address, "" }, PAIRING_QUIET_S * NS_PER_S, digits,
                                  &left_s),
                     PAIRING_FULL); /* refused: eight requests of this address are pending */
    for (int i = 0, now_s = PAIRING_QUIET_S; i < PAIRING_WRONG; i++)
        assert_int_not_equal(approve(f, "abcdef", now_s * NS_PER_S), REFUSAL_NONE);
    /* refused although the digits are right: after too many wrong ones, none are accepted for a minute */
    assert_int_not_equal(approve(f, more, (PAIRING_QUIET_S + 1) * NS_PER_S), REFUSAL_NONE);
    assert_int_equal(ask(f, PAIRINGS, (PAIRING_QUIET_S + 30) * NS_PER_S, more), PAIRING_WAITS);
    assert_int_equal(approve(f, more, (PAIRING_QUIET_S + 61) * NS_PER_S), REFUSAL_NONE);
}

static enum pairing look(const struct pairings *pairings, int i, int64_t now_ns, char digits[PAIRING_DIGITS + 1])
{
    char secret[TOKEN_MAX_CHARS + 1];
    int left_s;
    print_secret(i, secret);
    return pairings_look(pairings, &(struct pairing_request){ secret, ROOM, (const uint8_t[16]){ 0 }, "10.0.0.5" }, now_ns, digits,
                         &left_s);
}

static void mirror(const struct pairings_fixture *f, struct pairings *renderer, int64_t now_ns)
{
    json_t *told = pairings_told(f->pairings, now_ns);
    assert_true(pairings_mirror(renderer, told, now_ns));
    json_decref(told);
}

/* A display asks a renderer, which has no pairings of its own and passes the request to its core. The core's clock differs from
   that of the renderer. */
CASE(a_renderer_asks_its_core)
{
    struct pairings *renderer = pairings_open(f->log, NULL, NULL);
    char secret[TOKEN_MAX_CHARS + 1], digits[PAIRING_DIGITS + 1], there[PAIRING_DIGITS + 1];
    print_secret(3, secret);
    assert_int_equal(look(renderer, 3, 0, there), PAIRING_WAITS);
    assert_string_equal(there, "");
    char *text = test_memory(pairings_request_text(&(struct pairing_request){ secret, ROOM, (const uint8_t[16]){ 7 }, "10.0.0.5" }));
    assert_null(strstr(text, secret));
    json_t *request = test_json(json_loads(text, 0, NULL));
    uint64_t before = pairings_number(f->pairings);
    pairings_ask_for(f->pairings, request, NS_PER_S);
    assert_true(pairings_number(f->pairings) > before);
    mirror(f, renderer, NS_PER_S);
    assert_int_equal(look(renderer, 3, NS_PER_S, there), PAIRING_WAITS);
    ask(f, 3, NS_PER_S, digits);
    assert_string_equal(there, digits);
    assert_int_equal(look(renderer, 3, (PAIRING_S + 2) * NS_PER_S, there), PAIRING_WAITS);
    assert_string_equal(there, ""); /* the digits are no longer valid: PAIRING_S is over */
    mirror(f, renderer, (PAIRING_S + 2) * NS_PER_S);
    assert_int_equal(look(renderer, 3, (PAIRING_S + 2) * NS_PER_S, there), PAIRING_WAITS);
    assert_int_equal(approve(f, digits, NS_PER_S), REFUSAL_NONE);
    mirror(f, renderer, NS_PER_S);
    assert_int_equal(look(renderer, 3, NS_PER_S, there), PAIRING_DONE);
    assert_int_equal(pairings_revoke(f->pairings, "room.2.1"), REFUSAL_NONE);
    mirror(f, renderer, NS_PER_S);
    assert_int_equal(look(renderer, 3, NS_PER_S, there), PAIRING_WAITS);
    json_object_set_new(request, "hash", json_string("12"));
    before = pairings_number(f->pairings);
    pairings_ask_for(f->pairings, request, NS_PER_S);
    assert_int_equal(pairings_number(f->pairings), before);
    json_t *wrong = test_json(json_pack("{s:[],s:[{s:s}]}", "devices", "waiting", "digits", "123456"));
    assert_false(pairings_mirror(renderer, wrong, 0) || pairings_mirror(renderer, request, 0));
    pairings_close(&renderer);
}

CASE(what_is_not_kept_lets_nobody_in)
{
    char path[512];
    pairings_close(&f->pairings);
    f->pairings = pairings_open(f->log, NULL, NULL);
    assert_int_not_equal(pairings_refusal(f->pairings), REFUSAL_NONE);
    pairings_close(&f->pairings);
    snprintf(path, sizeof(path), "%s/%s", f->folder, PAIRINGS_FILE);
    const char *bad = "{\"devices\":[{\"id\":\"a b\","
                      "\"hash\":\"00\",\"wall\":\"w\",\"display\":1,\"from\":\"\",\"by\":\"\",\"time_us\":1}]}";
    assert_int_equal(atomic_file_put(path, bad, strlen(bad)), 0);
    f->pairings = pairings_open(f->log, f->folder, NULL);
    assert_int_not_equal(pairings_refusal(f->pairings), REFUSAL_NONE);
    assert_false(pairings_secret_valid("pc_1234"));
    assert_false(pairings_secret_valid(""));
}
