/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the area of each connected component of a mesh, and the component that each sensor is on. */
#include "preprocess/influence/gaussian_bodies.h"

#include "base/mem.h"

void gaussian_bodies_init(struct gaussian_bodies *bodies, const struct influence_mesh *mesh, const struct laplacian *laplacian)
{
    const struct trimesh *surface = &mesh->mesh;
    *bodies = (struct gaussian_bodies){ 0 };
    bodies->component = mem_array(surface->point_count, sizeof(*bodies->component));
    bodies->area_m2 = mem_array(surface->point_count, sizeof(*bodies->area_m2));
    bodies->of_sensor = mem_array(mesh->source_count, sizeof(*bodies->of_sensor));
    trimesh_components(surface, bodies->component);
    for (size_t s = 0; s < mesh->source_count; s++)
        bodies->of_sensor[s] = bodies->component[mesh->discs[s].points[0]];
    for (size_t p = 0; p < surface->point_count; p++)
        if (laplacian->row_of[p] != TRIMESH_NONE)
            bodies->area_m2[bodies->component[p]] += laplacian->mass_m2[laplacian->row_of[p]];
}

void gaussian_bodies_finish(struct gaussian_bodies *bodies)
{
    mem_free(bodies->component);
    mem_free(bodies->area_m2);
    mem_free(bodies->of_sensor);
    *bodies = (struct gaussian_bodies){ 0 };
}

void gaussian_bodies_scale(const struct gaussian_bodies *bodies, size_t count, double *covariance, double *scale)
{
    for (size_t i = 0; i < count; i++) {
        double sum = 0;
        size_t members = 0;
        for (size_t j = 0; j < count; j++)
            if (bodies->of_sensor[j] == bodies->of_sensor[i])
                sum += covariance[j * (count + 1)], members++;
        scale[bodies->of_sensor[i]] = sum > 0 ? (double)members / sum : 0;
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j <= i; j++) {
            double *a = &covariance[i * count + j], *b = &covariance[j * count + i];
            *a = *b = scale[bodies->of_sensor[i]] * (*a + *b) / 2;
        }
}
