// SPDX-License-Identifier: GPL-3.0-or-later
// Writes 1 for pixels that a surface covers, for masks of an asset; discards pixels where the texture has holes (alpha below the cutoff).
#ifdef HOLES
#include "material.glsl"
layout(location = 0) in vec3 hole;
layout(location = 2) uniform int material;
layout(binding = 3) uniform sampler2D base_color_map;
#endif
layout(location = 0) out vec4 mark;

void main()
{
#ifdef HOLES
    if (materials[material].base_color.a * hole.z * texture(base_color_map, hole.xy).a < materials[material].emissive.a)
        discard;
#endif
    mark = vec4(1.0);
}
