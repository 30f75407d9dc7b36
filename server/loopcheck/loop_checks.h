/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records of loop checks: which tags have been shown to be wired correctly, since a value forced at the transmitter arrived under their
   name. They are in a file that is only appended to, proofs.csv in the folder of the history (LOOPCHECK.md). Thread: the loop. */
#ifndef LOOPCHECK_LOOP_CHECKS_H
#define LOOPCHECK_LOOP_CHECKS_H
#include "base/log/log.h"
#include "base/refusal.h"
#include "base/text/text.h"
#include "plant/plant.h"

enum { LOOP_CHECK_NAME_BYTES = 64, LOOP_CHECK_REMARK_BYTES = 160 };

enum loop_check_state {
    LOOP_CHECK_NONE,
    LOOP_CHECK_PASSED,
    LOOP_CHECK_FAILED,
    LOOP_CHECK_CHANGED /* it was checked, but its address, scaling or place has changed since: counts as not checked */
};
extern const char *const loop_check_state_names[]; /* by loop_check_state */

struct loop_check {
    enum loop_check_state state;
    int64_t time_us;                  /* UTC */
    double value, expected, tolerance; /* engineering units; NaN: none */
    char who[LOOP_CHECK_NAME_BYTES], remark[LOOP_CHECK_REMARK_BYTES];
};

#define LOOP_CHECKS_FILE "proofs.csv"

struct loop_checks;
/* Reads the records of a plant. folder must exist before the first record is added. A file that cannot be read counts as empty (logged).
   Never returns NULL. plant must outlive them. */
struct loop_checks *loop_checks_open(struct log *log, const struct plant *plant, const char *folder);
void loop_checks_close(struct loop_checks **loop_checks); /* &NULL is fine; leaves NULL */
/* Adds a record of a tag and writes it to the disk. Returns NULL, or why it could not (static). */
enum refusal_code loop_checks_add(struct loop_checks *loop_checks, int tag, const struct loop_check *check);
/* Returns the last record of a tag. */
const struct loop_check *loop_checks_of(const struct loop_checks *loop_checks, int tag);
/* Returns whether any tag has been checked; from then on, tags that have not passed are marked as unproven. */
bool loop_checks_begun(
    const struct loop_checks *loop_checks);
uint64_t loop_checks_number(const struct loop_checks *loop_checks); /* returns a number that increases with each record */
/* Returns that number when the last record of this tag was added; 0: before the daemon started. */
uint64_t loop_checks_number_of(const struct loop_checks *loop_checks, int tag);
void loop_checks_print(const struct loop_checks *loop_checks, struct text *out); /* appends all tags with a source, as CSV */
/* Returns whether the tag is to be marked as unproven: others have been checked, and this one has not passed. Derived tags are not checked.
   Thread: any. */
bool loop_checks_unproven(const struct loop_checks *loop_checks, int tag);
/* Returns a hash of what makes a loop check void when it changes: source, address, type, byte order, scaling, asset and place. */
uint64_t loop_check_fingerprint(const struct plant *plant, int tag);

#endif
