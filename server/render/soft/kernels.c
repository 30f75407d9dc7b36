/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of kernels (inner loops) for the instruction set that this file is compiled for. */
#include "render/soft/kernels.h"

const struct soft_kernels soft_kernels_of_set = {
    .place_part = soft_place_part,
    .carry_part = soft_carry_part,
    .find_faces = soft_find_faces,
    .raster_faces = soft_raster_faces,
    .count_faces = soft_count_faces,
    .look_again = soft_look_again,
    .color = raster_color,
    .find_cells = soft_find_cells,
    .shade_field = refined_shade_field,
    .shade_gloss = refined_shade_gloss,
    .shade_surfaces = refined_shade_surfaces,
    .shade_sky = refined_shade_sky,
    .ink_band = refined_ink_band,
    .color_bands = resolve_color_bands,
};
