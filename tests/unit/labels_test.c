/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Label placement and the choice of drawn markers, by the rules of protocol/LABELS.md; shares its test vectors with the
   browser's implementation. */
#include "render/overlay/labels.h"
#include "render/overlay/crowd.h"

#include "tests/support/test.h"
#include <dirent.h>
#include <jansson.h>

#include "tests/support/synthetic.h"

static double at(const json_t *array, size_t i)
{
    return json_number_value(json_array_get(array, i));
}

static struct label_box box_of(const json_t *array)
{
    return (struct label_box){ at(array, 0), at(array, 1), at(array, 2) - at(array, 0), at(array, 3) - at(array, 1) };
}

/* Callback that measures call-outs: returns the size that the test vector gives for all of them. */
static void measure(void *arg, const int *members, size_t count, double size[2])
{
    const json_t *list = arg;
    assert_true(count > 1 && members[0] >= 0);
    size[0] = at(list, 0);
    size[1] = at(list, 1);
}

static void check_labels(const char *name, const json_t *vector)
{
    const json_t *list = json_object_get(vector, "items"), *blocked = json_object_get(vector, "blocked");
    size_t count = json_array_size(list), blocked_count = json_array_size(blocked);
    struct label_item *items = mem_array(count, sizeof(*items));
    struct label_box *boxes = mem_array(blocked_count, sizeof(*boxes));
    struct label_place *places = mem_array(count, sizeof(*places));
    for (size_t i = 0; i < count; i++) {
        const json_t *item = json_array_get(list, i);
        items[i] = (struct label_item){ at(item, 0),      at(item, 1),      at(item, 2),     at(item, 3), at(item, 5),
                                        (int)at(item, 4), (int)at(item, 6), at(item, 7) > 0, /* left out: no ring */
                                        LABEL_NONE,       LABEL_NONE };
        if (json_array_size(item) > 8)
            items[i].callout = (int)at(item, 8);
        if (json_array_size(item) > 9)
            items[i].asset = (int)at(item, 9);
    }
    for (size_t i = 0; i < blocked_count; i++)
        boxes[i] = box_of(json_array_get(blocked, i));
    struct label_area area = { .box = box_of(json_object_get(vector, "area")),
                               .unit = json_number_value(json_object_get(vector, "unit")),
                               .blocked = boxes,
                               .blocked_count = blocked_count,
                               .measure = measure,
                               .arg = json_object_get(vector, "callout") };
    const json_t *slots = json_object_get(vector, "slots"), *callouts = json_object_get(vector, "callouts");
    /* expected result by item: 1 if a leader line connects the item with its call-out */
    const json_t *leads_of = json_object_get(vector, "leads");
    labels_place(items, count, &area, places);
    for (size_t i = 0; i < count; i++) {
        if (places[i].slot != (int)at(slots, i))
            fail_msg("%s: item %zu has slot %d, not %g", name, i, places[i].slot, at(slots, i));
        if (places[i].callout != (callouts ? (int)at(callouts, i) : LABEL_NONE))
            fail_msg("%s: item %zu is in call-out %d, not %g", name, i, places[i].callout, at(callouts, i));
        bool leads = places[i].callout != LABEL_NONE && labels_has_leader(items, places, count, area.unit, i);
        if (leads != (leads_of && at(leads_of, i) > 0))
            fail_msg("%s: item %zu has %s leader line to its call-out", name, i, leads ? "a" : "no");
    }
    mem_free(items);
    mem_free(boxes);
    mem_free(places);
}

static void check_markers(const char *name, const json_t *vector)
{
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

/* Calls check() with each test vector (JSON file) of a folder. Fails if there are fewer than `least`. */
static void check_vectors(const char *path, void (*check)(const char *name, const json_t *vector), int least)
{
    int count = 0;
    DIR *folder = opendir(path);
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder));)
        if (strstr(entry->d_name, ".json")) {
            json_t *vector = test_json(json_load_file(test_printf("%s/%s", path, entry->d_name), 0, NULL));
            assert_non_null(vector);
            check(entry->d_name, vector);
            count++;
        }
    closedir(folder);
    assert_true(count >= least);
}

TEST(labels_and_markers_are_as_the_vectors_say)
{
    check_vectors("protocol/vectors/labels", check_labels, 7);
    check_vectors("protocol/vectors/markers", check_markers, 4);
}

/* Thousands of labels are placed quickly and never overlap. */
TEST(many_labels_do_not_overlap)
{
    enum { COUNT = 4096 };
    static struct label_item items[COUNT];
    static struct label_place places[COUNT];
    uint64_t seed = 11;
    for (int i = 0; i < COUNT; i++)
        items[i] = (struct label_item){ .x = 1920 * synthetic_random_unit(&seed),
                                        .y = 1080 * synthetic_random_unit(&seed),
                                        .width = 60,
                                        .height = 18,
                                        .depth_m = 1 + synthetic_random_unit(&seed),
                                        .rank = i % 4 - 1,
                                        .held = LABEL_NONE,
                                        .callout = LABEL_NONE,
                                        .asset = LABEL_NONE };
    labels_place(items, COUNT, &(struct label_area){ .box = { 0, 0, 1920, 1080 }, .unit = 1 }, places);
    int shown = 0;
    for (int i = 0; i < COUNT; i++) {
        if (places[i].slot == LABEL_NONE)
            continue;
        struct label_box a = places[i].box;
        assert_true(items[i].rank != LABEL_NOT_WANTED && a.x >= 0 && a.y >= 0 && a.x + a.width <= 1920 && a.y + a.height <= 1080);
        for (int k = 0; k < i; k++) {
            struct label_box b = places[k].slot == LABEL_NONE ? (struct label_box){ 0 } : places[k].box;
            assert_true(a.x >= b.x + b.width || b.x >= a.x + a.width || a.y >= b.y + b.height || b.y >= a.y + a.height);
        }
        shown++;
    }
    assert_true(shown > 3);
}

/* Returns the distance of a box from a marker's centre. */
static double distance_of(const struct label_item *item, const struct label_box *box)
{
    return hypot(fmax(0, fmax(box->x - item->x, item->x - box->x - box->width)),
                 fmax(0, fmax(box->y - item->y, item->y - box->y - box->height)));
}

/* Returns how many rings a label covers: those whose square of 32 units the label overlaps. */
static int covered_by(const struct label_item *items, int count, const struct label_box *box, double unit)
{
    int covered = 0;
    for (int i = 0; i < count; i++)
        covered += items[i].ring && box->x < items[i].x + 16 * unit && items[i].x - 16 * unit < box->x + box->width &&
                   box->y < items[i].y + 16 * unit && items[i].y - 16 * unit < box->y + box->height;
    return covered;
}

/* In small pictures full of rings, a call-out for all rings covers as few of them as any position of a grid of 4 units allows. */
TEST(call_out_for_all_rings_covers_few)
{
    enum { COUNT = 60, ROUNDS = 200, WIDTH = 320, HEIGHT = 180 };
    static struct label_item items[COUNT];
    static struct label_place places[COUNT];
    uint64_t seed = sweep_seed();
    json_t *size = test_json(json_pack("[ii]", 130, 36));
    int covering = 0;
    for (int round = 0; round < ROUNDS; round++) {
        int count = COUNT - round % 40;
        struct label_area area = { .box = { 0, 0, WIDTH, HEIGHT }, .unit = 1, .measure = measure, .arg = size };
        for (int i = 0; i < count; i++)
            items[i] = (struct label_item){ .x = WIDTH * synthetic_random_unit(&seed),
                                            .y = HEIGHT * synthetic_random_unit(&seed),
                                            .width = 90,
                                            .height = 20,
                                            .depth_m = 1 + synthetic_random_unit(&seed),
                                            .rank = LABEL_BEYOND,
                                            .ring = true,
                                            .held = LABEL_NONE,
                                            .callout = LABEL_NONE,
                                            .asset = LABEL_NONE };
        labels_place(items, (size_t)count, &area, places);
        if (places[0].slot <= 1000000)
            continue;
        int least = count, covered = covered_by(items, count, &places[0].box, 1);
        for (int y = 0; y <= HEIGHT - 36; y += 4)
            for (int x = 0; x <= WIDTH - 130; x += 4) {
                int here = covered_by(items, count, &(struct label_box){ x, y, 130, 36 }, 1);
                least = here < least ? here : least;
            }
        assert_int_equal(covered, least);
        for (int i = 0; i < count; i++)
            assert_true(distance_of(&items[i], &places[i].box) >= 13 || !labels_has_leader(items, places, (size_t)count, 1, (size_t)i));
        covering++;
    }
    assert_true(covering > 10);
}

/* In random pictures, labels keep 10 units from the outer edge (15.5 units from the centre) of rings of other labels. Two labels of rings
   keep 8 units between them, and a label of rings is at most 60 units from one of them. Exempt is a call-out for all rings. */
TEST(labels_keep_room_around_rings)
{
    enum { COUNT = 60, ROUNDS = 40 };
    static struct label_item items[COUNT];
    static struct label_place places[COUNT];
    uint64_t seed = sweep_seed();
    json_t *size = test_json(json_pack("[ii]", 130, 36));
    int labels = 0;
    for (int round = 0; round < ROUNDS; round++) {
        double unit = 0.5 + synthetic_random_unit(&seed), spread = round % 2 ? 1 : 0.3;
        struct label_area area = { .box = { 0, 0, 1280, 720 }, .unit = unit, .measure = measure, .arg = size };
        int rings = 0;
        for (int i = 0; i < COUNT; i++) {
            bool ring = synthetic_random_unit(&seed) < 0.02 * round;
            items[i] = (struct label_item){ .x = 640 + 1280 * spread * (synthetic_random_unit(&seed) - 0.5),
                                            .y = 360 + 720 * spread * (synthetic_random_unit(&seed) - 0.5),
                                            .width = 90 * unit,
                                            .height = 20 * unit,
                                            .depth_m = 1 + synthetic_random_unit(&seed),
                                            .rank = ring ? LABEL_BEYOND : LABEL_PLAIN,
                                            .ring = ring,
                                            .held = LABEL_NONE,
                                            .callout = LABEL_NONE,
                                            .asset = i % 5 };
            rings += ring;
        }
        labels_place(items, COUNT, &area, places);
        for (int i = 0; i < COUNT; i++) {
            struct label_box wide = { places[i].box.x - 8 * unit, places[i].box.y - 8 * unit, places[i].box.width + 16 * unit,
                                      places[i].box.height + 16 * unit };
            double nearest = distance_of(&items[i], &places[i].box);
            int shared = 0;
            for (int k = 0; k < COUNT && places[i].callout != LABEL_NONE; k++)
                if (places[k].callout == places[i].callout) {
                    nearest = fmin(nearest, distance_of(&items[k], &places[i].box));
                    shared++;
                }
            assert_true(!items[i].ring || places[i].slot != LABEL_NONE);
            if (places[i].slot == LABEL_NONE || (shared > 1 && shared == rings))
                continue;
            labels++;
            assert_true(!items[i].ring || nearest <= 60 * unit);
            for (int k = 0; k < COUNT; k++) {
                bool other = k != i && items[k].ring && (places[i].callout == LABEL_NONE || places[k].callout != places[i].callout);
                const struct label_box *box = &places[k].box;
                assert_true(!other || distance_of(&items[k], &places[i].box) >= 25.5 * unit - 1e-9);
                assert_true(!other || !items[i].ring || wide.x + wide.width <= box->x + 1e-9 || box->x + box->width <= wide.x + 1e-9 ||
                            wide.y + wide.height <= box->y + 1e-9 || box->y + box->height <= wide.y + 1e-9);
            }
        }
    }
    assert_true(labels > COUNT);
}

/* Of thousands of markers in one place, the nearest visible ones are drawn, and no others. An empty list of markers is
   accepted. */
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
