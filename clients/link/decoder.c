/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes frames: JPEG with TurboJPEG, PNG with libpng, H.264 with h264_decoder.h. Converts colours with libyuv. */
#include "decoder.h"

#include <png.h>
#include <stdio.h>
#include <turbojpeg.h>
#ifdef PLANTCAST_H264
#include <libyuv.h>
#endif

#include "base/mem.h"
#include "h264_decoder.h"

struct decoder {
    tjhandle turbo;
    uint8_t *pixels;
    size_t pixel_bytes;
#ifdef PLANTCAST_H264
    /* functions of the H.264 module, which is loaded with the first H.264 frame; NULL: not loaded yet, and the H.264 members below are not
       valid */
    const struct h264_decoder_functions *functions;
    struct h264_decoder *h264;
#endif
};

#ifdef PLANTCAST_H264
static bool open_h264(struct decoder *decoder, char why[DECODER_WHY_BYTES])
{
    if (!decoder->functions)
        decoder->functions = h264_decoder_functions(why);
    if (decoder->functions && !decoder->h264)
        decoder->h264 = decoder->functions->create(why);
    return decoder->h264 != NULL;
}
#endif

static void close_h264(struct decoder *decoder)
{
#ifdef PLANTCAST_H264
    if (decoder->functions)
        decoder->functions->destroy(&decoder->h264);
#else
    (void)decoder;
#endif
}

bool decoder_has(enum wire_codec codec, char why[DECODER_WHY_BYTES])
{
    if (codec == WIRE_CODEC_JPEG || codec == WIRE_CODEC_PNG)
        return true;
#ifdef PLANTCAST_H264
    struct decoder decoder = { 0 };
    bool has = open_h264(&decoder, why);
    close_h264(&decoder);
    return has;
#else
    snprintf(why, DECODER_WHY_BYTES, "this program was built without H.264 (CODECS=jpeg)");
    return false;
#endif
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
/* Decodes H.264. The coded picture has even sides, so it may be one pixel wider or higher than the frame. Returns false on failure. */
static bool decode_h264(struct decoder *decoder, const struct wire_frame *frame, const uint8_t *payload)
{
    char why[DECODER_WHY_BYTES];
    struct h264_decoded p;
    if (!open_h264(decoder, why) || !decoder->functions->decode(decoder->h264, payload, frame->payload_bytes, &p))
        return false;
    if (p.width_px < frame->width_px || p.height_px < frame->height_px || !reserve(decoder, frame->width_px, frame->height_px))
        return false;
    return J420ToARGB(p.at[0], p.pitches[0], p.at[1], p.pitches[1], p.at[2], p.pitches[2], decoder->pixels, frame->width_px * 4,
                      frame->width_px, frame->height_px) == 0;
}
#endif

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
    close_h264(decoder);
    mem_free(decoder->pixels);
    mem_free(decoder);
    *decoder_ptr = NULL;
}
