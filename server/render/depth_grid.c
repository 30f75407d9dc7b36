/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes a depth grid: coarse depth of a frame, with which a client redraws the frame for a moved camera (depth_grid.h).
   Quantises the depths of the cells to codes, predicts each code from the codes of neighbouring cells, and deflates the
   differences. */
#include "render/depth_grid.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/mem.h"
#include "render/matrix.h"

enum { MASK_SIDE = DEPTH_CELL_PX / 2, MASK_BYTES = MASK_SIDE * MASK_SIDE / 8, MOST_LEVELS = 4095 };
enum { ESCAPE = 255, MOST_SYMBOL_BYTES = 3 };
enum { PART_DIVIDED, PART_BACK, PART_NEAR, PART_MASKS, PARTS }; /* of the payload */
/* bytes reserved for the ends of deflate blocks in a depth grid's payload, which deflateBound() does not count: one block per part */
enum { MOST_BLOCK_BYTES = 100 };
/* Camera movement up to which clients can warp a picture with the depth grid to within a fraction of a pixel. Given as a
   fraction of the distance from the camera to the surface; 0.1 corresponds to orbiting by six degrees. */
static const double MOVEMENT = 0.1;
/* Thresholds for depth differences, given as the distance in pixels by which two depths shift apart on the screen when the
   camera moves by MOVEMENT. STEP_SHIFT_PX: from this shift on, the two depths form a step. UNIT_SHIFT_PX: shift of two depths
   whose codes differ by 1. */
static const double STEP_SHIFT_PX = 2, UNIT_SHIFT_PX = 1.5;
/* Ground whose inverse distance from the camera (1/m) is below this, that is, farther away than 100 km, counts as background. */
static const double LEAST_INVERSE = 1e-5;

/* --- from the depth buffer to metres ----------------------------------------------------------------------------------------- */

/* Computes the depth of the ground as a linear function of the pixel, and the matrix from pixels to positions on the ground. */
static void aim_at_ground(struct depth_lens *lens, const double clip_from_plant[16], const double plant_from_ground[16], int width_px,
                          int height_px)
{
    double clip[16], h[3][3], depth[3], determinant = 0, inverse[3][3];
    matrix_multiply(clip_from_plant, plant_from_ground, clip);
    /* h: homogeneous matrix from a position (u, v, 1) on the ground to the pixel (x w, y w, w). depth: row vector that maps the same
       position to its depth times w */
    for (int c = 0; c < 3; c++) {
        const double *column = &clip[c == 2 ? 12 : 4 * c];
        h[0][c] = 0.5 * width_px * (column[3] + column[0]);
        h[1][c] = 0.5 * height_px * (column[3] - column[1]);
        h[2][c] = column[3];
        depth[c] = column[2];
    }
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) {
            int a = (c + 1) % 3, b = (c + 2) % 3, p = (r + 1) % 3, q = (r + 2) % 3;
            inverse[r][c] = h[a][p] * h[b][q] - h[a][q] * h[b][p];
        }
    for (int c = 0; c < 3; c++)
        determinant += h[0][c] * inverse[c][0];
    lens->has_ground = fabs(determinant) > 1e-30;
    for (int c = 0; c < 3 && lens->has_ground; c++) {
        lens->ground[c] = 0;
        for (int r = 0; r < 3; r++) {
            lens->ground_from_pixel[c][r] = inverse[r][c] / determinant;
            lens->ground[c] += depth[r] * inverse[r][c] / determinant;
        }
    }
}

void depth_lens_init(struct depth_lens *lens, const struct view_constants *constants, const double *plant_from_ground, int width_px,
                     int height_px)
{
    const double *m = constants->clip_from_eye, *back = constants->back;
    *lens = (struct depth_lens){ .orthographic = constants->pixel_per_metre > 0 };
    for (int c = 0; c < 3; c++)
        lens->offset += m[4 * c + 2] * (lens->orthographic ? -back[c] : m[4 * c + 3]);
    lens->factor = m[14];
    if (lens->orthographic) {
        lens->factor = lens->offset;
        lens->offset = m[14];
        lens->least_step = (float)(fabs(lens->factor) * STEP_SHIFT_PX / MOVEMENT / constants->pixel_per_metre);
    } else {
        lens->step = (float)(STEP_SHIFT_PX / MOVEMENT / constants->pixel_per_radian);
        lens->least_step = (float)(-lens->offset * STEP_SHIFT_PX / MOVEMENT / constants->pixel_per_radian);
    }
    if (plant_from_ground)
        aim_at_ground(lens, constants->clip_from_plant, plant_from_ground, width_px, height_px);
}

/* Returns the depth of the ground at a pixel. Returns -INFINITY if no ground is seen there, or if it is farther than 1 / LEAST_INVERSE. */
static inline float ground_at(const struct depth_lens *lens, double x, double y)
{
    double at[3];
    if (!lens->has_ground)
        return -INFINITY;
    for (int r = 0; r < 3; r++)
        at[r] = lens->ground_from_pixel[0][r] * x + lens->ground_from_pixel[1][r] * y + lens->ground_from_pixel[2][r];
    if (at[2] <= 0 || at[0] < 0 || at[1] < 0 || at[0] > at[2] || at[1] > at[2])
        return -INFINITY;
    double depth = lens->ground[0] * x + lens->ground[1] * y + lens->ground[2];
    /* (depth - offset) / factor > LEAST_INVERSE, without a division */
    bool near = lens->orthographic || (depth - lens->offset - LEAST_INVERSE * lens->factor) * lens->factor > 0;
    return near ? (float)depth : -INFINITY;
}

/* --- codes ------------------------------------------------------------------------------------------------------------------- */

struct coder {
    const struct depth_cell *cells;
    const struct depth_lens *lens;
    int width_px, height_px, columns, rows;
    /* depths; -INFINITY: background. They use the memory of `data`, which is written only after the codes are known */
    float *nears, *fars;
    uint16_t *near, *far;         /* depth codes */
    uint16_t *symbols;            /* differences of a row of codes from their predictions */
    uint32_t *divided;            /* indices of the cells that contain a depth step, in ascending order */
    uint16_t *masks;              /* coarse masks of divided cells, at the index of the cell */
    size_t divided_count;
    uint8_t *data;
    /* depths are quantised to codes; low: depth with the code 1; unit: difference in depth between one code and the next */
    float low, unit;
    int levels;
};

static bool coder_init(struct coder *coder)
{
    enum { DATA_BYTES = 1 + 2 * MOST_SYMBOL_BYTES + MASK_BYTES, DEPTH_BYTES = 2 * sizeof(float) };
    size_t columns = (size_t)coder->columns, count = columns * (size_t)coder->rows;
    coder->near = mem_try_array(3 * count + columns, sizeof(*coder->near));
    coder->divided = mem_try_array(count, sizeof(*coder->divided));
    coder->data = mem_try_array(count, DATA_BYTES > DEPTH_BYTES ? DATA_BYTES : DEPTH_BYTES);
    coder->nears = (float *)(void *)coder->data;
    coder->fars = coder->nears + count;
    coder->far = coder->near + count;
    coder->masks = coder->far + count;
    coder->symbols = coder->masks + count;
    return coder->near && coder->divided && coder->data;
}

static void coder_finish(struct coder *coder)
{
    mem_free(coder->near);
    mem_free(coder->divided);
    mem_free(coder->data);
}

/* Returns the pixel coordinate, along one axis, of the centre of a depth grid cell. For a cell that extends beyond the frame,
   this is the centre of the part inside. */
static double middle(int cell, int px)
{
    int begin = cell * DEPTH_CELL_PX, end = begin + DEPTH_CELL_PX;
    return 0.5 * (begin + (end < px ? end : px));
}

/* Computes the depths of a row of cells. Replaces the background with the ground's depth: as the far depth behind the cell's
   surface, or as the cell's only depth. If the ground is in front of the surface, swaps the two depths. */
static void find_depths(const struct coder *coder, int row)
{
    size_t first = (size_t)row * (size_t)coder->columns;
    const struct depth_cell *cells = coder->cells + first;
    float *nears = coder->nears + first, *fars = coder->fars + first;
    double y = middle(row, coder->height_px);
    for (int column = 0; column < coder->columns; column++) {
        float near = cells[column].near, far = cells[column].far;
        if (far <= 0) {
            float ground = ground_at(coder->lens, middle(column, coder->width_px), y);
            far = ground;
            near = near > 0 ? near : ground;
        }
        nears[column] = near > far ? near : far;
        fars[column] = near < far ? near : far;
    }
}

/* Finds the depth range of all cells, and how depths are quantised to codes. */
static void find_range(struct coder *coder)
{
    float low = INFINITY, high = -INFINITY;
    double sum = 0;
    size_t seen = 0, count = (size_t)coder->columns * (size_t)coder->rows;
    for (size_t i = 0; i < count; i++) {
        float near = coder->nears[i], far = coder->fars[i], least = far > -INFINITY ? far : near;
        bool shows = near > -INFINITY;
        high = near > high ? near : high;
        low = shows && least < low ? least : low;
        sum += shows ? (double)near : 0;
        seen += shows;
    }
    coder->low = seen ? low : 0;
    double mean = seen ? sum / (double)seen : 0, unit = coder->lens->least_step + coder->lens->step * mean;
    unit *= UNIT_SHIFT_PX / STEP_SHIFT_PX;
    double levels = seen && high > low && unit > 0 ? ceil((high - low) / unit) + 1 : 1;
    coder->levels = levels > MOST_LEVELS ? MOST_LEVELS : (int)levels;
    coder->unit = coder->levels > 1 ? (high - low) / (float)(coder->levels - 1) : 1;
}

/* Reduces a cell's mask, which has one bit per pixel, to MASK_SIDE x MASK_SIDE bits. A bit is 1 if at least one of 2 x 2 pixels
   belongs to the near surface. Clients therefore move some pixels of the far surface along with the near one. The opposite
   error would be more visible: a thin near object, such as a handrail, would appear twice. */
static unsigned coarse_mask(uint64_t mask)
{
    /* this line and the next merge each square of 2 x 2 pixels into one bit, set if any of the four is near. The results are
       bits 0, 2, 4 and 6 of every second row; the lines after that pack them together */
    mask |= mask >> 1;
    mask |= mask >> DEPTH_CELL_PX;
    mask &= 0x0055005500550055;
    mask = (mask | mask >> 1) & 0x0033003300330033;
    mask = (mask | mask >> 2) & 0x000f000f000f000f;
    mask = (mask | mask >> 12) & 0x000000ff000000ff;
    return (unsigned)((mask | mask >> 24) & 0xffff);
}

static void quantise(const struct coder *coder, const float *restrict depths, uint16_t *restrict codes)
{
    size_t count = (size_t)coder->columns * (size_t)coder->rows;
    float low = coder->low, per_unit = 1 / coder->unit, most = (float)coder->levels;
    for (size_t i = 0; i < count; i++) {
        float code = (depths[i] - low) * per_unit + 1.5f;
        code = code > most ? most : code;
        codes[i] = (uint16_t)(int)(depths[i] == -INFINITY ? 0 : code);
    }
}

/* Finds the codes of all cells, and the masks of the divided ones. */
static void find_codes(struct coder *coder)
{
    quantise(coder, coder->nears, coder->near);
    quantise(coder, coder->fars, coder->far);
    /* without a branch for each cell, because processors predict badly which cells are divided */
    const uint32_t cells = (uint32_t)coder->columns * (uint32_t)coder->rows;
    size_t count = 0;
    for (uint32_t i = 0; i < cells; i++) {
        coder->divided[count] = i;
        count += coder->near[i] != coder->far[i];
    }
    for (size_t d = 0; d < count; d++) {
        uint32_t i = coder->divided[d];
        uint64_t mask = coder->cells[i].mask;
        bool swapped = coder->nears[i] != coder->cells[i].near;
        coder->masks[i] = (uint16_t)coarse_mask(swapped ? ~mask : mask);
    }
    coder->divided_count = count;
}

/* --- bytes ------------------------------------------------------------------------------------------------------------------- */

/* Returns the difference of a code from its prediction, without sign: 0, -1, 1, -2 ... become 0, 1, 2, 3 ... */
static inline unsigned symbol_of(int code, int predicted)
{
    int by = code - predicted;
    return (unsigned)(2 * by ^ by >> 31);
}

static inline uint8_t *put_symbol(uint8_t *out, unsigned symbol, int code)
{
    if (symbol < ESCAPE) {
        *out++ = (uint8_t)symbol;
        return out;
    }
    out[0] = ESCAPE;
    out[1] = (uint8_t)code;
    out[2] = (uint8_t)(code >> 8);
    return out + MOST_SYMBOL_BYTES;
}

static uint8_t *put_divided(const struct coder *coder, uint8_t *out)
{
    size_t count = (size_t)coder->columns * (size_t)coder->rows, bytes = (count + 7) / 8;
    memset(out, 0, bytes);
    for (size_t d = 0; d < coder->divided_count; d++)
        out[coder->divided[d] / 8] |= (uint8_t)(1 << coder->divided[d] % 8);
    return out + bytes;
}

/* Predicts a cell's depth code as the median of three values (LOCO-I; Weinberger et al., 2000): the code to the left, the code
   above, and the code that continues the plane through these two and the upper left one. */
static inline int predicted_back(int left, int up, int corner)
{
    int least = left < up ? left : up, most = left < up ? up : left, plane = left + up - corner;
    int median = plane < least ? least : plane > most ? most : plane;
    bool all = left && up && corner;
    return all ? median : left ? left : up;
}

/* Writes the far code (depth code of the farthest surface) of each cell, as its difference from a prediction from the codes of
   the left, upper and upper left cells. */
static uint8_t *put_back(const struct coder *coder, uint8_t *out)
{
    int columns = coder->columns;
    for (int row = 0; row < coder->rows; row++) {
        const uint16_t *restrict here = coder->far + (size_t)row * (size_t)columns, *restrict above = row ? here - columns : NULL;
        uint16_t *restrict symbols = coder->symbols;
        symbols[0] = (uint16_t)symbol_of(here[0], above ? above[0] : 0);
        for (int c = 1; c < columns && above; c++)
            symbols[c] = (uint16_t)symbol_of(here[c], predicted_back(here[c - 1], above[c], above[c - 1]));
        for (int c = 1; c < columns && !above; c++)
            symbols[c] = (uint16_t)symbol_of(here[c], here[c - 1]);
        for (int c = 0; c < columns; c++)
            out = put_symbol(out, symbols[c], here[c]);
    }
    return out;
}

/* Writes the near code (depth code of the nearer side) of each cell that contains a depth step. The prediction is the first of
   the left, upper and upper left neighbours' near codes that is nearer than the cell's far side. */
static uint8_t *put_near(const struct coder *coder, uint8_t *out)
{
    const uint32_t columns = (uint32_t)coder->columns;
    const uint16_t *near = coder->near;
    for (size_t d = 0; d < coder->divided_count; d++) {
        const uint32_t i = coder->divided[d], column = i % columns;
        int back = coder->far[i];
        int left = column ? near[i - 1] : 0, up = i >= columns ? near[i - columns] : 0;
        int corner = column && i >= columns ? near[i - columns - 1] : 0;
        int predicted = left > back ? left : up > back ? up : corner > back ? corner : back;
        out = put_symbol(out, symbol_of(near[i], predicted), near[i]);
    }
    return out;
}

/* Returns the mask of a neighbouring cell, which serves as prediction for cell `i`. A neighbour without a depth step has no
   mask. The result is then all ones if its depth is closer to the near side of cell `i` than to the far side, else 0. */
static unsigned mask_beside(const struct coder *coder, size_t neighbour, size_t i)
{
    int back = coder->far[neighbour];
    if (coder->near[neighbour] != back)
        return coder->masks[neighbour];
    return abs(back - coder->near[i]) < abs(back - coder->far[i]) ? 0xffff : 0;
}

/* Writes which bits of the cells' masks differ from their predictions. If the bits to the left and above are equal, the
   prediction is their value. Otherwise it is the inverse of the upper left bit, so that an edge continues straight. */
static uint8_t *put_masks(const struct coder *coder, uint8_t *out)
{
    const uint32_t columns = (uint32_t)coder->columns;
    for (size_t d = 0; d < coder->divided_count; d++) {
        const uint32_t i = coder->divided[d];
        unsigned mask = coder->masks[i];
        unsigned west = i % columns ? mask_beside(coder, i - 1, i) : 0, north = i >= columns ? mask_beside(coder, i - columns, i) : 0;
        unsigned left = (mask << 1 & 0xeeee) | (west >> 3 & 0x1111), up = (mask << 4 & 0xfff0) | north >> 12;
        unsigned between = (left << 4 & 0xfff0) | (north >> 11 & 0xe) | (west >> 3 & 1);
        unsigned differs = mask ^ ((left & up) | ((left ^ up) & ~between));
        *out++ = (uint8_t)differs;
        *out++ = (uint8_t)(differs >> 8);
    }
    return out;
}

/* Deflates the parts of the payload (far codes, near codes, and so on) separately, so that each gets its own Huffman codes. */
static uint8_t *deflated(const uint8_t *data, uint8_t *const ends[PARTS], size_t *bytes)
{
    enum { RAW = -15, MEMORY = 8, LEVEL = 1 };
    z_stream stream = { .next_in = (uint8_t *)(uintptr_t)data };
    if (deflateInit2(&stream, LEVEL, Z_DEFLATED, RAW, MEMORY, Z_RLE) != Z_OK)
        return NULL;
    size_t most = deflateBound(&stream, (uLong)(ends[PARTS - 1] - data)) + MOST_BLOCK_BYTES;
    uint8_t *out = mem_try_array(most, 1);
    stream.next_out = out;
    stream.avail_out = (uInt)most;
    bool good = out != NULL;
    for (int part = 0; part < PARTS && good; part++) {
        stream.avail_in = (uInt)(ends[part] - stream.next_in);
        if (part == PARTS - 1)
            good = deflate(&stream, Z_FINISH) == Z_STREAM_END;
        else if (stream.avail_in > 0)
            good = deflate(&stream, Z_BLOCK) == Z_OK;
        good &= part != PART_BACK || deflateParams(&stream, LEVEL, Z_HUFFMAN_ONLY) == Z_OK;
    }
    *bytes = stream.total_out;
    deflateEnd(&stream);
    if (!good) {
        mem_free(out);
        return NULL;
    }
    return out;
}

static struct depth_grid *make(struct coder *coder)
{
    for (int row = 0; row < coder->rows; row++)
        find_depths(coder, row);
    find_range(coder);
    find_codes(coder);
    uint8_t *ends[PARTS], *end = coder->data;
    uint8_t *(*const put[PARTS])(const struct coder *, uint8_t *) = { put_divided, put_back, put_near, put_masks };
    for (int part = 0; part < PARTS; part++)
        ends[part] = end = put[part](coder, end);
    size_t data_bytes = (size_t)(end - coder->data), bytes;
    uint8_t *payload = deflated(coder->data, ends, &bytes);
    if (!payload)
        return NULL;
    struct depth_grid *grid = mem_new(sizeof(*grid));
    atomic_init(&grid->refs, 1);
    grid->payload = payload;
    grid->wire = (struct wire_depth){ .flags = coder->lens->orthographic ? WIRE_DEPTH_ORTHOGRAPHIC : 0,
                                      .payload_bytes = (uint32_t)bytes,
                                      .width_px = (uint16_t)coder->width_px,
                                      .height_px = (uint16_t)coder->height_px,
                                      .columns = (uint16_t)coder->columns,
                                      .rows = (uint16_t)coder->rows,
                                      .cell_px = DEPTH_CELL_PX,
                                      .mask_side = MASK_SIDE,
                                      .levels = (uint16_t)coder->levels,
                                      .base = (float)((coder->low - coder->lens->offset) / coder->lens->factor),
                                      .unit = (float)(coder->unit / coder->lens->factor),
                                      .data_bytes = (uint32_t)data_bytes };
    return grid;
}

struct depth_grid *depth_grid_create(const struct depth_cell *cells, const struct depth_lens *lens, int width_px, int height_px)
{
    struct coder coder = { .cells = cells,
                           .lens = lens,
                           .width_px = width_px,
                           .height_px = height_px,
                           .columns = depth_cells_along(width_px),
                           .rows = depth_cells_along(height_px) };
    struct depth_grid *grid = coder_init(&coder) ? make(&coder) : NULL;
    coder_finish(&coder);
    return grid;
}

struct depth_grid *depth_grid_ref(struct depth_grid *grid)
{
    if (grid)
        atomic_fetch_add_explicit(&grid->refs, 1, memory_order_relaxed);
    return grid;
}

void depth_grid_unref(struct depth_grid **grid_ptr)
{
    struct depth_grid *grid = *grid_ptr;
    *grid_ptr = NULL;
    if (!grid || atomic_fetch_sub_explicit(&grid->refs, 1, memory_order_acq_rel) != 1)
        return;
    mem_free(grid->payload);
    mem_free(grid);
}

bool depth_grid_equal(const struct depth_grid *a, const struct depth_grid *b)
{
    if (a == b || !a || !b)
        return a == b;
    return !memcmp(&a->wire, &b->wire, sizeof(a->wire)) && !memcmp(a->payload, b->payload, a->wire.payload_bytes);
}
