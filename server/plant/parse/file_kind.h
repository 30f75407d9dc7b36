/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognises a file's kind from its first bytes, for errors about a file that a user named by mistake. Call from any thread. */
#ifndef PLANT_PARSE_FILE_KIND_H
#define PLANT_PARSE_FILE_KIND_H

/* Returns a description of a file's kind, such as "a STEP file" or "a model (GLB)" (static). Returns NULL if the kind is unknown (text,
   for instance) or the file cannot be read. */
const char *file_kind_of(const char *path);

#endif
