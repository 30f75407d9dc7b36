/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes readings to the store, each with the timestamp that its sender states. Thread: one. */
#ifndef VALUE_STAMPED_WRITER_H
#define VALUE_STAMPED_WRITER_H
#include "plant/plant.h"
#include "value/store.h"

struct stamped_value {
    double value;
    uint32_t quality;
    int64_t utc_ns; /* sender's timestamp; 0: not stated */
};

struct stamped_writer {
    struct store *store;
    const struct plant *plant;
    int64_t mono_ns, utc_ns; /* arrival time of the message being read */
    int64_t worst_skew_ns;   /* largest difference between a time stated in the message and our clock; > 0: the sender is ahead. 0: none */
    size_t written;          /* readings of this message written so far */
    struct sample *samples;  /* samples not written yet, all of the same time; room for one of each tag */
    size_t count;
    int64_t at_utc_ns, at_mono_ns; /* time of the pending samples */
    struct {
        int64_t utc_ns, mono_ns; /* time of the tag's last sample; array by tag */
        bool is_stated;          /* the sender stated that time */
    } * last;
};

void stamped_writer_init(struct stamped_writer *writer, const struct plant *plant, struct store *store);
void stamped_writer_finish(struct stamped_writer *writer);
/* Begins a message with its arrival time. */
void stamped_writer_begin(struct stamped_writer *writer, int64_t now_mono_ns, int64_t now_utc_ns);
/* Adds the value that the message holds for a tag, before scaling. was_kept: the broker retained the value, which may have changed
   since, so its quality is Uncertain_LastUsableValue at best. A time ahead of our clock is replaced by now. in_order: a time before that
   of the tag's last sample is replaced by the latter; without in_order the store ignores such a sample. */
void stamped_writer_add(struct stamped_writer *writer, int tag, const struct stamped_value *value, bool was_kept, bool in_order);
/* Sets a Bad quality for a tag from now on. If the sender states times, the quality counts from the tag's last time instead: otherwise a
   later value from a sender whose clock is behind would count as older, and be ignored. */
void stamped_writer_add_bad(struct stamped_writer *writer, int tag, uint32_t quality);
void stamped_writer_end(struct stamped_writer *writer); /* Writes the pending samples. */

#endif
