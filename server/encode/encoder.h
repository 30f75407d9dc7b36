/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encoders: turn frames into packets. Call from one thread at a time per encoder (a worker). */
#ifndef ENCODE_ENCODER_H
#define ENCODE_ENCODER_H
#include "base/log/log.h"
#include "base/workers.h"
#include "encode/packet.h"

#define ENCODER_H264_LIBRARY "libx264" /* default encoder in libavcodec */

struct encoder;
struct encoder_params {
    int quality;             /* quality of encoding, from 1 (worst) to 100 (best), for codecs that have a quality setting */
    bool full_chroma;        /* true: chroma at full resolution (4:4:4) instead of subsampled (4:2:0), for codecs that have both */
    bool key;                /* true: encode a key frame, whose packet can be decoded without earlier packets */
    struct workers *workers; /* threads for encoding in parallel; may be NULL */
    /* frame that the client currently shows, sent in the same quality: only regions that differ from it are encoded. NULL:
       unknown, so everything is encoded */
    struct frame *before;
};

/* Creates an encoder. name: "jpeg", "png" or, unless left out of the build, "h264"; H.264 packets depend on each other, so each
   stream needs its own encoder. library: the libavcodec encoder for H.264. On failure, logs the reason and returns NULL. */
struct encoder *encoder_create(struct log *log, const char *name, const char *library);
void encoder_destroy(struct encoder **encoder); /* frees the encoder and sets *encoder to NULL; accepts a pointer to NULL */
/* Encodes a frame. Returns 0; -EAGAIN: call encoder_receive() first; another negative value: the frame cannot be encoded (logged). */
int encoder_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params);
/* Gets the next packet. Returns 0, and the caller owns *out (packet_unref()); -EAGAIN: no packet is ready, because no frame was
   sent or the frame equals params.before. */
int encoder_receive(struct encoder *encoder, struct packet **out);
/* Returns true if packets of this codec, except key frames, depend on earlier packets. */
bool encoder_is_stream(const char *name);
/* Returns true if a codec works on this machine, tested by encoding a small frame. Logs a failure, unless the codec is not in
   this build. */
bool encoder_works(struct log *log, const char *name, const char *library);

#endif
