/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One session on the small scene, without socket, clock or painter. */
#ifndef TESTS_SESSION_CASE_H
#define TESTS_SESSION_CASE_H
#include "session/session.h"

struct session_case {
    struct session_context context;
    struct quotas quotas;
    struct admission admission;
    struct snapshot *snapshot;
    bool up[1];
    struct session *session;
    int64_t now_ns;
    uint64_t number;               /* of the last picture */
    char resume[RESUME_CHARS + 1]; /* of the last welcome that the test looked at */
};

/* For cmocka: the state is a struct session_case. */
int session_case_set_up(void **state);
int session_case_tear_down(void **state);

#endif
