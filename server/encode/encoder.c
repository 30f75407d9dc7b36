/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of codecs, and what is the same for all of them. */
#include "encode/encoder.h"

#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "encode/encoder_impl.h"

static const struct encoder_impl *const table[] = { &jpeg_impl, &png_impl };

struct encoder *encoder_create(struct log *log, const char *name)
{
    for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
        if (!strcmp(table[i]->name, name))
            return table[i]->create(log);
    log_err(log, "encoder '%s' is unknown", name);
    return NULL;
}

void encoder_destroy(struct encoder **encoder)
{
    if (!*encoder)
        return;
    packet_unref(&(*encoder)->ready);
    (*encoder)->impl->destroy(*encoder);
    *encoder = NULL;
}

int encoder_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params)
{
    if (encoder->ready)
        return -EAGAIN;
    int64_t begin_ns = clock_mono_ns();
    int status = encoder->impl->send(encoder, frame, params);
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
