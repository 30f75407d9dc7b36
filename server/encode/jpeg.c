/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Baseline JPEG by TurboJPEG. */
#include <errno.h>
#include <turbojpeg.h>

#include "base/mem.h"
#include "encode/encoder_impl.h"

struct jpeg_encoder {
    struct encoder base;
    tjhandle turbo;
    unsigned char *out; /* kept from picture to picture */
    size_t capacity;
};

static void jpeg_destroy(struct encoder *encoder)
{
    struct jpeg_encoder *jpeg = (struct jpeg_encoder *)encoder;
    if (jpeg->turbo)
        tjDestroy(jpeg->turbo);
    mem_free(jpeg->out);
    mem_free(jpeg);
}

static struct encoder *jpeg_create(struct log *log, const char *library)
{
    (void)library;
    struct jpeg_encoder *jpeg = mem_new(sizeof(*jpeg));
    jpeg->base = (struct encoder){ .impl = &jpeg_impl, .log = log };
    jpeg->turbo = tjInitCompress();
    if (!jpeg->turbo) {
        log_err(log, "jpeg: %s", tjGetErrorStr2(NULL));
        jpeg_destroy(&jpeg->base);
        return NULL;
    }
    return &jpeg->base;
}

static bool reserve(struct jpeg_encoder *jpeg, size_t need)
{
    if (need <= jpeg->capacity)
        return true;
    mem_free(jpeg->out);
    jpeg->out = mem_try_array(need, 1);
    jpeg->capacity = jpeg->out ? need : 0;
    return jpeg->out != NULL;
}

/* Appends one rectangle at *end of what is reserved. */
static bool compress(struct jpeg_encoder *jpeg, const struct frame *frame, const struct change *part, const struct encoder_params *params,
                     size_t *end)
{
    int sampling = params->full_chroma ? TJSAMP_444 : TJSAMP_420;
    const uint8_t *from = frame->bgrx + (size_t)part->y_px * (size_t)frame->stride_bytes + (size_t)part->x_px * 4;
    unsigned char *to = jpeg->out + *end;
    unsigned long count = tjBufSize(part->width_px, part->height_px, sampling);
    if (tjCompress2(jpeg->turbo, from, part->width_px, frame->stride_bytes, part->height_px, TJPF_BGRX, &to, &count, sampling,
                    params->quality, TJFLAG_NOREALLOC) != 0) {
        log_err(jpeg->base.log, "jpeg %dx%d: %s", part->width_px, part->height_px, tjGetErrorStr2(jpeg->turbo));
        return false;
    }
    *end += count;
    return true;
}

static bool reserve_for(struct jpeg_encoder *jpeg, const struct change *parts, int count, bool full_chroma)
{
    size_t need = 0;
    for (int i = 0; i < count; i++)
        need += tjBufSize(parts[i].width_px, parts[i].height_px, full_chroma ? TJSAMP_444 : TJSAMP_420);
    return reserve(jpeg, need);
}

static int jpeg_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params, const struct change *changes,
                     int count)
{
    struct jpeg_encoder *jpeg = (struct jpeg_encoder *)encoder;
    struct change whole = { .width_px = frame->width_px, .height_px = frame->height_px };
    struct packet_part parts[CHANGES_MAX];
    const struct change *from = count ? changes : &whole;
    int part_count = count ? count : 1;
    size_t end = 0;
    if (!reserve_for(jpeg, from, part_count, params->full_chroma)) {
        log_err(encoder->log, "jpeg %dx%d: no memory for it", frame->width_px, frame->height_px);
        return -ENOMEM;
    }
    for (int i = 0; i < part_count; i++) {
        parts[i] = (struct packet_part){ from[i].x_px, from[i].y_px, from[i].width_px, from[i].height_px, end, 0 };
        if (!compress(jpeg, frame, &from[i], params, &end))
            return -EIO;
        parts[i].count = end - parts[i].begin;
    }
    encoder->ready = count ? packet_create_parts(frame, WIRE_CODEC_JPEG, jpeg->out, parts, part_count)
                           : packet_create(frame, WIRE_CODEC_JPEG, true, jpeg->out, end);
    return encoder->ready ? 0 : -ENOMEM;
}

const struct encoder_impl jpeg_impl = { .name = "jpeg", .create = jpeg_create, .send = jpeg_send, .destroy = jpeg_destroy };
