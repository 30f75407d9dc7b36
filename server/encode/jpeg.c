/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Baseline JPEG by TurboJPEG. */
#include <errno.h>
#include <string.h>
#include <turbojpeg.h>

#include "base/mem.h"
#include "encode/encoder_impl.h"
#include "encode/planes.h"

struct jpeg_encoder {
    struct encoder base;
    tjhandle turbo;
    unsigned char *out; /* kept from picture to picture */
    size_t capacity;
    unsigned char *planes; /* of one rectangle, halved chroma behind its luma */
    size_t planes_capacity;
};

static void jpeg_destroy(struct encoder *encoder)
{
    struct jpeg_encoder *jpeg = (struct jpeg_encoder *)encoder;
    if (jpeg->turbo)
        tjDestroy(jpeg->turbo);
    mem_free(jpeg->out);
    mem_free(jpeg->planes);
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

/* What was there is lost. */
static bool reserve(unsigned char **at, size_t *capacity, size_t need)
{
    if (need <= *capacity)
        return true;
    mem_free(*at);
    *at = mem_try_array(need, 1);
    *capacity = *at ? need : 0;
    return *at != NULL;
}

static int even(int px)
{
    return (px + 1) & ~1;
}

/* Luma beyond an odd edge is what stands at the edge; even: TurboJPEG wants whole pairs. */
static void extend(const struct planes *planes)
{
    size_t width = (size_t)planes->width_px, pitch = (size_t)planes->pitch[0];
    for (size_t y = 0; y < (size_t)planes->height_px && pitch > width; y++)
        planes->plane[0][y * pitch + width] = planes->plane[0][y * pitch + width - 1];
    if (planes->height_px & 1)
        memcpy(planes->plane[0] + (size_t)planes->height_px * pitch, planes->plane[0] + (size_t)(planes->height_px - 1) * pitch, pitch);
}

static int compress_halved(struct jpeg_encoder *jpeg, const uint8_t *from, int stride_bytes, const struct change *part, int quality,
                           unsigned char **to, unsigned long *count)
{
    int width = even(part->width_px), height = even(part->height_px);
    size_t luma = (size_t)width * (size_t)height;
    struct planes planes = { from, stride_bytes, part->width_px, part->height_px, { 0 }, { width, width / 2, width / 2 } };
    if (!reserve(&jpeg->planes, &jpeg->planes_capacity, luma * 3 / 2))
        return -1;
    for (int i = 0; i < 3; i++)
        planes.plane[i] = jpeg->planes + (i > 0 ? luma : 0) + (i > 1 ? luma / 4 : 0);
    planes_convert(&planes, 0, planes_bands(part->height_px));
    extend(&planes);
    return tjCompressFromYUVPlanes(jpeg->turbo, (const unsigned char **)planes.plane, part->width_px, planes.pitch, part->height_px,
                                   TJSAMP_420, to, count, quality, TJFLAG_NOREALLOC);
}

/* Appends one rectangle at *end of what is reserved. */
static bool compress(struct jpeg_encoder *jpeg, const struct frame *frame, const struct change *part, const struct encoder_params *params,
                     size_t *end)
{
    const uint8_t *from = frame->bgrx + (size_t)part->y_px * (size_t)frame->stride_bytes + (size_t)part->x_px * 4;
    unsigned char *to = jpeg->out + *end;
    unsigned long count = tjBufSize(part->width_px, part->height_px, params->full_chroma ? TJSAMP_444 : TJSAMP_420);
    int status = params->full_chroma ? tjCompress2(jpeg->turbo, from, part->width_px, frame->stride_bytes, part->height_px, TJPF_BGRX, &to,
                                                   &count, TJSAMP_444, params->quality, TJFLAG_NOREALLOC)
                                     : compress_halved(jpeg, from, frame->stride_bytes, part, params->quality, &to, &count);
    if (status != 0) {
        log_err(jpeg->base.log, "jpeg %dx%d: %s", part->width_px, part->height_px,
                jpeg->planes || params->full_chroma ? tjGetErrorStr2(jpeg->turbo) : "no memory for it");
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
    return reserve(&jpeg->out, &jpeg->capacity, need);
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
