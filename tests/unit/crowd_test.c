/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which markers are drawn, by the rule of protocol/LABELS.md; uses the same test vectors as the browser's implementation. */
#include "render/overlay/crowd.h"

#include "tests/support/test.h"
#include <dirent.h>
#include <jansson.h>

#include "tests/support/synthetic.h"

#define FOLDER "protocol/vectors/markers"

static double at(const json_t *array, size_t i)
{
    return json_number_value(json_array_get(array, i));
}

static void check_vector(const char *name)
{
    char *path = test_printf("%s/%s", FOLDER, name);
    json_t *vector = test_json(json_load_file(path, 0, NULL));
    assert_non_null(vector);
    const json_t *list = json_object_get(vector, "items"), *expected = json_object_get(vector, "drawn");
    size_t count = json_array_size(list), next = 0;
    struct crowd_item *items = mem_array(count, sizeof(*items));
    bool *drawn = mem_array(count, sizeof(*drawn));
    for (size_t i = 0; i < count; i++) {
        const json_t *item = json_array_get(list, i);
        items[i] = (struct crowd_item){ at(item, 0), at(item, 1), at(item, 2), at(item, 3) > 0, at(item, 4) > 0, at(item, 5) > 0 };
    }
    crowd_thin(items, count, json_number_value(json_object_get(vector, "unit")), drawn);
    for (size_t i = 0; i < count; i++) {
        bool is_next = next < json_array_size(expected) && (size_t)at(expected, next) == i;
        if (drawn[i] != is_next)
            fail_msg("%s: item %zu is %sdrawn", name, i, drawn[i] ? "" : "not ");
        next += is_next;
    }
    assert_int_equal(next, json_array_size(expected));
    mem_free(items);
    mem_free(drawn);
}

TEST(draws_what_the_vectors_say)
{
    int count = 0;
    DIR *folder = opendir(FOLDER);
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder));)
        if (strstr(entry->d_name, ".json")) {
            check_vector(entry->d_name);
            count++;
        }
    closedir(folder);
    assert_true(count >= 4);
}

/* Also with all markers in one place, and with none. */
TEST(draws_the_first_of_thousands)
{
    enum { COUNT = 4096 };
    static struct crowd_item items[COUNT];
    static bool drawn[COUNT];
    uint64_t seed = 7;
    for (int i = 0; i < COUNT; i++)
        items[i] = (struct crowd_item){ .x = 5 * synthetic_random_unit(&seed), .y = 5, .depth_m = i, .occluded = i == 0 };
    crowd_thin(items, 0, 1, NULL);
    crowd_thin(items, COUNT, 1, drawn);
    for (int i = 0; i < COUNT; i++)
        assert_int_equal(drawn[i], i > 0 && i <= 6);
}
