/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures drawn bit by bit. */
#include <limits.h>
#include <math.h>

#include "base/clock.h"
#include "base/mem.h"
#include "render/renderer_impl.h"
#include "render/stroke.h"

enum { STILL_SAMPLES = 4 };
/* Of what is drawn bit by bit, on a processor: how long a bit may take. */
static const int64_t BIT_NS = 4 * NS_PER_MS;
static const double TRIANGLE_NS = 36;
enum { BIT_TRIANGLES = 80000 };

static bool take_target(struct renderer *renderer, const struct view *view, struct target *target)
{
    int samples = view->tier == TIER_STILL && renderer->gl->max_samples >= STILL_SAMPLES ? STILL_SAMPLES : 1;
    return targets_take(&renderer->targets, renderer->gl->log, view->width_px, view->height_px, samples, target);
}

static struct stroke *begin(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool whole)
{
    struct picture picture;
    struct target target = { 0 };
    struct frame *frame = renderer_start(renderer, view, snapshot, &picture);
    if (!frame)
        return NULL;
    bool by_plate = renderer->plates && !renderer->always_gl && plates_can(renderer->plates, &picture);
    struct plate *plate = by_plate ? plate_begin(renderer->plates) : NULL;
    if (by_plate ? !plate : !take_target(renderer, view, &target)) {
        frame_unref(&frame);
        return NULL;
    }
    struct stroke *stroke = mem_new(sizeof(*stroke));
    stroke_init(stroke, &picture, &target, frame, whole);
    stroke->plate = plate;
    if (!plate)
        isolines_collect(&renderer->isolines, &picture, &stroke->isolines);
    return stroke;
}

/* From now on its light stays. */
static bool take_up_stroke(struct renderer *renderer, struct stroke *stroke)
{
    if (!stroke->light) {
        stroke->light = light_get(&renderer->light, &stroke->picture.lit_by);
        if (!stroke->light)
            return false;
        light_hold(stroke->light);
        stroke->picture.light = stroke->light;
    }
    return renderer_take_up(renderer, &stroke->picture);
}

/* Some of the tile. Returns about how long its triangles took, and that is not for their pixels; done: all is drawn. */
static double draw_surfaces(struct renderer *renderer, struct stroke *stroke, const struct tile *tile, bool *done)
{
    struct picture picture = stroke_tile_picture(stroke, tile);
    size_t first = stroke->drawn;
    int triangles = stroke->copies && renderer->gl->software ? BIT_TRIANGLES : INT_MAX;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, stroke->target.framebuffer);
    glDepthMask(GL_TRUE);
    if (first == 0)
        glClear(GL_DEPTH_BUFFER_BIT);
    renderer->solid.triangles = 0;
    stroke->drawn = solid_draw_some(&renderer->solid, &picture, first, triangles);
    *done = stroke->drawn == picture.visible_count;
    if (*done) {
        sky_draw(&renderer->sky, &picture, &renderer->light); /* seen through what is blended */
        solid_draw_blended(&renderer->solid, &picture);
        target_resolve(&stroke->target, tile->x_px, tile->y_px, tile->width_px, tile->height_px);
    }
    return TRIANGLE_NS * renderer->solid.triangles;
}

/* First the surfaces of all tiles, then their edges: those look over the rim of a tile. */
static int cells_of(const struct stroke *stroke)
{
    return stroke_cells(stroke) * (stroke->view.tier == TIER_STILL ? PASSES : 1);
}

struct bit {
    int pass;
    double pixels, triangles_ns;
};

static struct bit draw_bit(struct renderer *renderer, struct stroke *stroke)
{
    bool done = true;
    struct bit bit = { .pass = stroke->next < stroke_cells(stroke) ? SURFACES : EDGES };
    struct tile tile = stroke_choose_tile(stroke, (double)BIT_NS / renderer->pixel_ns[bit.pass]);
    bit.pixels = (double)tile.width_px * tile.height_px;
    if (bit.pixels > 0) {
        glEnable(GL_SCISSOR_TEST);
        glScissor(tile.x_px, tile.y_px, tile.width_px, tile.height_px);
        if (bit.pass == SURFACES)
            bit.triangles_ns = draw_surfaces(renderer, stroke, &tile, &done);
        else
            lines_draw_edges(&renderer->lines, &stroke->picture);
        glDisable(GL_SCISSOR_TEST);
    }
    if (done) {
        stroke->next += stroke->span;
        stroke->span = 0;
        stroke->drawn = 0;
        if (stroke->next == stroke_cells(stroke))
            caps_draw(&renderer->caps, &stroke->picture);
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

struct stroke *renderer_begin(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    /* A GPU draws the whole in the time that a processor takes for a tile. */
    struct stroke *stroke = begin(renderer, view, snapshot, !renderer->gl->software);
    if (stroke && !stroke_hold_fields(stroke))
        renderer_abandon(renderer, &stroke);
    return stroke;
}

bool renderer_keeps(const struct stroke *stroke)
{
    return stroke->plate != NULL;
}

/* A bit on all cores takes some milliseconds; the next one may take twice as long as the last. */
static bool step_plate(struct renderer *renderer, struct stroke *stroke, int64_t budget_ns)
{
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    bool done = !take_up_stroke(renderer, stroke); /* renderer_end fails likewise */
    while (!done && spent_ns + 2 * last_ns <= budget_ns) {
        done = plate_step(stroke->plate, &stroke->picture, &renderer->light, stroke->frame);
        last_ns = clock_mono_ns() - start_ns - spent_ns;
        spent_ns += last_ns;
    }
    stroke->frame->render_ns += spent_ns;
    return done;
}

bool renderer_step(struct renderer *renderer, struct stroke *stroke, int64_t budget_ns)
{
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    int cells = cells_of(stroke);
    if (!stroke->light && !light_step(&renderer->light, &stroke->picture.lit_by, budget_ns))
        return false;
    if (stroke->plate)
        return step_plate(renderer, stroke, budget_ns);
    unsigned shortages = gl_shortages();
    if (stroke->next < cells && !take_up_stroke(renderer, stroke))
        stroke->next = cells; /* renderer_end fails likewise */
    while (stroke->next < cells && (spent_ns == 0 || spent_ns + (last_ns > BIT_NS ? last_ns : BIT_NS) <= budget_ns)) {
        int64_t work_ns = clock_work_ns();
        struct bit bit = draw_bit(renderer, stroke);
        glFinish();
        learn(renderer, &bit, (clock_work_ns() - work_ns) / workers_count(field_workers(renderer->fields.field)));
        last_ns = clock_mono_ns() - start_ns - spent_ns;
        spent_ns += last_ns;
    }
    stroke->short_of_memory |= gl_shortages() != shortages;
    stroke->frame->render_ns += spent_ns;
    if (!renderer->gl->software && stroke->view.tier == TIER_STILL && stroke->next == cells)
        renderer->still_ns = stroke->frame->render_ns;
    return stroke->next == cells;
}

/* What is left of a plate. NULL: it failed, logged. */
static struct frame *end_plate(struct renderer *renderer, struct stroke *stroke)
{
    int64_t start_ns = clock_mono_ns();
    struct frame *frame = stroke->frame;
    if (!take_up_stroke(renderer, stroke))
        return NULL;
    while (!plate_step(stroke->plate, &stroke->picture, &renderer->light, frame)) {}
    if (!plates_keep(renderer->plates, stroke->plate, &stroke->picture, frame))
        return NULL;
    frame->render_ns += clock_mono_ns() - start_ns;
    stroke->frame = NULL;
    return frame;
}

/* All that is left is given to the GPU, and the pixels are on their way. False: logged. */
static bool launch(struct renderer *renderer, struct stroke *stroke)
{
    struct log *log = renderer->gl->log;
    int64_t start_ns = clock_mono_ns();
    gl_forget_errors();
    unsigned shortages = gl_shortages();
    struct flight *flight = flights_take(&renderer->flights, log);
    if (!flight || !take_up_stroke(renderer, stroke)) {
        flights_give(flight);
        return false;
    }
    stroke->flight = flight;
    while (stroke->next < cells_of(stroke))
        draw_bit(renderer, stroke);
    ghosts_draw(&renderer->ghosts, &stroke->picture);
    lines_draw_outline(&renderer->lines, &stroke->picture);
    bool good = markers_start(&flight->markers, &stroke->picture) &&
                isolines_start(&flight->labels, &stroke->picture, &stroke->isolines) &&
                readback_start(&flight->readback, log, &stroke->target);
    gl_forget_errors();
    stroke->short_of_memory |= gl_shortages() != shortages;
    stroke->frame->render_ns += clock_mono_ns() - start_ns;
    if (good && stroke->short_of_memory)
        log_err(log, "picture of %dx%d: the GPU ran out of memory while it was drawn", stroke->view.width_px, stroke->view.height_px);
    return good && !stroke->short_of_memory;
}

/* What was launched. NULL: it failed, logged. */
static struct frame *land(struct renderer *renderer, struct stroke *stroke)
{
    struct flight *flight = stroke->flight;
    struct frame *frame = stroke->frame;
    int64_t start_ns = clock_mono_ns();
    if (!readback_wait(&flight->readback, renderer->gl->log))
        return NULL;
    int64_t drawn_ns = clock_mono_ns();
    readback_get(&flight->readback, field_workers(renderer->fields.field), frame->bgrx, (size_t)frame->stride_bytes);
    markers_get(&flight->markers, &stroke->picture, frame);
    isolines_get(&flight->labels, &stroke->isolines, frame);
    frame->render_ns += drawn_ns - start_ns;
    frame->readback_ns = clock_mono_ns() - drawn_ns;
    stroke->frame = NULL;
    return frame;
}

struct frame *renderer_end(struct renderer *renderer, struct stroke **stroke_ptr)
{
    struct stroke *stroke = *stroke_ptr;
    struct frame *frame = NULL;
    if (stroke->plate)
        frame = end_plate(renderer, stroke);
    else if (stroke->flight || launch(renderer, stroke))
        frame = land(renderer, stroke);
    renderer_abandon(renderer, stroke_ptr);
    return frame;
}

void renderer_abandon(struct renderer *renderer, struct stroke **stroke_ptr)
{
    struct stroke *stroke = *stroke_ptr;
    if (!stroke)
        return;
    if (stroke->plate)
        plate_end(renderer->plates, &stroke->plate);
    else
        targets_give(&renderer->targets, &stroke->target);
    flights_give(stroke->flight);
    stroke_finish(stroke);
    mem_free(stroke);
    *stroke_ptr = NULL;
}

struct frame *renderer_draw_stroke(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct stroke *stroke = begin(renderer, view, snapshot, true);
    return stroke ? renderer_end(renderer, &stroke) : NULL;
}

struct stroke *renderer_launch_stroke(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct stroke *stroke = begin(renderer, view, snapshot, true);
    if (stroke && !launch(renderer, stroke))
        renderer_abandon(renderer, &stroke);
    return stroke;
}
