/* SPDX-License-Identifier: GPL-3.0-or-later */
/* OpenImageIO behind plain C: PNG, JPEG and WebP from memory to RGBA8. */
#include "preprocess/image_shim.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

extern "C" {
#include "base/mem.h"
}

namespace
{

constexpr int MAX_SIDE_PX = 1 << 15;
constexpr uint64_t MAX_PIXELS = 1 << 26;                          /* of 8192 x 8192: more than a texture is ever drawn with */
constexpr uint64_t VALUES_PER_BYTE = 2000, FREE_VALUES = 1 << 20; /* zlib shrinks to a thousandth at best, JPEG to less */

/* OpenImageIO chooses its reader by name: the bytes say what they are. */
const char *format_of(const unsigned char *bytes, size_t size)
{
    if (size >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0)
        return "png";
    if (size >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0)
        return "jpeg";
    if (size >= 12 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0)
        return "webp";
    return nullptr;
}

/* One to four channels as four: grey, grey and alpha, RGB, RGBA. */
void spread(const uint8_t *from, int channels, size_t pixels, uint8_t *to)
{
    for (size_t i = 0; i < pixels; i++, from += channels, to += 4) {
        bool grey = channels < 3;
        to[0] = from[0];
        to[1] = grey ? from[0] : from[1];
        to[2] = grey ? from[0] : from[2];
        to[3] = channels == 2 ? from[1] : channels == 4 ? from[3] : 255;
    }
}

void shrink(struct image *image, uint32_t max_px)
{
    uint32_t longest = std::max(image->width_px, image->height_px);
    if (longest <= max_px)
        return;
    int width = static_cast<int>(std::max<uint64_t>(1, static_cast<uint64_t>(image->width_px) * max_px / longest));
    int height = static_cast<int>(std::max<uint64_t>(1, static_cast<uint64_t>(image->height_px) * max_px / longest));
    OIIO::ImageBuf from(OIIO::ImageSpec(static_cast<int>(image->width_px), static_cast<int>(image->height_px), 4, OIIO::TypeDesc::UINT8),
                        image->rgba);
    OIIO::ImageBuf to = OIIO::ImageBufAlgo::resize(from, "", 0, OIIO::ROI(0, width, 0, height, 0, 1, 0, 4), 1);
    if (to.has_error() || !to.get_pixels(OIIO::ROI(0, width, 0, height, 0, 1, 0, 4), OIIO::TypeDesc::UINT8, image->rgba))
        throw std::runtime_error(to.geterror());
    image->width_px = static_cast<uint32_t>(width);
    image->height_px = static_cast<uint32_t>(height);
}

bool refuse(char *why, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
bool refuse(char *why, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(why, IMAGE_WHY_BYTES, fmt, ap);
    va_end(ap);
    return false;
}

bool size_good(const OIIO::ImageSpec &spec, const char *format, size_t size, char *why)
{
    if (spec.width < 1 || spec.width > MAX_SIDE_PX || spec.height < 1 || spec.height > MAX_SIDE_PX || spec.nchannels < 1 ||
        spec.nchannels > 4 || static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) > MAX_PIXELS)
        return refuse(why, "%d x %d pixels of %d channels: at most %llu of 4", spec.width, spec.height, spec.nchannels,
                      static_cast<unsigned long long>(MAX_PIXELS));
    uint64_t values = static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) * static_cast<uint64_t>(spec.nchannels);
    if (strcmp(format, "webp") != 0 && values > FREE_VALUES + VALUES_PER_BYTE * size) /* WebP knows plain colours */
        return refuse(why, "%zu bytes claim %d x %d pixels", size, spec.width, spec.height);
    return true;
}

/* Chunks up to the last: libpng leaves OpenImageIO's reader by a jump, which leaks, where one is cut off. */
bool png_whole(const unsigned char *bytes, size_t size)
{
    for (size_t at = 8; size - at >= 12;) {
        size_t length = static_cast<size_t>(bytes[at]) << 24 | static_cast<size_t>(bytes[at + 1]) << 16 |
                        static_cast<size_t>(bytes[at + 2]) << 8 | bytes[at + 3];
        if (length > size - at - 12)
            return false;
        if (memcmp(bytes + at + 4, "IEND", 4) == 0)
            return true;
        at += length + 12;
    }
    return false;
}

bool decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char *why)
{
    const char *format = format_of(static_cast<const unsigned char *>(bytes), size);
    if (!format)
        return refuse(why, "%zu bytes are neither PNG, JPEG nor WebP", size);
    if (strcmp(format, "png") == 0 && !png_whole(static_cast<const unsigned char *>(bytes), size))
        return refuse(why, "png: cut off, or not whole chunks in its %zu bytes", size);
    OIIO::Filesystem::IOMemReader memory(const_cast<void *>(bytes), size);
    OIIO::ImageSpec hints, spec;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
    if (!in || !in->set_ioproxy(&memory) || !in->open("image", spec, hints))
        return refuse(why, "%s: %s", format, in ? in->geterror().c_str() : OIIO::geterror().c_str());
    if (!size_good(spec, format, size, why))
        return false;
    size_t pixels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    std::vector<uint8_t> raw(pixels * static_cast<size_t>(spec.nchannels));
    image->rgba = static_cast<uint8_t *>(mem_try_array(pixels, 4));
    if (!image->rgba)
        throw std::bad_alloc();
    bool read = in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, raw.data());
    std::string error = in->geterror();
    if (!read || error.find("Premature end") != std::string::npos) /* the JPEG reader fills up with grey */
        return refuse(why, "%s: %s", format, error.empty() ? "broken" : error.c_str());
    spread(raw.data(), spec.nchannels, pixels, image->rgba);
    image->width_px = static_cast<uint32_t>(spec.width);
    image->height_px = static_cast<uint32_t>(spec.height);
    shrink(image, max_px);
    return true;
}

} // namespace

extern "C" bool image_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    *image = {};
    try {
        if (decode(image, bytes, size, max_px, why))
            return true;
    } catch (const std::bad_alloc &) {
        snprintf(why, IMAGE_WHY_BYTES, "out of memory");
    } catch (const std::exception &e) {
        snprintf(why, IMAGE_WHY_BYTES, "%s", e.what());
    } catch (...) {
        snprintf(why, IMAGE_WHY_BYTES, "the image library failed");
    }
    mem_free(image->rgba);
    *image = {};
    return false;
}
