// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms positions for depth-only passes: shadow maps, and masks of one asset.
layout(location = 0) in vec3 position_m;
layout(location = 0) uniform mat4 clip_from_file;
#ifdef CLIP
layout(location = 4) uniform vec4 planes[6]; // in clip space
out float gl_ClipDistance[6];
#endif
#ifdef HOLES
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec4 vertex_color;
layout(location = 0) out vec3 hole; // texture coordinates, alpha
#endif

void main()
{
    gl_Position = clip_from_file * vec4(position_m, 1.0);
#ifdef HOLES
    hole = vec3(texcoord, vertex_color.a);
#endif
#ifdef CLIP
    for (int i = 0; i < 6; i++)
        gl_ClipDistance[i] = dot(planes[i], gl_Position);
#endif
}
