/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The token file: which tokens are accepted and which are revoked, and which files are refused so that nobody is admitted. */
#include "access/tokens.h"

#include "tests/support/test.h"
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"

static const int64_t NOW_NS = 1767225600LL * 1000000000; /* 2026-01-01 */

struct tokens_fixture {
    struct log *log;
    char *folder, *path;
};

static void begin(struct tokens_fixture *f)
{
    f->log = test_log();
    f->folder = temp_folder();
    f->path = temp_path(f->folder, "tokens");
}

TEST_FIXTURE(struct tokens_fixture, begin, NULL)

#define CASE(name) TEST_ON(struct tokens_fixture *f, name, set_up, tear_down)

static void add_line(struct text *text, enum role role, const char *name, const char *token, int64_t until_ns)
{
    struct token_holder holder = { .role = role, .until_utc_ns = until_ns };
    snprintf(holder.name, sizeof(holder.name), "%s", name);
    tokens_hash(token, holder.hash);
    tokens_print_line(text, &holder);
}

static void write_file(struct tokens_fixture *f, const char *text, mode_t mode)
{
    assert_int_equal(atomic_file_put(f->path, text, strlen(text)), 0);
    assert_int_equal(chmod(f->path, mode), 0);
}

static void write_two(struct tokens_fixture *f, mode_t mode)
{
    struct text *text = test_text();
    text_add(text, "# who may look\n\n");
    add_line(text, ROLE_VIEWER, "wall-1", "pc_wall", INT64_MAX);
    add_line(text, ROLE_ENGINEER, "eve@plant.example", "pc_eve", NOW_NS + NS_PER_S);
    write_file(f, text->at, mode);
}

CASE(a_token_may_be_for_one_plant)
{
    struct token_holder holder = { .role = ROLE_VIEWER, .name = "plant", .until_utc_ns = INT64_MAX, .plant = "Werk Nord 2" }, read;
    holder.unattended = true;
    struct text *text = test_text();
    const char *why;
    tokens_hash("pc_nord", holder.hash);
    tokens_print_line(text, &holder);
    assert_int_equal(tokens_parse_line(text->at, &read, &why), 1);
    assert_string_equal(read.plant, "Werk Nord 2");
    assert_true(read.unattended);
    assert_string_equal(read.name, "plant");
    add_line(text, ROLE_VIEWER, "any", "pc_any", INT64_MAX);
    write_file(f, text->at, 0600);
    struct tokens *tokens = tokens_create(f->log, f->path);
    tokens_set_plant(tokens, "Werk Nord 2");
    assert_true(tokens_find(tokens, "pc_nord", NOW_NS, &read));
    tokens_set_plant(tokens, "Werk Nord");
    assert_false(tokens_find(tokens, "pc_nord", NOW_NS, &read));
    assert_int_equal(tokens_role(tokens, &holder, NOW_NS), ROLE_NOBODY);
    assert_true(tokens_find(tokens, "pc_any", NOW_NS, &read));
    text->at[text->length - 1] = 0;
    char *bad = test_printf("%s plant ", text->at);
    assert_int_equal(tokens_parse_line(strstr(bad, "viewer any"), &read, &why), -1);
    tokens_destroy(&tokens);
}

CASE(a_token_may_be_for_one_display)
{
    struct token_holder holder = { .role = ROLE_VIEWER, .name = "tile", .until_utc_ns = INT64_MAX, .wall = "room", .display = 12 }, read;
    struct text *text = test_text();
    const char *why;
    tokens_hash("pc_tile", holder.hash);
    holder.unattended = true;
    tokens_print_line(text, &holder);
    assert_non_null(strstr(text->at, " unattended display room:12\n"));
    write_file(f, text->at, 0600);
    struct tokens *tokens = tokens_create(f->log, f->path);
    assert_true(tokens_find(tokens, "pc_tile", NOW_NS, &read));
    assert_string_equal(read.wall, "room");
    assert_int_equal(read.display, 12);
    assert_true(read.unattended);
    assert_int_equal(tokens_role(tokens, &read, NOW_NS), ROLE_VIEWER);
    read.display = 1; /* pretends that the file gave this token another display number meanwhile */
    assert_int_equal(tokens_role(tokens, &read, NOW_NS), ROLE_NOBODY);
    tokens_destroy(&tokens);
    static const char *const bad[] = { "room", "room:", "room:0", "room:17", "room:1x", "room:-1", "room:111111111111", ":1", "a b:1", "" };
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        assert_false(tokens_parse_display(bad[i], &read));
        char *line = test_printf("viewer x %064d display %s", 0, bad[i]);
        assert_int_equal(tokens_parse_line(line, &read, &why), -1);
    }
    char *line = test_printf("operator x %064d display room:1", 0);
    assert_int_equal(tokens_parse_line(line, &read, &why), -1);
    assert_non_null(strstr(why, "are allowed only for the role viewer"));
}

CASE(holders_are_found_by_their_tokens)
{
    struct token_holder holder;
    write_two(f, 0600);
    struct tokens *tokens = tokens_create(f->log, f->path);
    assert_non_null(tokens);
    assert_true(tokens_find(tokens, "pc_wall", NOW_NS, &holder));
    assert_int_equal(holder.role, ROLE_VIEWER);
    assert_string_equal(holder.name, "wall-1");
    assert_false(tokens_find(tokens, "pc_Wall", NOW_NS, &holder));
    assert_false(tokens_find(tokens, "", NOW_NS, &holder));
    tokens_destroy(&tokens);
}

CASE(time_runs_out)
{
    struct token_holder holder;
    int64_t until_ns;
    assert_true(tokens_parse_day("2026-01-01", &until_ns));
    assert_int_equal(until_ns, NOW_NS + 24 * 3600 * NS_PER_S);
    assert_false(tokens_parse_day("9999999-01-01", &until_ns) || tokens_parse_day("30-12-31", &until_ns));
    assert_false(tokens_parse_day("2026-02-30", &until_ns) || tokens_parse_day("tomorrow", &until_ns));
    assert_false(tokens_parse_day("2026-01-01x", &until_ns));
    struct text *text = test_text();
    add_line(text, ROLE_OPERATOR, "guest", "pc_guest", NOW_NS + 24 * 3600 * NS_PER_S);
    assert_non_null(strstr(text->at, " until 2026-01-01\n"));
    write_file(f, text->at, 0640);
    struct tokens *tokens = tokens_create(f->log, f->path);
    assert_true(tokens_find(tokens, "pc_guest", NOW_NS, &holder));
    assert_int_equal(tokens_role(tokens, &holder, NOW_NS), ROLE_OPERATOR);
    assert_int_equal(tokens_role(tokens, &holder, NOW_NS + 24 * 3600 * NS_PER_S), ROLE_NOBODY);
    assert_false(tokens_find(tokens, "pc_guest", NOW_NS + 24 * 3600 * NS_PER_S, &holder));
    tokens_destroy(&tokens);
}

CASE(files_that_others_may_touch_let_in_nobody)
{
    static const mode_t bad[] = { 0644, 0660, 0602, 0604 };
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        write_two(f, bad[i]);
        assert_null(tokens_create(f->log, f->path));
    }
    unlink(f->path);
    assert_null(tokens_create(f->log, f->path));
    assert_null(tokens_create(f->log, f->folder));
}

CASE(wrong_lines_let_in_nobody_and_leave_the_others)
{
    static const char *const bad[] = { "king bob",
                                       "viewer bob",
                                       "viewer bob 1234",
                                       "open bob 0000000000000000000000000000000000000000000000000000000000000000",
                                       "viewer b/b 0000000000000000000000000000000000000000000000000000000000000000",
                                       "viewer bob 000000000000000000000000000000000000000000000000000000000000000g",
                                       "viewer bob 0000000000000000000000000000000000000000000000000000000000000000 until",
                                       "viewer bob 0000000000000000000000000000000000000000000000000000000000000000 until never",
                                       "viewer bob 0000000000000000000000000000000000000000000000000000000000000000 until 2026-01-01 x" };
    struct text *text = test_text();
    struct token_holder holder;
    const char *why;
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        assert_int_equal(tokens_parse_line(bad[i], &holder, &why), -1);
        text_add(text, "%s\n", bad[i]);
    }
    assert_int_equal(tokens_parse_line("  # nothing", &holder, &why), 0);
    add_line(text, ROLE_OPERATOR, "good", "pc_good", INT64_MAX);
    write_file(f, text->at, 0600);
    struct tokens *tokens = tokens_create(f->log, f->path);
    assert_true(tokens_find(tokens, "pc_good", NOW_NS, &holder));
    assert_false(tokens_has_name(tokens, "bob") || tokens_has_name(tokens, "b/b"));
    tokens_destroy(&tokens);
}

/* Calls tokens_look() twice, because a changed file is read only after it has been unchanged between two calls. Returns whether
   the second call, and not the first, read the file. */
static bool look_until_read(struct tokens *tokens)
{
    bool first = tokens_look(tokens);
    return tokens_look(tokens) && !first;
}

CASE(a_changed_file_is_read_and_revokes)
{
    struct token_holder wall, eve;
    struct text *text = test_text();
    write_two(f, 0600);
    struct tokens *tokens = tokens_create(f->log, f->path);
    assert_true(tokens_find(tokens, "pc_wall", NOW_NS, &wall) && tokens_find(tokens, "pc_eve", NOW_NS, &eve));
    assert_false(tokens_look(tokens) || tokens_look(tokens));
    add_line(text, ROLE_OPERATOR, "eve", "pc_eve", INT64_MAX);
    write_file(f, text->at, 0600);
    assert_true(look_until_read(tokens));
    assert_int_equal(tokens_role(tokens, &wall, NOW_NS), ROLE_NOBODY);
    assert_int_equal(tokens_role(tokens, &eve, NOW_NS), ROLE_OPERATOR);
    chmod(f->path, 0666);
    assert_true(look_until_read(tokens));
    assert_int_equal(tokens_role(tokens, &eve, NOW_NS), ROLE_NOBODY);
    chmod(f->path, 0600);
    assert_true(look_until_read(tokens));
    assert_int_equal(tokens_role(tokens, &eve, NOW_NS), ROLE_OPERATOR);
    unlink(f->path);
    assert_true(look_until_read(tokens));
    assert_int_equal(tokens_role(tokens, &eve, NOW_NS), ROLE_NOBODY);
    tokens_destroy(&tokens);
}

CASE(a_token_may_be_for_some_views)
{
    struct token_holder holder = { .role = ROLE_VIEWER, .name = "lobby" }, read;
    struct text text = { 0 };
    const char *why;
    strcpy(holder.views, "unit,col.1");
    strcpy(holder.plant, "Werk Nord 2");
    holder.unattended = true;
    tokens_hash("pc_lobby", holder.hash);
    assert_true(tokens_parse_day("2199-12-31", &holder.until_utc_ns));
    tokens_print_line(&text, &holder);
    assert_int_equal(tokens_parse_line(text.at, &read, &why), 1);
    assert_string_equal(read.views, "unit,col.1");
    assert_string_equal(read.plant, "Werk Nord 2");
    assert_true(read.unattended && read.until_utc_ns == holder.until_utc_ns);
    assert_true(tokens_may_see(&read, "unit") && tokens_may_see(&read, "col.1"));
    static const char *const others[] = { "", "uni", "unit,", "unit,col.1", "col", "col.1 ", "Unit", "machines" };
    for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
        assert_false(tokens_may_see(&read, others[i]));
    assert_true(tokens_may_see(&(struct token_holder){ .role = ROLE_VIEWER }, "machines"));
    text_finish(&text);
    strcpy(holder.views, "a/b");
    tokens_print_line(&text, &holder);
    assert_int_equal(tokens_parse_line(text.at, &read, &why), -1);
    text_finish(&text);
    strcpy(holder.views, "unit");
    holder.role = ROLE_OPERATOR;
    tokens_print_line(&text, &holder);
    assert_int_equal(tokens_parse_line(text.at, &read, &why), -1);
    assert_string_equal(why, "`views` and `display` are allowed only for the role viewer");
    text_finish(&text);
    assert_false(tokens_views_valid("") || tokens_views_valid("a,,b") || tokens_views_valid("a b") || tokens_views_valid("a,"));
}

CASE(made_tokens_differ_and_hash_as_others_do)
{
    char a[TOKEN_MAX_CHARS + 1], b[TOKEN_MAX_CHARS + 1];
    static const uint8_t abc[] = { 0xba, 0x78, 0x16, 0xbf, 0x8f, 0x01, 0xcf, 0xea }; /* FIPS 180-2, appendix B.1 */
    uint8_t hash[TOKEN_HASH_BYTES];
    assert_true(tokens_make(a) && tokens_make(b));
    assert_int_equal(strlen(a), 3 + 64);
    assert_string_not_equal(a, b);
    tokens_hash("abc", hash);
    assert_memory_equal(hash, abc, sizeof(abc));
}
