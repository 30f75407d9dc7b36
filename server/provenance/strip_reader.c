/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the legend strip in a picture by two finder patterns as in a QR code, reads its cells, and matches colours to values. */
#include "provenance/strip_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/color/lab.h"

enum { RUNS = 5, FINDER_CELLS = 7, GREY = 128 };
/* tolerance for the lengths of the dark and light runs of pixels in a finder pattern, as a fraction of a cell */
static const double SLACK = 0.6;
/* a colour counts as not in the legend if its CIELAB distance from all legend colours is larger than this */
static const double STRANGE = 7;
/* two colours count as equal within this CIELAB distance plus the picture's noise */
static const double INDISTINCT = 1.2;
static const double NOISES = 1.5;

/* --- finding the strip -------------------------------------------------------------------------------------------------------- */

static const uint8_t *pixel(const struct strip_picture *picture, int x, int y)
{
    return picture->bgrx + (size_t)y * (size_t)picture->stride_bytes + (size_t)x * 4;
}

static int luma(const uint8_t *bgr)
{
    return (114 * bgr[0] + 587 * bgr[1] + 299 * bgr[2]) / 1000;
}

struct finder {
    double middle_px, cell_px;
};

/* Returns true if five runs of dark, light, dark, light, dark pixels have the lengths 1 : 1 : 3 : 1 : 1, as in a finder pattern.
   *cell_px receives the width of a cell. */
static bool is_finder(const int runs[RUNS], double *cell_px)
{
    static const int expected[RUNS] = { 1, 1, 3, 1, 1 };
    int sum = 0;
    for (int i = 0; i < RUNS; i++)
        sum += runs[i];
    *cell_px = (double)sum / FINDER_CELLS;
    bool good = *cell_px >= 1.5;
    for (int i = 0; good && i < RUNS; i++)
        good = fabs(runs[i] - expected[i] * *cell_px) < SLACK * *cell_px;
    return good;
}

/* Finds all finder patterns in a row of pixels. Returns their number, at most `most`. */
static int find_in_row(const struct strip_picture *picture, int y, struct finder *out, int most)
{
    int runs[RUNS] = { 0 }, count = 0, length = 0;
    bool dark = false;
    for (int x = 0; x <= picture->width_px && count < most; x++) {
        bool is_dark = x < picture->width_px && luma(pixel(picture, x, y)) < GREY;
        if (x < picture->width_px && is_dark == dark) {
            length++;
            continue;
        }
        memmove(runs, runs + 1, (RUNS - 1) * sizeof(*runs));
        runs[RUNS - 1] = length;
        double cell_px;
        if (dark && runs[0] > 0 && is_finder(runs, &cell_px))
            out[count++] = (struct finder){ x - FINDER_CELLS * cell_px / 2, cell_px };
        dark = is_dark;
        length = 1;
    }
    return count;
}

struct strip_row {
    /* left edge of the legend strip in this row of pixels, and width of one of its cells; cell_px 0: the row contains no strip */
    double left_px, cell_px;
};

/* Finds the strip in a row of pixels: two finder patterns at a distance that agrees with the sizes of their cells. */
static struct strip_row strip_in_row(const struct strip_picture *picture, int y)
{
    enum { MAX_FINDERS = 64 };
    static const double APART = STRIP_COLUMNS - STRIP_FINDER; /* distance in cells between the middles of the two finder patterns */
    struct finder finders[MAX_FINDERS];
    int count = find_in_row(picture, y, finders, MAX_FINDERS);
    for (int i = 0; i < count; i++)
        for (int j = count - 1; j > i; j--) {
            double cell_px = (finders[j].middle_px - finders[i].middle_px) / APART;
            if (fabs(finders[i].cell_px - cell_px) < 0.25 * cell_px + 0.3 && fabs(finders[j].cell_px - cell_px) < 0.25 * cell_px + 0.3)
                return (struct strip_row){ finders[i].middle_px - STRIP_FINDER * cell_px / 2, cell_px };
        }
    return (struct strip_row){ 0, 0 };
}

/* Finds the longest run of pixel rows that agree on the strip's position, tolerating up to two unreadable rows in between.
   Returns false if there is no such run, or if its height does not fit the width of the cells. */
static bool find_place(const struct strip_picture *picture, struct strip_found *found)
{
    double best = 0, left_px = 0, cell_px = 0, first = 0, rows = 0;
    for (int y = 0, last = -9; y < picture->height_px; y++) {
        struct strip_row row = strip_in_row(picture, y);
        if (row.cell_px == 0)
            continue;
        bool goes_on = y - last <= 3 && rows > 0 && fabs(row.left_px - left_px / rows) < 2.5 && fabs(row.cell_px - cell_px / rows) < 0.1;
        if (!goes_on) {
            left_px = cell_px = rows = 0;
            first = y;
        }
        left_px += row.left_px;
        cell_px += row.cell_px;
        rows++;
        last = y;
        if (y + 1 - first > best) {
            best = y + 1 - first;
            found->top_px = first;
            found->left_px = left_px / rows;
            found->cell_px = cell_px / rows;
        }
    }
    found->row_px = best / STRIP_ROWS;
    return best > 0 && fabs(found->row_px / found->cell_px - 1) < 0.35;
}

/* --- cells -------------------------------------------------------------------------------------------------------------------- */

struct color_patch {
    double rgb[3]; /* mean colour of the pixels in the patch: red, green, blue */
    int count;
};

/* Returns the mean colour in the inner part of a rectangle of the strip. The rectangle's position and size are in cells. */
static struct color_patch patch_at(const struct strip_picture *picture, const struct strip_found *found, double column, double row,
                                   double rows)
{
    struct color_patch patch = { 0 };
    int x0 = (int)ceil(found->left_px + (column + 0.2) * found->cell_px - 0.5),
        x1 = (int)floor(found->left_px + (column + 0.8) * found->cell_px - 0.5);
    int y0 = (int)ceil(found->top_px + (row + 0.25) * found->row_px - 0.5),
        y1 = (int)floor(found->top_px + (row + rows - 0.25) * found->row_px - 0.5);
    x1 = x1 < x0 ? x0 : x1;
    y1 = y1 < y0 ? y0 : y1;
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            if (x >= 0 && x < picture->width_px && y >= 0 && y < picture->height_px) {
                const uint8_t *bgr = pixel(picture, x, y);
                for (int c = 0; c < 3; c++)
                    patch.rgb[c] += bgr[2 - c];
                patch.count++;
            }
    for (int c = 0; c < 3 && patch.count > 0; c++)
        patch.rgb[c] /= patch.count;
    return patch;
}

static double grey_of(const struct color_patch *patch)
{
    return 0.299 * patch->rgb[0] + 0.587 * patch->rgb[1] + 0.114 * patch->rgb[2];
}

static bool read_code(const struct strip_picture *picture, struct strip_found *found)
{
    const int code_row = 1 + STRIP_SHADES * STRIP_SHADE_CELLS;
    uint8_t code[STRIP_BYTES] = { 0 };
    for (int row = 0; row < STRIP_CODE_ROWS; row++)
        for (int column = 0; column < STRIP_INNER; column++) {
            struct color_patch patch = patch_at(picture, found, STRIP_FINDER + column, code_row + row, 1);
            strip_set_cell(code, row, column, grey_of(&patch) < GREY);
        }
    return strip_decode(code, &found->strip, &found->mended);
}

/* Reads the legend's colours as they appear in this picture, in CIELAB. found->noise receives the RMS deviation of pixels from
   the mean of their column. */
static void read_ramp(const struct strip_picture *picture, struct strip_found *found)
{
    double square = 0;
    int count = 0;
    for (int shade = 0; shade < STRIP_SHADES; shade++)
        for (int i = 0; i < STRIP_INNER; i++) {
            double row = 1 + shade * STRIP_SHADE_CELLS, lab[3];
            struct color_patch patch = patch_at(picture, found, STRIP_FINDER + i, row, STRIP_SHADE_CELLS);
            lab_from_srgb(patch.rgb, VISION_NORMAL, found->ramp[shade][i]);
            int x = (int)(found->left_px + (STRIP_FINDER + i + 0.5) * found->cell_px);
            for (int k = 0; k < 4; k++) {
                int y = (int)(found->top_px + (row + 0.4 + 0.4 * k) * found->row_px);
                if (x < 0 || x >= picture->width_px || y < 0 || y >= picture->height_px)
                    continue;
                const uint8_t *bgr = pixel(picture, x, y);
                lab_from_srgb((double[3]){ bgr[2], bgr[1], bgr[0] }, VISION_NORMAL, lab);
                for (int c = 0; c < 3; c++)
                    square += pow(lab[c] - found->ramp[shade][i][c], 2);
                count++;
            }
        }
    found->noise = count > 0 ? sqrt(square / count) : 0;
}

bool strip_find(const struct strip_picture *picture, struct strip_found *found, const char **why)
{
    memset(found, 0, sizeof(*found));
    if (!find_place(picture, found)) {
        *why = "the picture has no legend strip; draw the picture with --strip legend, and do not crop its lower edge";
        return false;
    }
    if (!read_code(picture, found)) {
        *why = "the legend strip of the picture is too damaged to be read";
        return false;
    }
    read_ramp(picture, found);
    return true;
}

/* --- values ------------------------------------------------------------------------------------------------------------------- */

static double to_segment(const double p[3], const double a[3], const double b[3])
{
    double along = 0, length = 0, square = 0;
    for (int c = 0; c < 3; c++) {
        along += (p[c] - a[c]) * (b[c] - a[c]);
        length += (b[c] - a[c]) * (b[c] - a[c]);
    }
    double t = length > 0 ? fmin(fmax(along / length, 0), 1) : 0;
    for (int c = 0; c < 3; c++)
        square += pow(p[c] - a[c] - t * (b[c] - a[c]), 2);
    return sqrt(square);
}

/* Returns the CIELAB distance of a colour from one column of the legend strip. A column shows its colour in three shades,
   because lighting in the picture changes colours. The distance is measured to the line through the three shades. */
static double off_of(const struct strip_found *found, int column, const double lab[3])
{
    return fmin(to_segment(lab, found->ramp[0][column], found->ramp[1][column]),
                to_segment(lab, found->ramp[1][column], found->ramp[2][column]));
}

static double value_of(const struct strip *strip, double place)
{
    place = fmin(fmax(place, 0), 1);
    double min = (double)strip->min, max = (double)strip->max;
    return strip->log ? min * pow(max / min, place) : min + place * (max - min);
}

bool strip_read(const struct strip_picture *picture, const struct strip_found *found, int x_px, int y_px, struct strip_value *out)
{
    double lab[3], off[STRIP_INNER], width_px = STRIP_COLUMNS * found->cell_px, sum = 0, total = 0;
    bool on_strip = x_px >= found->left_px && x_px < found->left_px + width_px && y_px >= floor(found->top_px) &&
                    y_px < found->top_px + STRIP_ROWS * found->row_px;
    if (x_px < 0 || y_px < 0 || x_px >= picture->width_px || y_px >= picture->height_px || on_strip)
        return false;
    const uint8_t *bgr = pixel(picture, x_px, y_px);
    lab_from_srgb((double[3]){ bgr[2], bgr[1], bgr[0] }, VISION_NORMAL, lab);
    int best = 0, low = STRIP_INNER, high = -1;
    for (int i = 0; i < STRIP_INNER; i++) {
        off[i] = off_of(found, i, lab);
        best = off[i] < off[best] ? i : best;
    }
    *out = (struct strip_value){ .off = off[best] };
    double near = off[best] + INDISTINCT + NOISES * found->noise;
    for (int i = STRIP_BEYOND; i < STRIP_BEYOND + STRIP_RAMP; i++)
        if (off[i] <= near) {
            double weight = exp(-pow(off[i] - off[best], 2));
            low = i < low ? i : low;
            high = i > high ? i : high;
            sum += weight * (i - STRIP_BEYOND + 0.5);
            total += weight;
        }
    if (off[best] > STRANGE + found->noise)
        out->state = STRIP_NO_COLOR;
    else if (best < STRIP_BEYOND)
        out->state = STRIP_BELOW;
    else if (best >= STRIP_BEYOND + STRIP_RAMP)
        out->state = STRIP_ABOVE;
    else {
        /* If both ends of the scale have similar colours, a pixel's colour may match columns at both ends. Their mean position
           would be meaningless, so the position of the best match is used. */
        double place = abs(high - low) > STRIP_RAMP / 4 ? best - STRIP_BEYOND + 0.5 : sum / total;
        out->value = value_of(&found->strip, place / STRIP_RAMP);
        out->low = value_of(&found->strip, (double)(low - STRIP_BEYOND - 1) / STRIP_RAMP);
        out->high = value_of(&found->strip, (double)(high - STRIP_BEYOND + 2) / STRIP_RAMP);
    }
    return true;
}
