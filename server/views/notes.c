/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the notes that users attach to tags, assets and positions, in order of creation. */
#include "views/notes.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "views/kept_list.h"

struct notes {
    struct kept_list
        /* form of an entry: { id, text, tag or asset or position or none, by, time_us, until_us, ended_us, ended_by }; times that are
           absent are 0 */
        kept;
};

static int64_t time_of(const json_t *note, const char *name)
{
    return json_integer_value(json_object_get(note, name));
}

/* Returns when a note ends or ended, UTC in microseconds; 0: it has no end, and no user has ended it. */
static int64_t end_of(const json_t *note)
{
    int64_t until_us = time_of(note, "until_us"), ended_us = time_of(note, "ended_us");
    return ended_us && (!until_us || ended_us < until_us) ? ended_us : until_us;
}

static bool has_ended(const json_t *note, int64_t now_us)
{
    int64_t end_us = end_of(note);
    return end_us && end_us <= now_us;
}

static bool good_place(const json_t *note)
{
    const json_t *position = json_object_get(note, "position");
    if (!position || json_is_string(json_object_get(note, "tag")) || json_is_string(json_object_get(note, "asset")))
        return true;
    return json_array_size(position) == 3 && json_is_number(json_array_get(position, 0)) && json_is_number(json_array_get(position, 1)) &&
           json_is_number(json_array_get(position, 2));
}

static bool good_note(const json_t *note)
{
    return json_string_length(json_object_get(note, "id")) < NOTE_ID_BYTES &&
           json_string_length(json_object_get(note, "text")) < NOTE_TEXT_BYTES && good_place(note);
}

static const struct kept_list_kind KIND = {
    NOTES_FILE, "notes", "the keys id, text, by, time_us, until_us and ended_us",
    NOTES + NOTES_ENDED, { "id", "text", "by" }, { "time_us", "until_us", "ended_us" }, good_note
};

struct notes *notes_open(struct log *log, const char *folder, struct file_writer *writer)
{
    struct notes *notes = mem_new(sizeof(*notes));
    kept_list_open(&notes->kept, log, folder, &KIND, writer);
    return notes;
}

void notes_close(struct notes **pointer)
{
    struct notes *notes = *pointer;
    if (!notes)
        return;
    kept_list_close(&notes->kept);
    mem_free(notes);
    *pointer = NULL;
}

const char *notes_unread_file(const struct notes *notes)
{
    return kept_list_unread_file(&notes->kept);
}

static size_t count(const json_t *list, int64_t now_us, bool ended)
{
    size_t found = 0;
    for (size_t i = 0; i < json_array_size(list); i++)
        found += has_ended(json_array_get(list, i), now_us) == ended;
    return found;
}

static void forget_oldest(json_t *list, int64_t now_us)
{
    for (size_t ended = count(list, now_us, true), i = 0; ended > NOTES_ENDED && i < json_array_size(list);)
        if (has_ended(json_array_get(list, i), now_us)) {
            json_array_remove(list, i);
            ended--;
        } else {
            i++;
        }
}

/* Makes the id of a note from its time. If another note already has that id (made at the same time, or before the clock was set
   back), takes the next free id. */
static void make_id(const json_t *list, int64_t now_us, char id[NOTE_ID_BYTES])
{
    do
        snprintf(id, NOTE_ID_BYTES, "n%lld", (long long)now_us++);
    while (kept_list_find(list, id) < json_array_size(list));
}

/* Finds the note that `id` names, if it is active, and sets *at to its index. Returns REFUSAL_NONE, or why the note cannot be changed. */
static enum refusal_code find_in_force(const json_t *list, const char *id, int64_t now_us, size_t *at)
{
    *at = kept_list_find(list, id);
    return *at == json_array_size(list) || has_ended(json_array_get(list, *at), now_us) ? REFUSAL_NOTELESS : REFUSAL_NONE;
}

static const char *author_of(const json_t *note)
{
    return json_string_value(json_object_get(note, "by"));
}

/* Replaces the note at an index by a copy that ends now. */
static void end_at(json_t *list, size_t at, const char *who, int64_t now_us)
{
    json_t *note = json_copy(json_array_get(list, at)), *by = json_string(who);
    json_object_set_new(note, "ended_us", json_integer(now_us));
    json_object_set_new(note, "ended_by", by ? by : json_string(""));
    json_array_set_new(list, at, note);
}

/* Attaches a new note to the same tag, asset or position as the note that it replaces, or to the one that the user chose. */
static void set_place(json_t *entry, const struct note *note, const json_t *replaced)
{
    static const char *const members[] = { "tag", "asset", "position" };
    for (size_t i = 0; i < 3; i++)
        if (json_object_get(replaced, members[i]))
            json_object_set(entry, members[i], json_object_get(replaced, members[i]));
    if (!replaced && note->position_m)
        json_object_set_new(entry, "position", json_pack("[f,f,f]", note->position_m[0], note->position_m[1], note->position_m[2]));
    else if (!replaced && (note->tag || note->asset))
        json_object_set_new(entry, note->tag ? "tag" : "asset", json_string(note->tag ? note->tag : note->asset));
}

enum refusal_code notes_add(struct notes *notes, const struct note *note, const char *who, int64_t now_us, char id[NOTE_ID_BYTES])
{
    enum refusal_code why = kept_list_refusal(&notes->kept);
    json_t *newest = kept_list_newest(&notes->kept), *replaced = NULL;
    size_t at = 0;
    if (!why && note->replaces)
        why = find_in_force(newest, note->replaces, now_us, &at);
    if (why)
        return why;
    if (note->replaces)
        replaced = json_array_get(newest, at);
    if (replaced && strcmp(author_of(replaced), who) != 0)
        return REFUSAL_NOTE_OTHERS;
    if (!replaced && count(newest, now_us, false) >= NOTES)
        return REFUSAL_NOTES;
    if (note->until_us && note->until_us <= now_us)
        return REFUSAL_NOTE_ENDED;
    make_id(newest, now_us, id);
    json_t *entry = json_pack("{s:s,s:s,s:s,s:I,s:I,s:I,s:s}", "id", id, "text", note->text, "by", who, "time_us", (json_int_t)now_us,
                              "until_us", (json_int_t)note->until_us, "ended_us", (json_int_t)0, "ended_by", "");
    if (!entry)
        return REFUSAL_NOT_UTF8;
    set_place(entry, note, replaced);
    json_t *list = json_copy(newest);
    if (replaced)
        end_at(list, at, who, now_us);
    json_array_append_new(list, entry);
    forget_oldest(list, now_us);
    return kept_list_put(&notes->kept, list);
}

enum refusal_code notes_end(struct notes *notes, const char *id, const char *who, bool may_end_others, int64_t now_us)
{
    enum refusal_code why = kept_list_refusal(&notes->kept);
    json_t *newest = kept_list_newest(&notes->kept);
    size_t at;
    if (!why)
        why = find_in_force(newest, id, now_us, &at);
    if (why)
        return why;
    if (!may_end_others && strcmp(author_of(json_array_get(newest, at)), who) != 0)
        return REFUSAL_NOTE_NOT_OWN;
    json_t *list = json_copy(newest);
    end_at(list, at, who, now_us);
    forget_oldest(list, now_us);
    return kept_list_put(&notes->kept, list);
}

const char *notes_author(const struct notes *notes, const char *id)
{
    const json_t *newest = kept_list_newest(&notes->kept);
    return author_of(json_array_get(newest, kept_list_find(newest, id)));
}

uint64_t notes_number(const struct notes *notes)
{
    return notes->kept.number;
}

static char *text_of(const json_t *list, int64_t from_us, int64_t to_us)
{
    json_t *found = json_array();
    for (size_t i = 0; i < json_array_size(list); i++) {
        json_t *note = json_array_get(list, i);
        if (time_of(note, "time_us") <= to_us && !has_ended(note, from_us))
            json_array_append(found, note);
    }
    return json_text(json_pack("{s:s,s:o}", "type", "notes", "list", found), 0);
}

char *notes_text(const struct notes *notes, int64_t now_us)
{
    return text_of(notes->kept.list, now_us, INT64_MAX);
}

static bool in_force(const json_t *note, int64_t at_us)
{
    return time_of(note, "time_us") <= at_us && !has_ended(note, at_us);
}

bool notes_differ(const struct notes *notes, int64_t one_us, int64_t other_us)
{
    size_t i = 0, all = json_array_size(notes->kept.list);
    while (i < all && in_force(json_array_get(notes->kept.list, i), one_us) == in_force(json_array_get(notes->kept.list, i), other_us))
        i++;
    return i < all;
}

char *notes_text_between(const struct notes *notes, int64_t from_us, int64_t to_us)
{
    return text_of(notes->kept.list, from_us, to_us);
}

json_t *notes_list(const struct notes *notes)
{
    return notes->kept.list;
}

bool notes_mirror(struct notes *notes, json_t *list)
{
    return kept_list_mirror(&notes->kept, list);
}
