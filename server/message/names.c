/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of the names used in messages and queries for the options of a view, such as codecs and interpolations. */
#include "message/names.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "message/message.h"
#include "render/pick/pick.h"
#include "render/view.h"
#include "scene/framing.h"

const struct name names_interpolation[] = {
    { "shepard", INTERPOLATION_SHEPARD }, { "paper", INTERPOLATION_PAPER }, { "harmonic", INTERPOLATION_HARMONIC },
    { "fin", INTERPOLATION_FIN },         { "gp", INTERPOLATION_GP },       { NULL, 0 }
};
const struct name names_distance[] = {
    { "geodesic", DISTANCE_GEODESIC }, { "euclidean", DISTANCE_EUCLIDEAN }, { "heat", DISTANCE_HEAT }, { NULL, 0 }
};
const struct name names_fill[] = { { "none", FILL_NONE }, { "neighbours", FILL_NEIGHBOURS }, { NULL, 0 } };
const struct name names_show[] = { { "value", SHOW_VALUE },
                                   { "distance", SHOW_DISTANCE },
                                   { "difference", SHOW_DIFFERENCE },
                                   { "operator", SHOW_OPERATOR },
                                   { "uncertainty", SHOW_UNCERTAINTY },
                                   { "blind", SHOW_BLIND },
                                   { NULL, 0 } };
const struct name names_scale[] = { { "linear", false }, { "log", true }, { NULL, 0 } };
const struct name names_look[] = {
    { "default", LOOK_DEFAULT }, { "glossy", LOOK_GLOSSY }, { "flat", LOOK_FLAT }, { "materials", LOOK_MATERIALS }, { NULL, 0 }
};
const struct name names_arrows[] = {
    { "arrows", DIRECTIONS_ARROWS }, { "strokes", DIRECTIONS_STROKES }, { "none", DIRECTIONS_NONE }, { NULL, 0 }
};
const struct name names_strip[] = { { "none", false }, { "legend", true }, { NULL, 0 } };
const struct name names_language[] = { { "en", LANGUAGE_EN }, { "ko", LANGUAGE_KO }, { "de", LANGUAGE_DE }, { NULL, 0 } };
const struct name names_backdrop[] = { { "light", false }, { "dark", true }, { NULL, 0 } };
const struct name names_codec[] = { { "jpeg", WIRE_CODEC_JPEG }, { "png", WIRE_CODEC_PNG }, { "h264", WIRE_CODEC_H264 }, { NULL, 0 } };
const struct name names_projection[] = { { "perspective", PROJECTION_PERSPECTIVE },
                                         { "orthographic", PROJECTION_ORTHOGRAPHIC },
                                         { NULL, 0 } };
const struct name names_signed[] = { { "none", SIGNED_NONE }, { "refined", SIGNED_REFINED }, { "all", SIGNED_ALL }, { NULL, 0 } };
const struct name names_pick[] = {
    { "context", PICK_CONTEXT }, { "no data", PICK_NO_DATA }, { "between", PICK_BETWEEN }, { "measured", PICK_MEASURED }, { NULL, 0 }
};

const struct name names_side[] = { { "now", SIDE_NOW },     { "top", SIDE_TOP },   { "bottom", SIDE_BOTTOM },
                                   { "front", SIDE_FRONT }, { "back", SIDE_BACK }, { "left", SIDE_LEFT },
                                   { "right", SIDE_RIGHT }, { "iso", SIDE_ISO },   { NULL, 0 } };

int name_find(const struct name *names, const char *text)
{
    for (; names->text; names++)
        if (!strcmp(names->text, text))
            return names->value;
    return -1;
}

const char *name_of(const struct name *names, int value)
{
    for (; names->text; names++)
        if (names->value == value)
            return names->text;
    return NULL;
}
