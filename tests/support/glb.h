/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a GLB file in memory from its JSON and its binary chunk. */
#ifndef TESTS_GLB_H
#define TESTS_GLB_H
#include <stddef.h>

/* Returns the bytes of the file, and their number in *size; the caller frees them with mem_free(). bin NULL: the file gets no
   binary chunk. */
char *glb_build(const char *json, const void *bin, size_t bin_bytes, size_t *size);

#endif
