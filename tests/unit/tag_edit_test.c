/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writing sensor positions into a tag list: the edited cells change, and every other byte stays. */
#include "tests/support/test.h"

#include "base/files/atomic_file.h"
#include "base/text/text.h"
#include "plant/parse/csv.h"
#include "plant/tags/tag_edit.h"

static void expect(const char *text, const struct tag_edit *edits, size_t count, const char *expected)
{
    struct refusal why;
    char *out = test_memory(tag_edit(text, edits, count, &why));
    assert_non_null(out);
    assert_string_equal(out, expected);
}

TEST(test_one_row)
{
    const struct tag_edit to = { "TT-2", NULL, NULL, NULL, NULL, { 1.25, -3, 0.12345 }, false };
    expect("Tag Name,Group,Asset,X,Y,Z\nTT-1,t,E,1.50,2.000,3\nTT-2,t,E, 4.0 ,5,6\nTT-3,t,E,7,8,9\n", &to, 1,
           "Tag Name,Group,Asset,X,Y,Z\nTT-1,t,E,1.50,2.000,3\nTT-2,t,E,1.25,-3,0.123\nTT-3,t,E,7,8,9\n");
}

/* Editing one position in a tag list keeps everything else in the file: byte order mark, separator, unknown columns and their
   contents, blank rows, quotes, line endings, and a missing newline at the end. */
TEST(test_the_rest_stays_to_the_byte)
{
    const struct tag_edit to = { "T;\"2\"", "E 2", NULL, NULL, NULL, { 10, 20, -0.0001 }, false };
#define HEAD "\xEF\xBB\xBF" "Remark;TAG NAME;x;Y;Z;Asset;Node\r\n\r\n\"# old; see\r\nMaria\";T1;1,0;2;3;E;\r\n"
    expect(HEAD "; \"T;\"\"2\"\"\" ;1;;;E;N-1;more\r\nlast;T3", &to, 1, HEAD "; \"T;\"\"2\"\"\" ;10;20;0;E 2;;more\r\nlast;T3");
}

TEST(test_columns_that_are_not_there)
{
    const struct tag_edit to = { "b", "E,1", "t", NULL, NULL, { 1, 2, 3 }, false };
    expect("Tag Name,Address\na,hr:1\nb\nc,hr:3", &to, 1, "Tag Name,Address,Asset,Group,X,Y,Z\na,hr:1\nb,,\"E,1\",t,1,2,3\nc,hr:3");
}

TEST(test_a_place_is_no_longer_assumed)
{
    const struct tag_edit to = { "a", NULL, NULL, NULL, NULL, { 4, 5, 6 }, false };
    expect("Tag Name,Place,X,Y,Z\na,equipment,1,2,3\nb,equipment,,,\n", &to, 1, "Tag Name,Place,X,Y,Z\na,,4,5,6\nb,equipment,,,\n");
}

TEST(test_a_place_is_accepted_as_it_stands)
{
    const struct tag_edit to = { .tag = "a", .place_only = true };
    struct refusal why;
    char *out = test_memory(tag_edit("Tag Name,Place,X,Y,Z,Node\na,Equipment ,1.50,2,,pump\nb,equipment,1,,,\n", &to, 1, &why));
    assert_string_equal(out, "Tag Name,Place,X,Y,Z,Node\na,,1.50,2,,pump\nb,equipment,1,,,\n");
}

TEST(test_several_and_none)
{
    const struct tag_edit to[] = { { "b", NULL, NULL, NULL, NULL, { 1, 2, 3 }, false },
                                   { "a", NULL, NULL, NULL, NULL, { 4, 5, 6 }, false } };
    expect("Tag Name\tX\tY\tZ\na\t0\t0\t0\nb\t0\t0\t0\n", to, 2, "Tag Name\tX\tY\tZ\na\t4\t5\t6\nb\t1\t2\t3\n");
    expect("Tag Name,X,Y,Z\na,4,5.0,6\n", to + 1, 1, "Tag Name,X,Y,Z\na,4,5,6\n");
    expect("Tag Name,X,Y,Z\na,1,1,1\n", to, 0, "Tag Name,X,Y,Z\na,1,1,1\n");
}

TEST(test_what_is_not_there_is_refused)
{
    const struct tag_edit to = { "zz", NULL, NULL, NULL, NULL, { 1, 2, 3 }, false };
    struct refusal why;
    assert_null(tag_edit("Tag Name,X,Y,Z\na,1,1,1\n", &to, 1, &why));
    assert_int_equal(why.code, REFUSAL_UNLISTED);
    assert_string_equal(why.args, "tag=zz");
    assert_null(tag_edit("Name,X\na,1\n", &to, 1, &why));
    assert_int_equal(why.code, REFUSAL_NO_TAG_COLUMN);
    assert_null(tag_edit("", &to, 1, &why));
}

TEST(test_lines)
{
    struct tag_lines lines = { 0 };
    tag_lines("h\na\nb\nc\n", "h\na\nB\nc\n", &lines);
    assert_int_equal(lines.count, 1);
    assert_int_equal(lines.at[0].line, 3);
    assert_string_equal(lines.at[0].before, "b");
    assert_string_equal(lines.at[0].after, "B");
    tag_lines_finish(&lines);
    tag_lines("h\na\nc\n", "h\na\nb\nc\n", &lines);
    assert_int_equal(lines.count, 1);
    assert_null(lines.at[0].before);
    assert_string_equal(lines.at[0].after, "b");
    tag_lines_finish(&lines);
    tag_lines("h\na\n", "h\na\n", &lines);
    assert_int_equal(lines.count, 0);
    tag_lines_finish(&lines);
}

/* Edits random tag lists and reads them with the plant's own reader: all cells but the edited ones must be unchanged. */
static unsigned seed;
static int below(int n)
{
    return (int)((unsigned)rand_r(&seed) % (unsigned)n);
}

static void add_random_cell(struct text *text, char separator)
{
    static const char *const cells[] = { "", " ", "1.50", "-2", "\"q \"\"x\"\"\"", "\"a\nb\"", "\xC3\xBC", "# 3", "\"s,;\t\"", " b " };
    const char *cell = cells[below(10)];
    text_add(text, "%s%c", separator == '\t' && (cell[0] == ' ') ? "" : cell, separator);
}

static void write_random(struct text *text, char separator, int rows)
{
    text_add(text, "K%cTag Name%cX%cNode%cZ%cY%cAsset%cU\n", separator, separator, separator, separator, separator, separator, separator);
    for (int r = 0; r < rows; r++) {
        add_random_cell(text, separator);
        text_add(text, "tag%d%c", r, separator);
        for (int c = 0; c < 5; c++)
            add_random_cell(text, separator);
        text_add(text, "u%d%s", below(9), below(3) ? "\n" : "\r\n\n");
    }
}

static void compare(const char *before_path, const char *after_path, int changed)
{
    struct diag diag = { 0 };
    struct csv before, after;
    assert_true(csv_open(&before, before_path, &diag) && csv_open(&after, after_path, &diag));
    for (int r = 0; csv_next(&before); r++) {
        assert_true(csv_next(&after));
        for (int c = 0; c < 8; c++) {
            static const char *const to[8] = { NULL, NULL, "1.5", "", "-0.25", "2", "NEW", NULL };
            assert_string_equal(csv_text(&after, c), r == changed && to[c] ? to[c] : csv_text(&before, c));
        }
    }
    assert_false(csv_next(&after));
    assert_int_equal(diag.errors, 0);
    csv_close(&before);
    csv_close(&after);
    diag_finish(&diag);
}

TEST(test_random_lists)
{
    char *folder = temp_folder();
    seed = (unsigned)sweep_seed();
    for (int round = 0; round < 200; round++) {
        struct text text = { 0 };
        int rows = 1 + below(6), changed = below(rows);
        write_random(&text, ",;\t"[below(3)], rows);
        struct refusal why;
        const struct tag_edit edit = { test_printf("tag%d", changed), "NEW", NULL, NULL, NULL, { 1.5, 2, -0.25 }, false };
        char *out = test_memory(tag_edit(text.at, &edit, 1, &why));
        assert_non_null(out);
        compare(temp_write_text(folder, "before.csv", text.at), temp_write_text(folder, "after.csv", out), changed);
        text_finish(&text);
    }
}
