/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores short links as JSON, in the same form in memory and in the file. The list is sorted by last use: the least recently
   used link comes first. */
#include "views/short_links.h"

#include <openssl/evp.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plant/walls/wall.h"
#include "views/kept_list.h"

enum { FEWEST_ID_CHARS = 8 /* minimum length of an id: 40 bits, too many for an id to be found by trying */ };
/* minimum time in microseconds between two updates of a link's last use: a day, because each update writes the file */
static const int64_t USED_US = INT64_C(86400000000);

/* At most BURST_LINKS new links may be made at once, and one per LINK_US on average. So one user can neither replace all links
   nor keep the disk busy. */
enum { BURST_LINKS = 20 };
static const int64_t LINK_US = 2000000;

struct short_links {
    struct kept_list kept; /* form of an entry: { id, view, time_us, used }; time_us: when the link was made or last marked as used, UTC */
    int64_t whole_us;      /* time (UTC) from which BURST_LINKS links may again be made at once; each new link moves it by LINK_US */
};

static bool good_link(const json_t *link)
{
    return json_string_length(json_object_get(link, "id")) < SHORT_LINK_ID_BYTES &&
           !named_view_address_wrong(json_string_value(json_object_get(link, "view")));
}

static const struct kept_list_kind LINKS = {
    SHORT_LINKS_FILE, "links", "the keys id, view and time_us",
    SHORT_LINKS, { "id", "view" }, { "time_us" }, good_link
};

struct short_links *short_links_open(struct log *log, const char *folder, struct file_writer *writer)
{
    struct short_links *links = mem_new(sizeof(*links));
    kept_list_open(&links->kept, log, folder, &LINKS, writer);
    return links;
}

void short_links_close(struct short_links **pointer)
{
    if (!*pointer)
        return;
    kept_list_close(&(*pointer)->kept);
    mem_free(*pointer);
    *pointer = NULL;
}

const char *short_links_unread_file(const struct short_links *links)
{
    return kept_list_unread_file(&links->kept);
}

static const char *member(const json_t *list, size_t at, const char *name)
{
    return json_string_value(json_object_get(json_array_get(list, at), name));
}

/* Writes the id of a view, made from its SHA-256, and returns its index in the list, or the list's length. If another view
   already has that id, the id gets one more character. */
static size_t find_view(const json_t *list, const char *view, char id[SHORT_LINK_ID_BYTES])
{
    static const char digits[] = "abcdefghijkmnpqrstuvwxyz23456789"; /* alphabet of ids: 32 characters that are easy to tell apart */
    uint8_t hash[EVP_MAX_MD_SIZE] = { 0 };
    EVP_Digest(view, strlen(view), hash, NULL, EVP_sha256(), NULL);
    size_t length = 0, at = 0;
    do {
        for (size_t more = length ? 1 : FEWEST_ID_CHARS; more > 0 && length < SHORT_LINK_ID_BYTES - 1; more--, length++)
            id[length] = digits[hash[length] % 32];
        id[length] = 0;
        at = kept_list_find(list, id);
    } while (at < json_array_size(list) && strcmp(member(list, at, "view"), view) != 0 && length < SHORT_LINK_ID_BYTES - 1);
    return at;
}

/* Returns whether a new link may be made, and counts it. */
static bool may_add(struct short_links *links, int64_t now_us)
{
    /* whole_us is never more than this far in the future; if it is, the clock was set back */
    if (links->whole_us < now_us || links->whole_us > now_us + BURST_LINKS * LINK_US)
        links->whole_us = now_us;
    if (links->whole_us > now_us + (BURST_LINKS - 1) * LINK_US)
        return false;
    links->whole_us += LINK_US;
    return true;
}

static bool is_used(const json_t *link)
{
    return json_is_true(json_object_get(link, "used"));
}

/* Returns the index of the link that a new link replaces when the list is full. */
static size_t replaced(const json_t *list)
{
    size_t first = 0, never_used = 0;
    for (size_t i = json_array_size(list); i-- > 0;)
        if (!is_used(json_array_get(list, i))) {
            first = i;
            never_used++;
        }
    return never_used > SHORT_LINKS / 2 ? first : 0;
}

enum refusal_code short_links_share(struct short_links *links, const char *view, int64_t now_us, char id[SHORT_LINK_ID_BYTES], bool *added)
{
    json_t *newest = kept_list_newest(&links->kept);
    size_t at = find_view(newest, view, id);
    const json_t *old = json_array_get(newest, at);
    enum refusal_code why = kept_list_refusal(&links->kept);
    /* true: the link is in the file already, not only queued for it */
    const bool stored = kept_list_find(links->kept.list, id) < json_array_size(links->kept.list);
    if (added)
        *added = false;
    if (why || (stored && is_used(old) && llabs(now_us - json_integer_value(json_object_get(old, "time_us"))) < USED_US))
        return why;
    if (!stored && !may_add(links, now_us))
        return REFUSAL_LINKS_OFTEN;
    json_t *list = json_copy(newest);
    json_array_remove(list, at);
    while (json_array_size(list) >= SHORT_LINKS)
        json_array_remove(list, replaced(list));
    json_array_append_new(list,
                          json_pack("{s:s,s:s,s:I,s:b}", "id", id, "view", view, "time_us", (json_int_t)now_us, "used", (int)stored));
    why = kept_list_put(&links->kept, list);
    if (added)
        *added = !stored && !why;
    /* success even if the file cannot be written now: the link is on disk already, only its last use is not */
    return stored ? REFUSAL_NONE : why;
}

const char *short_links_find(const struct short_links *links, const char *id)
{
    return member(links->kept.list, kept_list_find(links->kept.list, id), "view");
}

uint64_t short_links_number(const struct short_links *links)
{
    return links->kept.number;
}

json_t *short_links_list(const struct short_links *links)
{
    return links->kept.list;
}

bool short_links_mirror(struct short_links *links, json_t *list)
{
    return kept_list_mirror(&links->kept, list);
}
