/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Placing sensors in words: what engineers say, and what they are told. Thread: the loop. */
#ifndef MESSAGE_PLACE_MESSAGE_H
#define MESSAGE_PLACE_MESSAGE_H
#include "message/message.h"
#include "placing/tag_file.h"

bool place_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool gaps_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool save_tags_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);

/* All texts: mem_free. */
char *placed_text(const struct plant *plant, const struct place_set *set, uint32_t seq);
char *gaps_text(const struct scene *scene, const struct place_set *set, const struct sensor_coverage_answer *answer);
/* What a list with the moves of the set in it would be: the difference, for somebody to confirm; and, where they confirmed that very one,
   the order to put it in force (tag_save_free). before: the list in force. */
char *tags_diff_text(const struct plant *plant, const char *before, const struct place_set *set, const struct message *message,
                     const char *who, struct tag_save **order);
char *tags_saved_text(uint32_t seq, bool saved, const char *why);

#endif
