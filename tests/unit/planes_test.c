/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion of pictures to luma and subsampled chroma planes: thin coloured lines and edges keep their colours, and grey stays
   grey. */
#include "encode/planes.h"

#include "tests/support/test.h"

#include <libyuv.h>

static const uint8_t GREY[3] = { 232, 231, 230 }, BLUE[3] = { 230, 130, 69 }; /* b, g, r */

struct frame_bytes {
    uint8_t *bgrx, *bytes;
    struct yuv_planes planes;
};

static void picture_init(struct frame_bytes *picture, int width, int height)
{
    size_t pitch = (size_t)(width + 1) / 2, rows = (size_t)(height + 1) / 2;
    *picture = (struct frame_bytes){ .bgrx = mem_array((size_t)width * (size_t)height, 4), .bytes = mem_array(pitch * rows, 6) };
    struct yuv_planes *planes = &picture->planes;
    *planes = (struct yuv_planes){ .bgrx = picture->bgrx, .stride_bytes = width * 4, .width_px = width, .height_px = height };
    planes->plane[0] = picture->bytes;
    planes->plane[1] = picture->bytes + pitch * rows * 4;
    planes->plane[2] = picture->bytes + pitch * rows * 5;
    planes->pitch[0] = width;
    planes->pitch[1] = planes->pitch[2] = (int)pitch;
}

static void picture_finish(struct frame_bytes *picture)
{
    mem_free(picture->bgrx);
    mem_free(picture->bytes);
}

static void paint(struct frame_bytes *picture, int x, int y, const uint8_t bgr[3])
{
    memcpy(picture->bgrx + ((size_t)y * (size_t)picture->planes.width_px + (size_t)x) * 4, bgr, 3);
}

/* Converts the picture; step: number of bands of rows for each call, as when threads share the work. */
static void make(struct frame_bytes *picture, size_t step)
{
    size_t bands = planes_bands(picture->planes.height_px);
    for (size_t i = 0; i < bands; i += step)
        planes_convert(&picture->planes, i, i + step < bands ? i + step : bands);
}

static int sample(const struct frame_bytes *picture, int c, int x, int y)
{
    return picture->planes.plane[1 + c][y / 2 * picture->planes.pitch[1 + c] + x / 2];
}

static int chroma_of(const uint8_t bgr[3], int c)
{
    double of[2] = { 0.5 * bgr[0] - 0.331264 * bgr[1] - 0.168736 * bgr[2], 0.5 * bgr[2] - 0.418688 * bgr[1] - 0.081312 * bgr[0] };
    return (int)lround(of[c]) + 128;
}

/* Coloured lines one pixel wide, vertical or horizontal, at each position relative to the 2 x 2 blocks that share a chroma
   value, must keep their colour. */
TEST(thin_lines_keep_their_colour)
{
    for (int turn = 0; turn < 2; turn++)
        for (int at = 30; at < 36; at++) {
            struct frame_bytes picture;
            picture_init(&picture, 77, 71);
            for (int y = 0; y < 71; y++)
                for (int x = 0; x < 77; x++)
                    paint(&picture, x, y, (turn ? y : x) == at ? BLUE : GREY);
            make(&picture, 1);
            for (int i = 0; i < 71; i++)
                for (int c = 0; c < 2; c++) {
                    int far = at + 20;
                    assert_in_range(sample(&picture, c, turn ? i : at, turn ? at : i) + 3, chroma_of(BLUE, c), chroma_of(BLUE, c) + 6);
                    assert_in_range(sample(&picture, c, turn ? i : far, turn ? far : i) + 2, chroma_of(GREY, c), chroma_of(GREY, c) + 4);
                }
            picture_finish(&picture);
        }
}

/* At an edge between two colours, only the 2 x 2 pixel blocks across the edge may mix them. */
TEST(colours_beside_each_other_stay)
{
    static const uint8_t amber[3] = { 85, 155, 233 };
    struct frame_bytes picture;
    picture_init(&picture, 64, 48);
    for (int y = 0; y < 48; y++)
        for (int x = 0; x < 64; x++)
            paint(&picture, x, y, x < 32 ? BLUE : amber);
    make(&picture, 1);
    for (int x = 0; x < 64; x++)
        for (int c = 0; c < 2; c++)
            assert_in_range(sample(&picture, c, x, 20) + 2, chroma_of(x < 32 ? BLUE : amber, c), chroma_of(x < 32 ? BLUE : amber, c) + 4);
    picture_finish(&picture);
}

/* Computes the planes by libyuv, without our correction of chroma, for comparison. */
static void plain(const struct frame_bytes *of, uint8_t *bytes)
{
    const struct yuv_planes *p = &of->planes;
    size_t count = (size_t)p->pitch[1] * (size_t)((p->height_px + 1) / 2);
    ARGBToJ420(p->bgrx, p->stride_bytes, bytes, p->pitch[0], bytes + 4 * count, p->pitch[1], bytes + 5 * count, p->pitch[2], p->width_px,
               p->height_px);
}

/* Frames of any size, converted in any number of bands of rows, must give the same planes. */
TEST(cuts_make_no_difference)
{
    static const int sizes[][2] = { { 1, 1 }, { 2, 3 }, { 31, 17 }, { 130, 95 }, { 333, 77 } };
    srand(7);
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        int width = sizes[i][0], height = sizes[i][1];
        size_t count = (size_t)((width + 1) / 2) * (size_t)((height + 1) / 2) * 6, luma = (size_t)width * (size_t)height;
        struct frame_bytes whole, cut;
        uint8_t *mean = mem_array(count, 1);
        picture_init(&whole, width, height);
        picture_init(&cut, width, height);
        for (int p = 0; p < width * height; p++)
            for (int c = 0; c < 3; c++)
                whole.bgrx[p * 4 + c] = (uint8_t)(p % 50 > 40 ? rand() % 256 : 90 + c * 20);
        memcpy(cut.bgrx, whole.bgrx, luma * 4);
        make(&whole, planes_bands(height));
        make(&cut, 1);
        plain(&whole, mean);
        assert_memory_equal(whole.bytes, cut.bytes, count);
        assert_memory_equal(whole.bytes, mean, luma);
        assert_true(width < 100 || memcmp(whole.bytes, mean, count) != 0);
        picture_finish(&whole);
        picture_finish(&cut);
        mem_free(mean);
    }
}

TEST(gentle_colours_are_left_alone)
{
    struct frame_bytes picture;
    uint8_t *mean = test_memory(mem_array(320 * 100 * 3 / 2, 1));
    picture_init(&picture, 320, 100);
    for (int y = 0; y < 100; y++)
        for (int x = 0; x < 320; x++)
            paint(&picture, x, y, (uint8_t[3]){ (uint8_t)(200 + x / 16), 110, (uint8_t)(90 + y / 10) });
    make(&picture, 2);
    plain(&picture, mean);
    assert_memory_equal(picture.bytes, mean, 320 * 100 * 3 / 2);
    picture_finish(&picture);
}
