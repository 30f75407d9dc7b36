/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a secret, such as a token or a password, from the first line of a file. Call from any thread. */
#ifndef BASE_FILES_SECRET_H
#define BASE_FILES_SECRET_H

/* Reads the file, without caching, and returns its first line; free with secret_forget(). Returns NULL with the reason in *why
   (mem_free) if the file cannot be read. */
char *secret_read(const char *path, char **why);
void secret_forget(char *secret); /* Overwrites a secret in memory, so that no copy remains, and frees it; NULL is a no-op. */

#endif
