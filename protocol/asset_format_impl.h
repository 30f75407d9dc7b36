/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the code that checks and the code that builds asset files. Private to protocol/asset_*.c. */
#ifndef PROTOCOL_ASSET_FORMAT_IMPL_H
#define PROTOCOL_ASSET_FORMAT_IMPL_H
#include "protocol/asset_format.h"

uint64_t asset_checksum(const void *bytes, size_t size); /* computes the file's checksum as if its checksum field were 0 */
/* Returns the size that a section must have; UINT64_MAX: any size. *optional receives whether the section may be empty instead. */
uint64_t asset_section_bytes(const struct asset_header *h, int section, bool *optional);
/* Returns the cosine of the largest angle between `axis` and the normal of a triangle of the cluster. */
double asset_cluster_least_dot(const struct asset_cluster *cluster, const float (*positions_m)[3], const uint32_t *indices,
                               const float axis[3]);
double asset_length(const float v[3]);

#endif
