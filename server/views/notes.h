/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What people note at a place, an asset or a tag, until when; in notes.json in the folder of the history. Those that have ended, by their
   time or by hand, are kept for whoever takes over. Thread: the loop. */
#ifndef VIEWS_NOTES_H
#define VIEWS_NOTES_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/refusal.h"

enum { NOTES = 100, NOTES_ENDED = 400 /* of these the newest are kept */, NOTE_TEXT_BYTES = 401, NOTE_ID_BYTES = 24 };
#define NOTES_FILE "notes.json"

struct note {
    const char *text;
    const char *tag, *asset;   /* where it is: one of them, or the position */
    const double *position_m;
    int64_t until_us;          /* UTC; 0: until it is removed */
};

struct notes;
/* Reads the notes. folder: of the history; NULL: none can be made. A file that cannot be read counts as empty (logged) and is not written
   over. Never returns NULL. folder must outlive them. */
struct notes *notes_open(struct log *log, const char *folder);
void notes_close(struct notes **notes); /* &NULL is fine; leaves NULL */
/* Adds a note of a person and writes the file. Returns NULL and its id, or why it could not (static). */
enum refusal_code notes_add(struct notes *notes, const struct note *note, const char *who, int64_t now_us, char id[NOTE_ID_BYTES]);
/* Ends a note and writes the file. Returns NULL, or why it could not (static). */
enum refusal_code notes_end(struct notes *notes, const char *id, const char *who, int64_t now_us);
/* Returns a number that increases with each change; 0: there has been no note. */
uint64_t notes_number(const struct notes *notes);
/* Return the message `notes` with the notes in force at an instant, or with all that were in force in a span of time, with how they ended.
   Free with mem_free. */
char *notes_text(const struct notes *notes, int64_t now_us);
char *notes_text_between(const struct notes *notes, int64_t from_us, int64_t to_us);
/* Returns whether other notes are in force at one instant than at another. */
bool notes_differ(const struct notes *notes, int64_t one_us, int64_t other_us);
/* For a core and its renderers: return the list of notes, which belongs to them; and take it from the other one (false: it
   is none, and nothing changed). */
json_t *notes_list(const struct notes *notes);
bool notes_mirror(struct notes *notes, json_t *list);

#endif
