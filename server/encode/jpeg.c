/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The baseline JPEG codec. */
#include <errno.h>
#include <string.h>

#include "base/mem.h"
#include "encode/encoder_impl.h"
#include "encode/jpeg_write.h"
#include "encode/planes.h"

struct jpeg_encoder {
    struct encoder base;
    struct jpeg_writer *writer;
    unsigned char *out; /* output buffer for the JPEG files, reused from frame to frame */
    size_t capacity;
    unsigned char *planes; /* planes of one rectangle: luma, then subsampled chroma */
    size_t planes_capacity;
};

static void jpeg_destroy(struct encoder *encoder)
{
    struct jpeg_encoder *jpeg = (struct jpeg_encoder *)encoder;
    jpeg_writer_destroy(&jpeg->writer);
    mem_free(jpeg->out);
    mem_free(jpeg->planes);
    mem_free(jpeg);
}

static struct encoder *jpeg_create(struct log *log, const char *library)
{
    (void)library;
    struct jpeg_encoder *jpeg = mem_new(sizeof(*jpeg));
    jpeg->base = (struct encoder){ .impl = &jpeg_impl, .log = log };
    jpeg->writer = jpeg_writer_create();
    if (!jpeg->writer) {
        log_err(log, "jpeg: cannot create the encoder: out of memory");
        jpeg_destroy(&jpeg->base);
        return NULL;
    }
    return &jpeg->base;
}

/* Grows a buffer to at least `need` bytes; its content is lost. Returns false when out of memory. */
static bool reserve(unsigned char **at, size_t *capacity, size_t need)
{
    if (need <= *capacity)
        return true;
    mem_free(*at);
    *at = mem_try_array(need, 1);
    *capacity = *at ? need : 0;
    return *at != NULL;
}

static int padded(int px)
{
    return (px + JPEG_PAD_PX - 1) / JPEG_PAD_PX * JPEG_PAD_PX;
}

/* Returns an upper bound on the size in bytes of a rectangle's JPEG, the same as TurboJPEG's own. */
static size_t max_bytes(const struct dirty_rect *part)
{
    return (size_t)padded(part->width_px) * (size_t)padded(part->height_px) * 6 + 2048;
}

/* Repeats the last column of pixels of each plane in the padding on the right. */
static void extend(const struct yuv_planes *planes)
{
    for (int c = 0; c < 3; c++) {
        int width = c ? (planes->width_px + 1) / 2 : planes->width_px, height = c ? (planes->height_px + 1) / 2 : planes->height_px;
        for (int y = 0; y < height; y++) {
            uint8_t *row = planes->plane[c] + (ptrdiff_t)y * planes->pitch[c];
            memset(row + width, row[width - 1], (size_t)(planes->pitch[c] - width));
        }
    }
}

/* Compresses a rectangle with subsampled chroma. Returns the number of bytes; 0: failed, with the reason in *why. */
static size_t compress_halved(struct jpeg_encoder *jpeg, const uint8_t *from, int stride_bytes, const struct dirty_rect *part, int quality,
                              unsigned char *to, const char **why)
{
    int width = padded(part->width_px), height = padded(part->height_px);
    size_t luma = (size_t)width * (size_t)height;
    struct yuv_planes planes = { from, stride_bytes, part->width_px, part->height_px, { 0 }, { width, width / 2, width / 2 } };
    if (!reserve(&jpeg->planes, &jpeg->planes_capacity, luma * 3 / 2)) {
        *why = "out of memory";
        return 0;
    }
    for (int i = 0; i < 3; i++)
        planes.plane[i] = jpeg->planes + (i > 0 ? luma : 0) + (i > 1 ? luma / 4 : 0);
    planes_convert(&planes, 0, planes_bands(part->height_px));
    extend(&planes);
    return jpeg_write_halved(jpeg->writer, &planes, quality, to, max_bytes(part));
}

/* Compresses a rectangle and appends its JPEG at offset *end of the output buffer. Returns false on failure. */
static bool compress(struct jpeg_encoder *jpeg, const struct frame *frame, const struct dirty_rect *part,
                     const struct encoder_params *params, size_t *end)
{
    const uint8_t *from = frame->bgrx + (size_t)part->y_px * (size_t)frame->stride_bytes + (size_t)part->x_px * 4;
    const char *why = jpeg_writer_why(jpeg->writer);
    unsigned char *to = jpeg->out + *end;
    const struct jpeg_pixels pixels = { from, frame->stride_bytes, part->width_px, part->height_px };
    size_t count = params->full_chroma ? jpeg_write_whole(jpeg->writer, &pixels, params->quality, to, max_bytes(part))
                                       : compress_halved(jpeg, from, frame->stride_bytes, part, params->quality, to, &why);
    if (count == 0)
        log_err(jpeg->base.log, "jpeg: cannot encode a picture of %dx%d: %s", part->width_px, part->height_px, why);
    *end += count;
    return count > 0;
}

static bool reserve_for(struct jpeg_encoder *jpeg, const struct dirty_rect *parts, int count)
{
    size_t need = 0;
    for (int i = 0; i < count; i++)
        need += max_bytes(&parts[i]);
    return reserve(&jpeg->out, &jpeg->capacity, need);
}

static int jpeg_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params, const struct dirty_rect *rects,
                     int count)
{
    struct jpeg_encoder *jpeg = (struct jpeg_encoder *)encoder;
    struct dirty_rect whole = { .width_px = frame->width_px, .height_px = frame->height_px };
    struct packet_part parts[DIRTY_RECTS_MAX];
    const struct dirty_rect *from = count ? rects : &whole;
    int part_count = count ? count : 1;
    size_t end = 0;
    if (!reserve_for(jpeg, from, part_count)) {
        log_err(encoder->log, "jpeg: cannot encode a picture of %dx%d: out of memory", frame->width_px, frame->height_px);
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
