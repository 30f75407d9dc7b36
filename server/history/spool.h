/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spool: rows that could not be written to history when the daemon ended, stored in a separate file until the next start. Thread: one. */
#ifndef HISTORY_SPOOL_H
#define HISTORY_SPOOL_H
#include "history/recorder.h"

struct spool_rows {
    struct recorder_rows kept, held; /* kept: recorded rows; held: newest samples that are not recorded yet (month_file_write()) */
};

/* Returns possible paths for the spool of a history folder, best first: in the folder itself, RUNTIME_DIRECTORY, /var/tmp. The list ends
   with NULL; free with spool_places_free(). */
char **spool_places(const char *folder);
void spool_places_free(char **places);
/* Reserves disk space in the folder for a spool file, which then fits even on a full disk and survives a reboot. The space is reserved only
   while the disk has plenty; a reserve that exists is kept. Returns 0 or -errno; -ENOSPC: the disk does not have plenty. */
int spool_reserve(const char *folder);
/* Writes all rows to the file, readable by its owner only; if the disk is full, into the reserve in the same folder. Returns 0 or
   -errno. */
int spool_write(const char *path, const struct plant *plant, const struct spool_rows *rows);
/* Appends the rows of the file whose tags are still in the plant, in the tags' present units. *foreign receives the number of rows whose
   tags are not in the plant, or whose unit cannot be converted. Refuses a file of another user. Returns 0 or -errno; -ENOENT: no such
   file. */
int spool_read(const char *path, const struct plant *plant, struct spool_rows *rows, size_t *foreign);

#endif
