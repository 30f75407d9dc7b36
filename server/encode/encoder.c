/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of codecs, and code shared by all codecs. */
#include "encode/encoder.h"

#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "encode/encoder_impl.h"

/* fraction of a frame's pixels: if more have changed, the whole frame is encoded, which is cheaper than encoding rectangles */
static const double MAX_DIRTY_SHARE = 0.6;
static const struct encoder_impl *const table[] = {
    &jpeg_impl,
    &png_impl,
#ifdef PLANTCAST_H264
    &h264_impl,
#endif
};

static const struct encoder_impl *find(const char *name)
{
    for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
        if (!strcmp(table[i]->name, name))
            return table[i];
    return NULL;
}

struct encoder *encoder_create(struct log *log, const char *name, const char *library)
{
    const struct encoder_impl *impl = find(name);
    if (!impl) {
        log_err(log, "encoder '%s' is unknown", name);
        return NULL;
    }
    return impl->create(log, library);
}

void encoder_destroy(struct encoder **encoder)
{
    if (!*encoder)
        return;
    packet_unref(&(*encoder)->ready);
    (*encoder)->impl->destroy(*encoder);
    *encoder = NULL;
}

bool encoder_is_stream(const char *name)
{
    const struct encoder_impl *impl = find(name);
    return impl && impl->is_stream;
}

/* Finds the rectangles of a frame that changed since `before`, an earlier frame of the same view. Returns false if nothing changed. */
static bool find_dirty_rects(const struct encoder *encoder, const struct frame *frame, const struct frame *before, struct dirty_rect *rects,
                             int *count)
{
    if (encoder->impl->is_stream) /* the codec detects changes itself */
        return !dirty_rects_none(before, frame);
    *count = dirty_rects_find(before, frame, rects);
    if (*count == 0)
        return false;
    if (dirty_rects_share(frame, rects, *count) > MAX_DIRTY_SHARE)
        *count = 0;
    return true;
}

/* Returns true if two frames have equal arrows. Arrows are sent separately from the pixels, so a frame whose arrows changed
   must be sent even if no pixel changed. */
static bool arrows_equal(const struct frame *a, const struct frame *b)
{
    if (a->label_count != b->label_count)
        return false;
    for (size_t i = 0; i < a->label_count; i++) {
        const struct frame_label *x = &a->labels[i], *y = &b->labels[i];
        if (x->arrow != y->arrow || x->stroke != y->stroke ||
            (x->arrow && (x->dx != y->dx || x->dy != y->dy || x->uncertain != y->uncertain)))
            return false;
    }
    return true;
}

int encoder_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params)
{
    struct dirty_rect rects[DIRTY_RECTS_MAX];
    const struct frame *before = params->key ? NULL : params->before;
    int count = 0;
    if (encoder->ready)
        return -EAGAIN;
    int64_t begin_ns = clock_mono_ns();
    if (before && before->width_px == frame->width_px && before->height_px == frame->height_px && view_equal(&before->view, &frame->view) &&
        !find_dirty_rects(encoder, frame, before, rects, &count) && arrows_equal(before, frame))
        return 0;
    int status = encoder->impl->send(encoder, frame, params, rects, count);
    if (status == 0)
        encoder->ready->encode_ns = clock_mono_ns() - begin_ns;
    return status;
}

int encoder_receive(struct encoder *encoder, struct packet **out)
{
    *out = encoder->ready;
    encoder->ready = NULL;
    return *out ? 0 : -EAGAIN;
}

bool encoder_works(struct log *log, const char *name, const char *library)
{
    struct encoder *encoder = find(name) ? encoder_create(log, name, library) : NULL;
    struct frame *frame = encoder ? frame_create(NULL, 320, 192) : NULL;
    bool works = frame && encoder_send(encoder, frame, &(struct encoder_params){ .quality = 80, .key = true }) == 0;
    frame_unref(&frame);
    encoder_destroy(&encoder);
    return works;
}
