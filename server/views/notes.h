/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notes of users on a position, an asset, a tag or the whole plant, with an optional end; stored in notes.json in the history's
 * folder. Notes that have expired or been removed stay in the file for the next shift. Call only in the event loop. */
#ifndef VIEWS_NOTES_H
#define VIEWS_NOTES_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/files/file_writer.h"
#include "base/refusal.h"

/* NOTES: maximum number of active notes; NOTES_ENDED: maximum number of ended notes that are stored, the newest ones */
enum { NOTES = 100, NOTES_ENDED = 400, NOTE_TEXT_BYTES = 401, NOTE_ID_BYTES = 24 };
#define NOTES_FILE "notes.json"

struct note {
    const char *text;
    /* place of the note: at most one of a tag, the id of an asset, and a position; all NULL: the whole plant */
    const char *tag, *asset;
    const double *position_m;
    /* id of an active note of the same user that this note replaces: that note ends, and the new note is attached to the same
       tag, asset or position (the members above are ignored); NULL: this note replaces none */
    const char *replaces;
    int64_t until_us; /* time at which the note ends, UTC in microseconds; 0: it has no end */
};

struct notes;
/* Reads the notes. folder: the history's folder; NULL: no notes can be made. An unreadable file counts as empty (logged) and is not
   overwritten. Never returns NULL. `folder` must outlive the notes. */
struct notes *notes_open(struct log *log, const char *folder, struct file_writer *writer);
void notes_close(struct notes **notes); /* Frees the notes and sets *notes to NULL. *notes may be NULL. */
/* Returns the name of the file (static) if it could not be read; otherwise NULL. */
const char *notes_unread_file(const struct notes *notes);
/* Adds a user's note and queues the file (kept_list_put()). Returns REFUSAL_NONE with the note's id, or why it failed. */
enum refusal_code notes_add(struct notes *notes, const struct note *note, const char *who, int64_t now_us, char id[NOTE_ID_BYTES]);
/* Ends a note and queues the file (kept_list_put()). may_end_others: the user may also end notes that other users wrote. Returns
   REFUSAL_NONE, or why it failed. */
enum refusal_code notes_end(struct notes *notes, const char *id, const char *who, bool may_end_others, int64_t now_us);
/* Returns the author of an active or ended note; NULL if no such note is stored. The name is valid until the notes change. */
const char *notes_author(const struct notes *notes, const char *id);
/* Returns a counter that increases with each change of the notes; 0: there has been no note. */
uint64_t notes_number(const struct notes *notes);
/* Return the message `notes`. notes_text() includes the notes valid at an instant, notes_text_between() all notes valid at some
 * time between two instants, and how they ended. The caller frees the text (mem_free()). */
char *notes_text(const struct notes *notes, int64_t now_us);
char *notes_text_between(const struct notes *notes, int64_t from_us, int64_t to_us);
/* Returns whether the notes valid at one instant differ from those valid at the other. */
bool notes_differ(const struct notes *notes, int64_t one_us, int64_t other_us);
/* For the connection between a core and its renderers. notes_list() returns the list of notes, owned by `notes`. notes_mirror()
   replaces the list with that of the other daemon; it returns false, with nothing changed, if that list is invalid. */
json_t *notes_list(const struct notes *notes);
bool notes_mirror(struct notes *notes, json_t *list);

#endif
