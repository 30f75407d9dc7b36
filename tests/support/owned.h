/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resources that belong to the running test and are released after its tear-down, the newest first. Resources of a group's
   set-up, and of programs without tests, are released when the program exits. Call from any thread. */
#ifndef TESTS_OWNED_H
#define TESTS_OWNED_H
#include <jansson.h>
#include <stddef.h>

struct counters;
struct log;
struct plant;
struct snapshot;
struct store;
struct workers;

/* Hands a resource over to the running test: release(resource) is called once, after the test's tear-down. */
void owned_add(void (*release)(void *resource), void *resource);
/* Returns the number of resources that are not released yet. */
size_t owned_count(void);
/* Releases all but the `kept` oldest resources. */
void owned_release(size_t kept);

/* Each of these functions creates a resource and hands it over with owned_add(), so that its caller need not release it. */
json_t *test_json(json_t *json); /* hands `json` over and returns it; accepts NULL */
char *test_printf(const char *format, ...) __attribute__((format(printf, 1, 2)));
struct log *test_log(void); /* returns a log that prints errors only */
struct counters *test_counters(void);
struct snapshot *test_snapshot(size_t tag_count);
struct store *test_store(const struct plant *plant);
struct workers *test_workers(int threads); /* creates a pool of workers; threads 0: one thread per core */

#endif
