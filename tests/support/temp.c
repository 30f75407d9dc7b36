/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files for one test. */
#include "tests/support/temp.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/support/owned.h"

static void give_up(const char *path)
{
    perror(path);
    abort();
}

static int remove_one(const char *path, const struct stat *st, int type, struct FTW *walk)
{
    (void)st, (void)type, (void)walk;
    return remove(path);
}

static void remove_folder(void *folder)
{
    if (nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS) != 0)
        give_up(folder);
}

char *temp_folder(void)
{
    const char *parent = getenv("TMPDIR");
    char *folder = test_printf("%s/plantcast-test-XX" "XX" "XX", parent ? parent : "/tmp");
    if (!mkdtemp(folder))
        give_up(folder);
    owned_add(remove_folder, folder);
    return folder;
}

char *temp_path(const char *folder, const char *name)
{
    return test_printf("%s/%s", folder, name);
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
