/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the depth grid (coarse depth for clients, render/depth_grid.h) of a frame that the software renderer drew. */
#include "base/mem.h"
#include "render/soft/depth_cells.h"
#include "render/soft/kernels.h"
#include "render/soft/soft_impl.h"

void raster_aim_depth(struct raster *raster, const struct light *light)
{
    size_t cells = (size_t)depth_cells_along(raster->width_px) * (size_t)depth_cells_along(raster->height_px);
    raster->finds_cells = raster->context->gives_depth;
    if (!raster->finds_cells)
        return;
    if (cells > raster->cell_capacity) {
        mem_free(raster->cells);
        raster->cells = mem_try_array(cells, sizeof(*raster->cells));
        raster->cell_capacity = raster->cells ? cells : 0;
    }
    raster->finds_cells = raster->cells != NULL;
    depth_lens_init(&raster->lens, &raster->context->constants, raster->has_ground ? light->plant_from_ground : NULL, raster->width_px,
                    raster->height_px);
}

void raster_find_cells(const struct raster *raster, const struct soft_rect *rect)
{
    const struct depth_source source = { raster->depth, (size_t)raster->pitch_px, raster->width_px, raster->height_px, &raster->lens };
    if (raster->finds_cells)
        raster->soft->kernels->find_cells(&source, rect->top / DEPTH_CELL_PX, depth_cells_along(rect->bottom + 1),
                                          rect->left / DEPTH_CELL_PX, depth_cells_along(rect->right + 1), raster->cells);
}

struct depth_grid *raster_depth_grid(const struct raster *raster)
{
    return raster->finds_cells ? depth_grid_create(raster->cells, &raster->lens, raster->width_px, raster->height_px) : NULL;
}
