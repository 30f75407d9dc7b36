/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests of WHEP, each reader's place, and who may. */
#include "whep.h"

#include <string.h>

#include "readers.h"
#include "refusal.h"
#include "whep_session.h"

enum { MOST_BYTES = 64 * 1024, ID_BYTES = 16 };
static const char PATH[] = "/whep", TYPE[] = "application/sdp", RETRY_S[] = "5";

struct place {
    struct whep *whep;
    struct whep_session *session;
    SoupServerMessage *message; /* that waits for the answer; NULL: it has it */
    char id[2 * ID_BYTES + 1];
};

struct whep {
    const struct options *options;
    struct outputs *outputs;
    GPtrArray *places;
    GThreadPool *enders; /* of sessions, which may take a while: whoever else watches does not wait for it */
    gint ending;         /* atomic: how many have not ended yet */
};

static void answer(SoupServerMessage *message, guint status, const char *text)
{
    soup_server_message_set_status(message, status, NULL);
    soup_server_message_set_response(message, "text/plain; charset=utf-8", SOUP_MEMORY_COPY, text, strlen(text));
}

/* What may go another time. */
static void put_off(SoupServerMessage *message, const char *text)
{
    soup_message_headers_replace(soup_server_message_get_response_headers(message), "Retry-After", RETRY_S);
    answer(message, SOUP_STATUS_SERVICE_UNAVAILABLE, text);
}

static void refuse(SoupServerMessage *message, enum whep_fault fault, const char *text)
{
    if (fault == WHEP_BUSY)
        put_off(message, text);
    else
        answer(message, fault == WHEP_BAD_OFFER ? SOUP_STATUS_BAD_REQUEST : SOUP_STATUS_NOT_IMPLEMENTED, text);
}

/* A thread of whep->enders. */
static void end_session(gpointer data, gpointer user)
{
    struct whep_session *session = data;
    struct whep *whep = user;
    whep_session_destroy(&session);
    g_atomic_int_add(&whep->ending, -1);
}

static void place_free(gpointer data)
{
    struct place *place = data;
    if (place->message) {
        g_signal_handlers_disconnect_by_data(place->message, place);
        put_off(place->message, "this ends\n");
        soup_server_message_unpause(place->message);
        g_object_unref(place->message);
    }
    whep_session_leave(place->session);
    g_atomic_int_inc(&place->whep->ending);
    g_thread_pool_push(place->whep->enders, place->session, NULL);
    g_free(place);
}

/* --- who may ------------------------------------------------------------------------------------------------------------------ */

static bool is_basic(const struct options *options, SoupServerMessage *message, const char *code)
{
    gsize count = 0;
    guchar *bytes = g_base64_decode(code, &count);
    char *user = g_strndup((const char *)bytes, count), *colon = strchr(user, ':');
    if (colon)
        *colon = 0;
    bool good = colon && reader_may(options, message, user, colon + 1);
    g_free(bytes);
    g_free(user);
    return good;
}

static bool may(const struct options *options, SoupServerMessage *message)
{
    const char *said = soup_message_headers_get_one(soup_server_message_get_request_headers(message), "Authorization");
    if (!options->user)
        return true;
    if (said && !g_ascii_strncasecmp(said, "Bearer ", 7) && reader_may(options, message, NULL, said + 7))
        return true;
    if (said && !g_ascii_strncasecmp(said, "Basic ", 6) && is_basic(options, message, said + 6))
        return true;
    soup_message_headers_replace(soup_server_message_get_response_headers(message), "WWW-Authenticate", "Bearer");
    answer(message, SOUP_STATUS_UNAUTHORIZED, "a bearer token is needed: the password of --readers-file\n");
    return false;
}

/* A page of any other server may play this, if whoever opens it has the token. */
static void allow_pages(SoupServerMessage *message)
{
    SoupMessageHeaders *headers = soup_server_message_get_response_headers(message);
    soup_message_headers_replace(headers, "Access-Control-Allow-Origin", "*");
    soup_message_headers_replace(headers, "Access-Control-Allow-Methods", "POST, DELETE, OPTIONS");
    soup_message_headers_replace(headers, "Access-Control-Allow-Headers", "Authorization, Content-Type");
    soup_message_headers_replace(headers, "Access-Control-Expose-Headers", "Location, Retry-After");
    soup_message_headers_replace(headers, "Cache-Control", "no-store");
}

/* --- requests ------------------------------------------------------------------------------------------------------------------ */

/* Who asked went away before the answer. */
static void on_disconnected(SoupServerMessage *message, struct place *place)
{
    if (place->message == message) {
        g_clear_object(&place->message);
        g_ptr_array_remove_fast(place->whep->places, place);
    }
}

static void on_answered(struct whep_session *session, const char *sdp, enum whep_fault fault, void *data)
{
    struct place *place = data;
    SoupServerMessage *message = g_steal_pointer(&place->message);
    (void)session;
    g_signal_handlers_disconnect_by_data(message, place);
    if (sdp) {
        char *location = g_strdup_printf("%s/%s", PATH, place->id);
        soup_message_headers_replace(soup_server_message_get_response_headers(message), "Location", location);
        soup_server_message_set_status(message, SOUP_STATUS_CREATED, NULL);
        soup_server_message_set_response(message, TYPE, SOUP_MEMORY_COPY, sdp, strlen(sdp));
        g_free(location);
    } else {
        refuse(message, fault, fault == WHEP_BAD_OFFER ? "the offer cannot be answered\n" : "busy, offer it again\n");
        g_ptr_array_remove_fast(place->whep->places, place);
    }
    soup_server_message_unpause(message);
    g_object_unref(message);
}

/* Not to be guessed: it is all that is needed to end a stream. */
static void make_id(char id[2 * ID_BYTES + 1])
{
    char *text = g_uuid_string_random();
    int n = 0;
    for (const char *at = text; *at && n < 2 * ID_BYTES; at++)
        if (*at != '-')
            id[n++] = *at;
    id[n] = 0;
    g_free(text);
}

static void post(struct whep *whep, SoupServerMessage *message)
{
    SoupMessageBody *body = soup_server_message_get_request_body(message);
    const char *type = soup_message_headers_get_content_type(soup_server_message_get_request_headers(message), NULL), *why = NULL;
    if (g_strcmp0(type, TYPE) != 0) {
        answer(message, SOUP_STATUS_UNSUPPORTED_MEDIA_TYPE, "an offer is expected, as application/sdp\n");
        return;
    }
    if (whep->places->len >= (guint)whep->options->most_readers ||
        g_atomic_int_get(&whep->ending) >= whep->options->most_readers) {
        put_off(message, "too many are reading\n");
        return;
    }
    GBytes *bytes = soup_message_body_flatten(body);
    char *offer = g_strndup(g_bytes_get_data(bytes, NULL), g_bytes_get_size(bytes));
    struct place *place = g_new0(struct place, 1);
    enum whep_fault fault = WHEP_UNABLE;
    place->whep = whep;
    make_id(place->id);
    place->session = whep_session_create(whep->options, whep->outputs, offer, on_answered, place, &fault, &why);
    if (place->session) {
        place->message = g_object_ref(message);
        g_signal_connect(message, "disconnected", G_CALLBACK(on_disconnected), place);
        soup_server_message_pause(message);
        g_ptr_array_add(whep->places, place);
    } else {
        char *text = g_strconcat(why, "\n", NULL);
        refuse(message, fault, text);
        g_free(text);
        g_free(place);
    }
    g_free(offer);
    g_bytes_unref(bytes);
}

static bool end_place(struct whep *whep, const char *id)
{
    for (guint i = 0; i < whep->places->len; i++) {
        const struct place *place = g_ptr_array_index(whep->places, i);
        if (!strcmp(place->id, id)) {
            g_ptr_array_remove_index_fast(whep->places, i);
            return true;
        }
    }
    return false;
}

static void on_request(SoupServer *server, SoupServerMessage *message, const char *path, GHashTable *query, gpointer data)
{
    struct whep *whep = data;
    const char *method = soup_server_message_get_method(message), *id = path + strlen(PATH);
    (void)server;
    (void)query;
    allow_pages(message);
    if (!strcmp(method, "OPTIONS"))
        soup_server_message_set_status(message, SOUP_STATUS_NO_CONTENT, NULL);
    else if (!may(whep->options, message))
        return;
    else if (*id && *id != '/')
        answer(message, SOUP_STATUS_NOT_FOUND, "offers go to /whep\n");
    else if (!strcmp(method, "POST") && !id[*id == '/'])
        post(whep, message);
    else if (strcmp(method, "DELETE") != 0 || !*id)
        answer(message, SOUP_STATUS_METHOD_NOT_ALLOWED, "POST to /whep, or DELETE of what it answered, is expected\n");
    else if (end_place(whep, id + 1))
        soup_server_message_set_status(message, SOUP_STATUS_OK, NULL);
    else
        answer(message, SOUP_STATUS_NOT_FOUND, "it has ended\n");
}

/* Before a body is taken in: no offer is that large. */
static void on_headers(SoupServer *server, SoupServerMessage *message, const char *path, GHashTable *query, gpointer data)
{
    SoupMessageHeaders *headers = soup_server_message_get_request_headers(message);
    bool sized = soup_message_headers_get_encoding(headers) == SOUP_ENCODING_CONTENT_LENGTH;
    (void)path;
    (void)query;
    (void)data;
    if (strcmp(soup_server_message_get_method(message), "POST") != 0 ||
        (sized && soup_message_headers_get_content_length(headers) <= MOST_BYTES))
        return;
    allow_pages(message);
    answer(message, SOUP_STATUS_REQUEST_ENTITY_TOO_LARGE, "an offer has at most 64 KiB, and says how many\n");
    refusal_send(server, message);
}

/* --- life ------------------------------------------------------------------------------------------------------------------------ */

struct whep *whep_create(const struct options *options, struct outputs *outputs)
{
    struct whep *whep = g_new0(struct whep, 1);
    *whep = (struct whep){ .options = options, .outputs = outputs, .places = g_ptr_array_new_with_free_func(place_free) };
    whep->enders = g_thread_pool_new(end_session, whep, -1, FALSE, NULL);
    return whep;
}

void whep_serve(struct whep *whep, SoupServer *server)
{
    soup_server_add_early_handler(server, PATH, on_headers, whep, NULL);
    soup_server_add_handler(server, PATH, on_request, whep, NULL);
}

void whep_destroy(struct whep **pointer)
{
    struct whep *whep = *pointer;
    if (!whep)
        return;
    g_ptr_array_free(whep->places, TRUE);
    g_thread_pool_free(whep->enders, FALSE, TRUE);
    g_free(whep);
    *pointer = NULL;
}

void whep_look(struct whep *whep)
{
    for (guint i = 0; whep && i < whep->places->len; i++) {
        const struct place *place = g_ptr_array_index(whep->places, i);
        if (!place->message && !whep_session_is_alive(place->session))
            g_ptr_array_remove_index_fast(whep->places, i--);
    }
}

guint whep_readers(const struct whep *whep)
{
    return whep ? whep->places->len : 0;
}
