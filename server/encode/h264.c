/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The H.264 codec: converts frames to planes for h264_codec.h. Annex B, no frame reordering, key frames on demand only. */
#include <errno.h>
#include <string.h>

#include "base/mem.h"
#include "encode/encoder_impl.h"
#include "encode/h264_codec.h"
#include "encode/planes.h"

enum { GRAIN_ROWS = 256 };

struct h264_encoder {
    struct encoder base;
    const struct h264_codec_functions *functions;
    struct h264_codec *codec;
};

static void h264_destroy(struct encoder *encoder)
{
    struct h264_encoder *h264 = (struct h264_encoder *)encoder;
    if (h264->functions)
        h264->functions->destroy(&h264->codec);
    mem_free(h264);
}

static struct encoder *h264_create(struct log *log, const char *library)
{
    char why[H264_WHY_BYTES];
    struct h264_encoder *h264 = mem_new(sizeof(*h264));
    h264->base = (struct encoder){ .impl = &h264_impl, .log = log };
    h264->functions = h264_codec_functions(why);
    if (h264->functions && (h264->codec = h264->functions->create(library, why)))
        return &h264->base;
    log_warn(log, "h264: %s", why);
    h264_destroy(&h264->base);
    return NULL;
}

/* Extends planes to even width and height, which H.264 needs: repeats luma's last column or row if the width or the height is
   odd. */
static void extend(const struct h264_planes *to, int width_px, int height_px)
{
    size_t pitch = (size_t)to->pitches[0];
    for (int y = 0; y < height_px && to->width_px > width_px; y++)
        to->at[0][(size_t)y * pitch + (size_t)width_px] = to->at[0][(size_t)y * pitch + (size_t)width_px - 1];
    if (to->height_px > height_px)
        memcpy(to->at[0] + (size_t)height_px * pitch, to->at[0] + (size_t)(height_px - 1) * pitch, (size_t)to->width_px);
}

static void convert_bands(void *arg, size_t begin, size_t end)
{
    planes_convert(arg, begin, end);
}

static void convert(const struct frame *frame, struct workers *workers, const struct h264_planes *to)
{
    struct yuv_planes planes = { frame->bgrx,
                                 frame->stride_bytes,
                                 frame->width_px,
                                 frame->height_px,
                                 { to->at[0], to->at[1], to->at[2] },
                                 { to->pitches[0], to->pitches[1], to->pitches[2] } };
    size_t bands = planes_bands(frame->height_px);
    if (workers)
        workers_for(workers, bands, GRAIN_ROWS / PLANES_BAND_PX, convert_bands, &planes);
    else
        convert_bands(&planes, 0, bands);
    extend(to, frame->width_px, frame->height_px);
}

static int h264_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params, const struct dirty_rect *rects,
                     int count)
{
    struct h264_encoder *h264 = (struct h264_encoder *)encoder;
    struct h264_access_unit unit;
    struct h264_planes planes;
    char why[H264_WHY_BYTES];
    (void)rects; /* ignores the list of changed rectangles, because the encoder skips unchanged blocks itself */
    (void)count;
    int status = h264->functions->begin(h264->codec, frame->width_px, frame->height_px, &planes, why);
    if (status == 0) {
        convert(frame, params->workers, &planes);
        status = h264->functions->encode(h264->codec, params->quality, params->key, &unit, why);
    }
    if (status < 0) {
        log_err(encoder->log, "h264 by %s", why);
        return status;
    }
    encoder->ready = packet_create(frame, WIRE_CODEC_H264, unit.key, unit.bytes, unit.count);
    return encoder->ready ? 0 : -ENOMEM;
}

const struct encoder_impl h264_impl = {
    .name = "h264", .is_stream = true, .create = h264_create, .send = h264_send, .destroy = h264_destroy
};
