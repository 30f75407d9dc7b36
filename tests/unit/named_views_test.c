/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named views (saved by users or defined in the plant file): they survive a restart, keep their content and have one common
   order. Views of the plant file stay as written there. Short links (ids for shared views) survive a restart; if there are too
   many, the newest are kept. */
#include "tests/support/test.h"

#include <jansson.h>

#include "views/named_views.h"
#include "views/short_links.h"

enum { NOON_S = 1767268800 };
struct named_views_fixture {
    struct log *log;
    struct plant plant;
    char *folder, *history;
    struct named_views *views;
};

static void begin(struct named_views_fixture *f)
{
    static struct named_view fixed = { .id = "all", .title = "All", .address = "group=t" };
    f->log = test_log();
    f->plant = (struct plant){ .screens.views = &fixed, .screens.view_count = 1 };
    f->folder = temp_folder();
    f->history = temp_path(f->folder, "history");
    f->views = named_views_open(f->log, &f->plant, f->history, NULL);
}

static void end(struct named_views_fixture *f)
{
    named_views_close(&f->views);
}

TEST_FIXTURE(struct named_views_fixture, begin, end)

#define CASE(name) TEST_ON(struct named_views_fixture *f, name, set_up, tear_down)

static void open_again(struct named_views_fixture *f)
{
    named_views_close(&f->views);
    f->views = named_views_open(f->log, &f->plant, f->history, NULL);
}

static enum refusal_code save(struct named_views_fixture *f, const char *id, const char *title, int at)
{
    struct named_view_edit edit = { .at = at, .address = "group=t&show=value" };
    snprintf(edit.id, sizeof(edit.id), "%s", id);
    snprintf(edit.title, sizeof(edit.title), "%s", title);
    return named_views_save(f->views, &edit, "kim", INT64_C(1000000) * NOON_S);
}

/* Asserts the ids of all views in their order. expected: the ids, separated by blanks. */
static void assert_order(struct named_views_fixture *f, const char *expected)
{
    char found[400] = "";
    json_t *message = named_views_message(f->views, NULL), *list = json_object_get(message, "list");
    for (size_t i = 0; i < json_array_size(list); i++)
        snprintf(found + strlen(found), sizeof(found) - strlen(found), "%s%s", i ? " " : "",
                 json_string_value(json_object_get(json_array_get(list, i), "id")));
    json_decref(message);
    assert_string_equal(found, expected);
}

static size_t versions_of(struct named_views_fixture *f, const char *id, size_t index)
{
    json_t *message = named_views_message(f->views, id), *list = json_object_get(message, "list");
    size_t count = json_array_size(json_object_get(json_array_get(list, index), "before"));
    json_decref(message);
    return count;
}

CASE(they_are_kept_in_order)
{
    uint64_t number = named_views_number(f->views);
    assert_true(number == 1);
    assert_int_equal(save(f, "b", "B", -1), REFUSAL_NONE);
    assert_int_equal(save(f, "c", "C", -1), REFUSAL_NONE);
    assert_int_equal(save(f, "a", "A", 0), REFUSAL_NONE);
    assert_order(f, "all a b c");
    assert_int_equal(save(f, "a", "A", 2), REFUSAL_NONE);
    assert_order(f, "all b c a");
    /* saving under an existing id replaces that view and keeps its place in the order */
    assert_int_equal(save(f, "b", "Other", -1), REFUSAL_NONE);
    assert_true(named_views_number(f->views) == number + 5);
    open_again(f);
    assert_order(f, "all b c a");
    assert_int_equal(named_views_remove(f->views, "c"), REFUSAL_NONE);
    assert_int_not_equal(named_views_remove(f->views, "c"), REFUSAL_NONE);
    open_again(f);
    assert_order(f, "all b a");
}

CASE(what_they_were_is_kept)
{
    char title[12];
    assert_int_equal(save(f, "a", "0", -1), REFUSAL_NONE);
    assert_int_equal(versions_of(f, "a", 1), 0);
    /* saves the same content at another place in the order, which must not count as a new version of the view */
    assert_int_equal(save(f, "a", "0", 0), REFUSAL_NONE);
    assert_int_equal(versions_of(f, "a", 1), 0);
    for (int i = 1; i < 2 * NAMED_VIEW_VERSIONS; i++) {
        snprintf(title, sizeof(title), "%d", i);
        assert_int_equal(save(f, "a", title, -1), REFUSAL_NONE);
    }
    open_again(f);
    assert_int_equal(versions_of(f, "a", 1), NAMED_VIEW_VERSIONS);
    assert_int_equal(versions_of(f, NULL, 1), 0);
}

CASE(the_plant_file_has_its_own)
{
    assert_int_not_equal(save(f, "all", "Mine", -1), REFUSAL_NONE);
    assert_int_not_equal(named_views_remove(f->views, "all"), REFUSAL_NONE);
    assert_int_equal(save(f, "mine", "Mine", -1), REFUSAL_NONE);
    f->plant.screens.view_count = 0;
    assert_int_equal(save(f, "all", "Mine", -1), REFUSAL_NONE);
    /* the plant file defines "all" again, which takes precedence over the view that a user saved under the same id */
    f->plant.screens.view_count = 1;
    assert_order(f, "all mine");
}

CASE(there_is_a_limit)
{
    char id[16];
    for (int i = 0; i < NAMED_VIEWS; i++) {
        snprintf(id, sizeof(id), "v%d", i);
        assert_int_equal(save(f, id, "V", -1), REFUSAL_NONE);
    }
    assert_int_not_equal(save(f, "more", "V", -1), REFUSAL_NONE);
    assert_int_equal(save(f, "v0", "Other", -1), REFUSAL_NONE);
}

CASE(what_cannot_be_read_is_not_written_over)
{
    static const char *const files[] = {
        "{", "[]", "{\"views\":[{\"id\":\"a\"}]}",
        "{\"views\":[{\"id\":\"a b\",\"title\":\"\",\"view\":\"\",\"by\":\"\",\"time_us\":1,\"before\":[]}]}",
    };
    for (size_t i = 0; i < sizeof(files) / sizeof(*files); i++) {
        char *path = temp_write_text(f->folder, "history/" NAMED_VIEWS_FILE, files[i]), text[200] = "";
        open_again(f);
        assert_order(f, "all");
        assert_int_not_equal(save(f, "a", "A", -1), REFUSAL_NONE);
        FILE *file = fopen(path, "re");
        assert_non_null(file);
        text[fread(text, 1, sizeof(text) - 1, file)] = 0;
        fclose(file);
        assert_string_equal(text, files[i]);
    }
}

CASE(without_a_folder_none_is_saved)
{
    struct named_views *views = named_views_open(f->log, &f->plant, NULL, NULL);
    struct named_view_edit edit = { .id = "a", .title = "A", .address = "group=t", .at = -1 };
    assert_int_not_equal(named_views_save(views, &edit, "kim", 1), REFUSAL_NONE);
    named_views_close(&views);
    edit.title[0] = (char)0xff; /* a title with invalid UTF-8 is refused, and nothing is changed */
    assert_int_not_equal(named_views_save(f->views, &edit, "kim", 1), REFUSAL_NONE);
    assert_order(f, "all");
}

/* --- short links */

static const int64_t NOON_US = INT64_C(1000000) * NOON_S, DAY_US = INT64_C(86400000000);

CASE(a_short_link_depends_on_its_view_and_survives_a_restart)
{
    char id[SHORT_LINK_ID_BYTES], again[SHORT_LINK_ID_BYTES], other[SHORT_LINK_ID_BYTES];
    struct short_links *links = short_links_open(f->log, f->history, NULL);
    assert_int_equal(short_links_share(links, "asset=P-101A", NOON_US, id, NULL), REFUSAL_NONE);
    assert_string_equal(id, "vyj5ny9g");
    assert_int_equal(short_links_share(links, "asset=P-101A", NOON_US + 1, again, NULL), REFUSAL_NONE);
    assert_string_equal(again, id);
    assert_int_equal(short_links_share(links, "asset=P-101A", NOON_US + 2, again, NULL), REFUSAL_NONE);
    /* written twice: when the link was made, and when it was shared again for the first time */
    assert_int_equal(short_links_number(links), 2);
    assert_int_equal(short_links_share(links, "asset=P-101B", NOON_US, other, NULL), REFUSAL_NONE);
    assert_string_not_equal(other, id);
    short_links_close(&links);
    links = short_links_open(f->log, f->history, NULL);
    assert_string_equal(short_links_find(links, id), "asset=P-101A");
    assert_null(short_links_find(links, "vyj5ny9"));
    short_links_close(&links);
}

CASE(an_id_that_another_view_has_gets_longer)
{
    char id[SHORT_LINK_ID_BYTES];
    temp_write_text(f->folder, "history/" SHORT_LINKS_FILE, "{\"links\":[{\"id\":\"vyj5ny9g\",\"view\":\"group=t\",\"time_us\":1}]}");
    struct short_links *links = short_links_open(f->log, f->history, NULL);
    assert_int_equal(short_links_share(links, "asset=P-101A", NOON_US, id, NULL), REFUSAL_NONE);
    assert_int_equal(strlen(id), 9);
    assert_string_equal(short_links_find(links, id), "asset=P-101A");
    assert_string_equal(short_links_find(links, "vyj5ny9g"), "group=t");
    short_links_close(&links);
}

/* Makes `count` short links, each for a different view that is shared once, 2 s apart. */
static void share_many(struct short_links *links, int first, int count)
{
    char id[SHORT_LINK_ID_BYTES], view[40];
    for (int i = first; i < first + count; i++) {
        snprintf(view, sizeof(view), "asset=%d", i);
        assert_int_equal(short_links_share(links, view, NOON_US + i * 2000000LL, id, NULL), REFUSAL_NONE);
    }
}

CASE(a_further_short_link_replaces_the_one_unused_for_longest)
{
    char first[SHORT_LINK_ID_BYTES], second[SHORT_LINK_ID_BYTES], id[SHORT_LINK_ID_BYTES];
    struct short_links *links = short_links_open(f->log, f->history, NULL);
    assert_int_equal(short_links_share(links, "asset=first", NOON_US, first, NULL), REFUSAL_NONE);
    assert_int_equal(short_links_share(links, "asset=second", NOON_US, second, NULL), REFUSAL_NONE);
    share_many(links, 2, SHORT_LINKS - 2);
    /* the first link is shared again a day later, which makes it one of the newest */
    assert_int_equal(short_links_share(links, "asset=first", NOON_US + DAY_US, id, NULL), REFUSAL_NONE);
    assert_int_equal(short_links_share(links, "asset=another", NOON_US + DAY_US, id, NULL), REFUSAL_NONE);
    assert_int_equal(json_array_size(short_links_list(links)), SHORT_LINKS);
    assert_string_equal(short_links_find(links, first), "asset=first");
    assert_null(short_links_find(links, second));
    short_links_close(&links);
}

CASE(links_that_nobody_opens_do_not_replace_one_that_was_used)
{
    char used[SHORT_LINK_ID_BYTES], id[SHORT_LINK_ID_BYTES];
    bool added;
    struct short_links *links = short_links_open(f->log, f->history, NULL);
    assert_int_equal(short_links_share(links, "asset=used", NOON_US, used, &added), REFUSAL_NONE);
    assert_true(added);
    assert_int_equal(short_links_share(links, "asset=used", NOON_US, used, &added), REFUSAL_NONE);
    assert_false(added);
    share_many(links, 1, 2 * SHORT_LINKS);
    short_links_close(&links);
    links = short_links_open(f->log, f->history, NULL);
    assert_int_equal(json_array_size(short_links_list(links)), SHORT_LINKS);
    assert_string_equal(short_links_find(links, used), "asset=used");
    short_links_share(links, "asset=1", NOON_US + DAY_US, id, &added);
    assert_true(added); /* this link had been replaced */
    short_links_close(&links);
}

CASE(too_many_new_short_links_within_a_short_time_are_refused)
{
    char id[SHORT_LINK_ID_BYTES], view[40];
    struct short_links *links = short_links_open(f->log, f->history, NULL);
    for (int i = 0; i < 30; i++) {
        snprintf(view, sizeof(view), "asset=%d", i);
        assert_int_equal(short_links_share(links, view, NOON_US, id, NULL), i < 20 ? REFUSAL_NONE : REFUSAL_LINKS_OFTEN);
    }
    assert_int_equal(short_links_share(links, "asset=0", NOON_US, id, NULL), REFUSAL_NONE); /* is stored already */
    assert_int_equal(short_links_share(links, "asset=20", NOON_US + 2000000, id, NULL), REFUSAL_NONE);
    assert_int_equal(short_links_share(links, "asset=21", NOON_US + 2000000, id, NULL), REFUSAL_LINKS_OFTEN);
    assert_int_equal(short_links_share(links, "asset=21", NOON_US - DAY_US, id, NULL), REFUSAL_NONE); /* the clock was set back */
    short_links_close(&links);
}

CASE(a_mirror_takes_only_valid_short_links)
{
    char id[SHORT_LINK_ID_BYTES];
    struct short_links *links = short_links_open(f->log, NULL, NULL);
    assert_int_equal(short_links_share(links, "asset=first", NOON_US, id, NULL), REFUSAL_UNRECORDED);
    json_t *good = test_json(json_loads("[{\"id\":\"abcdefgh\",\"view\":\"group=t\",\"time_us\":1}]", 0, NULL));
    json_t *bad = test_json(json_loads("[{\"id\":\"abcdefgh\",\"view\":\"a blank\",\"time_us\":1}]", 0, NULL));
    assert_true(short_links_mirror(links, good));
    assert_false(short_links_mirror(links, bad));
    assert_string_equal(short_links_find(links, "abcdefgh"), "group=t");
    short_links_close(&links);
}
