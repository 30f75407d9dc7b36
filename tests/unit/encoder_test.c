/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encoders: decoded output equals the input, within the loss that each codec permits. */
#include "encode/encoder.h"

#include "tests/support/test.h"
#include <errno.h>
#include <png.h>
#include <turbojpeg.h>

static struct frame *gradient(int w, int h)
{
    struct frame *frame = frame_create(NULL, w, h);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            uint8_t *p = frame->bgrx + (size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4;
            p[0] = (uint8_t)(x * 255 / w);
            p[1] = (uint8_t)(y * 255 / h);
            p[2] = x < w / 2 ? 200 : 40;
            p[3] = 0x5a; /* BGRX: the fourth byte is not part of the picture, so it may have any value */
        }
    frame->marker_count = 1;
    frame->markers = mem_new(sizeof(*frame->markers));
    frame->markers[0] = (struct frame_marker){ .tag = 3, .x_px = 1.5f, .y_px = 2.5f, .occluded = 1 };
    return frame;
}

static struct packet *encode(const char *name, struct frame *frame, int quality, bool full_chroma)
{
    struct log *log = test_log();
    struct encoder *encoder = encoder_create(log, name, ENCODER_H264_LIBRARY);
    struct packet *packet = NULL, *none = NULL;
    assert_non_null(encoder);
    assert_int_equal(encoder_receive(encoder, &none), -EAGAIN);
    assert_int_equal(encoder_send(encoder, frame, &(struct encoder_params){ .quality = quality, .full_chroma = full_chroma }), 0);
    assert_int_equal(encoder_send(encoder, frame, &(struct encoder_params){ .quality = quality }), -EAGAIN);
    assert_int_equal(encoder_receive(encoder, &packet), 0);
    assert_int_equal(encoder_receive(encoder, &none), -EAGAIN);
    encoder_destroy(&encoder);
    assert_null(encoder);
    return packet;
}

static double worst_difference(const struct frame *frame, const uint8_t *bgr, int border)
{
    double worst = 0;
    for (int y = 0; y < frame->height_px; y++)
        for (int x = 0; x < frame->width_px; x++)
            for (int c = 0; c < 3 && abs(x - frame->width_px / 2) > border; c++) {
                int want = frame->bgrx[(size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4 + (size_t)c];
                int got = bgr[((size_t)y * (size_t)frame->width_px + (size_t)x) * 3 + (size_t)c];
                worst = abs(want - got) > worst ? abs(want - got) : worst;
            }
    return worst;
}

static void check_jpeg(int w, int h, int quality, bool full_chroma, double tolerance, int border)
{
    struct frame *frame = gradient(w, h);
    struct packet *packet = encode("jpeg", frame, quality, full_chroma);
    tjhandle turbo = tjInitDecompress();
    uint8_t *bgr = mem_array((size_t)w * (size_t)h, 3);
    int got_w, got_h, sampling, space;
    assert_int_equal(packet->codec, WIRE_CODEC_JPEG);
    assert_true(packet->key && packet->encode_ns > 0);
    assert_int_equal(tjDecompressHeader3(turbo, packet->bytes, packet->count, &got_w, &got_h, &sampling, &space), 0);
    assert_int_equal(got_w, w);
    assert_int_equal(got_h, h);
    assert_int_equal(sampling, full_chroma ? TJSAMP_444 : TJSAMP_420);
    assert_int_equal(tjDecompress2(turbo, packet->bytes, packet->count, bgr, w, w * 3, h, TJPF_BGR, 0), 0);
    assert_true(worst_difference(frame, bgr, border) <= tolerance);
    tjDestroy(turbo);
    mem_free(bgr);
    packet_unref(&packet);
    frame_unref(&frame);
}

TEST(jpeg_keeps_the_picture)
{
    check_jpeg(320, 200, 78, false, 24, 16);
    check_jpeg(320, 200, 95, true, 12, 0);
    check_jpeg(333, 77, 78, false, 30, 16); /* a size that is no multiple of JPEG's blocks */
    check_jpeg(16, 16, 90, true, 40, 8);
}

/* Returns whether column x belongs to a vertical line: lines are three pixels wide, alternately blue and amber, on grey. */
static bool is_line(int x)
{
    return x % 11 < 3;
}

static struct frame *thin_lines(int w, int h)
{
    /* colours of the two kinds of lines and of the background, in the order blue, green, red */
    static const uint8_t colors[3][3] = { { 231, 146, 89 }, { 42, 183, 216 }, { 230, 231, 232 } };
    struct frame *frame = frame_create(NULL, w, h);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            memcpy(frame->bgrx + (size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4, colors[is_line(x) ? x / 11 % 2 : 2], 3);
    return frame;
}

/* Returns the mean error, in steps of 1/255, of the blue channel of the thin lines' pixels after decoding the JPEG. */
static double lines_off(const struct frame *frame, const uint8_t *bytes, size_t count)
{
    int w = frame->width_px, h = frame->height_px, lines = 0;
    uint8_t *bgr = mem_array((size_t)w * (size_t)h, 3);
    tjhandle turbo = tjInitDecompress();
    double sum = 0;
    assert_int_equal(tjDecompress2(turbo, bytes, count, bgr, w, w * 3, h, TJPF_BGR, 0), 0);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            sum += is_line(x) ? abs(bgr[(y * w + x) * 3] - frame->bgrx[(size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4]) : 0;
            lines += is_line(x);
        }
    tjDestroy(turbo);
    mem_free(bgr);
    return sum / lines;
}

/* returns the number of bytes before the marker that begins the picture's data */
static size_t head_of(const uint8_t *bytes, size_t count)
{
    size_t at = 0;
    while (at + 1 < count && !(bytes[at] == 0xff && bytes[at + 1] == 0xda))
        at++;
    return at;
}

/* All preview JPEGs begin with the same header, which includes the quantisation tables. From JPEG_READ_QUALITY on, thin lines
   keep more of their colour than with libjpeg-turbo's own tables. */
TEST(jpeg_keeps_the_colour_of_thin_things)
{
    struct frame *frame = test_frame(thin_lines(320, 200));
    tjhandle turbo = tjInitCompress();
    for (int quality = 66; quality <= 80; quality += 14) {
        unsigned char *bytes = NULL;
        unsigned long count = 0;
        assert_int_equal(tjCompress2(turbo, frame->bgrx, 320, frame->stride_bytes, 200, TJPF_BGRX, &bytes, &count, TJSAMP_420, quality, 0),
                         0);
        struct packet *packet = encode("jpeg", frame, quality, false);
        size_t head = head_of(bytes, count);
        bool same = head == head_of(packet->bytes, packet->count) && memcmp(packet->bytes, bytes, head) == 0;
        double ours = lines_off(frame, packet->bytes, packet->count), standard = lines_off(frame, bytes, count);
        print_message("# quality %d: thin lines are %.1f off in %zu bytes, by the standard %.1f in %lu\n", quality, ours, packet->count,
                      standard, count);
        assert_true(same == (quality < 75));
        assert_true(quality < 75 || ours < 0.4 * standard);
        packet_unref(&packet);
        tjFree(bytes);
    }
    tjDestroy(turbo);
}

/* Decodes the parts of a packet into bgr, which holds the whole frame. */
static void decode_parts(const struct packet *packet, uint8_t *bgr)
{
    tjhandle turbo = tjInitDecompress();
    int w = packet->frame->width_px;
    for (int i = 0; i < packet->part_count; i++) {
        const struct packet_part *part = &packet->parts[i];
        uint8_t *to = bgr + ((size_t)part->y_px * (size_t)w + (size_t)part->x_px) * 3;
        int got_w, got_h, sampling, space;
        assert_int_equal(tjDecompressHeader3(turbo, packet->bytes + part->begin, part->count, &got_w, &got_h, &sampling, &space), 0);
        assert_true(got_w == part->width_px && got_h == part->height_px);
        assert_int_equal(tjDecompress2(turbo, packet->bytes + part->begin, part->count, to, got_w, w * 3, got_h, TJPF_BGR, 0), 0);
    }
    tjDestroy(turbo);
}

TEST(jpeg_sends_only_what_changed)
{
    struct log *log = test_log();
    struct encoder *encoder = encoder_create(log, "jpeg", NULL);
    struct frame *before = test_frame(gradient(640, 360)), *now = test_frame(gradient(640, 360));
    struct encoder_params params = { .quality = 95, .full_chroma = true };
    struct packet *whole, *change;
    uint8_t *bgr = test_memory(mem_array(640 * 360, 3));
    for (size_t y = 40; y < 60; y++) {
        memset(now->bgrx + y * (size_t)now->stride_bytes + 100 * 4, 180, 30 * 4);
        memset(now->bgrx + (y + 250) * (size_t)now->stride_bytes + 600 * 4, 90, 30 * 4);
    }
    assert_int_equal(encoder_send(encoder, before, &params), 0);
    assert_int_equal(encoder_receive(encoder, &whole), 0);
    params.before = before;
    assert_int_equal(encoder_send(encoder, now, &params), 0);
    assert_int_equal(encoder_receive(encoder, &change), 0);
    assert_true(whole->key && !change->key && change->part_count == 2 && change->count * 8 < whole->count);
    decode_parts(whole, bgr);
    decode_parts(change, bgr);
    assert_true(worst_difference(now, bgr, 0) <= 16);
    packet_unref(&change);
    /* the picture has changed back to the one before, which the client already shows again, so nothing is sent */
    assert_int_equal(encoder_send(encoder, before, &params), 0);
    assert_int_equal(encoder_receive(encoder, &change), -EAGAIN);
    params.key = true;
    assert_int_equal(encoder_send(encoder, before, &params), 0);
    assert_int_equal(encoder_receive(encoder, &change), 0);
    assert_true(change->key);
    packet_unref(&change);
    /* a picture of another view cannot be sent as a change of the last one: it must be complete (a key frame) */
    now->view.camera.fov_deg = 33;
    params.key = false;
    assert_int_equal(encoder_send(encoder, now, &params), 0);
    assert_int_equal(encoder_receive(encoder, &change), 0);
    assert_true(change->key);
    packet_unref(&change);
    packet_unref(&whole);
    encoder_destroy(&encoder);
}

TEST(png_keeps_every_pixel)
{
    struct frame *frame = test_frame(gradient(123, 45));
    struct packet *packet = encode("png", frame, 0, false);
    png_image image = { .version = PNG_IMAGE_VERSION };
    assert_int_equal(packet->codec, WIRE_CODEC_PNG);
    assert_true(png_image_begin_read_from_memory(&image, packet->bytes, packet->count));
    image.format = PNG_FORMAT_BGR;
    uint8_t *bgr = test_memory(mem_array(PNG_IMAGE_SIZE(image), 1));
    assert_true(image.width == 123 && image.height == 45);
    assert_true(png_image_finish_read(&image, NULL, bgr, 0, NULL));
    assert_true(worst_difference(frame, bgr, -1) == 0);
    packet_unref(&packet);
}

TEST(packets_outlive_frames_without_their_pixels)
{
    struct frame *frame = test_frame(gradient(64, 64));
    struct packet *packet = encode("jpeg", frame, 80, false), *second = packet_ref(packet);
    assert_null(packet->frame->bgrx);
    assert_int_equal(packet->frame->width_px, 64);
    assert_true(packet->frame->marker_count == 1 && packet->frame->markers[0].tag == 3 && packet->frame->markers[0].x_px == 1.5f);
    packet_unref(&packet);
    assert_null(packet);
    assert_int_equal(second->bytes[0], 0xff);
    packet_unref(&second);
}

TEST(unknown_codecs_are_refused)
{
    struct log *log = test_log();
    assert_null(encoder_create(log, "gif", NULL));
}
