/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages with samples from a core to its standby: all samples arrive, in order and with unchanged bits, and invalid messages
   are refused. */
#include "tests/support/test.h"

#include "corelink/core_samples.h"
#include "tests/support/plant_by_hand.h"
#include "value/quality.h"

#define S INT64_C(1000000000)
enum { TAGS = 3 };

static const char *read_text(const struct text *text, struct sample_event **out, size_t *count)
{
    return core_samples_read(out, count, TAGS, text->at, text->length, 77);
}

/* Returns a message of two samples, made from what the store reports to its listener. */
static struct text make_message(void)
{
    struct plant *plant = plant_by_hand_create(TAGS);
    plant_by_hand_source(plant, "a", 1);
    for (int i = 0; i < TAGS; i++)
        plant_by_hand_tag(plant, (const char *[]){ "T0", "T1", "T2" }[i], TABLE_HOLDING, i, DATA_INT16);
    struct store *store = store_create(plant);
    struct core_samples *samples = core_samples_listen(store);
    struct text text = { 0 };
    assert_int_equal(core_samples_write(samples, &text), 0);
    assert_int_equal(text.length, 0);
    store_write(store, &(struct sample){ .tag = 1, .value = 0.1 + 0.2 }, 1, S, 5000 * S + 1);
    store_write(store, &(struct sample){ .tag = 2, .quality = QUALITY_BAD_SENSOR_FAILURE }, 1, 2 * S, 5001 * S);
    assert_int_equal(core_samples_write(samples, &text), 2);
    core_samples_end(&samples);
    /* writes after core_samples_end(): the store must not call the destroyed listener */
    store_write(store, &(struct sample){ .tag = 0, .value = 1 }, 1, 3 * S, 5002 * S);
    store_destroy(&store);
    return text;
}

TEST(each_comes_in_order)
{
    struct text text = make_message();
    struct sample_event *got;
    size_t count;
    assert_null(read_text(&text, &got, &count));
    assert_int_equal(count, 2);
    const double value = 0.1 + 0.2;
    assert_memory_equal(&got[0].value, &value, sizeof(value));
    assert_int_equal(got[0].tag, 1);
    assert_int_equal(got[0].utc_ns, 5000 * S + 1);
    assert_int_equal(got[0].mono_ns, 77);
    assert_int_equal(got[1].tag, 2);
    assert_int_equal(got[1].quality, QUALITY_BAD_SENSOR_FAILURE);
    assert_true(isnan(got[1].value));
    mem_free(got);
    text_finish(&text);
}

TEST(nonsense_is_refused)
{
    struct text text = make_message();
    struct sample_event *got;
    size_t count;
    for (size_t length = 0; length < text.length; length++) {
        assert_non_null(core_samples_read(&got, &count, TAGS, text.at, length, 77));
        assert_null(got);
    }
    text.at[8] = TAGS; /* changes the first sample's tag */
    assert_string_equal(read_text(&text, &got, &count), "the core's message has an invalid sample; do both nodes run the same version?");
    text.at[8] = 1;
    text.at[8 + 4 + 3] = (char)0x80; /* gives the first sample the quality Bad, although it has a value, which is invalid */
    assert_string_equal(read_text(&text, &got, &count), "the core's message has an invalid sample; do both nodes run the same version?");
    text.at[8 + 4 + 3] = 0;
    assert_null(read_text(&text, &got, &count));
    mem_free(got);
    memset(text.at + 4, 0xff, 4); /* states four thousand million samples */
    assert_string_equal(read_text(&text, &got, &count),
                        "the length of the core's message does not match the number of samples in the message; "
                        "do both nodes run the same version?");
    text_finish(&text);
}

TEST(any_bytes_are_read_or_refused)
{
    unsigned seed = (unsigned)sweep_seed();
    struct text text = make_message();
    for (int round = 0; round < 20000; round++) {
        struct sample_event *got;
        size_t count;
        seed = seed * 1664525u + 1013904223u;
        text.at[(seed >> 8) % text.length] = (char)(seed >> 24);
        if (round % 50 == 0)
            memcpy(text.at, "PCS1\2\0\0\0", 8);
        if (read_text(&text, &got, &count) == NULL) {
            for (size_t i = 0; i < count; i++)
                assert_true(got[i].tag >= 0 && got[i].tag < TAGS && isfinite(got[i].value) == !quality_is_bad(got[i].quality));
            mem_free(got);
        }
    }
    text_finish(&text);
}
