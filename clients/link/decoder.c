/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JPEG by TurboJPEG, PNG by libpng, H.264 by libavcodec. */
#include "decoder.h"

#include <png.h>
#include <string.h>
#include <turbojpeg.h>
#include <unistd.h>
#ifdef PLANTCAST_H264
#include <libavcodec/avcodec.h>
#include <libavutil/hwcontext.h>
#include <libyuv.h>
#endif

#include "base/mem.h"

/* Where there are many cores, slices are decoded side by side, as a browser does. */
enum { MANY_CORES = 8, SLICE_THREADS = 8 };

struct decoder {
    tjhandle turbo;
    uint8_t *pixels;
    size_t pixel_bytes;
#ifdef PLANTCAST_H264
    AVCodecContext *context;
    AVPacket *packet;
    AVFrame *picture, *copy; /* copy: of a picture that lies in a GPU */
    AVBufferRef *hardware;   /* NULL: decoded by the processor */
#endif
};

bool decoder_has(enum wire_codec codec)
{
#ifdef PLANTCAST_H264
    if (codec == WIRE_CODEC_H264)
        return avcodec_find_decoder(AV_CODEC_ID_H264) != NULL;
#endif
    return codec == WIRE_CODEC_JPEG || codec == WIRE_CODEC_PNG;
}

static bool reserve(struct decoder *decoder, int width_px, int height_px)
{
    size_t need = (size_t)width_px * (size_t)height_px * 4;
    if (need > decoder->pixel_bytes) {
        mem_free(decoder->pixels);
        decoder->pixels = mem_try_array(need, 1);
        decoder->pixel_bytes = decoder->pixels ? need : 0;
    }
    return decoder->pixels != NULL;
}

static bool decode_jpeg(struct decoder *decoder, const struct wire_frame *frame, const uint8_t *payload)
{
    int w, h, sampling, space;
    return tjDecompressHeader3(decoder->turbo, payload, frame->payload_bytes, &w, &h, &sampling, &space) == 0 && w == frame->width_px &&
           h == frame->height_px && reserve(decoder, w, h) &&
           tjDecompress2(decoder->turbo, payload, frame->payload_bytes, decoder->pixels, w, w * 4, h, TJPF_BGRX, 0) == 0;
}

static bool decode_png(struct decoder *decoder, const struct wire_frame *frame, const uint8_t *payload)
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    bool good = png_image_begin_read_from_memory(&image, payload, frame->payload_bytes) && image.width == frame->width_px &&
                image.height == frame->height_px && reserve(decoder, frame->width_px, frame->height_px);
    image.format = PNG_FORMAT_BGRA;
    good = good && png_image_finish_read(&image, NULL, decoder->pixels, 0, NULL);
    png_image_free(&image);
    return good;
}

#ifdef PLANTCAST_H264
static enum AVPixelFormat choose_format(AVCodecContext *context, const enum AVPixelFormat *offered)
{
    for (const enum AVPixelFormat *format = offered; *format != AV_PIX_FMT_NONE; format++)
        if (*format == AV_PIX_FMT_VAAPI && context->hw_device_ctx)
            return *format;
    return avcodec_default_get_format(context, offered);
}

static bool open_h264(struct decoder *decoder)
{
    if (decoder->context)
        return true;
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    decoder->packet = av_packet_alloc();
    decoder->picture = av_frame_alloc();
    decoder->context = avcodec_alloc_context3(avcodec_find_decoder(AV_CODEC_ID_H264));
    if (!decoder->packet || !decoder->picture || !decoder->context)
        return false;
    decoder->copy = av_frame_alloc();
    if (decoder->hardware && decoder->copy) {
        decoder->context->hw_device_ctx = av_buffer_ref(decoder->hardware);
        decoder->context->get_format = choose_format;
    }
    decoder->context->flags |= AV_CODEC_FLAG_LOW_DELAY;
    decoder->context->thread_type = FF_THREAD_SLICE;
    decoder->context->thread_count = cores >= MANY_CORES ? SLICE_THREADS : 1;
    return avcodec_open2(decoder->context, NULL, NULL) == 0;
}

/* The coded picture may be wider and higher by the pixel that makes its sides even. */
static bool show_h264(struct decoder *decoder, const struct wire_frame *frame)
{
    const AVFrame *p = decoder->picture;
    if (p->format == AV_PIX_FMT_VAAPI) {
        av_frame_unref(decoder->copy);
        if (av_hwframe_transfer_data(decoder->copy, p, 0) != 0)
            return false;
        p = decoder->copy;
    }
    if (p->width < frame->width_px || p->height < frame->height_px || !reserve(decoder, frame->width_px, frame->height_px))
        return false;
    if (p->format == AV_PIX_FMT_NV12)
        return NV12ToARGBMatrix(p->data[0], p->linesize[0], p->data[1], p->linesize[1], decoder->pixels, frame->width_px * 4,
                                &kYuvJPEGConstants, frame->width_px, frame->height_px) == 0;
    return J420ToARGB(p->data[0], p->linesize[0], p->data[1], p->linesize[1], p->data[2], p->linesize[2], decoder->pixels,
                      frame->width_px * 4, frame->width_px, frame->height_px) == 0;
}

static bool decode_h264(struct decoder *decoder, const struct wire_frame *frame, const uint8_t *payload)
{
    if (!open_h264(decoder) || av_new_packet(decoder->packet, (int)frame->payload_bytes) != 0)
        return false;
    memcpy(decoder->packet->data, payload, frame->payload_bytes);
    int status = avcodec_send_packet(decoder->context, decoder->packet);
    av_packet_unref(decoder->packet);
    return status == 0 && avcodec_receive_frame(decoder->context, decoder->picture) == 0 && show_h264(decoder, frame);
}
#endif

bool decoder_use_hardware(struct decoder *decoder)
{
#ifdef PLANTCAST_H264
    return decoder->hardware || av_hwdevice_ctx_create(&decoder->hardware, AV_HWDEVICE_TYPE_VAAPI, NULL, NULL, 0) == 0;
#else
    (void)decoder;
    return false;
#endif
}

const uint8_t *decoder_pixels(const struct decoder *decoder)
{
    return decoder->pixels;
}

bool decoder_decode(struct decoder *decoder, const struct wire_frame *frame, const uint8_t *payload)
{
#ifdef PLANTCAST_H264
    if (frame->codec == WIRE_CODEC_H264)
        return decode_h264(decoder, frame, payload);
#endif
    return frame->codec == WIRE_CODEC_PNG ? decode_png(decoder, frame, payload)
                                          : frame->codec == WIRE_CODEC_JPEG && decode_jpeg(decoder, frame, payload);
}

struct decoder *decoder_create(void)
{
    struct decoder *decoder = mem_new(sizeof(*decoder));
    decoder->turbo = tjInitDecompress();
    if (!decoder->turbo)
        decoder_destroy(&decoder);
    return decoder;
}

void decoder_destroy(struct decoder **decoder_ptr)
{
    struct decoder *decoder = *decoder_ptr;
    if (!decoder)
        return;
    if (decoder->turbo)
        tjDestroy(decoder->turbo);
#ifdef PLANTCAST_H264
    avcodec_free_context(&decoder->context);
    av_packet_free(&decoder->packet);
    av_frame_free(&decoder->picture);
    av_frame_free(&decoder->copy);
    av_buffer_unref(&decoder->hardware);
#endif
    mem_free(decoder->pixels);
    mem_free(decoder);
    *decoder_ptr = NULL;
}
