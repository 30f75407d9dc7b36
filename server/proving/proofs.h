/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which tags were proven in the field: that a value forced at the transmitter arrives here, under that name. Kept in a file that only
   grows, proofs.csv in the folder of the history (PROVING.md). Thread: the loop. */
#ifndef PROVING_PROOFS_H
#define PROVING_PROOFS_H
#include "base/log.h"
#include "base/text.h"
#include "plant/plant.h"

enum { PROOF_NAME_BYTES = 64, PROOF_REMARK_BYTES = 160 };

enum proof_state {
    PROOF_NONE,
    PROOF_PASSED,
    PROOF_FAILED,
    PROOF_CHANGED /* it was looked at, but its address, scale or place is another since: as good as never */
};
extern const char *const proof_names[]; /* by proof_state */

struct proof {
    enum proof_state state;
    int64_t time_us;                  /* UTC */
    double value, expected, tolerance; /* engineering units; NaN: none */
    char who[PROOF_NAME_BYTES], remark[PROOF_REMARK_BYTES];
};

#define PROOFS_FILE "proofs.csv"

struct proofs;
/* folder must be there, or come to be there before the first is added. A file that cannot be read counts as none, and says so in the log.
   Never NULL. plant must outlive it. */
struct proofs *proofs_open(struct log *log, const struct plant *plant, const char *folder);
void proofs_close(struct proofs **proofs); /* &NULL is fine; leaves NULL */
/* NULL: it is kept, on disk. Else why not (static). */
const char *proofs_add(struct proofs *proofs, int tag, const struct proof *proof);
const struct proof *proofs_of(const struct proofs *proofs, int tag);
bool proofs_begun(const struct proofs *proofs);      /* somebody looked at a tag, ever: from then on those not proven are said to be so */
uint64_t proofs_number(const struct proofs *proofs); /* grows with each that is added */
uint64_t proofs_number_of(const struct proofs *proofs, int tag); /* when this one was added; 0: before */
void proofs_print(const struct proofs *proofs, struct text *out); /* all tags with a source, as CSV */
/* To be said with every value: others have been looked at, and this one has not passed. Computed tags need none. Thread: any. */
bool proofs_unproven(const struct proofs *proofs, int tag);
/* Of what makes a proof void when it changes: source, address, type, byte order, scaling, asset and place. */
uint64_t proof_fingerprint(const struct plant *plant, int tag);

#endif
