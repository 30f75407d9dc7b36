/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits the assets in the text of a plant file, leaving everything else, such as order and comments, unchanged. No side
 * effects. Call from any thread. */
#ifndef PREPROCESS_IMPORT_ASSET_EDIT_H
#define PREPROCESS_IMPORT_ASSET_EDIT_H
#include <stdbool.h>
#include <stddef.h>

struct asset_edit { /* changes to one asset of the plant file; all zero: none */
    bool removed;
    char *tag; /* new tag of the asset; NULL: unchanged */
    /* nodes[i]: patterns, one per line, that replace the asset's node pattern i, NULL: the pattern is deleted; nodes NULL: no
     * pattern changes */
    char **nodes;
    size_t node_count;
};

enum { ASSET_EDIT_WHY_BYTES = 200 };

/* Applies edits[i] to asset i of the plant file, and appends the lines `added` to the list of assets (NULL: none). Returns the
 * new text, which the caller frees with mem_free. Returns NULL with the reason in why if the list of assets is not in block
 * style, one item per line. */
char *asset_edit_apply(const char *text, const struct asset_edit *edits, size_t count, const char *added, char why[ASSET_EDIT_WHY_BYTES]);

#endif
