/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The seat of a core: a unique id stored in its folder. It must survive restarts, must never be used by two cores at once, and
   must not be used by a copy of the folder. */
#include "tests/support/test.h"

#include "corelink/node_id.h"

static void take(struct node_id *node, const char *folder, char id[9])
{
    char *why = node_id_take(node, folder);
    assert_null(why);
    assert_int_equal(strlen(node->id), 8);
    memcpy(id, node->id, 9);
}

TEST(it_is_kept_and_never_shared)
{
    struct node_id node = { 0 }, other = { 0 };
    char first[9], again[9], *folder = temp_folder();
    take(&node, folder, first);
    char *why = test_memory(node_id_take(&other, folder));
    assert_non_null(why);
    assert_non_null(strstr(why, folder));
    assert_non_null(strstr(why, "another core"));
    node_id_release(&node);
    take(&node, folder, again);
    assert_string_equal(again, first);
    node_id_release(&node);
}

/* Copies the file with the id to another one, as `cp -a` of the folder does: the copy must get another id. */
TEST(a_copy_is_another)
{
    struct node_id node = { 0 };
    char first[9], again[9], line[128], *folder = temp_folder();
    take(&node, folder, first);
    char *path = test_printf("%s/node", folder), *copy = test_printf("%s/copy", folder);
    FILE *in = fopen(path, "r"), *out = fopen(copy, "w");
    assert_non_null(fgets(line, sizeof(line), in));
    fputs(line, out);
    fclose(in);
    fclose(out);
    node_id_release(&node);
    assert_int_equal(rename(copy, path), 0);
    take(&node, folder, again);
    assert_string_not_equal(again, first);
    node_id_release(&node);
    take(&node, folder, first);
    assert_string_equal(again, first);
    node_id_release(&node);
}

TEST(what_it_cannot_read_is_made_anew_and_no_folder_is_said)
{
    struct node_id node = { 0 };
    char id[9], *folder = temp_folder();
    temp_write_text(folder, "node", "no seat at all, and much longer than what stands here is ever going to be, by a good deal");
    take(&node, folder, id);
    node_id_release(&node);
    char *why = test_memory(node_id_take(&node, "/dev/null/none"));
    assert_non_null(why);
    assert_non_null(strstr(why, "/dev/null/none/node"));
}
