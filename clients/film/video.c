/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes one H.264 stream to one video file. */
#include "video.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libyuv.h>
#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "base/mem.h"

struct video {
    const char *path;
    AVFormatContext *format;
    AVCodecContext *codec;
    AVStream *stream;
    AVFrame *picture;
    AVPacket *packet;
    bool lossless;
    bool begun; /* true: the video file exists and has its header */
    int64_t next;
};

static bool failed(const struct video *video, const char *what, int status)
{
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(status, text, sizeof(text));
    fprintf(stderr, "plantcast: %s: %s: %s\n", video->path, what, text);
    return false;
}

/* Sets the codec's parameters. Players expect limited range (brightness from 16 to 235); the colour matrix and transfer curve
   match the pictures. */
static void describe(struct video *video, int width_px, int height_px, double fps)
{
    AVCodecContext *codec = video->codec;
    codec->width = video->lossless ? width_px : width_px & ~1;
    codec->height = video->lossless ? height_px : height_px & ~1;
    codec->pix_fmt = video->lossless ? AV_PIX_FMT_BGR0 : AV_PIX_FMT_YUV420P;
    codec->framerate = av_d2q(fps, 1001000);
    codec->time_base = av_inv_q(codec->framerate);
    codec->color_range = video->lossless ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    codec->colorspace = video->lossless ? AVCOL_SPC_RGB : AVCOL_SPC_SMPTE170M;
    codec->color_primaries = AVCOL_PRI_BT709;
    codec->color_trc = AVCOL_TRC_IEC61966_2_1;
    codec->gop_size = (int)fmax(fps, 1); /* one key frame per second, so that players can seek */
    if (video->format->oformat->flags & AVFMT_GLOBALHEADER)
        codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    av_opt_set(codec->priv_data, "preset", "fast", 0);
    av_opt_set(codec->priv_data, video->lossless ? "qp" : "crf", video->lossless ? "0" : "18", 0);
}

static bool open_codec(struct video *video, int width_px, int height_px, double fps)
{
    const char *name = video->lossless ? "libx264rgb" : "libx264";
    const AVCodec *library = avcodec_find_encoder_by_name(name);
    if (!library) {
        fprintf(stderr, "plantcast: %s: libavcodec on this machine lacks the H.264 encoder %s, which clips need\n", video->path, name);
        return false;
    }
    video->codec = avcodec_alloc_context3(library);
    video->picture = av_frame_alloc();
    video->packet = av_packet_alloc();
    if (!video->codec || !video->picture || !video->packet)
        return failed(video, "begin", AVERROR(ENOMEM));
    describe(video, width_px, height_px, fps);
    int status = avcodec_open2(video->codec, library, NULL);
    video->picture->width = video->codec->width;
    video->picture->height = video->codec->height;
    video->picture->format = video->codec->pix_fmt;
    if (status >= 0)
        status = av_frame_get_buffer(video->picture, 0);
    return status >= 0 || failed(video, "H.264", status);
}

static bool open_file(struct video *video)
{
    AVDictionary *options = NULL;
    video->stream = avformat_new_stream(video->format, NULL);
    if (!video->stream)
        return failed(video, "begin", AVERROR(ENOMEM));
    video->stream->time_base = video->codec->time_base;
    video->stream->avg_frame_rate = video->codec->framerate;
    int status = avcodec_parameters_from_context(video->stream->codecpar, video->codec);
    if (status >= 0)
        status = avio_open(&video->format->pb, video->path, AVIO_FLAG_WRITE);
    if (status < 0)
        return failed(video, "cannot be written", status);
    video->begun = true;
    av_dict_set(&options, "movflags", "+faststart+use_metadata_tags", 0);
    status = avformat_write_header(video->format, &options);
    av_dict_free(&options);
    return status >= 0 || failed(video, "cannot be written", status);
}

void video_set_text(struct video *video, const char *key, const char *text)
{
    av_dict_set(&video->format->metadata, key, text, 0);
}

struct video *video_create(const char *path, int width_px, int height_px, double fps, bool lossless)
{
    struct video *video = mem_new(sizeof(*video));
    video->path = path;
    video->lossless = lossless;
    av_log_set_level(AV_LOG_ERROR);
    avformat_alloc_output_context2(&video->format, NULL, NULL, path);
    if (!video->format || video->format->oformat->video_codec == AV_CODEC_ID_NONE)
        fprintf(stderr, "plantcast: %s: unknown file format: the name must end in .mp4, .mkv or .mov\n", path);
    else if (open_codec(video, width_px, height_px, fps) && open_file(video))
        return video;
    video_finish(&video, false);
    return NULL;
}

/* Writes the encoder's finished packets to the file. Returns false on failure. */
static bool write_packets(struct video *video)
{
    int status;
    while ((status = avcodec_receive_packet(video->codec, video->packet)) >= 0) {
        av_packet_rescale_ts(video->packet, video->codec->time_base, video->stream->time_base);
        video->packet->stream_index = video->stream->index;
        status = av_interleaved_write_frame(video->format, video->packet);
        if (status < 0)
            return failed(video, "cannot be written", status);
    }
    return status == AVERROR(EAGAIN) || status == AVERROR_EOF || failed(video, "H.264", status);
}

bool video_add(struct video *video, const uint8_t *bgrx, int stride_bytes)
{
    AVFrame *picture = video->picture;
    int status = av_frame_make_writable(picture);
    if (status < 0)
        return failed(video, "H.264", status);
    if (video->lossless)
        ARGBCopy(bgrx, stride_bytes, picture->data[0], picture->linesize[0], picture->width, picture->height);
    else
        ARGBToI420(bgrx, stride_bytes, picture->data[0], picture->linesize[0], picture->data[1], picture->linesize[1], picture->data[2],
                   picture->linesize[2], picture->width, picture->height);
    picture->pts = video->next++;
    status = avcodec_send_frame(video->codec, picture);
    return status < 0 ? failed(video, "H.264", status) : write_packets(video);
}

static bool finish_file(struct video *video)
{
    int status = avcodec_send_frame(video->codec, NULL);
    if (status < 0)
        return failed(video, "H.264", status);
    if (!write_packets(video))
        return false;
    status = av_write_trailer(video->format);
    if (status >= 0)
        status = avio_closep(&video->format->pb);
    return status >= 0 || failed(video, "cannot be written", status);
}

bool video_finish(struct video **pointer, bool good)
{
    struct video *video = *pointer;
    if (!video)
        return false;
    good = good && video->begun && finish_file(video);
    if (video->format && video->format->pb)
        avio_closep(&video->format->pb);
    if (!good && video->begun)
        unlink(video->path);
    avcodec_free_context(&video->codec);
    av_frame_free(&video->picture);
    av_packet_free(&video->packet);
    avformat_free_context(video->format);
    mem_free(video);
    *pointer = NULL;
    return good;
}
