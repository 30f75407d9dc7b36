/* SPDX-License-Identifier: GPL-3.0-or-later */
/* H.264 with libavcodec: Annex B, no frame reordering, key frames on demand only. */
#include "encode/h264_codec.h"

#include <errno.h>
#include <libavutil/opt.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "encode/h264_upload.h"

/* Options of libavcodec's encoders. For x264: qcomp=1 keeps the quality constant over all frames, however little moves;
   ipratio=1 makes key frames no finer than others, because finer ones would only cause a peak in the bit rate. */
struct library {
    const char *name, *options;
    /* true: the quality can change from frame to frame (constant rate factor); false: `options` fixes it */
    bool has_crf;
};
static const struct library libraries[] = {
    { "libx264",
      "preset=ultrafast tune=zerolatency forced-idr=1 x264-params=keyint=infinite:scenecut=0:qcomp=1:ipratio=1:aq-mode=0:annexb=1", true },
    { "h264_nvenc", "preset=p4 tune=ull zerolatency=1 delay=0 forced-idr=1 rc=constqp qp=22 rc-lookahead=0", false },
    { "h264_vaapi", "rc_mode=CQP qp=22 async_depth=1", false },
    { "h264_qsv", "preset=veryfast async_depth=1 look_ahead=0 forced_idr=1", false },
    { "libopenh264", "rc_mode=quality allow_skip_frames=0", false },
};
static const struct library other_library = { "", "", false };
/* default bit rate for encoders that cannot encode with constant quality: bits per second for each pixel of the frame */
static const int64_t DEFAULT_BITS_PER_PX_S = 4;
enum { RATE_HZ = 60, SLICED_PX = 1500000, MANY_CORES = 8, MAX_THREADS = 8 };

struct h264_codec {
    const AVCodec *codec;
    const struct library *library;
    AVCodecContext *context; /* libavcodec's encoder; it is created again when the size of the frames changes */
    AVFrame *picture;
    AVPacket *out;
    struct h264_upload *upload;
    int width_px, height_px;
    int64_t next;
};

static void close_codec(struct h264_codec *h264)
{
    avcodec_free_context(&h264->context);
    av_frame_free(&h264->picture);
    h264_upload_destroy(&h264->upload);
}

static void codec_destroy(struct h264_codec **pointer)
{
    struct h264_codec *h264 = *pointer;
    if (!h264)
        return;
    close_codec(h264);
    av_packet_free(&h264->out);
    mem_free(h264);
    *pointer = NULL;
}

static const struct library *library_of(const char *name)
{
    for (size_t i = 0; i < sizeof(libraries) / sizeof(libraries[0]); i++)
        if (!strcmp(libraries[i].name, name))
            return &libraries[i];
    return &other_library;
}

static struct h264_codec *codec_create(const char *library, char why[H264_WHY_BYTES])
{
    struct h264_codec *h264 = mem_new(sizeof(*h264));
    h264->codec = avcodec_find_encoder_by_name(library);
    h264->library = library_of(library);
    h264->out = av_packet_alloc();
    av_log_set_level(AV_LOG_ERROR);
    if (h264->out && h264->codec && h264->codec->id == AV_CODEC_ID_H264)
        return h264;
    snprintf(why, H264_WHY_BYTES, "libavcodec has no H.264 encoder named '%s'", library);
    codec_destroy(&h264);
    return NULL;
}

static int failed(const struct h264_codec *h264, const char *what, int status, char why[H264_WHY_BYTES])
{
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(status, text, sizeof(text));
    snprintf(why, H264_WHY_BYTES, "%s, %dx%d: %s: %s", h264->codec->name, h264->width_px, h264->height_px, what, text);
    return status == AVERROR(ENOMEM) ? -ENOMEM : -EIO;
}

/* Returns the number of slices, which are encoded in parallel: 1 unless the frame is too large for one core; otherwise one for
   each SLICED_PX pixels, at most one per core. */
static int thread_count(int width_px, int height_px)
{
    long cores = sysconf(_SC_NPROCESSORS_ONLN), pixels = (long)width_px * height_px;
    if (cores < MANY_CORES)
        return pixels < SLICED_PX || cores < 2 ? 1 : cores < 4 ? (int)cores : 4;
    long parts = 1 + MAX_THREADS * pixels / (SLICED_PX + SLICED_PX / 4), most = cores / 2 < MAX_THREADS ? cores / 2 : MAX_THREADS;
    return (int)(parts < most ? parts : most);
}

/* Describes the frames to libavcodec. Colours are BT.601 at full range, as in JPEG: libyuv converts to it fastest, and browsers
   reproduce it most exactly. With BT.709 at limited range, chromium is off by up to 12 of 255. */
static void describe(AVCodecContext *context, const struct h264_codec *h264)
{
    context->width = (h264->width_px + 1) & ~1;
    context->height = (h264->height_px + 1) & ~1;
    context->time_base = (AVRational){ 1, RATE_HZ };
    context->framerate = (AVRational){ RATE_HZ, 1 };
    context->color_range = AVCOL_RANGE_JPEG;
    context->colorspace = AVCOL_SPC_SMPTE170M;
    context->color_primaries = AVCOL_PRI_BT709;
    context->color_trc = AVCOL_TRC_IEC61966_2_1;
    context->max_b_frames = 0;
    context->gop_size = INT16_MAX;
    context->refs = 1;
    context->thread_count = thread_count(h264->width_px, h264->height_px);
    if (h264->library == &other_library)
        context->bit_rate = (int64_t)h264->width_px * h264->height_px * DEFAULT_BITS_PER_PX_S;
}

static int open_codec(struct h264_codec *h264, int width_px, int height_px, char why[H264_WHY_BYTES])
{
    AVDictionary *options = NULL;
    close_codec(h264);
    h264->width_px = width_px;
    h264->height_px = height_px;
    h264->context = avcodec_alloc_context3(h264->codec);
    h264->picture = av_frame_alloc();
    if (!h264->context || !h264->picture)
        return failed(h264, "begin", AVERROR(ENOMEM), why);
    describe(h264->context, h264);
    int status = h264_upload_create(h264->context, &h264->upload);
    if (status < 0)
        return failed(h264, "its device", status, why);
    av_dict_parse_string(&options, h264->library->options, "=", " ", 0);
    status = avcodec_open2(h264->context, h264->codec, &options);
    av_dict_free(&options);
    if (status < 0)
        return failed(h264, "begin", status, why);
    h264->picture->width = h264->context->width;
    h264->picture->height = h264->context->height;
    h264->picture->format = AV_PIX_FMT_YUV420P;
    h264->picture->color_range = AVCOL_RANGE_JPEG;
    status = av_frame_get_buffer(h264->picture, 0);
    return status < 0 ? failed(h264, "begin", status, why) : 0;
}

static int codec_begin(struct h264_codec *h264, int width_px, int height_px, struct h264_planes *planes, char why[H264_WHY_BYTES])
{
    bool fits = h264->context && h264->width_px == width_px && h264->height_px == height_px;
    int status = fits ? 0 : open_codec(h264, width_px, height_px, why);
    AVFrame *p = h264->picture;
    if (status == 0 && (status = av_frame_make_writable(p)) < 0)
        status = failed(h264, "begin", status, why);
    if (status < 0) {
        close_codec(h264);
        return status;
    }
    *planes = (struct h264_planes){
        { p->data[0], p->data[1], p->data[2] }, { p->linesize[0], p->linesize[1], p->linesize[2] }, p->width, p->height
    };
    return 0;
}

/* Maps JPEG quality to x264's rate factor: 92 looks like rate factor 18, and 78 like 25. Below 78, the bit rate falls as JPEG's
   does, but the look degrades more slowly. With rate factors of 40 and above, nearly all blocks of a moving picture would be
   skipped and show outdated content. */
static double rate_factor(int quality)
{
    static const double fine = 18, moving = 25;
    return quality >= 100 ? 12 : quality >= 78 ? fine + (92 - quality) * 0.5 : moving + (78 - quality) / 6.0;
}

static int codec_encode(struct h264_codec *h264, int quality, bool key, struct h264_access_unit *out, char why[H264_WHY_BYTES])
{
    AVFrame *p = h264->picture;
    p->pts = h264->next++;
    p->pict_type = key ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
    if (h264->library->has_crf)
        av_opt_set_double(h264->context->priv_data, "crf", rate_factor(quality), 0);
    av_packet_unref(h264->out);
    int status = h264_upload_send(h264->upload, h264->context, p);
    if (status >= 0)
        status = avcodec_receive_packet(h264->context, h264->out);
    if (status < 0) {
        status = failed(h264, "encode", status, why);
        close_codec(h264);
        return status;
    }
    *out = (struct h264_access_unit){ h264->out->data, (size_t)h264->out->size, (h264->out->flags & AV_PKT_FLAG_KEY) != 0 };
    return 0;
}

const struct h264_codec_functions *h264_codec_functions(char why[H264_WHY_BYTES])
{
    static const struct h264_codec_functions functions = {
        .create = codec_create, .destroy = codec_destroy, .begin = codec_begin, .encode = codec_encode
    };
    (void)why;
    return &functions;
}
