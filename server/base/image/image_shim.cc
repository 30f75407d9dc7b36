/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plantcast-images.so: decodes, with OpenImageIO, the image formats that image.c does not decode itself. */
#include "base/image/image_impl.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

#include "base/image/srgb.h"

extern "C" {
#include "base/mem.h"
}

namespace
{

constexpr int MAX_FILE_CHANNELS = 64;    /* maximum number of channels in a file; rendering programs add channels beyond the colours */

/* Returns OpenImageIO's name of the reader for the format, according to the first bytes; otherwise OpenImageIO would choose the
   reader by file name. */
const char *format_of(const unsigned char *bytes, size_t size)
{
    if (size >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0)
        return "jpeg";
    if (size >= 12 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0)
        return "webp";
    return nullptr;
}

/* Expands one to four channels (grey; grey and alpha; RGB; RGBA) to four. */
template <typename T> void spread(const T *from, int channels, size_t pixels, T opaque, T *to)
{
    for (size_t i = 0; i < pixels; i++, from += channels, to += 4) {
        bool grey = channels < 3;
        to[0] = from[0];
        to[1] = grey ? from[0] : from[1];
        to[2] = grey ? from[0] : from[2];
        to[3] = channels == 2 ? from[1] : channels == 4 ? from[3] : opaque;
    }
}

template <typename T> struct kind;
template <> struct kind<uint8_t> {
    static constexpr OIIO::TypeDesc::BASETYPE type = OIIO::TypeDesc::UINT8;
    static constexpr uint8_t opaque = 255;
};
template <> struct kind<float> {
    static constexpr OIIO::TypeDesc::BASETYPE type = OIIO::TypeDesc::FLOAT;
    static constexpr float opaque = 1;
};

/* Scales an image down in place until no side exceeds max_px. */
template <typename T> void shrink(T *rgba, uint32_t *width_px, uint32_t *height_px, uint32_t max_px)
{
    uint32_t longest = std::max(*width_px, *height_px);
    if (longest <= max_px)
        return;
    int width = static_cast<int>(std::max<uint64_t>(1, static_cast<uint64_t>(*width_px) * max_px / longest));
    int height = static_cast<int>(std::max<uint64_t>(1, static_cast<uint64_t>(*height_px) * max_px / longest));
    OIIO::ImageBuf from(OIIO::ImageSpec(static_cast<int>(*width_px), static_cast<int>(*height_px), 4, kind<T>::type), rgba);
    OIIO::ROI all(0, width, 0, height, 0, 1, 0, 4);
    OIIO::ImageBuf to = OIIO::ImageBufAlgo::resize(from, "", 0, all, 1);
    if (to.has_error() || !to.get_pixels(all, kind<T>::type, rgba))
        throw std::runtime_error(to.geterror());
    *width_px = static_cast<uint32_t>(width);
    *height_px = static_cast<uint32_t>(height);
}

/* Reads the whole image as four channels, scaled down to max_px. Throws on errors. */
template <typename T>
void read_pixels(OIIO::ImageInput *in, const OIIO::ImageSpec &spec, uint32_t max_px, T **rgba, uint32_t *width_px, uint32_t *height_px)
{
    int channels = std::min(spec.nchannels, 4);
    size_t pixels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    std::vector<T> raw(pixels * static_cast<size_t>(channels));
    *rgba = static_cast<T *>(mem_try_array(pixels, 4 * sizeof(T)));
    if (!*rgba)
        throw std::bad_alloc();
    bool read = in->read_image(0, 0, 0, channels, kind<T>::type, raw.data());
    std::string error = in->geterror();
    /* a truncated JPEG file counts as broken; the JPEG reader only mentions it in its error text and fills the missing rows with grey */
    if (!read || error.find("Premature end") != std::string::npos)
        throw std::runtime_error(error.empty() ? "broken" : error);
    spread(raw.data(), channels, pixels, kind<T>::opaque, *rgba);
    *width_px = static_cast<uint32_t>(spec.width);
    *height_px = static_cast<uint32_t>(spec.height);
    shrink(*rgba, width_px, height_px, max_px);
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

bool size_good(const OIIO::ImageSpec &spec, int max_channels, char *why)
{
    constexpr int MAX_SIDE_PX = IMAGE_MAX_SIDE_PX;
    if (spec.width >= 1 && spec.width <= MAX_SIDE_PX && spec.height >= 1 && spec.height <= MAX_SIDE_PX && spec.nchannels >= 1 &&
        spec.nchannels <= max_channels && spec.depth <= 1 &&
        static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) <= IMAGE_MAX_PIXELS)
        return true;
    return refuse(why, "the picture has %d x %d pixels of %d channels; at most %llu pixels of %d channels are supported", spec.width,
                  spec.height, spec.nchannels, static_cast<unsigned long long>(IMAGE_MAX_PIXELS), max_channels);
}

bool claim_good(const OIIO::ImageSpec &spec, const char *format, size_t size, char *why)
{
    uint64_t values = static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) * static_cast<uint64_t>(spec.nchannels);
    /* refuses files too short for the size that they state; not WebP files, which store even large single-colour images in a
       few bytes */
    if (strcmp(format, "webp") != 0 && values > IMAGE_FREE_VALUES + uint64_t{ IMAGE_VALUES_PER_BYTE } * size)
        return refuse(why, "the picture file is truncated or damaged: %zu bytes cannot hold %d x %d pixels", size, spec.width, spec.height);
    return true;
}

bool decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char *why)
{
    const char *format = format_of(static_cast<const unsigned char *>(bytes), size);
    if (!format)
        return refuse(why, "the picture of %zu bytes is not in the format JPEG or WebP", size);
    OIIO::Filesystem::IOMemReader memory(const_cast<void *>(bytes), size);
    OIIO::ImageSpec hints, spec;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
    if (!in || !in->set_ioproxy(&memory) || !in->open("image", spec, hints))
        return refuse(why, "%s: %s", format, in ? in->geterror().c_str() : OIIO::geterror().c_str());
    if (!size_good(spec, 4, why) || !claim_good(spec, format, size, why))
        return false;
    try {
        read_pixels(in.get(), spec, max_px, &image->rgba, &image->width_px, &image->height_px);
    } catch (const std::runtime_error &e) {
        return refuse(why, "%s: %s", format, e.what());
    }
    return true;
}

/* Opens an image by its content, regardless of the file name. Returns NULL with the reason in `why` on failure. */
std::unique_ptr<OIIO::ImageInput> open_file(const char *path, OIIO::ImageSpec *spec, char *why)
{
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &hints);
    if (!in) {
        refuse(why, "%s", OIIO::geterror().c_str());
        return in;
    }
    *spec = in->spec();
    if (!size_good(*spec, MAX_FILE_CHANNELS, why))
        in.reset();
    return in;
}

bool load(struct image *image, const char *path, uint32_t max_px, char *why)
{
    OIIO::ImageSpec spec;
    std::unique_ptr<OIIO::ImageInput> in = open_file(path, &spec, why);
    if (in)
        read_pixels(in.get(), spec, max_px, &image->rgba, &image->width_px, &image->height_px);
    return in != nullptr;
}

bool load_float(struct image_float *image, const char *path, uint32_t max_px, char *why)
{
    OIIO::ImageSpec spec;
    std::unique_ptr<OIIO::ImageInput> in = open_file(path, &spec, why);
    if (!in)
        return false;
    read_pixels(in.get(), spec, max_px, &image->rgba, &image->width_px, &image->height_px);
    if (spec.format.is_floating_point() || spec.get_string_attribute("oiio:ColorSpace") == "linear")
        return true;
    size_t values = static_cast<size_t>(image->width_px) * image->height_px * 4;
    for (size_t i = 0; i < values; i++)
        if (i % 4 != 3)
            image->rgba[i] = linear_from_srgbf(image->rgba[i]);
    return true;
}

/* Calls a function that may throw. If it throws, frees the partial image and returns false with the reason in `why`. */
template <typename I, typename F> bool guarded(I *image, char *why, F read)
{
    *image = {};
    try {
        if (read())
            return true;
    } catch (const std::bad_alloc &) {
        refuse(why, "out of memory");
    } catch (const std::exception &e) {
        refuse(why, "%s", e.what());
    } catch (...) {
        refuse(why, "the image library could not read the picture, and gave no reason");
    }
    mem_free(image->rgba);
    *image = {};
    return false;
}

} // namespace

extern "C" bool images_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    return guarded(image, why, [=] { return decode(image, bytes, size, max_px, why); });
}

extern "C" bool images_load(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    return guarded(image, why, [=] { return load(image, path, max_px, why); });
}

extern "C" bool images_load_float(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    return guarded(image, why, [=] { return load_float(image, path, max_px, why); });
}
