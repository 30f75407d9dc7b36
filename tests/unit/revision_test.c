/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A revision replaces several files of a plant together. After a kill or a full disk at any step, all files must be old or all
   new. Also tests edits to the plant file's text. */
#include "preprocess/import/revision/revision_files.h"

#include "tests/support/test.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "plant/plant_folder.h"
#include "preprocess/import/revision/asset_edit.h"

/* --- a file system whose renames fail ---------------------------------------------------------------------------------------- */

static int steps_left = -1; /* -1: none fails */
static bool kills;

/* Replaces the C library's rename(), so that tests can let a rename fail or kill the process. */
int rename(const char *from, const char *to)
{
    if (steps_left == 0 && kills)
        kill(getpid(), SIGKILL);
    if (steps_left == 0) {
        errno = ENOSPC;
        return -1;
    }
    steps_left -= steps_left > 0;
    return (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}

/* --- files ------------------------------------------------------------------------------------------------------------------- */

static const char *const names[] = { "model.glb", "tags.csv", "plant.yaml", "new.glb" };
enum { FILES = 4, PLANT = 2, WERE = 3 };

static void begin(const char *folder)
{
    for (int i = 0; i < WERE; i++)
        temp_write_text(folder, names[i], "old");
    char *lists = test_printf("%s/lists", folder);
    mkdir(lists, 0777);
    temp_write_text(lists, "tags.csv", "old");
    temp_write_text(folder, "matches.csv", "old");
}

static int take(const char *folder, const char *own)
{
    char *why = NULL;
    int lock = plant_folder_lock(&(struct plant_folder_params){ .folder = folder, .own = own }, &why);
    mem_free(why);
    return lock;
}

/* Applies a revision to the plant in `folder`. In addition to the usual files, it replaces a tag list in a subfolder and
   contains one file that does not change. */
static int apply_to(const char *folder, const char *plant_as_read)
{
    char *own = test_printf("%s/.import-1", folder), *list = test_printf("%s/lists/tags.csv", folder);
    struct revision_file files[FILES + 2];
    const char *changed = NULL;
    mkdir(own, 0777);
    int lock = take(folder, own);
    for (int i = 0; i < FILES; i++)
        files[i] = (struct revision_file){ names[i], temp_write_text(own, names[i], "new"), i == PLANT ? plant_as_read : NULL };
    files[FILES] = (struct revision_file){ list, temp_write_text(own, "list", "new"), "old" };
    files[FILES + 1] = (struct revision_file){ "matches.csv", NULL, "old" };
    int status = lock < 0 ? lock : revision_files_apply(folder, own, files, FILES + 2, &changed);
    if (status == -ESTALE)
        assert_string_equal(changed, "plant.yaml");
    if (lock >= 0)
        close(lock);
    return status;
}

static int apply(const char *folder)
{
    return apply_to(folder, NULL);
}

static int undo(const char *folder, bool forced)
{
    struct text *changed = test_text(), *done = test_text();
    int lock = take(folder, NULL), status = lock < 0 ? lock : revision_files_undo(folder, forced, changed, done);
    if (lock >= 0)
        close(lock);
    return status;
}

static bool says(const char *folder, const char *name, const char *text)
{
    size_t bytes;
    char *path = test_printf("%s/%s", folder, name), *now = test_memory(text_read_file(path, 100, &bytes));
    bool same = text ? now && !strcmp(now, text) : !now;
    return same;
}

static bool all(const char *folder, bool new)
{
    bool good = true;
    for (int i = 0; i < FILES; i++)
        good &= says(folder, names[i], new ? "new" : i < WERE ? "old" : NULL);
    return good && says(folder, "lists/tags.csv", new ? "new" : "old") && says(folder, "matches.csv", "old");
}

/* --- tests ------------------------------------------------------------------------------------------------------------------- */

TEST(all_files_come_and_go_together)
{
    char *folder = temp_folder();
    begin(folder);
    assert_int_equal(apply(folder), 0);
    assert_true(all(folder, true));
    assert_int_equal(undo(folder, false), 0);
    assert_true(all(folder, false));
    assert_int_equal(undo(folder, false), -ENOENT);
    assert_true(all(folder, false));
}

TEST(what_people_changed_since_is_not_undone_unless_forced)
{
    char *folder = temp_folder();
    begin(folder);
    assert_int_equal(apply(folder), 0);
    temp_write_text(folder, "tags.csv", "mine");
    assert_int_equal(undo(folder, false), -EBUSY);
    assert_true(says(folder, "tags.csv", "mine") && says(folder, "plant.yaml", "new"));
    assert_int_equal(undo(folder, true), 0);
    assert_true(all(folder, false));
    assert_true(says(folder, "tags.csv.undone", "mine"));
}

TEST(what_was_saved_meanwhile_is_not_replaced)
{
    char *folder = temp_folder();
    begin(folder);
    temp_write_text(folder, "plant.yaml", "mine");
    assert_int_equal(apply_to(folder, "old"), -ESTALE);
    assert_true(says(folder, "plant.yaml", "mine") && says(folder, "model.glb", "old") && says(folder, "lists/tags.csv", "old"));
    assert_int_equal(undo(folder, false), -ENOENT);
}

TEST(what_only_was_remembered_comes_back_too)
{
    char *folder = temp_folder();
    begin(folder);
    assert_int_equal(apply(folder), 0);
    temp_write_text(folder, "matches.csv", "others'");
    assert_int_equal(undo(folder, false), -EBUSY);
    assert_int_equal(undo(folder, true), 0);
    assert_true(all(folder, false));
    assert_true(says(folder, "matches.csv.undone", "others'"));
}

TEST(rights_of_a_file_stay)
{
    char *folder = temp_folder(), *path;
    struct stat st;
    begin(folder);
    path = test_printf("%s/plant.yaml", folder);
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(apply(folder), 0);
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0640);
}

/* Applies a revision, or undoes it, in a child process whose rename number `step` fails or kills the process. Returns true if
   the process finished before that rename. */
static bool run_until(const char *folder, bool undoing, int step, bool killed)
{
    int status;
    pid_t child = fork();
    if (child == 0) {
        steps_left = step;
        kills = killed;
        _exit((undoing ? undo(folder, false) : apply(folder)) == 0 ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static void fail_each_step(bool killed)
{
    for (int undoing = 0; undoing < 2; undoing++) {
        bool ended = false;
        int step = 0;
        for (; !ended; step++) {
            char *folder = temp_folder();
            begin(folder);
            if (undoing)
                assert_int_equal(apply(folder), 0);
            ended = run_until(folder, undoing, step, killed);
            /* takes the lock, as the next program does, which completes or undoes the interrupted revision */
            int lock = take(folder, NULL);
            assert_true(lock >= 0);
            close(lock);
            bool new = all(folder, true);
            assert_true(new || all(folder, false));
            assert_true(!ended || new == !undoing);
            if (new) { /* if the revision was applied, it must be possible to undo it */
                assert_int_equal(undo(folder, false), 0);
                assert_true(all(folder, false));
            }
        }
        assert_true(step >= 5);
    }
}

TEST(killed_at_any_step_it_is_all_or_nothing)
{
    fail_each_step(true);
}

TEST(out_of_disk_at_any_step_it_is_all_or_nothing)
{
    fail_each_step(false);
}

TEST(an_undoing_that_was_killed_while_tidying_up_is_done)
{
    char *folder = temp_folder(), *left = test_printf("%s/.revision.undoing", folder), *old = test_printf("%s/old", left);
    assert_int_equal(mkdir(left, 0777), 0);
    assert_int_equal(mkdir(old, 0777), 0);
    int lock = take(folder, NULL);
    assert_true(lock >= 0);
    close(lock);
    assert_int_not_equal(access(left, F_OK), 0);
}

TEST(one_program_at_a_time)
{
    char *folder = temp_folder();
    int lock = take(folder, NULL);
    assert_true(lock >= 0);
    assert_int_equal(take(folder, NULL), -EWOULDBLOCK);
    close(lock);
}

TEST(the_plant_file_stays_as_people_wrote_it)
{
    static const char text[] = "plant: { name: \"Größe\" }\n"
                               "assets:\n"
                               "  # the feed\n"
                               "  - { id: E-101, model: m.glb, nodes: \"E-101\" } # ours\n"
                               "  - id: P-1\n"
                               "    model: m.glb\n"
                               "    # two of them\n"
                               "    nodes:\n"
                               "      - P-1*\n"
                               "      - '#7'\n"
                               "  - { id: V-1, model: m.glb, nodes: [A, B] }\n"
                               "  - { id: gone,\n"
                               "      model: m.glb }\n"
                               "\n"
                               "# end\n"
                               "tags: tags.csv\n";
    char *pump[] = { NULL, mem_strdup("#9") }, *vessel[] = { mem_strdup("A \"x\""), mem_strdup("B") }, why[ASSET_EDIT_WHY_BYTES];
    const struct asset_edit edits[] = {
        { .tag = mem_strdup("E-102") }, { .nodes = pump, .node_count = 2 }, { .nodes = vessel, .node_count = 2 }, { .removed = true }
    };
    char *out = test_memory(asset_edit_apply(text, edits, 4, "  - { id: \"new\" }\n", why));
    assert_string_equal(out, "plant: { name: \"Größe\" }\n"
                             "assets:\n"
                             "  # the feed\n"
                             "  - { id: E-101, tag: \"E-102\", model: m.glb, nodes: \"E-101\" } # ours\n"
                             "  - id: P-1\n"
                             "    model: m.glb\n"
                             "    # two of them\n"
                             "    nodes:\n"
                             "      - \"#9\"\n"
                             "  - { id: V-1, model: m.glb, nodes: [\"A \\\"x\\\"\", \"B\"] }\n"
                             "  - { id: \"new\" }\n"
                             "\n"
                             "# end\n"
                             "tags: tags.csv\n");
    const struct asset_edit several = { .nodes = (char *[]){ "A\nB" }, .node_count = 1 };
    assert_string_equal(test_memory(asset_edit_apply("assets:\n  - id: a\n    nodes:\n      - P* # ours\n", &several, 1, NULL, why)),
                        "assets:\n  - id: a\n    nodes:\n      - \"A\"\n      - \"B\" # ours\n");
    assert_string_equal(test_memory(asset_edit_apply("assets:\n  - { id: a, nodes: P* }\n", &several, 1, NULL, why)),
                        "assets:\n  - { id: a, nodes: [\"A\", \"B\"] }\n");
    assert_null(asset_edit_apply("assets: [{ id: a }]\n", &(struct asset_edit){ .removed = true }, 1, NULL, why));
    assert_string_equal(why, "import can edit the lists `assets` and `nodes` in the plant file only if each item is on a line of its own");
    mem_free(pump[1]);
    mem_free(vessel[0]);
    mem_free(vessel[1]);
    mem_free(edits[0].tag);
}

TEST(an_asset_goes_with_all_its_keys)
{
    static const char text[] = "assets:\n"
                               "  - id: P-1\n"
                               "    model: m.glb\n"
                               "\n"
                               "  - id: gone\n"
                               "    model: m.glb\n"
                               "\n"
                               "# its tag\n"
                               "    tag: G\n"
                               "\n"
                               "  # the vessel\n"
                               "  - id: V-1\n"
                               "    model: m.glb\n"
                               "  - { id: gone too,\n"
                               "\n"
                               "      model: m.glb\n"
                               "    }\n"
                               "tags: tags.csv\n";
    const struct asset_edit edits[] = { { 0 }, { .removed = true }, { 0 }, { .removed = true } };
    char why[ASSET_EDIT_WHY_BYTES], *out = test_memory(asset_edit_apply(text, edits, 4, NULL, why));
    assert_string_equal(out, "assets:\n"
                             "  - id: P-1\n"
                             "    model: m.glb\n"
                             "\n"
                             "\n"
                             "  # the vessel\n"
                             "  - id: V-1\n"
                             "    model: m.glb\n"
                             "tags: tags.csv\n");
}
