/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parsing of the headers of frame messages: test vectors that the browser's parser shares, and random bytes. */
#include "protocol/wire.h"

#include "tests/support/test.h"
#include <dirent.h>
#include <jansson.h>

#include "base/text/text.h"

#define FOLDER "protocol/vectors/frame"

static uint64_t number(const json_t *o, const char *name)
{
    const json_t *value = json_object_get(o, name);
    if (!json_is_integer(value))
        fail_msg("the vector has no integer '%s'", name);
    return (uint64_t)json_integer_value(value);
}

static void vector(const json_t *o, const char *name, float v[3])
{
    const json_t *array = json_object_get(o, name);
    assert_int_equal(json_array_size(array), 3);
    for (size_t i = 0; i < 3; i++)
        v[i] = (float)json_number_value(json_array_get(array, i));
}

static struct wire_frame frame_of_json(const json_t *o)
{
    struct wire_frame f = {
        .type = (uint8_t)number(o, "type"),
        .codec = (uint8_t)number(o, "codec"),
        .flags = (uint16_t)number(o, "flags"),
        .payload_bytes = (uint32_t)number(o, "payload_bytes"),
        .seq = (uint32_t)number(o, "seq"),
        .camera_seq = (uint32_t)number(o, "camera_seq"),
        .params_seq = (uint32_t)number(o, "params_seq"),
        .oldest_age_ms = (uint32_t)number(o, "oldest_age_ms"),
        .data_time_us = number(o, "data_time_us"),
        .sent_time_us = number(o, "sent_time_us"),
        .wait_us = (uint32_t)number(o, "wait_us"),
        .field_us = (uint32_t)number(o, "field_us"),
        .render_us = (uint32_t)number(o, "render_us"),
        .encode_us = (uint32_t)number(o, "encode_us"),
        .x_px = (uint16_t)number(o, "x"),
        .y_px = (uint16_t)number(o, "y"),
        .width_px = (uint16_t)number(o, "width"),
        .height_px = (uint16_t)number(o, "height"),
        .full_width_px = (uint16_t)number(o, "full_width"),
        .full_height_px = (uint16_t)number(o, "full_height"),
        .fov_deg = (float)json_number_value(json_object_get(o, "fov")),
        .height_m = (float)json_number_value(json_object_get(o, "height_m")),
    };
    vector(o, "eye", f.eye_m);
    vector(o, "target", f.target_m);
    vector(o, "up", f.up);
    return f;
}

static void assert_same_header(const struct wire_frame *a, const struct wire_frame *b)
{
    uint8_t bytes_a[WIRE_FRAME_HEADER_BYTES], bytes_b[WIRE_FRAME_HEADER_BYTES];
    wire_put_frame(a, bytes_a);
    wire_put_frame(b, bytes_b);
    assert_memory_equal(bytes_a, bytes_b, WIRE_FRAME_HEADER_BYTES);
}

static bool reserved_is_zero(const char *bytes)
{
    return !memcmp(bytes + 108, "\0\0\0\0", 4);
}

static void check_vector(const char *name, bool *valid)
{
    size_t count, json_count;
    char *bin = test_printf("%s/%s.bin", FOLDER, name), *sidecar = test_printf("%s/%s.json", FOLDER, name);
    char *bytes = test_memory(text_read_file(bin, 1 << 20, &count)), *text = test_memory(text_read_file(sidecar, 1 << 20, &json_count));
    assert_non_null(bytes);
    assert_non_null(text);
    json_t *expected = test_json(json_loads(text, JSON_REJECT_DUPLICATES, NULL));
    assert_non_null(expected);
    struct wire_frame got;
    *valid = json_is_true(json_object_get(expected, "valid"));
    if (wire_get_frame((const uint8_t *)bytes, count, &got) != *valid)
        fail_msg("%s: read as %s, the vector says otherwise", name, *valid ? "wrong" : "good");
    if (*valid) {
        struct wire_frame want = frame_of_json(expected);
        uint8_t header[WIRE_FRAME_HEADER_BYTES];
        assert_same_header(&got, &want);
        wire_put_frame(&want, header);
        assert_memory_equal(header, bytes, reserved_is_zero(bytes) ? WIRE_FRAME_HEADER_BYTES : 108);
    }
}

TEST(reads_and_writes_the_vectors)
{
    int good = 0, bad = 0;
    DIR *folder = opendir(FOLDER);
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder));) {
        char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".bin") != 0)
            continue;
        bool valid;
        *dot = 0;
        check_vector(entry->d_name, &valid);
        *(valid ? &good : &bad) += 1;
    }
    closedir(folder);
    assert_true(good >= 9 && bad >= 17);
}

TEST(every_cut_of_a_frame_is_refused)
{
    size_t count;
    uint8_t *bytes = test_memory((uint8_t *)text_read_file(FOLDER "/jpeg-key.bin", 1 << 20, &count));
    struct wire_frame frame;
    assert_non_null(bytes);
    for (size_t n = 0; n < count; n++)
        assert_false(wire_get_frame(bytes, n, &frame));
    assert_true(wire_get_frame(bytes, count, &frame));
}

/* Random changes of a valid frame header: the parser must refuse the header, or return values within their ranges that, written
   again, give the same bytes. */
TEST(random_headers_are_refused_or_sane)
{
    unsigned seed = (unsigned)sweep_seed(), accepted = 0;
    size_t count;
    uint8_t *bytes = test_memory((uint8_t *)text_read_file(FOLDER "/jpeg-key.bin", 1 << 20, &count));
    assert_non_null(bytes);
    for (int i = 0; i < 200000; i++) {
        uint8_t changed[WIRE_FRAME_HEADER_BYTES + 1024];
        struct wire_frame f;
        memcpy(changed, bytes, count);
        changed[(unsigned)rand_r(&seed) % WIRE_FRAME_HEADER_BYTES] ^= (uint8_t)(1 << rand_r(&seed) % 8);
        if (!wire_get_frame(changed, count, &f))
            continue;
        accepted++;
        uint8_t again[WIRE_FRAME_HEADER_BYTES];
        wire_put_frame(&f, again);
        assert_memory_equal(again, changed, 108);
        assert_true(f.x_px + f.width_px <= f.full_width_px && f.full_width_px <= WIRE_MAX_FRAME_PX);
        assert_true(f.payload_bytes == count - WIRE_FRAME_HEADER_BYTES);
        assert_true(f.fov_deg == 0 ? f.height_m > 0 : f.fov_deg >= 1 && f.fov_deg <= 120 && f.height_m == 0);
    }
    assert_true(accepted > 1000);
}
