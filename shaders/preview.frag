// SPDX-License-Identifier: GPL-3.0-or-later
// Fragment shader of previews, the frames in lower quality. For speed, it computes one brightness and one colour lookup per
// pixel; textures of the material only cut holes.
#include "frame.glsl"
#include "light.glsl"
#ifdef FIELD
layout(location = 0) in float light;
layout(location = 1) in FIELD_TYPE field;
#include "field.glsl"
#include "field_source.glsl"
#else
layout(location = 0) in vec2 light;
layout(location = 1) in vec3 sun_place;
// colours of assets without values: one row per material, columns by brightness of the light from 0 (left) to 1; sRGB
layout(binding = 1) uniform sampler2D ramps;
layout(binding = 2) uniform sampler2DShadow sun_map;
#endif
layout(location = 2) uniform int material;
#ifdef TEXTURED
#include "material.glsl"
layout(binding = 3) uniform sampler2D base_color_map;
layout(location = 2) in vec3 hole;
#endif
layout(location = 0) out vec4 color;
#ifdef CLIP
layout(location = 6) in vec3 place;
#include "section.glsl"
#endif

void main()
{
#ifdef TEXTURED
    if (materials[material].base_color.a * hole.z * texture(base_color_map, hole.xy).a < materials[material].emissive.a)
        discard;
#endif
#ifdef CLIP
    if (!gl_FrontFacing) {
        vec3 v = frame.back.w > 0.0 ? frame.back.xyz : normalize(-place);
        color = vec4(inside_color(v, cross(dFdx(place), dFdy(place))), 1.0);
        return;
    }
#endif
#ifdef FIELD
    color.rgb = field_color(field_here(field), light);
#ifdef GLOSSY
    color.rgb = srgb_from_linear(tone_map(linear_from_srgb(color.rgb) * (GLOSSY_DARKEST + light)));
#endif
#else
    float sum = light_scalar(light.x, light.y * texture(sun_map, sun_place));
    color.rgb = texelFetch(ramps, ivec2(int(sum * float(textureSize(ramps, 0).x - 1) + 0.5), material), 0).rgb;
    if (frame.up.w > 0.0)
        color.rgb *= frame.up.w;
#ifdef RICH
    color.rgb = vec3(grey_of(color.rgb));
#endif
#endif
    color.a = 1.0;
}
