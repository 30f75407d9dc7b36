/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures drawn bit by bit. */
#include <limits.h>
#include <math.h>

#include "base/clock.h"
#include "base/mem.h"
#include "render/renderer_impl.h"
#include "render/render_job.h"

enum { REFINED_SAMPLES = 4 };
/* Of what is drawn bit by bit, on a processor: how long a bit may take. */
static const int64_t BIT_NS = 4 * NS_PER_MS;
static const double TRIANGLE_NS = 36;
enum { BIT_TRIANGLES = 80000 };

static bool take_target(struct renderer *renderer, const struct view *view, struct target *target)
{
    int samples = view->tier == TIER_REFINED && renderer->gl->max_samples >= REFINED_SAMPLES ? REFINED_SAMPLES : 1;
    return targets_take(&renderer->targets, renderer->gl->log, view->width_px, view->height_px, samples, target);
}

static struct render_job *begin(struct renderer *renderer, const struct frame_plan *plan, bool whole)
{
    struct frame_context context;
    struct target target = { 0 };
    struct frame *frame = renderer_start(renderer, plan, &context);
    if (!frame)
        return NULL;
    bool by_refiner = renderer->refiner && !renderer->always_gl && refiner_can(renderer->refiner, &context);
    struct refined *refined = by_refiner ? refined_begin(renderer->refiner) : NULL;
    if (by_refiner ? !refined : !take_target(renderer, &plan->view, &target)) {
        frame_unref(&frame);
        return NULL;
    }
    struct render_job *job = mem_new(sizeof(*job));
    render_job_init(job, &context, &target, frame, whole);
    job->refined = refined;
    if (!refined)
        renderer_upload_fields(renderer, plan, &job->context, frame);
    isolines_collect(&renderer->isolines, &job->context, &job->isolines);
    return job;
}

/* From now on its light stays. */
static bool take_up_job(struct renderer *renderer, struct render_job *job)
{
    if (!job->light) {
        job->light = light_get(&renderer->light, &job->context.lit_by);
        if (!job->light)
            return false;
        light_hold(job->light);
        job->context.light = job->light;
    }
    return renderer_take_up(renderer, &job->context);
}

/* Some of the tile. Returns about how long its triangles took, and that is not for their pixels; done: all is drawn. */
static double draw_surfaces(struct renderer *renderer, struct render_job *job, const struct tile *tile, bool *done)
{
    struct frame_context context = render_job_tile_context(job, tile);
    size_t first = job->drawn;
    int triangles = job->copies && renderer->gl->software ? BIT_TRIANGLES : INT_MAX;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, job->target.framebuffer);
    glDepthMask(GL_TRUE);
    if (first == 0)
        glClear(GL_DEPTH_BUFFER_BIT);
    renderer->surface_pass.triangles = 0;
    job->drawn = surface_pass_draw_some(&renderer->surface_pass, &context, first, triangles);
    *done = job->drawn == context.visible_count;
    if (*done) {
        sky_draw(&renderer->sky, &context, &renderer->light); /* seen through what is blended */
        surface_pass_draw_blended(&renderer->surface_pass, &context);
        target_resolve(&job->target, tile->x_px, tile->y_px, tile->width_px, tile->height_px);
    }
    return TRIANGLE_NS * renderer->surface_pass.triangles;
}

/* First the surfaces of all tiles, then their edges: those look over the rim of a tile. */
static int cells_of(const struct render_job *job)
{
    return render_job_cells(job) * (job->view.tier == TIER_REFINED ? PASSES : 1);
}

struct bit {
    int pass;
    double pixels, triangles_ns;
};

static struct bit draw_bit(struct renderer *renderer, struct render_job *job)
{
    bool done = true;
    struct bit bit = { .pass = job->next < render_job_cells(job) ? SURFACES : EDGES };
    struct tile tile = render_job_choose_tile(job, (double)BIT_NS / renderer->pixel_ns[bit.pass]);
    bit.pixels = (double)tile.width_px * tile.height_px;
    if (bit.pixels > 0) {
        glEnable(GL_SCISSOR_TEST);
        glScissor(tile.x_px, tile.y_px, tile.width_px, tile.height_px);
        if (bit.pass == SURFACES)
            bit.triangles_ns = draw_surfaces(renderer, job, &tile, &done);
        else
            lines_draw_edges(&renderer->lines, &job->context);
        glDisable(GL_SCISSOR_TEST);
    }
    if (done) {
        job->next += job->span;
        job->span = 0;
        job->drawn = 0;
        if (job->next == render_job_cells(job))
            section_caps_draw(&renderer->section_caps, &job->context);
    }
    return bit;
}

/* took_ns: of a machine that has nothing else to do; smaller tiles would not help one that has. */
static void learn(struct renderer *renderer, const struct bit *bit, int64_t took_ns)
{
    double *pixel_ns = &renderer->pixel_ns[bit->pass], now_ns = ((double)took_ns - bit->triangles_ns) / fmax(bit->pixels, 1);
    if (bit->pixels > 0)
        *pixel_ns = fmax(*pixel_ns + 0.3 * (now_ns - *pixel_ns), 1);
}

struct render_job *renderer_begin(struct renderer *renderer, const struct frame_plan *plan)
{
    /* A GPU draws the whole in the time that a processor takes for a tile. */
    struct render_job *job = begin(renderer, plan, !renderer->gl->software);
    if (job && !render_job_hold_fields(job))
        renderer_abandon(renderer, &job);
    return job;
}

bool renderer_keeps(const struct render_job *job)
{
    return job->refined != NULL;
}

/* A bit on all cores takes some milliseconds; the next one may take twice as long as the last. */
static bool step_refined(struct renderer *renderer, struct render_job *job, int64_t budget_ns)
{
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    bool done = !take_up_job(renderer, job); /* renderer_end fails likewise */
    while (!done && spent_ns + 2 * last_ns <= budget_ns) {
        done = refined_step(job->refined, &job->context, &renderer->light, job->frame);
        last_ns = clock_mono_ns() - start_ns - spent_ns;
        spent_ns += last_ns;
    }
    job->frame->render_ns += spent_ns;
    return done;
}

bool renderer_step(struct renderer *renderer, struct render_job *job, int64_t budget_ns)
{
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    int cells = cells_of(job);
    if (!job->light && !light_step(&renderer->light, &job->context.lit_by, budget_ns))
        return false;
    if (job->refined)
        return step_refined(renderer, job, budget_ns);
    unsigned shortages = gl_out_of_memory_count();
    if (job->next < cells && !take_up_job(renderer, job))
        job->next = cells; /* renderer_end fails likewise */
    while (job->next < cells && (spent_ns == 0 || spent_ns + (last_ns > BIT_NS ? last_ns : BIT_NS) <= budget_ns)) {
        int64_t work_ns = clock_work_ns();
        struct bit bit = draw_bit(renderer, job);
        glFinish();
        learn(renderer, &bit, (clock_work_ns() - work_ns) / workers_count(field_workers(renderer->fields.field)));
        last_ns = clock_mono_ns() - start_ns - spent_ns;
        spent_ns += last_ns;
    }
    job->short_of_memory |= gl_out_of_memory_count() != shortages;
    job->frame->render_ns += spent_ns;
    if (!renderer->gl->software && job->view.tier == TIER_REFINED && job->next == cells)
        renderer->refined_ns = job->frame->render_ns;
    return job->next == cells;
}

/* What is left of a refined frame. NULL: it failed, logged. */
static struct frame *end_refined(struct renderer *renderer, struct render_job *job)
{
    int64_t start_ns = clock_mono_ns();
    struct frame *frame = job->frame;
    if (!take_up_job(renderer, job))
        return NULL;
    while (!refined_step(job->refined, &job->context, &renderer->light, frame)) {
    }
    if (!refiner_keep(renderer->refiner, job->refined, &job->context, &job->isolines, frame))
        return NULL;
    frame->render_ns += clock_mono_ns() - start_ns;
    job->frame = NULL;
    return frame;
}

/* All that is left is given to the GPU, and the pixels are on their way. False: logged. */
static bool submit(struct renderer *renderer, struct render_job *job)
{
    struct log *log = renderer->gl->log;
    int64_t start_ns = clock_mono_ns();
    gl_clear_errors();
    unsigned shortages = gl_out_of_memory_count();
    struct frame_in_flight *in_flight = frames_in_flight_take(&renderer->frames_in_flight, log);
    if (!in_flight || !take_up_job(renderer, job)) {
        frames_in_flight_give(in_flight);
        return false;
    }
    job->in_flight = in_flight;
    while (job->next < cells_of(job))
        draw_bit(renderer, job);
    ghosts_draw(&renderer->ghosts, &job->context);
    lines_draw_outline(&renderer->lines, &job->context);
    bool good = markers_start(&in_flight->markers, &job->context) && isolines_start(&in_flight->labels, &job->context, &job->isolines) &&
                readback_start(&in_flight->readback, log, &job->target);
    gl_clear_errors();
    job->short_of_memory |= gl_out_of_memory_count() != shortages;
    job->frame->render_ns += clock_mono_ns() - start_ns;
    if (good && job->short_of_memory)
        log_err(log, "picture of %dx%d: the GPU ran out of memory while it was drawn", job->view.width_px, job->view.height_px);
    return good && !job->short_of_memory;
}

/* What was submitted. NULL: it failed, logged. */
static struct frame *complete(struct renderer *renderer, struct render_job *job)
{
    struct frame_in_flight *in_flight = job->in_flight;
    struct frame *frame = job->frame;
    int64_t start_ns = clock_mono_ns();
    if (!readback_wait(&in_flight->readback, renderer->gl->log))
        return NULL;
    int64_t drawn_ns = clock_mono_ns();
    readback_get(&in_flight->readback, field_workers(renderer->fields.field), frame->bgrx, (size_t)frame->stride_bytes);
    markers_get(&in_flight->markers, &job->context, frame);
    isolines_get(&in_flight->labels, &job->isolines, frame);
    frame->render_ns += drawn_ns - start_ns;
    frame->readback_ns = clock_mono_ns() - drawn_ns;
    job->frame = NULL;
    return frame;
}

struct frame *renderer_end(struct renderer *renderer, struct render_job **job_ptr)
{
    struct render_job *job = *job_ptr;
    struct frame *frame = NULL;
    if (job->refined)
        frame = end_refined(renderer, job);
    else if (job->in_flight || submit(renderer, job))
        frame = complete(renderer, job);
    renderer_abandon(renderer, job_ptr);
    return frame;
}

void renderer_abandon(struct renderer *renderer, struct render_job **job_ptr)
{
    struct render_job *job = *job_ptr;
    if (!job)
        return;
    if (job->refined)
        refined_end(renderer->refiner, &job->refined);
    else
        targets_give(&renderer->targets, &job->target);
    frames_in_flight_give(job->in_flight);
    render_job_finish(job);
    mem_free(job);
    *job_ptr = NULL;
}

struct frame *renderer_draw_job(struct renderer *renderer, const struct frame_plan *plan)
{
    struct render_job *job = begin(renderer, plan, true);
    return job ? renderer_end(renderer, &job) : NULL;
}

struct render_job *renderer_submit_job(struct renderer *renderer, const struct frame_plan *plan)
{
    struct render_job *job = begin(renderer, plan, true);
    if (job && !submit(renderer, job))
        renderer_abandon(renderer, &job);
    return job;
}
