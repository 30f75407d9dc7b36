/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects consecutive samples with the same timestamp, and writes them to the store together. */
#include "value/stamped_writer.h"

#include <stdlib.h>

#include "base/mem.h"
#include "value/decode.h"
#include "value/quality.h"

void stamped_writer_init(struct stamped_writer *writer, const struct plant *plant, struct store *store)
{
    *writer = (struct stamped_writer){ .store = store, .plant = plant };
    writer->samples = mem_array(plant->tag_count, sizeof(*writer->samples));
    writer->last = mem_array(plant->tag_count, sizeof(*writer->last));
    /* INT64_MIN means "no sample yet"; 0 would not do, because a monotonic time before the machine's start is negative */
    for (size_t i = 0; i < plant->tag_count; i++)
        writer->last[i].mono_ns = INT64_MIN;
}

void stamped_writer_finish(struct stamped_writer *writer)
{
    mem_free(writer->samples);
    mem_free(writer->last);
    *writer = (struct stamped_writer){ 0 };
}

void stamped_writer_begin(struct stamped_writer *writer, int64_t now_mono_ns, int64_t now_utc_ns)
{
    writer->mono_ns = now_mono_ns;
    writer->utc_ns = writer->at_utc_ns = now_utc_ns;
    writer->worst_skew_ns = 0;
    writer->written = 0;
}

void stamped_writer_end(struct stamped_writer *writer)
{
    if (writer->count > 0 && writer->are_undated)
        store_write_undated(writer->store, writer->samples, writer->count, writer->at_mono_ns, writer->at_utc_ns);
    else if (writer->count > 0)
        store_write(writer->store, writer->samples, writer->count, writer->at_mono_ns, writer->at_utc_ns);
    writer->written += writer->count;
    writer->count = 0;
}

/* Converts a sample's UTC time to monotonic time. The two clocks cannot be read at the same moment, so the result may be slightly off.
   If the sample is not older in UTC than the tag's last sample, its monotonic time is at least that of the last sample. */
static int64_t mono_of(const struct stamped_writer *writer, int tag, int64_t utc_ns)
{
    int64_t mono_ns = writer->mono_ns - (writer->utc_ns - utc_ns);
    return utc_ns >= writer->last[tag].utc_ns && mono_ns < writer->last[tag].mono_ns ? writer->last[tag].mono_ns : mono_ns;
}

/* Adds a sample to the batch, whose samples must all have the same time and cannot be more than there are tags. If the sample
   does not fit, the batch is written first. is_undated: utc_ns is not the sender's time. */
static void add_sample(struct stamped_writer *writer, const struct sample *sample, bool is_undated, int64_t utc_ns)
{
    int64_t mono_ns = mono_of(writer, sample->tag, utc_ns);
    if (utc_ns != writer->at_utc_ns || mono_ns != writer->at_mono_ns || is_undated != writer->are_undated ||
        writer->count == writer->plant->tag_count)
        stamped_writer_end(writer);
    writer->are_undated = is_undated;
    writer->at_utc_ns = utc_ns;
    writer->at_mono_ns = mono_ns;
    writer->samples[writer->count++] = *sample;
    if (is_undated || utc_ns < writer->last[sample->tag].utc_ns)
        return;
    writer->last[sample->tag].utc_ns = utc_ns;
    writer->last[sample->tag].mono_ns = mono_ns;
}

void stamped_writer_add(struct stamped_writer *writer, int tag, const struct stamped_value *value, bool was_kept, bool in_order)
{
    struct sample sample = { .tag = tag, .quality = value->quality };
    int64_t utc_ns = value->utc_ns ? value->utc_ns : writer->utc_ns;
    if (llabs(utc_ns - writer->utc_ns) > llabs(writer->worst_skew_ns) && !was_kept)
        writer->worst_skew_ns = utc_ns - writer->utc_ns;
    if (!quality_is_bad(value->quality)) {
        decode_number(&writer->plant->tags[tag], value->value, &sample);
        /* uses the quality code that the publisher sent, because it is more specific than the code from our own decoding,
           unless our own code is worse */
        if (!quality_is_worse(sample.quality, value->quality))
            sample.quality = value->quality;
        if (was_kept && quality_is_good(sample.quality))
            sample.quality = QUALITY_UNCERTAIN_LAST_USABLE;
    }
    writer->last[tag].is_stated = value->utc_ns != 0;
    if (in_order && utc_ns < writer->last[tag].utc_ns)
        utc_ns = writer->last[tag].utc_ns;
    add_sample(writer, &sample, false, utc_ns < writer->utc_ns ? utc_ns : writer->utc_ns);
}

void stamped_writer_add_bad(struct stamped_writer *writer, int tag, uint32_t quality)
{
    const struct sample sample = { .tag = tag, .quality = quality };
    bool is_stated = writer->last[tag].is_stated;
    add_sample(writer, &sample, !is_stated, is_stated ? writer->last[tag].utc_ns : writer->utc_ns);
}
