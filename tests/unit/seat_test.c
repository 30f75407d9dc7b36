/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A core's seat (its unique identity): kept across restarts, never shared, and not copied with its folder. */
#include "tests/support/test.h"
#include <unistd.h>

#include "base/mem.h"
#include "corelink/seat.h"

static char folder[] = "/tmp/seat_test.XXXXXX";

static void take(struct seat *seat, char id[9])
{
    char *why = seat_take(seat, folder);
    assert_null(why);
    assert_int_equal(strlen(seat->id), 8);
    memcpy(id, seat->id, 9);
}

TEST(it_is_kept_and_never_shared)
{
    struct seat seat = { 0 }, other = { 0 };
    char first[9], again[9];
    take(&seat, first);
    char *why = seat_take(&other, folder);
    assert_non_null(why);
    assert_non_null(strstr(why, folder));
    assert_non_null(strstr(why, "another core"));
    mem_free(why);
    seat_leave(&seat);
    take(&seat, again);
    assert_string_equal(again, first);
    seat_leave(&seat);
}

/* The same text in another file, as `cp -a` leaves it. */
TEST(a_copy_is_another)
{
    struct seat seat = { 0 };
    char first[9], again[9], line[128];
    take(&seat, first);
    char *path = mem_printf("%s/node", folder), *copy = mem_printf("%s/copy", folder);
    FILE *in = fopen(path, "r"), *out = fopen(copy, "w");
    assert_non_null(fgets(line, sizeof(line), in));
    fputs(line, out);
    fclose(in);
    fclose(out);
    seat_leave(&seat);
    assert_int_equal(rename(copy, path), 0);
    take(&seat, again);
    assert_string_not_equal(again, first);
    seat_leave(&seat);
    take(&seat, first);
    assert_string_equal(again, first);
    seat_leave(&seat);
    mem_free(path);
    mem_free(copy);
}

TEST(what_it_cannot_read_is_made_anew_and_no_folder_is_said)
{
    struct seat seat = { 0 };
    char id[9], *path = mem_printf("%s/node", folder);
    FILE *file = fopen(path, "w");
    fputs("no seat at all, and much longer than what stands here is ever going to be, by a good deal", file);
    fclose(file);
    take(&seat, id);
    seat_leave(&seat);
    char *why = seat_take(&seat, "/dev/null/none");
    assert_non_null(why);
    assert_non_null(strstr(why, "/dev/null/none/node"));
    mem_free(why);
    unlink(path);
    mem_free(path);
}

int main(void)
{
    if (!mkdtemp(folder))
        return 1;
    int failed = tests_run(NULL);
    rmdir(folder);
    return failed;
}
