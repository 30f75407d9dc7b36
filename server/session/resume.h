/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Views that are kept for clients who come back: by a secret that `welcome` told them, each good for one return. Pure: time is handed in.
   Thread: the loop. */
#ifndef SESSION_RESUME_H
#define SESSION_RESUME_H
#include "message/message.h"

static const int64_t RESUME_KEPT_NS = 60LL * 1000000000; /* after the connection is gone */
enum { RESUME_MAX_KEPT = 256 };                          /* of those who are gone; the oldest go first */

struct session;
struct resumes;
struct resumes *resumes_create(void);
void resumes_destroy(struct resumes **resumes); /* &NULL is fine; leaves NULL */

/* A connected session can be resumed from now on, by *secret. */
void resumes_open(struct resumes *resumes, struct session *session, char secret[RESUME_CHARS + 1]);
/* It is gone: what it looked at is kept for a while, unless it is not to. */
void resumes_close(struct resumes *resumes, const struct session *session, bool keep, int64_t now_ns);

struct resumed {
    struct view view;
    struct codec_list codecs;
    double pixel_ratio;
    uint64_t called;      /* its number for others, who follow it by that */
    double speed;         /* of play, where view.at_us is an instant */
    struct session *live; /* NULL: its connection is gone; else the one that is to go now */
};
/* False: there is none, its time is over, or it is another's than `session`'s. */
bool resumes_find(const struct resumes *resumes, const char *secret, const struct session *session, int64_t now_ns, struct resumed *out);
void resumes_forget_gone(struct resumes *resumes); /* views of those who are not connected */
void resumes_forget(struct resumes *resumes, const char *secret);

#endif
