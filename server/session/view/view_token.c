/* SPDX-License-Identifier: GPL-3.0-or-later */
/* View tokens have the form SECRET.BODY.MAC: BODY is JSON in base64, MAC is the HMAC-SHA-256 of SECRET.BODY. */
#include "session/view/view_token.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/hex.h"
#include "base/text/json_text.h"
#include "message/fit_message.h"
#include "session/session_impl.h"

enum { MAC_BYTES = 32, DIGITS = 17 };
/* nanoseconds. KEPT_NS: lifetime of a view token. SKEW_NS: how far in the future a token may be dated, because the clock of the
   daemon that made it may be ahead. */
static const int64_t KEPT_NS = 86400 * NS_PER_S, SKEW_NS = 7200 * NS_PER_S;

void view_token_add_key(struct view_token_keys *keys, const uint8_t key[VIEW_TOKEN_KEY_BYTES])
{
    if (keys->count > 0 && !memcmp(keys->at[0], key, VIEW_TOKEN_KEY_BYTES))
        return;
    memcpy(keys->at[1], keys->at[0], VIEW_TOKEN_KEY_BYTES);
    memcpy(keys->at[0], key, VIEW_TOKEN_KEY_BYTES);
    keys->count += keys->count < VIEW_TOKEN_KEYS;
}

/* Writes the MAC (HMAC-SHA-256) of `text`, the view token up to its last dot. */
static bool sign(const uint8_t key[VIEW_TOKEN_KEY_BYTES], const char *text, size_t count, char mac[2 * MAC_BYTES + 1])
{
    uint8_t bytes[MAC_BYTES];
    unsigned length = 0;
    if (!HMAC(EVP_sha256(), key, VIEW_TOKEN_KEY_BYTES, (const uint8_t *)text, count, bytes, &length) || length != MAC_BYTES)
        return false;
    hex_print(bytes, MAC_BYTES, mac);
    return true;
}

static json_t *vector(const double v[3])
{
    return json_pack("[f,f,f]", v[0], v[1], v[2]);
}

static json_t *camera_json(const struct camera *camera)
{
    json_t *object = json_pack("{s:o,s:o,s:o,s:f}", "eye", vector(camera->eye_m), "target", vector(camera->target_m), "up",
                               vector(camera->up), "fov", camera->fov_deg);
    if (camera->height_m > 0)
        json_object_update_new(object, json_pack("{s:s,s:f}", "projection", "orthographic", "height_m", camera->height_m));
    return object;
}

static json_t *body_of(const struct session *session, int64_t now_utc_ns)
{
    char holder[2 * TOKEN_HASH_BYTES + 1], *carried = session_carried_text(session->context, &session->view);
    json_t *codecs = json_array();
    hex_print(session->identity.holder.hash, TOKEN_HASH_BYTES, holder);
    for (int i = 0; i < session->codec.list.count; i++)
        json_array_append_new(codecs, json_integer(session->codec.list.at[i]));
    json_t *body =
        json_pack("{s:I,s:s,s:I,s:o,s:i,s:i,s:f,s:o,s:b,s:s}", "t", (json_int_t)now_utc_ns, "h", holder, "n",
                  (json_int_t)session->identity.number, "c", camera_json(&session->view.camera), "x", session->view.width_px, "y",
                  session->view.height_px, "r", session->pixel_ratio, "d", codecs, "a", session->codec.list.choose, "p", carried);
    mem_free(carried);
    return body;
}

char *view_token_make(const struct view_token_keys *keys, const struct session *session, int64_t now_utc_ns)
{
    char mac[2 * MAC_BYTES + 1], *token = NULL;
    if (!keys || keys->count == 0 || !session->identity.resume_secret[0])
        return NULL;
    char *body = json_text(body_of(session, now_utc_ns), DIGITS);
    size_t count = strlen(body);
    char *encoded = mem_array(4 * ((count + 2) / 3) + 1, 1);
    EVP_EncodeBlock((uint8_t *)encoded, (const uint8_t *)body, (int)count);
    char *text = mem_printf("%s.%s", session->identity.resume_secret, encoded);
    if (sign(keys->at[0], text, strlen(text), mac) && strlen(text) + sizeof(mac) + 1 <= RESUME_MOST_CHARS)
        token = mem_printf("%s.%s", text, mac);
    mem_free(text);
    mem_free(encoded);
    mem_free(body);
    return token;
}

/* Returns the length of the part of a view token that its MAC covers; 0: the MAC was made with none of `keys`. */
static size_t find_signed(const struct view_token_keys *keys, const char *token)
{
    const char *end = strrchr(token, '.');
    char mac[2 * MAC_BYTES + 1];
    if (!end || strlen(end + 1) != 2 * MAC_BYTES)
        return 0;
    for (int i = 0; i < keys->count; i++)
        if (sign(keys->at[i], token, (size_t)(end - token), mac) && !CRYPTO_memcmp(mac, end + 1, 2 * MAC_BYTES))
            return (size_t)(end - token);
    return 0;
}

static json_t *decode_body(const char *token, size_t count)
{
    const char *begin = memchr(token, '.', count);
    size_t length = begin ? count - (size_t)(begin + 1 - token) : 0;
    uint8_t *bytes = mem_array(length + 4, 1);
    int got = length ? EVP_DecodeBlock(bytes, (const uint8_t *)begin + 1, (int)length) : -1;
    while (got > 0 && bytes[got - 1] == 0) /* strips the zero bytes that result from the padding of base64 */
        got--;
    json_t *body = got > 0 ? json_loadb((const char *)bytes, (size_t)got, 0, NULL) : NULL;
    mem_free(bytes);
    return body;
}

static bool take_view(const json_t *body, const struct session *session, struct resumed *out)
{
    struct message_error error;
    struct view before = { .width_px = (int)json_integer_value(json_object_get(body, "x")),
                           .height_px = (int)json_integer_value(json_object_get(body, "y")) };
    const char *carried = json_string_value(json_object_get(body, "p"));
    if (!carried || !camera_parse(json_object_get(body, "c"), &before.camera, &error))
        return false;
    struct session *other = session_create(session->context, session->id, 0);
    session_look_again(other, &before, carried);
    out->view = other->view;
    session_destroy(&other);
    return true;
}

bool view_token_read(const struct view_token_keys *keys, const char *token, const struct session *session, int64_t now_utc_ns,
                     struct resumed *out)
{
    char holder[2 * TOKEN_HASH_BYTES + 1];
    size_t count = keys ? find_signed(keys, token) : 0;
    json_t *body = count ? decode_body(token, count) : NULL;
    const char *whose = json_string_value(json_object_get(body, "h"));
    int64_t made_ns = json_integer_value(json_object_get(body, "t"));
    const json_t *codecs = json_object_get(body, "d");
    hex_print(session->identity.holder.hash, TOKEN_HASH_BYTES, holder);
    bool good = whose && !strcmp(whose, holder) && made_ns - now_utc_ns < SKEW_NS && now_utc_ns - made_ns < KEPT_NS;
    *out = (struct resumed){ .called = (uint64_t)json_integer_value(json_object_get(body, "n")),
                             .pixel_ratio = json_number_value(json_object_get(body, "r")),
                             .codecs.choose = json_is_true(json_object_get(body, "a")) };
    for (size_t i = 0; good && i < json_array_size(codecs) && i < CODEC_LIST_MOST; i++)
        out->codecs.at[out->codecs.count++] = (enum wire_codec)json_integer_value(json_array_get(codecs, i));
    good = good && out->codecs.count > 0 && take_view(body, session, out);
    json_decref(body);
    return good;
}
