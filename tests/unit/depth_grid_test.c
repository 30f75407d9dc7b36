/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Depth grids: the cells that the server finds are compared with a brute-force search, also for pictures whose size is no
   multiple of a cell; encoded and decoded again, they must be the same. */
#include "tests/support/test.h"

#include "render/soft/depth_cells.h"
#include "render/soft/kernels.h"
#include "tests/support/depth_reader.h"

static const struct depth_lens perspective = { .offset = -0.01, .factor = 2, .step = 0.01f, .least_step = 1e-4f };

struct depth_picture {
    int width_px, height_px;
    size_t pitch_px;
    float *depth;
};

static unsigned seed = 1;

static double random_part(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) / 16777216.0;
}

static struct depth_picture picture_of(int width_px, int height_px)
{
    struct depth_picture picture = { width_px, height_px, (size_t)(width_px + 7) / 8 * 8, NULL };
    picture.depth = mem_array(picture.pitch_px * (size_t)height_px, sizeof(float));
    return picture;
}

/* Makes a picture of depths: random rectangles, each a slanted plane; every fifth one, like the rest of the picture, is
   background. */
static struct depth_picture patchwork(int width_px, int height_px)
{
    struct depth_picture picture = picture_of(width_px, height_px);
    for (int patch = 0; patch < 40; patch++) {
        int x0 = (int)(random_part() * width_px), y0 = (int)(random_part() * height_px);
        int x1 = x0 + (int)(random_part() * width_px / 2), y1 = y0 + (int)(random_part() * height_px / 2);
        double base = patch % 5 ? 0.05 + 0.9 * random_part() : 0, dx = 2e-4 * random_part(), dy = 2e-4 * random_part();
        for (int y = y0; y < y1 && y < height_px; y++)
            for (int x = x0; x < x1 && x < (int)picture.pitch_px; x++)
                picture.depth[(size_t)y * picture.pitch_px + (size_t)x] = base > 0 ? (float)(base + dx * x + dy * y) : 0;
    }
    return picture;
}

static struct depth_cell *cells_of(const struct depth_picture *picture, const struct depth_lens *lens)
{
    int columns = depth_cells_along(picture->width_px), rows = depth_cells_along(picture->height_px), half = columns / 2;
    struct depth_cell *cells = mem_array((size_t)(columns * rows), sizeof(*cells));
    const struct depth_source source = { picture->depth, picture->pitch_px, picture->width_px, picture->height_px, lens };
    /* finds the left and the right half of the cells in two calls, as for a picture that is drawn in tiles */
    soft_find_cells(&source, 0, rows, 0, half, cells);
    soft_find_cells(&source, 0, rows, half, columns, cells);
    return cells;
}

static int by_value(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* From a cell's depths, sorted from the farthest, returns how many belong to the farther of the two surfaces into which
   depth_cells.c divides it. For an undivided cell: the number of background depths. */
static int count_behind(const struct depth_lens *lens, const float *all, int count)
{
    int background = 0, behind = 0;
    while (background < count && all[background] <= 0)
        background++;
    if (background == count)
        return 0;
    float low = all[background], high = all[count - 1], border = 0.5f * (low + high);
    while (all[behind] <= border && behind < count - 1)
        behind++;
    bool divided = high - low > lens->step * border + lens->least_step && all[behind] - all[behind - 1] >= 0.25f * (high - low);
    return divided ? behind : background;
}

/* Computes from the picture's depths what the cell must contain by the rules of depth_cells.c. */
static void expect_cell(const struct depth_picture *picture, const struct depth_lens *lens, int column, int row, struct depth_cell *out)
{
    float all[64];
    int count = 0;
    for (int y = row * 8; y < row * 8 + 8 && y < picture->height_px; y++)
        for (int x = column * 8; x < column * 8 + 8 && x < picture->width_px; x++)
            all[count++] = picture->depth[(size_t)y * picture->pitch_px + (size_t)x];
    qsort(all, (size_t)count, sizeof(*all), by_value);
    float middle = 0.5f * (all[0] + all[count - 1]);
    int behind = count_behind(lens, all, count), first = 0;
    *out = (struct depth_cell){ middle, middle, 0 };
    if (behind == 0)
        return;
    while (first < behind - 1 && all[first] <= 0)
        first++;
    *out = (struct depth_cell){ 0.5f * (all[behind] + all[count - 1]), 0.5f * (all[first] + all[behind - 1]), 0 };
    for (int i = 0; i < 64; i++) {
        int x = column * 8 + i % 8, y = row * 8 + i / 8;
        if (x < picture->width_px && y < picture->height_px && picture->depth[(size_t)y * picture->pitch_px + (size_t)x] >= all[behind])
            out->mask |= 1ull << i;
    }
}

/* Returns the mask of a depth cell without the bits of pixels that lie outside the picture. */
static uint64_t within(const struct depth_picture *picture, int column, int row, uint64_t mask)
{
    for (int i = 0; i < 64; i++)
        if (column * 8 + i % 8 >= picture->width_px || row * 8 + i / 8 >= picture->height_px)
            mask &= ~(1ull << i);
    return mask;
}

static bool has_background(const struct depth_picture *picture, int column, int row)
{
    for (int y = row * 8; y < row * 8 + 8 && y < picture->height_px; y++)
        for (int x = column * 8; x < column * 8 + 8 && x < picture->width_px; x++)
            if (picture->depth[(size_t)y * picture->pitch_px + (size_t)x] <= 0)
                return true;
    return false;
}

TEST(cells_are_those_of_a_plain_search)
{
    static const int sizes[][2] = { { 64, 40 }, { 13, 9 }, { 1, 1 }, { 317, 211 }, { 8, 8 }, { 1920, 1080 } };
    int divided = 0, background = 0, mixed = 0;
    for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++) {
        struct depth_picture picture = patchwork(sizes[s][0], sizes[s][1]);
        struct depth_cell *cells = cells_of(&picture, &perspective), expected;
        int columns = depth_cells_along(picture.width_px);
        for (int row = 0; row < depth_cells_along(picture.height_px); row++)
            for (int column = 0; column < columns; column++) {
                const struct depth_cell *cell = &cells[row * columns + column];
                expect_cell(&picture, &perspective, column, row, &expected);
                assert_true(cell->near == expected.near && cell->far == expected.far);
                assert_true(within(&picture, column, row, cell->mask) == expected.mask);
                divided += cell->near != cell->far;
                background += cell->near == 0;
                mixed += has_background(&picture, column, row) && cell->far > 0;
            }
        mem_free(cells);
        mem_free(picture.depth);
    }
    assert_true(divided > 100 && background > 10 && mixed > 10);
}

static void check_mask(const struct depth_cell *cell, const uint8_t *mask)
{
    for (int i = 0; i < 16; i++) {
        int at = i / 4 * 16 + i % 4 * 2;
        int near = (int)(cell->mask >> at & 1) + (int)(cell->mask >> (at + 1) & 1) + (int)(cell->mask >> (at + 8) & 1) +
                   (int)(cell->mask >> (at + 9) & 1);
        assert_int_equal(mask[i], near >= 1);
    }
}

static double in_metres(const struct depth_lens *lens, float depth)
{
    return (depth - lens->offset) / lens->factor;
}

/* Encodes and decodes a picture, and compares codes with cells. Returns the size of the payload in bytes. */
static size_t round_trip(const struct depth_picture *picture, const struct depth_lens *lens, int *divided)
{
    struct depth_cell *cells = cells_of(picture, lens);
    struct depth_grid *grid = depth_grid_create(cells, lens, picture->width_px, picture->height_px);
    struct depth_read read;
    assert_true(depth_read_init(&read, grid));
    assert_true((read.wire.flags & WIRE_DEPTH_ORTHOGRAPHIC) == (lens->orthographic ? WIRE_DEPTH_ORTHOGRAPHIC : 0));
    assert_int_equal(read.wire.columns, (picture->width_px + 7) / 8);
    assert_int_equal(read.wire.rows, (picture->height_px + 7) / 8);
    *divided = 0;
    for (int i = 0; i < read.wire.columns * read.wire.rows; i++) {
        double slack = 0.51 * fabs((double)read.wire.unit) + 1e-6;
        assert_true(read.near[i] <= read.wire.levels && read.near[i] >= read.far[i]);
        assert_true((read.near[i] > 0) == (cells[i].near > 0));
        assert_true((read.far[i] > 0) == (cells[i].far > 0));
        if (read.near[i])
            assert_true(fabs(depth_read_value(&read, read.near[i]) - in_metres(lens, cells[i].near)) <= slack);
        if (read.far[i])
            assert_true(fabs(depth_read_value(&read, read.far[i]) - in_metres(lens, cells[i].far)) <= slack);
        if (read.near[i] != read.far[i])
            check_mask(&cells[i], read.masks[i]);
        *divided += read.near[i] != read.far[i];
    }
    size_t bytes = read.wire.payload_bytes;
    depth_read_finish(&read);
    depth_grid_unref(&grid);
    mem_free(cells);
    return bytes;
}

TEST(codes_survive_a_round_trip)
{
    static const struct depth_lens orthographic = { .orthographic = true, .offset = 1, .factor = -0.01, .least_step = 1e-3f };
    int divided;
    for (int i = 0; i < sweep(200, 20); i++) {
        struct depth_picture picture = patchwork(1 + (int)(random_part() * 400), 1 + (int)(random_part() * 300));
        round_trip(&picture, i % 2 ? &orthographic : &perspective, &divided);
        mem_free(picture.depth);
    }
}

TEST(a_plane_is_one_surface_and_takes_few_bytes)
{
    struct depth_picture picture = picture_of(1920, 1080);
    int divided;
    for (size_t y = 0; y < 1080; y++)
        for (size_t x = 0; x < picture.pitch_px; x++)
            picture.depth[y * picture.pitch_px + x] = (float)(0.05 + 1e-4 * (double)x + 5e-4 * (double)y);
    assert_true(round_trip(&picture, &perspective, &divided) < 15000);
    assert_int_equal(divided, 0);
    memset(picture.depth, 0, picture.pitch_px * 1080 * sizeof(float));
    assert_true(round_trip(&picture, &perspective, &divided) < 300);
    assert_int_equal(divided, 0);
    mem_free(picture.depth);
}

/* A picture with a wall at the left and, behind it, the ground, which reaches up to the background. Depth grids include the
   ground where nothing else is visible. */
TEST(the_ground_is_behind_surfaces)
{
    struct depth_lens lens = perspective;
    struct depth_picture picture = picture_of(64, 64);
    lens.has_ground = true;
    lens.ground[1] = 0.01; /* depth of the ground at the pixel row y: 0.01 y */
    lens.ground_from_pixel[0][0] = 1 / 64.0; /* the ground is visible only in the upper half of the picture */
    lens.ground_from_pixel[1][1] = 1 / 32.0;
    lens.ground_from_pixel[2][2] = 1;
    for (int y = 0; y < 64; y++)
        for (int x = 0; x < 12; x++)
            picture.depth[y * 64 + x] = 0.9f;
    struct depth_cell *cells = test_memory(cells_of(&picture, &lens));
    struct depth_grid *grid = depth_grid_create(cells, &lens, 64, 64);
    struct depth_read read;
    assert_true(depth_read_init(&read, grid));
    assert_true(read.near[0] == read.far[0] && fabs(depth_read_value(&read, read.near[0]) - in_metres(&lens, 0.9f)) < 1e-6);
    assert_true(fabs(depth_read_value(&read, read.near[1]) - in_metres(&lens, 0.9f)) < 1e-6);
    assert_true(fabs(depth_read_value(&read, read.far[1]) - in_metres(&lens, 0.04f)) < 1e-3);
    assert_true(read.near[2] == read.far[2] && fabs(depth_read_value(&read, read.near[2]) - in_metres(&lens, 0.04f)) < 1e-3);
    assert_int_equal(read.masks[1][1], 1);
    assert_int_equal(read.masks[1][2], 0);
    assert_true(read.near[7 * 8 + 2] == 0 && read.far[7 * 8 + 1] == 0);
    depth_read_finish(&read);
    depth_grid_unref(&grid);
    mem_free(picture.depth);
}

TEST(the_header_has_the_bytes_of_the_protocol)
{
    static const uint8_t expected[WIRE_DEPTH_HEADER_BYTES] = { 2, 2, 3, 0, 0x10, 0x20, 0, 0, 7, 0, 0, 0, 0x64, 0, 0, 0, 0x65, 0, 0x2c, 1,
                                                               0xc9, 0, 0x2c, 1, 13, 0, 38, 0, 8, 4, 0xff, 0x0f, 0, 0, 0, 0x3f, 0, 0,
                                                               0, 0xbf, 1, 2, 3, 0 };
    uint8_t bytes[WIRE_DEPTH_HEADER_BYTES];
    wire_put_depth(&(struct wire_depth){ .flags = WIRE_DEPTH_ORTHOGRAPHIC | WIRE_DEPTH_MORE,
                                         .payload_bytes = 0x2010,
                                         .seq = 7,
                                         .x_px = 100,
                                         .width_px = 101,
                                         .height_px = 300,
                                         .full_width_px = 201,
                                         .full_height_px = 300,
                                         .columns = 13,
                                         .rows = 38,
                                         .cell_px = 8,
                                         .mask_side = 4,
                                         .levels = 4095,
                                         .base = 0.5f,
                                         .unit = -0.5f,
                                         .data_bytes = 0x30201 },
                   bytes);
    assert_memory_equal(bytes, expected, sizeof(bytes));
}
