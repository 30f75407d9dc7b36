/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds glTF files to the reader of `plantcast nodes`, and prints the result. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "preprocess/import/model_outline.h"
#include "preprocess/import/node_list.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void print(const struct model_outline *outline)
{
    FILE *nowhere = fopen("/dev/null", "w");
    require(nowhere != NULL, "/dev/null is there");
    const struct node_list_params ways[] = { { 0 }, { .levels = 2 }, { .json = true } };
    for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++)
        require(node_list_print(outline, &ways[i], nowhere) <= outline->header.count, "each node is printed once");
    fclose(nowhere);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct model_outline outline;
    char path[64], why[256] = "";
    int file = memfd_create("model", 0);
    require(file >= 0 && write(file, bytes, count) == (ssize_t)count, "there is memory for a file");
    snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
    if (model_outline_read(&outline, path, why, sizeof(why))) {
        for (size_t i = 0; i < outline.header.count; i++)
            require(outline.header.nodes[i].parent < (int)i, "parents come before children");
        print(&outline);
        model_outline_finish(&outline);
    } else {
        require(why[0], "what is refused says why");
    }
    close(file);
    return 0;
}
