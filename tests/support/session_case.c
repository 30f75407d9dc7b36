/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmocka fixture with one session on the small scene (small_scene.h), without a socket, a clock or a render service. */
#include "tests/support/session_case.h"

#include "base/clock.h"
#include "base/mem.h"
#include "session/view/resume.h"
#include "tests/support/small_scene.h"

int session_case_set_up(void **state)
{
    struct session_case *c = mem_new(sizeof(*c));
    c->snapshot = snapshot_create(small_scene()->plant->tag_count);
    c->up[0] = true;
    c->services.scene = (struct scene *)small_scene();
    c->context = (struct session_context){ .plant = small_scene()->plant,
                                           .services = &c->services,
                                           .readings.snapshot = c->snapshot,
                                           .readings.links_up = c->up,
                                           .readings.live = true,
                                           .version = "1.2.3" };
    c->services.baselines = baselines_create();
    c->quotas = quotas_default();
    c->admission.quotas = c->context.quotas = &c->quotas;
    c->context.admission = &c->admission;
    c->context.resumes = resumes_create();
    c->services.named_views = named_views_open(NULL, c->context.plant, NULL, NULL);
    c->services.notes = notes_open(NULL, NULL, NULL);
    c->services.wall_remote = wall_remote_open(NULL, c->context.plant, NULL, NULL);
    c->now_ns = 1000 * NS_PER_S;
    c->session = session_create(&c->context, 7, c->now_ns);
    *state = c;
    return 0;
}

int session_case_tear_down(void **state)
{
    struct session_case *c = *state;
    session_destroy(&c->session);
    snapshot_destroy(&c->snapshot);
    baselines_destroy(&c->services.baselines);
    resumes_destroy(&c->context.resumes);
    named_views_close(&c->services.named_views);
    notes_close(&c->services.notes);
    wall_remote_close(&c->services.wall_remote);
    mem_free(c);
    return 0;
}
