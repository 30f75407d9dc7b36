/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws what is wished for. */
#include "base/clock.h"
#include "net/paint/drawing_impl.h"
#include "render/overlay/overlay.h"

static const int64_t STEP_NS = 10 * NS_PER_MS;              /* of a slow picture, before anyone else gets a turn */
static const int64_t LIGHT_NS = 4 * NS_PER_MS;     /* of each picture of a moving session, for a light that it chose */
static const int64_t FIELD_NS = 6 * NS_PER_MS;              /* of a field that takes long, likewise */
static const int64_t IDLE_NS = 5 * NS_PER_MS;               /* of what nobody waits for, before looking whether somebody does */
static const int64_t REHEARSE_NS = 10 * NS_PER_S;           /* of a field, before anyone asks; what is left is worked on as for others */
static const int64_t REBUILD_NS = 100 * NS_PER_MS, REBUILD_MAX_NS = 5 * NS_PER_S; /* between attempts at a new context */
static const int64_t SAME_NS = 60 * NS_PER_S; /* a driver that restarts is waited for so long, before anything else will do */

/* Under lock. It is wanted as before; true: a newer wish of its client is there already, and stands for it. */
static bool wish_again(const struct order *order, void *arg)
{
    struct client *client = painter_find(arg, order->client);
    if (!client || client->pending)
        return true;
    client->wish = order->wish;
    client->pending = true;
    return false;
}

/* What the picture is not made for. If the context was lost it is drawn again in the next one. */
static void fail(struct drawing *drawing, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    bool lost = gl_lost(drawing->gl);
    if (lost) {
        pthread_mutex_lock(&painter->lock);
        batch_split(batch, wish_again, painter, &drawing->same);
        pthread_mutex_unlock(&painter->lock);
        painter_post_none(painter, &drawing->same, false);
    } else {
        counter_inc(painter->failures, 1);
        painter_post_none(painter, batch, true);
    }
    batch->count = 0;
}

/* What was read back from a context that is gone is no picture. Takes the frame. */
static bool is_good(struct drawing *drawing, struct frame *frame)
{
    bool good = frame && !gl_lost(drawing->gl);
    if (frame && !good)
        frame_unref(&frame);
    return good;
}

static void lose_on_demand(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    pthread_mutex_lock(&painter->lock);
    bool lose = painter->lose;
    painter->lose = false;
    pthread_mutex_unlock(&painter->lock);
    if (lose)
        gl_lose(drawing->gl);
}

static const struct proofs *proofs_now(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    const struct proofs *proofs = painter->proofs;
    pthread_mutex_unlock(&painter->lock);
    return proofs;
}

/* Takes the frame. */
static void deliver(struct drawing *drawing, struct frame *frame, const struct snapshot *snapshot, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    frame_read_markers(frame, snapshot, painter->params.baselines);
    frame->clock_unset = !frame->view.at_us && !clock_utc_is_set();
    if (batch->orders[0].wish.overlay)
        (batch->orders[0].wish.overlay == OVERLAY_FULL ? overlay_draw : overlay_draw_bare)(frame, painter->params.scene, snapshot,
                                                                                           proofs_now(painter));
    counter_inc(painter->renders, 1);
    counter_inc(painter->render_us, (frame->render_ns + frame->readback_ns) / 1000);
    if (!batch->orders[0].wish.overlay)
        recent_add(&drawing->recent, frame, snapshot->taken_mono_ns, clock_mono_ns());
    sharing_submit(painter, frame, batch, frame->field_ns + frame->render_ns + frame->readback_ns);
    frame_unref(&frame);
}

/* --- pictures that a GPU draws while another one's pixels come ----------------------------------------------------------------- */

/* The instant, if it is one, goes over to it. */
static void fly(struct drawing *drawing, struct batch *batch, const struct moment **moment, uint64_t content, int64_t field_ns)
{
    struct flying_picture picture = { .moment = *moment, .content = content, .field_ns = field_ns };
    const struct snapshot *snapshot = *moment ? &(*moment)->snapshot : drawing->snapshot;
    picture.canvas = canvas_launch(drawing->renderer, &batch->orders[0].wish.view, snapshot);
    if (!picture.canvas) {
        fail(drawing, batch);
        return;
    }
    flying_push(&drawing->flying, &picture, batch, &drawing->snapshot);
    *moment = NULL;
    if (picture.moment)
        return;
    store_snapshot(drawing->painter->params.store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
}

static void flying_gone(struct drawing *drawing)
{
    if (drawing->flying.at[0].moment)
        moments_give(drawing->painter->params.moments, &drawing->flying.at[0].moment);
    flying_pop(&drawing->flying);
}

/* The oldest: waits for it. */
static void land(struct drawing *drawing)
{
    struct flying_picture *picture = &drawing->flying.at[0];
    struct frame *frame = canvas_end(drawing->renderer, &picture->canvas);
    if (is_good(drawing, frame)) {
        frame->field_ns += picture->field_ns;
        deliver(drawing, frame, flying_readings(picture), &picture->batch);
    } else {
        fail(drawing, &picture->batch);
    }
    flying_gone(drawing);
}

/* Those that came, and where there is room for no other the oldest. */
static void land_some(struct drawing *drawing)
{
    struct flying *flying = &drawing->flying;
    while (flying->count > 0 && (flying->count == FLYING_MOST || canvas_landed(flying->at[0].canvas)))
        land(drawing);
}

/* --- pictures that take long -------------------------------------------------------------------------------------------------- */

/* Whoever it is for left the one before it, not this one. */
static void stay(struct painter *painter, const struct batch *batch)
{
    pthread_mutex_lock(&painter->lock);
    for (size_t i = 0; i < batch->count; i++) {
        struct client *client = painter_find(painter, batch->orders[i].client);
        if (client)
            client->left = false;
    }
    pthread_mutex_unlock(&painter->lock);
}

/* The instant, if it is one, goes over to it. */
static void slow_swap(struct drawing *drawing)
{
    struct slow parked = drawing->parked;
    drawing->parked = drawing->slow;
    drawing->slow = parked;
}

/* Makes the place free, if whoever is first in the batch may have it at once. */
static void slow_park(struct drawing *drawing, const struct batch *batch)
{
    struct painter *painter = drawing->painter;
    pthread_mutex_lock(&painter->lock);
    const struct client *client = painter_find(painter, batch->orders[0].client);
    bool overtakes = client && drawing_overtakes(drawing, client);
    pthread_mutex_unlock(&painter->lock);
    if (overtakes)
        slow_swap(drawing);
}

static int64_t spent_by(struct painter *painter, uint64_t id)
{
    pthread_mutex_lock(&painter->lock);
    const struct client *client = painter_find(painter, id);
    int64_t spent_ns = client ? client->payer->spent_ns[SCHEDULE_LONG] : 0;
    pthread_mutex_unlock(&painter->lock);
    return spent_ns;
}

static void slow_begin(struct drawing *drawing, struct batch *batch, const struct moment **moment, int64_t field_ns)
{
    const struct wish *wish = &batch->orders[0].wish;
    const struct snapshot *snapshot = *moment ? &(*moment)->snapshot : drawing->snapshot;
    drawing->slow.canvas = canvas_begin(drawing->renderer, &wish->view, snapshot);
    if (!drawing->slow.canvas) {
        fail(drawing, batch);
        return;
    }
    drawing->slow.keeps = canvas_keeps(drawing->slow.canvas);
    drawing->slow.urgency = wish->urgency;
    drawing->slow.asked_ns = wish->asked_ns;
    drawing->slow.field_ns = field_ns;
    drawing->slow.px = (int64_t)wish->view.width_px * wish->view.height_px;
    drawing->slow.payer = wish->payer;
    drawing->slow.payer_spent_ns = spent_by(drawing->painter, batch->orders[0].client);
    drawing->slow.spent_ns = 0;
    struct batch empty = drawing->slow.batch;
    stay(drawing->painter, batch);
    drawing->slow.batch = *batch;
    *batch = empty;
    batch->count = 0;
    drawing->slow.moment = *moment;
    *moment = NULL;
    if (drawing->slow.moment)
        return;
    struct snapshot *other = drawing->slow.snapshot;
    drawing->slow.snapshot = drawing->snapshot;
    drawing->snapshot = other;
    store_snapshot(drawing->painter->params.store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
}

/* Its clients may have got newer readings meanwhile: the refined picture shows them too, and is the newest. NULL: it cannot. */
static struct frame *slow_again(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    struct batch *batch = &drawing->slow.batch;
    const struct view *view = &batch->orders[0].wish.view;
    if (!drawing->slow.keeps || batch->orders[0].wish.overlay || drawing->slow.moment)
        return NULL;
    drawing_refresh(drawing);
    if (!canvas_is_quick(drawing->renderer, view, drawing->snapshot))
        return NULL;
    pthread_mutex_lock(&painter->lock);
    for (size_t i = 0; i < batch->count; i++) {
        struct client *client = painter_find(painter, batch->orders[i].client);
        if (client)
            batch->orders[i].number = ++client->number;
    }
    pthread_mutex_unlock(&painter->lock);
    return canvas_draw(drawing->renderer, view, drawing->snapshot);
}

static const struct snapshot *slow_readings(const struct drawing *drawing)
{
    return drawing->slow.moment ? &drawing->slow.moment->snapshot : drawing->slow.snapshot;
}

static void slow_forget_moment(struct drawing *drawing)
{
    if (drawing->slow.moment)
        moments_give(drawing->painter->params.moments, &drawing->slow.moment);
}

/* True: it is done. */
static bool slow_step(struct drawing *drawing)
{
    int64_t start_ns = clock_mono_ns();
    bool drawn = canvas_step(drawing->renderer, drawing->slow.canvas, STEP_NS);
    drawing->slow.spent_ns += clock_mono_ns() - start_ns;
    counter_inc(drawing->painter->steps, 1);
    lose_on_demand(drawing);
    if (!drawn && !gl_lost(drawing->gl))
        return false;
    struct frame *frame = canvas_end(drawing->renderer, &drawing->slow.canvas);
    if (is_good(drawing, frame)) {
        struct frame *newer = slow_again(drawing);
        frame->field_ns += drawing->slow.field_ns;
        if (newer) {
            newer->field_ns += frame->field_ns;
            newer->render_ns += frame->render_ns;
            frame_unref(&frame);
        }
        deliver(drawing, newer ? newer : frame, newer ? drawing->snapshot : slow_readings(drawing), &drawing->slow.batch);
    } else {
        fail(drawing, &drawing->slow.batch);
    }
    slow_forget_moment(drawing);
    drawing->slow.batch.count = 0;
    return true;
}

/* Under lock. */
static bool has_left(const struct order *order, void *arg)
{
    const struct client *client = painter_find(arg, order->client);
    return !client || client->left || (client->pending && client->wish.urgency == URGENCY_INPUT);
}

/* Who moved on gets no more of it; when nobody is left it is given up. */
static void slow_leave(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    if (!drawing->slow.canvas)
        return;
    pthread_mutex_lock(&painter->lock);
    batch_split(&drawing->slow.batch, has_left, painter, &drawing->same);
    pthread_mutex_unlock(&painter->lock);
    painter_post_none(painter, &drawing->same, false);
    if (drawing->slow.batch.count > 0)
        return;
    counter_inc(painter->abandoned, 1);
    canvas_abandon(drawing->renderer, &drawing->slow.canvas);
    slow_forget_moment(drawing);
}

/* A refined picture was wished for if it were quick, and it is not: the other one that was wished for then. */
static void choose_other(struct batch *batch)
{
    for (size_t i = 0; i < batch->count; i++) {
        struct wish *wish = &batch->orders[i].wish;
        if (!wish->or_moving) {
            wish->urgency = URGENCY_REFINE;
            continue;
        }
        wish->view.tier = TIER_MOVING;
        wish->quality = wish->moving_quality;
    }
}

/* False: held: the field is not there yet, or the place for slow pictures is taken; again later. */
static bool draw_of(struct drawing *drawing, struct batch *batch, const struct snapshot *snapshot, const struct moment **moment)
{
    int64_t field_begin_ns = clock_mono_ns();
    const struct wish *wish = &batch->orders[0].wish;
    bool ready = canvas_prepare(drawing->renderer, &wish->view, snapshot, FIELD_NS);
    bool quick = ready && canvas_is_quick(drawing->renderer, &wish->view, snapshot);
    if (ready && !quick && wish->urgency == URGENCY_DATA)
        choose_other(batch);
    quick = quick || wish->urgency < URGENCY_REFINE;
    if (ready && !quick && drawing->slow.canvas)
        slow_park(drawing, batch);
    if ((!ready || (!quick && drawing->slow.canvas)) && held_push(&drawing->held, batch)) {
        counter_inc(drawing->painter->steps, 1);
        return false;
    }
    uint64_t content = sharing_leave_out_same(drawing, snapshot, batch);
    if (batch->count == 0)
        return true;
    int64_t field_ns = clock_mono_ns() - field_begin_ns; /* to know what changed, the field was brought up to date already */
    if (!quick && !drawing->slow.canvas) {
        slow_begin(drawing, batch, moment, field_ns);
        return true;
    }
    lose_on_demand(drawing);
    if (renderer_launches(drawing->renderer)) {
        fly(drawing, batch, moment, content, field_ns);
        return true;
    }
    struct frame *frame = canvas_draw(drawing->renderer, &wish->view, snapshot);
    if (!is_good(drawing, frame)) {
        fail(drawing, batch);
        return true;
    }
    frame->field_ns += field_ns;
    deliver(drawing, frame, snapshot, batch);
    return true;
}

/* As draw_of. */
static bool draw(struct drawing *drawing, struct batch *batch)
{
    const struct moment *moment;
    sharing_take_recent(drawing, batch);
    if (batch->count == 0)
        return true;
    const struct snapshot *snapshot = drawing_readings(drawing, &batch->orders[0].wish.view, &moment);
    if (!snapshot) {
        painter_post_none(drawing->painter, batch, false);
        batch->count = 0;
        return true;
    }
    bool done = draw_of(drawing, batch, snapshot, &moment);
    if (moment)
        moments_give(drawing->painter->params.moments, &moment);
    return done;
}

/* --- life of the render thread -------------------------------------------------------------------------------------------------- */

/* GL and what hangs on it. kind: GL_AUTO or that of a context that is gone; hardware: a processor will not do. */
static bool gl_begin(struct drawing *drawing, enum gl_kind kind, bool hardware)
{
    const struct painter_params *params = &drawing->painter->params;
    unsigned shortages = gl_shortages();
    drawing->gl = gl_create(params->log, kind, params->gl_device);
    if (drawing->gl && hardware && drawing->gl->software) {
        log_warn(params->log, "gl: the GPU is not back yet");
        return false;
    }
    if (drawing->gl)
        drawing->renderer = renderer_create(params->log, drawing->gl, params->scene, drawing->field);
    bool complete = gl_shortages() == shortages;
    if (!complete)
        log_err(params->log, "gl: the GPU has no room for the plant");
    if (!drawing->renderer || !complete)
        return false;
    renderer_set_per_fragment(drawing->renderer, params->per_fragment);
    renderer_use_gl(drawing->renderer, params->by_gl);
    drawing->warm = false;
    return renderer_hurry(drawing->renderer, LIGHT_NS);
}

static void gl_end(struct drawing *drawing)
{
    for (; drawing->flying.count > 0; flying_gone(drawing))
        canvas_abandon(drawing->renderer, &drawing->flying.at[0].canvas);
    for (int i = 0; i < 2; i++, slow_swap(drawing)) {
        if (drawing->renderer)
            canvas_abandon(drawing->renderer, &drawing->slow.canvas);
        slow_forget_moment(drawing);
    }
    renderer_destroy(&drawing->renderer);
    gl_destroy(&drawing->gl);
}

/* For what it costs. */
static void draw_for_nobody(struct drawing *drawing, const struct view *view)
{
    struct frame *frame = canvas_draw(drawing->renderer, view, drawing->snapshot);
    if (frame)
        frame_unref(&frame);
}

/* What only the first picture of a tier costs (shaders) is paid before anyone asks. */
static void warm_up(struct drawing *drawing, enum tier tier)
{
    struct view view;
    view_default(drawing->painter->params.scene, 64, 36, &view);
    view.tier = tier;
    draw_for_nobody(drawing, &view);
}

/* Pictures that somebody waits for: the next ones find their fields, buffers and shaders. */
static void rehearse(struct drawing *drawing)
{
    const struct painter_params *params = &drawing->painter->params;
    for (size_t i = 0; i < params->first_count; i++) {
        struct view view = params->first[i];
        view.tier = TIER_MOVING;
        canvas_prepare(drawing->renderer, &view, drawing->snapshot, REHEARSE_NS);
        draw_for_nobody(drawing, &view);
    }
}

static bool drawing_init(struct drawing *drawing, struct painter *painter)
{
    const struct painter_params *params = &painter->params;
    *drawing = (struct drawing){ .painter = painter };
    drawing->field = field_create(params->workers, params->scene);
    field_set_baselines(drawing->field, params->baselines);
    field_set_trials(drawing->field, params->trials);
    drawing->snapshot = snapshot_create(params->scene->plant->tag_count);
    drawing->slow.snapshot = snapshot_create(params->scene->plant->tag_count);
    drawing->parked.snapshot = snapshot_create(params->scene->plant->tag_count);
    flying_init(&drawing->flying, params->scene->plant->tag_count);
    store_snapshot(params->store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
    resting_init(&drawing->resting, painter);
    return gl_begin(drawing, params->gl, false);
}

static void drawing_finish(struct drawing *drawing)
{
    gl_end(drawing);
    batch_finish(&drawing->slow.batch);
    batch_finish(&drawing->parked.batch);
    field_destroy(&drawing->field);
    snapshot_destroy(&drawing->snapshot);
    snapshot_destroy(&drawing->slow.snapshot);
    snapshot_destroy(&drawing->parked.snapshot);
    batch_finish(&drawing->same);
    recent_finish(&drawing->recent);
    held_finish(&drawing->held);
    flying_finish(&drawing->flying);
}

void drawing_idle(struct drawing *drawing)
{
    drawing->warm = renderer_idle(drawing->renderer, IDLE_NS);
    drawing_stir(drawing);
    if (drawing->warm)
        warm_up(drawing, TIER_STILL);
}

static void set_lost(struct painter *painter, bool lost)
{
    pthread_mutex_lock(&painter->lock);
    painter->lost = lost;
    pthread_mutex_unlock(&painter->lock);
}

/* False: the painter is to stop. */
static bool pause_for(struct painter *painter, int64_t pause_ns)
{
    int64_t until_ns = clock_mono_ns() + pause_ns;
    pthread_mutex_lock(&painter->lock);
    while (painter->state == RUNNING && clock_mono_ns() < until_ns)
        drawing_wait(painter, until_ns);
    bool running = painter->state == RUNNING;
    pthread_mutex_unlock(&painter->lock);
    return running;
}

/* A device that was reset needs a moment, a driver that restarts some seconds; until then nothing is drawn, and nothing else ends.
   The slow picture that was under way is asked for again. */
static void rebuild(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    int64_t pause_ns = REBUILD_NS, lost_ns = clock_mono_ns();
    enum gl_kind kind = drawing->gl->kind;
    bool hardware = !drawing->gl->software;
    log_err(painter->params.log, "gl: the context is lost; making a new one");
    counter_inc(painter->losses, 1);
    set_lost(painter, true);
    for (int i = 0; i < drawing->flying.count; i++)
        fail(drawing, &drawing->flying.at[i].batch);
    fail(drawing, &drawing->slow.batch);
    fail(drawing, &drawing->parked.batch);
    gl_end(drawing);
    while (!gl_begin(drawing, kind, hardware)) {
        gl_end(drawing);
        if (!pause_for(painter, pause_ns))
            return;
        pause_ns = pause_ns * 2 > REBUILD_MAX_NS ? REBUILD_MAX_NS : pause_ns * 2;
        if (clock_mono_ns() - lost_ns >= SAME_NS) {
            kind = painter->params.gl;
            hardware = false;
        }
    }
    renderer_idle(drawing->renderer, INT64_MAX); /* pictures go on as they were */
    set_lost(painter, false);
    log_info(painter->params.log, "gl: a new context draws after %.1f s", (double)(clock_mono_ns() - lost_ns) / NS_PER_S);
}

static void turn(struct drawing *drawing, struct schedule *schedule, struct batch *batch)
{
    enum urgency urgency = batch->count > 0 ? batch->orders[0].wish.urgency : drawing->slow.urgency;
    bool done = true;
    if (!drawing->slow.canvas && drawing->parked.canvas)
        slow_swap(drawing);
    slow_leave(drawing);
    if (batch->count == 0 && !drawing->slow.canvas && drawing->flying.count > 0) {
        land(drawing);
        return;
    }
    if (batch->count > 0)
        done = draw(drawing, batch);
    else if (drawing->slow.canvas)
        done = slow_step(drawing);
    land_some(drawing);
    if (urgency >= URGENCY_REFINE)
        schedule_stepped(schedule);
    if (done && !(urgency >= URGENCY_REFINE && drawing->slow.canvas))
        schedule_done(schedule, urgency, clock_mono_ns());
}

void *drawing_main(void *arg)
{
    struct painter *painter = arg;
    struct drawing drawing;
    struct batch batch = { 0 };
    struct schedule schedule = { 0 };
    bool good = drawing_init(&drawing, painter);
    if (good) {
        drawing_bound(&drawing);
        rehearse(&drawing);
    }
    pthread_mutex_lock(&painter->lock);
    painter->state = good ? RUNNING : FAILED;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    if (good)
        warm_up(&drawing, TIER_MOVING);
    while (drawing_next(&drawing, &schedule, &batch)) {
        turn(&drawing, &schedule, &batch);
        drawing_look(&drawing);
        if (gl_lost(drawing.gl))
            rebuild(&drawing);
    }
    batch_finish(&batch);
    drawing_finish(&drawing);
    return NULL;
}
