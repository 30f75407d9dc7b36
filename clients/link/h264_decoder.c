/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes H.264 with libavcodec, on the processor or with VA-API. */
#include "h264_decoder.h"

#include <libavcodec/avcodec.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"

/* on machines with at least MANY_CORES cores, the slices of a frame are decoded in parallel, as browsers do */
enum { MANY_CORES = 8, SLICE_THREADS = 8 };

struct h264_decoder {
    const AVCodec *codec;
    AVCodecContext *context; /* NULL: not opened yet */
    AVPacket *packet;
    AVFrame *picture;
};

static bool begin(struct h264_decoder *decoder)
{
    if (decoder->context)
        return true;
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    decoder->packet = av_packet_alloc();
    decoder->picture = av_frame_alloc();
    decoder->context = avcodec_alloc_context3(decoder->codec);
    if (!decoder->packet || !decoder->picture || !decoder->context)
        return false;
    decoder->context->flags |= AV_CODEC_FLAG_LOW_DELAY;
    decoder->context->thread_type = FF_THREAD_SLICE;
    decoder->context->thread_count = cores >= MANY_CORES ? SLICE_THREADS : 1;
    return avcodec_open2(decoder->context, NULL, NULL) == 0;
}

static void take_picture(const struct h264_decoder *decoder, struct h264_decoded *out)
{
    const AVFrame *p = decoder->picture;
    *out = (struct h264_decoded){ .at = { p->data[0], p->data[1], p->data[2] },
                                  .pitches = { p->linesize[0], p->linesize[1], p->linesize[2] },
                                  .width_px = p->width,
                                  .height_px = p->height };
}

static bool decode(struct h264_decoder *decoder, const uint8_t *bytes, size_t count, struct h264_decoded *out)
{
    if (!begin(decoder) || av_new_packet(decoder->packet, (int)count) != 0)
        return false;
    memcpy(decoder->packet->data, bytes, count);
    int status = avcodec_send_packet(decoder->context, decoder->packet);
    av_packet_unref(decoder->packet);
    if (status != 0 || avcodec_receive_frame(decoder->context, decoder->picture) != 0)
        return false;
    take_picture(decoder, out);
    return true;
}

static struct h264_decoder *create(char why[H264_DECODER_WHY_BYTES])
{
    struct h264_decoder *decoder = mem_new(sizeof(*decoder));
    decoder->codec = avcodec_find_decoder(AV_CODEC_ID_H264);
    if (decoder->codec)
        return decoder;
    snprintf(why, H264_DECODER_WHY_BYTES, "libavcodec on this machine cannot decode H.264");
    mem_free(decoder);
    return NULL;
}

static void destroy(struct h264_decoder **pointer)
{
    struct h264_decoder *decoder = *pointer;
    if (!decoder)
        return;
    avcodec_free_context(&decoder->context);
    av_packet_free(&decoder->packet);
    av_frame_free(&decoder->picture);
    mem_free(decoder);
    *pointer = NULL;
}

const struct h264_decoder_functions *h264_decoder_functions(char why[H264_DECODER_WHY_BYTES])
{
    static const struct h264_decoder_functions functions = { .create = create, .destroy = destroy, .decode = decode };
    (void)why;
    return &functions;
}
