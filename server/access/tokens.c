/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the token file, and finds the holder of a token. */
#include "access/tokens.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text/hex.h"
#include "base/mem.h"
#include "access/file_watch.h"
#include "message/names.h"
#include "plant/walls/wall.h"

enum { MAX_FILE_BYTES = 1024 * 1024, RANDOM_BYTES = 32 };

struct tokens {
    struct log *log;
    char *path, *plant; /* path of the token file; name of this plant, NULL: not known */
    struct token_holder *holders;
    size_t count, capacity;
    struct file_watch watch;
    tokens_find_device *find_device; /* looks up paired wall devices by their secrets; NULL: there are none */
    const void *pairings;
};

/* --- single tokens ------------------------------------------------------------------------------------------------------------- */

void tokens_hash(const char *token, uint8_t hash[TOKEN_HASH_BYTES])
{
    if (EVP_Digest(token, strlen(token), hash, NULL, EVP_sha256(), NULL) != 1)
        memset(hash, 0, TOKEN_HASH_BYTES);
}

/* Generates a random token. Tokens begin with a prefix, so that users, and tools that scan files for secrets, can tell a token
   from the hash of a token. */
bool tokens_make(char token[TOKEN_MAX_CHARS + 1])
{
    uint8_t bytes[RANDOM_BYTES];
    if (RAND_bytes(bytes, RANDOM_BYTES) != 1)
        return false;
    strcpy(token, "pc_");
    hex_print(bytes, RANDOM_BYTES, token + 3);
    OPENSSL_cleanse(bytes, sizeof(bytes));
    return true;
}

bool tokens_name_valid(const char *name)
{
    size_t n = strlen(name);
    for (size_t i = 0; i < n; i++)
        if (!isalnum((unsigned char)name[i]) && !strchr("-_.@", name[i]))
            return false;
    return n > 0 && n < TOKEN_NAME_BYTES;
}

bool tokens_plant_valid(const char *plant)
{
    size_t n = strlen(plant);
    return n > 0 && n < TOKEN_PLANT_BYTES && !strpbrk(plant, "\r\n#") && plant[0] != ' ' && plant[n - 1] != ' ';
}

bool tokens_views_valid(const char *views)
{
    char copy[TOKEN_VIEWS_BYTES], *rest = copy;
    bool good = strlen(views) < sizeof(copy);
    snprintf(copy, sizeof(copy), "%s", views);
    for (char *id; good && (id = strsep(&rest, ","));)
        good = named_view_id_valid(id);
    return good;
}

bool tokens_parse_display(const char *text, struct token_holder *out)
{
    const char *colon = strchr(text, ':');
    if (!colon || colon - text >= (ptrdiff_t)sizeof(out->wall) || strlen(colon + 1) > 2 || colon[1 + strspn(colon + 1, "0123456789")])
        return false;
    snprintf(out->wall, sizeof(out->wall), "%.*s", (int)(colon - text), text);
    out->display = atoi(colon + 1);
    return named_view_id_valid(out->wall) && out->display >= 1 && out->display <= WALL_DISPLAYS;
}

enum role tokens_role_of(const struct token_holder *holder)
{
    return holder->views[0] ? ROLE_OPEN : holder->role;
}

bool tokens_may_see(const struct token_holder *holder, const char *view)
{
    size_t length = strlen(view);
    for (const char *at = holder->views; *at; at += at[strcspn(at, ",")] ? strcspn(at, ",") + 1 : strlen(at))
        if (!strncmp(at, view, length) && (at[length] == ',' || !at[length]))
            /* requires that `view` is the id of one view: a text such as "a,b" could otherwise match part of the
               comma-separated list holder->views */
            return named_view_id_valid(view);
    return !holder->views[0];
}

bool tokens_parse_day(const char *text, int64_t *until_utc_ns)
{
    struct tm day = { 0 };
    const char *end = strptime(text, "%Y-%m-%d", &day);
    int said = day.tm_mday;
    if (!end || *end || day.tm_year < 1970 - 1900 || day.tm_year > 2200 - 1900)
        return false;
    int64_t begin_s = timegm(&day);
    *until_utc_ns = (begin_s + 24 * 3600) * NS_PER_S;
    return day.tm_mday == said; /* refuses dates such as 30 February, which strptime accepts but timegm turns into another date */
}

/* Cuts the final `plant NAME` off a line and copies NAME to `plant`; NAME may contain blanks. Returns false if NAME is invalid. */
static bool take_plant(char *line, char plant[TOKEN_PLANT_BYTES])
{
    static const char key[] = " plant ";
    char *at = NULL;
    size_t n = strlen(line);
    while (n > 0 && strchr(" \t", line[n - 1]))
        line[--n] = 0;
    for (char *next = line; (next = strstr(next, key)); next++)
        /* searches for the keyword `plant` only after the token's hash, because the holder's name in front of the hash may
           contain that word */
        at = next > line + 2 * TOKEN_HASH_BYTES && !at ? next : at;
    if (!at)
        return true;
    *at = 0;
    at += strlen(key);
    at += strspn(at, " ");
    snprintf(plant, TOKEN_PLANT_BYTES, "%s", at);
    return tokens_plant_valid(at);
}

int tokens_parse_line(const char *line, struct token_holder *out, const char **why)
{
    enum { WORDS = 5, MOST = WORDS + 3 };
    char copy[1024], *rest = copy, *words[MOST + 1] = { NULL };
    int count = 0;
    *out = (struct token_holder){ .until_utc_ns = INT64_MAX };
    if (strcspn(line, "\r\n#") >= sizeof(copy)) {
        *why = "the line is longer than 1023 bytes";
        return -1;
    }
    snprintf(copy, strcspn(line, "\r\n#") + 1, "%s", line);
    bool plant_good = take_plant(copy, out->plant);
    for (char *word; count <= MOST && (word = strsep(&rest, " \t"));)
        if (*word)
            words[count++] = word;
    bool limited = count > 4 && !strcmp(words[count - 2], "views"), views_good = !limited || tokens_views_valid(words[count - 1]);
    bool display = count > 4 && !strcmp(words[count - 2], "display");
    bool display_good = !display || tokens_parse_display(words[count - 1], out);
    if (display)
        count -= 2;
    if (limited) {
        snprintf(out->views, sizeof(out->views), "%s", words[count - 1]);
        count -= 2;
    }
    if (count > 3 && !strcmp(words[count - 1], "unattended")) {
        out->unattended = true;
        count--;
    }
    if (count == 0)
        return 0;
    int role = name_find(names_role, words[0]);
    if (role < ROLE_VIEWER && !role_is_node((enum role)role))
        *why = "expected the role viewer, operator, engineer, renderer or standby";
    else if (count != 3 && count != WORDS)
        *why = "expected a line ROLE NAME SHA-256 [until YYYY-MM-DD] [unattended] [views ID,... | display WALL:NUMBER] [plant PLANT]";
    else if (!views_good)
        *why = "expected ids of views, separated by commas, after `views`";
    else if (!display_good)
        *why = "expected a display as WALL:NUMBER after `display`";
    else if ((limited || display) && role != ROLE_VIEWER)
        *why = "`views` and `display` are allowed only for the role viewer";
    else if (!plant_good)
        *why = "expected the name of a plant after `plant`";
    else if (!tokens_name_valid(words[1]))
        *why = "the name may contain only letters, digits and -_.@";
    else if (!hex_read(words[2], out->hash, TOKEN_HASH_BYTES))
        *why = "expected a SHA-256 of 64 hexadecimal digits";
    else if (count == WORDS && (strcmp(words[3], "until") != 0 || !tokens_parse_day(words[4], &out->until_utc_ns)))
        *why = "expected the last day as `until YYYY-MM-DD`";
    else {
        out->role = (enum role)role;
        strcpy(out->name, words[1]);
        return 1;
    }
    return -1;
}

void tokens_print_line(struct text *out, const struct token_holder *holder)
{
    char hash[2 * TOKEN_HASH_BYTES + 1];
    hex_print(holder->hash, TOKEN_HASH_BYTES, hash);
    text_add(out, "%s %s %s", name_of(names_role, (int)holder->role), holder->name, hash);
    if (holder->until_utc_ns != INT64_MAX) {
        time_t last_s = (time_t)(holder->until_utc_ns / NS_PER_S - 1);
        struct tm day;
        char text[32];
        strftime(text, sizeof(text), "%Y-%m-%d", gmtime_r(&last_s, &day));
        text_add(out, " until %s", text);
    }
    if (holder->unattended)
        text_add(out, " unattended");
    if (holder->views[0])
        text_add(out, " views %s", holder->views);
    if (holder->display)
        text_add(out, " display %s:%d", holder->wall, holder->display);
    if (holder->plant[0])
        text_add(out, " plant %s", holder->plant);
    text_add(out, "\n");
}

/* --- the file --------------------------------------------------------------------------------------------------------------------- */

/* Returns why the token file must not be used, judging by its type, owner, mode and size; NULL: it may be used. */
static const char *fault_of(const struct stat *st)
{
    if (!S_ISREG(st->st_mode))
        return "the path is not a regular file";
    if (st->st_uid != 0 && st->st_uid != geteuid())
        return "the file's owner is neither root nor the daemon's user; change the owner with chown";
    if (st->st_mode & (S_IWGRP | S_IWOTH | S_IROTH))
        return "other users may read or write the file; set chmod 640 or stricter";
    return st->st_size > MAX_FILE_BYTES ? "the file is larger than 1 MiB" : NULL;
}

static void take_line(struct tokens *tokens, const char *line, int number)
{
    struct token_holder holder;
    const char *why;
    int found = tokens_parse_line(line, &holder, &why);
    if (found < 0)
        log_err(tokens->log, "%s:%d: %s; this token is refused", tokens->path, number, why);
    if (found <= 0)
        return;
    mem_grow(&tokens->holders, &tokens->capacity, tokens->count + 1, sizeof(*tokens->holders));
    tokens->holders[tokens->count++] = holder;
}

static void take_lines(struct tokens *tokens, char *text)
{
    int number = 0;
    for (char *line; (line = strsep(&text, "\n"));)
        take_line(tokens, line, ++number);
}

/* Reads the token file. Checks owner and mode of the open descriptor, so that nobody can swap the file between check and read.
   On failure, logs the reason and returns false. */
static bool read_file(struct tokens *tokens)
{
    struct stat st = { 0 };
    int fd = open(tokens->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool there = fd >= 0 && fstat(fd, &st) == 0;
    const char *fault = there ? fault_of(&st) : strerror(errno);
    tokens->count = 0;
    file_watch_read(&tokens->watch, there ? &st : NULL);
    if (!fault) {
        char *text = mem_array((size_t)st.st_size + 1, 1);
        ssize_t n = read(fd, text, (size_t)st.st_size);
        text[n > 0 ? n : 0] = 0;
        take_lines(tokens, text);
        mem_free(text);
    } else {
        log_err(tokens->log, "tokens %s: %s; all tokens are refused", tokens->path, fault);
    }
    if (fd >= 0)
        close(fd);
    return !fault;
}

struct tokens *tokens_create(struct log *log, const char *path)
{
    struct tokens *tokens = mem_new(sizeof(*tokens));
    *tokens = (struct tokens){ .log = log, .path = mem_strdup(path) };
    if (!read_file(tokens))
        tokens_destroy(&tokens);
    return tokens;
}

void tokens_set_plant(struct tokens *tokens, const char *plant)
{
    mem_free(tokens->plant);
    tokens->plant = mem_strdup(plant);
}

void tokens_set_pairings(struct tokens *tokens, tokens_find_device *find_device, const void *pairings)
{
    tokens->find_device = find_device;
    tokens->pairings = pairings;
}

void tokens_destroy(struct tokens **tokens_ptr)
{
    struct tokens *tokens = *tokens_ptr;
    if (!tokens)
        return;
    mem_free(tokens->holders);
    mem_free(tokens->path);
    mem_free(tokens->plant);
    mem_free(tokens);
    *tokens_ptr = NULL;
}

bool tokens_look(struct tokens *tokens)
{
    if (!file_watch_changed(&tokens->watch, tokens->path))
        return false;
    if (read_file(tokens))
        log_info(tokens->log, "tokens %s: %zu tokens read", tokens->path, tokens->count);
    return true;
}

bool tokens_has_name(const struct tokens *tokens, const char *name)
{
    for (size_t i = 0; i < tokens->count; i++)
        if (!strcmp(tokens->holders[i].name, name))
            return true;
    return false;
}

static bool is_for_us(const struct tokens *tokens, const struct token_holder *holder)
{
    return !holder->plant[0] || !tokens->plant || !strcmp(holder->plant, tokens->plant);
}

/* Finds the holder of a token by the token's hash. If the file lists the hash twice, returns the holder whose token has not
   expired. Takes the same time for every hash, so that the timing reveals nothing about the stored hashes. */
static const struct token_holder *find(const struct tokens *tokens, const uint8_t hash[TOKEN_HASH_BYTES], int64_t now_utc_ns)
{
    const struct token_holder *found = NULL;
    for (size_t i = 0; i < tokens->count; i++)
        if (CRYPTO_memcmp(tokens->holders[i].hash, hash, TOKEN_HASH_BYTES) == 0 && is_for_us(tokens, &tokens->holders[i]) &&
            (!found || now_utc_ns < tokens->holders[i].until_utc_ns))
            found = &tokens->holders[i];
    return found;
}

bool tokens_find(const struct tokens *tokens, const char *token, int64_t now_utc_ns, struct token_holder *out)
{
    uint8_t hash[TOKEN_HASH_BYTES];
    tokens_hash(token, hash);
    const struct token_holder *found = find(tokens, hash, now_utc_ns);
    if (!found && tokens->find_device)
        return tokens->find_device(tokens->pairings, hash, out);
    *out = found ? *found : (struct token_holder){ .role = ROLE_NOBODY };
    return found && now_utc_ns < found->until_utc_ns;
}

enum role tokens_role(const struct tokens *tokens, const struct token_holder *holder, int64_t now_utc_ns)
{
    struct token_holder device = { .role = ROLE_NOBODY };
    const struct token_holder *found = find(tokens, holder->hash, now_utc_ns);
    if (!found && tokens->find_device)
        tokens->find_device(tokens->pairings, holder->hash, &device);
    if (!found)
        return device.role;
    bool same = !strcmp(found->views, holder->views) && !strcmp(found->wall, holder->wall) && found->display == holder->display;
    if (now_utc_ns >= found->until_utc_ns || !same)
        return ROLE_NOBODY;
    return tokens_role_of(found);
}
