/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The spool: a file for rows that could not be written to history before the daemon ended. The next start reads it. Call from one
   thread only. */
#ifndef HISTORY_SPOOL_H
#define HISTORY_SPOOL_H
#include "history/recorder.h"

struct spool_rows {
    struct recorder_rows kept, held; /* kept: recorded rows; held: newest samples that are not recorded yet (month_file_write()) */
};

/* Returns the possible paths of the spool file for a history folder, best first: in the folder itself, in RUNTIME_DIRECTORY, in
   /var/tmp. The list is terminated by NULL; free with spool_places_free(). */
char **spool_places(const char *folder);
void spool_places_free(char **places);
/* Reserves disk space in the history folder for a spool file, which can then be written even if the disk is full. Reserves it
   only while the disk has plenty of space; an existing reserve is kept. Returns 0 or -errno; -ENOSPC: the disk does not have
   plenty. */
int spool_reserve(const char *folder);
/* Writes all rows to the spool file, readable only by its owner; if the disk is full, to the space reserved in the same folder.
   Returns 0 or -errno. */
int spool_write(const char *path, const struct plant *plant, const struct spool_rows *rows);
/* Appends the spool file's rows for tags that the plant still has, in the tags' current units. *foreign receives the number of
   rows whose tag is no longer in the plant, or whose unit cannot be converted. Refuses a file of another user. Returns 0 or
   -errno; -ENOENT: no such file. */
int spool_read(const char *path, const struct plant *plant, struct spool_rows *rows, size_t *foreign);

#endif
