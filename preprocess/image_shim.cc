/* SPDX-License-Identifier: GPL-3.0-or-later */
/* OpenImageIO behind plain C: PNG and JPEG from memory to RGBA8. */
#include "preprocess/image_shim.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>

extern "C" {
#include "base/mem.h"
}

namespace
{

constexpr int MAX_SIDE_PX = 1 << 15;

/* OpenImageIO chooses its reader by name: the bytes say what they are. */
const char *format_of(const unsigned char *bytes, size_t size)
{
    if (size >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0)
        return "png";
    if (size >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0)
        return "jpeg";
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

bool decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char *why)
{
    const char *format = format_of(static_cast<const unsigned char *>(bytes), size);
    if (!format) {
        snprintf(why, IMAGE_WHY_BYTES, "%zu bytes are neither PNG nor JPEG", size);
        return false;
    }
    OIIO::Filesystem::IOMemReader memory(const_cast<void *>(bytes), size);
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
    OIIO::ImageSpec spec;
    if (!in || !in->set_ioproxy(&memory) || !in->open("image", spec, hints)) {
        snprintf(why, IMAGE_WHY_BYTES, "%s", in ? in->geterror().c_str() : OIIO::geterror().c_str());
        return false;
    }
    if (spec.width < 1 || spec.width > MAX_SIDE_PX || spec.height < 1 || spec.height > MAX_SIDE_PX || spec.nchannels < 1 ||
        spec.nchannels > 4) {
        snprintf(why, IMAGE_WHY_BYTES, "%d x %d pixels of %d channels: at most %d x %d of 4", spec.width, spec.height, spec.nchannels,
                 MAX_SIDE_PX, MAX_SIDE_PX);
        return false;
    }
    size_t pixels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    int channels = spec.nchannels;
    std::vector<uint8_t> raw(pixels * static_cast<size_t>(channels));
    image->rgba = static_cast<uint8_t *>(mem_try_array(pixels, 4));
    if (!image->rgba)
        throw std::bad_alloc();
    if (!in->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, raw.data())) {
        snprintf(why, IMAGE_WHY_BYTES, "%s", in->geterror().c_str());
        return false;
    }
    spread(raw.data(), channels, pixels, image->rgba);
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
