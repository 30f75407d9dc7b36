/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs an import: reads exports, matches tags and prepares models, each with a program of its own. Thread: the reload thread. */
#ifndef IMPORT_JOB_H
#define IMPORT_JOB_H
#include "access/quota.h"
#include "importing/plant_import.h"

struct import_job_params {
    struct plant_import *import;
    const char *plant_path, *tags_path;
    const char *prepared;        /* folder of prepared assets */
    int lock;                    /* descriptor of the lock on the plant's folder, which is lent to the programs */
    const struct quotas *quotas; /* resource limits of the programs */
    bool (*stop)(void *arg);     /* returns whether the import must end */
    void *arg;
};

struct import_job;
/* Stores the present plant file, tag list and matches, and the last revision of the models, for an undo. params itself need not outlive
   the call, but everything it points to must. */
struct import_job *import_job_begin(const struct import_job_params *params);
/* Runs the programs. Returns NULL on success, else one line that says what went wrong (free with mem_free()). *remark: set if the models
   are good but the tag list is not: what is wrong with the list (mem_free); the models can then be used without it. */
char *import_job_run(struct import_job *job, const struct import_order *order, char **remark);
/* If import_job_run() changed anything, restores all files, including the models. A file that another program saved meanwhile is renamed to
   NAME.undone. params.stop does not end it. Returns NULL on success, else one line that says what went wrong (mem_free). */
char *import_job_undo(struct import_job *job);
/* Returns whether preparing the models was begun. */
bool import_job_prepares(const struct import_job *job);
void import_job_end(struct import_job **job); /* sets *job to NULL */

#endif
