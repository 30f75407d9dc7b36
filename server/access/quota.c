/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of limits on clients and on model-reading programs: names, defaults and ranges. */
#include "access/quota.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/wire.h"

static const struct {
    const char *name;
    int64_t usual, low, high;
    const char *help;
} table[QUOTA_COUNT] = {
    [QUOTA_CONNECTIONS] = { "connections", 4096, 1, 60000, "maximum number of open TCP connections, for all clients together" },
    [QUOTA_ADDRESS_CONNECTIONS] = { "address-connections", 64, 1, 60000, "maximum number of open TCP connections from one client address" },
    [QUOTA_SESSIONS] = { "sessions", 1000, 1, 50000, "maximum number of open picture streams (WebSocket), for all clients together" },
    [QUOTA_ADDRESS_SESSIONS] = { "address-sessions", 32, 1, 50000, "maximum number of open picture streams from one client address" },
    [QUOTA_PIXELS] = { "pixels", 512 << 20, 256, INT64_C(1) << 40,
                       "maximum number of pixels in the pictures of all open streams together" },
    [QUOTA_ADDRESS_PIXELS] = { "address-pixels", 128 << 20, 256, INT64_C(1) << 40,
                               "maximum number of pixels in the pictures of all open streams from one client address" },
    [QUOTA_SESSION_PIXELS] = { "session-pixels", 16 << 20, 256, 16 << 20,
                               "maximum number of pixels (width x height) in the picture of one stream" },
    [QUOTA_MESSAGE_BYTES] = { "message-bytes", WIRE_MAX_MESSAGE_BYTES, 1024, WIRE_MAX_MESSAGE_BYTES,
                              "maximum size in bytes of a message from a client" },
    [QUOTA_MESSAGES] = { "messages", 1000, 10, 1000000,
                         "maximum number of messages per second from one stream; further messages are delayed" },
    [QUOTA_ADDRESS_MESSAGES] = { "address-messages", 8000, 10, 1000000,
                                 "maximum number of messages per second from all streams of one client address" },
    [QUOTA_SNAPSHOTS] = { "snapshots", 8, 1, 1000,
                          "maximum number of HTTP requests for pictures and pixel values in progress, for all clients together" },
    [QUOTA_ADDRESS_SNAPSHOTS] = { "address-snapshots", 4, 1, 1000,
                                  "maximum number of HTTP requests for pictures and pixel values in progress from one client address" },
    [QUOTA_QUESTIONS] = { "questions", 128, 1, 128, "maximum number of HTTP requests for history in progress, for all clients together" },
    [QUOTA_ADDRESS_QUESTIONS] = { "address-questions", 32, 1, 128,
                                  "maximum number of HTTP requests for history in progress from one client address" },
    [QUOTA_ANSWER_BYTES] = { "answer-bytes", 192 << 20, 1 << 20, INT64_C(1) << 40,
                             "maximum number of bytes of HTTP responses not yet read, for all clients together" },
    [QUOTA_ADDRESS_ANSWER_BYTES] = { "address-answer-bytes", 96 << 20, 1 << 20, INT64_C(1) << 40,
                                     "maximum number of bytes of HTTP responses not yet read by one client address" },
    [QUOTA_LEAST_FPS] = { "least-fps", 5, 0, 1000,
                          "lowest permitted frame rate of moving views, in frames per second; clients that would reduce it further are "
                          "refused" },
    [QUOTA_PATIENCE_S] = { "patience", 10, 1, 600,
                           "time limit in seconds within which a client must complete an HTTP request, its hello or a message" },
    [QUOTA_ANSWER_WAIT_S] = { "answer-wait", 120, 1, 3600, "time limit in seconds for answering an HTTP request for a picture or history" },
    [QUOTA_IMPORT_S] = { "import-seconds", 120, 1, 86400, "time limit in seconds for reading one model or tag list" },
    [QUOTA_IMPORT_MB] = { "import-megabytes", 2048, 64, 1000000, "memory limit in MB for reading one model or tag list" },
    [QUOTA_PREPARE_S] = { "prepare-seconds", 14400, 1, 7 * 86400, "time limit in seconds for preparing the models (plantcast-prep)" },
    [QUOTA_PREPARE_MB] = { "prepare-megabytes", 0, 0, 1 << 24,
                           "memory limit in MB for preparing the models; 0: three quarters of the machine's memory" },
};

struct quotas quotas_default(void)
{
    struct quotas quotas = { .given = { false } };
    for (int i = 0; i < QUOTA_COUNT; i++)
        quotas.at[i] = table[i].usual;
    return quotas;
}

bool quotas_parse(struct quotas *quotas, const char *text)
{
    size_t n = strcspn(text, "=");
    for (int i = 0; i < QUOTA_COUNT; i++) {
        if (strlen(table[i].name) != n || strncmp(table[i].name, text, n) != 0 || text[n] != '=')
            continue;
        char *end;
        errno = 0;
        long long value = strtoll(text + n + 1, &end, 10);
        if (end == text + n + 1 || *end || errno || value < table[i].low || value > table[i].high)
            return false;
        quotas->at[i] = value;
        quotas->given[i] = true;
        return true;
    }
    return false;
}

void quotas_print(FILE *out)
{
    for (int i = 0; i < QUOTA_COUNT; i++)
        fprintf(out, "      %-20s %10" PRId64 "  %s\n", table[i].name, table[i].usual, table[i].help);
}
