/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs an import: reads exports, matches tags and prepares models, each with a program of its own. Call only in the reload thread. */
#ifndef IMPORT_JOB_H
#define IMPORT_JOB_H
#include "access/quota.h"
#include "importing/plant_import.h"

struct import_job_params {
    struct log *log;
    struct plant_import *import;
    const char *plant_path, *tags_path;
    const char *prepared;        /* folder of prepared assets */
    int lock;                    /* descriptor of the lock on the plant's folder, which is lent to the programs */
    const struct quotas *quotas; /* resource limits of the programs */
    bool (*stop)(void *arg);     /* callback; returns true if the import must stop */
    void *arg;
};

struct import_job;
/* Prepares the undo of an import: stores the present plant file, tag list and matches, and the identity of the newest revision of the
   models. `params` itself may be freed after the call; everything that its members point to must outlive the job. */
struct import_job *import_job_begin(const struct import_job_params *params);
/* Runs the programs. Returns NULL on success, else one line that says what went wrong (free with mem_free()). If the models can
   be used but the tag list is faulty, *remark receives the fault of the list (mem_free). */
char *import_job_run(struct import_job *job, const struct import_order *order, char **remark);
/* If import_job_run() changed anything, restores all files, including the models. A file that another program saved after the import
   changed it is renamed to NAME.undone. params.stop does not end the undo. Returns NULL on success, else one line that says what went
   wrong (mem_free). */
char *import_job_undo(struct import_job *job);
/* Returns true if plantcast-prep, which prepares the models, was started. */
bool import_job_prepares(const struct import_job *job);
void import_job_end(struct import_job **job); /* frees the job and sets *job to NULL */

#endif
