/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a file is that somebody named by mistake, by how it begins. Pure. Thread: any. */
#ifndef PLANT_FILE_KIND_H
#define PLANT_FILE_KIND_H

/* Tells what a file is: "a STEP file", "a model (GLB)", ... Returns NULL for what is not known, text for instance, and for a file that
   cannot be read. */
const char *file_kind_of(const char *path);

#endif
