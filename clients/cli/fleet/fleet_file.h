/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fleet file (YAML): the plants whose servers `plantcast fleet` watches. deploy/pages/MONITORING.md describes it. Call from one
   thread only. */
#ifndef CLI_FLEET_FLEET_FILE_H
#define CLI_FLEET_FLEET_FILE_H
#include <stddef.h>

#include "base/text/diag.h"

enum { FLEET_PLANTS = 1000 };

struct fleet_plant {
    char *id;                   /* identifier in addresses and metrics */
    char *name;                 /* display name of the plant; equals the id if the file gives none */
    char *url;                  /* ends with a slash */
    char *token_file, *ca_file; /* NULL: none */
    double poll_s, picture_s;   /* minimum seconds between two requests to this server: poll_s for metrics, picture_s for pictures;
                                   picture_s 0: no pictures are requested */
    int line;
};

struct fleet_file {
    char *path, *folder, *name;
    double poll_s, picture_s; /* default intervals in seconds, for plants whose entry sets none (struct fleet_plant) */
    struct fleet_plant *plants;
    size_t count;
};

/* Reads a fleet file; findings go to diag. Returns NULL if there was an error. */
struct fleet_file *fleet_file_read(const char *path, struct diag *diag);
void fleet_file_free(struct fleet_file **file); /* &NULL is fine; leaves NULL */

#endif
