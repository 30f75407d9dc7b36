/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parallel transport of tangent vectors from sensors along a surface: the vector heat method (Sharp, Soliman, Crane, ACM TOG 2019). From
   each sensor a tangent vector spreads for a short time t: (M + t L) u = b with the connection Laplacian L, whose energy is
   sum_ij w_ij |u_i - R_ij u_j|^2; what arrives is u / |u|. w_ij are the cotangent weights of the intrinsic Delaunay triangulation; R_ij is
   the smallest rotation between the tangent planes of two points (Singer, Wu, Vector diffusion maps, 2012), which needs no order of
   triangles around a point, so that edges may have any number of faces, and either side may be the outer one. It is exact on planes and on
   what can be unfolded, and along great circles but for the size of triangles. Thread: one; it spreads its work over the workers. */
#ifndef PREPROCESS_INFLUENCE_TRANSPORT_H
#define PREPROCESS_INFLUENCE_TRANSPORT_H
#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/influence/influence.h"

/* Computes for each sensor the angle of its vector at each vertex, against vec_frame() of the vertex's normal, INFINITY where no way leads:
   shares of *influence. Its precision is 0. workers may be NULL. Returns false if out of memory, logged. Call influence_finish() in both
   cases. */
bool transport_angles(struct influence *influence, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                      const struct influence_anchor *anchors, const float (*normals)[3], size_t vertex_count);

#endif
