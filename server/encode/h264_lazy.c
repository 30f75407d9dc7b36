/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads the H.264 module on first use. libavcodec's 120 libraries take as long to load as everything else at program start. */
#include "base/system/module.h"
#include "encode/h264_codec.h"

static struct module h264 = MODULE("plantcast-h264.so"); /* built from server/encode/h264_codec.c */

const struct h264_codec_functions *h264_codec_functions(char why[H264_WHY_BYTES])
{
    const struct h264_codec_functions *(*functions)(char[H264_WHY_BYTES]);
    return module_find(&h264, "h264_codec_functions", &functions, why, H264_WHY_BYTES) ? functions(why) : NULL;
}
