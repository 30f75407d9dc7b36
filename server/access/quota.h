/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quotas: limits on the resources of clients and of model-reading programs (option --limit NAME=N). No input or output except
   quotas_print(). Call from any thread. */
#ifndef ACCESS_QUOTA_H
#define ACCESS_QUOTA_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum quota {
    QUOTA_CONNECTIONS,
    QUOTA_ADDRESS_CONNECTIONS,
    QUOTA_SESSIONS,
    QUOTA_ADDRESS_SESSIONS,
    QUOTA_PIXELS,
    QUOTA_ADDRESS_PIXELS,
    QUOTA_SESSION_PIXELS,
    QUOTA_MESSAGE_BYTES,
    QUOTA_MESSAGES,
    QUOTA_ADDRESS_MESSAGES,
    QUOTA_SNAPSHOTS,
    QUOTA_ADDRESS_SNAPSHOTS,
    QUOTA_QUESTIONS,
    QUOTA_ADDRESS_QUESTIONS,
    QUOTA_ANSWER_BYTES,
    QUOTA_ADDRESS_ANSWER_BYTES,
    QUOTA_LEAST_FPS,
    QUOTA_PATIENCE_S,
    QUOTA_ANSWER_WAIT_S,
    QUOTA_IMPORT_S,
    QUOTA_IMPORT_MB,
    QUOTA_PREPARE_S,
    QUOTA_PREPARE_MB,
    QUOTA_COUNT
};

struct quotas {
    int64_t at[QUOTA_COUNT];
    /* true: the limit was set on the command line. Clients on this machine are exempt from default limits per address, but not
       from a per-address limit set on the command line */
    bool given[QUOTA_COUNT];
};

/* Returns the default limits. */
struct quotas quotas_default(void);
/* Sets one limit from the text "NAME=N" of --limit. Returns false if there is no such limit, or N is out of range. */
bool quotas_parse(struct quotas *quotas, const char *text);
/* Prints the name, the default and a description of each quota, for --help. */
void quotas_print(FILE *out);

#endif
