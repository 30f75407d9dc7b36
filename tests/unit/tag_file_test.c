/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Versions of a tag list on disk: no version is ever lost, and a failed write is refused with the reason. */
#include "placing/tag_file.h"

#include "tests/support/test.h"
#include <sys/stat.h>
#include <unistd.h>

enum { NOBODY = 65534 };
struct tag_file_fixture {
    char *folder, *path;
};

static void begin(struct tag_file_fixture *f)
{
    f->folder = temp_folder();
    f->path = temp_write_text(f->folder, "tags.csv", "one\n");
}

TEST_FIXTURE(struct tag_file_fixture, begin, NULL)

#define CASE(name) TEST_ON(struct tag_file_fixture *f, name, set_up, tear_down)

static void expect_text(const char *folder, const char *name, const char *want)
{
    struct refusal why;
    char *path = temp_path(folder, name), *text = test_memory(tag_file_read(path, &why));
    assert_non_null(text);
    assert_string_equal(text, want);
}

static bool put(const struct tag_file_fixture *f, char *before, char *after, char **kept, struct refusal *why)
{
    struct tag_save save = { .path = f->path, .before = before, .after = after };
    *kept = NULL;
    return tag_file_put(&save, kept, why);
}

CASE(test_every_list_stays_beside_the_next)
{
    struct refusal why;
    char *kept;
    temp_write_text(f->folder, "tags.csv.2", "somebody's own\n");
    static const char *const names[] = { "tags.csv.1", "tags.csv.3" };
    char *texts[] = { "one\n", "two\n", "three\n" };
    assert_int_equal(chmod(f->path, 0640), 0);
    for (int i = 0; i < 2; i++) {
        assert_true(put(f, texts[i], texts[i + 1], &kept, &why));
        assert_string_equal(strrchr(kept, '/') + 1, names[i]);
        expect_text(f->folder, names[i], texts[i]);
        expect_text(f->folder, "tags.csv", texts[i + 1]);
        mem_free(kept);
    }
    struct stat st;
    assert_int_equal(stat(f->path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0640); /* permissions are kept */
    expect_text(f->folder, "tags.csv.2", "somebody's own\n");
}

CASE(test_what_was_put_is_put_back)
{
    char *kept, *unkept, *gone;
    struct refusal why;
    assert_true(put(f, "one\n", "two\n", &kept, &why));
    assert_true(tag_file_put_back(&(struct tag_save){ .path = f->path }, kept, &unkept));
    expect_text(f->folder, "tags.csv", "one\n");
    assert_int_equal(access(kept, F_OK), -1);
    assert_false(tag_file_put_back(&(struct tag_save){ .path = f->path }, kept, &unkept));
    assert_non_null(strstr(unkept, "tags.csv cannot be restored from tags.csv.1: No such file"));
    mem_free(unkept);
    mem_free(kept);
    gone = temp_path(f->folder, "none.csv");
    assert_null(tag_file_read(gone, &why));
    assert_int_equal(why.code, REFUSAL_UNREAD_FILE);
    assert_string_equal(why.args, "file=none.csv\nerror=No such file or directory");
}

CASE(test_a_list_that_changed_meanwhile_is_not_written_over)
{
    char *kept;
    struct refusal why;
    assert_false(put(f, "another\n", "two\n", &kept, &why));
    assert_int_equal(why.code, REFUSAL_CHANGED);
    assert_string_equal(why.args, "file=tags.csv");
    expect_text(f->folder, "tags.csv", "one\n");
    char *first = temp_path(f->folder, "tags.csv.1");
    assert_int_equal(access(first, F_OK), -1);
}

/* Saving into a folder that may not be written, as with a service that was given no right to it, must fail with that reason. */
CASE(test_a_folder_that_may_not_be_written_is_said)
{
    char *kept;
    struct refusal why;
    assert_int_equal(chmod(f->folder, 0555), 0);
    bool root = geteuid() == 0;
    if (root)
        assert_int_equal(chown(f->path, NOBODY, NOBODY) | chown(f->folder, NOBODY, NOBODY) | seteuid(NOBODY), 0);
    bool saved = put(f, "one\n", "two\n", &kept, &why);
    if (root)
        assert_int_equal(seteuid(0), 0);
    assert_int_equal(chmod(f->folder, 0755), 0);
    assert_false(saved);
    assert_null(kept);
    assert_int_equal(why.code, REFUSAL_FOLDER_LOCKED);
    assert_string_equal(why.args, "file=tags.csv.1");
    expect_text(f->folder, "tags.csv", "one\n");
}

TEST(test_a_hash_tells_texts_apart)
{
    char one[17], two[17], again[17];
    tag_file_hash("one\n", one);
    tag_file_hash("one", two);
    tag_file_hash("one\n", again);
    assert_int_equal(strlen(one), 16);
    assert_int_equal(strspn(one, "0123456789abcdef"), 16);
    assert_string_equal(one, again);
    assert_string_not_equal(one, two);
}
