/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resources of the running test that are released automatically after its tear-down, the newest first. Resources made in the
   set-up of a group, or in programs without tests, are released when the program exits. Call from any thread. */
#ifndef TESTS_OWNED_H
#define TESTS_OWNED_H
#include <jansson.h>
#include <stddef.h>

struct counters;
struct frame;
struct history_series;
struct log;
struct plant;
struct snapshot;
struct store;
struct text;
struct workers;

/* Registers a resource with the running test: release(resource) is called once after the test's tear-down. */
void owned_add(void (*release)(void *resource), void *resource);
/* Returns the number of resources that are not released yet. */
size_t owned_count(void);
/* Releases the newest resources until only the `kept` oldest ones are left. */
void owned_release(size_t kept);

/* Each of these functions creates a resource and registers it with owned_add(), so the caller must not release it. */
void *test_memory(void *memory); /* hands over memory to be freed with mem_free(), and returns it; accepts NULL */
struct frame *test_frame(struct frame *frame); /* hands the reference to `frame` over and returns `frame`; accepts NULL */
json_t *test_json(json_t *json); /* registers an existing `json` and returns it; NULL is allowed */
void test_series(const struct history_series *series); /* hands the arrays of the series over */
struct text *test_text(void); /* returns an empty text */
char *test_printf(const char *format, ...) __attribute__((format(printf, 1, 2)));
struct log *test_log(void); /* returns a log that prints errors only */
struct counters *test_counters(void);
struct snapshot *test_snapshot(size_t tag_count);
struct store *test_store(const struct plant *plant);
struct workers *test_workers(int threads); /* creates a pool of worker threads; threads: their number, 0: one per core */

#endif
