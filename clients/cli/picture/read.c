/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast read`: reads which measured value the colour of a picture's pixel shows. The picture needs a legend strip
   along its edge, which contains the colour scale; no other data is used. */
#include <cairo.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "clients/cli/commands.h"
#include "clients/link/png.h"
#include "field/params.h"
#include "provenance/strip_reader.h"

static const size_t MAX_BYTES = (size_t)256 << 20;

static void print_usage(FILE *out)
{
    fputs("usage: plantcast read PICTURE X Y [X Y]...\n"
          "\n"
          "Prints the value that a pixel shows, and the range of values that have the same colour.\n"
          "PICTURE is a PNG or JPEG drawn with --strip legend (/snapshot.png: strip=legend).\n"
          "PICTURE may be scaled, compressed, or part of a screenshot.\n"
          "The strip contains the range and the unit of the values, so the file's metadata is not needed.\n"
          "X and Y are the column and row of a pixel, counted from 0 at the upper left corner.\n"
          "Exit status: 0 success, 1 no strip in the picture or no value at a pixel, 2 unreadable picture.\n",
          out);
}

static bool read_jpeg(const uint8_t *bytes, size_t count, struct strip_picture *picture)
{
    int subsampling, colors;
    tjhandle turbo = tjInitDecompress();
    bool good = turbo && tjDecompressHeader3(turbo, bytes, count, &picture->width_px, &picture->height_px, &subsampling, &colors) == 0;
    picture->stride_bytes = picture->width_px * 4;
    uint8_t *pixels = good ? mem_try_array((size_t)picture->height_px, (size_t)picture->stride_bytes) : NULL;
    good = pixels && tjDecompress2(turbo, bytes, count, pixels, picture->width_px, 0, picture->height_px, TJPF_BGRX, 0) == 0;
    picture->bgrx = pixels;
    tjDestroy(turbo);
    return good;
}

static bool read_png(const uint8_t *at, size_t count, struct strip_picture *picture)
{
    cairo_surface_t *surface = png_read(at, count);
    cairo_format_t format = surface ? cairo_image_surface_get_format(surface) : CAIRO_FORMAT_INVALID;
    bool good = format == CAIRO_FORMAT_RGB24 || format == CAIRO_FORMAT_ARGB32;
    if (good) {
        *picture = (struct strip_picture){ .width_px = cairo_image_surface_get_width(surface),
                                           .height_px = cairo_image_surface_get_height(surface),
                                           .stride_bytes = cairo_image_surface_get_stride(surface) };
        size_t bytes = (size_t)picture->height_px * (size_t)picture->stride_bytes;
        uint8_t *pixels = mem_try_array(1, bytes);
        if (pixels)
            memcpy(pixels, cairo_image_surface_get_data(surface), bytes);
        picture->bgrx = pixels;
        good = pixels != NULL;
    }
    cairo_surface_destroy(surface);
    return good;
}

static bool read_picture(const char *path, struct strip_picture *picture)
{
    size_t count = 0;
    char *bytes = text_read_file(path, MAX_BYTES, &count);
    if (!bytes) {
        fprintf(stderr, "plantcast: %s: %m\n", path);
        return false;
    }
    bool is_jpeg = count > 2 && !memcmp(bytes, "\xff\xd8", 2);
    bool good = (is_jpeg ? read_jpeg : read_png)((const uint8_t *)bytes, count, picture);
    if (!good)
        fprintf(stderr, "plantcast: %s: expected a valid PNG or JPEG file\n", path);
    mem_free(bytes);
    return good;
}

static bool print_value(const struct strip_picture *picture, const struct strip_found *found, int x, int y)
{
    const struct strip *strip = &found->strip;
    const char *gap = *strip->unit ? " " : "";
    struct strip_value value;
    if (!strip_read(picture, found, x, y, &value)) {
        printf("%d,%d: this pixel is outside the picture, or on the legend strip\n", x, y);
        return false;
    }
    switch (value.state) {
    case STRIP_VALUE:
        printf("%d,%d: %.4g%s%s (%.4g to %.4g)\n", x, y, value.value, gap, strip->unit, value.low, value.high);
        return true;
    case STRIP_BELOW: printf("%d,%d: below %g%s%s\n", x, y, (double)strip->min, gap, strip->unit); return true;
    case STRIP_ABOVE: printf("%d,%d: above %g%s%s\n", x, y, (double)strip->max, gap, strip->unit); return true;
    default: printf("%d,%d: this pixel's colour is not in the legend\n", x, y); return false;
    }
}

static bool whole(const char *text, int *out)
{
    char *end;
    long number = strtol(text, &end, 10);
    *out = (int)number;
    return end != text && !*end && number >= 0 && number < 1 << 20;
}

/* Returns the words for the quantity (enum field_show) that a picture shows. show: number in the picture's strip, which a newer version
   may have written. */
static const char *words_of(uint8_t show)
{
    static const char *const words[] = { [SHOW_VALUE] = "",
                                         [SHOW_DISTANCE] = ", distance",
                                         [SHOW_DIFFERENCE] = ", difference",
                                         [SHOW_OPERATOR] = ", between limits",
                                         [SHOW_UNCERTAINTY] = ", standard deviation",
                                         [SHOW_BLIND] = ", detectable hot spot" };
    return show < sizeof(words) / sizeof(words[0]) ? words[show] : ", unknown quantity";
}

int cmd_read(int argc, char **argv)
{
    struct strip_picture picture = { 0 };
    struct strip_found *found = NULL;
    const char *why = NULL;
    int x, y, code = 2;
    if (argc == 2 && !strcmp(argv[1], "--help")) {
        print_usage(stdout);
        return 0;
    }
    bool good = argc >= 4 && argc % 2 == 0;
    for (int i = 2; good && i < argc; i++)
        good = whole(argv[i], &x);
    if (!good) {
        print_usage(stderr);
        return 2;
    }
    found = mem_new(sizeof(*found));
    if (read_picture(argv[1], &picture)) {
        code = !strip_find(&picture, found, &why);
        if (code)
            fprintf(stderr, "plantcast: %s: %s\n", argv[1], why);
        else
            printf("%s: group %s%s, %g to %g %s%s\n", argv[1], found->strip.group, words_of(found->strip.show), (double)found->strip.min,
                   (double)found->strip.max, found->strip.unit, found->strip.log ? ", logarithmic" : "");
        for (int i = 2; !why && i < argc; i += 2)
            code |= !(whole(argv[i], &x) && whole(argv[i + 1], &y) && print_value(&picture, found, x, y));
    }
    mem_free((void *)picture.bgrx);
    mem_free(found);
    return code;
}
