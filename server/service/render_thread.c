/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws what is wished for. */
#include "base/clock.h"
#include "service/render_thread_impl.h"
#include "render/overlay/overlay.h"

static const int64_t STEP_NS = 10 * NS_PER_MS;    /* of a slow picture, before anyone else gets a turn */
static const int64_t LIGHT_NS = 4 * NS_PER_MS;    /* of each picture of a moving session, for a light that it chose */
static const int64_t FIELD_NS = 6 * NS_PER_MS;    /* of a field that takes long, likewise */
static const int64_t IDLE_NS = 5 * NS_PER_MS;     /* of what nobody waits for, before looking whether somebody does */
static const int64_t REHEARSE_NS = 10 * NS_PER_S; /* of a field, before anyone asks; what is left is worked on as for others */
static const int64_t REBUILD_NS = 100 * NS_PER_MS, REBUILD_MAX_NS = 5 * NS_PER_S; /* between attempts at a new context */
static const int64_t SAME_NS = 60 * NS_PER_S; /* a driver that restarts is waited for so long, before anything else will do */

/* Under lock. It is wanted as before; true: a newer wish of its client is there already, and stands for it. */
static bool wish_again(const struct request_ticket *order, void *arg)
{
    struct render_client *client = render_service_find(arg, order->client);
    if (!client || client->pending)
        return true;
    client->wish = order->wish;
    client->pending = true;
    return false;
}

/* What the picture is not made for. If the context was lost it is drawn again in the next one. */
static void fail(struct render_thread *drawing, struct request_group *batch)
{
    struct render_service *painter = drawing->painter;
    bool lost = gl_lost(drawing->gl);
    if (lost) {
        pthread_mutex_lock(&painter->lock);
        request_group_split(batch, wish_again, painter, &drawing->same);
        pthread_mutex_unlock(&painter->lock);
        render_service_answer_without_frame(painter, &drawing->same, false);
    } else {
        counter_inc(painter->failures, 1);
        render_service_answer_without_frame(painter, batch, true);
    }
    batch->count = 0;
}

/* What was read back from a context that is gone is no picture. Takes the frame. */
static bool is_good(struct render_thread *drawing, struct frame *frame)
{
    bool good = frame && !gl_lost(drawing->gl);
    if (frame && !good)
        frame_unref(&frame);
    return good;
}

static void lose_on_demand(struct render_thread *drawing)
{
    struct render_service *painter = drawing->painter;
    pthread_mutex_lock(&painter->lock);
    bool lose = painter->lose;
    painter->lose = false;
    pthread_mutex_unlock(&painter->lock);
    if (lose)
        gl_lose(drawing->gl);
}

static const struct loop_checks *loop_checks_now(struct render_service *painter)
{
    pthread_mutex_lock(&painter->lock);
    const struct loop_checks *loop_checks = painter->loop_checks;
    pthread_mutex_unlock(&painter->lock);
    return loop_checks;
}

/* Takes the frame. */
static void deliver(struct render_thread *drawing, struct frame *frame, const struct snapshot *snapshot, struct request_group *batch)
{
    struct render_service *painter = drawing->painter;
    frame_read_markers(frame, snapshot, painter->params.baselines);
    frame->clock_unset = !frame->view.at_us && !clock_utc_is_set();
    if (batch->orders[0].wish.overlay)
        (batch->orders[0].wish.overlay == OVERLAY_FULL ? overlay_draw : overlay_draw_bare)(frame, painter->params.scene, snapshot,
                                                                                           loop_checks_now(painter));
    counter_inc(painter->renders, 1);
    counter_inc(painter->render_us, (frame->render_ns + frame->readback_ns) / 1000);
    if (!batch->orders[0].wish.overlay)
        recent_frames_add(&drawing->recent, frame, snapshot->taken_mono_ns, clock_mono_ns());
    frame_sharing_submit(painter, frame, batch, frame->field_ns + frame->render_ns + frame->readback_ns);
    frame_unref(&frame);
}

/* --- pictures that a GPU draws while another one's pixels come ----------------------------------------------------------------- */

/* The instant, if it is one, goes over to it. */
static void fly(struct render_thread *drawing, struct request_group *batch, const struct historical_snapshot **historical, uint64_t content,
                int64_t field_ns)
{
    struct awaited_frame picture = { .historical = *historical, .content = content, .field_ns = field_ns };
    const struct snapshot *snapshot = *historical ? &(*historical)->snapshot : drawing->snapshot;
    picture.split = split_view_submit(drawing->renderer, &batch->orders[0].wish.view, snapshot);
    if (!picture.split) {
        fail(drawing, batch);
        return;
    }
    awaited_frames_push(&drawing->flying, &picture, batch, &drawing->snapshot);
    *historical = NULL;
    if (picture.historical)
        return;
    store_snapshot(drawing->painter->params.store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
}

static void flying_gone(struct render_thread *drawing)
{
    if (drawing->flying.at[0].historical)
        snapshot_cache_give(drawing->painter->params.snapshot_cache, &drawing->flying.at[0].historical);
    awaited_frames_pop(&drawing->flying);
}

/* The oldest: waits for it. */
static void land(struct render_thread *drawing)
{
    struct awaited_frame *picture = &drawing->flying.at[0];
    struct frame *frame = split_view_end(drawing->renderer, &picture->split);
    if (is_good(drawing, frame)) {
        frame->field_ns += picture->field_ns;
        deliver(drawing, frame, awaited_frames_readings(picture), &picture->batch);
    } else {
        fail(drawing, &picture->batch);
    }
    flying_gone(drawing);
}

/* Those that came, and where there is room for no other the oldest. */
static void land_some(struct render_thread *drawing)
{
    struct awaited_frames *flying = &drawing->flying;
    while (flying->count > 0 && (flying->count == AWAITED_FRAMES_MOST || split_view_is_complete(flying->at[0].split)))
        land(drawing);
}

/* --- pictures that take long -------------------------------------------------------------------------------------------------- */

/* Whoever it is for left the one before it, not this one. */
static void stay(struct render_service *painter, const struct request_group *batch)
{
    pthread_mutex_lock(&painter->lock);
    for (size_t i = 0; i < batch->count; i++) {
        struct render_client *client = render_service_find(painter, batch->orders[i].client);
        if (client)
            client->left = false;
    }
    pthread_mutex_unlock(&painter->lock);
}

/* The instant, if it is one, goes over to it. */
static void slow_swap(struct render_thread *drawing)
{
    struct slow parked = drawing->parked;
    drawing->parked = drawing->slow;
    drawing->slow = parked;
}

/* Makes the place free, if whoever is first in the batch may have it at once. */
static void slow_park(struct render_thread *drawing, const struct request_group *batch)
{
    struct render_service *painter = drawing->painter;
    pthread_mutex_lock(&painter->lock);
    const struct render_client *client = render_service_find(painter, batch->orders[0].client);
    bool overtakes = client && render_thread_overtakes(drawing, client);
    pthread_mutex_unlock(&painter->lock);
    if (overtakes)
        slow_swap(drawing);
}

static int64_t spent_by(struct render_service *painter, uint64_t id)
{
    pthread_mutex_lock(&painter->lock);
    const struct render_client *client = render_service_find(painter, id);
    int64_t spent_ns = client ? client->payer->spent_ns[SCHEDULER_LONG] : 0;
    pthread_mutex_unlock(&painter->lock);
    return spent_ns;
}

static void slow_begin(struct render_thread *drawing, struct request_group *batch, const struct historical_snapshot **historical,
                       int64_t field_ns)
{
    const struct frame_request *wish = &batch->orders[0].wish;
    const struct snapshot *snapshot = *historical ? &(*historical)->snapshot : drawing->snapshot;
    drawing->slow.split = split_view_begin(drawing->renderer, &wish->view, snapshot);
    if (!drawing->slow.split) {
        fail(drawing, batch);
        return;
    }
    drawing->slow.keeps = split_view_keeps(drawing->slow.split);
    drawing->slow.urgency = wish->urgency;
    drawing->slow.asked_ns = wish->asked_ns;
    drawing->slow.field_ns = field_ns;
    drawing->slow.px = (int64_t)wish->view.width_px * wish->view.height_px;
    drawing->slow.payer = wish->payer;
    drawing->slow.payer_spent_ns = spent_by(drawing->painter, batch->orders[0].client);
    drawing->slow.spent_ns = 0;
    struct request_group empty = drawing->slow.batch;
    stay(drawing->painter, batch);
    drawing->slow.batch = *batch;
    *batch = empty;
    batch->count = 0;
    drawing->slow.historical = *historical;
    *historical = NULL;
    if (drawing->slow.historical)
        return;
    struct snapshot *other = drawing->slow.snapshot;
    drawing->slow.snapshot = drawing->snapshot;
    drawing->snapshot = other;
    store_snapshot(drawing->painter->params.store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
}

/* Its clients may have got newer readings meanwhile: the refined picture shows them too, and is the newest. NULL: it cannot. */
static struct frame *slow_again(struct render_thread *drawing)
{
    struct render_service *painter = drawing->painter;
    struct request_group *batch = &drawing->slow.batch;
    const struct view *view = &batch->orders[0].wish.view;
    if (!drawing->slow.keeps || batch->orders[0].wish.overlay || drawing->slow.historical)
        return NULL;
    render_thread_refresh(drawing);
    if (!split_view_is_quick(drawing->renderer, view, drawing->snapshot))
        return NULL;
    pthread_mutex_lock(&painter->lock);
    for (size_t i = 0; i < batch->count; i++) {
        struct render_client *client = render_service_find(painter, batch->orders[i].client);
        if (client)
            batch->orders[i].number = ++client->number;
    }
    pthread_mutex_unlock(&painter->lock);
    return split_view_draw(drawing->renderer, view, drawing->snapshot);
}

static const struct snapshot *slow_readings(const struct render_thread *drawing)
{
    return drawing->slow.historical ? &drawing->slow.historical->snapshot : drawing->slow.snapshot;
}

static void slow_forget_moment(struct render_thread *drawing)
{
    if (drawing->slow.historical)
        snapshot_cache_give(drawing->painter->params.snapshot_cache, &drawing->slow.historical);
}

/* True: it is done. */
static bool slow_step(struct render_thread *drawing)
{
    int64_t start_ns = clock_mono_ns();
    bool drawn = split_view_step(drawing->renderer, drawing->slow.split, STEP_NS);
    drawing->slow.spent_ns += clock_mono_ns() - start_ns;
    counter_inc(drawing->painter->steps, 1);
    lose_on_demand(drawing);
    if (!drawn && !gl_lost(drawing->gl))
        return false;
    struct frame *frame = split_view_end(drawing->renderer, &drawing->slow.split);
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
static bool has_left(const struct request_ticket *order, void *arg)
{
    const struct render_client *client = render_service_find(arg, order->client);
    return !client || client->left || (client->pending && client->wish.urgency == URGENCY_INPUT);
}

/* Who moved on gets no more of it; when nobody is left it is given up. */
static void slow_leave(struct render_thread *drawing)
{
    struct render_service *painter = drawing->painter;
    if (!drawing->slow.split)
        return;
    pthread_mutex_lock(&painter->lock);
    request_group_split(&drawing->slow.batch, has_left, painter, &drawing->same);
    pthread_mutex_unlock(&painter->lock);
    render_service_answer_without_frame(painter, &drawing->same, false);
    if (drawing->slow.batch.count > 0)
        return;
    counter_inc(painter->abandoned, 1);
    split_view_abandon(drawing->renderer, &drawing->slow.split);
    slow_forget_moment(drawing);
}

/* A refined picture was wished for if it were quick, and it is not: the other one that was wished for then. */
static void choose_other(struct request_group *batch)
{
    for (size_t i = 0; i < batch->count; i++) {
        struct frame_request *wish = &batch->orders[i].wish;
        if (!wish->or_moving) {
            wish->urgency = URGENCY_REFINE;
            continue;
        }
        wish->view.tier = TIER_PREVIEW;
        wish->quality = wish->moving_quality;
    }
}

/* False: held: the field is not there yet, or the place for slow pictures is taken; again later. */
static bool draw_of(struct render_thread *drawing, struct request_group *batch, const struct snapshot *snapshot,
                    const struct historical_snapshot **historical)
{
    int64_t field_begin_ns = clock_mono_ns();
    const struct frame_request *wish = &batch->orders[0].wish;
    bool ready = split_view_prepare(drawing->renderer, &wish->view, snapshot, FIELD_NS);
    bool quick = ready && split_view_is_quick(drawing->renderer, &wish->view, snapshot);
    if (ready && !quick && wish->urgency == URGENCY_DATA)
        choose_other(batch);
    quick = quick || wish->urgency < URGENCY_REFINE;
    if (ready && !quick && drawing->slow.split)
        slow_park(drawing, batch);
    if ((!ready || (!quick && drawing->slow.split)) && deferred_requests_push(&drawing->held, batch)) {
        counter_inc(drawing->painter->steps, 1);
        return false;
    }
    uint64_t content = frame_sharing_answer_unchanged(drawing, snapshot, batch);
    if (batch->count == 0)
        return true;
    int64_t field_ns = clock_mono_ns() - field_begin_ns; /* to know what changed, the field was brought up to date already */
    if (!quick && !drawing->slow.split) {
        slow_begin(drawing, batch, historical, field_ns);
        return true;
    }
    lose_on_demand(drawing);
    if (renderer_submits(drawing->renderer)) {
        fly(drawing, batch, historical, content, field_ns);
        return true;
    }
    struct frame *frame = split_view_draw(drawing->renderer, &wish->view, snapshot);
    if (!is_good(drawing, frame)) {
        fail(drawing, batch);
        return true;
    }
    frame->field_ns += field_ns;
    deliver(drawing, frame, snapshot, batch);
    return true;
}

/* As draw_of. */
static bool draw(struct render_thread *drawing, struct request_group *batch)
{
    const struct historical_snapshot *historical;
    frame_sharing_answer_from_recent(drawing, batch);
    if (batch->count == 0)
        return true;
    const struct snapshot *snapshot = render_thread_readings(drawing, &batch->orders[0].wish.view, &historical);
    if (!snapshot) {
        render_service_answer_without_frame(drawing->painter, batch, false);
        batch->count = 0;
        return true;
    }
    bool done = draw_of(drawing, batch, snapshot, &historical);
    if (historical)
        snapshot_cache_give(drawing->painter->params.snapshot_cache, &historical);
    return done;
}

/* --- life of the render thread -------------------------------------------------------------------------------------------------- */

/* GL and what hangs on it. kind: GL_AUTO or that of a context that is gone; hardware: a processor will not do. */
static bool gl_begin(struct render_thread *drawing, enum gl_kind kind, bool hardware)
{
    const struct render_service_params *params = &drawing->painter->params;
    unsigned shortages = gl_out_of_memory_count();
    drawing->gl = gl_create(params->log, kind, params->gl_device);
    if (drawing->gl && hardware && drawing->gl->software) {
        log_warn(params->log, "gl: the GPU is not back yet");
        return false;
    }
    if (drawing->gl)
        drawing->renderer = renderer_create(params->log, drawing->gl, params->scene, drawing->field);
    bool complete = gl_out_of_memory_count() == shortages;
    if (!complete)
        log_err(params->log, "gl: the GPU has no room for the plant");
    if (!drawing->renderer || !complete)
        return false;
    renderer_set_per_fragment(drawing->renderer, params->per_fragment);
    renderer_use_gl(drawing->renderer, params->by_gl);
    drawing->warm = false;
    return renderer_set_bake_budget(drawing->renderer, LIGHT_NS);
}

static void gl_end(struct render_thread *drawing)
{
    for (; drawing->flying.count > 0; flying_gone(drawing))
        split_view_abandon(drawing->renderer, &drawing->flying.at[0].split);
    for (int i = 0; i < 2; i++, slow_swap(drawing)) {
        if (drawing->renderer)
            split_view_abandon(drawing->renderer, &drawing->slow.split);
        slow_forget_moment(drawing);
    }
    renderer_destroy(&drawing->renderer);
    gl_destroy(&drawing->gl);
}

/* For what it costs. */
static void draw_for_nobody(struct render_thread *drawing, const struct view *view)
{
    struct frame *frame = split_view_draw(drawing->renderer, view, drawing->snapshot);
    if (frame)
        frame_unref(&frame);
}

/* What only the first picture of a tier costs (shaders) is paid before anyone asks. */
static void warm_up(struct render_thread *drawing, enum tier tier)
{
    struct view view;
    view_default(drawing->painter->params.scene, 64, 36, &view);
    view.tier = tier;
    draw_for_nobody(drawing, &view);
}

/* Pictures that somebody waits for: the next ones find their fields, buffers and shaders. */
static void rehearse(struct render_thread *drawing)
{
    const struct render_service_params *params = &drawing->painter->params;
    for (size_t i = 0; i < params->first_count; i++) {
        struct view view = params->first[i];
        view.tier = TIER_PREVIEW;
        split_view_prepare(drawing->renderer, &view, drawing->snapshot, REHEARSE_NS);
        draw_for_nobody(drawing, &view);
    }
}

static bool render_thread_init(struct render_thread *drawing, struct render_service *painter)
{
    const struct render_service_params *params = &painter->params;
    *drawing = (struct render_thread){ .painter = painter };
    drawing->field = field_create(params->workers, params->scene);
    field_set_baselines(drawing->field, params->baselines);
    field_set_trials(drawing->field, params->trials);
    drawing->snapshot = snapshot_create(params->scene->plant->tag_count);
    drawing->slow.snapshot = snapshot_create(params->scene->plant->tag_count);
    drawing->parked.snapshot = snapshot_create(params->scene->plant->tag_count);
    awaited_frames_init(&drawing->flying, params->scene->plant->tag_count);
    store_snapshot(params->store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
    render_thread_memory_init(&drawing->resting, painter);
    return gl_begin(drawing, params->gl, false);
}

static void render_thread_finish(struct render_thread *drawing)
{
    gl_end(drawing);
    request_group_finish(&drawing->slow.batch);
    request_group_finish(&drawing->parked.batch);
    field_destroy(&drawing->field);
    snapshot_destroy(&drawing->snapshot);
    snapshot_destroy(&drawing->slow.snapshot);
    snapshot_destroy(&drawing->parked.snapshot);
    request_group_finish(&drawing->same);
    recent_frames_finish(&drawing->recent);
    deferred_requests_finish(&drawing->held);
    awaited_frames_finish(&drawing->flying);
}

void render_thread_warm_up(struct render_thread *drawing)
{
    drawing->warm = renderer_bake_idle(drawing->renderer, IDLE_NS);
    render_thread_note_work(drawing);
    if (drawing->warm)
        warm_up(drawing, TIER_REFINED);
}

static void set_lost(struct render_service *painter, bool lost)
{
    pthread_mutex_lock(&painter->lock);
    painter->lost = lost;
    pthread_mutex_unlock(&painter->lock);
}

/* False: the painter is to stop. */
static bool pause_for(struct render_service *painter, int64_t pause_ns)
{
    int64_t until_ns = clock_mono_ns() + pause_ns;
    pthread_mutex_lock(&painter->lock);
    while (painter->state == RUNNING && clock_mono_ns() < until_ns)
        render_thread_wait(painter, until_ns);
    bool running = painter->state == RUNNING;
    pthread_mutex_unlock(&painter->lock);
    return running;
}

/* A device that was reset needs a moment, a driver that restarts some seconds; until then nothing is drawn, and nothing else ends.
   The slow picture that was under way is asked for again. */
static void rebuild(struct render_thread *drawing)
{
    struct render_service *painter = drawing->painter;
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
    renderer_bake_idle(drawing->renderer, INT64_MAX); /* pictures go on as they were */
    set_lost(painter, false);
    log_info(painter->params.log, "gl: a new context draws after %.1f s", (double)(clock_mono_ns() - lost_ns) / NS_PER_S);
}

static void turn(struct render_thread *drawing, struct scheduler *schedule, struct request_group *batch)
{
    enum urgency urgency = batch->count > 0 ? batch->orders[0].wish.urgency : drawing->slow.urgency;
    bool done = true;
    if (!drawing->slow.split && drawing->parked.split)
        slow_swap(drawing);
    slow_leave(drawing);
    if (batch->count == 0 && !drawing->slow.split && drawing->flying.count > 0) {
        land(drawing);
        return;
    }
    if (batch->count > 0)
        done = draw(drawing, batch);
    else if (drawing->slow.split)
        done = slow_step(drawing);
    land_some(drawing);
    if (urgency >= URGENCY_REFINE)
        scheduler_stepped(schedule);
    if (done && !(urgency >= URGENCY_REFINE && drawing->slow.split))
        scheduler_done(schedule, urgency, clock_mono_ns());
}

void *render_thread_main(void *arg)
{
    struct render_service *painter = arg;
    struct render_thread drawing;
    struct request_group batch = { 0 };
    struct scheduler schedule = { 0 };
    bool good = render_thread_init(&drawing, painter);
    if (good) {
        render_thread_bound_memory(&drawing);
        rehearse(&drawing);
    }
    pthread_mutex_lock(&painter->lock);
    painter->state = good ? RUNNING : FAILED;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    if (good)
        warm_up(&drawing, TIER_PREVIEW);
    while (render_thread_next(&drawing, &schedule, &batch)) {
        turn(&drawing, &schedule, &batch);
        render_thread_check_memory(&drawing);
        if (gl_lost(drawing.gl))
            rebuild(&drawing);
    }
    request_group_finish(&batch);
    render_thread_finish(&drawing);
    return NULL;
}
