/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds and checks the lines of the audit trail, each of which contains the hash of the previous line. */
#include "audit/audit_chain.h"

#include <jansson.h>
#include <openssl/evp.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/hex.h"
#include "base/text/json_text.h"
#include "base/text/timestamp.h"
#include "base/text/utf8.h"

enum { FIELD_BYTES = 1024 };
static const char HASH_KEY[] = ",\"hash\":\"", END[] = "\"}";

void audit_chain_init(struct audit_chain *chain)
{
    chain->seq = 0;
    memset(chain->hash, '0', AUDIT_HASH_CHARS);
    chain->hash[AUDIT_HASH_CHARS] = 0;
}

static void hash_of(const char *bytes, size_t count, char out[AUDIT_HASH_CHARS + 1])
{
    unsigned char hash[AUDIT_HASH_CHARS / 2] = { 0 };
    EVP_Digest(bytes, count, hash, NULL, EVP_sha256(), NULL);
    hex_print(hash, sizeof(hash), out);
}

/* Adds a text to the audit line. Clients may have chosen the text, so control characters and invalid UTF-8 are replaced by '?'. */
static void set_field(json_t *object, const char *key, const char *text)
{
    char copy[FIELD_BYTES + 1];
    size_t at = 0;
    if (!text || !*text)
        return;
    for (size_t left = strlen(text), length; left > 0 && at < FIELD_BYTES; text += length, left -= length) {
        length = utf8_length(text, left);
        if (length > FIELD_BYTES - at)
            break;
        if (length > 0 && (unsigned char)*text >= ' ' && *text != 0x7f)
            memcpy(copy + at, text, length);
        else
            copy[at] = '?';
        length += length == 0;
        at += length;
    }
    json_object_set_new(object, key, json_stringn(copy, at));
}

void audit_chain_add(struct audit_chain *chain, const struct audit_entry *entry, int64_t utc_us, struct text *out)
{
    char at[TIMESTAMP_BYTES], hash[AUDIT_HASH_CHARS + 1];
    size_t begin = out->length;
    timestamp_print(utc_us, at);
    json_t *object = json_pack("{s:I,s:s}", "seq", (json_int_t)(chain->seq + 1), "at", at);
    set_field(object, "event", entry->event);
    set_field(object, "result", entry->result);
    set_field(object, "who", entry->who);
    set_field(object, "role", entry->role);
    set_field(object, "from", entry->from);
    set_field(object, "how", entry->how);
    set_field(object, "through", entry->through);
    set_field(object, "what", entry->what);
    set_field(object, "why", entry->why);
    json_object_set_new(object, "prev", json_string(chain->hash));
    char *text = json_text(object, 0);
    text_add_bytes(out, text, strlen(text) - 1); /* omits the closing brace, because the line's own hash follows */
    mem_free(text);
    hash_of(out->at + begin, out->length - begin, hash);
    text_add(out, "%s%s%s\n", HASH_KEY, hash, END);
    chain->seq++;
    memcpy(chain->hash, hash, sizeof(hash));
}

bool audit_chain_check(struct audit_chain *chain, const char *line, size_t count, bool first, const char **why)
{
    const size_t tail = strlen(HASH_KEY) + AUDIT_HASH_CHARS + strlen(END);
    char hash[AUDIT_HASH_CHARS + 1];
    if (count < tail || count >= AUDIT_LINE_BYTES || memcmp(line + count - tail, HASH_KEY, strlen(HASH_KEY)) != 0) {
        *why = "this is not a line of an audit trail";
        return false;
    }
    const char *said = line + count - strlen(END) - AUDIT_HASH_CHARS;
    hash_of(line, count - tail, hash);
    json_t *object = memcmp(hash, said, AUDIT_HASH_CHARS) == 0 ? json_loadb(line, count, JSON_REJECT_DUPLICATES, NULL) : NULL;
    const char *prev = json_string_value(json_object_get(object, "prev"));
    json_int_t seq = json_integer_value(json_object_get(object, "seq"));
    *why = !object                                     ? "the line was changed after it was written: its hash differs"
           : !prev || seq < 1                          ? "the line has no line number (seq), or no hash of the preceding line (prev)"
           : !first && (uint64_t)seq != chain->seq + 1 ? "lines before this line were removed or inserted"
           : !first && strcmp(prev, chain->hash) != 0
               ? "the line's hash of the preceding line (prev) differs: a line was changed, removed or inserted"
               : NULL;
    json_decref(object);
    if (*why)
        return false;
    chain->seq = (uint64_t)seq;
    memcpy(chain->hash, hash, sizeof(hash));
    return true;
}
