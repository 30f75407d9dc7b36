/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages `note` and `remove_note`: parses them and carries them out. Call only in the event loop. */
#ifndef MESSAGE_NOTE_MESSAGE_H
#define MESSAGE_NOTE_MESSAGE_H
#include "message/message.h"

/* note_parse() and remove_note_parse() parse the messages into out->note. They return false with *error saying what is wrong. */
bool note_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool remove_note_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Adds a note, or ends an existing note. who: the user's name; may_end_others: the user may also end other users' notes;
   now_us: UTC. Returns the answer; free with mem_free(). */
char *note_do(struct notes *notes, const struct plant *plant, const struct message *message, const char *who, bool may_end_others,
              int64_t now_us);

#endif
