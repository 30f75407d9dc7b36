/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances that were found before, by the place that they start from: KEY.columns beside the asset files. Safe to delete; columns that
   are no good count as none. It grows to the most sensors that the asset ever had at once. */
#ifndef PREPROCESS_COLUMNS_H
#define PREPROCESS_COLUMNS_H
#include <stdatomic.h>
#include <stdint.h>

#include "surface/surface.h"

struct columns {
    int fd;
    atomic_bool may_write;
    uint64_t key;
    size_t length; /* of a column */
    const double (*places_m)[3];
    size_t count;
    size_t *slots; /* in the file, of each place; SIZE_MAX: none */
    atomic_size_t kept; /* places whose column was there */
};

/* places_m: where distances are wanted from; they must outlive it. Never fails: what cannot be read or written is not kept. */
void columns_open(struct columns *columns, const char *folder, uint64_t key, size_t length, const double (*places_m)[3], size_t count);
void columns_close(struct columns *columns);
struct surface_columns columns_of_surface(struct columns *columns);

#endif
