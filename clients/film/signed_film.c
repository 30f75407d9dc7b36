/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes a film's signed statements, one by the server for each picture, as one metadata text: JSON, compressed, in base64. */
#include "signed_film.h"

#include <inttypes.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <openssl/evp.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "base/text/timestamp.h"
#include "film_boxes.h"

#define FILM_KEY "plantcast_statements"
/* maximum size in bytes of the metadata text with the signed statements of all pictures: MAX_BYTES compressed, MAX_TEXT_BYTES
   uncompressed */
static const size_t MAX_BYTES = (size_t)64 << 20, MAX_TEXT_BYTES = (size_t)1 << 30;

/* --- writing ------------------------------------------------------------------------------------------------------------------- */

struct film_statements {
    struct text list; /* JSON array of all statements added so far, without its closing bracket */
};

struct film_statements *film_statements_create(void)
{
    return mem_new(sizeof(struct film_statements));
}

void film_statements_destroy(struct film_statements **statements)
{
    if (*statements)
        text_finish(&(*statements)->list);
    mem_free(*statements);
    *statements = NULL;
}

bool film_statements_add(struct film_statements *statements, const uint8_t *png, size_t count)
{
    char *statement, *signature;
    if (!signed_picture_take(png, count, &statement, &signature))
        return false;
    json_t *both = json_pack("[s,s]", statement, signature);
    char *text = json_dumps(both, JSON_COMPACT | JSON_ENSURE_ASCII);
    text_add(&statements->list, "%s", statements->list.length > 0 ? "," : "[");
    text_add_bytes(&statements->list, text, strlen(text));
    free(text);
    json_decref(both);
    mem_free(statement);
    mem_free(signature);
    return true;
}

bool film_statements_put(const struct film_statements *statements, struct video *video)
{
    struct text all = { 0 };
    text_add_bytes(&all, statements->list.at, statements->list.length);
    text_add(&all, "]");
    uLongf count = compressBound(all.length);
    uint8_t *bytes = mem_array(count, 1);
    bool good = all.length <= MAX_TEXT_BYTES && compress2(bytes, &count, (const Bytef *)all.at, all.length, 9) == Z_OK;
    good = good && count <= MAX_BYTES;
    if (good) {
        char *base64 = mem_array(4 * (count / 3 + 1) + 1, 1);
        EVP_EncodeBlock((unsigned char *)base64, bytes, (int)count);
        video_set_text(video, FILM_KEY, base64);
        mem_free(base64);
    } else {
        fprintf(stderr,
                "plantcast: the signed statements of all frames are too long for one clip: use a lower --fps or a shorter period\n");
    }
    mem_free(bytes);
    text_finish(&all);
    return good;
}

/* --- reading ------------------------------------------------------------------------------------------------------------------- */

struct film_reader {
    AVFormatContext *format;
    AVCodecContext *codec;
    AVPacket *packet;
    AVFrame *frame;
    bool ended;
    struct film_size size; /* display size */
    json_t *statements;    /* JSON array of [statement, signature] pairs, one per picture */
    char why[SIGNED_PICTURE_WHY_BYTES];
};

#define FAIL(...) (snprintf(reader->why, sizeof(reader->why), __VA_ARGS__), false)

/* Decodes the signed statements from base64 and decompresses them. Returns false with the reason in reader->why. */
static bool read_statements(struct film_reader *reader)
{
    const AVDictionaryEntry *entry = av_dict_get(reader->format->metadata, FILM_KEY, NULL, AV_DICT_MATCH_CASE);
    size_t length = entry ? strlen(entry->value) : 0;
    if (length < 4 || length % 4 || length > 2 * MAX_BYTES)
        return FAIL("the clip has no signed statements: the clip is damaged, or not made by `plantcast clip --signed`");
    uint8_t *bytes = mem_array(length, 1);
    int count = EVP_DecodeBlock(bytes, (const unsigned char *)entry->value, (int)length);
    count -= (entry->value[length - 1] == '=') + (entry->value[length - 2] == '=');
    struct text text = { 0 };
    uint8_t piece[65536];
    z_stream stream = { .next_in = bytes, .avail_in = count > 0 ? (uInt)count : 0 };
    int status = inflateInit(&stream);
    while (status == Z_OK && text.length < MAX_TEXT_BYTES) {
        stream.next_out = piece;
        stream.avail_out = sizeof(piece);
        status = inflate(&stream, Z_NO_FLUSH);
        text_add_bytes(&text, piece, sizeof(piece) - stream.avail_out);
    }
    inflateEnd(&stream);
    reader->statements = status == Z_STREAM_END ? json_loadb(text.at, text.length, JSON_REJECT_DUPLICATES, NULL) : NULL;
    text_finish(&text);
    mem_free(bytes);
    return json_is_array(reader->statements) || FAIL("the clip is damaged: its signed statements cannot be read");
}

/* Opens a film and checks that it has one stream that every player shows unchanged. The decoder takes the colour description
   from the stream alone, because film_boxes_plain() has already checked the container's. Returns false with the reason in
   reader->why. */
static bool open_film(struct film_reader *reader, const char *path)
{
    av_log_set_level(AV_LOG_QUIET);
    if (!film_boxes_plain(path, &reader->size, reader->why))
        return false;
    if (avformat_open_input(&reader->format, path, NULL, NULL) < 0 || avformat_find_stream_info(reader->format, NULL) < 0)
        return FAIL("the clip is damaged or incomplete: libavformat cannot read its streams");
    const AVStream *stream = reader->format->nb_streams == 1 ? reader->format->streams[0] : NULL;
    if (!stream || stream->codecpar->codec_id != AV_CODEC_ID_H264)
        return FAIL("the clip was not made by `plantcast clip --signed`: expected one H.264 stream and nothing else in the file");
    const AVCodec *decoder = avcodec_find_decoder(AV_CODEC_ID_H264);
    reader->codec = decoder ? avcodec_alloc_context3(decoder) : NULL;
    reader->packet = av_packet_alloc();
    reader->frame = av_frame_alloc();
    if (!reader->codec || !reader->packet || !reader->frame || avcodec_parameters_to_context(reader->codec, stream->codecpar) < 0)
        return FAIL("libavcodec on this machine cannot decode H.264, so the clip cannot be verified");
    reader->codec->thread_count = 1;
    reader->codec->color_primaries = AVCOL_PRI_UNSPECIFIED;
    reader->codec->color_trc = AVCOL_TRC_UNSPECIFIED;
    reader->codec->colorspace = AVCOL_SPC_UNSPECIFIED;
    reader->codec->color_range = AVCOL_RANGE_UNSPECIFIED;
    reader->codec->err_recognition = AV_EF_EXPLODE | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_CRCCHECK;
    return (avcodec_open2(reader->codec, decoder, NULL) >= 0 ||
            FAIL("libavcodec on this machine cannot decode H.264, so the clip cannot be verified")) &&
           read_statements(reader);
}

static void close_film(struct film_reader *reader)
{
    json_decref(reader->statements);
    av_frame_free(&reader->frame);
    av_packet_free(&reader->packet);
    avcodec_free_context(&reader->codec);
    avformat_close_input(&reader->format);
}

/* Decodes the next picture into reader->frame. Returns false at the end of the film, or with reader->why set if decoding fails. */
static bool next_picture(struct film_reader *reader)
{
    for (;;) {
        int status = avcodec_receive_frame(reader->codec, reader->frame);
        if (status >= 0)
            return true;
        if (status == AVERROR_EOF)
            return false;
        if (status != AVERROR(EAGAIN))
            return FAIL("the clip is damaged: a frame cannot be decoded");
        status = reader->ended ? AVERROR_EOF : av_read_frame(reader->format, reader->packet);
        if (status < 0 && status != AVERROR_EOF)
            return FAIL("the clip is damaged: it cannot be read to its end");
        reader->ended = status < 0;
        if (!reader->ended && !film_units_plain(reader->packet->data, (size_t)reader->packet->size, reader->why))
            return false;
        status = avcodec_send_packet(reader->codec, reader->ended ? NULL : reader->packet);
        av_packet_unref(reader->packet);
        if (status < 0 && status != AVERROR_EOF)
            return FAIL("the clip is damaged: a frame cannot be decoded");
    }
}

/* Returns true if the stream describes the picture's colours and pixels exactly as film/video.c writes them: RGB, not cropped,
   square pixels. Checked for each picture, because a stream may change the description later. */
static bool is_plain_picture(struct film_reader *reader)
{
    const AVFrame *frame = reader->frame;
    if (frame->format != AV_PIX_FMT_GBRP || frame->crop_left || frame->crop_right || frame->crop_top || frame->crop_bottom)
        return FAIL("the clip was changed, or not made by `plantcast clip --signed`: this frame is encoded in another way");
    if (frame->color_primaries != AVCOL_PRI_BT709 || frame->color_trc != AVCOL_TRC_IEC61966_2_1 || frame->colorspace != AVCOL_SPC_RGB ||
        frame->color_range != AVCOL_RANGE_JPEG)
        return FAIL("the clip was changed: its H.264 stream (VUI) states other colours than Plantcast writes: primaries %d, transfer %d, "
                    "matrix %d, range %d",
                    (int)frame->color_primaries, (int)frame->color_trc, (int)frame->colorspace, (int)frame->color_range);
    if (frame->sample_aspect_ratio.num != 0 && av_cmp_q(frame->sample_aspect_ratio, (AVRational){ 1, 1 }) != 0)
        return FAIL("the clip was changed: its H.264 stream (VUI) states that pixels are not square");
    return (frame->width == reader->size.width_px && frame->height == reader->size.height_px) ||
           FAIL("the clip was changed: MP4 box avc1 states %dx%d pixels, but the frames have %dx%d", reader->size.width_px,
                reader->size.height_px, frame->width, frame->height);
}

/* Returns the picture's pixels as red, green, blue (mem_free), or NULL if its colours or pixels are not described as
   film/video.c writes them. */
static uint8_t *pixels_of(struct film_reader *reader)
{
    const AVFrame *frame = reader->frame;
    if (!is_plain_picture(reader))
        return NULL;
    uint8_t *rgb = mem_array((size_t)frame->width * (size_t)frame->height, 3), *out = rgb;
    for (int y = 0; y < frame->height; y++)
        for (int x = 0; x < frame->width; x++, out += 3) {
            out[0] = frame->data[2][y * frame->linesize[2] + x];
            out[1] = frame->data[0][y * frame->linesize[0] + x];
            out[2] = frame->data[1][y * frame->linesize[1] + x];
        }
    return rgb;
}

/* --- verifying ----------------------------------------------------------------------------------------------------------------- */

struct film_check {
    const struct signing_key *key;
    const struct redraw_options *options;
    struct film_reader reader;
    bool tour;              /* true: the view may change between pictures */
    json_t *first;          /* statement of the first picture */
    json_t *views;          /* JSON array of the film's views in order, each with its query and start time */
    int64_t at_us, step_us; /* at_us: instant of the previous picture; step_us: time between the instants of two pictures, 0: not known
                               yet */
    int64_t pts, pts_step;  /* pts: presentation time of the previous picture; pts_step: difference between two presentation times, 0: not
                               known yet */
    size_t count;           /* number of verified pictures */
    int code;
};

/* Returns true if two snapshot queries are equal except for the instant. */
static bool same_view(const json_t *query, const json_t *other)
{
    bool same = json_array_size(query) == json_array_size(other);
    for (size_t i = 0; i < json_array_size(query) && same; i++)
        same = !strncmp(json_string_value(json_array_get(query, i)), "at=", 3) ||
               json_equal(json_array_get(query, i), json_array_get(other, i));
    return same;
}

/* Checks that a picture has the same view as the first one, unless --tour allows changes. Returns false if not. */
static bool takes_view(struct film_check *check, const json_t *statement)
{
    struct film_reader *reader = &check->reader;
    json_t *query = json_object_get(statement, "query");
    const json_t *last = json_object_get(json_array_get(check->views, json_array_size(check->views) - 1), "query");
    if (last && same_view(query, last))
        return true;
    if (last && !check->tour)
        return FAIL("this frame shows another view than the first frame: for a clip of a tour, add --tour");
    json_array_append_new(check->views, json_pack("{s:O,s:O}", "query", query, "at_us", json_object_get(statement, "at_us")));
    return true;
}

/* Checks that a picture has the same plant, size and server as the film's first one, and that its instant and presentation time follow
   those of the previous picture by constant steps. Returns false if not. */
static bool follows(struct film_check *check, const json_t *statement)
{
    static const char *const same[] = { "server", "plant", "configuration", "assets", "width", "height", "bare" };
    struct film_reader *reader = &check->reader;
    int64_t at_us = json_integer_value(json_object_get(statement, "at_us")), pts = reader->frame->pts;
    if (at_us == 0)
        return FAIL("the frame shows live readings, but `plantcast clip` makes only frames of recorded readings: the clip was changed");
    for (size_t i = 0; i < sizeof(same) / sizeof(*same) && check->first; i++)
        if (!json_equal(json_object_get(statement, same[i]), json_object_get(check->first, same[i])))
            return FAIL(
                "the frame's signed statement has another value of '%s' than the first frame's: the frames are from different clips",
                same[i]);
    if (!takes_view(check, statement))
        return false;
    int64_t step_us = at_us - check->at_us, pts_step = pts - check->pts;
    if (check->count > 0 && (step_us <= 0 || (check->step_us && llabs(step_us - check->step_us) > 1)))
        return FAIL("the clip was changed: the frame before this one is missing, or frames were moved or inserted");
    if (check->count > 0 && (pts_step <= 0 || (check->pts_step && pts_step != check->pts_step)))
        return FAIL("the clip was changed: this frame is shown for another time than the other frames");
    check->step_us = check->count > 0 ? step_us : 0;
    check->pts_step = check->count > 0 ? pts_step : 0;
    check->at_us = at_us;
    check->pts = pts;
    return true;
}

static bool verify_picture(struct film_check *check)
{
    struct film_reader *reader = &check->reader;
    const json_t *pair = json_array_get(reader->statements, check->count);
    const char *text = json_string_value(json_array_get(pair, 0)), *signature = json_string_value(json_array_get(pair, 1));
    uint8_t *rgb = pixels_of(reader);
    json_t *statement = NULL;
    bool good = rgb && ((text && signature) || FAIL("the clip was changed: this frame has no signed statement"));
    good = good && (statement = signed_statement_verify(check->key, text, strlen(text), signature, reader->why));
    good = good && signed_statement_has_pixels(statement, rgb, reader->frame->width, reader->frame->height, reader->why);
    good = good && follows(check, statement);
    if (good && !check->first)
        check->first = json_incref(statement);
    if (good && check->options->plant) {
        int code = redraw_compare(check->options, statement, rgb);
        check->code = code > check->code ? code : check->code;
    }
    json_decref(statement);
    mem_free(rgb);
    return good;
}

static void print_view(const json_t *view)
{
    char since[TIMESTAMP_BYTES];
    const json_t *query = json_object_get(view, "query"), *arg;
    size_t i;
    timestamp_print(json_integer_value(json_object_get(view, "at_us")), since);
    printf("  view from %s:", since);
    json_array_foreach(query, i, arg) if (strncmp(json_string_value(arg), "at=", 3) != 0) printf(" %s", json_string_value(arg));
    puts(json_array_size(query) > 1 ? "" : " the plant's own");
}

static void print_film(const struct film_check *check, const char *path)
{
    const json_t *view;
    size_t i;
    char from[TIMESTAMP_BYTES], to[TIMESTAMP_BYTES];
    timestamp_print(json_integer_value(json_object_get(check->first, "at_us")), from);
    timestamp_print(check->at_us, to);
    printf("%s: the signatures of all %zu frames are good, and no frame is missing between the first and the last\n", path, check->count);
    printf("  plant %s, configuration %s, plantcastd %s\n", json_string_value(json_object_get(check->first, "plant")),
           json_string_value(json_object_get(check->first, "configuration")), json_string_value(json_object_get(check->first, "server")));
    json_array_foreach(check->views, i, view) print_view(view);
    printf("  from %s to %s (history), one frame every %.6g s\n", from, to, (double)check->step_us / 1e6);
}

int film_verify(const struct signing_key *key, const char *path, const struct redraw_options *options, bool tour)
{
    struct film_check check = { .key = key, .options = options, .tour = tour };
    struct film_reader *reader = &check.reader;
    check.views = json_array();
    bool opened = open_film(reader, path), good = opened;
    while (good && next_picture(reader)) {
        good = verify_picture(&check);
        check.count += good;
        av_frame_unref(reader->frame);
    }
    good = good && !*reader->why;
    if (good && check.count != json_array_size(reader->statements))
        good = FAIL("the clip was changed: it has %zu frames, but signed statements for %zu frames", check.count,
                    json_array_size(reader->statements));
    good = good && (check.count > 0 || FAIL("the clip has no frame, so there is nothing to verify"));
    if (good)
        print_film(&check, path);
    else if (opened)
        fprintf(stderr, "plantcast: %s: frame %zu: %s\n", path, check.count + 1, reader->why);
    else
        fprintf(stderr, "plantcast: %s: %s\n", path, reader->why);
    json_decref(check.first);
    json_decref(check.views);
    close_film(reader);
    return good ? check.code : 1;
}
