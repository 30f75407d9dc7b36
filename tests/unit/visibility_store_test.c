/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The store of visibility buffers: lookup by shape, memory limit, and eviction of the least recently used. */
#include "tests/support/test.h"

#include "render/soft/visibility_store.h"

/* Gives the store a visibility buffer of this size for a shape. Returns it as found in the store, or NULL if the store did not
   keep it. */
static void *make(struct visibility_store *store, uint64_t shape, size_t bytes)
{
    visibility_store_give(store, shape, mem_new(bytes), bytes, mem_free);
    return visibility_store_find(store, shape);
}

TEST(test_found_again)
{
    struct visibility_store store = { .bound_bytes = 1000 };
    assert_null(visibility_store_find(&store, 7));
    int *made = make(&store, 7, 400);
    assert_non_null(made);
    *made = 42;
    assert_ptr_equal(visibility_store_find(&store, 7), made);
    assert_int_equal(*made, 42);
    assert_null(visibility_store_find(&store, 8));
    assert_non_null(make(&store, 7, 300)); /* replaces the old buffers */
    assert_int_equal(store.bytes, 300);
    visibility_store_drop(&store, 7);
    assert_null(visibility_store_find(&store, 7));
    assert_int_equal(store.bytes, 0);
    visibility_store_finish(&store);
}

TEST(test_bound)
{
    struct visibility_store store = { .bound_bytes = 1000 };
    assert_null(make(&store, 1, 1001));
    assert_non_null(make(&store, 1, 400));
    assert_non_null(make(&store, 2, 400));
    assert_non_null(visibility_store_find(&store, 1));
    /* to make room for the third buffer, the store evicts the second, which was used least recently */
    assert_non_null(make(&store, 3, 600));
    assert_non_null(visibility_store_find(&store, 1));
    assert_null(visibility_store_find(&store, 2));
    assert_int_equal(store.bytes, 1000);
    visibility_store_finish(&store);
    assert_int_equal(store.bytes, 0);
}

TEST(test_the_newest_is_kept_alone)
{
    struct visibility_store store = { .bound_bytes = 1000, .keeps_newest = true };
    assert_non_null(make(&store, 1, 400));
    assert_non_null(make(&store, 2, 5000));
    assert_null(visibility_store_find(&store, 1));
    assert_non_null(make(&store, 3, 6000));
    assert_int_equal(store.bytes, 6000);
    visibility_store_bound(&store, 1000);
    assert_null(visibility_store_find(&store, 3));
    assert_int_equal(store.bytes, 0);
    visibility_store_finish(&store);
}

TEST(test_many_small)
{
    struct visibility_store store = { .bound_bytes = 1000 };
    for (uint64_t shape = 0; shape < 3 * VISIBILITY_SLOTS; shape++)
        assert_non_null(make(&store, shape, 8));
    assert_int_equal(store.bytes, 8 * VISIBILITY_SLOTS);
    assert_null(visibility_store_find(&store, 0));
    assert_non_null(visibility_store_find(&store, 3 * VISIBILITY_SLOTS - 1));
    visibility_store_finish(&store);
}
