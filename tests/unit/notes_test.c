/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notes of users survive a restart, end by themselves or are ended by a user, and are limited in number. The notes that were
   active during a shift can be listed. */
#include "tests/support/test.h"

#include <errno.h>
#include <jansson.h>

#include "views/notes.h"

#define S INT64_C(1000000)
#define NOON (S * 1767268800)

struct notes_fixture {
    struct log *log;
    char *folder, *history, id[NOTE_ID_BYTES];
    struct notes *notes;
};

static void begin(struct notes_fixture *f)
{
    f->log = test_log();
    f->folder = temp_folder();
    f->history = test_printf("%s/history", f->folder);
    f->notes = notes_open(f->log, f->history, NULL);
}

static void end(struct notes_fixture *f)
{
    notes_close(&f->notes);
}

TEST_FIXTURE(struct notes_fixture, begin, end)

#define CASE(name) TEST_ON(struct notes_fixture *f, name, set_up, tear_down)

static void open_again(struct notes_fixture *f)
{
    notes_close(&f->notes);
    f->notes = notes_open(f->log, f->history, NULL);
}

static enum refusal_code add(struct notes_fixture *f, const char *text, int64_t at_us, int64_t until_us)
{
    return notes_add(f->notes, &(struct note){ .text = text, .tag = "TI-1", .until_us = until_us }, "kim", at_us, f->id);
}

/* Frees the message `text`, and asserts which notes it contains. expected: their texts, separated by blanks. */
static void assert_notes(char *text, const char *expected)
{
    char found[400] = "";
    json_t *message = test_json(json_loads(text, 0, NULL)), *list = json_object_get(message, "list");
    for (size_t i = 0; i < json_array_size(list); i++)
        snprintf(found + strlen(found), sizeof(found) - strlen(found), "%s%s", i ? " " : "",
                 json_string_value(json_object_get(json_array_get(list, i), "text")));
    mem_free(text);
    assert_string_equal(found, expected);
}

CASE(a_file_of_a_newer_version_is_not_used)
{
    assert_int_equal(add(f, "pump", NOON, 0), REFUSAL_NONE);
    assert_null(notes_unread_file(f->notes));
    char *path = test_printf("%s/" NOTES_FILE, f->history);
    json_t *file = test_json(json_load_file(path, 0, NULL));
    json_object_set_new(file, "version", json_integer(2));
    assert_int_equal(json_dump_file(file, path, 0), 0);
    open_again(f);
    assert_notes(notes_text(f->notes, NOON), "");
    assert_string_equal(notes_unread_file(f->notes), NOTES_FILE);
    assert_int_equal(add(f, "valve", NOON, 0), REFUSAL_KEPT_UNREAD);
    assert_true(json_equal(file, test_json(json_load_file(path, 0, NULL))));
}

CASE(they_end_by_their_time_or_by_hand)
{
    char first[NOTE_ID_BYTES];
    assert_int_equal(notes_number(f->notes), 0);
    assert_int_equal(add(f, "stays", NOON, 0), REFUSAL_NONE);
    strcpy(first, f->id);
    assert_int_equal(add(f, "hour", NOON, NOON + 3600 * S), REFUSAL_NONE);
    assert_string_not_equal(first, f->id);
    assert_int_not_equal(add(f, "over", NOON, NOON - S), REFUSAL_NONE);
    assert_notes(notes_text(f->notes, NOON + S), "stays hour");
    assert_notes(notes_text_between(f->notes, NOON - S, NOON - S), ""); /* at a time before the notes were written, there are none */
    assert_true(notes_differ(f->notes, NOON - S, NOON + S) && notes_differ(f->notes, NOON + 3600 * S, NOON + S));
    assert_false(notes_differ(f->notes, NOON + S, NOON + 2 * S));
    assert_notes(notes_text(f->notes, NOON + 3600 * S), "stays");
    assert_int_equal(notes_end(f->notes, f->id, "kim", true, NOON + 3601 * S), REFUSAL_NOTELESS); /* the note has ended */
    assert_int_equal(notes_end(f->notes, "n1", "kim", true, NOON), REFUSAL_NOTELESS);
    open_again(f);
    assert_int_equal(notes_end(f->notes, first, "kim", false, NOON + 7200 * S), REFUSAL_NONE);
    open_again(f);
    assert_notes(notes_text(f->notes, NOON + 7200 * S), "");
    assert_notes(notes_text_between(f->notes, NOON + 1800 * S, NOON + 9000 * S), "stays hour");
    assert_notes(notes_text_between(f->notes, NOON + 4000 * S, NOON + 9000 * S), "stays");
    assert_notes(notes_text_between(f->notes, NOON - 4000 * S, NOON - S), "");
}

CASE(another_user_ends_a_note_only_with_the_right_to)
{
    assert_int_equal(add(f, "stays", NOON, 0), REFUSAL_NONE);
    assert_int_equal(notes_end(f->notes, f->id, "lee", false, NOON + S), REFUSAL_NOTE_NOT_OWN);
    assert_notes(notes_text(f->notes, NOON + 2 * S), "stays");
    assert_string_equal(notes_author(f->notes, f->id), "kim");
    assert_null(notes_author(f->notes, "n1"));
    assert_int_equal(notes_end(f->notes, f->id, "lee", true, NOON + 3 * S), REFUSAL_NONE);
    assert_string_equal(notes_author(f->notes, f->id), "kim"); /* the author of an ended note is still known */
    assert_notes(notes_text(f->notes, NOON + 4 * S), "");
    char *text = test_memory(notes_text_between(f->notes, NOON, NOON + S));
    assert_non_null(strstr(text, "\"ended_by\":\"lee\""));
}

CASE(there_is_a_limit)
{
    for (int i = 0; i < NOTES; i++)
        assert_int_equal(add(f, "n", NOON, NOON + 60 * S), REFUSAL_NONE);
    assert_int_not_equal(add(f, "more", NOON, 0), REFUSAL_NONE);
    for (int round = 1; round <= 6; round++)
        for (int i = 0; i < NOTES; i++)
            assert_int_equal(add(f, "n", NOON + round * 100 * S, NOON + (round * 100 + 60) * S), REFUSAL_NONE);
    assert_int_equal(add(f, "last", NOON + 1000 * S, 0), REFUSAL_NONE);
    open_again(f); /* reopening must accept a file with the maximum number of notes */
    char *text = test_memory(notes_text_between(f->notes, 0, INT64_MAX));
    json_t *message = test_json(json_loads(text, 0, NULL));
    assert_int_equal(json_array_size(json_object_get(message, "list")), NOTES_ENDED + 1);
}

CASE(they_are_at_what_they_say)
{
    const double place[3] = { 1, 2.5, -3 };
    assert_int_equal(notes_add(f->notes, &(struct note){ .text = "p", .position_m = place }, "kim", NOON, f->id), REFUSAL_NONE);
    assert_int_equal(notes_add(f->notes, &(struct note){ .text = "a", .asset = "E-1" }, "kim", NOON, f->id), REFUSAL_NONE);
    open_again(f);
    char *text = test_memory(notes_text(f->notes, NOON));
    assert_non_null(strstr(text, "\"position\":[1.0,2.5,-3.0]"));
    assert_non_null(strstr(text, "\"asset\":\"E-1\""));
}

CASE(a_note_of_the_whole_plant_has_no_place)
{
    assert_int_equal(notes_add(f->notes, &(struct note){ .text = "shift" }, "kim", NOON, f->id), REFUSAL_NONE);
    open_again(f);
    char *text = test_memory(notes_text(f->notes, NOON));
    assert_non_null(strstr(text, "shift"));
    assert_null(strstr(text, "position"));
}

CASE(an_author_replaces_a_note_and_the_past_keeps_the_old_one)
{
    char first[NOTE_ID_BYTES];
    assert_int_equal(notes_add(f->notes, &(struct note){ .text = "drips", .asset = "E-1" }, "kim", NOON, f->id), REFUSAL_NONE);
    strcpy(first, f->id);
    const struct note better = { .text = "drips-a-lot", .replaces = first, .until_us = NOON + 3600 * S };
    assert_int_equal(notes_add(f->notes, &better, "lee", NOON + S, f->id), REFUSAL_NOTE_OTHERS);
    assert_int_equal(notes_add(f->notes, &better, "kim", NOON + 10 * S, f->id), REFUSAL_NONE);
    assert_int_equal(notes_add(f->notes, &better, "kim", NOON + 11 * S, f->id), REFUSAL_NOTELESS); /* the first note has ended */
    open_again(f);
    assert_notes(notes_text_between(f->notes, NOON + 5 * S, NOON + 5 * S), "drips");
    assert_notes(notes_text(f->notes, NOON + 20 * S), "drips-a-lot");
    char *text = test_memory(notes_text(f->notes, NOON + 20 * S));
    assert_non_null(strstr(text, "\"asset\":\"E-1\""));
}

CASE(what_cannot_be_read_is_not_written_over)
{
    static const char *const files[] = { "{", "{\"notes\":[{\"id\":\"a\"}]}",
                                         "{\"notes\":[{\"id\":\"a\",\"text\":\"t\",\"by\":\"\",\"time_us\":1}]}" };
    for (size_t i = 0; i < sizeof(files) / sizeof(*files); i++) {
        char *path = temp_write_text(f->folder, "history/" NOTES_FILE, files[i]), text[200] = "";
        open_again(f);
        assert_notes(notes_text(f->notes, NOON), "");
        assert_int_not_equal(add(f, "a", NOON, 0), REFUSAL_NONE);
        FILE *file = fopen(path, "re");
        assert_non_null(file);
        text[fread(text, 1, sizeof(text) - 1, file)] = 0;
        fclose(file);
        assert_string_equal(text, files[i]);
    }
    assert_int_not_equal(notes_add(f->notes, &(struct note){ .text = "\xff", .tag = "t" }, "kim", NOON, f->id), REFUSAL_NONE);
}

static void on_written(void *arg)
{
    (void)arg;
}

static void collect(struct file_writer *writer)
{
    assert_true(file_writer_wait(writer, 60 * NS_PER_S));
    assert_true(file_writer_collect(writer));
}

CASE(a_note_is_shown_once_it_is_on_disk)
{
    struct file_writer *writer = file_writer_start(f->log, on_written, NULL);
    struct notes *notes = notes_open(f->log, f->history, writer);
    const struct note one = { .text = "one", .tag = "t" }, two = { .text = "two", .tag = "t" }, three = { .text = "three", .tag = "t" };
    assert_int_equal(notes_add(notes, &one, "kim", NOON, f->id), REFUSAL_NONE);
    /* the second note is added before the first one is written; both must be in the file afterwards */
    assert_int_equal(notes_add(notes, &two, "kim", NOON, f->id), REFUSAL_NONE);
    assert_notes(notes_text(notes, NOON), "");
    assert_int_equal(notes_number(notes), 0);
    collect(writer);
    assert_notes(notes_text(notes, NOON), "one two");
    assert_int_equal(notes_number(notes), 2);
    char *spoiled = test_printf("rm -r '%s' && : > '%s'", f->history, f->history), *mended = test_printf("rm '%s'", f->history);
    assert_int_equal(system(spoiled), 0);
    struct settling_ticket ticket = file_writer_begin(writer);
    assert_int_equal(notes_end(notes, f->id, "kim", false, NOON + S), REFUSAL_NONE);
    file_writer_end(writer, &ticket);
    collect(writer);
    assert_int_equal(file_writer_settled(writer, &ticket), -ENOTDIR);
    assert_notes(notes_text(notes, NOON + 2 * S), "one two"); /* the change could not be written, so the note "one" is still active */
    assert_int_equal(system(mended), 0);
    assert_int_equal(notes_end(notes, f->id, "kim", false, NOON + S), REFUSAL_NONE);
    assert_int_equal(notes_add(notes, &three, "kim", NOON + S, f->id), REFUSAL_NONE);
    /* closes the notes before the change is written, as a reload of the plant does: the writer must still write it */
    notes_close(&notes);
    file_writer_stop(writer);
    open_again(f);
    assert_notes(notes_text(f->notes, NOON + 2 * S), "one three");
    notes = notes_open(f->log, f->history, writer);
    notes_close(&notes); /* the order at the end of the daemon: the writer has stopped, its users are closed, and then it is destroyed */
    file_writer_destroy(&writer);
}

CASE(without_a_folder_none_is_made)
{
    struct notes *notes = notes_open(f->log, NULL, NULL);
    assert_int_not_equal(notes_add(notes, &(struct note){ .text = "a", .tag = "t" }, "kim", NOON, f->id), REFUSAL_NONE);
    notes_close(&notes);
}
