/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signed pictures: PNG files with a statement of the data that they were drawn from, signed with the server's key. SIGNED.md
   describes the format. No input or output. */
#ifndef PROVENANCE_SIGNED_PICTURE_H
#define PROVENANCE_SIGNED_PICTURE_H
#include <jansson.h>

#include "encode/packet.h"
#include "provenance/signing_key.h"
#include "render/frame_record.h"
#include "scene/scene.h"

struct picture_origin { /* facts for a picture's signed statement that are not in the picture itself */
    const struct scene *scene;
    const char *const *args; /* arguments, as name=value, of the HTTP query answered with the picture */
    size_t arg_count;
    bool bare;           /* true: the user may not see readings, so the statement omits them */
    const char *overlay; /* overlay drawn over the model: `full`, `bare` (without sensors and alarms) or `none` */
    const char *version;
};

/* Returns the packet's PNG file with its statement and signature, and the file's size in *out_count; the caller frees it (mem_free). The
   packet's frame must have a record of its data. Returns NULL if out of memory or if signing fails. */
uint8_t *signed_picture_make(const struct signing_key *key, const struct picture_origin *origin, const struct packet *packet,
                             size_t *out_count);

enum { PICTURE_CHECKSUM_BYTES = 17 };
/* Writes the checksum from the header of the asset's file (protocol/ASSET.md), in the format used in statements; "": the asset
   has no file. */
void picture_asset_checksum(const struct scene_asset *asset, char out[PICTURE_CHECKSUM_BYTES]);

enum { SIGNED_PICTURE_WHY_BYTES = 256 };
/* Returns the statement of a signed PNG file; the caller drops it (json_decref). The statement must be complete, of a known
   version, signed by that key, and match the picture's pixels and readings. Otherwise returns NULL with the reason in `why`. */
json_t *signed_picture_verify(const struct signing_key *key, const uint8_t *png, size_t count, char why[SIGNED_PICTURE_WHY_BYTES]);

/* Verifies a statement outside of a PNG file, without checking pixels; result and `why` as for signed_picture_verify().
   `signature`: in the format used in signed pictures. */
json_t *signed_statement_verify(const struct signing_key *key, const char *text, size_t length, const char *signature,
                                char why[SIGNED_PICTURE_WHY_BYTES]);
/* Returns true if a verified statement belongs to these pixels (red, green, blue, rows from the top); otherwise `why` has the reason. */
bool signed_statement_has_pixels(const json_t *statement, const uint8_t *rgb, int width_px, int height_px,
                                 char why[SIGNED_PICTURE_WHY_BYTES]);
/* Extracts the statement and the signature of a PNG file, each followed by a 0 byte, without verifying them; the caller frees both
   (mem_free). Returns false if the file has none. */
bool signed_picture_take(const uint8_t *png, size_t count, char **statement, char **signature);

/* Returns a frame record with the readings, baselines and unproven tags of a verified statement, for a plant with the same
   tags. Also stores the baselines by name in `baselines`. Returns NULL with the reason in `why` if the statement has no
   readings or names tags that the plant lacks. */
struct frame_record *signed_picture_record(const json_t *statement, const struct plant *plant, struct baselines *baselines,
                                           char why[SIGNED_PICTURE_WHY_BYTES]);

#endif
