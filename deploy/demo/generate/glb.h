/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the model as binary glTF 2.0. */
#ifndef GENERATE_GLB_H
#define GENERATE_GLB_H
#include "model.h"

/* One mesh with one primitive per model mesh; the nodes hang below a root that turns Z up into glTF's Y up. 0 or -errno. */
int glb_write(const struct model *model, const char *path);

#endif
