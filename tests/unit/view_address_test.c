/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses of the page converted to query arguments: each valid form, and invalid addresses. */
#include "message/view_address.h"

#include "tests/support/test.h"

#include "base/text/text.h"

static void assert_read(const char *address, const char *expected)
{
    struct view_address read;
    struct message_error error = { 0 };
    struct text *text = test_text();
    assert_true(view_address_read(&read, address, &error));
    for (size_t i = 0; i < read.count; i++)
        text_add(text, "%s%s", i ? " | " : "", read.args[i]);
    assert_string_equal(text->at ? text->at : "", expected);
    view_address_finish(&read);
}

TEST(names_and_forms_are_those_of_queries)
{
    assert_read("", "");
    assert_read("&&group=t&&", "group=t");
    assert_read("group=vib%20ration&tag=TI-1&hide=A,%ED%95%9C&only=B&asset=E-101", "group=vib ration | hidden=A,\xed\x95\x9c | isolate=B | "
                                                                                   "selected=E-101");
    assert_read("hide=", "hidden=");
    assert_read("camera=1,2,3,4,5,6,0,0,1,45", "camera=1,2,3,4,5,6,45 | up=0,0,1");
    assert_read("camera=1,2,30,1,2,3,0,1,0,45,2.5", "camera=1,2,30,1,2,3 | up=0,1,0 | projection=orthographic | height_m=2.5");
    assert_read("clip=0,0,1,2;1,0,0,3", "clip=0,0,1,2;1,0,0,3");
    assert_read("clip=0,0,0,1,1,1", "clip_box=0,0,0,1,1,1");
    assert_read("split=group:pressure;look:flat", "split=group=pressure;look=flat");
    assert_read("split=same", "split=");
    assert_read("show=blind&isolines=none&arrows=strokes", "show=blind | isolines=none | arrows=strokes");
    assert_read("ramp=5&radius=2&reach=1", "ramp_interval=5 | radius_m=2 | reach_m=1");
    assert_read("group=a%zzb%4", "group=a%zzb%4");
    assert_read("group=a%00b", "group=a%00b"); /* no text ends there */
}

TEST(what_a_picture_cannot_show_is_said)
{
    static const char *const wrong[] = { "unknown=1",  "camera=", "camera=1,2,3", "camera=1,2,3,4,5,6,0,0,1,45,2,7", "camera=1,2,x",
                                         "view=other", "width=5", "follow=7",     "=" };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        struct view_address read;
        struct message_error error = { 0 };
        assert_false(view_address_read(&read, wrong[i], &error));
        assert_string_equal(error.code, "bad_field");
        view_address_finish(&read);
    }
}

TEST(more_than_there_is_room_for)
{
    struct text *text = test_text();
    struct view_address read;
    struct message_error error = { 0 };
    for (int i = 0; i <= VIEW_ADDRESS_ARGS; i++)
        text_add(text, "group=t%d&", i);
    assert_false(view_address_read(&read, text->at, &error));
    assert_int_equal(read.count, VIEW_ADDRESS_ARGS);
    view_address_finish(&read);
}

TEST(another_camera_replaces_that_of_a_view_with_its_vertical)
{
    static const char *const given[] = { "camera=1,2,3,4,5,6", "fit=E-101" };
    for (size_t i = 0; i < sizeof(given) / sizeof(given[0]); i++) {
        struct view_address read;
        struct message_error error = { 0 };
        assert_true(view_address_read(&read, "camera=1,2,30,1,2,3,0,1,0,45,2.5&look=flat", &error));
        assert_true(view_address_set(&read, given[i]));
        assert_int_equal(read.count, 2);
        assert_string_equal(read.args[0], "look=flat");
        assert_string_equal(read.args[1], given[i]);
        view_address_finish(&read);
    }
}
