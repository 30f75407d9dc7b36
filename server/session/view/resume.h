/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resumption: keeps the views of clients whose connection is lost, for their return with a secret that `welcome` gave them. Each secret is
   good for one return. Pure: time is handed in. Thread: the loop. */
#ifndef SESSION_VIEW_RESUME_H
#define SESSION_VIEW_RESUME_H
#include "message/message.h"

static const int64_t RESUME_KEPT_NS = 60LL * 1000000000; /* after the connection is gone */
enum { RESUME_MAX_KEPT = 256 };                          /* views of lost connections; the oldest are dropped first */

struct session;
struct resumes;
struct resumes *resumes_create(void);
void resumes_destroy(struct resumes **resumes); /* &NULL is fine; leaves NULL */

/* Lets a connected session be resumed from now on, and writes the secret for that. */
void resumes_open(struct resumes *resumes, struct session *session, char secret[RESUME_CHARS + 1]);
/* Notes that the session's connection is lost. keep: its view is kept for RESUME_KEPT_NS; false: it cannot be resumed. */
void resumes_close(struct resumes *resumes, const struct session *session, bool keep, int64_t now_ns);

struct resumed {
    struct view view;
    struct codec_list codecs;
    double pixel_ratio;
    uint64_t called;      /* the number by which others follow it */
    double speed;         /* of play, where view.at_us is an instant */
    struct session *live; /* a session that is still connected and is to be closed now; NULL: its connection is lost */
};
/* Finds what a secret resumes. Returns false if there is nothing, it has expired, or it belongs to another token than the session's. */
bool resumes_find(const struct resumes *resumes, const char *secret, const struct session *session, int64_t now_ns, struct resumed *out);
/* Returns whether a session that is connected has that number. */
bool resumes_has_live(const struct resumes *resumes, uint64_t number);
/* Drops the views of all lost connections, expired or not: none of them can be resumed. Secrets of living connections stay good. */
void resumes_forget_gone(struct resumes *resumes);
/* Drops what the secret resumes. */
void resumes_forget(struct resumes *resumes, const char *secret);

#endif
