/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages of control-room displays, of desks that send views to them, and of engineers who pair them. Call only in the event loop. */
#ifndef MESSAGE_WALL_MESSAGE_H
#define MESSAGE_WALL_MESSAGE_H
#include "message/message.h"

/* Each function parses one message and stores its content in out->hello.tile, out->wall or out->pair; send_to_wall_parse() also
   writes view and title to out->view_edit. Returns false with *error saying what is wrong. */
/* Reads the optional member `tile` (display of a wall) of the message hello. */
bool tile_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool display_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool send_to_wall_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool point_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool pair_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool unpair_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Carries out the message `send_to_wall`. who: the user's name; now_us: UTC. Returns the answer; free with mem_free(). */
char *send_to_wall_do(struct wall_remote *remote, const struct message *message, const char *who, int64_t now_us);

#endif
