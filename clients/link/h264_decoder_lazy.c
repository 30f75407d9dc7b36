/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads the H.264 decoder module on first use, because the many libraries that libavcodec needs would slow down every program start. */
#include "base/system/module.h"
#include "h264_decoder.h"

static struct module h264 = MODULE("plantcast-h264.so"); /* implemented by h264_decoder.c */

const struct h264_decoder_functions *h264_decoder_functions(char why[H264_DECODER_WHY_BYTES])
{
    const struct h264_decoder_functions *(*functions)(char[H264_DECODER_WHY_BYTES]);
    return module_find(&h264, "h264_decoder_functions", &functions, why, H264_DECODER_WHY_BYTES) ? functions(why) : NULL;
}
