/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the statement of a picture, which lists the data that the picture was drawn from. Signs the statement's exact bytes,
   so that a verifier need not reproduce its formatting. */
#include "provenance/signed_picture.h"

#include <inttypes.h>
#include <math.h>
#include <openssl/evp.h>
#include <string.h>

#include "base/text/hex.h"
#include "provenance/picture_statement.h"
#include "provenance/png_text.h"

static json_t *number_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *readings_of(const struct plant *plant, const struct snapshot *snapshot, const bool *unproven)
{
    json_t *all = json_array();
    for (size_t i = 0; i < snapshot->count; i++) {
        const struct reading *reading = &snapshot->readings[i];
        json_t *age = reading->age_ns == INT64_MAX ? json_null() : json_integer(reading->age_ns);
        json_array_append_new(all, json_pack("[s,o,I,I,o,i,i,b]", plant->tags[i].name, number_or_null(reading->value),
                                             (json_int_t)reading->quality, (json_int_t)reading->received_utc_ns, age,
                                             (int)reading->alarm, (int)reading->alarm_status, unproven && unproven[i]));
    }
    return all;
}

static json_t *baselines_of(const struct plant *plant, const struct frame_record *record)
{
    json_t *all = json_array();
    for (int i = 0; i < record->baseline_count; i++)
        json_array_append_new(all, json_pack("{s:s,s:I,s:o}", "name", record->baselines[i].what.name, "taken_ns",
                                             (json_int_t)record->baselines[i].what.taken_utc_ns, "readings",
                                             readings_of(plant, record->baselines[i].readings, NULL)));
    return all;
}

void picture_asset_checksum(const struct scene_asset *asset, char out[PICTURE_CHECKSUM_BYTES])
{
    *out = 0;
    if (!asset->missing)
        snprintf(out, PICTURE_CHECKSUM_BYTES, "%016" PRIx64, asset->file->view.header->checksum);
}

static json_t *assets_of(const struct scene *scene)
{
    json_t *all = json_object();
    for (size_t i = 0; i < scene->asset_count; i++) {
        char checksum[PICTURE_CHECKSUM_BYTES];
        picture_asset_checksum(&scene->assets[i], checksum);
        json_object_set_new(all, scene->plant->assets[i].id, *checksum ? json_string(checksum) : json_null());
    }
    return all;
}

static json_t *args_of(const struct picture_origin *origin)
{
    json_t *all = json_array();
    for (size_t i = 0; i < origin->arg_count; i++)
        json_array_append_new(all, json_string(origin->args[i]));
    return all;
}

static json_t *statement_of(const struct picture_origin *origin, const struct packet *packet)
{
    const struct frame *frame = packet->frame;
    const struct plant *plant = origin->scene->plant;
    char pixels[PICTURE_HASH_BYTES], hash[PICTURE_HASH_BYTES];
    json_t *told = json_pack("{s:o,s:o}", "now", readings_of(plant, frame->record->readings, frame->record->unproven), "baselines",
                             baselines_of(plant, frame->record));
    hex_print(packet->pixels_sha256, PACKET_SHA256_BYTES, pixels);
    picture_hash_json(told, hash);
    json_t *statement =
        json_pack("{s:i,s:s,s:s,s:s,s:o,s:I,s:I,s:b,s:b,s:s,s:s,s:o,s:i,s:i,s:s,s:s}", "plantcast_statement", PICTURE_STATEMENT_VERSION,
                  "server", origin->version, "plant", plant->name, "configuration", plant->files.hash, "assets", assets_of(origin->scene),
                  "taken_ns", (json_int_t)frame->data_utc_ns, "at_us", (json_int_t)frame->view.at_us, "clock_unset", frame->clock_unset,
                  "bare", origin->bare, "overlay", origin->overlay, "tier", frame->view.tier == TIER_REFINED ? "refined" : "preview",
                  "query", args_of(origin), "width", frame->width_px, "height", frame->height_px, "pixels_sha256", pixels,
                  "readings_sha256", hash);
    if (!origin->bare)
        json_object_set(statement, "readings", told);
    json_decref(told);
    return statement;
}

/* Signs a statement. Writes `ed25519 KEY-ID SIGNATURE` to `out`, with the signature in base64. Returns false if signing fails. */
static bool sign(const struct signing_key *key, const char *statement, size_t length, char out[PICTURE_SIGNATURE_BYTES])
{
    uint8_t signature[SIGNATURE_BYTES];
    char id[SIGNING_KEY_ID_BYTES];
    if (!signing_key_sign(key, statement, length, signature))
        return false;
    signing_key_id(key, id);
    int begin = snprintf(out, PICTURE_SIGNATURE_BYTES, "ed25519 %s ", id);
    EVP_EncodeBlock((unsigned char *)out + begin, signature, SIGNATURE_BYTES);
    return true;
}

uint8_t *signed_picture_make(const struct signing_key *key, const struct picture_origin *origin, const struct packet *packet,
                             size_t *out_count)
{
    json_t *statement = statement_of(origin, packet);
    char *text = statement ? json_dumps(statement, PICTURE_JSON) : NULL, signature[PICTURE_SIGNATURE_BYTES];
    uint8_t *out = NULL;
    if (text && sign(key, text, strlen(text), signature)) {
        const struct png_text texts[] = { { PICTURE_STATEMENT_KEYWORD, text, strlen(text) },
                                          { PICTURE_SIGNATURE_KEYWORD, signature, strlen(signature) } };
        out = png_text_add(packet->bytes, packet->count, texts, 2, out_count);
    }
    free(text);
    json_decref(statement);
    return out;
}
