/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast reload`: makes a daemon on this machine reload its plant, and prints the result. */
#include <errno.h>
#include <getopt.h>
#include <jansson.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "clients/cli/commands.h"

enum { TIMEOUT_S = 600 };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast reload PID [--runtime DIR] [--timeout SECONDS]\n"
          "\n"
          "Sends SIGHUP to the daemon with process ID PID, which reloads its plant file and tag list.\n"
          "Waits for the result. If the daemon rejects the files, prints the reasons; the daemon keeps the old files in use.\n"
          "Intended for ExecReload= of a systemd unit. From another machine, use POST /api/v1/reload.\n"
          "\n"
          "  --runtime DIR      folder to which the daemon writes the result: the value of RUNTIME_DIRECTORY in the\n"
          "                     daemon's environment (default: RUNTIME_DIRECTORY in this command's environment)\n"
          "  --timeout SECONDS  maximum time to wait for the result (default: 600)\n"
          "Exit status: 0 reloaded, 1 rejected.\n",
          out);
}

/* Reads the result of a reload from the file that the daemon writes. Returns NULL if the file has no result yet of a reload
   that began at since_ns or later. */
static json_t *read_result(const char *path, int64_t since_ns)
{
    json_t *file = json_load_file(path, 0, NULL), *result = NULL;
    if (file && json_integer_value(json_object_get(file, "begun_ns")) >= since_ns)
        result = json_incref(json_object_get(file, "result"));
    json_decref(file);
    return result;
}

static int say(const json_t *result)
{
    bool good = json_is_true(json_object_get(result, "reloaded"));
    const json_t *lines = json_object_get(result, good ? "changes" : "errors"), *line;
    const char *configuration = json_string_value(json_object_get(result, "configuration"));
    size_t i;
    json_array_foreach(lines, i, line)
    {
        fprintf(good ? stdout : stderr, "%s\n", json_string_value(line));
    }
    if (good)
        printf("reloaded: configuration %s\n", configuration);
    else
        fprintf(stderr, "plantcast: not reloaded: the daemon keeps configuration %s\n", configuration);
    return good ? 0 : 1;
}

static int fail(const char *what, const char *why)
{
    fprintf(stderr, "plantcast: %s: %s\n", what, why);
    return 1;
}

static int reload(const char *daemon, pid_t pid, const char *runtime, int timeout_s)
{
    int64_t since_ns = clock_mono_ns(), end_ns = since_ns + timeout_s * NS_PER_S;
    char *path = mem_printf("%s/reload.json", runtime);
    json_t *result = NULL;
    int status = 1;
    if (kill(pid, SIGHUP) != 0)
        status = fail(daemon, strerror(errno));
    else {
        while (!(result = read_result(path, since_ns)) && kill(pid, 0) == 0 && clock_mono_ns() < end_ns)
            usleep(50000);
        status = result ? say(result)
                        : fail(daemon, clock_mono_ns() >= end_ns ? "the daemon did not finish the reload within --timeout"
                                                                 : "the daemon exited during the reload");
    }
    json_decref(result);
    mem_free(path);
    return status;
}

int cmd_reload(int argc, char **argv)
{
    static const struct option options[] = {
        { "runtime", required_argument, NULL, 'r' },
        { "timeout", required_argument, NULL, 't' },
        { "help", no_argument, NULL, 'h' },
        { NULL, 0, NULL, 0 },
    };
    const char *runtime = getenv("RUNTIME_DIRECTORY");
    int timeout_s = TIMEOUT_S;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;)
        switch (option) {
        case 'r': runtime = optarg; break;
        case 't': timeout_s = atoi(optarg); break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    char *end = NULL;
    long pid = optind + 1 == argc ? strtol(argv[optind], &end, 10) : 0;
    if (!end || *end || pid <= 1 || pid > INT_MAX || timeout_s <= 0 || !runtime || !*runtime) {
        print_usage(stderr);
        return 2;
    }
    return reload(argv[optind], (pid_t)pid, runtime, timeout_s);
}
