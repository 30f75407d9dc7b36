/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the views of clients whose connection was lost, so that they can continue with the same view. */
#include "session/view/resume.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/hex.h"
#include "session/session_state.h"

struct kept_view {
    char secret[RESUME_CHARS + 1];
    struct token_holder holder;
    struct resumed what;
    int64_t until_ns; /* monotonic time at which the view of a lost connection is dropped */
};

struct resumes {
    struct kept_view *kept; /* all entries: those of connected sessions, and those of lost connections in the order of their loss */
    size_t count, capacity;
};

struct resumes *resumes_create(void)
{
    return mem_new(sizeof(struct resumes));
}

void resumes_destroy(struct resumes **resumes_ptr)
{
    struct resumes *resumes = *resumes_ptr;
    if (!resumes)
        return;
    mem_free(resumes->kept);
    mem_free(resumes);
    *resumes_ptr = NULL;
}

static void forget(struct resumes *resumes, size_t i)
{
    resumes->count--;
    memmove(&resumes->kept[i], &resumes->kept[i + 1], (resumes->count - i) * sizeof(*resumes->kept));
}

static bool gone(const struct kept_view *kept, int64_t now_ns)
{
    return !kept->what.live && now_ns >= kept->until_ns;
}

void resumes_open(struct resumes *resumes, struct session *session, char secret[RESUME_CHARS + 1])
{
    uint8_t bytes[RESUME_CHARS / 2];
    secret[0] = 0;
    if (RAND_bytes(bytes, sizeof(bytes)) != 1)
        return;
    hex_print(bytes, sizeof(bytes), secret);
    mem_grow(&resumes->kept, &resumes->capacity, resumes->count + 1, sizeof(*resumes->kept));
    struct kept_view *kept = &resumes->kept[resumes->count++];
    *kept = (struct kept_view){ .what.live = session, .holder = session->identity.holder };
    strcpy(kept->secret, secret);
}

static void drop_oldest(struct resumes *resumes, int64_t now_ns)
{
    size_t gone_count = 0;
    for (size_t i = resumes->count; i-- > 0;)
        if (gone(&resumes->kept[i], now_ns) || (!resumes->kept[i].what.live && ++gone_count > RESUME_MAX_KEPT))
            forget(resumes, i);
}

void resumes_close(struct resumes *resumes, const struct session *session, bool keep, int64_t now_ns)
{
    size_t i = 0;
    while (i < resumes->count && resumes->kept[i].what.live != session)
        i++;
    if (i == resumes->count)
        return;
    struct kept_view kept = resumes->kept[i];
    forget(resumes, i);
    if (keep) {
        kept.what = (struct resumed){ .view = session->view,
                                      .codecs = session->codec.list,
                                      .pixel_ratio = session->pixel_ratio,
                                      .called = session->identity.number,
                                      .speed = session->travel.speed };
        kept.until_ns = now_ns + RESUME_KEPT_NS;
        resumes->kept[resumes->count++] = kept;
    }
    drop_oldest(resumes, now_ns);
}

static const struct kept_view *find(const struct resumes *resumes, const char *secret)
{
    for (size_t i = 0; i < resumes->count && strlen(secret) == RESUME_CHARS; i++)
        if (CRYPTO_memcmp(resumes->kept[i].secret, secret, RESUME_CHARS) == 0)
            return &resumes->kept[i];
    return NULL;
}

bool resumes_find(const struct resumes *resumes, const char *secret, const struct session *session, int64_t now_ns, struct resumed *out)
{
    const struct kept_view *kept = find(resumes, secret);
    if (!kept || gone(kept, now_ns) || memcmp(kept->holder.hash, session->identity.holder.hash, TOKEN_HASH_BYTES) != 0)
        return false;
    struct session *live = kept->what.live;
    *out = kept->what;
    if (live)
        *out = (struct resumed){ .view = live->view,
                                 .codecs = live->codec.list,
                                 .pixel_ratio = live->pixel_ratio,
                                 .called = live->identity.number,
                                 .speed = live->travel.speed,
                                 .live = live };
    return true;
}

bool resumes_has_live(const struct resumes *resumes, uint64_t number)
{
    for (size_t i = 0; i < resumes->count; i++)
        if (resumes->kept[i].what.live && resumes->kept[i].what.live->identity.number == number)
            return true;
    return false;
}

void resumes_forget_gone(struct resumes *resumes)
{
    for (size_t i = resumes->count; i-- > 0;)
        if (!resumes->kept[i].what.live)
            forget(resumes, i);
}

void resumes_forget(struct resumes *resumes, const char *secret)
{
    const struct kept_view *kept = find(resumes, secret);
    if (kept)
        forget(resumes, (size_t)(kept - resumes->kept));
}
