/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes temporary plant files into the plant's folder, because paths in a plant file are relative to it. */
#include "preprocess/match/plant_trial.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"

/* Returns the text of a plant file with its tag list's path replaced by `list`. The caller frees it. */
static char *with_list(const char *text, const char *list)
{
    const char *key = strstr(text, "\ntags:"), *end = key ? key + 1 + strcspn(key + 1, "\n") : NULL;
    return key ? mem_printf("%.*s\ntags: %s%s", (int)(key - text), text, list, end) : mem_strdup(text);
}

struct plant *plant_trial_load(const struct plant *plant, const char *text, const char *tags, const char *program)
{
    char *name = mem_printf(".trial.%d.csv", (int)getpid()), *list = mem_printf("%s/%s", plant->files.folder, name),
         *path = mem_printf("%s/.trial.%d.yaml", plant->files.folder, (int)getpid()), *changed = tags ? with_list(text, name) : NULL;
    const char *all = changed ? changed : text;
    struct plant *loaded = NULL;
    int status = atomic_file_put(path, all, strlen(all));
    if (status == 0 && tags)
        status = atomic_file_put(list, tags, strlen(tags));
    if (status != 0)
        fprintf(stderr, "%s: %s: %s\n", program, path, strerror(-status));
    else
        loaded = plant_load_without_models(path); /* do not load the plant's models: they may not have been imported yet */
    if (status == 0 && !loaded)
        fprintf(stderr, "%s: the resulting plant would be invalid; nothing was written\n", program);
    unlink(path);
    unlink(list);
    mem_free(changed);
    mem_free(path);
    mem_free(list);
    mem_free(name);
    return loaded;
}
