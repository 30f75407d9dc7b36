/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render thread: takes the most urgent request, draws it and passes the frame to the encode queue. */
#include "base/clock.h"
#include "service/render_thread_impl.h"
#include "render/frame_record.h"
#include "render/overlay/overlay.h"

/* time in nanoseconds for one step of a long job (a frame drawn in steps); other requests are served after each step */
static const int64_t STEP_NS = 10 * NS_PER_MS;
/* time in nanoseconds for baking the light that a session chose, per frame that the render thread draws while that session's
   camera moves */
static const int64_t LIGHT_NS = 4 * NS_PER_MS;
/* time in nanoseconds for a slow computation of a field, per frame that the render thread draws meanwhile */
static const int64_t FIELD_NS = 6 * NS_PER_MS;
/* REBUILD_NS: nanoseconds between the first two attempts to create a new GL context; the pause doubles with each attempt, up to
   REBUILD_MAX_NS */
static const int64_t REBUILD_NS = 100 * NS_PER_MS, REBUILD_MAX_NS = 5 * NS_PER_S;
/* Maximum time in nanoseconds that changed readings wait for the next refined frame of a view that has had one. Afterwards a
   preview shows them. */
static const int64_t MAX_READINGS_DELAY_NS = 4 * NS_PER_S;
/* Time in nanoseconds after a restart of the GPU's driver during which the render thread accepts only a GPU of the same kind.
   Afterwards any renderer will do. */
static const int64_t DRIVER_RESTART_TIMEOUT_NS = 60 * NS_PER_S;

/* Puts the ticket's request back into the queue. Returns true if there is no need: the client has gone, or has a newer request.
   The caller holds the lock. */
static bool request_again(const struct request_ticket *ticket, void *arg)
{
    struct render_client *client = render_service_find(arg, ticket->client);
    if (!client || client->pending)
        return true;
    client->request = ticket->request;
    client->pending = true;
    return false;
}

/* Answers the group's requests with a failure. If the GL context was lost, keeps them waiting for the next context instead. */
static void fail(struct render_thread *thread, struct request_group *group)
{
    struct render_service *service = thread->service;
    bool lost = gl_lost(thread->gl);
    if (lost) {
        pthread_mutex_lock(&service->lock);
        request_group_split(group, request_again, service, &thread->same);
        pthread_mutex_unlock(&service->lock);
        render_service_answer_without_frame(service, &thread->same, FRAME_SKIPPED);
    } else {
        counter_inc(service->failures, 1);
        render_service_answer_without_frame(service, group, FRAME_FAILED);
    }
    group->count = 0;
}

/* Returns whether the frame's pixels are valid; frees an invalid frame. The pixels are invalid if the GL context was lost
   before they were read back. */
static bool is_good(struct render_thread *thread, struct frame *frame)
{
    bool good = frame && !gl_lost(thread->gl);
    if (frame && !good)
        frame_unref(&frame);
    return good;
}

static void lose_on_demand(struct render_thread *thread)
{
    struct render_service *service = thread->service;
    pthread_mutex_lock(&service->lock);
    bool lose = service->lose;
    service->lose = false;
    pthread_mutex_unlock(&service->lock);
    if (lose)
        gl_lose(thread->gl);
}

static const struct loop_checks *loop_checks_now(struct render_service *service)
{
    pthread_mutex_lock(&service->lock);
    const struct loop_checks *loop_checks = service->loop_checks;
    pthread_mutex_unlock(&service->lock);
    return loop_checks;
}

/* Passes a finished frame and the requests that it answers to the encode queue; takes ownership of the frame. */
static void deliver(struct render_thread *thread, struct frame *frame, const struct snapshot *snapshot, struct request_group *group)
{
    struct render_service *service = thread->service;
    int64_t now_ns = clock_mono_ns();
    frame->turn_ns = now_ns - thread->turn_began_ns;
    thread->turn_began_ns = now_ns;
    frame_read_markers(frame, snapshot, service->params.baselines);
    frame->clock_unset = !frame->view.at_us && !clock_utc_is_set();
    if ((group->tickets[0].request.overlay && service->params.keeps_records) || request_group_wants_record(group))
        frame->record = frame_record_create(&frame->view, snapshot, service->params.baselines, loop_checks_now(service));
    if (group->tickets[0].request.overlay)
        (group->tickets[0].request.overlay == OVERLAY_FULL ? overlay_draw : overlay_draw_bare)(frame, service->params.scene, snapshot,
                                                                                               loop_checks_now(service));
    counter_inc(service->renders, 1);
    counter_inc(service->render_us, (frame->render_ns + frame->readback_ns) / 1000);
    if (!group->tickets[0].request.overlay)
        recent_frames_add(&thread->recent, frame, snapshot->taken_mono_ns, now_ns);
    frame_sharing_submit(service, frame, group, frame->field_ns + frame->render_ns + frame->readback_ns);
    frame_unref(&frame);
}

/* --- submitted frames: the GPU draws one while the pixels of earlier ones are read back ------------------------------- */

/* Submits a frame to the GPU; takes ownership of the reference *historical. */
static void submit(struct render_thread *thread, struct request_group *group, const struct historical_snapshot **historical,
                   const struct split_plan *plan)
{
    struct pending_readback encoded = {
        .historical = *historical, .content = plan->content, .gives_depth = renderer_gives_depth(thread->renderer)
    };
    encoded.split = split_view_submit(thread->renderer, plan);
    if (!encoded.split) {
        fail(thread, group);
        return;
    }
    pending_readbacks_push(&thread->in_flight, &encoded, group, &thread->snapshot);
    *historical = NULL;
    thread->stale |= !encoded.historical;
}

static void drop_oldest(struct render_thread *thread)
{
    if (thread->in_flight.at[0].historical)
        snapshot_cache_give(thread->service->params.snapshot_cache, &thread->in_flight.at[0].historical);
    pending_readbacks_pop(&thread->in_flight);
}

/* Waits until the oldest submitted frame is complete and passes it to the encode queue. */
static void finish_oldest(struct render_thread *thread)
{
    struct pending_readback *encoded = &thread->in_flight.at[0];
    struct frame *frame = split_view_end(thread->renderer, &encoded->split);
    if (is_good(thread, frame))
        deliver(thread, frame, pending_readbacks_readings(encoded), &encoded->group);
    else
        fail(thread, &encoded->group);
    drop_oldest(thread);
}

/* Passes all complete frames to the encode queue; if the list of submitted frames is full, waits for the oldest. */
static void finish_complete(struct render_thread *thread)
{
    struct pending_readbacks *in_flight = &thread->in_flight;
    while (in_flight->count > 0 && (in_flight->count == PENDING_READBACKS_MAX || split_view_is_complete(in_flight->at[0].split)))
        finish_oldest(thread);
}

/* --- long jobs: frames drawn in steps ------------------------------------------------------------------------------------- */

/* Clears the flag `left` of the group's clients, because they now wait for a new long job (a frame drawn in steps). The flag
   says that a client withdrew from the last one. */
static void stay(struct render_service *service, const struct request_group *group)
{
    pthread_mutex_lock(&service->lock);
    for (size_t i = 0; i < group->count; i++) {
        struct render_client *client = render_service_find(service, group->tickets[i].client);
        if (client)
            client->left = false;
    }
    pthread_mutex_unlock(&service->lock);
}

/* Exchanges the running long job (a frame drawn in steps) with the parked (suspended) one. */
static void long_job_swap(struct render_thread *thread)
{
    struct long_job parked = thread->parked;
    thread->parked = thread->long_job;
    thread->long_job = parked;
}

/* Suspends the running long job (a frame drawn in steps) if the frame of the group's first client is small enough to be drawn before it. */
static void long_job_park(struct render_thread *thread, const struct request_group *group)
{
    struct render_service *service = thread->service;
    pthread_mutex_lock(&service->lock);
    const struct render_client *client = render_service_find(service, group->tickets[0].client);
    bool overtakes = client && render_thread_overtakes(thread, client);
    pthread_mutex_unlock(&service->lock);
    if (overtakes)
        long_job_swap(thread);
}

static int64_t spent_by(struct render_service *service, uint64_t id)
{
    pthread_mutex_lock(&service->lock);
    const struct render_client *client = render_service_find(service, id);
    int64_t spent_ns = client ? client->account->spent_ns[SCHEDULER_LONG] : 0;
    pthread_mutex_unlock(&service->lock);
    return spent_ns;
}

static void long_job_begin(struct render_thread *thread, struct request_group *group, const struct historical_snapshot **historical,
                           const struct split_plan *plan)
{
    const struct frame_request *request = &group->tickets[0].request;
    thread->long_job.split = split_view_begin(thread->renderer, plan);
    if (!thread->long_job.split) {
        fail(thread, group);
        return;
    }
    thread->long_job.keeps = split_view_keeps(thread->long_job.split);
    thread->long_job.urgency = request->urgency;
    thread->long_job.asked_ns = request->asked_ns;
    thread->long_job.px = (int64_t)request->view.width_px * request->view.height_px;
    thread->long_job.account = request->account;
    thread->long_job.account_spent_ns = spent_by(thread->service, group->tickets[0].client);
    thread->long_job.spent_ns = 0;
    struct request_group empty = thread->long_job.group;
    stay(thread->service, group);
    thread->long_job.group = *group;
    *group = empty;
    group->count = 0;
    thread->long_job.historical = *historical;
    *historical = NULL;
    if (thread->long_job.historical)
        return;
    struct snapshot *other = thread->long_job.snapshot;
    thread->long_job.snapshot = thread->snapshot;
    thread->snapshot = other;
    thread->stale = true;
}

/* Draws a finished refined frame again with the newest readings, because previews may already have shown its clients newer
   readings. Returns the new frame; NULL: not possible. */
static struct frame *long_job_with_new_readings(struct render_thread *thread)
{
    struct render_service *service = thread->service;
    struct request_group *group = &thread->long_job.group;
    const struct view *view = &group->tickets[0].request.view;
    if (!thread->long_job.keeps || group->tickets[0].request.overlay || thread->long_job.historical)
        return NULL;
    render_thread_refresh(thread);
    struct split_plan *plan = split_view_plan(thread->renderer, view, thread->snapshot, INT64_MAX);
    if (!split_view_is_quick(thread->renderer, plan)) {
        split_plan_destroy(&plan);
        return NULL;
    }
    pthread_mutex_lock(&service->lock);
    for (size_t i = 0; i < group->count; i++) {
        struct render_client *client = render_service_find(service, group->tickets[i].client);
        if (client)
            group->tickets[i].number = ++client->number;
    }
    pthread_mutex_unlock(&service->lock);
    struct frame *frame = split_view_draw(thread->renderer, plan);
    split_plan_destroy(&plan);
    return frame;
}

static const struct snapshot *long_job_readings(const struct render_thread *thread)
{
    return thread->long_job.historical ? &thread->long_job.historical->snapshot : thread->long_job.snapshot;
}

/* Called for clients that just got a refined frame: limits the time that changed readings wait for a preview to
   MAX_READINGS_DELAY_NS. Each refined frame that was given up had doubled that time. */
static void calm(struct render_service *service, const struct request_group *group)
{
    pthread_mutex_lock(&service->lock);
    for (size_t i = 0; i < group->count; i++) {
        struct render_client *client = render_service_find(service, group->tickets[i].client);
        if (client && client->patience_ns > MAX_READINGS_DELAY_NS)
            client->patience_ns = MAX_READINGS_DELAY_NS;
    }
    pthread_mutex_unlock(&service->lock);
}

static void long_job_forget_instant(struct render_thread *thread)
{
    if (thread->long_job.historical)
        snapshot_cache_give(thread->service->params.snapshot_cache, &thread->long_job.historical);
}

/* Draws one step of the long job (a frame drawn in steps). Returns true once the frame is complete. */
static bool long_job_step(struct render_thread *thread)
{
    int64_t start_ns = clock_mono_ns();
    bool drawn = split_view_step(thread->renderer, thread->long_job.split, STEP_NS);
    thread->turn_began_ns = clock_mono_ns();
    thread->long_job.spent_ns += thread->turn_began_ns - start_ns;
    counter_inc(thread->service->steps, 1);
    lose_on_demand(thread);
    if (!drawn && !gl_lost(thread->gl))
        return false;
    struct frame *frame = split_view_end(thread->renderer, &thread->long_job.split);
    if (is_good(thread, frame)) {
        struct frame *newer = long_job_with_new_readings(thread);
        if (newer) {
            newer->field_ns += frame->field_ns;
            newer->render_ns += frame->render_ns;
            frame_unref(&frame);
        }
        calm(thread->service, &thread->long_job.group);
        deliver(thread, newer ? newer : frame, newer ? thread->snapshot : long_job_readings(thread), &thread->long_job.group);
    } else {
        fail(thread, &thread->long_job.group);
    }
    long_job_forget_instant(thread);
    thread->long_job.group.count = 0;
    return true;
}

/* Returns whether the client no longer wants the frame that the long job (a frame drawn in steps) draws. The caller holds the lock. */
static bool has_left(const struct request_ticket *ticket, void *arg)
{
    const struct render_client *client = render_service_find(arg, ticket->client);
    return !client || client->left || (client->pending && client->request.urgency == URGENCY_INPUT);
}

/* Removes from the long job (a frame drawn in steps) the clients that no longer want its frame, and abandons the job once it
   has no clients. Its drawing time is charged nevertheless: otherwise an address whose clients withdraw from each frame would
   always be served first. */
static void long_job_leave(struct render_thread *thread)
{
    struct render_service *service = thread->service;
    if (!thread->long_job.split)
        return;
    pthread_mutex_lock(&service->lock);
    request_group_split(&thread->long_job.group, has_left, service, &thread->same);
    if (thread->long_job.group.count == 0)
        time_accounts_charge(&service->accounts, thread->long_job.account, SCHEDULER_LONG, thread->long_job.spent_ns);
    pthread_mutex_unlock(&service->lock);
    render_service_answer_without_frame(service, &thread->same, FRAME_SKIPPED);
    if (thread->long_job.group.count > 0)
        return;
    counter_inc(service->abandoned, 1);
    split_view_abandon(thread->renderer, &thread->long_job.split);
    long_job_forget_instant(thread);
}

/* Gives the group a preview in place of a refined frame if its first request has or_moving set. Otherwise its frame is drawn in
   steps (a long job). */
static void choose_other(struct request_group *group)
{
    /* one frame answers all tickets (requests whose drawing has begun) of the group, so all get the same tier: preview or
       refined */
    bool moving = group->tickets[0].request.or_moving;
    for (size_t i = 0; i < group->count; i++) {
        struct frame_request *request = &group->tickets[i].request;
        if (!moving) {
            request->urgency = URGENCY_REFINE;
            continue;
        }
        request->view.tier = TIER_PREVIEW;
        if (request->or_moving)
            request->quality = request->moving_quality;
        if (request->moving_codec) {
            request->codec = request->moving_codec;
            request->record = false;
        }
    }
}

/* Draws the planned frame in one call if `quick` is true; otherwise begins to draw it in steps (a long job). */
static void draw_plan(struct render_thread *thread, struct request_group *group, const struct snapshot *snapshot,
                      const struct historical_snapshot **historical, const struct split_plan *plan, bool quick)
{
    if (!quick && !thread->long_job.split) {
        long_job_begin(thread, group, historical, plan);
        return;
    }
    lose_on_demand(thread);
    if (renderer_submits(thread->renderer)) {
        submit(thread, group, historical, plan);
        return;
    }
    struct frame *frame = split_view_draw(thread->renderer, plan);
    if (is_good(thread, frame))
        deliver(thread, frame, snapshot, group);
    else
        fail(thread, group);
}

/* Draws the group's frame. Returns false if the group must wait because its field (interpolated values) is not computed yet, or
   because another long job (a frame drawn in steps) is running. */
static bool draw_of(struct render_thread *thread, struct request_group *group, const struct snapshot *snapshot,
                    const struct historical_snapshot **historical)
{
    const struct frame_request *request = &group->tickets[0].request;
    struct split_plan *plan = split_view_plan(thread->renderer, &request->view, snapshot, FIELD_NS);
    bool ready = plan != NULL, quick = ready && split_view_is_quick(thread->renderer, plan);
    if (ready && !quick && request->urgency == URGENCY_DATA) {
        choose_other(group);
        if (request->view.tier != plan->view.tier)
            split_plan_destroy(&plan);
    }
    quick = quick || request->urgency < URGENCY_REFINE;
    if (ready && !quick && thread->long_job.split)
        long_job_park(thread, group);
    if ((!ready || (!quick && thread->long_job.split)) && deferred_requests_push(&thread->deferred, group)) {
        split_plan_destroy(&plan);
        counter_inc(thread->service->steps, 1);
        return false;
    }
    if (!plan)
        plan = split_view_plan(thread->renderer, &request->view, snapshot, INT64_MAX);
    frame_sharing_answer_unchanged(thread, plan->content, group);
    if (group->count > 0)
        draw_plan(thread, group, snapshot, historical, plan, quick);
    split_plan_destroy(&plan);
    return true;
}

/* Returns whether the group, or the newest request of any connected client, wants a depth grid. Then all frames except those of
   walls get one, so that any client can share them. */
static bool wants_depth(struct render_service *service, const struct request_group *group)
{
    bool wants = request_group_wants_depth(group);
    pthread_mutex_lock(&service->lock);
    for (size_t i = 0; i < service->client_count && !wants; i++)
        wants = service->clients[i]->request.depth;
    pthread_mutex_unlock(&service->lock);
    return wants;
}

/* Answers the group's requests with a cached frame, or draws their frame. Returns false if the group must wait. */
static bool draw(struct render_thread *thread, struct request_group *group)
{
    const struct historical_snapshot *historical;
    renderer_set_depth(thread->renderer, wants_depth(thread->service, group) && !group->tickets[0].request.picture);
    frame_sharing_answer_from_recent(thread, group);
    if (group->count == 0)
        return true;
    const struct snapshot *snapshot = render_thread_readings(thread, &group->tickets[0].request.view, &historical);
    if (!snapshot) {
        render_service_answer_without_frame(thread->service, group, FRAME_SKIPPED);
        group->count = 0;
        return true;
    }
    bool done = draw_of(thread, group, snapshot, &historical);
    if (historical)
        snapshot_cache_give(thread->service->params.snapshot_cache, &historical);
    return done;
}

/* --- start, main loop and end of the render thread -------------------------------------------------------------------- */

/* Creates the GL context and everything that depends on it. kind: GL_AUTO, or the kind of the lost context. hardware: true:
   rejects a software renderer. On failure, logs the reason and returns false. */
static bool gl_begin(struct render_thread *thread, enum gl_kind kind, bool hardware)
{
    const struct render_service_params *params = &thread->service->params;
    unsigned shortages = gl_out_of_memory_count();
    thread->gl = gl_create(params->log, kind, params->gl_device);
    if (thread->gl && hardware && thread->gl->software) {
        log_warn(params->log, "gl: the GPU is still unavailable; retrying");
        return false;
    }
    if (thread->gl)
        thread->renderer = renderer_create(params->log, thread->gl, params->scene, thread->field);
    bool complete = gl_out_of_memory_count() == shortages;
    if (!complete)
        log_err(params->log, "gl: cannot load the plant: out of GPU memory");
    if (!thread->renderer || !complete)
        return false;
    renderer_set_per_fragment(thread->renderer, params->per_fragment);
    renderer_use_gl(thread->renderer, params->by_gl);
    thread->warm = false;
    return renderer_set_bake_budget(thread->renderer, LIGHT_NS);
}

static void gl_end(struct render_thread *thread)
{
    for (; thread->in_flight.count > 0; drop_oldest(thread))
        split_view_abandon(thread->renderer, &thread->in_flight.at[0].split);
    for (int i = 0; i < 2; i++, long_job_swap(thread)) {
        if (thread->renderer)
            split_view_abandon(thread->renderer, &thread->long_job.split);
        long_job_forget_instant(thread);
    }
    renderer_destroy(&thread->renderer);
    gl_destroy(&thread->gl);
}

static bool render_thread_init(struct render_thread *thread, struct render_service *service)
{
    const struct render_service_params *params = &service->params;
    *thread = (struct render_thread){ .service = service, .turn_began_ns = clock_mono_ns() };
    thread->field = field_create(params->workers, params->scene);
    field_set_baselines(thread->field, params->baselines);
    field_set_trials(thread->field, params->trials);
    thread->snapshot = snapshot_create(params->scene->plant->tag_count);
    thread->long_job.snapshot = snapshot_create(params->scene->plant->tag_count);
    thread->parked.snapshot = snapshot_create(params->scene->plant->tag_count);
    pending_readbacks_init(&thread->in_flight, params->scene->plant->tag_count);
    store_snapshot(params->store, clock_mono_ns(), clock_plant_ns(params->clock), thread->snapshot);
    render_thread_memory_init(&thread->memory, service);
    return gl_begin(thread, params->gl, false);
}

static void render_thread_finish(struct render_thread *thread)
{
    gl_end(thread);
    request_group_finish(&thread->long_job.group);
    request_group_finish(&thread->parked.group);
    field_destroy(&thread->field);
    snapshot_destroy(&thread->snapshot);
    snapshot_destroy(&thread->long_job.snapshot);
    snapshot_destroy(&thread->parked.snapshot);
    request_group_finish(&thread->same);
    recent_frames_finish(&thread->recent);
    deferred_requests_finish(&thread->deferred);
    pending_readbacks_finish(&thread->in_flight);
}

static void set_lost(struct render_service *service, bool lost)
{
    pthread_mutex_lock(&service->lock);
    service->lost = lost;
    service->asked_ns = 0;
    pthread_mutex_unlock(&service->lock);
}

/* Waits until pause_ns have passed. Returns false if the render service is stopping. */
static bool pause_for(struct render_service *service, int64_t pause_ns)
{
    int64_t until_ns = clock_mono_ns() + pause_ns;
    pthread_mutex_lock(&service->lock);
    while (service->state == RUNNING && clock_mono_ns() < until_ns) {
        service->asked_ns = 0;
        clock_cond_wait(&service->wake, &service->lock, until_ns);
    }
    bool running = service->state == RUNNING;
    pthread_mutex_unlock(&service->lock);
    return running;
}

/* Rebuilds a lost GL context. Attempts are repeated, because a driver takes some seconds to restart. Meanwhile nothing is
   drawn, but the rest of the daemon continues. The long job (a frame drawn in steps) in progress is requested again. */
static void rebuild(struct render_thread *thread)
{
    struct render_service *service = thread->service;
    int64_t pause_ns = REBUILD_NS, lost_ns = clock_mono_ns();
    enum gl_kind kind = thread->gl->kind;
    bool hardware = !thread->gl->software;
    log_err(service->params.log, "gl: the OpenGL context was lost; creating a new context");
    counter_inc(service->losses, 1);
    set_lost(service, true);
    for (int i = 0; i < thread->in_flight.count; i++)
        fail(thread, &thread->in_flight.at[i].group);
    fail(thread, &thread->long_job.group);
    fail(thread, &thread->parked.group);
    gl_end(thread);
    while (!gl_begin(thread, kind, hardware)) {
        gl_end(thread);
        if (!pause_for(service, pause_ns))
            return;
        pause_ns = pause_ns * 2 > REBUILD_MAX_NS ? REBUILD_MAX_NS : pause_ns * 2;
        if (clock_mono_ns() - lost_ns >= DRIVER_RESTART_TIMEOUT_NS) {
            kind = service->params.gl;
            hardware = false;
        }
    }
    /* bakes all lights completely, so that frames look the same as before the GL context was lost */
    renderer_bake_idle(thread->renderer, INT64_MAX);
    set_lost(service, false);
    log_info(service->params.log, "gl: drawing resumed with a new context after %.1f s", (double)(clock_mono_ns() - lost_ns) / NS_PER_S);
}

/* Continues the suspended long job (a frame drawn in steps) if no other one runs. Call it at the end of each turn, because
   there is no further turn until a request comes. */
static void resume_parked(struct render_thread *thread)
{
    if (!thread->long_job.split && thread->parked.split)
        long_job_swap(thread);
}

static void turn(struct render_thread *thread, struct scheduler *scheduler, struct request_group *group)
{
    enum urgency urgency = group->count > 0 ? group->tickets[0].request.urgency : thread->long_job.urgency;
    bool done = true;
    long_job_leave(thread);
    if (group->count == 0 && !thread->long_job.split && thread->in_flight.count > 0) {
        finish_oldest(thread);
        resume_parked(thread);
        return;
    }
    if (group->count > 0)
        done = draw(thread, group);
    else if (thread->long_job.split)
        done = long_job_step(thread);
    finish_complete(thread);
    if (urgency >= URGENCY_REFINE)
        scheduler_stepped(scheduler);
    if (done && !(urgency >= URGENCY_REFINE && thread->long_job.split))
        scheduler_done(scheduler, urgency, clock_mono_ns());
    resume_parked(thread);
}

void *render_thread_main(void *arg)
{
    struct render_service *service = arg;
    struct render_thread thread;
    struct request_group group = { 0 };
    struct scheduler scheduler = { 0 };
    pthread_setname_np(pthread_self(), "render");
    bool good = render_thread_init(&thread, service);
    if (good) {
        render_thread_bound_memory(&thread);
        render_thread_draw_first(&thread);
    }
    pthread_mutex_lock(&service->lock);
    service->state = good ? RUNNING : FAILED;
    pthread_cond_broadcast(&service->wake);
    pthread_mutex_unlock(&service->lock);
    if (good)
        render_thread_warm_tier(&thread, TIER_PREVIEW);
    while (render_thread_next(&thread, &scheduler, &group)) {
        turn(&thread, &scheduler, &group);
        render_thread_check_memory(&thread);
        if (gl_lost(thread.gl))
            rebuild(&thread);
    }
    request_group_finish(&group);
    render_thread_finish(&thread);
    return NULL;
}
