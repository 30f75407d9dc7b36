/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads checked fields from a JSON object. Each says in *error what was expected where it does not find it. */
#ifndef MESSAGE_JSON_FIELDS_H
#define MESSAGE_JSON_FIELDS_H
#include "message/message.h"
#include "message/names.h"

/* Missing fields are an error (`need_`), or leave *out alone and return true (`may_`); *given tells them apart where it is not NULL. */
bool need_number(const json_t *o, const char *name, double low, double high, double *out, struct message_error *error);
bool may_number(const json_t *o, const char *name, double low, double high, double *out, bool *given, struct message_error *error);
bool need_seq(const json_t *o, uint32_t *out, struct message_error *error); /* "seq": 1..2^32-1 */
bool need_vector(const json_t *o, const char *name, double out[3], struct message_error *error);
bool may_vector(const json_t *o, const char *name, double out[3], bool *given, struct message_error *error);
bool may_name(const json_t *o, const char *name, const struct name *names, int *out, bool *given, struct message_error *error);
/* A text of 1 to size - 1 printable ASCII characters. */
bool may_text(const json_t *o, const char *name, char *out, size_t size, bool *given, struct message_error *error);
/* Characters that control what stands where on a line, or what is shown at all: controls, and overrides of the direction of writing. */
bool has_controls(const char *text);
/* People's own words: any characters but those, less than size bytes; needed: one that is not a blank at least. */
bool need_words(const json_t *o, const char *name, bool needed, char *out, size_t size, struct message_error *error);
/* What a client wrote, cut and with control characters replaced: fit for a log line or an answer. */
const char *quoted(const char *text, char out[48]);

#endif
