/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loops, once for any machine, once for wider registers. */
#include "render/draft/draft_kernels.h"

#ifdef DRAFT_WIDE
#define TABLE draft_kernels_wide
#else
#define TABLE draft_kernels_plain
#endif

const struct draft_kernels TABLE = {
    .place_part = draft_place_part,
    .carry_part = draft_carry_part,
    .find_faces = draft_find_faces,
    .raster_faces = draft_raster_faces,
    .look_again = draft_look_again,
    .color = draft_color,
};
