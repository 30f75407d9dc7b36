/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Brings readings to the store, each at the time that its sender states. Thread: one. */
#ifndef VALUE_STAMPED_WRITER_H
#define VALUE_STAMPED_WRITER_H
#include "plant/plant.h"
#include "value/store.h"

struct stamped_value {
    double value;
    uint32_t quality;
    int64_t utc_ns; /* as its sender states it; 0: it does not */
};

struct stamped_writer {
    struct store *store;
    const struct plant *plant;
    int64_t mono_ns, utc_ns; /* now: of the message that is being read */
    int64_t worst_skew_ns;   /* of a time that was stated in it, against ours: > 0 is ahead. 0: none */
    size_t written;          /* readings of it */
    struct sample *samples;  /* of one time, not written yet; room for all tags */
    size_t count;
    int64_t at_utc_ns, at_mono_ns; /* their time */
    struct {
        int64_t utc_ns, mono_ns; /* of its last sample, by tag */
        bool is_stated;          /* the time is its sender's */
    } *last;
};

void stamped_writer_init(struct stamped_writer *writer, const struct plant *plant, struct store *store);
void stamped_writer_finish(struct stamped_writer *writer);
/* Begins a message that has arrived now. */
void stamped_writer_begin(struct stamped_writer *writer, int64_t now_mono_ns, int64_t now_utc_ns);
/* Takes the value that the message holds for a tag, before scaling. was_kept: the broker kept it, and it may have changed since: it is
   Uncertain_LastUsableValue at best. A time ahead of ours is taken for now. in_order: a time
   before that of the tag's last sample is taken for that one; else such a sample is passed over. */
void stamped_writer_add(struct stamped_writer *writer, int tag, const struct stamped_value *value, bool was_kept, bool in_order);
/* Takes a quality in place of a value, from now on; where times are stated, from the last one on: by a clock that is behind,
   what comes next would be older than now. */
void stamped_writer_add_bad(struct stamped_writer *writer, int tag, uint32_t quality);
void stamped_writer_end(struct stamped_writer *writer); /* writes what is left */

#endif
