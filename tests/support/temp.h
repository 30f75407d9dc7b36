/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files for one test, in its own folder under TMPDIR. After the test, the folders are removed and the returned paths are freed
   automatically (tests/support/owned.h). Aborts if a file cannot be created. Call from any thread. */
#ifndef TESTS_TEMP_H
#define TESTS_TEMP_H
#include <stddef.h>

char *temp_folder(void); /* creates a folder, which is removed after the test with everything in it */
/* Writes FOLDER/NAME, creates missing folders, and returns the path. */
char *temp_write(const char *folder, const char *name, const void *bytes, size_t count);
char *temp_write_text(const char *folder, const char *name, const char *text);
char *temp_path(const char *folder, const char *name);

#endif
