/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checked members of a JSON object. Each reader returns false, with *error saying what was expected, where it does not find that.
   Pure; any thread. */
#ifndef MESSAGE_JSON_FIELDS_H
#define MESSAGE_JSON_FIELDS_H
#include "message/message.h"
#include "message/names.h"

/* need_...: a member that is missing is an error. may_...: it leaves *out alone and returns true; *given, where it is not NULL, says
   whether the member was there. */
bool need_number(const json_t *o, const char *name, double low, double high, double *out, struct message_error *error);
bool may_number(const json_t *o, const char *name, double low, double high, double *out, bool *given, struct message_error *error);
/* Reads "seq", an integer of 1..2^32-1. */
bool need_seq(const json_t *o, uint32_t *out, struct message_error *error);
bool need_vector(const json_t *o, const char *name, double out[3], struct message_error *error);
bool may_vector(const json_t *o, const char *name, double out[3], bool *given, struct message_error *error);
/* Reads one of the names, as its value. */
bool may_name(const json_t *o, const char *name, const struct name *names, int *out, bool *given, struct message_error *error);
/* Reads a text of 1 to size - 1 printable ASCII characters. */
bool may_text(const json_t *o, const char *name, char *out, size_t size, bool *given, struct message_error *error);
/* Reads free text of less than size bytes without control characters (has_controls). needed: it must hold more than blanks. */
bool need_words(const json_t *o, const char *name, bool needed, char *out, size_t size, struct message_error *error);
/* Returns whether the text has characters that would disturb a line it is shown in: controls, and overrides of the writing direction. */
bool has_controls(const char *text);
/* Writes a client's text into out, cut, with control characters replaced: fit for a log line or an answer. Returns out. */
const char *quoted(const char *text, char out[48]);

#endif
