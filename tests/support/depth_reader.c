/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inflates a depth grid and undoes its prediction. */
#include "tests/support/depth_reader.h"

#include <string.h>
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

static void read_near(struct depth_read *read, struct payload_bytes *bytes)
{
    int columns = read->wire.columns;
    for (int i = 0; i < columns * read->wire.rows; i++) {
        int left = i % columns ? read->near[i - 1] : 0, up = i >= columns ? read->near[i - columns] : 0;
        int corner = i % columns && i >= columns ? read->near[i - columns - 1] : 0, predicted = left ? left : up;
        if (left && up && corner) {
            predicted = left + up - corner;
            predicted = predicted < 1 ? 1 : predicted > read->wire.levels ? read->wire.levels : predicted;
        }
        read->near[i] = symbol(bytes, predicted);
    }
}

static void read_mask(struct depth_read *read, struct payload_bytes *bytes, int cell)
{
    int bits = read->wire.mask_side * read->wire.mask_side;
    read->masks[cell] = mem_array((size_t)bits, 1);
    for (int b = 0, byte = 0; b < bits; b++) {
        byte = b % 8 ? byte : (int)next(bytes);
        read->masks[cell][b] = byte >> b % 8 & 1;
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
        read_near(read, &bytes);
    for (int i = 0; i < count && bytes.good; i++) {
        bool divided = data[i / 8] >> i % 8 & 1;
        read->far[i] = divided ? symbol(&bytes, i % columns ? read->far[i - 1] : 0) : read->near[i];
    }
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
