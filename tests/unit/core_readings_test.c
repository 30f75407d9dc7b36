/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readings between core and renderer: only what changed, to the bit; and nothing is believed that cannot be. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "base/mem.h"
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

static void only_changes_are_sent(void **state)
{
    (void)state;
    struct snapshot *snapshot = make_snapshot();
    struct core_sent sent;
    struct text text = { 0 };
    struct mirrored got[TAGS];
    struct core_readings readings = { .at = got, .least_ns = INT64_MAX };
    core_sent_init(&sent, TAGS);
    core_readings_write(&text, snapshot, &sent);
    assert_null(core_readings_read(&readings, TAGS, text.at, text.length, 100 * S));
    assert_int_equal(readings.count, TAGS);
    assert_true(readings.utc_ns == 5000 * S && got[0].value == 0.1 + 0.2 && got[0].received_mono_ns == 99 * S);
    assert_true(got[0].received_utc_ns == 4999 * S && got[1].quality == QUALITY_BAD_SENSOR_FAILURE && got[1].value == -7);
    assert_true(got[0].has_value && got[1].has_value && !got[2].has_value && got[2].quality == QUALITY_BAD_WAITING);
    text.length = 0;
    snapshot->readings[0].received_utc_ns += S; /* read again, the same value */
    snapshot->readings[2].changes++;
    core_readings_write(&text, snapshot, &sent);
    assert_null(core_readings_read(&readings, TAGS, text.at, text.length, 101 * S));
    assert_true(readings.count == 2 && got[0].tag == 0 && got[1].tag == 2);
    text.length = 0;
    core_readings_write(&text, snapshot, &sent);
    assert_int_equal(text.length, CORE_READINGS_HEAD_BYTES);
    core_sent_finish(&sent);
    text_finish(&text);
    snapshot_destroy(&snapshot);
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    struct snapshot *snapshot = make_snapshot();
    struct core_sent sent;
    struct text text = { 0 };
    struct mirrored got[TAGS];
    struct core_readings readings = { .at = got, .least_ns = INT64_MAX };
    core_sent_init(&sent, TAGS);
    core_readings_write(&text, snapshot, &sent);
    for (size_t n = 0; n < text.length; n++)
        assert_non_null(core_readings_read(&readings, TAGS, text.at, n, S));
    assert_non_null(core_readings_read(&readings, TAGS - 1, text.at, text.length, S)); /* more than there are */
    const struct {
        size_t at, count;
        uint8_t byte;
    } wrong[] = { { 0, 1, 'X' }, { 4, 4, 0xff }, { 16, 8, 0xff }, { 24, 1, TAGS },
                { 24 + 8, 8, 0xff }, { 24 + 16, 8, 0xff }, { 88 + 4, 4, 0 } };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        char kept[256];
        memcpy(kept, text.at, text.length);
        memset(text.at + wrong[i].at, wrong[i].byte, wrong[i].count);
        assert_non_null(core_readings_read(&readings, TAGS, text.at, text.length, S));
        memcpy(text.at, kept, text.length);
    }
    core_sent_finish(&sent);
    text_finish(&text);
    snapshot_destroy(&snapshot);
}

/* What waited on its way is older by that. */
#define DRIFT_NS (S / 500) /* that clocks may have drifted apart between two messages */

static void late_readings_are_older(void **state)
{
    (void)state;
    struct snapshot *snapshot = make_snapshot();
    struct core_sent sent;
    struct text text = { 0 };
    struct mirrored got[TAGS];
    struct core_readings readings = { .at = got, .least_ns = INT64_MAX };
    for (int i = 0; i < 3; i++) { /* each a second after the one before; the second takes 5 s longer */
        core_sent_init(&sent, TAGS);
        snapshot->taken_mono_ns = (50 + i) * S;
        text.length = 0;
        core_readings_write(&text, snapshot, &sent);
        int64_t now_ns = (1000 + i + (i == 1 ? 5 : 0)) * S;
        assert_null(core_readings_read(&readings, TAGS, text.at, text.length, now_ns));
        int64_t late_ns = i == 1 ? 5 * S : 0;
        assert_true(llabs(readings.late_ns - late_ns) < DRIFT_NS && llabs(got[0].received_mono_ns - (999 + i) * S) < DRIFT_NS);
        core_sent_finish(&sent);
    }
    for (int i = 0; i < 100; i++) { /* 40 hours, while our clock is faster by 50 of a million */
        int64_t passed_ns = (3 + 1440 * (int64_t)i) * S;
        core_sent_init(&sent, TAGS);
        snapshot->taken_mono_ns = 50 * S + passed_ns;
        text.length = 0;
        core_readings_write(&text, snapshot, &sent);
        assert_null(core_readings_read(&readings, TAGS, text.at, text.length, 1000 * S + passed_ns + passed_ns / 20000));
        assert_true(readings.late_ns < DRIFT_NS);
        core_sent_finish(&sent);
    }
    text_finish(&text);
    snapshot_destroy(&snapshot);
}

/* What is shown there is shown here, whatever its age; a lost link makes all Bad, also what is told again unchanged afterwards. */
static void a_store_shows_what_the_other_shows(void **state)
{
    (void)state;
    struct plant *plant = plant_by_hand_create(2);
    plant_by_hand_source(plant, "a", 1);
    plant_by_hand_tag(plant, "TT", TABLE_HOLDING, 0, DATA_INT16);
    struct store *store = store_create(plant);
    struct snapshot *snapshot = snapshot_create(1);
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
    snapshot_destroy(&snapshot);
    store_destroy(&store);
    plant_by_hand_destroy(&plant);
}

static void differences_have_names(void **state)
{
    (void)state;
    const struct core_identity own = { "1.0", "Plant", "abc" };
    const struct core_identity others[] = { { "1.1", "Plant", "abc" }, { "1.0", "P", "abc" }, { "1.0", "Plant", "x" } };
    const char *const names[] = { "version", "plant", "configuration" };
    json_t *message = core_identity_message("core", &own);
    assert_null(core_identity_difference(message, "core", &own));
    for (int i = 0; i < 3; i++) {
        char *why = core_identity_difference(message, "core", &others[i]);
        assert_non_null(strstr(why, names[i]));
        mem_free(why);
    }
    json_object_del(message, "plant");
    char *why = core_identity_difference(message, "core", &own);
    assert_string_equal(why, "the core does not tell its plant");
    mem_free(why);
    json_decref(message);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_changes_are_sent),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(late_readings_are_older),
        cmocka_unit_test(a_store_shows_what_the_other_shows),
        cmocka_unit_test(differences_have_names),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
