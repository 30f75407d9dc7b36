/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distributes the encoded video to the pipelines of all outputs (RTSP, SRT). */
#include "outputs.h"

/* if more bytes are queued for the pipeline of one output, that output misses all frames up to the next key frame */
enum { MAX_QUEUED_BYTES = 4 << 20 };
static const GstClockTimeDiff SLACK = 500 * GST_MSECOND;

struct output {
    GstAppSrc *src;
    bool begun, timed;
    /* added to the time of each encoded frame, in nanoseconds: running time of this output's pipeline minus that of the
       encoder's pipeline */
    GstClockTimeDiff offset;
};

struct outputs {
    GMutex lock;
    /* --- below: under lock */
    GPtrArray *all;
    struct outputs_counts counts;
};

static void output_free(gpointer data)
{
    struct output *output = data;
    gst_object_unref(output->src);
    g_free(output);
}

struct outputs *outputs_create(void)
{
    struct outputs *outputs = g_new0(struct outputs, 1);
    g_mutex_init(&outputs->lock);
    outputs->all = g_ptr_array_new_with_free_func(output_free);
    return outputs;
}

void outputs_destroy(struct outputs **pointer)
{
    struct outputs *outputs = *pointer;
    if (!outputs)
        return;
    g_ptr_array_free(outputs->all, TRUE);
    g_mutex_clear(&outputs->lock);
    g_free(outputs);
    *pointer = NULL;
}

void outputs_add(struct outputs *outputs, GstAppSrc *src)
{
    struct output *output = g_new0(struct output, 1);
    output->src = gst_object_ref(src);
    g_mutex_lock(&outputs->lock);
    g_ptr_array_add(outputs->all, output);
    g_mutex_unlock(&outputs->lock);
}

void outputs_remove(struct outputs *outputs, GstAppSrc *src)
{
    g_mutex_lock(&outputs->lock);
    for (guint i = 0; i < outputs->all->len; i++) {
        const struct output *output = g_ptr_array_index(outputs->all, i);
        if (output->src == src)
            g_ptr_array_remove_index_fast(outputs->all, i--);
    }
    g_mutex_unlock(&outputs->lock);
}

/* Sets *out to the running time of the pipeline to which `src` belongs. Returns false if the pipeline is not running. */
static bool running_time(GstAppSrc *src, GstClockTime *out)
{
    GstClock *clock = gst_element_get_clock(GST_ELEMENT(src));
    if (!clock)
        return false;
    GstClockTime now = gst_clock_get_time(clock), base = gst_element_get_base_time(GST_ELEMENT(src));
    gst_object_unref(clock);
    *out = now - base;
    return GST_CLOCK_TIME_IS_VALID(base) && now >= base;
}

static bool push(struct output *output, GstBuffer *unit)
{
    GstClockTime now;
    bool key = !GST_BUFFER_FLAG_IS_SET(unit, GST_BUFFER_FLAG_DELTA_UNIT);
    if (!running_time(output->src, &now))
        return true;
    if (gst_app_src_get_current_level_bytes(output->src) > MAX_QUEUED_BYTES)
        output->begun = false;
    else
        output->begun = output->begun || key;
    if (!output->begun)
        return false;
    GstClockTimeDiff pts = (GstClockTimeDiff)GST_BUFFER_PTS(unit), off = pts + output->offset - (GstClockTimeDiff)now;
    if (!output->timed || off > SLACK || off < -SLACK)
        output->offset = (GstClockTimeDiff)now - pts;
    output->timed = true;
    GstBuffer *copy = gst_buffer_copy(unit); /* the copy shares the payload */
    GST_BUFFER_PTS(copy) = GST_BUFFER_DTS(copy) = (GstClockTime)MAX(pts + output->offset, 0);
    gst_app_src_push_buffer(output->src, copy);
    return true;
}

void outputs_push(struct outputs *outputs, GstBuffer *unit)
{
    g_mutex_lock(&outputs->lock);
    outputs->counts.units++;
    outputs->counts.key_units += !GST_BUFFER_FLAG_IS_SET(unit, GST_BUFFER_FLAG_DELTA_UNIT);
    outputs->counts.bytes += gst_buffer_get_size(unit);
    for (guint i = 0; i < outputs->all->len; i++)
        outputs->counts.dropped += !push(g_ptr_array_index(outputs->all, i), unit);
    g_mutex_unlock(&outputs->lock);
}

void outputs_count(struct outputs *outputs, struct outputs_counts *out)
{
    g_mutex_lock(&outputs->lock);
    *out = outputs->counts;
    out->outputs = outputs->all->len;
    g_mutex_unlock(&outputs->lock);
}
