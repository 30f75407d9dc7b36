/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lossless PNG with libpng, for snapshots and for still frames on request. */
#include <errno.h>
#include <openssl/evp.h>
#include <png.h>
#include <string.h>

#include "base/mem.h"
#include "encode/encoder_impl.h"

static void png_destroy(struct encoder *encoder)
{
    mem_free(encoder);
}

static struct encoder *png_create(struct log *log, const char *library)
{
    (void)library;
    struct encoder *encoder = mem_new(sizeof(*encoder));
    *encoder = (struct encoder){ .impl = &png_impl, .log = log };
    return encoder;
}

static uint8_t *pack_rgb(const struct frame *frame)
{
    uint8_t *packed = mem_try_array((size_t)frame->width_px * (size_t)frame->height_px, 3);
    if (!packed)
        return NULL;
    uint8_t *to = packed;
    for (int y = 0; y < frame->height_px; y++) {
        const uint8_t *from = frame->bgrx + (size_t)y * (size_t)frame->stride_bytes;
        for (int x = 0; x < frame->width_px; x++, from += 4, to += 3)
            to[0] = from[2], to[1] = from[1], to[2] = from[0];
    }
    return packed;
}

/* Computes the SHA-256 of the pixels. If the library fails, `out` becomes all zero, which matches no frame. */
static void hash_pixels(const struct frame *frame, const uint8_t *packed, uint8_t out[PACKET_SHA256_BYTES])
{
    size_t bytes = 3 * (size_t)frame->width_px * (size_t)frame->height_px;
    if (EVP_Digest(packed, bytes, out, NULL, EVP_sha256(), NULL) != 1)
        memset(out, 0, PACKET_SHA256_BYTES);
}

static int png_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params, const struct dirty_rect *rects,
                    int count)
{
    (void)params; /* ignores the parameters: PNG is lossless and always encodes the whole frame */
    (void)rects;
    (void)count;
    png_image image = {
        .version = PNG_IMAGE_VERSION,
        .format = PNG_FORMAT_RGB,
        .flags = PNG_IMAGE_FLAG_FAST,
        .width = (png_uint_32)frame->width_px,
        .height = (png_uint_32)frame->height_px,
    };
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
    uint8_t *packed = pack_rgb(frame), *out = mem_try_array(bytes, 1);
    int status = -ENOMEM;
    if (packed && out && png_image_write_to_memory(&image, out, &bytes, 0, packed, 0, NULL)) {
        encoder->ready = packet_create(frame, WIRE_CODEC_PNG, true, out, bytes);
        status = encoder->ready ? 0 : -ENOMEM;
    }
    if (status == 0 && frame->record)
        hash_pixels(frame, packed, encoder->ready->pixels_sha256);
    if (status)
        log_err(encoder->log, "png: cannot encode a picture of %dx%d: %s", frame->width_px, frame->height_px,
                image.message[0] ? image.message : "out of memory");
    mem_free(out);
    mem_free(packed);
    return status;
}

const struct encoder_impl png_impl = { .name = "png", .create = png_create, .send = png_send, .destroy = png_destroy };
