/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Materials without textures. */
#ifndef TESTS_SUPPORT_NO_TEXTURES_H
#define TESTS_SUPPORT_NO_TEXTURES_H
#include "protocol/asset_format.h"

/* initialises those members of struct asset_material that refer to textures, for a material without any */
#define NO_TEXTURES                                                                                                                        \
    .base_color_texture = ASSET_NO_TEXTURE, .metallic_roughness_texture = ASSET_NO_TEXTURE, .normal_texture = ASSET_NO_TEXTURE,            \
    .occlusion_texture = ASSET_NO_TEXTURE, .emissive_texture = ASSET_NO_TEXTURE

#endif
