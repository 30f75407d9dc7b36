/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resumption: keeps the views of clients whose connection was lost, so that they can return with a secret from `welcome`. Each
   secret works once. Pure: the caller passes the time. Call only in the event loop. */
#ifndef SESSION_VIEW_RESUME_H
#define SESSION_VIEW_RESUME_H
#include "message/message.h"

static const int64_t RESUME_KEPT_NS = 60LL * 1000000000; /* how long a view is kept after its connection is lost */
enum { RESUME_MAX_KEPT = 256 }; /* maximum number of views kept for lost connections; the oldest is dropped first */

struct session;
struct resumes;
struct resumes *resumes_create(void);
void resumes_destroy(struct resumes **resumes); /* destroys the list and sets *resumes to NULL; accepts a pointer to NULL */

/* Makes a connected session resumable from now on. Writes the secret that its client must present after a lost connection. */
void resumes_open(struct resumes *resumes, struct session *session, char secret[RESUME_CHARS + 1]);
/* Notes that the session's connection is lost. keep: true: keeps its view for RESUME_KEPT_NS; false: the session cannot be resumed. */
void resumes_close(struct resumes *resumes, const struct session *session, bool keep, int64_t now_ns);

struct resumed {
    struct view view;
    struct codec_list codecs;
    double pixel_ratio;
    uint64_t called; /* number of the resumed session, which other sessions use to follow it */
    double speed;    /* playback speed, recorded seconds per second, if view.at_us is a past instant */
    /* session that still shows the view, because its connection is not closed yet; the caller must close it now. NULL: the
       view's connection is lost */
    struct session *live;
};
/* Finds the view that a secret resumes. Returns false if no view has this secret, the view has expired, or the session has
   another token than the view. */
bool resumes_find(const struct resumes *resumes, const char *secret, const struct session *session, int64_t now_ns, struct resumed *out);
/* Returns whether a connected session has that session number, which other sessions use to follow it. */
bool resumes_has_live(const struct resumes *resumes, uint64_t number);
/* Drops the views of all lost connections, so that none can be resumed. Secrets of open connections stay valid. */
void resumes_forget_gone(struct resumes *resumes);
/* Removes the view that the secret resumes from the list, so that the secret becomes invalid. */
void resumes_forget(struct resumes *resumes, const char *secret);

#endif
