/* SPDX-License-Identifier: GPL-3.0-or-later */
/* C interface to CGAL, whose exact results the tests compare with ours: shortest paths on polyhedra, and the union of two
   polyhedra. */
#include "tests/oracle/geodesic.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <vector>

namespace
{

template <typename Mesh> bool read(const oracle_mesh *from, Mesh *to, std::vector<typename Mesh::Face_index> *faces)
{
    std::vector<typename Mesh::Vertex_index> vertices;
    for (size_t i = 0; i < from->vertex_count; i++) {
        const float *p = from->positions[i];
        vertices.push_back(
            to->add_vertex(typename Mesh::Point(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]))));
    }
    for (size_t t = 0; t < from->triangle_count; t++) {
        const uint32_t *v = from->triangles + 3 * t;
        faces->push_back(to->add_face(vertices[v[0]], vertices[v[1]], vertices[v[2]]));
        if (faces->back() == Mesh::null_face())
            return false;
    }
    return true;
}

bool measure(const oracle_mesh *from, size_t triangle, const double weights[3], double *distances)
{
    using Kernel = CGAL::Simple_cartesian<double>;
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>;
    Mesh mesh;
    std::vector<Mesh::Face_index> faces;
    if (!read(from, &mesh, &faces))
        return false;
    /* CGAL lists a face's corners beginning at a corner of its own choice, so the barycentric weights must be put into that
       order */
    auto edge = halfedge(faces[triangle], mesh);
    const Mesh::Vertex_index corners[3] = { source(edge, mesh), target(edge, mesh), target(next(edge, mesh), mesh) };
    double turned[3] = { 0, 0, 0 };
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (static_cast<uint32_t>(corners[i]) == from->triangles[3 * triangle + static_cast<size_t>(j)])
                turned[i] = weights[j];
    CGAL::Surface_mesh_shortest_path<Traits> paths(mesh);
    paths.add_source_point(faces[triangle], Traits::Construct_barycentric_coordinates()(turned[0], turned[1], turned[2]));
    paths.build_sequence_tree();
    for (Mesh::Vertex_index v : mesh.vertices())
        distances[static_cast<size_t>(v)] = paths.shortest_distance_to_source_points(v).first;
    return true;
}

bool unite(const oracle_mesh *a, const oracle_mesh *b, oracle_mesh *result)
{
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    Mesh first, second, both;
    std::vector<Mesh::Face_index> faces;
    if (!read(a, &first, &faces) || !read(b, &second, &faces) ||
        !CGAL::Polygon_mesh_processing::corefine_and_compute_union(first, second, both))
        return false;
    both.collect_garbage();
    auto *positions = static_cast<float(*)[3]>(calloc(both.number_of_vertices(), sizeof(float[3])));
    auto *triangles = static_cast<uint32_t *>(calloc(both.number_of_faces(), 3 * sizeof(uint32_t)));
    if (!positions || !triangles) {
        free(positions);
        free(triangles);
        return false;
    }
    for (Mesh::Vertex_index v : both.vertices())
        for (int axis = 0; axis < 3; axis++)
            positions[static_cast<size_t>(v)][axis] = static_cast<float>(CGAL::to_double(both.point(v)[axis]));
    size_t corner = 0;
    for (Mesh::Face_index f : both.faces())
        for (Mesh::Vertex_index v : vertices_around_face(both.halfedge(f), both))
            triangles[corner++] = static_cast<uint32_t>(v);
    *result = { positions, triangles, both.number_of_vertices(), both.number_of_faces() };
    return true;
}

} // namespace

extern "C" long oracle_vertex_at(const oracle_mesh *mesh, const float p[3])
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *q = mesh->positions[v];
        if (std::fabs(p[0] - q[0]) < 1e-5f && std::fabs(p[1] - q[1]) < 1e-5f && std::fabs(p[2] - q[2]) < 1e-5f)
            return static_cast<long>(v);
    }
    return -1;
}

bool oracle_distances(const struct oracle_mesh *mesh, size_t triangle, const double weights[3], double *distances)
{
    try {
        return measure(mesh, triangle, weights, distances);
    } catch (const std::exception &) {
        return false;
    }
}

extern "C" bool oracle_union(const struct oracle_mesh *a, const struct oracle_mesh *b, struct oracle_mesh *result)
{
    try {
        return unite(a, b, result);
    } catch (const std::exception &) {
        return false;
    }
}
