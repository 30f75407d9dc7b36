/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the checking and the building of asset files share. */
#ifndef PROTOCOL_ASSET_FORMAT_IMPL_H
#define PROTOCOL_ASSET_FORMAT_IMPL_H
#include "protocol/asset_format.h"

uint64_t asset_checksum(const void *bytes, size_t size); /* as if the header's were 0 */
/* Bytes that the section must have; UINT64_MAX: any number; optional ones may also be empty. */
uint64_t asset_section_bytes(const struct asset_header *h, int section, bool *optional);
/* Of the normals of the cluster's triangles with the axis: the cosine of the widest angle. */
double asset_cluster_least_dot(const struct asset_cluster *cluster, const float (*positions_m)[3], const uint32_t *indices,
                               const float axis[3]);
double asset_length(const float v[3]);

#endif
