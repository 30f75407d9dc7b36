/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records of loop checks. A tag passes if a value that an engineer forces at its transmitter arrives as the tag's value, which
   shows that the tag is wired correctly. The records are in proofs.csv in the history folder, an append-only file
   (LOOPCHECK.md). Call only in the event loop. */
#ifndef LOOPCHECK_LOOP_CHECKS_H
#define LOOPCHECK_LOOP_CHECKS_H
#include "base/files/file_writer.h"
#include "base/refusal.h"
#include "base/text/text.h"
#include "plant/plant.h"

enum { LOOP_CHECK_NAME_BYTES = 64, LOOP_CHECK_REMARK_BYTES = 160, LOOP_CHECK_UNIT_BYTES = 64 };

enum loop_check_state {
    LOOP_CHECK_NONE,
    LOOP_CHECK_PASSED,
    LOOP_CHECK_FAILED,
    LOOP_CHECK_CHANGED /* the tag was checked, but its address, scaling or position has changed since then, so it counts as not checked */
};
extern const char *const loop_check_state_names[]; /* names of the loop check states, indexed by enum loop_check_state */

struct loop_check {
    enum loop_check_state state;
    int64_t time_us;                  /* time of the check, microseconds UTC */
    /* value: value that arrived as the tag's value; expected: value forced at the transmitter; tolerance: largest accepted
       difference; in `unit`, NaN: none */
    double value, expected, tolerance;
    /* the tag's unit, and loop_check_fingerprint(), at the time of the check; loop_checks_add() sets both */
    char unit[LOOP_CHECK_UNIT_BYTES];
    uint64_t fingerprint;
    char who[LOOP_CHECK_NAME_BYTES], remark[LOOP_CHECK_REMARK_BYTES];
};

#define LOOP_CHECKS_FILE "proofs.csv"

struct loop_checks;
/* Reads the loop checks of a plant. A file that cannot be read counts as empty (logged). folder: the history folder; NULL: this
   daemon draws for a core, and gets the core's checks from loop_checks_mirror(). writer: the thread that writes checks to disk; NULL:
   checks are written at once. Never returns NULL. plant and writer must outlive the result. */
struct loop_checks *loop_checks_open(struct log *log, const struct plant *plant, const char *folder, struct file_writer *writer);
/* Frees the loop checks and sets *loop_checks to NULL; accepts a pointer to NULL. */
void loop_checks_close(struct loop_checks **loop_checks);
/* Queues a loop check for writing; once it is on disk, file_writer_collect() makes it the tag's newest check. Returns
   REFUSAL_NONE, or why it could not be queued. */
enum refusal_code loop_checks_add(struct loop_checks *loop_checks, int tag, const struct loop_check *check);
/* Returns true if this daemon mirrors the loop checks of its core; false: it records its own. */
bool loop_checks_are_mirrored(const struct loop_checks *loop_checks);
/* Returns REFUSAL_NONE if this daemon records loop checks, or why it does not. loop_checks NULL: no history is recorded. */
enum refusal_code loop_checks_refusal(const struct loop_checks *loop_checks);
struct loop_check_row {
    int tag;
    struct loop_check check;
};
/* Stores checks that the core has recorded. all: forgets the checks stored before. begun: loop_checks_begun() of the core. */
void loop_checks_mirror(struct loop_checks *loop_checks, const struct loop_check_row *rows, size_t count, bool all, bool begun);
/* Returns the newest loop check recorded for a tag. */
const struct loop_check *loop_checks_of(const struct loop_checks *loop_checks, int tag);
/* Returns true if any tag of the plant has been checked. From the first check on, all tags that have not passed are marked as unproven. */
bool loop_checks_begun(const struct loop_checks *loop_checks);
/* Returns a sequence number that increases with each recorded loop check. */
uint64_t loop_checks_number(const struct loop_checks *loop_checks);
/* Returns the sequence number of the newest loop_checks_mirror() with `all`; 0: none. */
uint64_t loop_checks_replaced_number(const struct loop_checks *loop_checks);
/* Returns the sequence number of the tag's newest loop check; 0: it was recorded before the daemon started. */
uint64_t loop_checks_number_of(const struct loop_checks *loop_checks, int tag);
/* Appends CSV: a header line, then the newest check of every tag that has a source. */
void loop_checks_print(const struct loop_checks *loop_checks, struct text *out);
/* Returns true if pictures must mark the tag as unproven: at least one tag has been checked, but this one has not passed.
   Derived tags are never marked. Call from any thread. */
bool loop_checks_unproven(const struct loop_checks *loop_checks, int tag);
/* Returns a hash of all settings whose change invalidates a tag's loop check: source, address (with what the source's settings
   contribute, such as its Modbus unit), type, byte order, scaling, NE 43, values that mean an open circuit, asset and position. */
uint64_t loop_check_fingerprint(const struct plant *plant, int tag);

#endif
