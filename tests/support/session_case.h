/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fixture of one session on the small scene, without socket, clock or render service. */
#ifndef TESTS_SESSION_CASE_H
#define TESTS_SESSION_CASE_H
#include "session/session.h"

struct session_case {
    struct session_context context;
    struct plant_services services;
    struct quotas quotas;
    struct admission admission;
    struct snapshot *snapshot;
    bool up[1];
    struct session *session;
    int64_t now_ns;
    uint64_t number;               /* number of the last picture */
    /* resume secret of the last `welcome` message that the test read; a client needs the secret to resume its session */
    char resume[RESUME_CHARS + 1];
};

/* Set-up and tear-down for cmocka; the state is a struct session_case. */
int session_case_set_up(void **state);
int session_case_tear_down(void **state);

#endif
