/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Images: decoding an encoded picture gives the original, large pictures are scaled down, and truncated or oversized files are
   refused. */
#include "base/image/image.h"

#include "tests/support/test.h"
#include <png.h>
#include <turbojpeg.h>

struct encoded {
    unsigned char *bytes;
    unsigned long size;
};

/* Makes a picture whose left half is red and right half green, with blue increasing downwards. */
static unsigned char *picture(uint32_t width, uint32_t height, int channels)
{
    unsigned char *pixels = mem_array((size_t)width * height, (size_t)channels);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const unsigned char color[4] = { x < width / 2 ? 255 : 0, x < width / 2 ? 0 : 255, (unsigned char)(255 * y / height), 128 };
            memcpy(pixels + ((size_t)y * width + x) * (size_t)channels, channels < 3 ? color + 2 : color, (size_t)channels);
        }
    return pixels;
}

static struct encoded png_of(uint32_t width, uint32_t height, int channels)
{
    static const uint32_t formats[] = { 0, PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB, PNG_FORMAT_RGBA };
    png_image image = { .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = formats[channels] };
    unsigned char *pixels = picture(width, height, channels);
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    struct encoded out = { .bytes = malloc(size) };
    assert_true(png_image_write_to_memory(&image, out.bytes, &size, 0, pixels, 0, NULL));
    out.size = size;
    mem_free(pixels);
    return out;
}

static struct encoded jpeg_of(int width, int height)
{
    struct encoded out = { 0 };
    unsigned char *pixels = picture((uint32_t)width, (uint32_t)height, 3);
    tjhandle handle = tjInitCompress();
    unsigned char *bytes = NULL;
    assert_int_equal(tjCompress2(handle, pixels, width, 0, height, TJPF_RGB, &bytes, &out.size, TJSAMP_444, 95, 0), 0);
    out.bytes = malloc(out.size);
    memcpy(out.bytes, bytes, out.size);
    tjFree(bytes);
    tjDestroy(handle);
    mem_free(pixels);
    return out;
}

static void assert_refused(const void *bytes, size_t size, const char *reason)
{
    struct image image;
    char why[IMAGE_WHY_BYTES] = "accepted";
    bool good = image_decode(&image, bytes, size, 2048, why);
    if (good || !strstr(why, reason))
        fail_msg("%zu bytes: '%s', expected '%s'", size, why, reason);
}

TEST(png_of_every_kind_comes_back)
{
    for (int channels = 1; channels <= 4; channels++) {
        struct encoded png = png_of(40, 30, channels);
        unsigned char *pixels = picture(40, 30, channels);
        struct image image;
        char why[IMAGE_WHY_BYTES] = "";
        if (!image_decode(&image, png.bytes, png.size, 2048, why))
            fail_msg("%d channels: %s", channels, why);
        assert_int_equal(image.width_px, 40);
        assert_int_equal(image.height_px, 30);
        for (int i = 0; i < 40 * 30; i++) {
            const unsigned char *from = pixels + i * channels, *to = image.rgba + 4 * i;
            assert_int_equal(to[0], from[0]);
            assert_int_equal(to[1], from[channels < 3 ? 0 : 1]);
            assert_int_equal(to[3], channels == 4 ? from[3] : channels == 2 ? from[1] : 255);
        }
        mem_free(image.rgba);
        mem_free(pixels);
        free(png.bytes);
    }
}

TEST(jpeg_comes_back_and_great_ones_shrink)
{
    struct encoded jpeg = jpeg_of(400, 200);
    for (uint32_t most = 100; most <= 400; most *= 4) {
        struct image image;
        char why[IMAGE_WHY_BYTES] = "";
        if (!image_decode(&image, jpeg.bytes, jpeg.size, most, why))
            fail_msg("%s", why);
        assert_int_equal(image.width_px, most);
        assert_int_equal(image.height_px, most / 2);
        const uint8_t *left = image.rgba + 4 * (most / 4 * image.width_px + most / 8), *right = left + 4 * (most / 2);
        assert_true(left[0] > 240 && left[1] < 15 && right[0] < 15 && right[1] > 240 && left[3] == 255);
        mem_free(image.rgba);
    }
    free(jpeg.bytes);
}

/* Asserts that an image file decodes to one row of these RGBA pixels. */
static void assert_row(const unsigned char *bytes, size_t size, const char *pixels, size_t pixel_bytes)
{
    struct image image;
    char why[IMAGE_WHY_BYTES] = "";
    if (!image_decode(&image, bytes, size, 2048, why))
        fail_msg("%s", why);
    assert_int_equal(4 * image.width_px, pixel_bytes);
    assert_memory_equal(image.rgba, pixels, pixel_bytes);
    mem_free(image.rgba);
}

/* The PNG files state a gamma of 1, which must be ignored, as glTF demands. */
TEST(palettes_and_16_bits_become_8_bits)
{
    static const unsigned char rows[2][6] = { { 0, 1 }, { 0x80, 0x80, 0x12, 0x34, 0xff, 0xff } };
    for (int wide = 0; wide < 2; wide++) {
        unsigned char *bytes = NULL;
        size_t size = 0;
        FILE *file = open_memstream((char **)&bytes, &size);
        png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
        png_infop info = png_create_info_struct(png);
        png_color colors[2] = { { 1, 2, 3 }, { 4, 5, 6 } };
        png_init_io(png, file);
        png_set_IHDR(png, info, wide ? 1 : 2, 1, wide ? 16 : 8, wide ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_ADAM7,
                     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_set_gAMA(png, info, 1);
        if (!wide) {
            png_set_PLTE(png, info, colors, 2);
            png_set_tRNS(png, info, (unsigned char[]){ 7 }, 1, NULL);
        }
        png_write_info(png, info);
        for (int pass = png_set_interlace_handling(png); pass > 0; pass--)
            png_write_row(png, rows[wide]);
        png_write_end(png, info);
        png_destroy_write_struct(&png, &info);
        fclose(file);
        assert_row(bytes, size, wide ? "\x80\x12\xff\xff" : "\1\2\3\7\4\5\6\xff", wide ? 4 : 8);
        free(bytes);
    }
}

TEST(jpeg_in_cmyk_is_read)
{
    struct encoded out = { 0 };
    unsigned char pixels[16 * 16 * 4], *bytes = NULL;
    struct image image;
    char why[IMAGE_WHY_BYTES] = "";
    memset(pixels, 255, sizeof(pixels)); /* inverted CMYK, as Adobe's programs write it: 255 means no ink */
    tjhandle handle = tjInitCompress();
    assert_int_equal(tjCompress2(handle, pixels, 16, 0, 16, TJPF_CMYK, &bytes, &out.size, TJSAMP_444, 95, 0), 0);
    if (!image_decode(&image, bytes, out.size, 2048, why))
        fail_msg("%s", why);
    assert_true(image.rgba[0] > 250 && image.rgba[1] > 250 && image.rgba[2] > 250 && image.rgba[3] == 255);
    mem_free(image.rgba);
    tjFree(bytes);
    tjDestroy(handle);
}

TEST(webp_is_read)
{
    static const unsigned char webp[] = {
        /* WebP file of 8 x 8 pixels with a grey gradient, encoded by libwebp */
        82, 73, 70,  70,  70,  0,   0,   0,   87,  69,  66,  80,  86,  80,  56,  32,  58, 0,   0,   0,   176, 1,   0,  157, 1,  42,
        8,  0,  8,   0,   0,   0,   0,   37,  164, 0,   2,   231, 112, 175, 101, 144, 0,  254, 255, 255, 126, 117, 51, 255, 72, 70,
        57, 23, 217, 194, 201, 188, 230, 248, 223, 254, 144, 140, 113, 237, 235, 103, 99, 46,  31,  238, 147, 245, 63, 148, 0,  0,
    };
    struct image image;
    char why[IMAGE_WHY_BYTES] = "";
    if (!image_decode(&image, webp, sizeof(webp), 2048, why))
        fail_msg("%s", why);
    assert_int_equal(image.width_px, 8);
    assert_int_equal(image.height_px, 8);
    assert_true(image.rgba[0] < 40 && image.rgba[4 * 63] > 150); /* dark to light */
    mem_free(image.rgba);
    assert_refused(webp, 60, "webp: ");
}

TEST(cut_images_are_refused)
{
    struct encoded all[] = { png_of(64, 64, 3), jpeg_of(64, 64) };
    for (int i = 0; i < 2; i++) {
        /* tries prefixes of the file up to two bytes short of the end, because a JPEG without its last byte is still complete
           */
        for (size_t size = 0; size + 1 < all[i].size; size += 1 + size / 40) {
            struct image image;
            char why[IMAGE_WHY_BYTES] = "";
            if (image_decode(&image, all[i].bytes, size, 2048, why))
                fail_msg("%s: the first %zu bytes of %lu are accepted", i ? "JPEG" : "PNG", size, all[i].size);
            assert_true(why[0] != 0);
        }
        free(all[i].bytes);
    }
}

TEST(false_claims_are_refused)
{
    struct encoded png = png_of(64, 64, 3);
    memcpy(png.bytes + 16, "\0\0\x1f\xff\0\0\x1f\xff", 8); /* 8191 x 8191 */
    png_const_bytep at = png.bytes;
    assert_refused(at, png.size, "");
    uint32_t crc = 0xffffffffu; /* repeated with a correct checksum */
    for (int i = 12; i < 29; i++) {
        crc ^= at[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    crc = ~crc;
    for (int i = 0; i < 4; i++)
        png.bytes[29 + i] = (unsigned char)(crc >> (24 - 8 * i));
    assert_refused(png.bytes, png.size, "bytes cannot hold 8191 x 8191 pixels");
    free(png.bytes);
    assert_refused("GIF89a", 6, "the picture of 6 bytes is not in the format PNG, JPEG or WebP");
    assert_refused("", 0, "the picture of 0 bytes is not");
}

TEST(files_are_told_by_their_bytes)
{
    char *folder = temp_folder();
    struct encoded png = png_of(300, 20, 3);
    char *path = temp_write(folder, "a.jpg", png.bytes, png.size), why[IMAGE_WHY_BYTES] = "";
    struct image image;
    struct image_float linear;
    if (!image_load(&image, path, 100, why))
        fail_msg("%s", why);
    assert_int_equal(image.width_px, 100);
    assert_true(image.rgba[0] > 250 && image.rgba[1] < 5 && image.rgba[4 * 99 + 1] > 250 && image.rgba[3] == 255);
    assert_true(image_load_float(&linear, path, 4096, why));
    const float *last = linear.rgba + 4 * (300 * 19);
    assert_true(last[0] == 1 && last[3] == 1 && fabsf(last[2] - powf((242 / 255.0f + 0.055f) / 1.055f, 2.4f)) < 1e-4f);
    mem_free(image.rgba);
    mem_free(linear.rgba);
    free(png.bytes);
    path = temp_write(folder, "no.png", "GIF98", 5);
    assert_false(image_load(&image, path, 100, why));
    assert_true(why[0] != 0);
    path = temp_path(folder, "missing.png");
    assert_false(image_load_float(&linear, path, 100, why));
}

TEST(radiance_files_keep_their_light)
{
    static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x84\x80\x80\x80\x80";
    char *folder = temp_folder(), *path = temp_write(folder, "sky.hdr", hdr, sizeof(hdr) - 1), why[IMAGE_WHY_BYTES] = "";
    struct image_float image;
    if (!image_load_float(&image, path, 4096, why))
        fail_msg("%s", why);
    assert_int_equal(image.width_px, 2);
    assert_true(fabsf(image.rgba[0] - 8) < 0.1f && fabsf(image.rgba[1] - 4) < 0.1f && fabsf(image.rgba[4] - 0.5f) < 0.01f);
    assert_true(image.rgba[3] == 1);
    mem_free(image.rgba);
}
