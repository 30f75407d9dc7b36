/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a user name and a password from a file. */
#include "base/files/login_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

enum { LOGIN_BYTES = 4096 };

bool login_file_read(const char *path, struct login_file *login, char why[200])
{
    *login = (struct login_file){ .text = text_read_file(path, LOGIN_BYTES, &login->bytes) };
    if (!login->text) {
        snprintf(why, 200, "%.100s: %s", path, strerror(errno));
        return false;
    }
    char *rest = login->text;
    login->bytes = strlen(rest);
    login->user = strsep(&rest, "\r\n");
    rest += rest && *rest == '\n'; /* skips the \n of a line that ends with \r\n */
    login->password = rest ? strsep(&rest, "\r\n") : NULL;
    if (*login->user)
        return true;
    snprintf(why, 200, "%.100s: expected the user name in line 1 and the password in line 2", path);
    login_file_forget(login);
    return false;
}

void login_file_forget(struct login_file *login)
{
    if (login->text)
        explicit_bzero(login->text, login->bytes);
    mem_free(login->text);
    *login = (struct login_file){ 0 };
}
