/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses the contents of cache files with zstd, without loss. The contents are arrays of integers and floating-point
   numbers. They are compressed in chunks; each chunk is stored in the layout that makes it smallest. Call from any thread. */
#ifndef BASE_FILES_COMPRESS_H
#define BASE_FILES_COMPRESS_H
#include <stdbool.h>
#include <stddef.h>

#include "base/files/atomic_file.h"

/* Compresses the parts, joined in this order. Passes the compressed bytes to put() piece by piece; a result of put() other than 0 ends the
   compression. Returns 0, the result of put(), or -ENOMEM. */
int compress_parts(const struct atomic_file_part *parts, size_t part_count, int (*put)(void *arg, const void *bytes, size_t count),
                   void *arg);

/* Reads compressed bytes from start to end, without holding all decompressed bytes in memory. Call from one thread only. */
struct decompressor;
/* Creates a decompressor for the bytes that compress_parts() made. Returns NULL if bytes are missing, if the sizes stored in
   them contradict each other, or if memory is short. `compressed` stays the caller's and must outlive the decompressor; end
   with decompressor_destroy(). */
struct decompressor *decompressor_create(const void *compressed, size_t bytes);
/* Copies the next `count` decompressed bytes. Returns false if fewer are left or the compressed bytes are damaged. */
bool decompressor_read(struct decompressor *d, void *to, size_t count);
/* Returns how many bytes decompressor_read() can still return. */
size_t decompressor_left(const struct decompressor *d);
void decompressor_destroy(struct decompressor **d); /* &NULL is fine; leaves NULL */

/* Decompresses all bytes that compress_parts() made. Returns the joined parts, and their number of bytes in *count; free with
   mem_free(). The memory is aligned for any type. Returns NULL if the compressed bytes are incomplete or damaged, or if memory
   is short. Damaged bytes never cause an allocation of more than 256 KiB for each chunk that is present. */
void *decompress(const void *compressed, size_t bytes, size_t *count);
/* Returns the number of bytes that decompress() returns, or SIZE_MAX if the compressed bytes are incomplete or the sizes in them contradict
   each other. Allocates nothing and does not decompress. */
size_t decompressed_size(const void *compressed, size_t bytes);

#endif
