// SPDX-License-Identifier: GPL-3.0-or-later
// Reduces a depth buffer to the cells of a depth grid, which tells clients the distances of a picture's surfaces at a coarse
// resolution. One cell per invocation; server/render/soft/depth_cells.c computes the same cells.
layout(local_size_x = 64) in;
struct Cell {
    float near, far;
    // 64-bit mask: bit i is set if pixel i of the cell shows the surface at depth `near`, clear if it shows the one at `far`
    uint upper, lower;
};
layout(std430, binding = 0) buffer Cells { Cell cells[]; };
layout(location = 0) uniform ivec2 grid; // columns and rows of the depth grid
layout(location = 1) uniform vec2 steps; // x, y: a cell is divided into two surfaces if its depths differ by more than x * depth + y
layout(binding = 0) uniform sampler2D depth;
const int SIDE = 8;
const float LEAST_GAP = 0.25;

float depth_at(ivec2 corner, int i)
{
    return texelFetch(depth, min(corner + ivec2(i % SIDE, i / SIDE), textureSize(depth, 0) - 1), 0).r;
}

bool divide(int number, ivec2 corner, float low, float border, float high)
{
    float behind = 0.0, before = high;
    uint mask[2] = uint[2](0u, 0u);
    for (int i = 0; i < SIDE * SIDE; i++) {
        float here = depth_at(corner, i);
        if (here > border) {
            before = min(before, here);
            mask[i / 32] |= 1u << (i % 32);
        } else {
            behind = max(behind, here);
        }
    }
    if (low > 0.0 && before - behind < LEAST_GAP * (high - low))
        return false;
    cells[number] = Cell(0.5 * (before + high), 0.5 * (low + behind), mask[0], mask[1]);
    return true;
}

void main()
{
    int number = int(gl_GlobalInvocationID.x);
    if (number >= grid.x * grid.y)
        return;
    ivec2 corner = SIDE * ivec2(number % grid.x, number / grid.x);
    float low = 1.0, surface = 1.0, high = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        float here = depth_at(corner, i);
        low = min(low, here);
        surface = here > 0.0 ? min(surface, here) : surface;
        high = max(high, here);
    }
    float middle = 0.5 * (low + high), border = 0.5 * (surface + high);
    cells[number] = Cell(middle, middle, 0u, 0u);
    if (high == 0.0)
        return;
    bool divided = high - surface > steps.x * border + steps.y && divide(number, corner, surface, border, high);
    if (low <= 0.0 && !divided)
        divide(number, corner, 0.0, 0.0, high);
}
