/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects the files and folders that a confined child may use, with symlinks resolved. */
#include "preprocess/child/child_paths.h"

#include <dirent.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"

enum { MAX_DEPTH = 3, MAX_BESIDE = 4096 };

void child_paths_add(struct child_paths *paths, const char *path, enum confine_access access)
{
    char *real = path ? realpath(path, NULL) : NULL;
    if (!real)
        return;
    mem_grow(&paths->at, &paths->capacity, paths->count + 1, sizeof(*paths->at));
    paths->at[paths->count++] = (struct confine_path){ mem_strdup(real), access };
    free(real);
}

void child_paths_add_folder_of(struct child_paths *paths, const char *path, enum confine_access access)
{
    char *real = path ? realpath(path, NULL) : NULL, *slash = real ? strrchr(real, '/') : NULL;
    if (slash && slash > real) {
        *slash = 0;
        child_paths_add(paths, real, access);
    }
    free(real);
}

static bool ends_with_one_of(const char *name, const char *endings)
{
    const char *dot = strrchr(name, '.');
    size_t length = dot ? strlen(dot) : 0;
    for (const char *at = endings; dot && *at; at += strcspn(at, " "), at += *at == ' ')
        if (strcspn(at, " ") == length && !strncasecmp(at, dot, length))
            return true;
    return false;
}

static void add_endings(struct child_paths *paths, const char *folder, const char *endings, int depth, int *left)
{
    DIR *dir = opendir(folder);
    for (const struct dirent *entry; dir && *left > 0 && (entry = readdir(dir));) {
        struct stat st;
        if (entry->d_name[0] == '.' || fstatat(dirfd(dir), entry->d_name, &st, 0) != 0)
            continue;
        char *path = mem_printf("%s/%s", folder, entry->d_name);
        if (S_ISDIR(st.st_mode) && depth < MAX_DEPTH) {
            --*left;
            add_endings(paths, path, endings, depth + 1, left);
        } else if (S_ISREG(st.st_mode) && ends_with_one_of(entry->d_name, endings)) {
            --*left;
            child_paths_add(paths, path, CONFINE_READ);
        }
        mem_free(path);
    }
    if (dir)
        closedir(dir);
}

void child_paths_add_beside(struct child_paths *paths, const char *input, const char *endings)
{
    int left = MAX_BESIDE;
    char *real = realpath(input, NULL), *slash = real ? strrchr(real, '/') : NULL;
    if (slash && slash > real) {
        *slash = 0;
        add_endings(paths, real, endings, 0, &left);
    }
    free(real);
}

void child_paths_link_beside(const char *folder, const char *input, const char *endings)
{
    char *real = realpath(input, NULL), *slash = real ? strrchr(real, '/') : NULL;
    if (slash)
        *slash = 0;
    for (int lower = 0; slash && lower < 2; lower++) { /* first all exact names, so that they win over lower-case ones */
        DIR *dir = opendir(*real ? real : "/");
        int left = MAX_BESIDE;
        for (const struct dirent *entry; dir && left > 0 && (entry = readdir(dir));) {
            if (entry->d_name[0] == '.' || !ends_with_one_of(entry->d_name, endings))
                continue;
            char *file = mem_printf("%s/%s", real, entry->d_name), *target = realpath(file, NULL);
            char *link = mem_printf("%s/%s", folder, entry->d_name);
            for (char *c = link + strlen(folder) + 1; lower && *c; c++)
                *c = (char)(*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c);
            left -= target && symlink(target, link) == 0;
            mem_free(link);
            mem_free(file);
            free(target);
        }
        if (dir)
            closedir(dir);
    }
    free(real);
}

static void add_settings(struct child_paths *paths)
{
    DIR *dir = opendir("/etc");
    for (const struct dirent *entry; dir && (entry = readdir(dir));)
        if (entry->d_name[0] != '.' && strcmp(entry->d_name, "plantcast") != 0) {
            char *path = mem_printf("/etc/%s", entry->d_name);
            child_paths_add(paths, path, CONFINE_READ);
            mem_free(path);
        }
    if (dir)
        closedir(dir);
}

/* Allows what programs in a folder such as ~/.venv/bin load from the folder above it: only the entries of ~/.venv named in
   `parts`. Allowing the whole folder above would be too much: for ~/.local/bin, that is ~/.local. */
static void add_installation(struct child_paths *paths, const char *programs)
{
    static const char *const parts[] = { "lib", "lib64", "libexec", "versions", "version", "pyvenv.cfg" };
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
        char *path = mem_printf("%s/../%s", programs, parts[i]);
        child_paths_add(paths, path, CONFINE_EXECUTE);
        mem_free(path);
    }
}

/* Adds the absolute paths in a text, which is a shell command or the value of $PATH. separators: characters that separate the paths. */
static void add_absolute(struct child_paths *paths, const char *text, const char *separators, bool installed)
{
    for (const char *at = text; *at;) {
        size_t length = strcspn(at, separators);
        if (length > 1 && *at == '/') {
            char *path = mem_printf("%.*s", (int)length, at);
            child_paths_add(paths, path, CONFINE_EXECUTE);
            if (installed)
                add_installation(paths, path);
            mem_free(path);
        }
        at += length + (at[length] != 0);
    }
}

void child_paths_add_command(struct child_paths *paths, const char *command)
{
    static const char *const programs[] = { "/usr", "/bin", "/sbin", "/lib", "/lib64", "/opt" };
    const char *path = getenv("PATH");
    for (size_t i = 0; i < sizeof(programs) / sizeof(programs[0]); i++)
        child_paths_add(paths, programs[i], CONFINE_EXECUTE);
    add_settings(paths);
    add_absolute(paths, path ? path : "", ":", true);
    add_absolute(paths, command, " \t\n\"'`;|&<>()=$", false);
}

void child_paths_add_modules(struct child_paths *paths)
{
    char *program = realpath("/proc/self/exe", NULL), *slash = program ? strrchr(program, '/') : NULL;
    if (slash) {
        *slash = 0;
        char *library = mem_printf("%s/../lib/plantcast", program);
        child_paths_add(paths, program, CONFINE_READ);
        child_paths_add(paths, library, CONFINE_READ);
        mem_free(library);
    }
    free(program);
}

void child_paths_finish(struct child_paths *paths)
{
    for (size_t i = 0; i < paths->count; i++)
        mem_free((char *)(uintptr_t)paths->at[i].path);
    mem_free(paths->at);
    *paths = (struct child_paths){ 0 };
}
