/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognizes what kind of file somebody named by mistake, from its first bytes. Thread: any. */
#ifndef PLANT_PARSE_FILE_KIND_H
#define PLANT_PARSE_FILE_KIND_H

/* Returns what a file is: "a STEP file", "a model (GLB)", ... Returns NULL if it is not known, text for instance, or cannot be
   read. */
const char *file_kind_of(const char *path);

#endif
