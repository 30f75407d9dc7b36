/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files for one test. */
#include "tests/support/temp.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"

static void give_up(const char *path)
{
    perror(path);
    abort();
}

char *temp_folder_create(void)
{
    const char *parent = getenv("TMPDIR");
    char *folder = mem_printf("%s/plantcast-test-XX" "XX" "XX", parent ? parent : "/tmp");
    if (!mkdtemp(folder))
        give_up(folder);
    return folder;
}

static int remove_one(const char *path, const struct stat *st, int type, struct FTW *walk)
{
    (void)st, (void)type, (void)walk;
    return remove(path);
}

void temp_folder_destroy(char **folder)
{
    if (nftw(*folder, remove_one, 16, FTW_DEPTH | FTW_PHYS) != 0)
        give_up(*folder);
    mem_free(*folder);
    *folder = NULL;
}

char *temp_path(const char *folder, const char *name)
{
    return mem_printf("%s/%s", folder, name);
}

char *temp_write(const char *folder, const char *name, const void *bytes, size_t count)
{
    char *path = temp_path(folder, name);
    for (char *slash = path + 1; (slash = strchr(slash, '/')); *slash++ = '/') {
        *slash = 0;
        mkdir(path, 0777);
    }
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, count, file) != count || fclose(file) != 0)
        give_up(path);
    return path;
}

char *temp_write_text(const char *folder, const char *name, const char *text)
{
    return temp_write(folder, name, text, strlen(text));
}
