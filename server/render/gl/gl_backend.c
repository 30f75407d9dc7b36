/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The GL render backend: draws a frame as a whole on a GPU, and tile by tile if GL runs on the processor. */
#include "render/gl/gl_backend.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "gpu/mesh.h"
#include "render/gl/frame_tiles.h"
#include "render/gl/frame_uniforms.h"
#include "render/pick/markers.h"
#include "render/render_job.h"
#include "render/renderer_impl.h"

enum { REFINED_SAMPLES = 4 };
/* For GL on the processor (no GPU), in nanoseconds. TILE_NS: drawing time for which the size of tiles is chosen; TRIANGLE_NS:
   expected drawing time per triangle. */
static const int64_t TILE_NS = 4 * NS_PER_MS;
static const double TRIANGLE_NS = 36;
enum { TILE_TRIANGLES = 80000 };
/* If the GPU needed at most this time (nanoseconds) for the last refined frame, the next one is drawn in one call, like a
   preview, instead of in steps. */
static const int64_t MAX_QUICK_NS = 12 * NS_PER_MS;
/* Minimum number of triangles in a frame for occlusion culling; a slow GPU draws fewer in about half a millisecond. GL on the
   processor never culls: testing the bounding boxes of assets there costs more than it saves. */
enum { OCCLUSION_MIN_TRIANGLES = 250000 };
/* Initial estimate of the time per pixel and pass, in nanoseconds, where GL runs on the processor; used until measured. */
static const double INITIAL_PIXEL_NS[GL_PASSES] = { 200, 20 };

struct gl_job {
    struct target target;
    struct frame_tiles tiles;
    /* slot of the frame while the GPU computes its results (frames_in_flight.h); NULL: the frame is not submitted to the GPU yet */
    struct frame_in_flight *in_flight;
    size_t drawn;                      /* number of the current tile's assets drawn so far, nearest first */
    bool short_of_memory;              /* true: the GPU ran out of memory while drawing, so the frame's content is undefined */
};

/* --- life ------------------------------------------------------------------------------------------------------------------- */

static void finish(struct renderer *renderer)
{
    struct gl_backend *backend = renderer->by_gl;
    if (!backend)
        return;
    targets_finish(&backend->targets);
    glDeleteBuffers(1, &backend->frame_buffer);
    frames_in_flight_finish(&backend->frames_in_flight);
    ghosts_finish(&backend->ghosts);
    section_caps_finish(&backend->section_caps);
    lines_finish(&backend->lines);
    surface_pass_finish(&backend->surface_pass);
    mem_free(backend);
    renderer->by_gl = NULL;
}

static bool init(struct renderer *renderer)
{
    struct log *log = renderer->gl->log;
    if (renderer->by_gl)
        return true;
    struct gl_backend *backend = mem_new(sizeof(*backend));
    renderer->by_gl = backend;
    memcpy(backend->pixel_ns, INITIAL_PIXEL_NS, sizeof(backend->pixel_ns));
    backend->frame_buffer = mesh_buffer(log, "frame block", sizeof(struct frame_uniforms), NULL, GL_DYNAMIC_STORAGE_BIT);
    if (!backend->frame_buffer || !surface_pass_init(&backend->surface_pass, log) || !lines_init(&backend->lines, log) ||
        !ghosts_init(&backend->ghosts, log) || !section_caps_init(&backend->section_caps, log) ||
        !frames_in_flight_init(&backend->frames_in_flight, log)) {
        finish(renderer);
        return false;
    }
    backend->surface_pass.least_hiding = renderer->gl->software ? INT_MAX : OCCLUSION_MIN_TRIANGLES;
    return true;
}

static bool can(const struct frame_context *context)
{
    (void)context;
    return true;
}

static bool is_quick(struct renderer *renderer, const struct frame_context *context)
{
    int64_t refined_ns = renderer->by_gl->refined_ns;
    return context->view->tier == TIER_PREVIEW || (refined_ns > 0 && refined_ns <= MAX_QUICK_NS);
}

/* --- jobs ------------------------------------------------------------------------------------------------------------------- */

bool gl_backend_take_up(struct renderer *renderer, struct frame_context *context)
{
    struct frame_uniforms block;
    if (!renderer_find_light(renderer, context))
        return false;
    environments_bind(&renderer->environments, context->lit_by.environment);
    frame_uniforms_fill(&block, context);
    glNamedBufferSubData(renderer->by_gl->frame_buffer, 0, sizeof(block), &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, renderer->by_gl->frame_buffer);
    glViewport(0, 0, context->view->width_px, context->view->height_px);
    return true;
}

/* Prepares a frame's job to be continued after the renderer has drawn other frames. The job then holds a reference to its light
   set (baked light), so that the set is not evicted. On failure, logs the reason and returns false. */
static bool take_up(struct renderer *renderer, struct render_job *job)
{
    return renderer_light_job(renderer, job) && gl_backend_take_up(renderer, &job->context);
}

static bool take_target(struct renderer *renderer, const struct view *view, struct target *target)
{
    int samples = view->tier == TIER_REFINED && renderer->gl->max_samples >= REFINED_SAMPLES ? REFINED_SAMPLES : 1;
    return targets_take(&renderer->by_gl->targets, renderer->gl->log, view->width_px, view->height_px, samples, target);
}

static bool begin(struct renderer *renderer, struct render_job *job, const struct frame_plan *plan, bool at_once)
{
    struct target target = { 0 };
    if (!take_target(renderer, &job->view, &target))
        return false;
    job->of.gl = mem_new(sizeof(*job->of.gl));
    job->of.gl->target = target;
    job->context.target = &job->of.gl->target;
    /* draws the whole frame as one tile if a GPU draws it: that takes no longer than one small tile on a processor */
    frame_tiles_init(&job->of.gl->tiles, &job->context, at_once || !renderer->gl->software);
    renderer_upload_fields(renderer, plan, &job->context, job->frame);
    surface_pass_prepare(&renderer->by_gl->surface_pass, &renderer->fields, &job->context);
    return true;
}

static void abandon(struct renderer *renderer, struct render_job *job)
{
    struct gl_job *own = job->of.gl;
    if (!own)
        return;
    targets_give(&renderer->by_gl->targets, &own->target);
    frames_in_flight_give(own->in_flight);
    frame_tiles_finish(&own->tiles);
    mem_free(own);
    job->of.gl = NULL;
}

/* --- tiles ------------------------------------------------------------------------------------------------------------------ */

/* Draws some of the tile's surfaces. *done: true once the whole tile is drawn. Returns the part of the drawing time, in
   nanoseconds, that is due to the number of triangles rather than pixels: TRIANGLE_NS for each triangle drawn. */
static double draw_surfaces(struct renderer *renderer, struct render_job *job, const struct tile *tile, bool *done)
{
    struct gl_job *own = job->of.gl;
    struct surface_pass *pass = &renderer->by_gl->surface_pass;
    struct frame_context context = frame_tiles_context(&own->tiles, &job->context, tile);
    size_t first = own->drawn;
    int triangles = job->copies && renderer->gl->software ? TILE_TRIANGLES : INT_MAX;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, own->target.framebuffer);
    glDepthMask(GL_TRUE);
    if (first == 0)
        glClear(GL_DEPTH_BUFFER_BIT);
    pass->triangles = 0;
    own->drawn = surface_pass_draw_some(pass, &context, first, triangles);
    *done = own->drawn == context.visible_count;
    if (*done) {
        /* draws the sky before blended surfaces, because it is visible through them */
        sky_draw(&renderer->sky, &context, &renderer->light);
        surface_pass_draw_blended(pass, &context);
        target_resolve(&own->target, tile->x_px, tile->y_px, tile->width_px, tile->height_px);
    }
    return TRIANGLE_NS * pass->triangles;
}

/* Returns the number of cells (small squares of the frame, frame_tiles.h) to draw, summed over the passes. The first pass draws all
   surfaces. The second pass, in refined frames only, draws the edges; it reads pixels beyond a tile's border, so the surfaces must be
   finished. */
static int count_cells(const struct render_job *job)
{
    return frame_tiles_cells(&job->of.gl->tiles) * (job->view.tier == TIER_REFINED ? GL_PASSES : 1);
}

struct drawn_tile {
    enum gl_pass pass;
    double pixels, triangles_ns;
};

static struct drawn_tile draw_tile(struct renderer *renderer, struct render_job *job)
{
    struct gl_backend *backend = renderer->by_gl;
    struct frame_tiles *tiles = &job->of.gl->tiles;
    bool done = true;
    struct drawn_tile drawn = { .pass = tiles->next < frame_tiles_cells(tiles) ? GL_SURFACES : GL_EDGES };
    struct tile tile = frame_tiles_choose(tiles, (double)TILE_NS / backend->pixel_ns[drawn.pass]);
    drawn.pixels = (double)tile.width_px * tile.height_px;
    if (drawn.pixels > 0) {
        glEnable(GL_SCISSOR_TEST);
        glScissor(tile.x_px, tile.y_px, tile.width_px, tile.height_px);
        if (drawn.pass == GL_SURFACES)
            drawn.triangles_ns = draw_surfaces(renderer, job, &tile, &done);
        else
            lines_draw_edges(&backend->lines, &job->context);
        glDisable(GL_SCISSOR_TEST);
    }
    if (done) {
        tiles->next += tiles->span;
        tiles->span = 0;
        job->of.gl->drawn = 0;
        if (tiles->next == frame_tiles_cells(tiles))
            section_caps_draw(&backend->section_caps, &job->context);
    }
    return drawn;
}

/* Updates the measured drawing time per pixel of a pass. took_ns: CPU time of this process. Wall time would include other load
   on the machine, and make tiles smaller than necessary. */
static void update_pixel_time(struct renderer *renderer, const struct drawn_tile *drawn, int64_t took_ns)
{
    double *pixel_ns = &renderer->by_gl->pixel_ns[drawn->pass], now_ns = ((double)took_ns - drawn->triangles_ns) / fmax(drawn->pixels, 1);
    if (drawn->pixels > 0)
        *pixel_ns = fmax(*pixel_ns + 0.3 * (now_ns - *pixel_ns), 1);
}

static bool step(struct renderer *renderer, struct render_job *job, int64_t budget_ns)
{
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    struct gl_job *own = job->of.gl;
    int cells = count_cells(job);
    unsigned shortages = gl_out_of_memory_count();
    if (own->tiles.next < cells && !take_up(renderer, job))
        /* the light set or the colour map could not be bound (no GPU memory): draws no further tiles; end() tries again and
           reports the error */
        own->tiles.next = cells;
    while (own->tiles.next < cells && (spent_ns == 0 || spent_ns + (last_ns > TILE_NS ? last_ns : TILE_NS) <= budget_ns)) {
        int64_t work_ns = clock_work_ns();
        struct drawn_tile drawn = draw_tile(renderer, job);
        glFinish();
        update_pixel_time(renderer, &drawn, (clock_work_ns() - work_ns) / workers_count(field_workers(renderer->fields.field)));
        last_ns = clock_mono_ns() - start_ns - spent_ns;
        spent_ns += last_ns;
    }
    own->short_of_memory |= gl_out_of_memory_count() != shortages;
    job->frame->render_ns += spent_ns;
    if (!renderer->gl->software && job->view.tier == TIER_REFINED && own->tiles.next == cells)
        renderer->by_gl->refined_ns = job->frame->render_ns;
    return own->tiles.next == cells;
}

/* --- the whole -------------------------------------------------------------------------------------------------------------- */

static bool submit(struct renderer *renderer, struct render_job *job)
{
    struct log *log = renderer->gl->log;
    struct gl_backend *backend = renderer->by_gl;
    struct gl_job *own = job->of.gl;
    int64_t start_ns = clock_mono_ns();
    gl_clear_errors();
    unsigned shortages = gl_out_of_memory_count();
    struct frame_in_flight *in_flight = frames_in_flight_take(&backend->frames_in_flight, log);
    if (!in_flight || !take_up(renderer, job)) {
        frames_in_flight_give(in_flight);
        return false;
    }
    own->in_flight = in_flight;
    while (own->tiles.next < count_cells(job))
        draw_tile(renderer, job);
    ghosts_draw(&backend->ghosts, &job->context);
    lines_draw_outline(&backend->lines, &job->context);
    bool good = markers_start(&in_flight->markers, &job->context) && isolines_start(&in_flight->labels, &job->context, &job->isolines) &&
                depth_query_start(&in_flight->depth, &job->context, &renderer->light) &&
                readback_start(&in_flight->readback, log, &own->target);
    gl_clear_errors();
    own->short_of_memory |= gl_out_of_memory_count() != shortages;
    job->frame->render_ns += clock_mono_ns() - start_ns;
    if (good && own->short_of_memory)
        log_err(log, "a picture of %dx%d pixels was not drawn: the GPU ran out of memory", job->view.width_px, job->view.height_px);
    return good && !own->short_of_memory;
}

static bool is_complete(const struct render_job *job)
{
    return readback_is_done(&job->of.gl->in_flight->readback);
}

static bool end(struct renderer *renderer, struct render_job *job)
{
    if (!job->of.gl->in_flight && !submit(renderer, job))
        return false;
    struct frame_in_flight *in_flight = job->of.gl->in_flight;
    struct frame *frame = job->frame;
    int64_t start_ns = clock_mono_ns();
    if (!readback_wait(&in_flight->readback, renderer->gl->log))
        return false;
    int64_t drawn_ns = clock_mono_ns();
    readback_get(&in_flight->readback, field_workers(renderer->fields.field), frame->bgrx, (size_t)frame->stride_bytes);
    markers_get(&in_flight->markers, &job->context, frame);
    isolines_get(&in_flight->labels, &job->context, &job->isolines, frame);
    frame->depth[0] = depth_query_get(&in_flight->depth);
    frame->render_ns += drawn_ns - start_ns;
    frame->readback_ns = clock_mono_ns() - drawn_ns;
    return true;
}

const struct render_backend render_backend_gl = {
    .name = "GL",
    .draws_from_gpu = true,
    .init = init,
    .finish = finish,
    .can = can,
    .is_quick = is_quick,
    .begin = begin,
    .step = step,
    .end = end,
    .abandon = abandon,
    .submit = submit,
    .is_complete = is_complete,
};
