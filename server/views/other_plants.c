/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that requests pictures of other plants from their servers. A picture's age is counted from the time of the
   request, so it includes the time that the server took to draw it. */
#include "views/other_plants.h"

#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/clock.h"
#include "base/files/secret.h"
#include "base/mem.h"
#include "base/system/http_request.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "views/other_picture.h"

enum { CONNECT_S = 5, TIMEOUT_S = 10, PICTURE_BYTES = 8 << 20, HEADER_BYTES = 1024, MIN_RETRY_S = 5, MAX_RETRY_S = 60, REST_MS = 60000 };
static const int64_t WANTED_NS = 30 * NS_PER_S;

/* reasons why there is no picture of another plant; clients receive the reason's name, and the log receives the details */
enum why { WHY_NONE, WHY_WAITING, WHY_UNREACHABLE, WHY_TLS, WHY_TOKEN, WHY_REFUSED, WHY_BUSY, WHY_SLOW, WHY_LARGE, WHY_NO_PICTURE };
static const char *const why_names[] = { [WHY_NONE] = "",
                                         [WHY_WAITING] = "waiting",
                                         [WHY_UNREACHABLE] = "unreachable",
                                         [WHY_TLS] = "tls",
                                         [WHY_TOKEN] = "token",
                                         [WHY_REFUSED] = "refused",
                                         [WHY_BUSY] = "busy",
                                         [WHY_SLOW] = "slow",
                                         [WHY_LARGE] = "large",
                                         [WHY_NO_PICTURE] = "no_picture" };

struct other {
    const struct other_plant *plant;
    struct http_request request; /* request for the picture; its `answer` receives the picture */
    char header[HEADER_BYTES];   /* header Plantcast-Frame of the answer */
    /* times of the next request (due) and of the newest one (begun); _ns: monotonic, _us: by the clock of the plant */
    int64_t due_ns, begun_ns, begun_us;
    bool running, failing;
    /* --- below: under `lock` */
    int64_t wanted_ns; /* monotonic time when a client last requested this plant's picture; 0: never */
    struct other_picture about;
    char *png; /* picture of the other plant as PNG; NULL: none */
    size_t bytes;
    /* times at which the request that returned the present picture began: asked_ns by the monotonic clock, asked_us by the clock
       of the plant shown here. asked_us is also the picture's id for pages; 0: there is no picture */
    int64_t asked_ns, asked_us;
    /* time, by the clock of the plant shown here, of the request that returned the last good picture. Before there is one: time
       at which displays began to want the picture */
    int64_t since_us;
    enum why why; /* reason why there is no picture; WHY_NONE: there is one */
};

struct other_plants {
    struct log *log;
    const struct plant_clock *clock;
    pthread_t thread;
    bool started;
    _Atomic bool stopping;
    CURLM *multi;
    struct other *at;
    size_t count;
    pthread_mutex_t lock;
};

/* --- one request ------------------------------------------------------------------------------------------------------------ */

static size_t take_header(char *bytes, size_t size, size_t count, void *arg)
{
    static const char name[] = "plantcast-frame:";
    struct other *other = arg;
    if (size * count > sizeof(name) && !strncasecmp(bytes, name, sizeof(name) - 1))
        snprintf(other->header, sizeof(other->header), "%.*s", (int)(size * count - sizeof(name)), bytes + sizeof(name));
    return size * count;
}

static bool make_request(struct other *other)
{
    const struct other_plant *plant = other->plant;
    other->request.most_bytes = PICTURE_BYTES;
    if (!http_request_make(&other->request, "plantcastd", plant->ca_file))
        return false;
    CURL *handle = other->request.handle;
    bool slash = plant->url[strlen(plant->url) - 1] == '/';
    char *url = mem_printf("%s%ssnapshot.png?width=%d&height=%d%s%s", plant->url, slash ? "" : "/", plant->width_px, plant->height_px,
                           plant->view ? "&view=" : "", plant->view ? plant->view : "");
    curl_easy_setopt(handle, CURLOPT_URL, url);
    mem_free(url);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(handle, CURLOPT_TIMEOUT, (long)TIMEOUT_S);
    curl_easy_setopt(handle, CURLOPT_MAXFILESIZE, (long)PICTURE_BYTES);
    curl_easy_setopt(handle, CURLOPT_HEADERFUNCTION, take_header);
    curl_easy_setopt(handle, CURLOPT_HEADERDATA, other);
    curl_easy_setopt(handle, CURLOPT_PRIVATE, (void *)other);
    return true;
}

/* Reads the token file and sets the token of the request. Returns NULL, or an error text that the caller frees (mem_free). */
static char *set_token(struct other *other)
{
    char *why = NULL, *token = other->plant->token_file ? secret_read(other->plant->token_file, &why) : NULL;
    http_request_authorize(&other->request, "Bearer ", token);
    secret_forget(token);
    return why;
}

static enum why why_of(CURLcode code)
{
    switch (code) {
    case CURLE_OK: return WHY_NONE;
    case CURLE_OPERATION_TIMEDOUT: return WHY_SLOW;
    case CURLE_WRITE_ERROR: /* the answer is too long */
    case CURLE_FILESIZE_EXCEEDED: return WHY_LARGE;
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_SSL_CONNECT_ERROR: return WHY_TLS;
    default: return WHY_UNREACHABLE;
    }
}

static enum why why_of_status(long status)
{
    return status == 200                    ? WHY_NONE
           : status == 401 || status == 403 ? WHY_REFUSED
           : status == 429 || status == 503 ? WHY_BUSY
                                            : WHY_NO_PICTURE;
}

/* Checks a complete answer. Returns WHY_NONE if it is a valid picture, else the reason to reject it, with a description for the log. */
static enum why judge(struct other *other, struct other_picture *about, char said[160])
{
    const struct other_plant *plant = other->plant;
    const struct text *body = &other->request.answer;
    const char *text = body->at ? body->at : "";
    long status = 0;
    curl_easy_getinfo(other->request.handle, CURLINFO_RESPONSE_CODE, &status);
    enum why why = why_of_status(status);
    if (why != WHY_NONE) {
        snprintf(said, 160, "the server answered with HTTP status %ld: %.*s", status, (int)strcspn(text, "\r\n"), text);
    } else if (!other_picture_read_header(other->header, about)) {
        snprintf(said, 160, "the answer has no header with the age of readings: the server is not a Plantcast server");
        why = WHY_NO_PICTURE;
    } else if (about->past) {
        snprintf(said, 160, "the picture shows a time in the past: remove `at` from view %s of that plant", plant->view ? plant->view : "");
        why = WHY_NO_PICTURE;
    } else if (!other_picture_is_png((const uint8_t *)text, body->length, plant->width_px, plant->height_px)) {
        snprintf(said, 160, "the answer is not a PNG file of %d x %d", plant->width_px, plant->height_px);
        why = WHY_NO_PICTURE;
    }
    return why;
}

/* Records a failed request. If the server is only busy or slow, its last picture is shown until it is too old. */
static void note_failure(struct other_plants *others, struct other *other, enum why why, const char *said)
{
    pthread_mutex_lock(&others->lock);
    if (why != WHY_BUSY && why != WHY_SLOW) {
        mem_free(other->png);
        other->png = NULL;
    }
    other->why = why;
    pthread_mutex_unlock(&others->lock);
    if (!other->failing)
        log_warn(others->log, "plant %s: no picture from %s: %s", other->plant->id, other->plant->url, said);
    other->failing = true;
}

static void note_picture(struct other_plants *others, struct other *other, const struct other_picture *about)
{
    pthread_mutex_lock(&others->lock);
    mem_free(other->png);
    other->png = other->request.answer.at;
    other->bytes = other->request.answer.length;
    other->about = *about;
    other->asked_ns = other->begun_ns;
    other->asked_us = other->since_us = other->begun_us;
    other->why = WHY_NONE;
    pthread_mutex_unlock(&others->lock);
    other->request.answer = (struct text){ 0 };
    if (other->failing)
        log_info(others->log, "plant %s: receiving pictures again", other->plant->id);
    other->failing = false;
}

/* Sets the time of the next request to another plant: one interval after the last request began, or later if that plant's server states
   Retry-After. */
static void rest(struct other *other, bool good)
{
    curl_off_t pause_s = 1;
    int64_t next_ns = other->begun_ns + (int64_t)(other->plant->every_s * 1e9);
    if (!good) {
        curl_easy_getinfo(other->request.handle, CURLINFO_RETRY_AFTER, &pause_s);
        pause_s = pause_s < MIN_RETRY_S ? MIN_RETRY_S : pause_s > MAX_RETRY_S ? MAX_RETRY_S : pause_s;
    }
    int64_t least_ns = clock_mono_ns() + pause_s * NS_PER_S;
    other->due_ns = next_ns > least_ns ? next_ns : least_ns;
}

static void on_end(void *arg, void *ended, CURLcode code)
{
    struct other_plants *others = arg;
    struct other *other = ended;
    struct other_picture about;
    char said[CURL_ERROR_SIZE + 160];
    enum why why = why_of(code);
    snprintf(said, sizeof(said), "%s", http_request_why(&other->request, code));
    if (why == WHY_LARGE)
        snprintf(said, sizeof(said), "the answer has more than %d bytes", PICTURE_BYTES);
    if (why == WHY_NONE)
        why = judge(other, &about, said);
    if (why == WHY_NONE)
        note_picture(others, other, &about);
    else
        note_failure(others, other, why, said);
    text_finish(&other->request.answer);
    rest(other, why == WHY_NONE);
    other->running = false;
}

static void begin(struct other_plants *others, struct other *other)
{
    other->begun_ns = clock_mono_ns();
    other->begun_us = clock_plant_ns(others->clock) / 1000;
    other->request.error[0] = other->header[0] = 0;
    if (!other->request.handle && !make_request(other)) {
        note_failure(others, other, WHY_UNREACHABLE, "out of memory");
        rest(other, false);
        return;
    }
    char *why = set_token(other);
    if (why) {
        note_failure(others, other, WHY_TOKEN, why);
        rest(other, false);
        mem_free(why);
        return;
    }
    other->running = true;
    curl_multi_add_handle(others->multi, other->request.handle);
}

/* --- the thread ------------------------------------------------------------------------------------------------------------- */

/* Begins all requests that are due. Returns the number of milliseconds until the next one is due. */
static int begin_due(struct other_plants *others)
{
    int64_t now_ns = clock_mono_ns(), next_ns = now_ns + REST_MS * NS_PER_MS;
    for (size_t i = 0; i < others->count; i++) {
        struct other *other = &others->at[i];
        pthread_mutex_lock(&others->lock);
        bool wanted = other->wanted_ns && now_ns - other->wanted_ns < WANTED_NS;
        /* drops the picture and stops requesting it, because no display has asked for it lately */
        if (!wanted && other->wanted_ns && !other->running) {
            mem_free(other->png);
            other->png = NULL;
            other->wanted_ns = other->asked_us = 0;
        }
        pthread_mutex_unlock(&others->lock);
        if (!wanted || other->running)
            continue;
        if (other->due_ns <= now_ns)
            begin(others, other);
        if (!other->running && other->due_ns < next_ns)
            next_ns = other->due_ns;
    }
    return (int)((next_ns - now_ns) / NS_PER_MS) + 1;
}

static void *other_plants_main(void *arg)
{
    struct other_plants *others = arg;
    while (!atomic_load(&others->stopping))
        http_requests_wait(others->multi, begin_due(others), on_end, others);
    return NULL;
}

/* --- messages to displays ------------------------------------------------------------------------------------------------------ */

static bool is_shown(const struct other *other, int64_t now_ns)
{
    return other->png && now_ns - other->asked_ns <= (int64_t)(other->plant->every_s * 1e9) + TIMEOUT_S * NS_PER_S;
}

static json_t *state_of(const struct other *other, int64_t now_ns)
{
    bool shown = is_shown(other, now_ns), aged = shown && other->about.oldest_age_ms >= 0;
    enum why why = shown ? WHY_NONE : other->why == WHY_NONE ? WHY_SLOW : other->why;
    json_int_t age_ms = aged ? other->about.oldest_age_ms + (now_ns - other->asked_ns) / NS_PER_MS : 0;
    return json_pack("{s:s,s:o,s:I,s:o,s:I,s:s}", "id", other->plant->id, "name",
                     other->about.name[0] ? json_string(other->about.name) : json_null(), "picture",
                     (json_int_t)(shown ? other->asked_us : 0), "age_ms", aged ? json_integer(age_ms) : json_null(), "since_us",
                     (json_int_t)other->since_us, "why", why_names[why]);
}

char *other_plants_text(struct other_plants *others, const int *which, size_t count, int64_t now_ns)
{
    json_t *list = json_array();
    bool wakes = false;
    pthread_mutex_lock(&others->lock);
    for (size_t i = 0; i < count; i++) {
        struct other *other = &others->at[which[i]];
        if (!other->wanted_ns) { /* records the time of the first request after a period when no display wanted the picture */
            other->why = WHY_WAITING;
            other->since_us = clock_plant_ns(others->clock) / 1000;
            wakes = true;
        }
        other->wanted_ns = now_ns;
        json_array_append_new(list, state_of(other, now_ns));
    }
    pthread_mutex_unlock(&others->lock);
    if (wakes)
        curl_multi_wakeup(others->multi);
    return json_text(json_pack("{s:o}", "list", list), 0);
}

char *other_plants_picture(struct other_plants *others, int which, int64_t number, int64_t now_ns, size_t *bytes)
{
    const struct other *other = &others->at[which];
    char *copy = NULL;
    pthread_mutex_lock(&others->lock);
    if (is_shown(other, now_ns) && other->asked_us == number) {
        *bytes = other->bytes;
        copy = memcpy(mem_array(other->bytes, 1), other->png, other->bytes);
    }
    pthread_mutex_unlock(&others->lock);
    return copy;
}

/* --- start and stop --------------------------------------------------------------------------------------------------------- */

struct other_plants *other_plants_start(struct log *log, const struct plant *plant, const struct plant_clock *clock)
{
    struct other_plants *others = mem_new(sizeof(*others));
    others->log = log;
    others->clock = clock;
    others->count = plant->screens.other_plant_count;
    others->at = mem_array(others->count, sizeof(*others->at));
    pthread_mutex_init(&others->lock, NULL);
    for (size_t i = 0; i < others->count; i++)
        others->at[i].plant = &plant->screens.other_plants[i];
    bool usable = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK && (others->multi = curl_multi_init());
    others->started = usable && pthread_create(&others->thread, NULL, other_plants_main, others) == 0;
    if (!others->started) {
        log_err(log, "pictures of other plants cannot be requested: %s", usable ? "a thread cannot be started" : "libcurl cannot be used");
        other_plants_stop(&others);
    }
    return others;
}

void other_plants_stop(struct other_plants **pointer)
{
    struct other_plants *others = *pointer;
    if (!others)
        return;
    atomic_store(&others->stopping, true);
    if (others->started) {
        curl_multi_wakeup(others->multi);
        pthread_join(others->thread, NULL);
    }
    for (size_t i = 0; i < others->count; i++) {
        struct other *other = &others->at[i];
        if (other->running)
            curl_multi_remove_handle(others->multi, other->request.handle);
        http_request_finish(&other->request);
        mem_free(other->png);
    }
    curl_multi_cleanup(others->multi);
    pthread_mutex_destroy(&others->lock);
    mem_free(others->at);
    mem_free(others);
    *pointer = NULL;
}
