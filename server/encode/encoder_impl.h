/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one codec supplies: a line in the table of encoder.c. Private to encode/. */
#ifndef ENCODE_ENCODER_IMPL_H
#define ENCODE_ENCODER_IMPL_H
#include "encode/encoder.h"

struct encoder_impl {
    const char *name;
    struct encoder *(*create)(struct log *log);
    int (*send)(struct encoder *encoder, struct frame *frame, const struct encoder_params *params);
    void (*destroy)(struct encoder *encoder);
};

struct encoder { /* first member of each codec's own struct */
    const struct encoder_impl *impl;
    struct log *log;
    struct packet *ready; /* made by send, not yet received */
};

extern const struct encoder_impl jpeg_impl, png_impl;

#endif
