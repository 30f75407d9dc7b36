/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes the frames that a daemon sends to a session. Call from one thread at a time. */
#ifndef LINK_DECODER_H
#define LINK_DECODER_H
#include <stdbool.h>

#include "h264_decoder.h"
#include "protocol/wire.h"

#define DECODER_WHY_BYTES H264_DECODER_WHY_BYTES

struct decoder;
/* Creates a decoder for all codecs of this build. Returns NULL when out of memory. The caller destroys it. */
struct decoder *decoder_create(void);
/* Frees the decoder. &NULL is fine; sets *decoder to NULL. */
void decoder_destroy(struct decoder **decoder);
/* Decodes one frame. Returns false if its data is invalid, or if this build lacks its codec. */
bool decoder_decode(struct decoder *decoder, const struct wire_frame *frame, const uint8_t *payload);
/* Returns true if this build can decode the codec on this machine; if not, `why` receives the reason. */
bool decoder_has(enum wire_codec codec, char why[DECODER_WHY_BYTES]);

#endif
