/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which tags were proven in the field: that a value forced at the transmitter arrives here, under that name. Kept in a file that only
   grows, proofs.csv in the folder of the history (LOOPCHECK.md). Thread: the loop. */
#ifndef LOOPCHECK_LOOP_CHECKS_H
#define LOOPCHECK_LOOP_CHECKS_H
#include "base/log.h"
#include "base/text.h"
#include "plant/plant.h"

enum { LOOP_CHECK_NAME_BYTES = 64, LOOP_CHECK_REMARK_BYTES = 160 };

enum loop_check_state {
    LOOP_CHECK_NONE,
    LOOP_CHECK_PASSED,
    LOOP_CHECK_FAILED,
    LOOP_CHECK_CHANGED /* it was looked at, but its address, scale or place is another since: as good as never */
};
extern const char *const loop_check_state_names[]; /* by loop_check_state */

struct loop_check {
    enum loop_check_state state;
    int64_t time_us;                   /* UTC */
    double value, expected, tolerance; /* engineering units; NaN: none */
    char who[LOOP_CHECK_NAME_BYTES], remark[LOOP_CHECK_REMARK_BYTES];
};

#define LOOP_CHECKS_FILE "proofs.csv"

struct loop_checks;
/* folder must be there, or come to be there before the first is added. A file that cannot be read counts as none, and says so in the log.
   Never NULL. plant must outlive it. */
struct loop_checks *loop_checks_open(struct log *log, const struct plant *plant, const char *folder);
void loop_checks_close(struct loop_checks **loop_checks); /* &NULL is fine; leaves NULL */
/* NULL: it is kept, on disk. Else why not (static). */
const char *loop_checks_add(struct loop_checks *loop_checks, int tag, const struct loop_check *check);
const struct loop_check *loop_checks_of(const struct loop_checks *loop_checks, int tag);
bool loop_checks_begun(
    const struct loop_checks *loop_checks); /* somebody looked at a tag, ever: from then on those not proven are said to be so */
uint64_t loop_checks_number(const struct loop_checks *loop_checks);              /* grows with each that is added */
uint64_t loop_checks_number_of(const struct loop_checks *loop_checks, int tag);  /* when this one was added; 0: before */
void loop_checks_print(const struct loop_checks *loop_checks, struct text *out); /* all tags with a source, as CSV */
/* To be said with every value: others have been looked at, and this one has not passed. Computed tags need none. Thread: any. */
bool loop_checks_unproven(const struct loop_checks *loop_checks, int tag);
/* Of what makes a loop check void when it changes: source, address, type, byte order, scaling, asset and place. */
uint64_t loop_check_fingerprint(const struct plant *plant, int tag);

#endif
