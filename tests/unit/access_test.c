/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the rules of access control: which role may send which message, on which addresses a daemon may listen, which host
   names and page origins are accepted, and which proxies may state a client's address. */
#include "access/access.h"

#include "tests/support/test.h"

#include "message/message_parse.h"
#include "message/names.h"
#include "tests/support/small_scene.h"

#define HELLO_WITH(params) "{\"type\":\"hello\",\"width\":64,\"height\":64,\"codecs\":[\"png\"],\"params\":{\"seq\":1," params "}}"

/* Asserts that every role from `least` upwards may send this message, and that lower roles may not. */
static void expect_least(const char *text, enum role least)
{
    struct message message;
    struct message_error error;
    if (!message_parse(small_scene()->plant, text, strlen(text), &message, &error))
        fail_msg("%s: %s", text, error.text);
    for (enum role role = ROLE_NOBODY; role <= ROLE_ENGINEER; role++) {
        bool may = role_may_send(role, &message, &error);
        if (may != (role >= least))
            fail_msg("%s as %s: %s", text, name_of(names_role, (int)role), may ? "let" : error.text);
        if (!may)
            assert_string_equal(error.code, role == ROLE_NOBODY ? "token_needed" : "not_allowed");
    }
}

TEST(each_message_asks_for_its_role)
{
    expect_least("{\"type\":\"ping\",\"t\":1}", ROLE_NOBODY);
    static const char *const looking[] = {
        "{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"jpeg\"]}",
        "{\"type\":\"camera\",\"seq\":1,\"eye\":[1,2,3],\"target\":[0,0,0]}",
        "{\"type\":\"resize\",\"width\":640,\"height\":360}",
        "{\"type\":\"ack\",\"seq\":1}",
        "{\"type\":\"visible\",\"visible\":false}",
        "{\"type\":\"fit\",\"seq\":1}",
        "{\"type\":\"pick\",\"seq\":1,\"x\":1,\"y\":1}",
        "{\"type\":\"key_frame\"}",
        "{\"type\":\"codecs\",\"codecs\":[\"jpeg\"]}",
        "{\"type\":\"params\",\"seq\":1}",
        "{\"type\":\"params\",\"seq\":1,\"group\":\"pressure\",\"interpolation\":\"paper\",\"distance\":\"euclidean\",\"range\":[1,2]}",
        "{\"type\":\"params\",\"seq\":1,\"show\":\"difference\",\"baseline\":\"then\"}",
        "{\"type\":\"params\",\"seq\":1,\"split\":{\"interpolation\":\"paper\"}}",
    };
    for (size_t i = 0; i < sizeof(looking) / sizeof(looking[0]); i++)
        expect_least(looking[i], ROLE_OPEN);
}

TEST(what_others_see_takes_an_operator)
{
    expect_least("{\"type\":\"params\",\"seq\":1,\"baseline\":\"now\"}", ROLE_OPERATOR);
    expect_least("{\"type\":\"params\",\"seq\":1,\"baseline\":{\"set\":\"a\"}}", ROLE_OPERATOR);
    expect_least("{\"type\":\"params\",\"seq\":1,\"baseline\":{\"remove\":\"a\"}}", ROLE_OPERATOR);
    expect_least(HELLO_WITH("\"baseline\":\"now\""), ROLE_OPERATOR);
}

TEST(how_the_field_is_computed_takes_an_engineer)
{
    static const char *const fields[] = { "\"fill\":\"neighbours\"",
                                          "\"strength\":2",
                                          "\"decay\":2",
                                          "\"power\":3",
                                          "\"radius_m\":4",
                                          "\"reach_m\":5",
                                          "\"sensors\":{\"TI-1\":{\"strength\":2}}" };
    for (size_t i = 0; i < sizeof(fields) / sizeof(fields[0]); i++) {
        char text[256];
        snprintf(text, sizeof(text), "{\"type\":\"params\",\"seq\":1,%s}", fields[i]);
        expect_least(text, ROLE_ENGINEER);
        snprintf(text, sizeof(text), "{\"type\":\"params\",\"seq\":1,\"split\":{%s}}", fields[i]);
        expect_least(text, ROLE_ENGINEER);
        snprintf(text, sizeof(text), HELLO_WITH("%s"), fields[i]);
        expect_least(text, ROLE_ENGINEER);
    }
}

TEST(where_a_daemon_may_listen)
{
    const char *why = NULL;
    struct access_params params = { 0 };
    assert_true(access_allowed_at(&params, true, &why));
    assert_false(access_allowed_at(&params, false, &why));
    assert_non_null(strstr(why, "--open-viewers"));
    params.tokens_path = "tokens";
    assert_false(access_allowed_at(&params, false, &why));
    params.tls_cert_path = "cert";
    assert_false(access_allowed_at(&params, true, &why)); /* refused: a certificate without a key does not count as TLS */
    params.tls_key_path = "key";
    assert_true(access_allowed_at(&params, false, &why));
    params.tokens_path = NULL;
    assert_false(access_allowed_at(&params, false, &why));
    params.open_viewers = true;
    assert_true(access_allowed_at(&params, false, &why));
    params = (struct access_params){ .behind_proxy = true };
    assert_false(access_allowed_at(&params, true, &why));
    params.tokens_path = "tokens";
    /* refused: behind a proxy, the plant must list the host names under which its pages are served, and host_count is still 0
       */
    assert_false(access_allowed_at(&params, true, &why));
    params.host_count = 1;
    assert_true(access_allowed_at(&params, true, &why));
    /* refused: not on the loopback address, so the proxy's requests, with credentials, would cross the network unencrypted */
    assert_false(access_allowed_at(&params, false, &why));
}

TEST(hosts_are_names_without_ports)
{
    static const struct {
        const char *host, *name;
    } good[] = { { "plant.example", "plant.example" },
                 { "Plant.Example:8443", "plant.example" },
                 { "plant.example.", "plant.example" },
                 { "127.0.0.1:80", "127.0.0.1" },
                 { "[::1]", "::1" },
                 { "[FD00::2]:443", "fd00::2" } };
    static const char *const bad[] = {
        "",         ":80",         "[::1", "[::1]x", "a b", "plant.example:80x", "user@plant.example", "a/b", "a:80:90", "[]:80",
        "\xc3\xa9", "a,b.example", ".",    "a..",    ".a"
    };
    char name[64];
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
        assert_true(access_host_name(good[i].host, name, sizeof(name)));
        assert_string_equal(name, good[i].name);
    }
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        if (access_host_name(bad[i], name, sizeof(name)))
            fail_msg("'%s' is taken for the name '%s'", bad[i], name);
    assert_false(access_host_name("plant.example", name, 13));
    assert_true(access_name_is_local("localhost") && access_name_is_local("127.3.2.1") && access_name_is_local("::1"));
    assert_false(access_name_is_local("127.evil.example") || access_name_is_local("localhost.evil.example") || access_name_is_local("::2"));
}

TEST(pages_of_other_hosts_may_not)
{
    struct access_params params = { .origins = { "https://portal.example" }, .origin_count = 1 };
    /* accepted: a request without an Origin header does not come from a browser */
    assert_true(access_origin(&params, "", "plant.example", true));
    assert_true(access_origin(&params, "http://plant.example:8080", "plant.example:8080", false));
    assert_true(access_origin(&params, "https://plant.example", "plant.example", true));
    assert_true(access_origin(&params, "https://portal.example", "plant.example", true));
    /* refused: the page came over plain http, so anybody on the network could have changed it */
    assert_false(access_origin(&params, "http://plant.example", "plant.example", true));
    assert_false(access_origin(&params, "http://plant.example:81", "plant.example", false));
    assert_false(access_origin(&params, "https://portal.example.evil.example", "plant.example", false));
    assert_false(access_origin(&params, "null", "plant.example", false));
    assert_false(access_origin(&params, "plant.example", "plant.example", false));
}

TEST(frames_of_pages_that_were_named)
{
    struct access_params params = { .origins = { "https://portal.example", "http://wall.example:81" } };
    char *own = test_memory(access_content_policy(&params));
    params.origin_count = 2;
    char *more = test_memory(access_content_policy(&params));
    assert_non_null(strstr(own, "connect-src 'self';"));
    assert_string_equal(strstr(own, "frame-ancestors"), "frame-ancestors 'self'");
    assert_string_equal(strstr(more, "frame-ancestors"), "frame-ancestors 'self' https://portal.example http://wall.example:81");
}

TEST(lists_in_headers)
{
    char out[64] = "before";
    assert_true(access_list_has("chat, plantcast.v1", "plantcast.v1") && access_list_has("plantcast.v1,x", "plantcast.v1"));
    assert_false(access_list_has("plantcast.v10", "plantcast.v1") || access_list_has("xplantcast.v1", "plantcast.v1"));
    assert_false(access_list_has("", "plantcast.v1"));
    assert_true(access_list_rest("plantcast.v1, Authorization-Bearer.pc_1", "Authorization-Bearer.", out, sizeof(out)));
    assert_string_equal(out, "pc_1");
    assert_false(access_list_rest("plantcast.v1, Authorization-Bearer.", "Authorization-Bearer.", out, sizeof(out)));
    assert_false(access_list_rest("Authorization-Bearer.12345", "Authorization-Bearer.", out, 5));
}

TEST(a_forwarded_address_is_the_one_that_a_proxy_appended)
{
    static const struct {
        const char *list, *address;
    } cases[] = { { "10.0.0.1, 203.0.113.7", "203.0.113.7" },
                  { "203.0.113.7:1234", "203.0.113.7" },
                  { "unknown, [2001:db8::1]:99", "2001:db8::1" },
                  { "2001:db8::1", "2001:db8::1" },
                  /* 203.0.113.7 is the client: the two entries after it are trusted proxies */
                  { "198.51.100.1, 203.0.113.7, 10.0.0.10", "203.0.113.7" },
                  { "198.51.100.1, 203.0.113.7, fd00:1::7, 10.0.0.10", "203.0.113.7" },
                  /* "unknown" before the last trusted proxy: the addresses before it may be forged, so that proxy counts as the
                     client */
                  { "198.51.100.1, unknown, 10.0.0.10", "10.0.0.10" },
                  /* all entries are trusted proxies, so the first is the client: a program that runs on a proxy's machine */
                  { "10.0.0.11, 10.0.0.10", "10.0.0.11" },
                  { "10.0.0.10", "10.0.0.10" },
                  /* the trusted proxy has added only the last entry, which is no address, so the client's address is not known
                     (NULL) */
                  { "203.0.113.7, unknown", NULL },
                  { "203.0.113.7, 1.2.3.4.5.6.7.8.9.0.1.2.3.4.5.6.7.8.9.0.1.2.3.4.5.6.7.8.9.0.1.2.3.4.5.6.7.8", NULL },
                  { "", NULL } };
    struct access_params params = { 0 };
    assert_true(access_add_proxy(&params, "10.0.0.8/30") && access_add_proxy(&params, "fd00:1::/32"));
    assert_false(params.behind_proxy);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        char out[64] = "before";
        bool found = access_forwarded(&params, cases[i].list, out, sizeof(out));
        if (found != (cases[i].address != NULL) || (found && strcmp(out, cases[i].address) != 0))
            fail_msg("%s: %s", cases[i].list, found ? out : "none");
    }
}

TEST(only_the_named_networks_are_proxies)
{
    static const char *const good[] = { "10.0.0.10", "10.1.0.0/16", "192.0.2.128/25", "2001:db8::5", "fd00::/7", "::ffff:198.51.100.1" };
    static const char *const bad[] = { "",          "10.0.0.0/0", "10.0.0.0/33", "10.0.0.0/-1", "10.0.0.0/", "10.0.0.0/8x", "plant.example",
                                       "10.0.0/24", "::/0",       "::1/129",     "10.0.0.1/ 8", "/8",        "10.0.0.1:80" };
    static const char *const proxies[] = { "10.0.0.10",   "::ffff:10.0.0.10", "10.1.255.255", "192.0.2.128",
                                           "192.0.2.255", "2001:db8::5",      "fdff::1",      "198.51.100.1" };
    static const char *const others[] = { "10.0.0.11", "10.2.0.0", "192.0.2.127", "2001:db8::6", "fe00::1", "127.0.0.1", "198.51.100.2",
                                          "::1",       "",         "unknown" };
    struct access_params params = { 0 };
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
        assert_true(access_add_proxy(&params, good[i]));
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        if (access_add_proxy(&params, bad[i]))
            fail_msg("accepted: %s", bad[i]);
    for (size_t i = 0; i < sizeof(proxies) / sizeof(proxies[0]); i++)
        if (!access_is_proxy(&params, proxies[i]))
            fail_msg("no proxy: %s", proxies[i]);
    for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
        if (access_is_proxy(&params, others[i]))
            fail_msg("a proxy: %s", others[i]);
    assert_false(params.behind_proxy);
    /* adds a proxy on this machine: from then on, local requests may come from anybody through the proxy, so they are no longer
       trusted */
    assert_true(access_add_proxy(&params, "127.0.0.1") && params.behind_proxy);
    while (params.proxy_count < ACCESS_MAX_NAMES)
        assert_true(access_add_proxy(&params, "10.0.0.10"));
    assert_false(access_add_proxy(&params, "10.0.0.10"));
}

TEST(tokens_in_queries_are_known_by_name)
{
    assert_true(access_argument_is_token("token=abc") && access_argument_is_token("Access_Token=abc") && access_argument_is_token("token"));
    assert_false(access_argument_is_token("tokens=abc") || access_argument_is_token("width=5") || access_argument_is_token("=token"));
}
