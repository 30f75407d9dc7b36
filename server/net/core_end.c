/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connects a renderer (daemon that draws for a core) with its core: forwards users' actions, and handles the core's messages. */
#include "net/core_end.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/hex.h"
#include "base/text/json_text.h"
#include "corelink/core_identity.h"
#include "message/loop_check_message.h"

static bool hand_on(void *arg, const struct session *session, const char *text)
{
    const struct server_context *server = arg;
    const struct session_identity *identity = &session->identity;
    char *id_token = identity->holder.signed_in && server->logins.openid ? openid_id_token(server->logins.openid, &identity->holder) : NULL;
    bool sent = core_link_act(server->params.plant.core_link, &(struct core_act){ .client = session->id,
                                                                                  .from = identity->from,
                                                                                  .token = identity->token[0] ? identity->token : NULL,
                                                                                  .id_token = id_token,
                                                                                  .text = text });
    mem_free(id_token);
    return sent;
}

void core_end_bind(struct server_context *server)
{
    server->session_context.core.hand_on = server->params.plant.core_link ? hand_on : NULL;
    server->session_context.core.hand_on_arg = server;
    server->session_context.sign_in.token_keys = server->params.plant.core_link ? &server->core.token_keys : NULL;
}

static void take_key(struct server_context *server, const json_t *core)
{
    const char *text = json_string_value(json_object_get(core, "key"));
    uint8_t key[VIEW_TOKEN_KEY_BYTES];
    if (text && hex_read(text, key, sizeof(key)))
        view_token_add_key(&server->core.token_keys, key);
}

/* Handles the core's loop checks; NULL: they have not changed. A standby core ignores them, because it has records of its own. */
static bool take_loop_checks(const struct server_context *server, const json_t *proofs)
{
    struct loop_checks *loop_checks = server->params.plant.loop_checks;
    return !proofs || !loop_checks || !loop_checks_are_mirrored(loop_checks) ||
           loop_checks_take(loop_checks, server->session_context.plant, proofs);
}

static void take_lists(struct server_context *server, const json_t *lists)
{
    const struct plant_services *plant = &server->params.plant;
    if (!named_views_mirror(plant->named_views, json_object_get(lists, "views")) ||
        !notes_mirror(plant->notes, json_object_get(lists, "notes")) ||
        !wall_remote_mirror(plant->wall_remote, json_object_get(lists, "walls")) ||
        !wall_remote_mirror_pointers(plant->wall_remote, json_object_get(lists, "pointed")) ||
        !pairings_mirror(plant->pairings, json_object_get(lists, "pairings"), clock_mono_ns()) ||
        (json_object_get(lists, "links") && !short_links_mirror(plant->short_links, json_object_get(lists, "links"))) ||
        !take_loop_checks(server, json_object_get(lists, "proofs")))
        log_err(server->params.log,
                "core: the core sent an invalid list of views, notes, walls, devices, short links or loop checks; this daemon ignores the "
                "rest of the message");
    server->core.listed = true;
    streams_on_alarms(server);
}

static void follow(const struct server_context *server, const struct core_follow *follow)
{
    if (server->params.follow)
        server->params.follow(server->params.reload_arg, follow);
}

/* Handles the core's refusal of this daemon because their configurations differ: makes this daemon get the core's tag list, or
   load its own files again, since the core's new files may have arrived on this machine. A refused renderer reconnects every
   second, and therefore tries this once per configuration that the core names. */
static void take_refusal(struct server_context *server, const json_t *refusal)
{
    const char *configuration = json_string_value(json_object_get(refusal, "configuration"));
    struct core_files files;
    if (!configuration || (!server->params.is_core && !strcmp(configuration, server->core.followed)))
        return;
    snprintf(server->core.followed, sizeof(server->core.followed), "%s", configuration);
    server->core.reloads = false;
    if (server->params.match && core_files_read(refusal, &files))
        server->params.match(server->params.reload_arg, &files, configuration);
}

/* Handles the hashes of files in the core's introduction: logs that the core has other models, and records the common tag list. */
static void take_files(const struct server_context *server, const json_t *message)
{
    const struct scene *scene = server->params.plant.scene;
    const struct core_files own = core_files_of(scene->plant, scene->models_hash);
    struct core_files files;
    if (!core_files_read(message, &files))
        return;
    if (server->params.agree)
        server->params.agree(server->params.reload_arg, own.tags);
    if (!(core_files_differing(&own, &files) & CORE_MODELS))
        return;
    const char *node = server->params.node_name;
    char *why = mem_printf("node %s shows other models than the core: copy the models from the core's machine, run plantcast-prep, and "
                           "reload the plant on %s",
                           node, node);
    log_err(server->params.log, "core: models: the core has %s, this node %s: %s", files.models, own.models, why);
    if (server->params.is_core)
        core_link_report_files(server->params.plant.core_link, why);
    mem_free(why);
}

/* Handles the core's message that it accepts this daemon. If the leading core has just loaded its plant, a standby core now
   reloads its own plant. The standby's models may be outdated even if the configuration hash, which covers only plant file and
   tag list, has not changed. */
static void take_introduction(struct server_context *server, const json_t *message)
{
    take_key(server, message);
    take_files(server, message);
    server->core.followed[0] = 0;
    if (server->core.reloads)
        follow(server, &(struct core_follow){ .expects = server->session_context.plant->files.hash });
    server->core.reloads = false;
}

/* Handles the core's message that it loads its plant. A renderer loads the plant at the same time. A standby core waits until
   the leading core uses its new plant: if that plant makes the leader fail, the standby takes over with the old plant. */
static void take_reload(struct server_context *server, const json_t *message)
{
    const char *loads = json_member_text(message, "configuration");
    server->core.reloads = server->params.is_core;
    if (!server->params.is_core)
        follow(server, &(struct core_follow){ .session = core_link_session(server->params.plant.core_link), .loads = loads });
}

static void take(struct server_context *server, const char *text)
{
    json_t *message = json_loads(text, 0, NULL);
    const char *type = json_string_value(json_object_get(message, "type"));
    if (!strcmp(type, "core"))
        take_introduction(server, message);
    else if (!strcmp(type, "reloading"))
        take_reload(server, message);
    else if (!strcmp(type, "refused"))
        take_refusal(server, message);
    else
        take_lists(server, message);
    json_decref(message);
}

bool core_end_leads(const struct server_context *server)
{
    return !server->params.plant.core_link && (!server->params.keeper || lease_keeper_leads(server->params.keeper));
}

void core_end_collect(struct server_context *server)
{
    struct core_link *link = server->params.plant.core_link;
    for (struct core_arrival *arrival = link ? core_link_collect(link) : NULL, *next; arrival; arrival = next) {
        next = arrival->next;
        if (arrival->client)
            stream_say(server, arrival->client, arrival->text);
        else
            take(server, arrival->text);
        core_arrival_free(arrival);
    }
}
