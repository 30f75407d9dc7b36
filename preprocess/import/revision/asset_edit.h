/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes the assets of a plant file in its own text: order, comments and everything else stay as people wrote them. Pure. Thread: any. */
#ifndef PREPROCESS_IMPORT_ASSET_EDIT_H
#define PREPROCESS_IMPORT_ASSET_EDIT_H
#include <stdbool.h>
#include <stddef.h>

struct asset_edit { /* zero: the asset stays as it is */
    bool removed;
    char *tag;    /* what it is called from now on; NULL: as before */
    char **nodes; /* for each of its patterns the new one, or NULL where it goes; NULL: all stay */
    size_t node_count;
};

enum { ASSET_EDIT_WHY_BYTES = 200 };

/* Applies one edit for each asset, in the file's order, and appends lines to the list of assets (NULL: none). Returns the new text
 * (mem_free), or NULL with the reason in why: the list is not in block style, one item a line. */
char *asset_edit_apply(const char *text, const struct asset_edit *edits, size_t count, const char *added, char why[ASSET_EDIT_WHY_BYTES]);

#endif
