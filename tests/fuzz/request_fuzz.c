/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds the parts of an HTTP request that this project parses itself. The first byte selects one: a query, a host, an origin, a
   list, a path, or a line of tokens. */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/mem.h"
#include "net/http/site.h"
#include "message/view_query.h"
#include "access/tokens.h"
#include "tests/support/small_scene.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void read_query(char *text)
{
    enum { MOST = 32 };
    const char *args[MOST];
    size_t count = 0;
    struct view view;
    double place[2];
    struct message_error error = { 0 };
    const struct params_context context = { .scene = small_scene() };
    for (char *arg; count < MOST && (arg = strsep(&text, "&"));)
        args[count++] = arg;
    for (int with_place = 0; with_place < 2; with_place++) {
        if (view_query_parse(&context, ROLE_ENGINEER, args, count, &view, with_place ? place : NULL, &error))
            require(view_size_valid(view.width_px, view.height_px) && camera_valid(&view.camera), "a query makes a view");
        else
            require(error.code && error.text[0], "a refusal has a reason");
    }
}

static void read_host(const char *text)
{
    char name[64], again[64];
    if (!access_host_name(text, name, sizeof(name)))
        return;
    require(name[0] && strlen(name) < sizeof(name), "a name");
    if (!strchr(name, ':'))
        require(access_host_name(name, again, sizeof(again)) && !strcmp(name, again), "a name is its own name");
}

static void read_list(const char *text)
{
    char out[24];
    access_list_has(text, "plantcast.v1");
    if (access_list_rest(text, "Authorization-Bearer.", out, sizeof(out)))
        require(out[0] && strlen(out) < sizeof(out) && !strpbrk(out, " ,\t"), "a word");
    struct access_params params = { 0 };
    if (access_add_proxy(&params, text))
        require(access_is_proxy(&params, text) || strchr(text, '/'), "a network has its own address");
    if (access_forwarded(&params, text, out, sizeof(out)))
        require(access_name_is_address(out), "an address");
}

static void read_path(const char *text)
{
    static struct web_site *site;
    if (!site)
        site = site_create(NULL, "clients/web");
    const struct site_file *file = site_find(site, text);
    require(!file || (file->plain.bytes && file->type && !strstr(text, "..")), "a file of the client");
}

static void read_token_line(const char *text)
{
    struct token_holder holder, again;
    struct text line = { 0 };
    const char *why = NULL;
    int found = tokens_parse_line(text, &holder, &why);
    require(found >= 0 || why, "a refusal has a reason");
    if (found != 1)
        return;
    require((holder.role >= ROLE_VIEWER || holder.role == ROLE_RENDERER) && tokens_name_valid(holder.name), "a holder");
    tokens_print_line(&line, &holder);
    require(tokens_parse_line(line.at, &again, &why) == 1 && again.role == holder.role && !strcmp(again.name, holder.name) &&
                !memcmp(again.hash, holder.hash, sizeof(holder.hash)) && again.until_utc_ns == holder.until_utc_ns,
            "a line is read as it was written");
    text_finish(&line);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    const struct access_params params = { .origins = { "https://portal.example" }, .origin_count = 1 };
    if (count < 1)
        return 0;
    char *text = mem_array(count, 1);
    memcpy(text, bytes + 1, count - 1);
    switch (bytes[0]) {
    case 'q': read_query(text); break;
    case 'h': read_host(text); break;
    case 'o': access_origin(&params, text, "plant.example", true); break;
    case 'l': read_list(text); break;
    case 'p': read_path(text); break;
    case 't': read_token_line(text); break;
    default: access_argument_is_token(text);
    }
    mem_free(text);
    return 0;
}
