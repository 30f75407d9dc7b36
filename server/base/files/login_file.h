/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a file with a user name on its first line and a password on its second. Call from any thread. */
#ifndef BASE_FILES_LOGIN_FILE_H
#define BASE_FILES_LOGIN_FILE_H
#include <stdbool.h>
#include <stddef.h>

struct login_file {
    const char *user, *password; /* user and password; password NULL: the file has no second line */
    char *text;
    size_t bytes;
};

/* Reads the file. Returns false with the reason in `why` if the file cannot be read or has no user name; login_file_forget() is
   then not needed. */
bool login_file_read(const char *path, struct login_file *login, char why[200]);
void login_file_forget(struct login_file *login); /* Overwrites the user name and password and frees them; a zeroed struct is fine. */

#endif
