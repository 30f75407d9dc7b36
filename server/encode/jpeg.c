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

static struct encoder *jpeg_create(struct log *log)
{
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

static int jpeg_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params)
{
    struct jpeg_encoder *jpeg = (struct jpeg_encoder *)encoder;
    int sampling = params->full_chroma ? TJSAMP_444 : TJSAMP_420, w = frame->width_px, h = frame->height_px;
    unsigned long count = tjBufSize(w, h, sampling);
    if (count == (unsigned long)-1 || !reserve(jpeg, count)) {
        log_err(encoder->log, "jpeg %dx%d: no memory for it", w, h);
        return -ENOMEM;
    }
    if (tjCompress2(jpeg->turbo, frame->bgrx, w, frame->stride_bytes, h, TJPF_BGRX, &jpeg->out, &count, sampling, params->quality,
                    TJFLAG_NOREALLOC) != 0) {
        log_err(encoder->log, "jpeg %dx%d: %s", w, h, tjGetErrorStr2(jpeg->turbo));
        return -EIO;
    }
    encoder->ready = packet_create(frame, WIRE_CODEC_JPEG, true, jpeg->out, count);
    return encoder->ready ? 0 : -ENOMEM;
}

const struct encoder_impl jpeg_impl = { .name = "jpeg", .create = jpeg_create, .send = jpeg_send, .destroy = jpeg_destroy };
