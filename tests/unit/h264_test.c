/* SPDX-License-Identifier: GPL-3.0-or-later */
/* H.264: libavcodec decodes each frame to what was encoded; key frames come when requested, and the stream states its colour space. */
#include "tests/support/test.h"

#include "encode/encoder.h"

#ifdef PLANTCAST_H264
#include <libavcodec/avcodec.h>
#include <libyuv.h>

struct h264_fixture {
    struct log *log;
    struct workers *workers; /* threads that help to convert colours; NULL: none */
    struct encoder *encoder;
    AVCodecContext *decoder;
    AVFrame *picture;
    uint8_t *bgrx; /* the decoded picture */
    size_t bytes;  /* size of the last packet */
    bool key;
};

static void begin(struct h264_fixture *f)
{
    f->log = test_log();
    f->encoder = encoder_create(f->log, "h264", ENCODER_H264_LIBRARY);
    f->decoder = avcodec_alloc_context3(avcodec_find_decoder(AV_CODEC_ID_H264));
    f->decoder->flags |= AV_CODEC_FLAG_LOW_DELAY;
    f->decoder->thread_count = 1;
    f->picture = av_frame_alloc();
    assert_true(f->encoder && avcodec_open2(f->decoder, NULL, NULL) == 0);
}

static void end(struct h264_fixture *f)
{
    encoder_destroy(&f->encoder);
    avcodec_free_context(&f->decoder);
    av_frame_free(&f->picture);
    mem_free(f->bgrx);
}

TEST_FIXTURE(struct h264_fixture, begin, end)

#define CASE(name) TEST_ON(struct h264_fixture *f, name, set_up, tear_down)

/* Makes a frame with coloured patches on grey with thin lines; `level`: brightness of the patches. */
static struct frame *picture(int w, int h, int level)
{
    static const uint8_t patches[4][3] = { { 40, 40, 200 }, { 60, 160, 40 }, { 200, 70, 50 }, { 40, 200, 240 } };
    struct frame *frame = frame_create(NULL, w, h);
    frame->view.width_px = w;
    frame->view.height_px = h;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            uint8_t *p = frame->bgrx + (size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4;
            int column = x * 8 / w, line = x % 40 == 0 ? 60 : 225;
            for (int c = 0; c < 3; c++)
                p[c] = (uint8_t)(column % 2 ? patches[column / 2][c] + level : line);
        }
    return frame;
}

/* Encodes and decodes a frame. Returns false if nothing had changed. */
static bool pass(struct h264_fixture *f, struct frame *frame, int quality, bool key, struct frame *before)
{
    struct encoder_params params = { .quality = quality, .key = key, .workers = f->workers, .before = before };
    struct packet *packet;
    assert_int_equal(encoder_send(f->encoder, frame, &params), 0);
    if (encoder_receive(f->encoder, &packet) != 0)
        return false;
    assert_int_equal(packet->codec, WIRE_CODEC_H264);
    AVPacket *in = av_packet_alloc();
    assert_int_equal(av_new_packet(in, (int)packet->count), 0);
    memcpy(in->data, packet->bytes, packet->count);
    assert_int_equal(avcodec_send_packet(f->decoder, in), 0);
    /* the decoder returns the frame for its own packet, so the encoder has not held it back */
    assert_int_equal(avcodec_receive_frame(f->decoder, f->picture), 0);
    av_packet_free(&in);
    f->key = packet->key;
    f->bytes = packet->count;
    packet_unref(&packet);
    const AVFrame *p = f->picture;
    assert_true(p->width == ((frame->width_px + 1) & ~1) && p->height == ((frame->height_px + 1) & ~1));
    mem_free(f->bgrx);
    f->bgrx = mem_array((size_t)frame->height_px, (size_t)frame->width_px * 4);
    J420ToARGB(p->data[0], p->linesize[0], p->data[1], p->linesize[1], p->data[2], p->linesize[2], f->bgrx, frame->width_px * 4,
               frame->width_px, frame->height_px);
    return true;
}

/* Returns the largest error of any channel among the middle pixels of the patches. */
static int worst(const struct h264_fixture *f, const struct frame *frame)
{
    int most = 0, w = frame->width_px, h = frame->height_px;
    for (int column = 1; column < 8; column += 2) {
        size_t at = (size_t)(h / 2) * (size_t)w + (size_t)(w * (2 * column + 1) / 16);
        for (size_t c = 0; c < 3; c++)
            most = abs(frame->bgrx[at * 4 + c] - f->bgrx[at * 4 + c]) > most ? abs(frame->bgrx[at * 4 + c] - f->bgrx[at * 4 + c]) : most;
    }
    return most;
}

static void check_size(struct h264_fixture *f, int w, int h)
{
    struct frame *frame = picture(w, h, 0);
    assert_true(pass(f, frame, 92, false, NULL)); /* a new frame size restarts the encoder */
    assert_true(f->key);
    assert_in_range(worst(f, frame), 0, 6);
    frame_unref(&frame);
}

CASE(colours_are_kept_at_any_size)
{
    check_size(f, 640, 360);
    check_size(f, 333, 77);
    check_size(f, 160, 91);
    check_size(f, 16, 16);
}

/* Colour conversion with rows split among threads gives the same picture as one thread. */
CASE(many_make_the_same_picture)
{
    for (int odd = 0; odd < 2; odd++) {
        struct frame *frame = picture(322 - odd, 1042 + odd, 0);
        size_t bytes = (size_t)frame->width_px * 4 * (size_t)frame->height_px;
        assert_true(pass(f, frame, 92, true, NULL));
        uint8_t *alone = f->bgrx;
        f->bgrx = NULL;
        f->workers = workers_create(3);
        assert_true(pass(f, frame, 92, true, NULL));
        workers_destroy(&f->workers);
        assert_memory_equal(f->bgrx, alone, bytes);
        mem_free(alone);
        frame_unref(&frame);
    }
}

CASE(colours_are_described)
{
    struct frame *frame = test_frame(picture(320, 180, 0));
    pass(f, frame, 92, true, NULL);
    assert_int_equal(f->picture->color_range, AVCOL_RANGE_JPEG);
    assert_int_equal(f->picture->colorspace, AVCOL_SPC_SMPTE170M);
    assert_int_equal(f->picture->color_primaries, AVCOL_PRI_BT709);
    assert_int_equal(f->picture->color_trc, AVCOL_TRC_IEC61966_2_1);
    assert_int_equal(f->decoder->has_b_frames, 0);
}

CASE(key_frames_come_on_demand_only)
{
    for (int i = 0; i < 400; i++) {
        struct frame *frame = picture(160, 90, i % 3 * 30);
        pass(f, frame, 78, i == 200, NULL);
        assert_int_equal(f->key, i == 0 || i == 200);
        frame_unref(&frame);
    }
}

CASE(equal_pictures_are_not_sent_and_little_costs_little)
{
    struct frame *frame = test_frame(picture(1280, 720, 0)), *same = test_frame(picture(1280, 720, 0)), *near = picture(1280, 720, 0);
    memset(near->bgrx + 300 * (size_t)near->stride_bytes, 250, 64 * 4);
    pass(f, frame, 92, true, NULL);
    size_t whole = f->bytes;
    assert_false(pass(f, same, 92, false, frame));
    assert_true(pass(f, near, 92, false, frame));
    assert_true(!f->key && f->bytes < 600 && f->bytes * 10 < whole);
    frame_unref(&near);
}

/* The picture changes so slowly that each frame differs from the last one by less than a quantisation step. The decoded picture
   must not fall behind. */
CASE(what_changes_slowly_arrives)
{
    struct frame *before = NULL;
    for (int i = 0; i < 50; i++) {
        struct frame *frame = picture(640, 360, i / 2);
        pass(f, frame, 92, i == 0, before);
        assert_in_range(worst(f, frame), 0, 7);
        if (before)
            frame_unref(&before);
        before = frame;
    }
    frame_unref(&before);
}

CASE(quality_can_change_between_pictures)
{
    size_t bytes[3];
    for (int i = 0; i < 3; i++) {
        struct frame *frame = picture(640, 360, 0);
        for (size_t p = 0; p < (size_t)frame->height_px * (size_t)frame->stride_bytes; p += 4)
            memset(frame->bgrx + p, rand() % 64 + 64, 3);
        pass(f, frame, (const int[]){ 40, 92, 40 }[i], true, NULL);
        bytes[i] = f->bytes;
        frame_unref(&frame);
    }
    assert_true(bytes[1] > 2 * bytes[0] && bytes[1] > 2 * bytes[2]);
}

/* Makes a picture of grey shapes of low contrast on grey, like a building from afar. `turn` shifts them, as a moving camera
   does; nearer rows more. */
static struct frame *building(int w, int h, int turn)
{
    struct frame *frame = frame_create(NULL, w, h);
    frame->view.width_px = w;
    frame->view.height_px = h;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            int along = x + turn * (2 + y / 60), row = y / 40, shape = (along / 30 * 7 + row * 5) % 11;
            int inside = along % 30 < 4 + shape && y % 40 > 3 * shape;
            memset(frame->bgrx + (size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4, 222 - y / 20 - inside * (30 + 2 * shape), 3);
        }
    return frame;
}

static double mean_off(const struct h264_fixture *f, const struct frame *frame)
{
    double sum = 0;
    size_t pixels = (size_t)frame->width_px * (size_t)frame->height_px;
    for (size_t i = 0; i < pixels; i++)
        sum += abs(f->bgrx[4 * i + 1] - frame->bgrx[4 * i + 1]);
    return sum / (double)pixels;
}

/* While the camera moves, each decoded frame must show the shapes where they are now, without traces where they were, at any
   quality. */
CASE(what_moves_leaves_nothing_behind)
{
    static const int qualities[] = { 78, 42, 30, 25 };
    for (size_t q = 0; q < sizeof(qualities) / sizeof(qualities[0]); q++) {
        struct frame *first = building(640, 360, 0);
        pass(f, first, qualities[q], true, NULL);
        for (int turn = 1; turn <= 12; turn++) {
            struct frame *frame = building(640, 360, turn);
            pass(f, frame, qualities[q], false, NULL);
            double off = mean_off(f, frame), moved = 0;
            for (size_t i = 0; i < (size_t)640 * 360; i++)
                moved += abs(frame->bgrx[4 * i + 1] - first->bgrx[4 * i + 1]) / (640.0 * 360);
            if (turn == 12)
                print_message("# quality %d: %zu bytes, %.2f off, where %.2f moved\n", qualities[q], f->bytes, off, moved);
            assert_true(off < 0.25 * moved);
            frame_unref(&frame);
        }
        frame_unref(&first);
    }
}

CASE(encoders_that_do_not_work_here_are_known)
{
    assert_true(encoder_works(f->log, "h264", ENCODER_H264_LIBRARY));
    /* libavcodec has an encoder "mjpeg", but it does not make H.264, so it must be rejected */
    assert_false(encoder_works(f->log, "h264", "mjpeg"));
    assert_false(encoder_works(f->log, "h264", "h264_nothing"));
    assert_true(encoder_is_stream("h264") && !encoder_is_stream("jpeg"));
}
#else
TEST(there_is_none)
{
    struct log *log = test_log();
    assert_false(encoder_works(log, "h264", ENCODER_H264_LIBRARY));
}
#endif
