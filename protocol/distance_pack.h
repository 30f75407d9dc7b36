/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lossless packing of geodesic distances in asset files of many sensors (ASSET.md). It reduces the codes to 40 % of their size.
   One call packs one block of ASSET_DISTANCE_BLOCK vertices with the codes of all sensors (distance_code.h). Call from any
   thread. */
#ifndef PROTOCOL_DISTANCE_PACK_H
#define PROTOCOL_DISTANCE_PACK_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* assets with fewer sensors have unpacked distance codes, which readers use without a copy */
#define DISTANCE_PACK_MIN_SENSORS 64u
#define DISTANCE_PACK_NEAR 12u        /* maximum number of similar sensors from which the packer chooses a sensor's `parent` */

/* Returns the largest size in bytes of a packed block. */
size_t distance_pack_bound(size_t sensor_count);
/* Packs a block. codes: [sensor][ASSET_DISTANCE_BLOCK]. near[s]: up to DISTANCE_PACK_NEAR sensors with an index below s and
   distances similar to those of s. The packer chooses the one that predicts best; unused entries are s. out:
   distance_pack_bound() bytes. Returns the number of bytes used, a multiple of 16, or 0 if out of memory. */
size_t distance_pack(const uint16_t *codes, size_t sensor_count, const uint16_t (*near)[DISTANCE_PACK_NEAR], uint8_t *out);
/* Returns whether the `bytes` bytes from `block` on hold a valid block, so that distance_unpack() reads nothing beyond them. */
bool distance_pack_good(const uint8_t *block, size_t bytes, size_t sensor_count);
/* Unpacks a block for which distance_pack_good() returned true. codes: [sensor][ASSET_DISTANCE_BLOCK]. */
void distance_unpack(const uint8_t *block, size_t sensor_count, uint16_t *codes);

#endif
