/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transports tangent vectors in parallel from sensors along a surface: the vector heat method (Sharp, Soliman, Crane, ACM TOG
 * 2019). From each sensor, a tangent vector diffuses for a short time t: (M + t L) u = b with the connection Laplacian L, whose
 * energy is sum_ij w_ij |u_i - R_ij u_j|^2. The result is u / |u|. w_ij are the cotangent weights of the intrinsic Delaunay
 * triangulation. R_ij is the smallest rotation between the tangent planes of two points (Singer, Wu, Vector diffusion maps,
 * 2012). R_ij does not depend on the order of triangles around a point. So an edge may have any number of faces, of either
 * orientation. The method is exact on planes and developable surfaces, and along great circles up to the triangle size. Call
 * from one thread only, which uses the workers. */
#ifndef PREPROCESS_INFLUENCE_TRANSPORT_H
#define PREPROCESS_INFLUENCE_TRANSPORT_H
#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/influence/influence.h"

/* Writes to influence->shares, for each sensor and vertex, the angle of the sensor's transported vector, relative to
 * vec_frame() of the vertex normal; INFINITY where the vertex is not connected to the sensor. Sets the precision matrix, which
 * has no meaning here, to 0. workers may be NULL. Returns false after logging if out of memory. In either case, call
 * influence_finish(). */
bool transport_angles(struct influence *influence, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                      const struct influence_anchor *anchors, const float (*normals)[3], size_t vertex_count);

#endif
