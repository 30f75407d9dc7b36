/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits and builds file names. The caller frees all results with mem_free. Call from any thread. */
#ifndef PREPROCESS_IMPORT_FILE_NAME_H
#define PREPROCESS_IMPORT_FILE_NAME_H

/* Returns the path without the ending ".gz" (in upper or lower case) of a compressed file. */
char *file_name_without_gz(const char *path);
/* Returns the path with its ending replaced: with ".att", "a/b.rvm" and "a/b.rvm.gz" both give "a/b.att". */
char *file_name_with_ending(const char *path, const char *ending);
/* Returns the file name without folder and ending: "a/b.rvm" and "a/b.rvm.gz" give "b". */
char *file_name_stem(const char *path);

#endif
