/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests sign-in with OpenID Connect: which ID tokens are accepted and which are refused, how pending logins are matched to
   answers, and which contents of the --openid file are errors. */
#include "tests/support/test.h"
#include <unistd.h>
#include <cjose/cjose.h>

#include "access/openid/id_token.h"
#include "access/openid/openid_config.h"
#include "access/openid/sign_ins.h"
#include "base/clock.h"

#define NOW_S INT64_C(1795000000)
static const char CLAIMS[] = "{\"iss\":\"https://id.example\",\"aud\":\"plant\",\"sub\":\"s1\",\"exp\":1795000300,\"iat\":1794999990,"
                             "\"nonce\":\"n1\",\"preferred_username\":\"kim\",\"groups\":[\"x\",\"ops\"]}";

struct openid_fixture {
    cjose_jwk_t *key, *other;
    json_t *jwks;
    struct openid_config config;
    struct openid_group groups[2];
};

static json_t *public_part(const cjose_jwk_t *key)
{
    char *text = cjose_jwk_to_json(key, false, NULL);
    json_t *json = json_loads(text, 0, NULL);
    free(text);
    return json;
}

static cjose_jwk_t *make_key(const char *kid)
{
    cjose_jwk_t *key = cjose_jwk_create_RSA_random(2048, (const uint8_t *)"\x01\x00\x01", 3, NULL);
    assert_non_null(key);
    cjose_jwk_set_kid(key, kid, strlen(kid), NULL);
    return key;
}

static void begin(struct openid_fixture *f)
{
    f->key = make_key("k1");
    f->other = make_key("k2");
    f->jwks = json_pack("{s:[o]}", "keys", public_part(f->key));
    f->groups[0] = (struct openid_group){ (char *)(uintptr_t) "ops", ROLE_OPERATOR };
    f->groups[1] = (struct openid_group){ (char *)(uintptr_t) "look", ROLE_VIEWER };
    f->config = (struct openid_config){ .issuer = (char *)(uintptr_t) "https://id.example",
                                        .client_id = (char *)(uintptr_t) "plant",
                                        .name_claim = (char *)(uintptr_t) "preferred_username",
                                        .groups_claim = (char *)(uintptr_t) "groups",
                                        .groups = f->groups,
                                        .group_count = 2 };
}

static void end(struct openid_fixture *f)
{
    cjose_jwk_release(f->key);
    cjose_jwk_release(f->other);
    json_decref(f->jwks);
}

TEST_FIXTURE(struct openid_fixture, begin, end)

#define CASE(name) TEST_ON(struct openid_fixture *f, name, set_up, tear_down)

static char *sign(const cjose_jwk_t *key, const char *alg, const char *kid, const char *claims)
{
    cjose_header_t *header = cjose_header_new(NULL);
    const char *text;
    cjose_header_set(header, CJOSE_HDR_ALG, alg, NULL);
    if (kid)
        cjose_header_set(header, CJOSE_HDR_KID, kid, NULL);
    cjose_jws_t *jws = cjose_jws_sign(key, header, (const uint8_t *)claims, strlen(claims), NULL);
    assert_non_null(jws);
    assert_true(cjose_jws_export(jws, &text, NULL));
    char *copy = mem_strdup(text);
    cjose_jws_release(jws);
    cjose_header_release(header);
    return copy;
}

/* Verifies the ID token, which it then frees, and asserts the result. why: part of the reason for which it must be refused;
   NULL: it must be accepted. Returns the fault. */
static enum id_token_fault expect(struct openid_fixture *f, char *token, const char *nonce, const char *sub, const char *why)
{
    const struct id_token_expected expected = { .config = &f->config, .jwks = f->jwks, .nonce = nonce, .sub = sub, .now_s = NOW_S };
    const char *said = NULL;
    json_t *claims;
    enum id_token_fault fault = id_token_verify(token, &expected, &claims, &said);
    if (why && (!said || !strstr(said, why)))
        fprintf(stderr, "'%s' is not in '%s'\n", why, said ? said : "(accepted)");
    if (!why && said)
        fprintf(stderr, "refused: %s\n", said);
    assert_int_equal(fault == ID_TOKEN_GOOD, why == NULL);
    assert_int_equal(claims != NULL, why == NULL);
    assert_true(!why || strstr(said, why));
    json_decref(claims);
    mem_free(token);
    return fault;
}

/* Returns a signed ID token whose claim `name` has another value. value: JSON; NULL: the token lacks the claim. */
static char *changed(const struct openid_fixture *f, const char *name, const char *value)
{
    json_t *claims = json_loads(CLAIMS, 0, NULL);
    json_object_del(claims, name);
    if (value)
        json_object_set_new(claims, name, json_loads(value, JSON_DECODE_ANY, NULL));
    char *text = json_dumps(claims, JSON_COMPACT), *token = sign(f->key, "RS256", "k1", text);
    free(text);
    json_decref(claims);
    return token;
}

CASE(test_signatures)
{
    expect(f, sign(f->key, "RS256", "k1", CLAIMS), "n1", NULL, NULL);
    expect(f, sign(f->key, "PS256", "k1", CLAIMS), "n1", "s1", NULL);
    expect(f, sign(f->key, "RS256", NULL, CLAIMS), "n1", NULL, NULL);
    /* a token signed with an unknown key is reported as ID_TOKEN_NO_KEY, so that the caller requests the keys again; a wrong
       signature by a known key is not */
    assert_int_equal(expect(f, sign(f->other, "RS256", "k2", CLAIMS), "n1", NULL, "does not publish"), ID_TOKEN_NO_KEY);
    assert_int_equal(expect(f, sign(f->other, "RS256", "k1", CLAIMS), "n1", NULL, "signature of the ID token is invalid"), ID_TOKEN_BAD);
    /* rotated */
    json_array_append_new(json_object_get(f->jwks, "keys"), public_part(f->other));
    expect(f, sign(f->other, "RS256", "k2", CLAIMS), "n1", NULL, NULL);
    expect(f, sign(f->key, "RS256", "k1", CLAIMS), "n1", NULL, NULL);
    json_array_remove(json_object_get(f->jwks, "keys"), 0);
    expect(f, sign(f->key, "RS256", "k1", CLAIMS), "n1", NULL, "does not publish");
    /* changes one character of the token */
    char *token = sign(f->other, "RS256", "k2", CLAIMS), *middle = strchr(token, '.') + 10;
    *middle = *middle == 'A' ? 'B' : 'A';
    expect(f, token, "n1", NULL, "");
    /* two keys that must not be used for the signature: one with an elliptic curve, one that is meant for encryption */
    cjose_jwk_t *curve = cjose_jwk_create_EC_random(CJOSE_JWK_EC_P_256, NULL);
    cjose_jwk_set_kid(curve, "e1", 2, NULL);
    json_t *jwk = test_json(public_part(curve));
    json_object_set_new(jwk, "use", json_string("enc"));
    json_array_append(json_object_get(f->jwks, "keys"), jwk);
    expect(f, sign(curve, "ES256", "e1", CLAIMS), "n1", NULL, "does not publish");
    json_object_set_new(jwk, "use", json_string("sig"));
    expect(f, sign(curve, "ES256", "e1", CLAIMS), "n1", NULL, NULL);
    cjose_jwk_release(curve);
}

/* Two known forgeries are refused: a token with {"alg":"none"} and no signature, and one signed by HMAC with the public key as
   the secret. */
CASE(test_algorithms)
{
    static const char none[] = "eyJhbGciOiJub25lIn0.";
    char *good = test_memory(sign(f->key, "RS256", "k1", CLAIMS)), *claims = strchr(good, '.') + 1;
    expect(f, mem_printf("%s%.*s.", none, (int)strcspn(claims, "."), claims), "n1", NULL, "not signed");
    expect(f, mem_printf("%s%s", none, claims), "n1", NULL, "not signed");
    char *text = cjose_jwk_to_json(f->key, false, NULL);
    cjose_jwk_t *secret = cjose_jwk_create_oct_spec((const uint8_t *)text, strlen(text), NULL);
    expect(f, sign(secret, "HS256", "k1", CLAIMS), "n1", NULL, "not signed with a public-key algorithm");
    json_array_append_new(json_object_get(f->jwks, "keys"), json_pack("{s:s,s:s,s:s}", "kty", "oct", "kid", "o1", "k", "c2VjcmV0"));
    expect(f, sign(secret, "HS256", "o1", CLAIMS), "n1", NULL, "not signed with a public-key algorithm");
    cjose_jwk_release(secret);
    free(text);
    expect(f, mem_strdup(""), "n1", NULL, "not signed");
    expect(f, mem_strdup("a.b.c"), "n1", NULL, "not signed");
    char *longest = mem_array(ID_TOKEN_BYTES + 1, 1);
    memset(longest, 'a', ID_TOKEN_BYTES);
    expect(f, longest, "n1", NULL, "not signed");
}

CASE(test_claims)
{
    static const struct {
        const char *name, *value, *why;
    } cases[] = { { "iss", "\"https://id.example/\"", "another issuer" },
                  { "iss", NULL, "another issuer" },
                  { "aud", "\"other\"", "another client (aud)" },
                  { "aud", "[\"other\"]", "another client (aud)" },
                  { "aud", "[\"plant\"]", NULL },
                  /* a token with two audiences and no azp may belong to another client */
                  { "aud", "[\"plant\",\"other\"]", "another client (aud)" },
                  { "azp", "\"other\"", "another client (aud)" },
                  { "azp", "\"plant\"", NULL },
                  { "sub", "\"\"", "is missing, or is not the user" },
                  { "sub", NULL, "is missing, or is not the user" },
                  { "exp", "1794999941", NULL }, /* a minute's difference of clocks */
                  { "exp", "1794999940", "the ID token has expired" },
                  { "exp", "\"1795000300\"", "the ID token has expired" },
                  { "exp", NULL, "the ID token has expired" },
                  { "iat", "1795000060", NULL },
                  { "iat", "1795000061", "time of issue" },
                  { "iat", "1794900000", "time of issue" },
                  { "nbf", "1795000061", "time of issue" },
                  { "nbf", "1795000060", NULL },
                  { "nonce", "\"n2\"", "nonce" },
                  { "nonce", NULL, "nonce" } };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++)
        expect(f, changed(f, cases[i].name, cases[i].value), "n1", "s1", cases[i].why);
    expect(f, changed(f, "nonce", NULL), NULL, "s1", NULL);
    expect(f, changed(f, "sub", "\"s2\""), NULL, "s1", "is missing, or is not the user");
    expect(f, sign(f->key, "RS256", "k1", "[]"), "n1", NULL, "another issuer");
    expect(f, sign(f->key, "RS256", "k1", "{\"iss\":\"https://id.example\",\"iss\":\"https://id.example\"}"), "n1", NULL, "not JSON");
}

/* A renderer's users may stay logged in longer than a day, and a core must accept their ID tokens that long: up to patience_s
   after the token was issued. */
CASE(test_older_tokens)
{
    struct id_token_expected expected = { .config = &f->config, .jwks = f->jwks, .sub = "s1", .now_s = NOW_S + 2 * 24 * 3600 };
    char *token = test_memory(sign(f->key, "RS256", "k1", CLAIMS));
    for (int hours = 40; hours <= 72; hours += 32) {
        const char *why = NULL;
        json_t *claims;
        expected.patience_s = hours * 3600;
        enum id_token_fault fault = id_token_verify(token, &expected, &claims, &why);
        assert_int_equal(fault, hours == 72 ? ID_TOKEN_GOOD : ID_TOKEN_BAD);
        json_decref(claims);
    }
}

CASE(test_roles_and_names)
{
    char name[TOKEN_NAME_BYTES];
    json_t *claims = test_json(json_loads(CLAIMS, 0, NULL));
    assert_int_equal(id_token_role(&f->config, claims), ROLE_OPERATOR);
    json_object_set_new(claims, "groups", json_pack("[s,s,i]", "look", "OPS", 3));
    assert_int_equal(id_token_role(&f->config, claims), ROLE_VIEWER);
    json_object_set_new(claims, "groups", json_string("ops"));
    assert_int_equal(id_token_role(&f->config, claims), ROLE_OPERATOR);
    json_object_del(claims, "groups");
    assert_int_equal(id_token_role(&f->config, claims), ROLE_NOBODY);
    assert_false(id_token_has_groups(&f->config, claims));
    json_object_set_new(claims, "realm", json_pack("{s:[s]}", "roles", "ops"));
    f->config.groups_claim = (char *)(uintptr_t) "realm.roles";
    assert_int_equal(id_token_role(&f->config, claims), ROLE_OPERATOR);
    assert_true(id_token_name(&f->config, claims, name, sizeof(name)));
    assert_string_equal(name, "kim");
    json_object_set_new(claims, "preferred_username", json_string("\xea\xb9\x80\xeb\xaf\xbc\xec\x88\x98"));
    assert_true(id_token_name(&f->config, claims, name, sizeof(name)));
    assert_string_equal(name, "\xea\xb9\x80\xeb\xaf\xbc\xec\x88\x98");
    json_object_set_new(claims, "preferred_username", json_string("a\nlogin from"));
    assert_true(id_token_name(&f->config, claims, name, sizeof(name)));
    assert_string_equal(name, "s1");
}

TEST(test_log_ins)
{
    struct sign_ins *table = sign_ins_create();
    uint8_t here[16] = { 1 }, there[16] = { 2 };
    char challenge[SIGN_IN_SECRET_CHARS + 1];
    struct sign_in first, taken;
    sign_in_challenge("dBjftJeZ4CVP-mB92K27uhbUJU1p1r_wW1gFWFOEjXk", challenge); /* RFC 7636, appendix B */
    assert_string_equal(challenge, "E9Melhoa2OwvFrEMTJguCHaoeK1t8URWbuGJSstw-cM");
    first = *sign_ins_begin(table, here, "/?lang=de#tag=TE-101", NS_PER_S);
    assert_string_not_equal(first.state, first.binding);
    assert_false(sign_ins_take(table, first.state, first.nonce, NS_PER_S, &taken)); /* another browser lacks the binding */
    assert_false(sign_ins_take(table, "", "", NS_PER_S, &taken));
    assert_true(sign_ins_take(table, first.state, first.binding, NS_PER_S, &taken));
    assert_string_equal(taken.path, "/?lang=de#tag=TE-101");
    assert_string_equal(taken.verifier, first.verifier);
    assert_false(sign_ins_take(table, first.state, first.binding, NS_PER_S, &taken)); /* replayed */
    first = *sign_ins_begin(table, here, "/", NS_PER_S);
    assert_false(sign_ins_take(table, first.state, first.binding, 602 * NS_PER_S, &taken)); /* late */
    /* an address that starts thousands of logins does not evict those of other addresses */
    first = *sign_ins_begin(table, here, "/", NS_PER_S);
    for (int i = 0; i < 3 * SIGN_INS; i++)
        assert_non_null(sign_ins_begin(table, there, "/", 2 * NS_PER_S));
    assert_true(sign_ins_take(table, first.state, first.binding, 3 * NS_PER_S, &taken));
    /* twice as many addresses as the table has entries begin a login: each must succeed, in place of an older one */
    for (int i = 0; i < 2 * SIGN_INS; i++) {
        memcpy(there, &i, sizeof(i));
        assert_non_null(sign_ins_begin(table, there, "/", 2 * NS_PER_S));
    }
    sign_ins_destroy(&table);
}

TEST(test_return_paths)
{
    struct sign_ins *table = sign_ins_create();
    uint8_t here[16] = { 1 };
    for (const char *const *path = (const char *const[]){ "/", "/b/?x=1#y", "/?to=//a", NULL }; *path; path++)
        assert_true(sign_in_path_good(*path));
    static const char *const bad[] = { "",      "x",    "//evil.example", "/\\evil.example", "https://evil.example/", "/a\r\nSet-Cookie: b",
                                       "/\t/e", "/a b", "/\xc3\xa9",      "\\/evil.example" };
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
        assert_false(sign_in_path_good(bad[i]));
        assert_string_equal(sign_ins_begin(table, here, bad[i], 1)->path, "/");
    }
    sign_ins_destroy(&table);
}

static struct person person_of(const char *sub)
{
    return (struct person){
        .holder = { .role = ROLE_VIEWER, .until_utc_ns = INT64_MAX }, .sub = mem_strdup(sub), .refresh_token = mem_printf("of %s", sub)
    };
}

TEST(test_people)
{
    struct sign_ins *table = sign_ins_create();
    char first[SIGN_IN_SECRET_CHARS + 1], cookie[SIGN_IN_SECRET_CHARS + 1], *left;
    struct person kim = person_of("kim");
    assert_true(sign_ins_add_person(table, &kim, first, &left));
    assert_non_null(sign_ins_find(table, first));
    for (int i = 0; i < PEOPLE_SAME; i++) {
        struct person again = person_of("lee");
        assert_true(sign_ins_add_person(table, &again, cookie, &left));
        assert_null(left);
    }
    assert_int_equal(sign_ins_count(table), 1 + PEOPLE_SAME);
    struct person more = person_of("lee");
    /* Lee has as many logins as a person may have: one more ends Lee's oldest one, and Kim's login stays */
    assert_true(sign_ins_add_person(table, &more, cookie, &left));
    assert_string_equal(left, "of lee");
    mem_free(left);
    assert_int_equal(sign_ins_count(table), 1 + PEOPLE_SAME);
    assert_non_null(sign_ins_find(table, first));
    assert_null(sign_ins_find(table, ""));
    cookie[0] ^= 1;
    assert_null(sign_ins_find(table, cookie));
    sign_ins_find(table, first)->check_ns = -1;
    assert_string_equal(sign_ins_next_check(table)->sub, "kim");
    sign_ins_find(table, first)->checking = true;
    assert_string_equal(sign_ins_next_check(table)->sub, "lee");
    sign_ins_remove(table, sign_ins_find(table, first));
    assert_null(sign_ins_find(table, first));
    sign_ins_destroy(&table);
}

static struct openid_config *read_config(const char *text)
{
    char path[] = "/tmp/plantcast-openid-XXXXXX";
    struct log *log = test_log();
    FILE *out = fdopen(mkstemp(path), "w");
    fputs(text, out);
    fclose(out);
    assert_non_null(freopen("/dev/null", "w", stderr));
    struct openid_config *config = openid_config_read(log, path);
    unlink(path);
    return config;
}

TEST(test_file)
{
    static const char good[] = "issuer: https://id.example\nclient_id: plant\nurl: https://p.example:8443\nclient_secret_file: secret\n"
                               "roles: [{ group: ops, role: operator }, { group: ops, role: viewer }]\n";
    struct openid_config *config = read_config(good);
    assert_non_null(config);
    assert_string_equal(config->redirect_uri, "https://p.example:8443/login/callback");
    assert_string_equal(config->client_secret_file, "/tmp/secret");
    assert_int_equal(openid_config_role(config, "ops"), ROLE_OPERATOR);
    assert_int_equal(openid_config_role(config, "Ops"), ROLE_NOBODY);
    assert_int_equal(strncmp(config->cookie, "__Host-plantcast-", 17), 0);
    openid_config_free(&config);
    static const char *const bad[][2] = { { "issuer: https", "issuer: http" },
                                          { "url: https", "url: http" },
                                          { "role: operator", "role: king" },
                                          { "issuer:", "isuer:" },
                                          { "roles: [", "roles: [] #" } };
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
        const char *at = strstr(good, bad[i][0]);
        char *text = test_printf("%.*s%s%s", (int)(at - good), good, bad[i][1], at + strlen(bad[i][0]));
        assert_null(read_config(text));
    }
}
