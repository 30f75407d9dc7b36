/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames drawn in software: a preview in one go, a refined frame step by step, or its resolve once more. */
#include "render/soft/soft_backend.h"

#include "base/clock.h"
#include "base/mem.h"
#include "render/render_job.h"
#include "render/renderer_impl.h"

struct soft_job {
    struct refined *refined; /* NULL: a preview, or one that is kept */
};

static bool init(struct renderer *renderer)
{
    struct workers *workers = field_workers(renderer->fields.field);
    struct soft_backend *backend = mem_new(sizeof(*backend));
    renderer->by_soft = backend;
    backend->soft = soft_create(workers, &renderer->gpu_scene, &renderer->sky, NULL);
    if (backend->soft)
        backend->refiner = refiner_create(workers, &renderer->gpu_scene, &renderer->sky, backend->soft, &renderer->environments);
    return backend->refiner != NULL;
}

static void finish(struct renderer *renderer)
{
    if (!renderer->by_soft)
        return;
    refiner_destroy(&renderer->by_soft->refiner);
    soft_destroy(&renderer->by_soft->soft);
    mem_free(renderer->by_soft);
    renderer->by_soft = NULL;
}

static bool can(const struct frame_context *context)
{
    return !context->reference;
}

static bool is_quick(struct renderer *renderer, const struct frame_context *context)
{
    return context->view->tier == TIER_PREVIEW || refiner_know(renderer->by_soft->refiner, context);
}

static bool begin(struct renderer *renderer, struct render_job *job, const struct frame_plan *plan, bool at_once)
{
    struct refiner *refiner = renderer->by_soft->refiner;
    (void)plan;
    job->of.soft = mem_new(sizeof(*job->of.soft));
    if (job->view.tier == TIER_REFINED && !(at_once && refiner_know(refiner, &job->context))) {
        job->of.soft->refined = refined_begin(refiner);
        if (!job->of.soft->refined)
            return false;
        job->keeps = true;
    }
    return true;
}

static void abandon(struct renderer *renderer, struct render_job *job)
{
    if (job->of.soft)
        refined_end(renderer->by_soft->refiner, &job->of.soft->refined);
    mem_free(job->of.soft);
    job->of.soft = NULL;
}

/* Others drew meanwhile. */
static bool take_up(struct renderer *renderer, struct render_job *job)
{
    if (!renderer_light_job(renderer, job))
        return false;
    environments_bind(&renderer->environments, job->context.lit_by.environment);
    return true;
}

/* A step on all cores takes some milliseconds; the next one may take twice as long as the last. */
static bool step(struct renderer *renderer, struct render_job *job, int64_t budget_ns)
{
    struct refined *refined = job->of.soft->refined;
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    bool done = !refined || !take_up(renderer, job); /* end fails likewise */
    while (!done && spent_ns + 2 * last_ns <= budget_ns) {
        done = refined_step(refined, &job->context, &renderer->light, job->frame);
        last_ns = clock_mono_ns() - start_ns - spent_ns;
        spent_ns += last_ns;
    }
    job->frame->render_ns += spent_ns;
    return done;
}

static bool end_refined(struct renderer *renderer, struct render_job *job)
{
    struct refined *refined = job->of.soft->refined;
    while (!refined_step(refined, &job->context, &renderer->light, job->frame)) {
    }
    return refiner_keep(renderer->by_soft->refiner, refined, &job->context, &job->isolines, job->frame);
}

static bool end(struct renderer *renderer, struct render_job *job)
{
    const struct soft_backend *backend = renderer->by_soft;
    int64_t start_ns = clock_mono_ns();
    bool good = take_up(renderer, job);
    if (good && job->of.soft->refined)
        good = end_refined(renderer, job);
    else if (good && job->view.tier == TIER_REFINED)
        good = refiner_resolve_again(backend->refiner, &job->context, &job->isolines, job->frame);
    else if (good)
        good = preview_draw(backend->soft, &job->context, &renderer->light, &job->isolines, job->frame);
    job->frame->render_ns += clock_mono_ns() - start_ns;
    return good;
}

const struct render_backend render_backend_soft = {
    .name = "software",
    .init = init,
    .finish = finish,
    .can = can,
    .is_quick = is_quick,
    .begin = begin,
    .step = step,
    .end = end,
    .abandon = abandon,
};
