/* SPDX-License-Identifier: GPL-3.0-or-later */
/* H.264 by libavcodec: Annex B, no picture waits for another, key frames only on demand. */
#include <errno.h>
#include <libavutil/opt.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "encode/encoder_impl.h"
#include "encode/h264_upload.h"
#include "encode/planes.h"

/* Options of libavcodec's encoders. x264: qcomp=1 makes every picture of one quality, however little moves; without ipratio key frames
   are no finer than what follows, which would only be a spike. */
struct library {
    const char *name, *options;
    bool has_crf; /* its quality can change between pictures; that of others is what the options say */
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
static const int64_t OTHERS_BITS_PER_PX_S = 4; /* rate of the encoders that need one */
enum { RATE_HZ = 60, SLICED_PX = 1500000, MANY_CORES = 8, MOST_THREADS = 8, GRAIN_ROWS = 256 };

struct h264_encoder {
    struct encoder base;
    const AVCodec *codec;
    const struct library *library;
    AVCodecContext *context; /* of the size of the last picture */
    AVFrame *picture;
    AVPacket *out;
    struct h264_upload *upload;
    int width_px, height_px;
    int64_t next;
};

static void close_codec(struct h264_encoder *h264)
{
    avcodec_free_context(&h264->context);
    av_frame_free(&h264->picture);
    h264_upload_destroy(&h264->upload);
}

static void h264_destroy(struct encoder *encoder)
{
    struct h264_encoder *h264 = (struct h264_encoder *)encoder;
    close_codec(h264);
    av_packet_free(&h264->out);
    mem_free(h264);
}

static const struct library *library_of(const char *name)
{
    for (size_t i = 0; i < sizeof(libraries) / sizeof(libraries[0]); i++)
        if (!strcmp(libraries[i].name, name))
            return &libraries[i];
    return &other_library;
}

static struct encoder *h264_create(struct log *log, const char *library)
{
    struct h264_encoder *h264 = mem_new(sizeof(*h264));
    h264->base = (struct encoder){ .impl = &h264_impl, .log = log };
    h264->codec = avcodec_find_encoder_by_name(library);
    h264->library = library_of(library);
    h264->out = av_packet_alloc();
    av_log_set_level(AV_LOG_ERROR);
    if (h264->out && h264->codec && h264->codec->id == AV_CODEC_ID_H264)
        return &h264->base;
    log_err(log, "h264: libavcodec has no encoder for it named '%s'", library);
    h264_destroy(&h264->base);
    return NULL;
}

static int failed(const struct h264_encoder *h264, const char *what, int status)
{
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(status, text, sizeof(text));
    log_err(h264->base.log, "h264 by %s, %dx%d: %s: %s", h264->codec->name, h264->width_px, h264->height_px, what, text);
    return status == AVERROR(ENOMEM) ? -ENOMEM : -EIO;
}

/* Slices only where one core would be late; where there are many, for each part of a picture so large. */
static int thread_count(int width_px, int height_px)
{
    long cores = sysconf(_SC_NPROCESSORS_ONLN), pixels = (long)width_px * height_px;
    if (cores < MANY_CORES)
        return pixels < SLICED_PX || cores < 2 ? 1 : cores < 4 ? (int)cores : 4;
    long parts = 1 + MOST_THREADS * pixels / (SLICED_PX + SLICED_PX / 4), most = cores / 2 < MOST_THREADS ? cores / 2 : MOST_THREADS;
    return (int)(parts < most ? parts : most);
}

/* Colours are what JPEG has them, BT.601 at full range: libyuv's fastest, and what browsers turn back most exactly (of BT.709 and limited
   range at that, chromium is up to 12 of 255 off). */
static void describe(AVCodecContext *context, const struct h264_encoder *h264)
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
        context->bit_rate = (int64_t)h264->width_px * h264->height_px * OTHERS_BITS_PER_PX_S;
}

static int open_codec(struct h264_encoder *h264, const struct frame *frame)
{
    AVDictionary *options = NULL;
    close_codec(h264);
    h264->width_px = frame->width_px;
    h264->height_px = frame->height_px;
    h264->context = avcodec_alloc_context3(h264->codec);
    h264->picture = av_frame_alloc();
    if (!h264->context || !h264->picture)
        return failed(h264, "begin", AVERROR(ENOMEM));
    describe(h264->context, h264);
    int status = h264_upload_create(h264->context, &h264->upload);
    if (status < 0)
        return failed(h264, "its device", status);
    av_dict_parse_string(&options, h264->library->options, "=", " ", 0);
    status = avcodec_open2(h264->context, h264->codec, &options);
    av_dict_free(&options);
    if (status < 0)
        return failed(h264, "begin", status);
    h264->picture->width = h264->context->width;
    h264->picture->height = h264->context->height;
    h264->picture->format = AV_PIX_FMT_YUV420P;
    h264->picture->color_range = AVCOL_RANGE_JPEG;
    status = av_frame_get_buffer(h264->picture, 0);
    return status < 0 ? failed(h264, "begin", status) : 0;
}

/* Luma beyond an odd edge is what stands at the edge. */
static void extend(AVFrame *picture, int width_px, int height_px)
{
    size_t pitch = (size_t)picture->linesize[0];
    for (int y = 0; y < height_px && picture->width > width_px; y++)
        picture->data[0][(size_t)y * pitch + (size_t)width_px] = picture->data[0][(size_t)y * pitch + (size_t)width_px - 1];
    if (picture->height > height_px)
        memcpy(picture->data[0] + (size_t)height_px * pitch, picture->data[0] + (size_t)(height_px - 1) * pitch, (size_t)picture->width);
}

static void convert_bands(void *arg, size_t begin, size_t end)
{
    planes_convert(arg, begin, end);
}

static void convert(struct h264_encoder *h264, const struct frame *frame, struct workers *workers)
{
    AVFrame *p = h264->picture;
    struct planes planes = { frame->bgrx,
                             frame->stride_bytes,
                             frame->width_px,
                             frame->height_px,
                             { p->data[0], p->data[1], p->data[2] },
                             { p->linesize[0], p->linesize[1], p->linesize[2] } };
    size_t bands = planes_bands(frame->height_px);
    if (workers)
        workers_for(workers, bands, GRAIN_ROWS / PLANES_BAND_PX, convert_bands, &planes);
    else
        convert_bands(&planes, 0, bands);
    extend(p, frame->width_px, frame->height_px);
}

/* JPEG's 92 looks as 18 does, 78 as 25. Below that, bytes go down with quality as JPEG's do, and looks more slowly: from 40 on nearly all
   blocks of a picture that moves are skipped, and it shows what stood there before. */
static double rate_factor(int quality)
{
    static const double fine = 18, moving = 25;
    return quality >= 100 ? 12 : quality >= 78 ? fine + (92 - quality) * 0.5 : moving + (78 - quality) / 6.0;
}

static int fill_picture(struct h264_encoder *h264, const struct frame *frame, const struct encoder_params *params)
{
    AVFrame *p = h264->picture;
    int status = av_frame_make_writable(p);
    if (status < 0)
        return status;
    convert(h264, frame, params->workers);
    p->pts = h264->next++;
    p->pict_type = params->key ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
    if (h264->library->has_crf)
        av_opt_set_double(h264->context->priv_data, "crf", rate_factor(params->quality), 0);
    return 0;
}

static int h264_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params, const struct dirty_rect *rects,
                     int count)
{
    struct h264_encoder *h264 = (struct h264_encoder *)encoder;
    bool fits = h264->context && h264->width_px == frame->width_px && h264->height_px == frame->height_px;
    (void)rects; /* what did not change is skipped block by block */
    (void)count;
    int status = fits ? 0 : open_codec(h264, frame);
    if (status < 0) {
        close_codec(h264);
        return status;
    }
    if ((status = fill_picture(h264, frame, params)) < 0 || (status = h264_upload_send(h264->upload, h264->context, h264->picture)) < 0 ||
        (status = avcodec_receive_packet(h264->context, h264->out)) < 0) {
        status = failed(h264, "encode", status);
        close_codec(h264);
        return status;
    }
    encoder->ready =
        packet_create(frame, WIRE_CODEC_H264, (h264->out->flags & AV_PKT_FLAG_KEY) != 0, h264->out->data, (size_t)h264->out->size);
    av_packet_unref(h264->out);
    return encoder->ready ? 0 : -ENOMEM;
}

const struct encoder_impl h264_impl = {
    .name = "h264", .is_stream = true, .create = h264_create, .send = h264_send, .destroy = h264_destroy
};
