/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loops of one set. */
#include "render/draft/draft_kernels.h"

const struct draft_kernels draft_kernels_of_set = {
    .place_part = draft_place_part,
    .carry_part = draft_carry_part,
    .find_faces = draft_find_faces,
    .raster_faces = draft_raster_faces,
    .count_faces = draft_count_faces,
    .look_again = draft_look_again,
    .color = draft_color,
};
