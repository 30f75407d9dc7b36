/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes samples to the store, each with the timestamp that its sender (publisher or server) states. Call from one thread only. */
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
    int64_t mono_ns, utc_ns; /* arrival time of the message that is being processed */
    /* largest difference between a time stated in the message and our clock, in nanoseconds; above 0: the sender's clock is ahead; 0: no
       difference */
    int64_t worst_skew_ns;
    size_t written; /* number of samples of this message written to the store so far */
    /* samples of the current batch, which are not written yet and all have the same time; room for as many as there are tags */
    struct sample *samples;
    size_t count;
    int64_t at_utc_ns, at_mono_ns; /* time, UTC and monotonic, that all samples of the batch have */
    bool are_undated;              /* true: the batch must be written with store_write_undated() */
    struct {
        int64_t utc_ns, mono_ns; /* [tag]: time of the tag's last sample, UTC and monotonic */
        bool is_stated;          /* the sender stated that time */
    } * last;
};

void stamped_writer_init(struct stamped_writer *writer, const struct plant *plant, struct store *store);
void stamped_writer_finish(struct stamped_writer *writer);
/* Begins the processing of a message that arrived at this time. */
void stamped_writer_begin(struct stamped_writer *writer, int64_t now_mono_ns, int64_t now_utc_ns);
/* Adds the value, not scaled yet, that the message contains for a tag. was_kept: the broker had retained the value, which may have
   changed since, so its quality is Uncertain_LastUsableValue at best. A time ahead of our clock is replaced by the current time. A time
   before that of the tag's last sample is replaced by that sample's time if in_order is set; otherwise the store ignores the sample. */
void stamped_writer_add(struct stamped_writer *writer, int tag, const struct stamped_value *value, bool was_kept, bool in_order);
/* Makes a tag Bad from now on. If the sender stated the time of the tag's last sample, the Bad quality instead counts from that time.
   Otherwise, the Bad sample is undated: the tag's next value is used even if its stated time is earlier, because the sender's clock may
   be behind ours. */
void stamped_writer_add_bad(struct stamped_writer *writer, int tag, uint32_t quality);
/* Call after all values of a message have been added: writes the last batch of samples to the store. */
void stamped_writer_end(struct stamped_writer *writer);

#endif
