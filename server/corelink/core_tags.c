/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gets the leading core's tag list with libcurl, and keeps the record of the lists that came from there. */
#include "corelink/core_tags.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"

#define AGREED_FILE "shared_tag_list"
enum {
    MAX_BYTES = 64 << 20,
    CONNECT_S = 4,
    SLOW_S = 10 /* seconds without a received byte after which the transfer fails */,
    STATUS_GOOD = 200,
    WHOLE_S = 600, /* time after which the transfer fails, however steadily it receives bytes */
    REASON = 120,  /* maximum number of characters of the core's answer in a message */
    HASH_BYTES = 17 /* 16 hexadecimal digits, and the end of the text or line */,
    KEPT_HASHES = 8,
    RECORD_BYTES = 4096
};

bool core_tags_begin(struct http_request *request, struct core_link *link, const _Atomic bool *stop)
{
    struct core_peer peer;
    *request = (struct http_request){ .stop = stop, .most_bytes = MAX_BYTES };
    if (!core_link_leader(link, &peer) || !http_request_make(request, "plantcastd", peer.ca_path))
        return false;
    char *url = mem_printf("%s" CORE_TAGS_PATH, peer.url);
    http_request_authorize(request, "", peer.authorization[0] ? peer.authorization : NULL);
    curl_easy_setopt(request->handle, CURLOPT_URL, url);
    curl_easy_setopt(request->handle, CURLOPT_PROXY, "");
    curl_easy_setopt(request->handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(request->handle, CURLOPT_TIMEOUT, (long)WHOLE_S);
    curl_easy_setopt(request->handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(request->handle, CURLOPT_LOW_SPEED_TIME, (long)SLOW_S);
    mem_free(url);
    return true;
}

char *core_tags_get(struct http_request *request, const char *hash, char **why)
{
    long status = 0;
    char is[HASH_BYTES];
    CURLcode code = curl_easy_perform(request->handle);
    curl_easy_getinfo(request->handle, CURLINFO_RESPONSE_CODE, &status);
    const char *text = request->answer.at ? request->answer.at : "";
    size_t line = strcspn(text, "\r\n");
    snprintf(is, sizeof(is), "%016" PRIx64, (uint64_t)XXH3_64bits(text, request->answer.length));
    if (code != CURLE_OK)
        *why = mem_printf("the transfer from the leading core failed: %s", http_request_why(request, code));
    else if (status != STATUS_GOOD)
        *why = mem_printf("the leading core answered with HTTP status %ld: %.*s", status, (int)(line < REASON ? line : REASON), text);
    else if (strcmp(is, hash) != 0 || strlen(text) != request->answer.length)
        *why = mem_strdup("the leading core's tag list has changed since the core loaded it: reload the plant on the leading core");
    else
        return mem_strdup(text);
    return NULL;
}

/* Returns the record's text (mem_free): hashes of HASH_BYTES - 1 characters, newest first, each with a line end; "" if there is none. */
static char *read_record(const char *path)
{
    size_t count;
    char *text = text_read_file(path, RECORD_BYTES, &count);
    return text ? text : mem_strdup("");
}

static char *record_path(const char *folder)
{
    return mem_printf("%s/" AGREED_FILE, folder);
}

bool core_tags_agreed(const char *folder, const char *hash)
{
    char *path = record_path(folder), *record = read_record(path);
    bool agreed = *hash && strstr(record, hash);
    mem_free(record);
    mem_free(path);
    return agreed;
}

/* Writes the record, unless it is equal already; takes ownership of `text`. Returns 0 or -errno. */
static int write_record(const char *folder, char *text)
{
    char *path = record_path(folder), *record = read_record(path);
    int error = strcmp(record, text) != 0 ? atomic_file_keep(path, text, strlen(text)) : 0;
    mem_free(record);
    mem_free(path);
    mem_free(text);
    return error;
}

int core_tags_agree(const char *folder, const char *hash)
{
    return write_record(folder, mem_printf("%s\n", hash));
}

int core_tags_expect(const char *folder, const char *hash)
{
    char *path = record_path(folder), *record = read_record(path);
    char *text = mem_printf("%s\n%.*s", hash, HASH_BYTES * (KEPT_HASHES - 1), record);
    mem_free(record);
    mem_free(path);
    return write_record(folder, text);
}
