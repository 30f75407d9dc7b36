/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is done to bring a plant in: exports are read, tags matched, models prepared, each by a program of its own. Thread: the reload
   thread. */
#ifndef IMPORT_JOB_H
#define IMPORT_JOB_H
#include "access/quota.h"
#include "importing/plant_import.h"

struct import_job_params {
    struct plant_import *import;
    const char *plant_path, *tags_path;
    const char *prepared;    /* folder of prepared assets */
    int lock;                /* of the plant's folder, which is lent to the programs */
    const struct quotas *quotas; /* limits of the programs */
    bool (*stop)(void *arg); /* whether to end */
    void *arg;
};

struct import_job;
/* Remembers plant file, tag list and matches as they are, and the last revision of the models. params need not outlive the call, but what
   it points to. */
struct import_job *import_job_begin(const struct import_job_params *params);
/* Runs the programs. Returns NULL, or one line of what went wrong; mem_free. *remark receives likewise what is wrong with the tag list
   where the models are good: they can be put in force without it. */
char *import_job_run(struct import_job *job, const struct import_order *order, char **remark);
/* Puts everything back as it was, models too, if import_job_run() changed anything: what others saved meanwhile stays beside, as
   NAME.undone. params.stop does not end it. Returns NULL, or one line of what went wrong; mem_free. */
char *import_job_undo(struct import_job *job);
/* Returns whether preparing was begun. */
bool import_job_prepares(const struct import_job *job);
void import_job_end(struct import_job **job); /* leaves NULL */

#endif
