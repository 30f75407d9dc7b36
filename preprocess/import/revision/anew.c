/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces all files of a plant with those of a new import and keeps their previous versions. */
#include "preprocess/import/revision/anew.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "placing/tag_file.h"
#include "preprocess/import/import_fail.h"
#include "preprocess/import/revision/revision_files.h"

enum { TEXTS = 3 };

struct one_text {
    const char *name;
    char *before, *after; /* before: current text of the file; NULL: the file does not exist. after: new text; NULL: unchanged */
    char *kept;           /* path at which the file's previous version is kept; NULL: not kept */
};

struct revision_making {
    const struct revise_params *params;
    struct revision_file *files;
    size_t file_count;
    struct one_text texts[TEXTS];
};

/* Adds a text file to the transaction that replaces the plant's files, and takes ownership of `after`. versioned: also keeps
 * the current file under another name (NAME.1, ...), because a user may have written it. */
static int add_text(struct revision_making *making, struct one_text *one, const char *name, char *after, bool versioned)
{
    char *path = mem_printf("%s/%s", making->params->folder, name);
    struct refusal why = { .code = REFUSAL_NONE };
    int status = 0;
    *one = (struct one_text){ .name = name, .before = access(path, F_OK) == 0 ? tag_file_read(path, &why) : NULL, .after = after };
    if (one->before && after && !strcmp(one->before, after)) {
        mem_free(one->after);
        one->after = NULL;
        printf("%s: unchanged\n", path);
    }
    if (one->before && one->after && versioned)
        one->kept = tag_file_keep(path, &why);
    if (why.code) {
        char text[REFUSAL_TEXT_BYTES];
        refusal_text(&why, text);
        status = import_fail(path, text);
    }
    struct revision_file *file = &making->files[making->file_count];
    *file = (struct revision_file){ name, NULL, one->before };
    if (status == 0 && one->after) {
        file->made = mem_printf("%s/%s", making->params->work, name);
        int error = atomic_file_put(file->made, one->after, strlen(one->after));
        status = error == 0 ? 0 : import_fail(path, strerror(-error));
    }
    making->file_count += one->before || one->after;
    mem_free(path);
    return status;
}

static int add_texts(struct revision_making *making, const struct plant_draft *draft, size_t *assets)
{
    char *plant = mem_printf("%s/plant.yaml", making->params->folder), *tags = mem_printf("%s/tags.csv", making->params->folder);
    bool new_list = draft->anew || access(tags, F_OK) != 0;
    int status = add_text(making, &making->texts[0], "tags.csv", new_list ? mem_strdup(plant_draft_tags()) : NULL, true);
    if (status == 0)
        status = add_text(making, &making->texts[1], "matches.csv", NULL, true);
    if (status == 0)
        status = add_text(making, &making->texts[2], "plant.yaml", plant_draft_text(draft, assets), !plant_draft_is_begun(plant));
    mem_free(tags);
    mem_free(plant);
    return status;
}

static int apply(const struct revision_making *making)
{
    const char *folder = making->params->folder;
    int status = revision_files_replace(folder, making->params->work, making->files, making->file_count);
    if (status != 0)
        return status;
    for (size_t i = 0; i < TEXTS; i++)
        if (making->texts[i].kept)
            printf("%s/%s: written; the previous version is kept as %s\n", folder, making->texts[i].name, making->texts[i].kept);
    return 0;
}

int import_anew(const struct revise_params *params, const struct plant_draft *draft)
{
    struct revision_making making = { .params = params, .files = mem_array(params->count + TEXTS, sizeof(*making.files)) };
    size_t assets = 0;
    for (size_t i = 0; i < params->count; i++)
        making.files[making.file_count++] =
            (struct revision_file){ params->models[i].file, mem_printf("%s/%zu.glb", params->work, i), NULL };
    int status = add_texts(&making, draft, &assets);
    if (status == 0)
        status = apply(&making);
    if (status == 0)
        printf("%s/plant.yaml: %zu assets\n", params->folder, assets);
    for (size_t i = 0; i < TEXTS; i++) {
        if (making.texts[i].kept && status != 0)
            unlink(making.texts[i].kept);
        mem_free(making.texts[i].kept);
        mem_free(making.texts[i].before);
        mem_free(making.texts[i].after);
    }
    for (size_t i = 0; i < making.file_count; i++)
        mem_free(making.files[i].made);
    mem_free(making.files);
    return status;
}
