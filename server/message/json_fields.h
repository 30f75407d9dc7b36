/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that read one member of a JSON object and check its type and range. If the member is wrong, each returns false,
   with *error saying what was expected. Pure. Call from any thread. */
#ifndef MESSAGE_JSON_FIELDS_H
#define MESSAGE_JSON_FIELDS_H
#include "message/message.h"
#include "message/names.h"

/* Functions whose names begin with need_ treat a missing member as an error. Functions whose names begin with may_ leave *out
   unchanged if the member is missing, and return true. *given, if not NULL, tells whether the member was present. */
bool need_number(const json_t *o, const char *name, double low, double high, double *out, struct message_error *error);
bool may_number(const json_t *o, const char *name, double low, double high, double *out, bool *given, struct message_error *error);
/* Reads the member "seq", the client's sequence number of the message, an integer in 1..2^32-1. */
bool need_seq(const json_t *o, uint32_t *out, struct message_error *error);
bool need_vector(const json_t *o, const char *name, double out[3], struct message_error *error);
bool may_vector(const json_t *o, const char *name, double out[3], bool *given, struct message_error *error);
/* Reads a member whose text must be a name in a table; *out receives the name's value. */
bool may_name(const json_t *o, const char *name, const struct name *names, int *out, bool *given, struct message_error *error);
/* Reads a text of 1 to size - 1 printable ASCII characters. */
bool may_text(const json_t *o, const char *name, char *out, size_t size, bool *given, struct message_error *error);
/* Reads a member with a user's text, of less than `size` bytes, without control characters (has_controls()). needed: true: an
   empty or blank text is an error. */
bool need_words(const json_t *o, const char *name, bool needed, char *out, size_t size, struct message_error *error);
/* Returns true if the text has characters that would garble a line: control characters, or overrides of the writing direction. */
bool has_controls(const char *text);
/* Copies a client's text into `out` for a log line or an answer: at most 40 bytes, control characters and invalid UTF-8 replaced by '?'.
   Returns `out`. */
const char *quoted(const char *text, char out[48]);

#endif
