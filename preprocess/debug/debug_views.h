/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes debug views of a plant's assets, one GLB file each (`plantcast-prep --debug-view`). Call from one thread only. */
#ifndef PREPROCESS_DEBUG_VIEWS_H
#define PREPROCESS_DEBUG_VIEWS_H
#include <stdio.h>

#include "base/log/log.h"
#include "base/text/diag.h"
#include "base/workers.h"
#include "plant/plant.h"

struct debug_views_params {
    const char *folder;
    const char *asset; /* id of the only asset to show; NULL: show all assets */
    /* tag of a sensor: show only its asset, with distances from this sensor; NULL: distances from each asset's first sensor */
    const char *sensor;
    FILE *say; /* receives the names of the written files; NULL: prints nothing */
};

/* Reads the plant's models, computes distances and writes a GLB for each asset that params select. Errors go to diag. Returns false if any
   view could not be written. */
bool debug_views_write(struct log *log, struct workers *workers, const struct plant *plant, const struct debug_views_params *params,
                       struct diag *diag);

/* Returns the default folder for debug views: NAME.debug next to NAME.yaml. The caller frees it (mem_free). */
char *debug_views_folder(const struct plant *plant);

#endif
