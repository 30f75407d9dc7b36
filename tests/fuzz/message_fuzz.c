/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds a client's messages, one per line, to a session of a small plant. Whatever they contain, the view must stay drawable and all
   answers must be JSON. */
#include <jansson.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/clock.h"
#include "session/view/resume.h"
#include "session/session.h"
#include "tests/support/small_scene.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void check_field(const struct field_params *field)
{
    require(field->group >= 0 && field->group < (int)small_scene()->plant->group_count, "group");
    require(isfinite(field->strength) && isfinite(field->decay) && isfinite(field->power) && isfinite(field->radius_m), "factors");
    require(field->reach_m > 0, "reach");
}

static void check_view(const struct session *session)
{
    const struct view *view = &session->view;
    require(view_size_valid(view->width_px, view->height_px), "size");
    require(camera_valid(&view->camera), "camera");
    require(view->range_min < view->range_max && isfinite(view->range_max - view->range_min), "range");
    require(view->ramp_interval >= 0 && isfinite(view->ramp_interval), "ramp");
    check_field(&view->field);
    if (view->split)
        check_field(&view->right.field);
    require(session->room.pixels == (int64_t)view->width_px * view->height_px, "pixels are counted");
}

static void check_texts(struct session *session, int64_t now_ns)
{
    struct text text = { 0 };
    while (session_next_text(session, now_ns, now_ns, &text)) {
        json_t *said = json_loads(text.at, 0, NULL);
        require(json_is_object(said) && json_is_string(json_object_get(said, "type")), "an answer is JSON");
        json_decref(said);
        text.length = 0;
    }
    text_finish(&text);
}

static void say_lines(struct session *session, const char *at, size_t count, int64_t now_ns)
{
    while (count > 0) {
        const char *end = memchr(at, '\n', count);
        size_t n = end ? (size_t)(end - at) : count;
        session_on_message(session, at, n, now_ns, now_ns);
        if (session->hello)
            check_view(session);
        check_texts(session, now_ns);
        n += end != NULL;
        at += n;
        count -= n;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    const struct plant *plant = small_scene()->plant;
    struct quotas quotas = quotas_default();
    struct admission admission = { .quotas = &quotas };
    struct snapshot *snapshot = snapshot_create(plant->tag_count);
    struct baselines *baselines = baselines_create();
    struct resumes *resumes = resumes_create();
    const bool up[1] = { true };
    const struct plant_services services = { .scene = (struct scene *)small_scene(), .baselines = baselines };
    const struct session_context context = { .plant = plant,
                                             .services = &services,
                                             .readings.snapshot = snapshot,
                                             .readings.links_up = up,
                                             .version = "1",
                                             .quotas = &quotas,
                                             .resumes = resumes,
                                             .admission = &admission };
    int64_t now_ns = 1000 * NS_PER_S;
    struct session *session = session_create(&context, 1, now_ns);
    say_lines(session, (const char *)bytes, count, now_ns);
    session_leave(session, session->hello, now_ns);
    require(admission.pixels == 0, "pixels are given back");
    session_destroy(&session);
    resumes_destroy(&resumes);
    baselines_destroy(&baselines);
    snapshot_destroy(&snapshot);
    return 0;
}
