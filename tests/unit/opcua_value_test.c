/* SPDX-License-Identifier: GPL-3.0-or-later */
/* OPC UA: node addresses, and the conversion of values to readings. Tests every numeric type, status codes and timestamps bit
   by bit, and values that are no numbers. */
#include "tests/support/test.h"

#include "plant/sources/opcua_address.h"
#include "tests/support/plant_by_hand.h"
#include "value/quality.h"
#include "value/stamped_writer.h"
#ifdef PLANTCAST_OPCUA
#include <open62541/types_generated.h>

#include "value/opcua/opcua_value.h"
#endif

static bool resolve(const char *address, char *of_source, struct plant_tag *tag, char why[200])
{
    struct plant_source source = { .opcua.name_space = of_source };
    const struct plant plant = { .sources = &source, .source_count = 1 };
    *tag = (struct plant_tag){ .signal.address = (char *)(uintptr_t)address };
    bool good = opcua_address_resolve(&plant, tag, why);
    if (!good)
        assert_true(strlen(why) > 10);
    return good;
}

TEST(addresses_are_as_written)
{
    static const struct {
        const char *address, *uri, *id;
        int element;
    } good[] = { { "nsu=urn:a;s=Tank.Temp", "urn:a", "s=Tank.Temp", -1 },
                 { "[12]nsu=urn:a%3Bb%25;s=Row[3];x", "urn:a;b%", "s=Row[3];x", 12 },
                 { "s=nsu=x", "urn:own", "s=nsu=x", -1 },
                 { "[0]i=4294967295", "urn:own", "i=4294967295", 0 },
                 { "g=09087e75-8e5e-499b-954f-f2a9603db28a", "urn:own", "g=09087e75-8e5e-499b-954f-f2a9603db28a", -1 },
                 { "b=AAEC", "urn:own", "b=AAEC", -1 } };
    static const char *const wrong[] = { "", "nsu=;s=x", "nsu=urn:a", "nsu=urn:a;", "nsu=urn:a;s=", "nsu=urn:a;x=1", "ns=2;s=x", "[-1]s=x",
                                         "[1s=x", "[]s=x", "[1000001]s=x", "i=4294967296", "i=-1", "i=1x", "nsu=a%;s=x", "nsu=a%0;s=x",
                                         "nsu=a%00;s=x", "g=09087e75-8e5e-499b-954f-f2a9603db28", "g=x", "s" };
    struct plant_tag tag;
    char why[200];
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++) {
        assert_true(resolve(good[i].address, "urn:own", &tag, why));
        assert_string_equal(tag.signal.topic, good[i].uri);
        assert_string_equal(tag.signal.path, good[i].id);
        assert_int_equal(tag.signal.element, good[i].element);
        mem_free(tag.signal.topic);
        mem_free(tag.signal.path);
    }
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++) {
        assert_false(resolve(wrong[i], "urn:own", &tag, why));
        mem_free(tag.signal.topic);
    }
    assert_false(resolve("s=x", NULL, &tag, why));
}

#ifdef PLANTCAST_OPCUA
static const int64_t NOW_UTC_NS = 1795000000 * 1000000000LL, NOW_MONO_NS = 90000 * 1000000000LL;

TEST(every_number_is_read)
{
    UA_Boolean yes = true;
    UA_SByte sbyte = -5;
    UA_UInt16 word = 65535;
    UA_Int32 whole = -7;
    UA_UInt64 large = 1ull << 60;
    UA_Float single = 1.5f;
    const struct {
        int type;
        void *at;
        double value;
    } numbers[] = { { UA_TYPES_BOOLEAN, &yes, 1 }, { UA_TYPES_SBYTE, &sbyte, -5 }, { UA_TYPES_UINT16, &word, 65535 },
                    { UA_TYPES_INT32, &whole, -7 }, { UA_TYPES_UINT64, &large, 0x1p60 }, { UA_TYPES_FLOAT, &single, 1.5 } };
    struct stamped_value value;
    char why[200];
    for (size_t i = 0; i < sizeof(numbers) / sizeof(*numbers); i++) {
        UA_DataValue data = { .hasValue = true };
        UA_Variant_setScalar(&data.value, numbers[i].at, &UA_TYPES[numbers[i].type]);
        assert_true(opcua_value_read(&data, -1, &value, why));
        assert_true(value.value == numbers[i].value && value.quality == QUALITY_GOOD && value.utc_ns == 0);
        assert_false(opcua_value_read(&data, 0, &value, why));
        assert_int_equal(value.quality, QUALITY_BAD_CONFIGURATION);
    }
}

TEST(what_is_no_number_is_bad)
{
    UA_Double numbers[3] = { 1, 2, 3 };
    UA_String text = UA_STRING("warm");
    UA_DataValue data = { .hasValue = true };
    struct stamped_value value;
    char why[200];
    UA_Variant_setArray(&data.value, numbers, 3, &UA_TYPES[UA_TYPES_DOUBLE]);
    assert_true(opcua_value_read(&data, 2, &value, why) && value.value == 3);
    assert_false(opcua_value_read(&data, 3, &value, why));
    assert_int_equal(value.quality, 0x80370000);
    assert_false(opcua_value_read(&data, -1, &value, why));
    assert_int_equal(value.quality, QUALITY_BAD_CONFIGURATION);
    UA_Variant_setArray(&data.value, UA_EMPTY_ARRAY_SENTINEL, 0, &UA_TYPES[UA_TYPES_DOUBLE]);
    assert_false(opcua_value_read(&data, 0, &value, why));
    UA_Variant_setScalar(&data.value, &text, &UA_TYPES[UA_TYPES_STRING]);
    assert_false(opcua_value_read(&data, -1, &value, why));
    data.hasValue = false;
    assert_false(opcua_value_read(&data, -1, &value, why));
    assert_int_equal(value.quality, QUALITY_BAD_SENSOR_FAILURE);
}

/* Status codes and times of OPC UA values must be the same in a snapshot of the store, bit by bit. */
TEST(status_codes_and_times_stay_as_they_are)
{
    static const uint32_t codes[] = { 0, 0x00960000, 0x00000480, 0x40930000, 0x40A50480, 0x40000001, 0x808C0000, 0x80AB0000, 0xC0000000 };
    struct plant *plant = plant_by_hand_create(1);
    plant_by_hand_source(plant, "plc", 4840);
    plant_by_hand_tag(plant, "A", TABLE_HOLDING, 0, DATA_FLOAT64)->validity.stale_s = PLANT_NEVER_STALE_S;
    struct store *store = test_store(plant);
    struct snapshot *snapshot = test_snapshot(1);
    struct stamped_writer writer;
    UA_Double number = 4;
    char why[200];
    stamped_writer_init(&writer, plant, store);
    for (size_t i = 0; i < sizeof(codes) / sizeof(*codes); i++) {
        UA_DateTime ticks = UA_DATETIME_UNIX_EPOCH + NOW_UTC_NS / 100 - 1000000007 + (UA_DateTime)i;
        UA_DataValue data = { .hasValue = true, .hasStatus = true, .status = codes[i], .hasSourceTimestamp = true,
                              .sourceTimestamp = ticks, .hasServerTimestamp = true, .serverTimestamp = ticks + 5 };
        struct stamped_value value;
        UA_Variant_setScalar(&data.value, &number, &UA_TYPES[UA_TYPES_DOUBLE]);
        assert_true(opcua_value_read(&data, -1, &value, why));
        assert_true(value.utc_ns == NOW_UTC_NS - 100000000700 + 100 * (int64_t)i);
        stamped_writer_begin(&writer, NOW_MONO_NS, NOW_UTC_NS);
        stamped_writer_add(&writer, 0, &value, false, true);
        stamped_writer_end(&writer);
        store_snapshot(store, NOW_MONO_NS, NOW_UTC_NS, snapshot);
        assert_int_equal(snapshot->readings[0].quality, codes[i]);
    }
    stamped_writer_finish(&writer);
}

/* A machine that started a minute ago gets readings that are an hour old, so they are older than the origin of the monotonic
   clock. Their age must nevertheless be an hour. */
TEST(what_is_older_than_the_machine_s_start_is_as_old_as_it_is)
{
    static const int64_t minute_ns = 60 * 1000000000LL;
    struct plant *plant = plant_by_hand_create(1);
    plant_by_hand_source(plant, "plc", 4840);
    plant_by_hand_tag(plant, "A", TABLE_HOLDING, 0, DATA_FLOAT64)->validity.stale_s = 600;
    struct store *store = test_store(plant);
    struct snapshot *snapshot = test_snapshot(1);
    struct stamped_writer writer;
    stamped_writer_init(&writer, plant, store);
    for (int minutes = 60; minutes > 57; minutes--) {
        const struct stamped_value value = { .value = 4, .quality = QUALITY_GOOD, .utc_ns = NOW_UTC_NS - minutes * minute_ns };
        stamped_writer_begin(&writer, minute_ns, NOW_UTC_NS);
        stamped_writer_add(&writer, 0, &value, false, true);
        stamped_writer_end(&writer);
        store_snapshot(store, minute_ns, NOW_UTC_NS, snapshot);
        assert_true(snapshot->readings[0].age_ns == minutes * minute_ns);
        assert_false(quality_is_good(snapshot->readings[0].quality)); /* stale */
    }
    stamped_writer_finish(&writer);
}

/* A tag is Bad before its sender has stated a time. Its first value, from a sender whose clock is behind ours, must not be ignored. */
TEST(an_undated_bad_sample_hides_no_older_value)
{
    static const int64_t minute_ns = 60 * 1000000000LL;
    struct plant *plant = plant_by_hand_create(2);
    plant_by_hand_source(plant, "plc", 4840);
    for (int tag = 0; tag < 2; tag++)
        plant_by_hand_tag(plant, tag ? "B" : "A", TABLE_HOLDING, tag, DATA_FLOAT64)->validity.stale_s = PLANT_NEVER_STALE_S;
    struct store *store = test_store(plant);
    struct snapshot *snapshot = test_snapshot(2);
    struct stamped_writer writer;
    const struct stamped_value value = { .value = 4, .quality = QUALITY_GOOD, .utc_ns = NOW_UTC_NS - minute_ns };
    stamped_writer_init(&writer, plant, store);
    for (int tag = 0; tag < 2; tag++) {
        stamped_writer_begin(&writer, NOW_MONO_NS, NOW_UTC_NS);
        stamped_writer_add_bad(&writer, tag, QUALITY_BAD_NO_MATCH);
        stamped_writer_end(&writer);
        stamped_writer_add(&writer, tag, &value, false, tag == 1);
        stamped_writer_end(&writer);
        store_snapshot(store, NOW_MONO_NS, NOW_UTC_NS, snapshot);
        assert_int_equal(snapshot->readings[tag].quality, QUALITY_GOOD);
        assert_true(snapshot->readings[tag].age_ns == minute_ns);
        /* a Bad quality after a value with a stated time counts from that time, and hides older values */
        const struct stamped_value older = { .value = 5, .quality = QUALITY_GOOD, .utc_ns = NOW_UTC_NS - 2 * minute_ns };
        stamped_writer_add_bad(&writer, tag, QUALITY_BAD_NO_MATCH);
        stamped_writer_end(&writer);
        stamped_writer_add(&writer, tag, &older, false, false);
        stamped_writer_end(&writer);
        store_snapshot(store, NOW_MONO_NS, NOW_UTC_NS, snapshot);
        assert_int_equal(snapshot->readings[tag].quality, QUALITY_BAD_NO_MATCH);
    }
    stamped_writer_finish(&writer);
}
#endif
