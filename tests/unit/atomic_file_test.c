/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Atomic replacement of files: what readers see meanwhile, what a failure leaves, and that existing files and links are never written
   through. */
#include "base/files/atomic_file.h"

#include "tests/support/test.h"
#include <sys/stat.h>
#include <unistd.h>


#include "base/mem.h"
#include "base/text/text.h"
#include "tests/support/temp.h"

struct atomic_file_fixture {
    char *folder, *path;
};

static int set_up(void **state)
{
    struct atomic_file_fixture *f = mem_new(sizeof(*f));
    f->folder = temp_folder_create();
    f->path = temp_write_text(f->folder, "f", "old");
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct atomic_file_fixture *f = *state;
    temp_folder_destroy(&f->folder);
    mem_free(f->path);
    mem_free(f);
    return 0;
}

#define CASE(name) TEST_ON(struct atomic_file_fixture *f, name, set_up, tear_down)

static void assert_text(const char *path, const char *want)
{
    size_t bytes;
    char *text = text_read_file(path, 100, &bytes);
    assert_string_equal(text, want);
    mem_free(text);
}

static void assert_nothing_beside(const struct atomic_file_fixture *f)
{
    char *look = mem_printf("test -z \"$(ls '%s' | grep new)\"", f->folder);
    assert_int_equal(system(look), 0);
    mem_free(look);
}

CASE(the_old_file_stays_until_the_new_one_is_whole)
{
    struct atomic_file file;
    for (int durable = 0; durable < 2; durable++) {
        assert_int_equal(atomic_file_begin(&file, f->path, 0600), 0);
        assert_int_equal(atomic_file_write(&file, "n", 1), 0);
        assert_int_equal(atomic_file_write(&file, "ew", 2), 0);
        assert_text(f->path, durable ? "new" : "old");
        assert_int_equal(atomic_file_commit(&file, durable), 0);
        atomic_file_abandon(&file); /* does nothing any more */
        assert_text(f->path, "new");
    }
    struct stat st;
    assert_int_equal(stat(f->path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0600);
    assert_nothing_beside(f);
}

CASE(one_that_is_given_up_leaves_nothing)
{
    struct atomic_file file;
    assert_int_equal(atomic_file_begin(&file, f->path, 0600), 0);
    assert_int_equal(atomic_file_write(&file, "x", 1), 0);
    atomic_file_abandon(&file);
    assert_text(f->path, "old");
    assert_nothing_beside(f);
}

/* An attacker puts a link at the temporary file's path, pointing to a file that only this program may write. */
CASE(links_and_files_beside_are_not_written_through)
{
    char *secret = temp_write_text(f->folder, "secret", "secret"), *link = mem_printf("%s.%ld.new", f->path, (long)getpid());
    assert_int_equal(symlink(secret, link), 0);
    assert_int_equal(atomic_file_put(f->path, "new", 3), 0);
    assert_text(f->path, "new");
    assert_text(secret, "secret");
    struct stat st;
    assert_int_equal(lstat(f->path, &st), 0);
    assert_true(S_ISREG(st.st_mode));
    assert_int_equal(unlink(link), 0);
    assert_nothing_beside(f);
    mem_free(secret);
    mem_free(link);
}
