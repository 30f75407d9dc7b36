/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Import of a plant by engineers: uploads of exported files, orders to import them, and files with proposed places of sensors. The event
   loop writes uploads to files, piece by piece, without waiting for the disk. */
#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "net/http/http_impl.h"
#include "net/connection.h"

static const int64_t most_bytes = (int64_t)2 << 30, most_in_all = (int64_t)8 << 30, most_decisions = 16 << 20;
enum { MAX_FILES = 64, MATCHES_BYTES = 32 << 20, MAX_UPLOADS = 4, SLOW_S = 20, SLOWEST_BPS = 10000 };

struct upload_body {
    struct export_upload *upload;
    int64_t left, bytes; /* left: number of bytes of the upload still to come; bytes: size of the whole file */
    int64_t begun_ns;
    char name[256];
    /* true: the file holds an engineer's decisions about proposed places of sensors (plantcast match), so the end of the upload
       starts an import */
    bool decides;
};

/* Adds a line about an import step (an upload or an order) to the audit trail. result: as in struct audit_entry; why: the
   reason of a refusal, or NULL. The reload thread records the outcome of an import order later. */
static void record_file(struct http_exchange *request, const char *file, const char *result, const char *why)
{
    char *line = why ? mem_printf("%.*s", (int)strcspn(why, "\n"), why) : NULL;
    char *what = mem_printf("%s%s%s", request->step, *file ? " " : "", file);
    connection_record(server_context_of(request->wsi), request->wsi, "import", result, what, line);
    mem_free(what);
    mem_free(line);
}

static void record(struct http_exchange *request, const char *result, const char *why)
{
    record_file(request, "", result, why);
}

static int refuse_for(struct http_exchange *request, int status, const struct refusal *refusal)
{
    char text[REFUSAL_TEXT_BYTES];
    refusal_text(refusal, text);
    record(request, status == HTTP_STATUS_FORBIDDEN ? "refused" : "failed", text);
    request->close = true;
    return request_refuse_for(request, status, refusal);
}

static int refuse_with(struct http_exchange *request, int status, enum refusal_code code)
{
    return refuse_for(request, status, &(struct refusal){ .code = code });
}

static int fail_with(struct http_exchange *request, const char *what, int error)
{
    struct refusal refusal;
    refusal_set(&refusal, REFUSAL_UNWRITTEN, "file=%s\nerror=%s", what, strerror(-error));
    return refuse_for(request, error == -ENOSPC ? 507 : HTTP_STATUS_INTERNAL_SERVER_ERROR, &refusal);
}

static int answer_empty(struct http_exchange *request)
{
    return request_answer(request, HTTP_STATUS_OK, "application/json", mem_strdup("{}"), 2, NULL, NULL);
}

/* Records the import step as done in the audit trail; http_settle() answers the request once that line is on disk or cannot be
   written. file: name of the uploaded file; "": none. */
static int answer_done(struct http_exchange *request, const char *file)
{
    struct server_context *server = server_context_of(request->wsi);
    request->record = audit_begin(server->params.audit);
    record_file(request, file, "done", NULL);
    audit_end(server->params.audit, &request->record);
    if (!server->params.audit)
        return answer_empty(request);
    request->recorded = server->kept_answers.waiting = true;
    request_await(server, request);
    return 0;
}

void http_settle(struct server_context *server)
{
    for (struct http_exchange *request = server->http.waiting, *next; request; request = next) {
        next = request->next;
        int error = request->recorded ? audit_settled(server->params.audit, &request->record) : 0;
        server->kept_answers.waiting |= error == -EINPROGRESS;
        if (!request->recorded || error == -EINPROGRESS)
            continue;
        json_t *answer = json_object();
        if (error)
            refusal_add_unaudited(answer, atomic_file_not_kept(error));
        request_forget(server, request);
        request->recorded = false;
        request_answered(request, request_answer_json(request, json_text(answer, 0)));
    }
}

/* --- state of the import --- */

int api_import(struct server_context *server, struct http_exchange *request)
{
    if (!server->params.import)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, "this server does not import plants (it runs without --import)\n");
    const struct import_source source = import_source_of_plant(server->params.plant.scene->plant);
    return request_answer_json(request, plant_import_text(server->params.import, &source));
}

/* Answers with the content of a file. path NULL: no plant has been imported yet. missing: text of the answer if the file does not exist. */
static int answer_file(struct http_exchange *request, const char *path, const char *type, const char *missing)
{
    size_t bytes;
    char *text = path ? text_read_file(path, MATCHES_BYTES, &bytes) : NULL;
    if (!text)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, missing);
    return request_answer(request, HTTP_STATUS_OK, type, text, bytes, NULL, NULL);
}

int api_import_matches(struct server_context *server, struct http_exchange *request)
{
    const struct plant_import *import = server->params.import;
    return answer_file(request, import ? plant_import_matches(import) : NULL, "text/csv; charset=utf-8", "no tags have been matched yet\n");
}

int api_import_report(struct server_context *server, struct http_exchange *request)
{
    const struct plant_import *import = server->params.import;
    return answer_file(request, import ? plant_import_report(import) : NULL, "application/json", "no models have been read yet\n");
}

/* --- import orders ---------------------------------------------------------------------------------------------------- */

static int order(struct server_context *server, struct http_exchange *request, const struct import_order *order)
{
    if (!plant_import_order(server->params.import, order))
        return refuse_with(request, HTTP_STATUS_CONFLICT, REFUSAL_IMPORTING);
    server->params.import_ordered(server->params.reload_arg, connection_who(connection_of(request->wsi)));
    return answer_empty(request);
}

/* Copies the value of the argument NAME=value of the query; "" if the name is missing. Returns false if the value is too long. */
static bool take_argument(const struct args *args, const char *name, char *out, size_t size)
{
    size_t length = strlen(name);
    *out = 0;
    for (size_t i = 0; i < args->count; i++)
        if (!strncmp(args->list[i], name, length) && args->list[i][length] == '=') {
            const char *value = args->list[i] + length + 1;
            if (strlen(value) >= size)
                return false;
            strcpy(out, value);
        }
    return true;
}

/* Orders an import of the uploaded files. Argument `what`: `tags` matches the tag list and keeps the models; `anew` replaces the plant;
   absent: updates the models. */
static int order_all(struct server_context *server, struct http_exchange *request, const struct args *args)
{
    struct import_order wanted = { 0 };
    char what[8];
    if (!take_argument(args, "what", what, sizeof(what)) || (*what && strcmp(what, "tags") != 0 && strcmp(what, "anew") != 0))
        return refuse_with(request, HTTP_STATUS_BAD_REQUEST, REFUSAL_IMPORT_VALUES);
    wanted.anew = !strcmp(what, "anew");
    wanted.models = wanted.anew || !*what;
    if (!take_argument(args, "units", wanted.units, sizeof(wanted.units)) || !take_argument(args, "up", wanted.up, sizeof(wanted.up)) ||
        !take_argument(args, "mesh_units", wanted.mesh_units, sizeof(wanted.mesh_units)) ||
        !take_argument(args, "encoding", wanted.encoding, sizeof(wanted.encoding)) || !import_order_good(&wanted))
        return refuse_with(request, HTTP_STATUS_BAD_REQUEST, REFUSAL_IMPORT_VALUES);
    return order(server, request, &wanted);
}

/* Orders an import that reads the tags from a data source. */
static int order_source(struct server_context *server, struct http_exchange *request, const struct args *args)
{
    struct import_order wanted = { 0 };
    struct import_source *source = &wanted.source;
    if (!take_argument(args, "host", source->host, sizeof(source->host)) ||
        !take_argument(args, "port", source->port, sizeof(source->port)) ||
        !take_argument(args, "unit", source->unit, sizeof(source->unit)) ||
        !take_argument(args, "order", source->order, sizeof(source->order)) ||
        !take_argument(args, "base", source->base, sizeof(source->base)) || !*source->host || !import_order_good(&wanted))
        return refuse_with(request, HTTP_STATUS_BAD_REQUEST, REFUSAL_IMPORT_DEVICE);
    return order(server, request, &wanted);
}

static int cancel(struct server_context *server, struct http_exchange *request, const struct args *args)
{
    (void)args;
    plant_import_cancel(server->params.import);
    return answer_done(request, "");
}

static int remove_file(struct server_context *server, struct http_exchange *request, const struct args *args)
{
    char name[256];
    if (!take_argument(args, "name", name, sizeof(name)) || !export_name_good(name))
        return refuse_with(request, HTTP_STATUS_BAD_REQUEST, REFUSAL_FILELESS);
    int error = export_folder_remove(plant_import_exports(server->params.import), name);
    return error == 0 || error == -ENOENT ? answer_done(request, name) : fail_with(request, name, error);
}

/* --- uploads ---------------------------------------------------------------------------------------------------------- */

/* Returns whether `bytes` more bytes may be uploaded as the file `name`. If not, *why receives the reason. */
static bool has_room(const struct server_context *server, const char *folder, const char *name, int64_t bytes, enum refusal_code *why)
{
    struct export_list list = { 0 };
    int64_t all = bytes + server->http.upload_bytes;
    size_t others = (size_t)server->http.uploads;
    export_folder_list(folder, &list);
    for (size_t i = 0; i < list.count; i++)
        if (strcmp(list.at[i].name, name) != 0) {
            all += list.at[i].bytes;
            others++;
        }
    export_list_finish(&list);
    *why = others >= MAX_FILES ? REFUSAL_FILES : REFUSAL_FILES_LARGE;
    return others < MAX_FILES && all <= most_in_all;
}

static int begin_body(struct server_context *server, struct http_exchange *request, const char *name, bool decides)
{
    char length[32];
    const char *folder = plant_import_exports(server->params.import);
    enum refusal_code why;
    int error;
    if (!connection_header(request->wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH, length, sizeof(length)) || !*length)
        return refuse_with(request, 411, REFUSAL_FILE_LENGTH);
    int64_t bytes = strtoll(length, NULL, 10);
    if (bytes <= 0 || bytes > (decides ? most_decisions : most_bytes))
        return refuse_with(request, 413, bytes <= 0 ? REFUSAL_FILE_EMPTY : REFUSAL_FILE_LARGE);
    if (server->http.uploads >= MAX_UPLOADS)
        return refuse_with(request, HTTP_STATUS_SERVICE_UNAVAILABLE, REFUSAL_UPLOADS);
    if (!decides && !has_room(server, folder, name, bytes, &why))
        return refuse_with(request, 413, why);
    struct export_upload *upload = export_upload_begin(folder, name, &error);
    if (!upload)
        return fail_with(request, name, error);
    request->body_in = mem_new(sizeof(*request->body_in));
    *request->body_in =
        (struct upload_body){ .upload = upload, .left = bytes, .bytes = bytes, .begun_ns = clock_mono_ns(), .decides = decides };
    server->http.uploads++;
    server->http.upload_bytes += bytes;
    snprintf(request->body_in->name, sizeof(request->body_in->name), "%s", name);
    return 0;
}

static int begin_upload(struct server_context *server, struct http_exchange *request, const struct args *args)
{
    char name[256];
    if (!take_argument(args, "name", name, sizeof(name)) || !export_name_good(name))
        return refuse_with(request, HTTP_STATUS_BAD_REQUEST, REFUSAL_FILE_NAME);
    return begin_body(server, request, name, false);
}

static int begin_decisions(struct server_context *server, struct http_exchange *request, const struct args *args)
{
    (void)args;
    return begin_body(server, request, plant_import_decisions(), true);
}

/* Returns whether an upload is slower than any real link, and would occupy one of the few permitted uploads for hours. No check
   is needed for an upload that stalls completely: libwebsockets closes its connection. */
static bool drips(const struct upload_body *body)
{
    int64_t taken_s = (clock_mono_ns() - body->begun_ns) / NS_PER_S;
    return taken_s >= SLOW_S && body->left > 0 && body->bytes - body->left < taken_s * SLOWEST_BPS;
}

int import_take_body(struct server_context *server, struct http_exchange *request, const void *bytes, size_t count)
{
    (void)server;
    struct upload_body *body = request->body_in;
    if (!body)
        return 0; /* ignores the body of an upload that was refused */
    body->left -= (int64_t)count;
    int error = body->left < 0 ? -EFBIG : export_upload_write(body->upload, bytes, count);
    bool slow = drips(body);
    if (!error && !slow)
        return 0;
    char name[256];
    strcpy(name, body->name);
    import_abandon_body(request);
    if (slow)
        return refuse_with(request, 408, REFUSAL_UPLOAD_SLOW);
    return fail_with(request, name, error);
}

int import_end_body(struct server_context *server, struct http_exchange *request)
{
    struct upload_body *body = request->body_in;
    if (!body)
        return 0;
    const char *folder = plant_import_exports(server->params.import);
    bool whole = body->left == 0, decides = body->decides, busy = plant_import_busy(server->params.import);
    char name[256];
    strcpy(name, body->name);
    int error = whole && !busy ? export_upload_end(&body->upload) : 0;
    import_abandon_body(request);
    if (busy)
        return refuse_with(request, HTTP_STATUS_CONFLICT, REFUSAL_IMPORTING);
    if (!whole)
        return refuse_with(request, HTTP_STATUS_BAD_REQUEST, REFUSAL_UPLOAD_CUT);
    if (error)
        return fail_with(request, name, error);
    if (decides)
        return order(server, request, &(struct import_order){ .decides = true });
    if (export_kind_of(name) == EXPORT_TAGS)
        export_folder_remove_tag_lists(folder, name);
    return answer_done(request, name);
}

void import_abandon_body(struct http_exchange *request)
{
    struct server_context *server = server_context_of(request->wsi);
    if (!request->body_in)
        return;
    export_upload_abandon(&request->body_in->upload);
    server->http.uploads--;
    server->http.upload_bytes -= request->body_in->bytes;
    mem_free(request->body_in);
    request->body_in = NULL;
}

/* --- POST requests --------------------------------------------------------------------------------------------------- */

static const struct {
    const char *path;
    int (*take)(struct server_context *server, struct http_exchange *request, const struct args *args);
    bool always; /* true: the path of the API may be used even while an import runs */
} posts[] = {
    { "/api/v1/import/upload", begin_upload, false }, { "/api/v1/import/remove", remove_file, false },
    { "/api/v1/import/run", order_all, false },       { "/api/v1/import/decide", begin_decisions, false },
    { "/api/v1/import/source", order_source, false }, { "/api/v1/import/cancel", cancel, true },
};
enum { POSTS = sizeof(posts) / sizeof(posts[0]) };

static size_t find_post(const char *path)
{
    size_t i = 0;
    while (i < POSTS && strcmp(posts[i].path, path) != 0)
        i++;
    return i;
}

bool import_takes_post(const struct server_context *server, const char *path)
{
    return server->params.import && find_post(path) < POSTS;
}

void import_add_posts(const struct server_context *server, struct text *out)
{
    for (size_t i = 0; i < POSTS && server->params.import; i++)
        text_add(out, ", %s", posts[i].path);
}

int import_post(struct server_context *server, struct http_exchange *request, const char *path)
{
    struct message_error error = { 0 };
    struct args args;
    size_t i = find_post(path);
    request->step = posts[i].path;
    if (!connection_origin_allowed(server, request->wsi))
        return refuse_with(request, HTTP_STATUS_FORBIDDEN, REFUSAL_FOREIGN);
    if (!request_args(request->wsi, &args, &error)) {
        record(request, "failed", error.text);
        return request_answer_error(request, &error);
    }
    if (!posts[i].always && plant_import_busy(server->params.import))
        return refuse_with(request, HTTP_STATUS_CONFLICT, REFUSAL_IMPORTING);
    return posts[i].take(server, request, &args);
}
