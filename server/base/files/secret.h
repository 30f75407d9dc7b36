/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a secret, such as a token or a password, from the first line of a file. Call from any thread. */
#ifndef BASE_FILES_SECRET_H
#define BASE_FILES_SECRET_H
#include <stddef.h>

/* Reads the file, without caching, and returns its first line; free with secret_forget(). Returns NULL with the reason in *why
   (mem_free) if the file cannot be read. */
char *secret_read(const char *path, char **why);
/* Writes "Bearer TOKEN", the value of an HTTP header Authorization, to `out`; TOKEN is the first word of the file. Returns NULL, or
   the reason why the file has no token of at most size - sizeof("Bearer ") bytes (valid until the next call of this thread). */
const char *secret_read_bearer(const char *path, char *out, size_t size);
void secret_forget(char *secret); /* Overwrites a secret in memory, so that no copy remains, and frees it; NULL is a no-op. */

#endif
