/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The software render backend: draws a preview in a single call and a refined frame in steps, or recolours a refined frame from
   its visibility buffer. */
#include "base/clock.h"
#include "base/mem.h"
#include "render/render_backend.h"
#include "render/render_job.h"
#include "render/renderer_impl.h"
#include "render/soft/soft.h"

struct soft_job {
    struct refined *refined; /* state of a refined frame that is drawn in steps; NULL: a preview, or a recoloured frame */
};

static bool init(struct renderer *renderer)
{
    struct workers *workers = field_workers(renderer->fields.field);
    if (!renderer->by_soft)
        renderer->by_soft = soft_create(workers, &renderer->gpu_scene, &renderer->sky, &renderer->environments);
    return renderer->by_soft != NULL;
}

static void finish(struct renderer *renderer)
{
    soft_destroy(&renderer->by_soft);
}

static bool can(const struct frame_context *context)
{
    return !context->reference;
}

static bool is_quick(struct renderer *renderer, const struct frame_context *context)
{
    return context->view->tier == TIER_PREVIEW || soft_has_refined(renderer->by_soft, context);
}

static bool begin(struct renderer *renderer, struct render_job *job, const struct frame_plan *plan, bool at_once)
{
    (void)plan;
    job->of.soft = mem_new(sizeof(*job->of.soft));
    if (job->view.tier == TIER_REFINED && !(at_once && soft_has_refined(renderer->by_soft, &job->context))) {
        job->of.soft->refined = refined_begin(renderer->by_soft);
        job->keeps = true;
    }
    return true;
}

static void abandon(struct renderer *renderer, struct render_job *job)
{
    (void)renderer;
    if (job->of.soft)
        refined_end(&job->of.soft->refined);
    mem_free(job->of.soft);
    job->of.soft = NULL;
}

/* Prepares the job for its next step, since other frames may have been drawn in between. Sets its light set (baked light) and
   colour map, and binds its environment. On failure, logs the reason and returns false. */
static bool take_up(struct renderer *renderer, struct render_job *job)
{
    if (!renderer_light_job(renderer, job))
        return false;
    environments_bind(&renderer->environments, job->context.lit_by.environment);
    return true;
}

/* Draws steps until the budget is spent. A step takes a few milliseconds on all cores, and the next may take twice as long as
   the last. So another step is started only if twice the last step's duration fits in the rest of the budget. Returns true when
   no step is left. */
static bool step(struct renderer *renderer, struct render_job *job, int64_t budget_ns)
{
    struct refined *refined = job->of.soft->refined;
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    /* if the job's light cannot be set, no step is left: end() fails as well and reports the error */
    bool done = !refined || !take_up(renderer, job);
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
    return refined_keep(refined, &job->context, &job->isolines, job->frame);
}

static bool end(struct renderer *renderer, struct render_job *job)
{
    int64_t start_ns = clock_mono_ns();
    bool good = take_up(renderer, job);
    if (good && job->of.soft->refined)
        good = end_refined(renderer, job);
    else if (good && job->view.tier == TIER_REFINED)
        good = soft_resolve_again(renderer->by_soft, &job->context, &job->isolines, job->frame);
    else if (good)
        good = preview_draw(renderer->by_soft, &job->context, &renderer->light, &job->isolines, job->frame);
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
