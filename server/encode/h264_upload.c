/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts planar frames (luma and chroma in separate planes) to the pixel format that an H.264 encoder of libavcodec accepts. */
#include "encode/h264_upload.h"

#include <libavutil/hwcontext.h>
#include <libavutil/pixdesc.h>
#include <libyuv.h>
#include <stdbool.h>

#include "base/mem.h"

struct h264_upload {
    AVFrame *interleaved; /* frame with interleaved chroma; NULL: the encoder accepts planes */
    bool device;          /* true: the encoder accepts only frames in its device's memory */
};

/* Returns the pixel formats that the encoder accepts, terminated by AV_PIX_FMT_NONE. NULL: any format. */
static const enum AVPixelFormat *formats_of(const AVCodec *codec)
{
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(61, 13, 100)
    const void *formats = NULL;
    return avcodec_get_supported_config(NULL, codec, AV_CODEC_CONFIG_PIX_FORMAT, 0, &formats, NULL) < 0 ? NULL : formats;
#else
    return codec->pix_fmts;
#endif
}

static bool takes(const AVCodec *codec, enum AVPixelFormat format)
{
    const enum AVPixelFormat *formats = formats_of(codec);
    for (const enum AVPixelFormat *at = formats; at && *at != AV_PIX_FMT_NONE; at++)
        if (*at == format)
            return true;
    return !formats;
}

/* Returns the type of device whose memory holds frames of this pixel format. */
static enum AVHWDeviceType device_type(enum AVPixelFormat format)
{
    for (enum AVHWDeviceType type = AV_HWDEVICE_TYPE_NONE; (type = av_hwdevice_iterate_types(type)) != AV_HWDEVICE_TYPE_NONE;) {
        const char *name = av_get_pix_fmt_name(format);
        if (name && av_hwdevice_find_type_by_name(name) == type)
            return type;
    }
    return AV_HWDEVICE_TYPE_NONE;
}

static int open_device(AVCodecContext *context)
{
    AVBufferRef *device = NULL;
    int status = av_hwdevice_ctx_create(&device, device_type(context->pix_fmt), NULL, NULL, 0);
    if (status < 0)
        return status;
    context->hw_frames_ctx = av_hwframe_ctx_alloc(device);
    av_buffer_unref(&device);
    if (!context->hw_frames_ctx)
        return AVERROR(ENOMEM);
    AVHWFramesContext *frames = (AVHWFramesContext *)context->hw_frames_ctx->data;
    frames->format = context->pix_fmt;
    frames->sw_format = AV_PIX_FMT_NV12;
    frames->width = context->width;
    frames->height = context->height;
    frames->initial_pool_size = 4;
    return av_hwframe_ctx_init(context->hw_frames_ctx);
}

static int make_interleaved(const AVCodecContext *context, struct h264_upload *upload)
{
    AVFrame *frame = upload->interleaved = av_frame_alloc();
    if (!frame)
        return AVERROR(ENOMEM);
    frame->width = context->width;
    frame->height = context->height;
    frame->format = AV_PIX_FMT_NV12;
    return av_frame_get_buffer(frame, 0);
}

int h264_upload_create(AVCodecContext *context, struct h264_upload **out)
{
    struct h264_upload *upload = *out = mem_new(sizeof(*upload));
    if (takes(context->codec, AV_PIX_FMT_YUV420P)) {
        context->pix_fmt = AV_PIX_FMT_YUV420P;
        return 0;
    }
    upload->device = !takes(context->codec, AV_PIX_FMT_NV12);
    context->pix_fmt = upload->device ? formats_of(context->codec)[0] : AV_PIX_FMT_NV12;
    int status = make_interleaved(context, upload);
    return status < 0 || !upload->device ? status : open_device(context);
}

void h264_upload_destroy(struct h264_upload **upload)
{
    if (!*upload)
        return;
    av_frame_free(&(*upload)->interleaved);
    mem_free(*upload);
    *upload = NULL;
}

static int send_from_device(AVCodecContext *context, const AVFrame *from)
{
    AVFrame *frame = av_frame_alloc();
    int status = frame ? av_hwframe_get_buffer(context->hw_frames_ctx, frame, 0) : AVERROR(ENOMEM);
    if (status >= 0 && (status = av_hwframe_transfer_data(frame, from, 0)) >= 0 && (status = av_frame_copy_props(frame, from)) >= 0)
        status = avcodec_send_frame(context, frame);
    av_frame_free(&frame);
    return status;
}

int h264_upload_send(struct h264_upload *upload, AVCodecContext *context, AVFrame *picture)
{
    AVFrame *to = upload->interleaved;
    if (!to)
        return avcodec_send_frame(context, picture);
    int status = av_frame_make_writable(to);
    if (status < 0 || (status = av_frame_copy_props(to, picture)) < 0)
        return status;
    I420ToNV12(picture->data[0], picture->linesize[0], picture->data[1], picture->linesize[1], picture->data[2], picture->linesize[2],
               to->data[0], to->linesize[0], to->data[1], to->linesize[1], picture->width, picture->height);
    return upload->device ? send_from_device(context, to) : avcodec_send_frame(context, to);
}
