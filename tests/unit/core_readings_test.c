/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Live readings sent from a core to a renderer: only changes are sent, bit-exact; invalid messages are refused. */
#include "tests/support/test.h"

#include "corelink/core_identity.h"
#include "corelink/core_readings.h"
#include "tests/support/plant_by_hand.h"
#include "value/quality.h"

#define S INT64_C(1000000000)
enum { TAGS = 3 };

static struct snapshot *make_snapshot(void)
{
    struct snapshot *snapshot = snapshot_create(TAGS);
    snapshot->taken_utc_ns = 5000 * S;
    snapshot->taken_mono_ns = 50 * S;
    snapshot->readings[0] = (struct reading){ .value = 0.1 + 0.2, .changes = 1, .received_utc_ns = 4999 * S, .age_ns = S };
    snapshot->readings[1] =
        (struct reading){ .value = -7, .quality = QUALITY_BAD_SENSOR_FAILURE, .changes = 2, .received_utc_ns = 10, .age_ns = 4 * S };
    snapshot->readings[2].age_ns = INT64_MAX;
    return snapshot;
}

/* The way of readings from a core's snapshot through messages to a renderer. */
struct readings_path {
    struct snapshot *snapshot;
    struct core_sent sent;
    struct text text; /* text of the last written message */
    struct mirrored got[TAGS];
    struct core_readings readings;
};

static void way_init(struct readings_path *way)
{
    *way = (struct readings_path){ .snapshot = make_snapshot(), .readings = { .at = way->got, .least_ns = INT64_MAX } };
    core_sent_init(&way->sent, TAGS);
}

static void way_finish(struct readings_path *way)
{
    core_sent_finish(&way->sent);
    text_finish(&way->text);
    snapshot_destroy(&way->snapshot);
}

static void write_message(struct readings_path *way)
{
    way->text.length = 0;
    core_readings_write(&way->text, way->snapshot, &way->sent);
}

static const char *read_message(struct readings_path *way, int64_t now_mono_ns)
{
    return core_readings_read(&way->readings, TAGS, way->text.at, way->text.length, now_mono_ns);
}

TEST(only_changes_are_sent)
{
    struct readings_path way;
    const struct mirrored *got = way.got;
    way_init(&way);
    write_message(&way);
    assert_null(read_message(&way, 100 * S));
    assert_int_equal(way.readings.count, TAGS);
    assert_true(way.readings.utc_ns == 5000 * S && got[0].value == 0.1 + 0.2 && got[0].received_mono_ns == 99 * S);
    assert_true(got[0].received_utc_ns == 4999 * S && got[1].quality == QUALITY_BAD_SENSOR_FAILURE && got[1].value == -7);
    assert_true(got[0].has_value && got[1].has_value && !got[2].has_value && got[2].quality == QUALITY_BAD_WAITING);
    /* tag 0 was read again with the same value; tag 2 has changed: only these two may be sent */
    way.snapshot->readings[0].received_utc_ns += S;
    way.snapshot->readings[2].changes++;
    write_message(&way);
    assert_null(read_message(&way, 101 * S));
    assert_true(way.readings.count == 2 && got[0].tag == 0 && got[1].tag == 2);
    write_message(&way);
    assert_int_equal(way.text.length, CORE_READINGS_HEAD_BYTES);
    way_finish(&way);
}

TEST(nonsense_is_refused)
{
    struct readings_path way;
    way_init(&way);
    write_message(&way);
    const size_t whole = way.text.length;
    for (way.text.length = 0; way.text.length < whole; way.text.length++)
        assert_non_null(read_message(&way, S));
    /* the message has more readings than the plant has tags */
    assert_non_null(core_readings_read(&way.readings, TAGS - 1, way.text.at, whole, S));
    const struct {
        size_t at, count;
        uint8_t byte;
    } wrong[] = { { 0, 1, 'X' }, { 4, 4, 0xff }, { 16, 8, 0xff }, { 24, 1, TAGS },
                { 24 + 8, 8, 0xff }, { 24 + 16, 8, 0xff }, { 88 + 4, 4, 0 } };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        char kept[256];
        memcpy(kept, way.text.at, whole);
        memset(way.text.at + wrong[i].at, wrong[i].byte, wrong[i].count);
        assert_non_null(read_message(&way, S));
        memcpy(way.text.at, kept, whole);
    }
    way_finish(&way);
}

/* Sends all readings at core_ns by the core's clock; they arrive at now_ns by the renderer's. Asserts that the renderer finds
   them delayed by late_ns, give or take clock drift. */
#define DRIFT_NS (S / 500) /* delay in ns that may seem to exist between two messages because the two clocks drift apart */

static void assert_late(struct readings_path *way, int64_t core_ns, int64_t now_ns, int64_t late_ns)
{
    way->snapshot->taken_mono_ns = core_ns;
    core_sent_finish(&way->sent); /* a new connection gets all readings again */
    core_sent_init(&way->sent, TAGS);
    write_message(way);
    assert_null(read_message(way, now_ns));
    assert_true(llabs(way->readings.late_ns - late_ns) < DRIFT_NS);
    assert_true(llabs(way->got[0].received_mono_ns - (now_ns - late_ns - S)) < DRIFT_NS);
}

TEST(late_readings_are_older)
{
    struct readings_path way;
    way_init(&way);
    for (int i = 0; i < 3; i++) { /* one message per second; the second message is delayed by 5 s */
        int64_t late_ns = i == 1 ? 5 * S : 0;
        assert_late(&way, (50 + i) * S, (1000 + i) * S + late_ns, late_ns);
    }
    for (int i = 0; i < 100; i++) { /* in 40 hours the renderer's clock gains 50 ppm: the drift must not look like a delay */
        int64_t passed_ns = (3 + 1440 * (int64_t)i) * S;
        assert_late(&way, 50 * S + passed_ns, 1000 * S + passed_ns + passed_ns / 20000, 0);
    }
    way_finish(&way);
}

/* A renderer's store shows readings as the core sent them, however old they are: it makes none stale by itself. When the link
   is lost, it makes them Bad, until the core sends them again. */
TEST(a_store_shows_what_the_other_shows)
{
    struct plant *plant = plant_by_hand_create(2);
    plant_by_hand_source(plant, "a", 1);
    plant_by_hand_tag(plant, "TT", TABLE_HOLDING, 0, DATA_INT16);
    struct store *store = test_store(plant);
    struct snapshot *snapshot = test_snapshot(1);
    struct mirrored one = { .value = 4, .has_value = true, .received_mono_ns = 10 * S, .received_utc_ns = 7 };
    store_mirror(store, &one, 1, 10 * S);
    store_snapshot(store, 100000 * S, 0, snapshot);
    assert_true(snapshot->readings[0].quality == QUALITY_GOOD && snapshot->readings[0].value == 4);
    assert_true(snapshot->readings[0].received_utc_ns == 7 && snapshot->readings[0].age_ns == 99990 * S);
    uint32_t changes = snapshot->readings[0].changes;
    store_tags_dead(store, &(int){ 0 }, 1, 100001 * S);
    store_snapshot(store, 100001 * S, 0, snapshot);
    assert_true(quality_is_bad(snapshot->readings[0].quality) && snapshot->readings[0].changes == changes + 1);
    one.quality = QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE;
    store_mirror(store, &one, 1, 100002 * S);
    store_snapshot(store, 100002 * S, 0, snapshot);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
}

TEST(differing_files_have_names)
{
    const struct core_identity own = { "1.0", "Plant", "abc", { "0000000000000001", "0000000000000002", "0000000000000003" } };
    struct core_identity other = own;
    struct core_files read;
    json_t *message = test_json(core_identity_message("core", &own));
    assert_true(core_files_read(message, &read));
    assert_int_equal(core_files_differing(&read, &own.files), 0);
    strcpy(other.files.models, "0000000000000004");
    assert_int_equal(core_files_differing(&read, &other.files), CORE_MODELS);
    assert_null(core_identity_difference(message, "core", &other)); /* nodes with other models can exchange readings */
    strcpy(other.files.tags, "0000000000000005");
    other.configuration = "def";
    char *why = core_identity_difference(message, "core", &other), *names = core_files_text(0);
    assert_string_equal(why, "configuration: the core has abc, this node def (different: tag list, models)");
    assert_string_equal(names, "");
    mem_free(why);
    mem_free(names);
    json_object_set_new(json_object_get(message, "files"), "tags", json_string("12"));
    assert_false(core_files_read(message, &read));
    json_object_del(message, "files");
    assert_false(core_files_read(message, &read));
    why = core_identity_difference(message, "core", &other);
    assert_string_equal(why, "configuration: the core has abc, this node def");
    mem_free(why);
}

TEST(differences_have_names)
{
    const struct core_files files = { "0000000000000001", "0000000000000002", "0000000000000003" };
    const struct core_identity own = { "1.0", "Plant", "abc", files };
    const struct core_identity others[] = { { "1.1", "Plant", "abc", files },
                                            { "1.0", "P", "abc", files },
                                            { "1.0", "Plant", "x", files } };
    const char *const names[] = { "version", "plant", "configuration" };
    json_t *message = test_json(core_identity_message("core", &own));
    assert_null(core_identity_difference(message, "core", &own));
    for (int i = 0; i < 3; i++) {
        char *why = core_identity_difference(message, "core", &others[i]);
        assert_non_null(strstr(why, names[i]));
        mem_free(why);
    }
    json_object_del(message, "plant");
    char *why = core_identity_difference(message, "core", &own);
    assert_string_equal(why, "the core does not send its plant: do both nodes run the same version?");
    mem_free(why);
}
