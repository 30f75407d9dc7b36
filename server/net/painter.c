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

static const int64_t SNAPSHOT_MAX_AGE_NS = 100 * NS_PER_MS; /* the clock in the picture, and ages, are no older than this */

struct client {
    uint64_t id, number;
    bool pending, has_content;
    struct wish wish;
    uint64_t content; /* of the last picture drawn for it */
};

struct painter {
    struct painter_params params;
    counter *renders, *render_us, *same, *failures;
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

/* Under lock. NULL: none before *wait_until_ns. */
static struct client *first_due(struct painter *painter, const struct schedule *schedule, int64_t *wait_until_ns)
{
    struct client *oldest[URGENCY_COUNT] = { NULL };
    int64_t asked_ns[URGENCY_COUNT];
    for (int i = 0; i < URGENCY_COUNT; i++)
        asked_ns[i] = INT64_MAX;
    for (size_t i = 0; i < painter->client_count; i++) {
        struct client *client = &painter->clients[i];
        enum urgency urgency = client->wish.urgency;
        if (client->pending && client->wish.asked_ns < asked_ns[urgency]) {
            oldest[urgency] = client;
            asked_ns[urgency] = client->wish.asked_ns;
        }
    }
    enum urgency urgency = schedule_choose(schedule, asked_ns, clock_mono_ns(), wait_until_ns);
    return urgency == URGENCY_COUNT ? NULL : oldest[urgency];
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

/* Under lock. */
static void begin(struct client *client, struct batch *batch, int64_t now_ns)
{
    client->pending = false;
    batch_add(batch,
              &(struct order){
                  .client = client->id, .number = ++client->number, .wish = client->wish, .wait_ns = now_ns - client->wish.view.input_ns });
}

/* Waits for work. False: stop. */
static bool next_batch(struct painter *painter, const struct schedule *schedule, struct batch *batch)
{
    int64_t wait_until_ns;
    pthread_mutex_lock(&painter->lock);
    struct client *first = NULL;
    while (painter->state == RUNNING && !(first = first_due(painter, schedule, &wait_until_ns)))
        wait_until(painter, wait_until_ns);
    bool running = painter->state == RUNNING;
    batch->count = 0;
    if (running) {
        int64_t now_ns = clock_mono_ns();
        begin(first, batch, now_ns);
        const struct wish *wish = &batch->orders[0].wish;
        for (size_t i = 0; i < painter->client_count && !wish->overlay; i++) {
            struct client *other = &painter->clients[i];
            if (other->pending && !other->wish.overlay && same_picture(&other->wish.view, &wish->view)) {
                begin(other, batch, now_ns);
                wish = &batch->orders[0].wish; /* the list may have moved */
            }
        }
    }
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

static void draw(struct drawing *drawing, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    int64_t field_begin_ns = clock_mono_ns();
    refresh(drawing);
    leave_out_same(drawing, batch);
    if (batch->count == 0)
        return;
    const struct wish *wish = &batch->orders[0].wish;
    int64_t begin_ns = clock_mono_ns();
    struct frame *frame = renderer_draw(drawing->renderer, &wish->view, drawing->snapshot);
    if (!frame) {
        counter_inc(painter->failures, 1);
        post(painter, batch, NULL, true);
        return;
    }
    frame->field_ns += begin_ns - field_begin_ns; /* to know what changed, the field was brought up to date already */
    if (wish->overlay)
        overlay_draw(frame, painter->params.scene, drawing->snapshot);
    counter_inc(painter->renders, 1);
    counter_inc(painter->render_us, (clock_mono_ns() - begin_ns) / 1000);
    remember(painter, batch, frame->content);
    encoding_submit(painter->encoding, frame, batch);
    frame_unref(&frame);
}

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
    store_snapshot(params->store, clock_mono_ns(), clock_utc_ns(), drawing->snapshot);
    return drawing->renderer != NULL;
}

static void drawing_finish(struct drawing *drawing)
{
    renderer_destroy(&drawing->renderer);
    field_destroy(&drawing->field);
    gl_destroy(&drawing->gl);
    snapshot_destroy(&drawing->snapshot);
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
    while (next_batch(painter, &schedule, &batch)) {
        enum urgency urgency = batch.orders[0].wish.urgency;
        draw(&drawing, &batch);
        schedule_done(&schedule, urgency, clock_mono_ns());
    }
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
