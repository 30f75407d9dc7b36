/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serialises a surface (surface_store.h): packs only the data that are slow to compute; surface_unpack() computes all other data again. */
#include "surface/surface_store.h"

#include "base/mem.h"
#include "surface/surface_impl.h"

struct surface_totals {
    size_t vertex_count, visible_count, flips;
    double edge_m;
    struct surface_report report;
};

/* Returns whether the length of a side is stored. Two sides that are glued (adjacent) have the same length, which is stored once, with the
   side of the lower index. */
static bool is_kept(const struct intrinsic *in, uint32_t side)
{
    uint32_t other = in->glue[side / 3][side % 3];
    return other == TRIMESH_NONE || other >= side;
}

static void pack_lengths(const struct intrinsic *in, struct text *to)
{
    double *kept = mem_array(3 * in->tri_count, sizeof(*kept));
    size_t count = 0;
    for (uint32_t side = 0; side < 3 * in->tri_count; side++)
        if (is_kept(in, side))
            kept[count++] = in->lengths[side / 3][side % 3];
    pack_array(to, kept, count, sizeof(*kept));
    mem_free(kept);
}

static void unpack_lengths(struct unpack *from, struct intrinsic *in)
{
    size_t count, next = 0;
    double *kept = unpack_array(from, &count, sizeof(*kept));
    in->lengths = mem_try_array(in->tri_count, sizeof(*in->lengths));
    from->bad |= !in->lengths;
    for (uint32_t side = 0; side < 3 * in->tri_count && !from->bad; side++) {
        uint32_t other = in->glue[side / 3][side % 3];
        if (!is_kept(in, side))
            in->lengths[side / 3][side % 3] = in->lengths[other / 3][other % 3];
        else if (next < count)
            in->lengths[side / 3][side % 3] = kept[next++];
        else
            from->bad = true;
    }
    from->bad |= next != count;
    mem_free(kept);
}

void surface_pack(const struct surface *surface, struct text *to)
{
    const struct trimesh *mesh = &surface->mesh;
    const struct intrinsic *in = &surface->intrinsic;
    const struct surface_totals numbers = { .vertex_count = surface->vertex_count,
                                            .visible_count = surface->visible.tri_count,
                                            .flips = in->flips,
                                            .edge_m = surface->edge_m,
                                            .report = surface->report };
    pack_array(to, &numbers, 1, sizeof(numbers));
    pack_array(to, surface->vertex_point, surface->vertex_count, sizeof(*surface->vertex_point));
    pack_array(to, mesh->points, mesh->point_count, sizeof(*mesh->points));
    pack_array(to, mesh->tris, mesh->tri_count, sizeof(*mesh->tris));
    pack_array(to, mesh->tri_source, mesh->tri_count, sizeof(*mesh->tri_source));
    pack_array(to, surface->plane, surface->report.triangles, sizeof(*surface->plane));
    pack_array(to, surface->strays, surface->stray_count, sizeof(*surface->strays));
    pack_array(to, in->points, in->tri_count, sizeof(*in->points));
    pack_array(to, in->glue, in->tri_count, sizeof(*in->glue));
    pack_lengths(in, to);
    pack_array(to, surface->bridges, surface->bridge_count, sizeof(*surface->bridges));
}

struct surface *surface_unpack(struct unpack *from, struct log *log, struct workers *workers)
{
    struct surface *surface = mem_new(sizeof(*surface));
    struct trimesh *mesh = &surface->mesh;
    struct intrinsic *in = &surface->intrinsic;
    struct surface_totals numbers = { 0 };
    size_t vertices, sources, planes, glues;
    unpack_into(from, &numbers, 1, sizeof(numbers));
    *surface = (struct surface){
        .log = log, .workers = workers, .vertex_count = numbers.vertex_count, .edge_m = numbers.edge_m, .report = numbers.report
    };
    surface->vertex_point = unpack_array(from, &vertices, sizeof(*surface->vertex_point));
    mesh->points = unpack_array(from, &mesh->point_count, sizeof(*mesh->points));
    mesh->tris = unpack_array(from, &mesh->tri_count, sizeof(*mesh->tris));
    mesh->tri_source = unpack_array(from, &sources, sizeof(*mesh->tri_source));
    surface->plane = unpack_array(from, &planes, sizeof(*surface->plane));
    surface->strays = unpack_array(from, &surface->stray_count, sizeof(*surface->strays));
    in->points = unpack_array(from, &in->tri_count, sizeof(*in->points));
    in->glue = unpack_array(from, &glues, sizeof(*in->glue));
    from->bad |= glues != in->tri_count;
    unpack_lengths(from, in);
    surface->bridges = unpack_array(from, &surface->bridge_count, sizeof(*surface->bridges));
    in->point_count = mesh->point_count;
    in->flips = numbers.flips;
    mesh->point_capacity = mesh->point_count;
    mesh->tri_capacity = mesh->source_capacity = mesh->tri_count;
    surface->bridge_capacity = surface->bridge_count;
    if (from->bad || vertices != surface->vertex_count || sources != mesh->tri_count || planes != surface->report.triangles ||
        numbers.visible_count != in->tri_count || in->tri_count > mesh->tri_count) {
        surface_destroy(&surface);
        return NULL;
    }
    surface->visible = surface->mesh;
    surface->visible.tri_count = numbers.visible_count;
    surface_index(surface);
    return surface;
}
