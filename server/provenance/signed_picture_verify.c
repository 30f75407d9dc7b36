/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verifies signed pictures: the signature first, and only then the contents of the statement. */
#include <openssl/evp.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "provenance/picture_statement.h"
#include "provenance/signed_picture.h"
#include "provenance/png_pixels.h"
#include "provenance/png_text.h"

#define FAIL(...) (snprintf(why, SIGNED_PICTURE_WHY_BYTES, __VA_ARGS__), false)

static bool is_signed(const struct signing_key *key, const char *statement, size_t length, const char *signature,
                      char why[SIGNED_PICTURE_WHY_BYTES])
{
    char by[SIGNING_KEY_ID_BYTES], own[SIGNING_KEY_ID_BYTES], base64[96];
    uint8_t bytes[96];
    if (sscanf(signature, "ed25519 %16[0-9a-f] %95[A-Za-z0-9+/=]", by, base64) != 2 || strlen(base64) != 88 ||
        EVP_DecodeBlock(bytes, (const unsigned char *)base64, 88) != 66)
        return FAIL("the picture's signature cannot be read: expected 'ed25519 KEY-ID SIGNATURE'");
    signing_key_id(key, own);
    if (strcmp(by, own) != 0)
        return FAIL("the picture was signed with another key: %s; the given key is %s", by, own);
    return signing_key_verify(key, statement, length, bytes) ||
           FAIL("the signature is wrong: the picture's statement was changed after it was signed");
}

bool signed_statement_has_pixels(const json_t *statement, const uint8_t *rgb, int width_px, int height_px,
                                 char why[SIGNED_PICTURE_WHY_BYTES])
{
    char hash[PICTURE_HASH_BYTES];
    const char *expected = json_string_value(json_object_get(statement, "pixels_sha256"));
    json_int_t stated_width = json_integer_value(json_object_get(statement, "width")),
               stated_height = json_integer_value(json_object_get(statement, "height"));
    if (stated_width != width_px || stated_height != height_px)
        return FAIL("the picture has %dx%d pixels, but its signed statement says %lldx%lld", width_px, height_px, (long long)stated_width,
                    (long long)stated_height);
    picture_hash(rgb, 3 * (size_t)width_px * (size_t)height_px, hash);
    return (*hash && expected && !strcmp(hash, expected)) || FAIL("the pixels of the picture differ from the signed pixels");
}

static bool has_pixels(const json_t *statement, const uint8_t *png, size_t count, char why[SIGNED_PICTURE_WHY_BYTES])
{
    int64_t width_px = json_integer_value(json_object_get(statement, "width"));
    int64_t height_px = json_integer_value(json_object_get(statement, "height"));
    uint8_t *pixels = png_pixels(png, count, width_px, height_px, why);
    bool same = pixels && signed_statement_has_pixels(statement, pixels, (int)width_px, (int)height_px, why);
    mem_free(pixels);
    return same;
}

static bool has_readings(const json_t *statement, char why[SIGNED_PICTURE_WHY_BYTES])
{
    const json_t *told = json_object_get(statement, "readings");
    const char *expected = json_string_value(json_object_get(statement, "readings_sha256"));
    char hash[PICTURE_HASH_BYTES];
    if (!told)
        return true;
    picture_hash_json(told, hash);
    return (*hash && expected && !strcmp(hash, expected)) || FAIL("the readings do not match the hash in the picture's signed statement");
}

static bool is_known(const json_t *statement, char why[SIGNED_PICTURE_WHY_BYTES])
{
    const json_t *version = json_object_get(statement, "plantcast_statement");
    if (!json_is_integer(version))
        return FAIL("the picture's signed statement was not written by Plantcast");
    json_int_t number = json_integer_value(version);
    return (number >= 1 && number <= PICTURE_STATEMENT_VERSION) ||
           FAIL("the picture's signed statement has version %d; this program supports versions 1 to %d", (int)number,
                PICTURE_STATEMENT_VERSION);
}

json_t *signed_statement_verify(const struct signing_key *key, const char *text, size_t length, const char *signature,
                                char why[SIGNED_PICTURE_WHY_BYTES])
{
    json_t *statement = NULL;
    if (is_signed(key, text, length, signature, why) && !(statement = json_loadb(text, length, JSON_REJECT_DUPLICATES, NULL)))
        snprintf(why, SIGNED_PICTURE_WHY_BYTES, "the picture's signed statement is not JSON");
    if (statement && !(is_known(statement, why) && has_readings(statement, why))) {
        json_decref(statement);
        statement = NULL;
    }
    return statement;
}

bool signed_picture_take(const uint8_t *png, size_t count, char **statement, char **signature)
{
    size_t length;
    *statement = png_text_find(png, count, PICTURE_STATEMENT_KEYWORD, PICTURE_STATEMENT_MAX_BYTES, &length);
    *signature = png_text_find(png, count, PICTURE_SIGNATURE_KEYWORD, PICTURE_SIGNATURE_BYTES, &length);
    if (*statement && *signature)
        return true;
    mem_free(*statement);
    mem_free(*signature);
    *statement = *signature = NULL;
    return false;
}

json_t *signed_picture_verify(const struct signing_key *key, const uint8_t *png, size_t count, char why[SIGNED_PICTURE_WHY_BYTES])
{
    size_t length = 0, signature_length = 0;
    char *text = png_text_find(png, count, PICTURE_STATEMENT_KEYWORD, PICTURE_STATEMENT_MAX_BYTES, &length);
    char *signature = png_text_find(png, count, PICTURE_SIGNATURE_KEYWORD, PICTURE_SIGNATURE_BYTES, &signature_length);
    json_t *statement = NULL;
    bool is_plain = png_is_plain(png, count, (const char *const[]){ PICTURE_STATEMENT_KEYWORD, PICTURE_SIGNATURE_KEYWORD }, 2, why);
    if (is_plain && (!text || !signature))
        snprintf(why, SIGNED_PICTURE_WHY_BYTES, "the picture's file has no %s, or is damaged", text ? "signature" : "statement");
    else if (is_plain)
        statement = signed_statement_verify(key, text, length, signature, why);
    if (statement && !has_pixels(statement, png, count, why)) {
        json_decref(statement);
        statement = NULL;
    }
    mem_free(text);
    mem_free(signature);
    return statement;
}

/* --- contents of a statement --------------------------------------------------------------------------------------------------- */

/* Reads a statement's readings, which must cover each tag of the plant exactly once. unproven: receives by tag whether the tag
   has no passed loop check; NULL: not wanted. Returns false, with the reason in `why`, if the readings are not valid. */
static bool read_readings(const json_t *told, const struct plant *plant, struct snapshot *out, bool *unproven,
                          char why[SIGNED_PICTURE_WHY_BYTES])
{
    if (json_array_size(told) != plant->tag_count)
        return FAIL("the picture's signed statement has readings of %zu tags; the plant has %zu tags", json_array_size(told),
                    plant->tag_count);
    bool *seen = mem_array(plant->tag_count, sizeof(*seen)), good = true;
    for (size_t i = 0; i < plant->tag_count && good; i++) {
        const json_t *one = json_array_get(told, i), *age = json_array_get(one, 4);
        const char *name = json_string_value(json_array_get(one, 0));
        int tag = name ? plant_find_tag(plant, name) : -1;
        if (tag < 0 || seen[tag]) {
            good = FAIL("reading %zu is for '%.60s', which %s", i + 1, name ? name : "",
                        tag < 0 ? "is not a tag of the plant file" : "already has a reading in this statement");
            break;
        }
        seen[tag] = true;
        out->readings[tag] = (struct reading){ .value = json_number_value(json_array_get(one, 1)),
                                               .quality = (uint32_t)json_integer_value(json_array_get(one, 2)),
                                               .changes = 1,
                                               .received_utc_ns = json_integer_value(json_array_get(one, 3)),
                                               .age_ns = json_is_null(age) ? INT64_MAX : json_integer_value(age),
                                               .alarm = (uint8_t)json_integer_value(json_array_get(one, 5)),
                                               .alarm_status = (uint8_t)json_integer_value(json_array_get(one, 6)) };
        if (unproven)
            unproven[tag] = json_is_true(json_array_get(one, 7));
    }
    mem_free(seen);
    return good;
}

static bool read_baseline(const json_t *told, const struct plant *plant, struct frame_record *record, struct baselines *baselines,
                          char why[SIGNED_PICTURE_WHY_BYTES])
{
    const char *name = json_string_value(json_object_get(told, "name"));
    int i = record->baseline_count;
    if (i == FRAME_RECORD_BASELINES || !name)
        return FAIL("the baselines (saved readings) in the picture's signed statement cannot be read");
    record->baselines[i].readings = snapshot_create(plant->tag_count);
    record->baselines[i].readings->taken_utc_ns = json_integer_value(json_object_get(told, "taken_ns"));
    record->baseline_count++;
    if (!read_readings(json_object_get(told, "readings"), plant, record->baselines[i].readings, NULL, why))
        return false;
    uint32_t id = baselines_set(baselines, name, record->baselines[i].readings);
    return baselines_describe(baselines, id, &record->baselines[i].what) ||
           FAIL("the baselines (saved readings) in the picture's signed statement do not fit the plant");
}

struct frame_record *signed_picture_record(const json_t *statement, const struct plant *plant, struct baselines *baselines,
                                           char why[SIGNED_PICTURE_WHY_BYTES])
{
    const json_t *told = json_object_get(statement, "readings"), *all = json_object_get(told, "baselines");
    if (!told) {
        snprintf(why, SIGNED_PICTURE_WHY_BYTES, "the picture was made for a user who may not see readings: the statement has no readings");
        return NULL;
    }
    struct frame_record *record = frame_record_empty(plant->tag_count);
    record->readings->taken_utc_ns = json_integer_value(json_object_get(statement, "taken_ns"));
    bool good = read_readings(json_object_get(told, "now"), plant, record->readings, record->unproven, why);
    for (size_t i = 0; i < json_array_size(all) && good; i++)
        good = read_baseline(json_array_get(all, i), plant, record, baselines, why);
    if (!good)
        frame_record_unref(&record);
    return record;
}
