/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spool: rows that could not be written to history when the daemon ended, in a file elsewhere, for the next start. Thread: one. */
#ifndef HISTORY_SPOOL_H
#define HISTORY_SPOOL_H
#include "history/recorder.h"

struct spool_rows {
    struct recorder_rows kept, held; /* as month_file_write() takes them */
};

/* Returns the places for the spool of that history folder, best first: the folder itself, RUNTIME_DIRECTORY, /var/tmp. NULL ends them; free
   with spool_places_free. */
char **spool_places(const char *folder);
void spool_places_free(char **places);
/* Reserves room in the folder while the disk has plenty, so that even a full disk takes a spool, which then outlives a reboot. Does nothing
   where there is a reserve. Returns 0 or -errno; -ENOSPC: there is not plenty. */
int spool_reserve(const char *folder);
/* Writes all rows to the file, for its owner only; where the disk is full, into what was reserved beside it. Returns 0 or -errno. */
int spool_write(const char *path, const struct plant *plant, const struct spool_rows *rows);
/* Appends what the file holds of tags that are still in the plant, and says of how many rows the tags are not. A file of somebody else is
   refused. Returns 0 or -errno; -ENOENT: there is none. */
int spool_read(const char *path, const struct plant *plant, struct spool_rows *rows, size_t *foreign);

#endif
