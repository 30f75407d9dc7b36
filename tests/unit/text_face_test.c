/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Characters that the font DejaVu Sans lacks, such as Korean ones, must be drawn with another font that has them. */
#include "tests/support/test.h"
#include <stdbool.h>

#include <fontconfig/fontconfig.h>

#include "render/overlay/text_face.h"

static cairo_t *begin(cairo_font_weight_t weight)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 64, 64);
    cairo_t *cairo = cairo_create(surface);
    cairo_surface_destroy(surface);
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, weight);
    cairo_set_font_size(cairo, 16);
    return cairo;
}

/* Returns how many characters of a text exist in the font that is selected in `cairo`. */
static int count_known(cairo_t *cairo, const char *text)
{
    cairo_glyph_t *glyphs = NULL;
    int count = 0, known = 0;
    assert_int_equal(cairo_scaled_font_text_to_glyphs(cairo_get_scaled_font(cairo), 0, 0, text, -1, &glyphs, &count, NULL, NULL, NULL),
                     CAIRO_STATUS_SUCCESS);
    for (int i = 0; i < count; i++)
        known += glyphs[i].index != 0;
    cairo_glyph_free(glyphs);
    return known;
}

static bool has_hangul(void)
{
    FcPattern *wanted = FcNameParse((const FcChar8 *)":lang=ko");
    FcObjectSet *objects = FcObjectSetBuild(FC_FILE, NULL);
    FcFontSet *fonts = FcFontList(NULL, wanted, objects);
    bool any = fonts && fonts->nfont > 0;
    if (fonts)
        FcFontSetDestroy(fonts);
    FcObjectSetDestroy(objects);
    FcPatternDestroy(wanted);
    return any;
}

TEST(korean_has_its_letters)
{
    static const char text[] = "\uc628\ub3c4 TE-171 \uc2dc\ud5d8"; /* 12 characters: 4 Korean ones, 6 Latin ones and 2 blanks */
    if (!has_hangul()) {
        print_message("no font for Korean: package fonts-nanum\n");
        skip();
    }
    for (int bold = 0; bold < 2; bold++) {
        cairo_t *cairo = begin(bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
        assert_int_equal(count_known(cairo, text), 8);
        assert_true(text_face_has(text));
        text_face_choose(cairo, text);
        assert_int_equal(count_known(cairo, text), 12);
        cairo_destroy(cairo);
    }
}

TEST(other_text_stays_as_it_is)
{
    static const char *const texts[] = { "", "TE-171 21.5 \u00b0C", "\u00dcber \u2192 \u2212 1", "\u0422\u0435\u043c\u043f", "\xff\xfe" };
    for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
        cairo_t *cairo = begin(CAIRO_FONT_WEIGHT_NORMAL);
        cairo_font_face_t *face = cairo_get_font_face(cairo);
        text_face_choose(cairo, texts[i]);
        assert_ptr_equal(cairo_get_font_face(cairo), face);
        cairo_destroy(cairo);
    }
}

TEST(a_missing_letter_is_noticed)
{
    assert_true(text_face_has("TE-171"));
    assert_false(text_face_has("\xf4\x8f\xbf\xbd")); /* U+10FFFD, for private use */
}
