/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the frame header's reader against its writer. A header that the reader accepts is valid and the writer produces the
   same bytes from it. A header written from any struct is read back with the same values, or the reader refuses it. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/wire.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void check_sound(const struct wire_frame *frame, size_t count)
{
    require(frame->payload_bytes == count - WIRE_FRAME_HEADER_BYTES && frame->payload_bytes > 0, "length");
    require(frame->x_px + frame->width_px <= frame->full_width_px && frame->y_px + frame->height_px <= frame->full_height_px, "part");
    require(frame->full_width_px <= WIRE_MAX_FRAME_PX && frame->full_height_px <= WIRE_MAX_FRAME_PX, "size");
    for (int i = 0; i < 3; i++)
        require(isfinite(frame->eye_m[i]) && isfinite(frame->target_m[i]) && isfinite(frame->up[i]), "camera");
    require(frame->fov_deg == 0 ? frame->height_m > 0 && isfinite(frame->height_m) : frame->fov_deg >= 1 && frame->fov_deg <= 120, "lens");
}

static void read_then_write(const uint8_t *bytes, size_t count)
{
    struct wire_frame frame;
    uint8_t again[WIRE_FRAME_HEADER_BYTES];
    /* compares only the bytes before height_m if the camera is a perspective one: the reader ignores height_m then, and the
       writer writes 0 */
    enum { RESERVED = 108 };
    if (!wire_get_frame(bytes, count, &frame))
        return;
    check_sound(&frame, count);
    wire_put_frame(&frame, again);
    require(!memcmp(bytes, again, frame.fov_deg == 0 ? sizeof(again) : RESERVED), "read and written it is the same");
}

/* Copies the random bytes into the header struct itself, so that members have nonsensical values, writes the header and reads
   it back. */
static void write_then_read(const uint8_t *bytes, size_t count)
{
    struct wire_frame frame = { 0 }, again;
    uint8_t header[WIRE_FRAME_HEADER_BYTES];
    memcpy(&frame, bytes, count < sizeof(frame) ? count : sizeof(frame));
    frame.payload_bytes = (uint32_t)(count % 1000 + 1);
    wire_put_frame(&frame, header);
    uint8_t *message = calloc(1, sizeof(header) + frame.payload_bytes);
    memcpy(message, header, sizeof(header));
    if (wire_get_frame(message, sizeof(header) + frame.payload_bytes, &again)) {
        require(again.seq == frame.seq && again.camera_seq == frame.camera_seq && again.data_time_us == frame.data_time_us &&
                    again.width_px == frame.width_px && again.eye_m[2] == frame.eye_m[2] && again.flags == frame.flags,
                "written and read it is the same");
        check_sound(&again, sizeof(header) + frame.payload_bytes);
    }
    free(message);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    read_then_write(bytes, count);
    write_then_read(bytes, count);
    return 0;
}
