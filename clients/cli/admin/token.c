/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast token`: creates, lists and revokes access tokens in the token file. The daemon notices by itself that the file has changed. */
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "base/text/timestamp.h"
#include "clients/cli/commands.h"
#include "message/names.h"
#include "access/tokens.h"

enum { MAX_FILE_BYTES = 1024 * 1024 };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast token add FILE --role ROLE --name NAME [--until YYYY-MM-DD]\n"
          "                           [--plant PLANT] [--unattended] [--views ID,... | --display WALL:NUMBER]\n"
          "       plantcast token list FILE\n"
          "       plantcast token revoke FILE NAME\n"
          "\n"
          "`add` creates a token and prints it once. FILE stores only the token's SHA-256 hash.\n"
          "If FILE does not exist, `add` creates it.\n"
          "A daemon with --tokens FILE applies changes to FILE within 3 s, and closes the sessions of revoked tokens.\n"
          "\n"
          "  --role ROLE      what the token permits: viewer, operator or engineer for users and programs;\n"
          "                   renderer or standby for a daemon that connects to a core\n"
          "  --name NAME      name of the user or program that will use the token\n"
          "  --until DATE     last day on which the token is valid, as YYYY-MM-DD (default: no expiry)\n"
          "  --plant PLANT    name of the only plant for which the token is valid (default: all plants whose\n"
          "                   daemon uses FILE)\n"
          "  --views ID,...   restrict a viewer's token to pictures (/snapshot.png?view=ID) of these views in the\n"
          "                   plant file\n"
          "  --display WALL:NUMBER  restrict a viewer's token to this display of a video wall in the plant file;\n"
          "                   implies --unattended\n"
          "  --unattended     never sign out users of this token after inactivity (plantcastd --lock-after);\n"
          "                   for video walls and programs\n"
          "\n"
          "FILE must be in a folder that root or you own, and must not be a symbolic link.\n"
          "To let the daemon read FILE: chown root:plantcast FILE; chmod 640 FILE\n",
          out);
}

static int fail_at(const char *path, const char *why)
{
    fprintf(stderr, "plantcast: %s: %s\n", path, why);
    return 1;
}

static bool is_foreign(const struct stat *st)
{
    return st->st_uid != 0 && st->st_uid != geteuid();
}

/* Returns NULL if the folder of `path` is safe, else why it is not: anyone who may write to a folder can replace the files in it. */
static const char *folder_fault(const char *path)
{
    struct stat st;
    const char *slash = strrchr(path, '/'), *fault = NULL;
    char *folder = slash ? mem_printf("%.*s", slash > path ? (int)(slash - path) : 1, path) : mem_strdup(".");
    if (stat(folder, &st) != 0)
        fault = strerror(errno);
    else if (is_foreign(&st))
        fault =
            "the folder of this token file belongs to another user, who could replace the file: move the file to a folder that root owns";
    else if ((st.st_mode & S_IWOTH) && !(st.st_mode & S_ISVTX))
        fault = "every user can write to the folder of this token file: run chmod go-w on the folder";
    mem_free(folder);
    return fault;
}

/* Returns NULL if the token file is a regular file of at most MAX_FILE_BYTES that belongs to this user or root, else the reason
   for refusing it. */
static const char *file_fault(const struct stat *st)
{
    if (!S_ISREG(st->st_mode))
        return "the token file is not a regular file";
    if (is_foreign(st))
        return "the owner of the token file is neither root nor you: run chown root on the file";
    return st->st_size > MAX_FILE_BYTES ? "the token file is larger than 1 MiB" : NULL;
}

static char *read_all(int fd, size_t size)
{
    char *text = mem_array(size + 1, 1);
    ssize_t n = read(fd, text, size);
    text[n > 0 ? n : 0] = 0;
    return text;
}

/* Reads the token file into a new text. Returns NULL with the reason printed. If the file is missing, returns "" with
   may_be_new, else fails. */
static char *read_file(const char *path, bool may_be_new)
{
    struct stat st;
    char *text = NULL;
    const char *fault = folder_fault(path);
    int fd = fault ? -1 : open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (!fault && fd < 0 && errno == ENOENT && may_be_new)
        return mem_strdup("");
    if (!fault && fd < 0)
        fault = errno == ELOOP ? "the token file is a symbolic link: give the path of the file itself" : strerror(errno);
    if (!fault)
        fault = fstat(fd, &st) == 0 ? file_fault(&st) : strerror(errno);
    if (fault)
        fail_at(path, fault);
    else
        text = read_all(fd, (size_t)st.st_size);
    if (fd >= 0)
        close(fd);
    return text;
}

/* Replaces the token file atomically and keeps its owner and mode. If the file is new, only its creator may read it. */
static int write_file(const char *path, const struct text *text)
{
    struct stat st;
    struct atomic_file file;
    bool old = lstat(path, &st) == 0;
    int error = atomic_file_begin(&file, path, 0600);
    if (error)
        return fail_at(path, strerror(-error));
    if (old && (fchown(file.fd, st.st_uid, st.st_gid) != 0 || fchmod(file.fd, st.st_mode & 07777) != 0))
        error = -errno;
    if (!error)
        error = atomic_file_write(&file, text->at, text->length);
    if (!error)
        error = atomic_file_commit(&file, true);
    atomic_file_abandon(&file);
    return error ? fail_at(path, strerror(-error)) : 0;
}

static bool has_name(const char *lines, const char *name)
{
    struct token_holder holder;
    const char *why;
    for (; *lines; lines += strcspn(lines, "\n"), lines += *lines == '\n')
        if (tokens_parse_line(lines, &holder, &why) == 1 && !strcmp(holder.name, name))
            return true;
    return false;
}

/* Removes the token with this name from the file. Returns 0 or the exit code, with the reason printed. */
static int revoke_token(const char *path, const char *name)
{
    char *old = read_file(path, false);
    struct text text = { 0 };
    int found = 0, result = 1;
    for (const char *line = old; line && *line;) {
        struct token_holder holder;
        const char *why;
        size_t n = strcspn(line, "\n") + (line[strcspn(line, "\n")] == '\n');
        bool this_one = tokens_parse_line(line, &holder, &why) == 1 && !strcmp(holder.name, name);
        found += this_one;
        if (!this_one)
            text_add_bytes(&text, line, n);
        line += n;
    }
    if (old && !found)
        fail_at(path, "this token file has no token with that name: `plantcast token list` prints the names");
    else if (old)
        result = write_file(path, &text);
    text_finish(&text);
    mem_free(old);
    return result;
}

static int add_token(const char *path, struct token_holder *holder)
{
    char token[TOKEN_MAX_CHARS + 1], *old = read_file(path, true);
    struct text text = { 0 };
    int result = 1;
    if (!old)
        return 1;
    signal(SIGPIPE, SIG_IGN); /* a token that nobody reads from a closed pipe must be removed again */
    if (has_name(old, holder->name)) {
        fail_at(path, "a token with this name exists: revoke that token, or choose another name");
    } else if (!tokens_make(token)) {
        fail_at(path, "this machine's random number generator failed");
    } else {
        tokens_hash(token, holder->hash);
        text_add(&text, "%s%s", old, *old && old[strlen(old) - 1] != '\n' ? "\n" : "");
        tokens_print_line(&text, holder);
        result = write_file(path, &text);
    }
    if (result == 0 && (puts(token) == EOF || fflush(stdout) != 0)) {
        result = fail_at(path, revoke_token(path, holder->name)
                                   ? "the new token could not be printed, and is still valid: revoke it with `plantcast token revoke`"
                                   : "the new token could not be printed and was removed again");
    }
    text_finish(&text);
    mem_free(old);
    return result;
}

static void print_holder(const struct token_holder *holder)
{
    char until[TIMESTAMP_BYTES] = "";
    if (holder->until_utc_ns < INT64_MAX)
        timestamp_print(holder->until_utc_ns / 1000, until);
    char display[sizeof(holder->wall) + 32] = "";
    if (holder->display)
        snprintf(display, sizeof(display), "  display %s:%d", holder->wall, holder->display);
    printf("%-10s %s  %s%s%s%s%s%s%s%s%s\n", name_of(names_role, (int)holder->role), holder->name, *until ? "until " : "no expiry", until,
           holder->plant[0] ? "  plant " : "", holder->plant, holder->views[0] ? "  views " : "", holder->views, display,
           holder->unattended ? "  unattended" : "", holder->until_utc_ns <= clock_utc_ns() ? "  (expired)" : "");
}

static int list(const char *path)
{
    char *old = read_file(path, false);
    int result = old ? 0 : 1, number = 1;
    for (const char *line = old; line && *line; number++) {
        struct token_holder holder;
        const char *why;
        int found = tokens_parse_line(line, &holder, &why);
        if (found == 1)
            print_holder(&holder);
        if (found < 0) {
            fprintf(stderr, "plantcast: %s:%d: %s\n", path, number, why);
            result = 1;
        }
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    mem_free(old);
    return result;
}

static bool take_option(int option, struct token_holder *holder)
{
    int role;
    switch (option) {
    case 'r':
        role = name_find(names_role, optarg);
        holder->role = (enum role)role;
        return role >= ROLE_VIEWER || role_is_node((enum role)role);
    case 'n': snprintf(holder->name, sizeof(holder->name), "%s", optarg); return tokens_name_valid(optarg);
    case 'w': holder->unattended = true; return true;
    case 'p': snprintf(holder->plant, sizeof(holder->plant), "%s", optarg); return tokens_plant_valid(optarg);
    case 'v': snprintf(holder->views, sizeof(holder->views), "%s", optarg); return *optarg && tokens_views_valid(optarg);
    case 'd': holder->unattended = true; return tokens_parse_display(optarg, holder);
    case 'u': return tokens_parse_day(optarg, &holder->until_utc_ns);
    default: return false;
    }
}

int cmd_token(int argc, char **argv)
{
    static const struct option options[] = {
        { "role", required_argument, NULL, 'r' },    { "name", required_argument, NULL, 'n' }, { "until", required_argument, NULL, 'u' },
        { "plant", required_argument, NULL, 'p' },   { "unattended", no_argument, NULL, 'w' }, { "views", required_argument, NULL, 'v' },
        { "display", required_argument, NULL, 'd' }, { "help", no_argument, NULL, 'h' },       { NULL, 0, NULL, 0 }
    };
    struct token_holder holder = { .role = ROLE_NOBODY, .until_utc_ns = INT64_MAX };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        if (option == 'h') {
            print_usage(stdout);
            return 0;
        }
        if (!take_option(option, &holder)) {
            if (option != '?')
                fprintf(stderr, "plantcast token: an option has the invalid value '%s': see plantcast token --help\n", optarg);
            print_usage(stderr);
            return 2;
        }
    }
    const char *what = argv[optind], *path = what ? argv[optind + 1] : NULL;
    int count = argc - optind;
    if ((holder.views[0] || holder.display) && (holder.role != ROLE_VIEWER || (holder.views[0] && holder.display))) {
        fprintf(stderr, "plantcast token: --views and --display need --role viewer, and cannot be combined\n");
        return 2;
    }
    if (count == 2 && !strcmp(what, "add") && holder.role != ROLE_NOBODY && holder.name[0])
        return add_token(path, &holder);
    if (count == 2 && !strcmp(what, "list"))
        return list(path);
    if (count == 3 && !strcmp(what, "revoke"))
        return revoke_token(path, argv[optind + 2]);
    print_usage(stderr);
    return 2;
}
