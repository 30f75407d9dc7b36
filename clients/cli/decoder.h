/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes what a session sends. Thread: one at a time. */
#ifndef CLI_DECODER_H
#define CLI_DECODER_H
#include <stdbool.h>

#include "protocol/wire.h"

struct decoder;
struct decoder *decoder_create(void); /* NULL: out of memory */
void decoder_destroy(struct decoder **decoder);
/* False: this is no such picture, or of a codec that is not in this build. */
bool decoder_decode(struct decoder *decoder, const struct wire_frame *frame, const uint8_t *payload);
bool decoder_has(enum wire_codec codec);

#endif
