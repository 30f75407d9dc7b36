/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses fonts with fontconfig. A text uses a single font, because cairo's toy text functions do not switch fonts within a text. */
#include "render/overlay/text_face.h"

#include <cairo-ft.h>
#include <fontconfig/fontconfig.h>
#include <stdbool.h>
#include <string.h>

#include "base/mem.h"

enum { FIRST_UNCOVERED = 0x590 }; /* first code point that DejaVu Sans may lack: Hebrew */

struct found_face {
    FcCharSet *letters; /* NULL: no search yet */
    cairo_font_face_t *face;
};
/* key under which a cairo drawing context stores the most recently found fonts: an array of two, [0] regular, [1] bold */
static const cairo_user_data_key_t found_key;

static void drop(struct found_face *found)
{
    if (found->letters)
        FcCharSetDestroy(found->letters);
    if (found->face)
        cairo_font_face_destroy(found->face);
}

static void free_found(void *arg)
{
    struct found_face *found = arg;
    drop(&found[0]);
    drop(&found[1]);
    mem_free(found);
}

/* Returns the drawing context's cached font for regular or bold text. NULL: out of memory. */
static struct found_face *found_of(cairo_t *cairo, bool bold)
{
    struct found_face *found = cairo_get_user_data(cairo, &found_key);
    if (!found) {
        found = mem_array(2, sizeof(*found));
        if (cairo_set_user_data(cairo, &found_key, found, free_found) != CAIRO_STATUS_SUCCESS) {
            mem_free(found);
            return NULL;
        }
    }
    return &found[bold];
}

/* Returns the set of letters in a text if DejaVu Sans may lack some of these letters, else NULL. The caller frees the set. */
static FcCharSet *letters_beyond(const char *text)
{
    FcCharSet *letters = FcCharSetCreate();
    const FcChar8 *at = (const FcChar8 *)text;
    bool beyond = false;
    FcChar32 letter;
    for (int count = (int)strlen(text), n; count > 0 && (n = FcUtf8ToUcs4(at, &letter, count)) > 0; at += n, count -= n) {
        FcCharSetAddChar(letters, letter);
        /* DejaVu Sans has the punctuation, arrows and symbols from 0x2000 to 0x2bff */
        beyond |= letter >= FIRST_UNCOVERED && !(letter >= 0x2000 && letter < 0x2c00);
    }
    if (beyond)
        return letters;
    FcCharSetDestroy(letters);
    return NULL;
}

static void find(struct found_face *out, const FcCharSet *letters, bool bold)
{
    FcPattern *wanted = FcPatternCreate();
    FcResult result;
    FcPatternAddString(wanted, FC_FAMILY, (const FcChar8 *)"sans-serif");
    FcPatternAddInteger(wanted, FC_WEIGHT, bold ? FC_WEIGHT_BOLD : FC_WEIGHT_REGULAR);
    FcPatternAddBool(wanted, FC_SCALABLE, FcTrue);
    FcPatternAddCharSet(wanted, FC_CHARSET, letters);
    FcConfigSubstitute(NULL, wanted, FcMatchPattern);
    FcDefaultSubstitute(wanted);
    FcPattern *match = FcFontMatch(NULL, wanted, &result);
    FcCharSet *has;
    FcPatternDestroy(wanted);
    if (!match)
        return;
    drop(out);
    out->letters = FcPatternGetCharSet(match, FC_CHARSET, 0, &has) == FcResultMatch ? FcCharSetCopy(has) : FcCharSetCreate();
    out->face = cairo_ft_font_face_create_for_pattern(match);
    FcPatternDestroy(match);
}

void text_face_choose(cairo_t *cairo, const char *text)
{
    FcCharSet *letters = letters_beyond(text);
    cairo_font_face_t *now = cairo_get_font_face(cairo);
    bool bold = cairo_font_face_get_type(now) == CAIRO_FONT_TYPE_TOY && cairo_toy_font_face_get_weight(now) == CAIRO_FONT_WEIGHT_BOLD;
    if (!letters)
        return;
    struct found_face *found = found_of(cairo, bold);
    if (found && (!found->letters || !FcCharSetIsSubset(letters, found->letters)))
        find(found, letters, bold);
    if (found && found->face)
        cairo_set_font_face(cairo, found->face);
    FcCharSetDestroy(letters);
}

bool text_face_has(const char *text)
{
    FcCharSet *letters = letters_beyond(text);
    struct found_face has = { 0 };
    if (!letters)
        return true;
    find(&has, letters, false);
    bool all = has.letters && FcCharSetIsSubset(letters, has.letters);
    drop(&has);
    FcCharSetDestroy(letters);
    return all;
}
