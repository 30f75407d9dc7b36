/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes libavcodec's H.264 from a module that is loaded when it is first asked for: the 120 libraries behind libavcodec take as long to
   load as all else that most programs do at their start. */
#include "base/system/module.h"
#include "encode/h264_codec.h"

static struct module h264 = MODULE("plantcast-h264.so"); /* server/encode/h264_codec.c */

const struct h264_codec_functions *h264_codec_functions(char why[H264_WHY_BYTES])
{
    const struct h264_codec_functions *(*functions)(char[H264_WHY_BYTES]);
    return module_find(&h264, "h264_codec_functions", &functions, why, H264_WHY_BYTES) ? functions(why) : NULL;
}
