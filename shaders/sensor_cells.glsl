// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of the sensors that matter in a cell of space (render/gl/sensor_cells.h). sensor_cells.comp makes them, reference.glsl reads them.
// A cell is a cube of a grid in coordinates of the asset file.
const int MOST_NEAR = 64; // a cell with more near sensors has no list: all sensors are summed there
layout(std430, binding = 6) GRID_ACCESS buffer Grid {
    vec4 grid_corner_m; // lowest corner of the grid; w: side of a cell
    ivec4 grid_cells;   // number of cells along x, y and z; w: number of cells that have lists
    // for each cell, 1 + the index of its list, or 0: it has none; after these, for each list, the number of its cell
    uint grid_lists[];
};
