/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which assets there are and where they stand. */
#ifndef GENERATE_LAYOUT_H
#define GENERATE_LAYOUT_H
#include "equipment.h"

struct layout_asset {
    const char *name, *description;
};
extern const struct layout_asset layout_assets[];
extern const int layout_asset_count;

void layout_build(struct site *site);

#endif
