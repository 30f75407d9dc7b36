/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a depth grid as a client does: decompresses it and undoes the prediction of its cells. */
#include "tests/support/depth_reader.h"

#include <stdlib.h>
#include <zlib.h>

#include "base/mem.h"

struct payload_bytes {
    const uint8_t *at, *end;
    bool good;
};

static unsigned next(struct payload_bytes *bytes)
{
    bytes->good &= bytes->at < bytes->end;
    return bytes->good ? *bytes->at++ : 0;
}

static uint16_t symbol(struct payload_bytes *bytes, int predicted)
{
    unsigned first = next(bytes);
    if (first < 255)
        return (uint16_t)(first % 2 ? predicted - (int)(first + 1) / 2 : predicted + (int)first / 2);
    unsigned low = next(bytes), high = next(bytes);
    return (uint16_t)(low | high << 8);
}

static bool inflate_all(const struct depth_grid *grid, uint8_t *out)
{
    z_stream stream = { .next_in = grid->payload, .next_out = out };
    stream.avail_in = grid->wire.payload_bytes;
    stream.avail_out = grid->wire.data_bytes;
    bool good = inflateInit2(&stream, -15) == Z_OK && inflate(&stream, Z_FINISH) == Z_STREAM_END && stream.avail_out == 0;
    inflateEnd(&stream);
    return good;
}

static int middle_of(int a, int b, int c)
{
    int least = a < b ? a : b, most = a < b ? b : a;
    return c < least ? least : c > most ? most : c;
}

struct codes_beside {
    /* codes of the cell to the left, the cell above, and the cell above the left one; 0 if the cell is outside the grid */
    int left, up, corner;
};

static struct codes_beside codes_beside_of(const uint16_t *codes, int i, int columns)
{
    return (struct codes_beside){ i % columns ? codes[i - 1] : 0, i >= columns ? codes[i - columns] : 0,
                                i % columns && i >= columns ? codes[i - columns - 1] : 0 };
}

static void read_far(struct depth_read *read, struct payload_bytes *bytes)
{
    for (int i = 0; i < read->wire.columns * read->wire.rows; i++) {
        struct codes_beside n = codes_beside_of(read->far, i, read->wire.columns);
        bool all = n.left && n.up && n.corner;
        read->far[i] = symbol(bytes, all ? middle_of(n.left, n.up, n.left + n.up - n.corner) : n.left ? n.left : n.up);
    }
}

static uint16_t near_symbol(const struct depth_read *read, struct payload_bytes *bytes, int i)
{
    struct codes_beside n = codes_beside_of(read->near, i, read->wire.columns);
    int far = read->far[i];
    return symbol(bytes, n.left > far ? n.left : n.up > far ? n.up : n.corner > far ? n.corner : far);
}

/* Returns the mask bit at (x, y) of the grid, which predicts mask bits in `cell`; 0 outside the grid. If the cell at (x, y) has
   no mask, the bit follows from whether its depth is closer to the near or to the far depth of `cell`. */
static int bit_at(const struct depth_read *read, int cell, int x, int y)
{
    int side = read->wire.mask_side, other = y / side * read->wire.columns + x / side;
    if (x < 0 || y < 0)
        return 0;
    if (read->masks[other])
        return read->masks[other][y % side * side + x % side];
    return abs(read->near[other] - read->near[cell]) < abs(read->near[other] - read->far[cell]);
}

static void read_mask(struct depth_read *read, struct payload_bytes *bytes, int cell)
{
    int side = read->wire.mask_side, x0 = cell % read->wire.columns * side, y0 = cell / read->wire.columns * side;
    read->masks[cell] = mem_array((size_t)(side * side), 1);
    for (int b = 0, byte = 0; b < side * side; b++) {
        int x = x0 + b % side, y = y0 + b / side, left = bit_at(read, cell, x - 1, y), up = bit_at(read, cell, x, y - 1);
        int between = b == 0 ? left : bit_at(read, cell, x - 1, y - 1);
        byte = b % 8 ? byte : (int)next(bytes);
        read->masks[cell][b] = (uint8_t)((left == up ? left : !between) ^ (byte >> b % 8 & 1));
    }
}

bool depth_read_init(struct depth_read *read, const struct depth_grid *grid)
{
    int columns = grid->wire.columns, count = columns * grid->wire.rows;
    uint8_t *data = mem_array(grid->wire.data_bytes + 1u, 1);
    *read = (struct depth_read){ .wire = grid->wire };
    read->near = mem_array((size_t)count, sizeof(*read->near));
    read->far = mem_array((size_t)count, sizeof(*read->far));
    read->masks = mem_array((size_t)count, sizeof(*read->masks));
    struct payload_bytes bytes = { data + (count + 7) / 8, data + grid->wire.data_bytes, inflate_all(grid, data) };
    if (bytes.good)
        read_far(read, &bytes);
    for (int i = 0; i < count && bytes.good; i++)
        read->near[i] = data[i / 8] >> i % 8 & 1 ? near_symbol(read, &bytes, i) : read->far[i];
    for (int i = 0; i < count && bytes.good; i++)
        if (data[i / 8] >> i % 8 & 1)
            read_mask(read, &bytes, i);
    bytes.good &= bytes.at == bytes.end;
    mem_free(data);
    return bytes.good;
}

void depth_read_finish(struct depth_read *read)
{
    for (int i = 0; i < read->wire.columns * read->wire.rows; i++)
        mem_free(read->masks[i]);
    mem_free(read->masks);
    mem_free(read->near);
    mem_free(read->far);
    *read = (struct depth_read){ 0 };
}

double depth_read_value(const struct depth_read *read, int code)
{
    return (double)read->wire.base + (code - 1) * (double)read->wire.unit;
}
