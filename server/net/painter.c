/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render thread and its way to the workers. */
#include "net/painter.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/names.h"
#include "render/overlay.h"
#include "render/renderer.h"

static const int64_t SNAPSHOT_MAX_AGE_NS = 100 * NS_PER_MS; /* the clock in the picture, and ages, are no older than this */

struct client {
    uint64_t id, number;
    bool pending, has_content;
    struct wish wish;
    uint64_t content; /* of the last picture drawn for it */
};

struct order { /* a wish that was begun */
    uint64_t client, number;
    struct wish wish;
    int64_t wait_ns;
    bool same;
};

struct batch { /* orders that one picture answers */
    struct order *orders;
    size_t count, capacity;
};

struct idle_encoder {
    enum wire_codec codec;
    struct encoder *encoder;
    struct idle_encoder *next;
};

struct painter {
    struct painter_params params;
    char gl_text[320];
    counter *renders, *render_us, *same, *encodes, *encode_us, *failures;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under lock */
    enum { STARTING, RUNNING, FAILED, STOPPING } state;
    bool new_data;
    struct client *clients;
    size_t client_count, client_capacity;
    struct picture *done, **done_last;
    struct idle_encoder *idle;
    int jobs; /* at the workers */
};

struct drawing { /* what only the render thread touches */
    struct painter *painter;
    struct gl *gl;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
};

struct encode_job {
    struct painter *painter;
    struct frame *frame;
    struct batch batch; /* all of one codec and quality */
};

/* --- pictures on their way back ------------------------------------------------------------------------------------------ */

static struct picture *picture_create(const struct order *order, struct packet *packet, bool failed)
{
    struct picture *picture = mem_new(sizeof(*picture));
    *picture = (struct picture){
        .client = order->client, .number = order->number, .packet = packet ? packet_ref(packet) : NULL, .failed = failed,
        .wish = order->wish, .wait_ns = order->wait_ns,
    };
    return picture;
}

/* Answers every order of the batch for which `same` is as given. */
static void post(struct painter *painter, const struct batch *batch, bool same, struct packet *packet, bool failed)
{
    bool was_empty = false, posted = false;
    for (size_t i = 0; i < batch->count; i++) {
        if (batch->orders[i].same != same)
            continue;
        struct picture *picture = picture_create(&batch->orders[i], packet, failed);
        pthread_mutex_lock(&painter->lock);
        was_empty |= painter->done == NULL;
        *painter->done_last = picture;
        painter->done_last = &picture->next;
        pthread_mutex_unlock(&painter->lock);
        posted = true;
    }
    if (posted && was_empty)
        painter->params.notify(painter->params.notify_arg);
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

/* --- encoding, on the workers ---------------------------------------------------------------------------------------------- */

static struct encoder *encoder_take(struct painter *painter, enum wire_codec codec)
{
    struct encoder *encoder = NULL;
    pthread_mutex_lock(&painter->lock);
    for (struct idle_encoder **at = &painter->idle; *at && !encoder; at = *at ? &(*at)->next : at) {
        struct idle_encoder *idle = *at;
        if (idle->codec != codec)
            continue;
        encoder = idle->encoder;
        *at = idle->next;
        mem_free(idle);
        break;
    }
    pthread_mutex_unlock(&painter->lock);
    return encoder ? encoder : encoder_create(painter->params.log, name_of(names_codec, (int)codec));
}

static void encoder_give(struct painter *painter, enum wire_codec codec, struct encoder *encoder)
{
    struct idle_encoder *idle = mem_new(sizeof(*idle));
    pthread_mutex_lock(&painter->lock);
    *idle = (struct idle_encoder){ .codec = codec, .encoder = encoder, .next = painter->idle };
    painter->idle = idle;
    pthread_mutex_unlock(&painter->lock);
}

static void encode(void *arg)
{
    struct encode_job *job = arg;
    struct painter *painter = job->painter;
    const struct wish *wish = &job->batch.orders[0].wish;
    struct packet *packet = NULL;
    struct encoder *encoder = encoder_take(painter, wish->codec);
    if (encoder && encoder_send(encoder, job->frame, &wish->quality) == 0 && encoder_receive(encoder, &packet) == 0) {
        counter_inc(painter->encodes, 1);
        counter_inc(painter->encode_us, packet->encode_ns / 1000);
    } else {
        counter_inc(painter->failures, 1);
    }
    if (encoder)
        encoder_give(painter, wish->codec, encoder);
    frame_unref(&job->frame);
    post(painter, &job->batch, false, packet, !packet);
    packet_unref(&packet);
    mem_free(job->batch.orders);
    mem_free(job);
    pthread_mutex_lock(&painter->lock);
    painter->jobs--;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
}

static void batch_add(struct batch *batch, const struct order *order)
{
    mem_grow(&batch->orders, &batch->capacity, batch->count + 1, sizeof(*batch->orders));
    batch->orders[batch->count++] = *order;
}

static bool same_coding(const struct wish *a, const struct wish *b)
{
    return a->codec == b->codec && a->quality.quality == b->quality.quality && a->quality.full_chroma == b->quality.full_chroma;
}

/* One job for each codec and quality in the batch. */
static void submit(struct painter *painter, struct frame *frame, struct batch *batch)
{
    for (size_t i = 0; i < batch->count; i++) {
        if (batch->orders[i].same)
            continue;
        struct encode_job *job = mem_new(sizeof(*job));
        *job = (struct encode_job){ .painter = painter, .frame = frame_ref(frame) };
        for (size_t k = i; k < batch->count; k++)
            if (!batch->orders[k].same && same_coding(&batch->orders[i].wish, &batch->orders[k].wish)) {
                batch_add(&job->batch, &batch->orders[k]);
                batch->orders[k].same = k > i; /* taken */
            }
        batch->orders[i].same = true;
        pthread_mutex_lock(&painter->lock);
        painter->jobs++;
        pthread_mutex_unlock(&painter->lock);
        workers_submit(painter->params.workers, encode, job);
    }
}

/* --- drawing, on the render thread ----------------------------------------------------------------------------------------- */

static bool same_vector(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool same_camera(const struct camera *a, const struct camera *b)
{
    return same_vector(a->eye_m, b->eye_m) && same_vector(a->target_m, b->target_m) && same_vector(a->up, b->up) && a->fov_deg == b->fov_deg;
}

static bool same_picture(const struct view *a, const struct view *b)
{
    return a->width_px == b->width_px && a->height_px == b->height_px && same_camera(&a->camera, &b->camera) &&
           field_params_equal(&a->field, &b->field) && a->colormap == b->colormap && a->ramp_interval == b->ramp_interval &&
           a->range_min == b->range_min && a->range_max == b->range_max && a->look == b->look && a->tier == b->tier &&
           a->selected_asset == b->selected_asset && same_vector(a->light_dir, b->light_dir);
}

/* Under lock. */
static struct client *first_due(struct painter *painter)
{
    struct client *first = NULL;
    int64_t first_ns = INT64_MAX;
    for (size_t i = 0; i < painter->client_count; i++) {
        struct client *client = &painter->clients[i];
        int64_t due_ns = schedule_due_ns(client->wish.urgency, client->wish.asked_ns);
        if (client->pending && due_ns < first_ns) {
            first = client;
            first_ns = due_ns;
        }
    }
    return first;
}

/* Under lock. */
static void begin(struct client *client, struct batch *batch, int64_t now_ns)
{
    client->pending = false;
    batch_add(batch, &(struct order){ .client = client->id, .number = ++client->number, .wish = client->wish,
                                      .wait_ns = now_ns - client->wish.view.input_ns });
}

/* Waits for work. False: stop. */
static bool next_batch(struct painter *painter, struct batch *batch)
{
    pthread_mutex_lock(&painter->lock);
    struct client *first = NULL;
    while (painter->state == RUNNING && !(first = first_due(painter)))
        pthread_cond_wait(&painter->wake, &painter->lock);
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

/* Marks the orders whose client has this picture already. True: at least one has not. */
static bool someone_needs(struct painter *painter, struct batch *batch, uint64_t content)
{
    bool needed = false;
    pthread_mutex_lock(&painter->lock);
    for (size_t i = 0; i < batch->count; i++) {
        struct order *order = &batch->orders[i];
        for (size_t k = 0; k < painter->client_count && !order->wish.always; k++)
            if (painter->clients[k].id == order->client)
                order->same = painter->clients[k].has_content && painter->clients[k].content == content;
        needed |= !order->same;
    }
    pthread_mutex_unlock(&painter->lock);
    return needed;
}

static void remember(struct painter *painter, const struct batch *batch, uint64_t content)
{
    pthread_mutex_lock(&painter->lock);
    for (size_t i = 0; i < batch->count; i++)
        for (size_t k = 0; k < painter->client_count; k++)
            if (painter->clients[k].id == batch->orders[i].client) {
                painter->clients[k].has_content = true;
                painter->clients[k].content = content;
            }
    pthread_mutex_unlock(&painter->lock);
}

static void draw(struct drawing *drawing, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    const struct wish *wish = &batch->orders[0].wish;
    refresh(drawing);
    uint64_t content = renderer_content(drawing->renderer, &wish->view, drawing->snapshot);
    bool needed = someone_needs(painter, batch, content);
    post(painter, batch, true, NULL, false);
    if (!needed) {
        counter_inc(painter->same, 1);
        return;
    }
    int64_t begin_ns = clock_mono_ns();
    struct frame *frame = renderer_draw(drawing->renderer, &wish->view, drawing->snapshot);
    if (!frame) {
        counter_inc(painter->failures, 1);
        post(painter, batch, false, NULL, true);
        return;
    }
    if (wish->overlay)
        overlay_draw(frame, painter->params.scene, drawing->snapshot);
    counter_inc(painter->renders, 1);
    counter_inc(painter->render_us, (clock_mono_ns() - begin_ns) / 1000);
    remember(painter, batch, frame->content);
    submit(painter, frame, batch);
    frame_unref(&frame);
}

static bool drawing_init(struct drawing *drawing, struct painter *painter)
{
    const struct painter_params *params = &painter->params;
    *drawing = (struct drawing){ .painter = painter };
    drawing->gl = gl_create(params->log, params->gl, -1);
    if (!drawing->gl)
        return false;
    snprintf(painter->gl_text, sizeof(painter->gl_text), "%s: %s, %s", gl_kind_name(drawing->gl->kind), drawing->gl->renderer,
             drawing->gl->version);
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
}

static void *painter_main(void *arg)
{
    struct painter *painter = arg;
    struct drawing drawing;
    struct batch batch = { 0 };
    bool good = drawing_init(&drawing, painter);
    pthread_mutex_lock(&painter->lock);
    painter->state = good ? RUNNING : FAILED;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    while (next_batch(painter, &batch))
        draw(&drawing, &batch);
    mem_free(batch.orders);
    drawing_finish(&drawing);
    return NULL;
}

/* --- wishes, from any thread ----------------------------------------------------------------------------------------------- */

/* Under lock. NULL: none. */
static struct client *client_find(struct painter *painter, uint64_t id)
{
    for (size_t i = 0; i < painter->client_count; i++)
        if (painter->clients[i].id == id)
            return &painter->clients[i];
    return NULL;
}

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
        pthread_cond_broadcast(&painter->wake);
    }
    pthread_mutex_unlock(&painter->lock);
    return answer;
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

struct painter *painter_create(const struct painter_params *params)
{
    struct painter *painter = mem_new(sizeof(*painter));
    painter->params = *params;
    painter->done_last = &painter->done;
    pthread_mutex_init(&painter->lock, NULL);
    pthread_cond_init(&painter->wake, NULL);
    painter->renders = counters_add(params->counters, "plantcast_renders_total", "counter", "Pictures drawn.");
    painter->render_us = counters_add(params->counters, "plantcast_render_us_total", "counter", "Microseconds spent drawing.");
    painter->same = counters_add(params->counters, "plantcast_renders_saved_total", "counter", "Pictures not drawn: nothing had changed.");
    painter->encodes = counters_add(params->counters, "plantcast_encodes_total", "counter", "Pictures encoded.");
    painter->encode_us = counters_add(params->counters, "plantcast_encode_us_total", "counter", "Microseconds spent encoding.");
    painter->failures = counters_add(params->counters, "plantcast_picture_failures_total", "counter", "Pictures that could not be made.");
    if (pthread_create(&painter->thread, NULL, painter_main, painter) != 0) {
        log_err(params->log, "painter: no thread could be started");
        painter->state = FAILED;
        goto error;
    }
    pthread_mutex_lock(&painter->lock);
    while (painter->state == STARTING)
        pthread_cond_wait(&painter->wake, &painter->lock);
    bool good = painter->state == RUNNING;
    pthread_mutex_unlock(&painter->lock);
    if (good)
        return painter;
    pthread_join(painter->thread, NULL);
error:
    pthread_cond_destroy(&painter->wake);
    pthread_mutex_destroy(&painter->lock);
    mem_free(painter);
    return NULL;
}

void painter_destroy(struct painter **painter_ptr)
{
    struct painter *painter = *painter_ptr;
    if (!painter)
        return;
    pthread_mutex_lock(&painter->lock);
    painter->state = STOPPING;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    pthread_join(painter->thread, NULL);
    pthread_mutex_lock(&painter->lock);
    while (painter->jobs > 0)
        pthread_cond_wait(&painter->wake, &painter->lock);
    pthread_mutex_unlock(&painter->lock);
    for (struct picture *picture = painter_collect(painter), *next; picture; picture = next) {
        next = picture->next;
        picture_destroy(&picture);
    }
    for (struct idle_encoder *idle = painter->idle, *next; idle; idle = next) {
        next = idle->next;
        encoder_destroy(&idle->encoder);
        mem_free(idle);
    }
    mem_free(painter->clients);
    pthread_cond_destroy(&painter->wake);
    pthread_mutex_destroy(&painter->lock);
    mem_free(painter);
    *painter_ptr = NULL;
}

const char *painter_gl_text(const struct painter *painter)
{
    return painter->gl_text;
}
