/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gets the leading core's tag list, and keeps the record of the lists that came from there. */
#include "corelink/core_tags.h"

#include <stdio.h>
#include <string.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "corelink/core_request.h"

#define AGREED_FILE "shared_tag_list"
enum {
    MAX_BYTES = 64 << 20,
    WHOLE_S = 600, /* time after which the transfer fails, however steadily it receives bytes */
    HASH_BYTES = 17 /* 16 hexadecimal digits, and the end of the text or line */,
    KEPT_HASHES = 8,
    RECORD_BYTES = 4096
};

bool core_tags_begin(struct http_request *request, struct core_link *link, const _Atomic bool *stop)
{
    struct core_peer peer;
    *request = (struct http_request){ .stop = stop, .most_bytes = MAX_BYTES };
    if (!core_link_leader(link, &peer) || !core_request_make(request))
        return false;
    core_request_address(request, &peer, CORE_TAGS_PATH);
    curl_easy_setopt(request->handle, CURLOPT_TIMEOUT, (long)WHOLE_S);
    return true;
}

char *core_tags_get(struct http_request *request, char **why)
{
    char *failure = core_request_send(request);
    if (failure)
        *why = mem_printf("the transfer from the leading core failed: %s", failure);
    char *text = failure ? NULL : mem_strdup(request->answer.at ? request->answer.at : "");
    mem_free(failure);
    return text;
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
