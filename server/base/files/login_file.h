/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file with a user and a password, a line each. Thread: any. */
#ifndef BASE_FILES_LOGIN_FILE_H
#define BASE_FILES_LOGIN_FILE_H
#include <stdbool.h>
#include <stddef.h>

struct login_file {
    const char *user, *password; /* password NULL: it has no second line */
    char *text;
    size_t bytes;
};

/* Reads the file. Returns false if it cannot be read or names no user, and says so in why; login_file_forget() is not needed then. */
bool login_file_read(const char *path, struct login_file *login, char why[200]);
void login_file_forget(struct login_file *login); /* overwrites what was read, and frees it; what is zero is fine */

#endif
