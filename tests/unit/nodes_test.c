/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patterns that select nodes of a model by their names: which nodes they select, and what is reported for patterns without a
   match. */
#include "tests/support/test.h"

#include "plant/models/nodes.h"

/* Tree of the test model: site / area1 / (P-1 / motor, P-2 / motor), area2 / (an unnamed node with the mesh "vessel", "a/b",
   and "P-3" with two instances of its own name) */
static const struct model_node nodes[] = {
    { "site", "", -1, 12, 20 },        { "area1", "", 0, 6, 21 },     { "P-1", "pump", 1, 4, 22 }, { "motor", "motor_m", 2, 4, 23 },
    { "P-2", "pump", 1, 6, 24 },       { "motor", "motor_m", 4, 6, 25 }, { "area2", "", 0, 12, 26 },  { "", "vessel", 6, 8, 0 },
    { "a/b", "", 6, 9, 28 },           { "P-3", "pump", 6, 12, 29 },  { "P-3", "pump", 9, 11, 29 }, { "P-3", "pump", 9, 12, 29 },
};
enum { COUNT = sizeof(nodes) / sizeof(*nodes) };

/* Returns the selected nodes' indices as letters (a: 0, b: 1 and so on), or the error message. */
static const char *taken(const char *patterns)
{
    static char text[COUNT + 1], why[300];
    bool marks[COUNT];
    size_t length = 0;
    if (!nodes_take(patterns, nodes, COUNT, marks, why, sizeof(why)))
        return why;
    for (size_t i = 0; i < COUNT; i++)
        if (marks[i])
            text[length++] = (char)('a' + i);
    text[length] = 0;
    return text;
}

static const char *found(const char *pattern)
{
    static char text[COUNT + 1], why[300];
    uint32_t at[COUNT];
    size_t count = nodes_find(pattern, nodes, COUNT, at, why, sizeof(why));
    for (size_t i = 0; i < count; i++)
        text[i] = (char)('a' + at[i]);
    text[count] = 0;
    return count ? text : why;
}

TEST(patterns_take_sub_trees_and_leave_others_out)
{
    assert_string_equal(taken(NULL), "abcdefghijkl");
    assert_string_equal(taken("P-1"), "cd");
    assert_string_equal(taken("P-[12]\n!motor"), "ce");
    assert_string_equal(taken("!area1"), "aghijkl"); /* all but */
    assert_string_equal(taken("P-3\n#0"), "hjkl");
    assert_string_equal(taken("mesh:vessel"), "h");
    assert_string_equal(taken("mesh:pump\n!#24"), "cdjkl");
    assert_string_equal(taken("P-2/motor"), "f");
    assert_string_equal(taken("/site/*/P-?/motor"), "df");
    assert_string_equal(taken("/site/**/motor"), "df");
    assert_string_equal(taken("/**/P-3"), "jkl");
    assert_string_equal(taken("a/b"), "i"); /* the name contains a slash; a pattern that equals a name exactly selects that node */
    assert_string_equal(taken("site\n!area*"), "a");
}

TEST(what_matches_nothing_is_named)
{
    assert_string_equal(taken("P-1\nmotr"), "no node's name matches 'motr': did you mean 'motor'?");
    assert_string_equal(taken("P-1\n!X*"), "no node's name matches '!X*'");
    assert_string_equal(taken("#99"), "the scene has no node '#99'");
    assert_string_equal(taken("vessel"), "no node's name matches 'vessel': did you mean 'mesh:vessel'?");
    assert_string_equal(taken("mesh:vesel"), "no node's mesh has a name that matches 'mesh:vesel': did you mean 'mesh:vessel'?");
    assert_string_equal(taken("/P-1"), "no node's name or path matches '/P-1'");
    assert_string_equal(taken("P-3/motor"), "no node's name or path matches 'P-3/motor'");
    /* messages shorten long patterns, but keep no part of a character */
    char name[80 * 3 + 1] = "";
    for (int i = 0; i < 80; i++)
        memcpy(name + strlen(name), "배", 4);
    assert_string_equal(taken(test_printf("A%s", name)), test_printf("no node's name matches 'A%.117s'", name));
    assert_string_equal(found(test_printf("A%s", name)), test_printf("the model has no node 'A%.198s'", name));
}

TEST(single_nodes_are_found_however_they_are_named)
{
    assert_string_equal(found("motor"), "df");
    assert_string_equal(found("P-1/motor"), "d");
    assert_string_equal(found("#25"), "f");
    assert_string_equal(found("mesh:vessel"), "h");
    assert_string_equal(found("P-3"), "j"); /* "P-3" and its two instances count as one node */
    assert_string_equal(found("motr"), "the model has no node 'motr': did you mean 'motor'?");
    assert_string_equal(found("!P-1"), "the model has no node '!P-1': did you mean 'P-1'?");
}
