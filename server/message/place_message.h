/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages by which engineers move sensors on trial, accept assumed places, and save the tag list. Call only in the event loop. */
#ifndef MESSAGE_PLACE_MESSAGE_H
#define MESSAGE_PLACE_MESSAGE_H
#include "message/message.h"
#include "placing/tag_file.h"

/* Each function parses one message and stores its content in `out`: in the member place, coverage, confirm, accept or kept.
   Returns false with *error saying what is wrong. */
bool place_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool coverage_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool save_tags_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool accept_places_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool restore_tags_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);

/* Returns `placed`, the answer to `place`. It lists the sensors that the user moved to try out other positions, with these
   positions; free with mem_free(). */
char *placed_text(const struct plant *plant, const struct place_set *set, uint32_t seq);
/* Returns `gaps`, the answer to `coverage`. It says how much of each asset's surface is too far from every sensor, or has no
   data; free with mem_free(). */
char *coverage_text(const struct scene *scene, const struct place_set *set, const struct sensor_coverage_answer *answer);
/* Returns how a message would change the current tag list, `before`, for the client to show and confirm; free with mem_free().
   The message is save_tags (applies the new positions of the sensors in `set`), accept_places or restore_tags (`set` is NULL
   for both). If the message already confirms the resulting list by its hash, *order receives a request to save it
   (tag_save_free), otherwise NULL. who: the user's name. */
char *tags_diff_text(const struct scene *scene, const char *before, const struct place_set *set, const struct message *message,
                     const char *who, struct tag_save **order);
/* Returns the message `tags_saved` with the reason why a tag list could not be saved; free with mem_free(). */
char *tags_refused_text(uint32_t seq, const struct refusal *why);

#endif
