/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signed pictures: a PNG file that says what it was drawn from, in a statement that the server's key has signed. SIGNED.md is the format.
   Pure. */
#ifndef PROVENANCE_SIGNED_PICTURE_H
#define PROVENANCE_SIGNED_PICTURE_H
#include <jansson.h>

#include "encode/packet.h"
#include "provenance/signing_key.h"
#include "render/frame_record.h"
#include "scene/scene.h"

struct picture_origin { /* what the server knows of a picture besides the picture */
    const struct scene *scene;
    const char *const *args; /* name=value: the query that it answers */
    size_t arg_count;
    bool bare; /* for somebody who may see no reading: they are not told */
    const char *overlay; /* what is drawn over it: `full`, `bare` (no sensors and alarms) or `none` */
    const char *version;
};

/* Returns the packet's PNG file with statement and signature, and its size in *out_count; the caller frees it (mem_free). The packet's
   frame has a record. Returns NULL if there is no memory for it or it cannot be signed. */
uint8_t *signed_picture_make(const struct signing_key *key, const struct picture_origin *origin, const struct packet *packet,
                             size_t *out_count);

enum { PICTURE_CHECKSUM_BYTES = 17 };
/* Writes the checksum in the head of the asset's file (protocol/ASSET.md), as statements have it; "": there is no file. */
void picture_asset_checksum(const struct scene_asset *asset, char out[PICTURE_CHECKSUM_BYTES]);

enum { SIGNED_PICTURE_WHY_BYTES = 256 };
/* Returns the statement of a PNG file if it is whole, of a version that is understood and signed by that key, and the picture's pixels and
   readings are those that it names; the caller drops it (json_decref). Else returns NULL, with the reason in `why`. */
json_t *signed_picture_verify(const struct signing_key *key, const uint8_t *png, size_t count, char why[SIGNED_PICTURE_WHY_BYTES]);

/* The same of a statement that stands elsewhere, without pixels: `text` of that length, and the signature as it is in pictures. */
json_t *signed_statement_verify(const struct signing_key *key, const char *text, size_t length, const char *signature,
                                char why[SIGNED_PICTURE_WHY_BYTES]);
/* Returns whether a verified statement is of these pixels: red, green, blue, rows from the top. If not, the reason is in `why`. */
bool signed_statement_has_pixels(const json_t *statement, const uint8_t *rgb, int width_px, int height_px,
                                 char why[SIGNED_PICTURE_WHY_BYTES]);
/* Finds statement and signature of a PNG file, each followed by a 0 byte; the caller frees both (mem_free). Returns false if there are
   none; verifies nothing. */
bool signed_picture_take(const uint8_t *png, size_t count, char **statement, char **signature);

/* Returns a record with the readings, baselines and marks that a verified statement tells, for a plant with the same tags. The baselines
   are put into `baselines` under their names, too. Returns NULL, with the reason in `why`, if the statement tells none or names tags that
   the plant does not have. */
struct frame_record *signed_picture_record(const json_t *statement, const struct plant *plant, struct baselines *baselines,
                                           char why[SIGNED_PICTURE_WHY_BYTES]);

#endif
