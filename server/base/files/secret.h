/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file that holds one secret in its first line: a token, a password. Thread: any. */
#ifndef BASE_FILES_SECRET_H
#define BASE_FILES_SECRET_H

/* Returns the first line of the file, read anew each time; secret_forget(). NULL: it cannot be read, and *why (mem_free) says so. */
char *secret_read(const char *path, char **why);
void secret_forget(char *secret); /* overwrites and frees it; NULL is fine */

#endif
