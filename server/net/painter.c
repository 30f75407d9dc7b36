/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render thread and its way to the workers. */
#include "net/painter.h"

#include <pthread.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/encoding.h"
#include "render/overlay.h"
#include "render/renderer.h"

static const int64_t STEP_NS = 10 * NS_PER_MS;      /* of a slow picture, before anyone else gets a turn */
static const int64_t OWN_DATA_NS = 1 * NS_PER_S;    /* changed readings wait so long for a refinement of the same client */
static const int64_t SNAPSHOT_MAX_AGE_NS = 100 * NS_PER_MS; /* the clock in the picture, and ages, are no older than this */

struct client {
    uint64_t id, number;
    bool pending, has_content;
    bool left; /* the slow picture: it wants another by now */
    struct wish wish;
    uint64_t content; /* of the last picture drawn for it */
};

struct painter {
    struct painter_params params;
    counter *renders, *render_us, *same, *failures, *steps, *abandoned;
    struct encoding *encoding;
    pthread_t thread;
    bool has_thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under lock */
    enum { STARTING, RUNNING, FAILED, STOPPING } state;
    bool new_data;
    struct client *clients;
    size_t client_count, client_capacity;
    struct picture *done, **done_last;
};

struct drawing { /* what only the render thread touches */
    struct painter *painter;
    struct gl *gl;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
    struct batch same;
    struct { /* the picture that takes long and is drawn step by step; at most one */
        struct stroke *stroke; /* NULL: none */
        struct batch batch;
        struct snapshot *snapshot; /* of what it shows */
        enum urgency urgency;
        int64_t asked_ns, field_ns;
    } slow;
};

/* Under lock. NULL: none. */
static struct client *client_find(struct painter *painter, uint64_t id)
{
    for (size_t i = 0; i < painter->client_count; i++)
        if (painter->clients[i].id == id)
            return &painter->clients[i];
    return NULL;
}

/* --- pictures on their way back ------------------------------------------------------------------------------------------ */

static struct picture *picture_create(const struct order *order, struct packet *packet, bool failed)
{
    struct picture *picture = mem_new(sizeof(*picture));
    *picture = (struct picture){
        .client = order->client,
        .number = order->number,
        .packet = packet ? packet_ref(packet) : NULL,
        .failed = failed,
        .wish = order->wish,
        .wait_ns = order->wait_ns,
    };
    return picture;
}

/* Answers every order of the batch. */
static void post(struct painter *painter, const struct batch *batch, struct packet *packet, bool failed)
{
    bool was_empty = false;
    for (size_t i = 0; i < batch->count; i++) {
        struct picture *picture = picture_create(&batch->orders[i], packet, failed);
        pthread_mutex_lock(&painter->lock);
        was_empty |= painter->done == NULL;
        *painter->done_last = picture;
        painter->done_last = &picture->next;
        pthread_mutex_unlock(&painter->lock);
    }
    if (was_empty)
        painter->params.notify(painter->params.notify_arg);
}

static void on_encoded(void *arg, const struct batch *batch, struct packet *packet)
{
    post(arg, batch, packet, !packet);
}

struct picture *painter_collect(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    struct picture *done = painter->done;
    painter->done = NULL;
    painter->done_last = &painter->done;
    pthread_mutex_unlock(&painter->lock);
    return done;
}

/* --- drawing, on the render thread ----------------------------------------------------------------------------------------- */

static bool same_vector(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool same_camera(const struct camera *a, const struct camera *b)
{
    return same_vector(a->eye_m, b->eye_m) && same_vector(a->target_m, b->target_m) && same_vector(a->up, b->up) &&
           a->fov_deg == b->fov_deg;
}

static bool same_picture(const struct view *a, const struct view *b)
{
    return a->width_px == b->width_px && a->height_px == b->height_px && same_camera(&a->camera, &b->camera) &&
           field_params_equal(&a->field, &b->field) && a->colormap == b->colormap && a->ramp_interval == b->ramp_interval &&
           a->range_min == b->range_min && a->range_max == b->range_max && a->look == b->look && a->tier == b->tier &&
           a->selected_asset == b->selected_asset && same_vector(a->light_dir, b->light_dir);
}

/* Under lock. Its slow picture is under way and still good: what it wants besides can wait for it. */
static bool waits_for_slow(const struct drawing *drawing, const struct client *client, int64_t now_ns)
{
    bool soon = client->wish.urgency == URGENCY_DATA && now_ns - client->wish.asked_ns >= OWN_DATA_NS;
    if (client->left || client->wish.urgency == URGENCY_INPUT || soon)
        return false;
    for (size_t i = 0; drawing->slow.stroke && i < drawing->slow.batch.count; i++)
        if (drawing->slow.batch.orders[i].client == client->id)
            return true;
    return false;
}

struct turn {
    bool step;             /* of the slow picture; else */
    struct client *client; /* NULL: nobody before wait_until_ns */
    int64_t wait_until_ns;
};

/* Under lock. */
static struct turn next_turn(const struct drawing *drawing, const struct schedule *schedule)
{
    struct client *oldest[URGENCY_COUNT + 1] = { NULL };
    int64_t asked_ns[URGENCY_COUNT], now_ns = clock_mono_ns();
    bool busy = drawing->slow.stroke != NULL;
    struct turn turn = { 0 };
    for (int i = 0; i < URGENCY_COUNT; i++)
        asked_ns[i] = busy && drawing->slow.urgency == (enum urgency)i ? drawing->slow.asked_ns : INT64_MAX;
    for (size_t i = 0; i < drawing->painter->client_count; i++) {
        struct client *client = &drawing->painter->clients[i];
        enum urgency urgency = client->wish.urgency;
        if (!client->pending || client->wish.asked_ns >= asked_ns[urgency] || (busy && urgency >= URGENCY_REFINE) ||
            waits_for_slow(drawing, client, now_ns))
            continue;
        oldest[urgency] = client;
        asked_ns[urgency] = client->wish.asked_ns;
    }
    enum urgency urgency = schedule_choose(schedule, asked_ns, now_ns, &turn.wait_until_ns);
    turn.step = busy && urgency == drawing->slow.urgency;
    turn.client = oldest[urgency];
    return turn;
}

/* Under lock. */
static void wait_until(struct painter *painter, int64_t mono_ns)
{
    struct timespec until = { .tv_sec = mono_ns / NS_PER_S, .tv_nsec = mono_ns % NS_PER_S };
    if (mono_ns == INT64_MAX)
        pthread_cond_wait(&painter->wake, &painter->lock);
    else
        pthread_cond_timedwait(&painter->wake, &painter->lock, &until);
}

/* Under lock. What it had under way is not wanted any more. */
static void begin(struct client *client, struct batch *batch, int64_t now_ns)
{
    client->pending = false;
    client->left = client->wish.urgency < URGENCY_REFINE;
    batch_add(batch,
              &(struct order){
                  .client = client->id, .number = ++client->number, .wish = client->wish, .wait_ns = now_ns - client->wish.view.input_ns });
}

/* Under lock. The client's wish, and all that the same picture answers. */
static void begin_all(struct painter *painter, struct client *first, struct batch *batch)
{
    int64_t now_ns = clock_mono_ns();
    begin(first, batch, now_ns);
    struct wish wish = batch->orders[0].wish;
    for (size_t i = 0; i < painter->client_count && !wish.overlay; i++) {
        struct client *other = &painter->clients[i];
        if (other->pending && !other->wish.overlay && same_picture(&other->wish.view, &wish.view))
            begin(other, batch, now_ns);
    }
}

/* Waits for work. False: stop. An empty batch: the slow picture may go on by a step. */
static bool next_batch(const struct drawing *drawing, const struct schedule *schedule, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    struct turn turn = { 0 };
    batch->count = 0;
    pthread_mutex_lock(&painter->lock);
    while (painter->state == RUNNING) {
        turn = next_turn(drawing, schedule);
        if (turn.step || turn.client)
            break;
        wait_until(painter, turn.wait_until_ns);
    }
    bool running = painter->state == RUNNING;
    if (running && !turn.step)
        begin_all(painter, turn.client, batch);
    pthread_mutex_unlock(&painter->lock);
    return running;
}

static void refresh(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    int64_t now_ns = clock_mono_ns();
    pthread_mutex_lock(&painter->lock);
    bool new_data = painter->new_data;
    painter->new_data = false;
    pthread_mutex_unlock(&painter->lock);
    if (new_data || now_ns - drawing->snapshot->taken_mono_ns > SNAPSHOT_MAX_AGE_NS)
        store_snapshot(painter->params.store, now_ns, clock_utc_ns(), drawing->snapshot);
}

struct content_of {
    struct painter *painter;
    uint64_t content;
};

/* Under lock: the client has this picture already. */
static bool has_it(const struct order *order, void *arg)
{
    const struct content_of *now = arg;
    const struct client *client = client_find(now->painter, order->client);
    return !order->wish.always && client && client->has_content && client->content == now->content;
}

static void remember(struct painter *painter, const struct batch *batch, uint64_t content)
{
    pthread_mutex_lock(&painter->lock);
    for (size_t i = 0; i < batch->count; i++) {
        struct client *client = client_find(painter, batch->orders[i].client);
        if (client) {
            client->has_content = true;
            client->content = content;
        }
    }
    pthread_mutex_unlock(&painter->lock);
}

/* Answers those for whom nothing changed, and takes them out of the batch. */
static void leave_out_same(struct drawing *drawing, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    struct content_of now = { .painter = painter };
    now.content = renderer_content(drawing->renderer, &batch->orders[0].wish.view, drawing->snapshot);
    pthread_mutex_lock(&painter->lock);
    batch_split(batch, has_it, &now, &drawing->same);
    pthread_mutex_unlock(&painter->lock);
    counter_inc(painter->same, (int64_t)drawing->same.count);
    post(painter, &drawing->same, NULL, false);
}

static void fail(struct drawing *drawing, const struct batch *batch)
{
    counter_inc(drawing->painter->failures, 1);
    post(drawing->painter, batch, NULL, true);
}

/* Takes the frame. */
static void deliver(struct drawing *drawing, struct frame *frame, const struct snapshot *snapshot, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    if (batch->orders[0].wish.overlay)
        overlay_draw(frame, painter->params.scene, snapshot);
    counter_inc(painter->renders, 1);
    counter_inc(painter->render_us, (frame->render_ns + frame->readback_ns) / 1000);
    remember(painter, batch, frame->content);
    encoding_submit(painter->encoding, frame, batch);
    frame_unref(&frame);
}

/* --- pictures that take long -------------------------------------------------------------------------------------------------- */

static void slow_begin(struct drawing *drawing, struct batch *batch, int64_t field_ns)
{
    const struct wish *wish = &batch->orders[0].wish;
    drawing->slow.stroke = renderer_begin(drawing->renderer, &wish->view, drawing->snapshot);
    if (!drawing->slow.stroke) {
        fail(drawing, batch);
        return;
    }
    drawing->slow.urgency = wish->urgency;
    drawing->slow.asked_ns = wish->asked_ns;
    drawing->slow.field_ns = field_ns;
    struct batch empty = drawing->slow.batch;
    drawing->slow.batch = *batch;
    *batch = empty;
    batch->count = 0;
    struct snapshot *other = drawing->slow.snapshot;
    drawing->slow.snapshot = drawing->snapshot;
    drawing->snapshot = other;
    store_snapshot(drawing->painter->params.store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
}

/* True: it is done. */
static bool slow_step(struct drawing *drawing)
{
    bool drawn = renderer_step(drawing->renderer, drawing->slow.stroke, STEP_NS);
    counter_inc(drawing->painter->steps, 1);
    if (!drawn)
        return false;
    struct frame *frame = renderer_end(drawing->renderer, &drawing->slow.stroke);
    if (frame) {
        frame->field_ns += drawing->slow.field_ns;
        deliver(drawing, frame, drawing->slow.snapshot, &drawing->slow.batch);
    } else {
        fail(drawing, &drawing->slow.batch);
    }
    drawing->slow.batch.count = 0;
    return true;
}

/* Under lock. */
static bool has_left(const struct order *order, void *arg)
{
    const struct client *client = client_find(arg, order->client);
    return !client || client->left || (client->pending && client->wish.urgency == URGENCY_INPUT);
}

/* Who moved on gets no more of it; when nobody is left it is given up. */
static void slow_leave(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    if (!drawing->slow.stroke)
        return;
    pthread_mutex_lock(&painter->lock);
    batch_split(&drawing->slow.batch, has_left, painter, &drawing->same);
    pthread_mutex_unlock(&painter->lock);
    post(painter, &drawing->same, NULL, false);
    if (drawing->slow.batch.count > 0)
        return;
    counter_inc(painter->abandoned, 1);
    renderer_abandon(drawing->renderer, &drawing->slow.stroke);
}

static void draw(struct drawing *drawing, struct batch *batch)
{
    int64_t field_begin_ns = clock_mono_ns();
    refresh(drawing);
    leave_out_same(drawing, batch);
    if (batch->count == 0)
        return;
    const struct wish *wish = &batch->orders[0].wish;
    int64_t field_ns = clock_mono_ns() - field_begin_ns; /* to know what changed, the field was brought up to date already */
    if (wish->urgency >= URGENCY_REFINE) {
        slow_begin(drawing, batch, field_ns);
        return;
    }
    struct frame *frame = renderer_draw(drawing->renderer, &wish->view, drawing->snapshot);
    if (!frame) {
        fail(drawing, batch);
        return;
    }
    frame->field_ns += field_ns;
    deliver(drawing, frame, drawing->snapshot, batch);
}

/* --- life of the render thread -------------------------------------------------------------------------------------------------- */

static bool drawing_init(struct drawing *drawing, struct painter *painter)
{
    const struct painter_params *params = &painter->params;
    *drawing = (struct drawing){ .painter = painter };
    drawing->gl = gl_create(params->log, params->gl, -1);
    if (!drawing->gl)
        return false;
    drawing->field = field_create(params->workers, params->scene);
    drawing->renderer = renderer_create(params->log, drawing->gl, params->scene, drawing->field);
    drawing->snapshot = snapshot_create(params->scene->plant->tag_count);
    drawing->slow.snapshot = snapshot_create(params->scene->plant->tag_count);
    store_snapshot(params->store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
    return drawing->renderer != NULL;
}

static void drawing_finish(struct drawing *drawing)
{
    if (drawing->renderer)
        renderer_abandon(drawing->renderer, &drawing->slow.stroke);
    batch_finish(&drawing->slow.batch);
    renderer_destroy(&drawing->renderer);
    field_destroy(&drawing->field);
    gl_destroy(&drawing->gl);
    snapshot_destroy(&drawing->snapshot);
    snapshot_destroy(&drawing->slow.snapshot);
    batch_finish(&drawing->same);
}

/* What only the first picture costs (shaders, baked light) is paid before anyone asks. */
static void warm_up(struct drawing *drawing)
{
    struct view view;
    view_default(drawing->painter->params.scene, 64, 36, &view);
    struct frame *frame = renderer_draw(drawing->renderer, &view, drawing->snapshot);
    if (frame)
        frame_unref(&frame);
}

static void turn(struct drawing *drawing, struct schedule *schedule, struct batch *batch)
{
    enum urgency urgency = batch->count > 0 ? batch->orders[0].wish.urgency : drawing->slow.urgency;
    bool done = true;
    slow_leave(drawing);
    if (batch->count > 0)
        draw(drawing, batch);
    else if (drawing->slow.stroke)
        done = slow_step(drawing);
    if (urgency >= URGENCY_REFINE)
        schedule_stepped(schedule);
    if (done && !(urgency >= URGENCY_REFINE && drawing->slow.stroke))
        schedule_done(schedule, urgency, clock_mono_ns());
}

static void *painter_main(void *arg)
{
    struct painter *painter = arg;
    struct drawing drawing;
    struct batch batch = { 0 };
    struct schedule schedule = { 0 };
    bool good = drawing_init(&drawing, painter);
    pthread_mutex_lock(&painter->lock);
    painter->state = good ? RUNNING : FAILED;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    if (good)
        warm_up(&drawing);
    while (next_batch(&drawing, &schedule, &batch))
        turn(&drawing, &schedule, &batch);
    batch_finish(&batch);
    drawing_finish(&drawing);
    return NULL;
}

/* --- wishes, from any thread ----------------------------------------------------------------------------------------------- */

/* The newer view stands; what made the older one urgent stays. */
static void replace(struct wish *old, const struct wish *wish)
{
    struct wish merged = *wish;
    merged.always |= old->always;
    if (old->urgency < merged.urgency)
        merged.urgency = old->urgency;
    if (old->asked_ns < merged.asked_ns)
        merged.asked_ns = old->asked_ns;
    *old = merged;
}

enum painter_answer painter_ask(struct painter *painter, uint64_t id, const struct wish *wish)
{
    enum painter_answer answer = PAINTER_ADDED;
    pthread_mutex_lock(&painter->lock);
    struct client *client = client_find(painter, id);
    if (client && client->pending) {
        replace(&client->wish, wish);
        answer = PAINTER_REPLACED;
    } else if (wish->only_replace) {
        if (client)
            client->left |= wish->urgency == URGENCY_INPUT;
        answer = PAINTER_REFUSED;
    } else {
        if (!client) {
            mem_grow(&painter->clients, &painter->client_capacity, painter->client_count + 1, sizeof(*painter->clients));
            client = &painter->clients[painter->client_count++];
            *client = (struct client){ .id = id };
        }
        client->wish = *wish;
        client->pending = true;
    }
    pthread_mutex_unlock(&painter->lock);
    return answer;
}

void painter_go(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
}

void painter_forget(struct painter *painter, uint64_t id)
{
    pthread_mutex_lock(&painter->lock);
    struct client *client = client_find(painter, id);
    if (client)
        *client = painter->clients[--painter->client_count];
    pthread_mutex_unlock(&painter->lock);
}

void painter_new_data(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->new_data = true;
    pthread_mutex_unlock(&painter->lock);
}

/* --- life ------------------------------------------------------------------------------------------------------------------ */

static bool thread_start(struct painter *painter)
{
    if (pthread_create(&painter->thread, NULL, painter_main, painter) != 0) {
        log_err(painter->params.log, "painter: no thread could be started");
        return false;
    }
    painter->has_thread = true;
    pthread_mutex_lock(&painter->lock);
    while (painter->state == STARTING)
        pthread_cond_wait(&painter->wake, &painter->lock);
    bool good = painter->state == RUNNING;
    pthread_mutex_unlock(&painter->lock);
    return good;
}

static void thread_stop(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->state = STOPPING;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    if (painter->has_thread)
        pthread_join(painter->thread, NULL);
}

static void add_counters(struct painter *painter, struct counters *counters)
{
    painter->renders = counters_add(counters, "plantcast_renders_total", "counter", "Pictures drawn.");
    painter->render_us = counters_add(counters, "plantcast_render_us_total", "counter", "Microseconds spent drawing.");
    painter->same = counters_add(counters, "plantcast_renders_saved_total", "counter", "Pictures not drawn: nothing had changed.");
    painter->failures = counters_add(counters, "plantcast_render_failures_total", "counter", "Pictures that could not be drawn.");
    painter->steps = counters_add(counters, "plantcast_render_steps_total", "counter", "Parts of pictures that take long.");
    painter->abandoned = counters_add(counters, "plantcast_renders_abandoned_total", "counter", "Pictures given up: nobody wanted them.");
}

static void init_wake(pthread_cond_t *wake)
{
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(wake, &attributes);
    pthread_condattr_destroy(&attributes);
}

struct painter *painter_create(const struct painter_params *params)
{
    struct painter *painter = mem_new(sizeof(*painter));
    painter->params = *params;
    painter->done_last = &painter->done;
    pthread_mutex_init(&painter->lock, NULL);
    init_wake(&painter->wake);
    add_counters(painter, params->counters);
    painter->encoding = encoding_create(&(struct encoding_params){
        .log = params->log, .workers = params->workers, .counters = params->counters, .done = on_encoded, .done_arg = painter });
    if (!thread_start(painter))
        painter_destroy(&painter);
    return painter;
}

void painter_destroy(struct painter **painter_ptr)
{
    struct painter *painter = *painter_ptr;
    if (!painter)
        return;
    thread_stop(painter);
    encoding_destroy(&painter->encoding);
    for (struct picture *picture = painter_collect(painter), *next; picture; picture = next) {
        next = picture->next;
        picture_destroy(&picture);
    }
    mem_free(painter->clients);
    pthread_cond_destroy(&painter->wake);
    pthread_mutex_destroy(&painter->lock);
    mem_free(painter);
    *painter_ptr = NULL;
}
