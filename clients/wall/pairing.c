/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Digits of a display that is not let in; the page has the same (clients/web/wall/pairing.js). */
#include "pairing.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "access/tokens.h"
#include "base/atomic_file.h"
#include "base/clock.h"

static const int64_t SETTLES_NS = 10 * NS_PER_S; /* so long after it was let in, other nodes of the server may not know it yet */

/* --- the files ---------------------------------------------------------------------------------------------------------------------- */

/* Makes the folders above a file. */
static void make_folders(const char *path)
{
    char folder[PAIRING_PATH_BYTES];
    snprintf(folder, sizeof(folder), "%s", path);
    for (char *at = strchr(folder + 1, '/'); at; at = strchr(at + 1, '/')) {
        *at = 0;
        mkdir(folder, 0700);
        *at = '/';
    }
}

/* Returns 0, or -errno. */
static int write_token(const char *path, const char *token)
{
    struct atomic_file file;
    make_folders(path);
    int error = atomic_file_begin(&file, path, 0600);
    if (error)
        return error;
    error = atomic_file_write(&file, token, strlen(token));
    if (!error)
        error = atomic_file_write(&file, "\n", 1);
    if (!error)
        return atomic_file_commit(&file, true);
    atomic_file_abandon(&file);
    return error;
}

/* In the file of --token-file, or, where that is not ours to write, as systemd's credentials are not, in the state folder. */
static void keep(struct pairing *pairing)
{
    const char *paths[] = { pairing->token_path, pairing->state_path[0] ? pairing->state_path : NULL };
    strcpy(pairing->kept, pairing->secret);
    for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++) {
        int error = paths[i] ? write_token(paths[i], pairing->secret) : -ENOENT;
        if (!error) {
            printf("plantcast-wall: let in; the secret is in %s\n", paths[i]);
            fflush(stdout);
            return;
        }
        if (paths[i])
            fprintf(stderr, "plantcast-wall: %s: %s\n", paths[i], strerror(-error));
    }
    fprintf(stderr, "plantcast-wall: let in, but the secret is kept nowhere: it asks for digits again when it is started again\n");
}

/* Sets the file of this server's display in the state folder, as the XDG Base Directory Specification and systemd's STATE_DIRECTORY have
   it. */
static void set_state_path(struct pairing *pairing, const struct daemon_url *url, const char *wall, int display)
{
    const char *systemd = getenv("STATE_DIRECTORY"), *xdg = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    char folder[PAIRING_PATH_BYTES / 2], name[PAIRING_PATH_BYTES / 2];
    int count = systemd && systemd[0] ? snprintf(folder, sizeof(folder), "%.*s", (int)strcspn(systemd, ":"), systemd)
                : xdg && xdg[0] == '/' ? snprintf(folder, sizeof(folder), "%s/plantcast", xdg)
                : home && home[0] == '/' ? snprintf(folder, sizeof(folder), "%s/.local/state/plantcast", home)
                                         : -1;
    int length = snprintf(name, sizeof(name), "%s_%d%s_%s_%d.token", url->host, url->port, url->base, wall, display);
    for (char *at = name; *at; at++)
        if (!isalnum((unsigned char)*at) && !strchr("-_.", *at))
            *at = '_';
    if (count >= 0 && (size_t)count < sizeof(folder) && length >= 0 && (size_t)length < sizeof(name))
        snprintf(pairing->state_path, sizeof(pairing->state_path), "%s/%s", folder, name);
}

void pairing_init(struct pairing *pairing, const char *token_path, const struct daemon_url *url, const char *wall, int display)
{
    struct text path = { 0 };
    *pairing = (struct pairing){ .enabled = true, .token_path = token_path };
    text_add(&path, "/api/v1/pair?display=%d&wall=", display);
    text_add_escaped(&path, wall);
    snprintf(pairing->path, sizeof(pairing->path), "%s", path.at);
    text_finish(&path);
    set_state_path(pairing, url, wall, display);
}

/* --- being let in ------------------------------------------------------------------------------------------------------------------- */

void pairing_choose_token(struct pairing *pairing)
{
    char tokens[3][TOKEN_MAX_CHARS + 1] = { "" };
    if (pairing->token_path)
        daemon_token_in(pairing->token_path, tokens[0]);
    if (pairing->state_path[0])
        daemon_token_in(pairing->state_path, tokens[1]);
    strcpy(tokens[2], pairing->kept);
    int chosen = -1;
    for (int i = 2; i >= 0; i--)
        if (tokens[i][0] && (chosen < 0 || strcmp(tokens[i], pairing->turned_away) != 0))
            chosen = i;
    strcpy(pairing->used, chosen < 0 ? "" : tokens[chosen]);
    daemon_set_token(pairing->used);
}

static void ask(struct pairing *pairing, struct links *links)
{
    char authorization[TOKEN_MAX_CHARS + 16];
    snprintf(authorization, sizeof(authorization), "Pairing %s", pairing->secret);
    links_ask_as(links, GET_PAIRING, pairing->path, authorization);
}

/* A secret that was refused is used no more: somebody else may have it. */
void pairing_refused(struct pairing *pairing, struct links *links, int64_t now_ns)
{
    bool settles = pairing->let_in_ns && now_ns - pairing->let_in_ns < SETTLES_NS;
    pairing->heard_ns = now_ns;
    strcpy(pairing->turned_away, pairing->used);
    if (pairing->state != PAIRING_NOT)
        return;
    if (!settles && !tokens_make(pairing->secret))
        return;
    pairing->state = PAIRING_ASKS;
    ask(pairing, links);
}

void pairing_welcomed(struct pairing *pairing)
{
    pairing->state = PAIRING_NOT;
    pairing->digits[0] = pairing->turned_away[0] = 0;
}

static void take_digits(struct pairing *pairing, const json_t *answer, int64_t now_ns)
{
    const char *digits = json_string_value(json_object_get(answer, "digits"));
    int left_s = (int)json_integer_value(json_object_get(answer, "left_s"));
    if (!digits || strlen(digits) != 6 || strspn(digits, "0123456789") != 6) {
        pairing->state = PAIRING_ASKS;
        return;
    }
    if (strcmp(pairing->digits, digits) != 0 || pairing->state != PAIRING_SHOWS) {
        printf("plantcast-wall: shows the digits %s, good for %d s\n", digits, left_s);
        fflush(stdout);
    }
    strcpy(pairing->digits, digits);
    pairing->until_ns = now_ns + left_s * NS_PER_S;
    pairing->state = PAIRING_SHOWS;
}

bool pairing_take(struct pairing *pairing, struct links *links, const json_t *answer, int64_t now_ns)
{
    int status = links->requests[GET_PAIRING].status;
    if (pairing->state == PAIRING_NOT)
        return false;
    if (status)
        pairing->heard_ns = now_ns;
    if (status == 200 && json_is_true(json_object_get(answer, "paired"))) {
        pairing->state = PAIRING_NOT;
        pairing->let_in_ns = now_ns;
        pairing->turned_away[0] = 0;
        if (strcmp(pairing->kept, pairing->secret) != 0)
            keep(pairing);
        return true;
    }
    if (status == 200)
        take_digits(pairing, answer, now_ns);
    else if (status) /* without an answer the digits stay as long as they are good */
        pairing->state = status == 503   ? PAIRING_CROWDED
                         : status == 400 ? PAIRING_NOWHERE
                         : status == 404 ? PAIRING_NEVER
                                         : PAIRING_ASKS;
    ask(pairing, links);
    return false;
}
