/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a GLB file from its JSON and its binary chunk. */
#ifndef TESTS_GLB_H
#define TESTS_GLB_H
#include <stddef.h>

/* Returns the file; the caller frees it with mem_free. bin NULL: no binary chunk. */
char *glb_build(const char *json, const void *bin, size_t bin_bytes, size_t *size);

#endif
