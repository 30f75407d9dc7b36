/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loop checks (comparisons of a displayed value with the instrument): they survive a restart, become void if the tag measures
   something else afterwards, and no line of their file is lost. */
#include "loopcheck/loop_checks.h"

#include "tests/support/test.h"
#include <inttypes.h>
#include <sys/stat.h>
#include <unistd.h>

#include "message/loop_check_message.h"
#include "tests/support/plant_by_hand.h"

enum { TAGS = 3, COMPUTED = 2, NOBODY = 65534 };
struct loop_checks_fixture {
    struct log *log;
    struct plant *plant;
    char *folder;
    struct loop_checks *loop_checks;
};

static void begin(struct loop_checks_fixture *f)
{
    f->log = test_log();
    f->plant = plant_by_hand_create(TAGS);
    plant_by_hand_source(f->plant, "plc", 502);
    plant_by_hand_tag(f->plant, "TI-1", TABLE_HOLDING, 0, DATA_FLOAT32);
    plant_by_hand_tag(f->plant, "TI-2", TABLE_HOLDING, 2, DATA_FLOAT32);
    plant_by_hand_tag(f->plant, "SUM", TABLE_HOLDING, 4, DATA_FLOAT32)->source = -1;
    f->folder = temp_folder();
    f->loop_checks = loop_checks_open(f->log, f->plant, f->folder, NULL);
}

static void end(struct loop_checks_fixture *f)
{
    loop_checks_close(&f->loop_checks);
}

TEST_FIXTURE(struct loop_checks_fixture, begin, end)

static void open_again(struct loop_checks_fixture *f)
{
    loop_checks_close(&f->loop_checks);
    f->loop_checks = loop_checks_open(f->log, f->plant, f->folder, NULL);
}

static const struct loop_check passed = { .state = LOOP_CHECK_PASSED,
                                          .time_us = 1700000000 * INT64_C(1000000),
                                          .value = 42,
                                          .expected = 42.3,
                                          .tolerance = 0.5,
                                          .who = "Kim, \"field\"",
                                          .remark = "calibrator 7\nline 2" };

static void expect_unproven(const struct loop_checks_fixture *f, bool first, bool second)
{
    assert_int_equal(loop_checks_unproven(f->loop_checks, 0), first);
    assert_int_equal(loop_checks_unproven(f->loop_checks, 1), second);
    assert_false(loop_checks_unproven(f->loop_checks, COMPUTED));
}

TEST_WITH(test_unproven_is_said_only_once_somebody_began, set_up, tear_down)
{
    struct loop_checks_fixture *f = *state;
    assert_false(loop_checks_begun(f->loop_checks));
    expect_unproven(f, false, false);
    struct loop_check failed = passed;
    failed.state = LOOP_CHECK_FAILED;
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &failed), REFUSAL_NONE);
    assert_true(loop_checks_begun(f->loop_checks));
    expect_unproven(f, true, true);
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    expect_unproven(f, false, true);
    assert_int_equal(loop_checks_number(f->loop_checks), 2);
    assert_int_equal(loop_checks_number_of(f->loop_checks, 0), 2);
    assert_int_equal(loop_checks_number_of(f->loop_checks, 1), 0);
}

TEST_WITH(test_a_proof_outlives_the_daemon, set_up, tear_down)
{
    struct loop_checks_fixture *f = *state;
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    open_again(f);
    const struct loop_check *check = loop_checks_of(f->loop_checks, 0);
    assert_int_equal(check->state, LOOP_CHECK_PASSED);
    assert_true(check->time_us == passed.time_us);
    assert_true(check->value == 42 && check->expected == 42.3 && check->tolerance == 0.5);
    assert_string_equal(check->who, "Kim, \"field\"");
    assert_string_equal(check->remark, "calibrator 7 line 2");
    assert_int_equal(loop_checks_of(f->loop_checks, 1)->state, LOOP_CHECK_NONE);
    expect_unproven(f, false, true);
}

TEST_WITH(test_a_tag_that_is_another_is_unproven_again, set_up, tear_down)
{
    struct loop_checks_fixture *f = *state;
    struct plant_tag *tag = &f->plant->tags[0], was = *tag;
    struct plant_source *source = &f->plant->sources[0], source_was = *source;
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    uint64_t before = loop_check_fingerprint(f->plant, 0);
    for (int change = 0; change < 13; change++) {
        *tag = was;
        *source = source_was;
        switch (change) {
        case 0: tag->signal.register_index++; break;
        case 1: tag->signal.byte_order = (enum byte_order)(tag->signal.byte_order + 1); break;
        case 2: tag->scale.scaled_high += 1; break;
        case 3: tag->scale.negate = !tag->scale.negate; break;
        case 4: tag->place.position_m[1] += 0.25; break;
        case 5: tag->scale.ne43 = !tag->scale.ne43; break;
        case 6: tag->scale.sentinels[tag->scale.sentinel_count++] = (struct plant_sentinel){ .number = -999.9 }; break;
        case 7: tag->scale.sentinels[tag->scale.sentinel_count++] = (struct plant_sentinel){ .is_bits = true, .bits = 0x8000 }; break;
        case 8: tag->signal.modbus_unit += 3; break;
        case 9: source->unit++; break;
        case 10: tag->signal.topic = test_printf("works/boiler"); break;
        case 11: source->mqtt.value = test_printf("readings.value"); break;
        default: tag->signal.element++; break;
        }
        assert_true(loop_check_fingerprint(f->plant, 0) != before);
        open_again(f);
        assert_int_equal(loop_checks_of(f->loop_checks, 0)->state, LOOP_CHECK_CHANGED);
        assert_true(loop_checks_unproven(f->loop_checks, 0));
    }
    *tag = was;
    *source = source_was;
    /* a tag's strength (its weight in the field) does not change what the tag measures, so the loop check stays valid */
    tag->strength = 3;
    open_again(f);
    assert_int_equal(loop_checks_of(f->loop_checks, 0)->state, LOOP_CHECK_PASSED);
}

static char *read_file(const struct loop_checks_fixture *f)
{
    char *path = temp_path(f->folder, LOOP_CHECKS_FILE);
    size_t bytes;
    char *text = text_read_file(path, 1 << 20, &bytes);
    assert_non_null(text);
    return text;
}

/* Older versions recorded a fingerprint without the resolved address. Their loop checks stay valid after an upgrade. */
TEST_WITH(test_a_check_of_an_older_version_stays_valid, set_up, tear_down)
{
    struct loop_checks_fixture *f = *state;
    temp_write_text(f->folder, LOOP_CHECKS_FILE,
                    "Time,Tag Name,Result,Value,Unit,Expected,Tolerance,By,Remark,Fingerprint\n"
                    "2023-11-14T22:13:20Z,\"TI-1\",pass,42,\"\",42.3,0.5,\"Kim\",\"\",c6463d05fd27624e\n");
    open_again(f);
    expect_unproven(f, false, true);
    f->plant->tags[0].signal.register_index++;
    open_again(f);
    expect_unproven(f, true, true);
}

TEST_WITH(test_a_line_that_was_cut_off_spoils_no_other, set_up, tear_down)
{
    struct loop_checks_fixture *f = *state;
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    char *whole = test_memory(read_file(f));
    size_t length = strlen(whole);
    assert_int_equal(loop_checks_add(f->loop_checks, 1, &passed), REFUSAL_NONE);
    char *both = test_memory(read_file(f));
    size_t end = strlen(both);
    /* truncates the file within its second line, at every byte: the check of the first line must stay valid, and a new one can
       be added */
    for (size_t cut = length; cut < end - 1; cut++) {
        temp_write(f->folder, LOOP_CHECKS_FILE, both, cut);
        open_again(f);
        assert_int_equal(loop_checks_of(f->loop_checks, 0)->state, LOOP_CHECK_PASSED);
        assert_int_equal(loop_checks_of(f->loop_checks, 1)->state, LOOP_CHECK_NONE);
        assert_int_equal(loop_checks_add(f->loop_checks, 1, &passed), REFUSAL_NONE);
        open_again(f);
        assert_int_equal(loop_checks_of(f->loop_checks, 0)->state, LOOP_CHECK_PASSED);
        assert_int_equal(loop_checks_of(f->loop_checks, 1)->state, LOOP_CHECK_PASSED);
    }
}

TEST_WITH(test_what_cannot_be_kept_is_refused_and_counts_for_nothing, set_up, tear_down)
{
    struct loop_checks_fixture *f = *state;
    bool root = geteuid() == 0;
    assert_int_equal(chmod(f->folder, 0555), 0);
    if (root)
        assert_int_equal(seteuid(NOBODY), 0);
    enum refusal_code why = loop_checks_add(f->loop_checks, 0, &passed);
    if (root)
        assert_int_equal(seteuid(0), 0);
    assert_int_equal(chmod(f->folder, 0755), 0);
    assert_int_equal(why, REFUSAL_DISK);
    assert_int_equal(loop_checks_of(f->loop_checks, 0)->state, LOOP_CHECK_NONE);
    assert_false(loop_checks_begun(f->loop_checks));
}

TEST_WITH(test_the_folder_is_made_where_nobody_has_yet, set_up, tear_down)
{
    struct loop_checks_fixture *f = *state;
    assert_int_equal(rmdir(f->folder), 0);
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    open_again(f);
    assert_int_equal(loop_checks_of(f->loop_checks, 0)->state, LOOP_CHECK_PASSED);
}

TEST_ON(struct loop_checks_fixture *f, test_all_tags_with_a_source_are_told, set_up, tear_down)
{
    struct text *text = test_text();
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    loop_checks_print(f->loop_checks, text);
    assert_int_equal(strncmp(text->at, "Time,Tag Name,Result,", 21), 0);
    assert_non_null(strstr(text->at, "\n2023-11-14T22:13:20Z,\"TI-1\",pass,42,\"\",42.3,0.5,"
                                     "\"Kim, \"\"field\"\"\",\"calibrator 7 line 2\","));
    assert_non_null(strstr(text->at, "\n,\"TI-2\",none,,\"\",,,\"\",\"\","));
    assert_null(strstr(text->at, "SUM"));
}

/* The values of a check are in the unit that the tag had then, and the fingerprint is that of the settings that were checked. */
TEST_ON(struct loop_checks_fixture *f, test_a_check_keeps_its_unit_and_fingerprint, set_up, tear_down)
{
    struct plant_tag *tag = &f->plant->tags[0];
    tag->unit = mem_strdup("bar");
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    char *fingerprint = test_printf(",%016" PRIx64 "\n", loop_check_fingerprint(f->plant, 0));
    mem_free(tag->unit);
    tag->unit = mem_strdup("kPa");
    tag->signal.register_index++;
    for (int again = 0; again < 2; again++) {
        struct text *text = test_text();
        loop_checks_print(f->loop_checks, text);
        assert_non_null(strstr(text->at, ",42,\"bar\",42.3,0.5,"));
        assert_non_null(strstr(text->at, fingerprint));
        open_again(f);
    }
}

static void mirror(struct loop_checks_fixture *f, struct loop_checks *mirror)
{
    json_t *message = loop_checks_message(f->loop_checks, f->plant, 0, true);
    assert_true(loop_checks_take(mirror, f->plant, message));
    json_decref(message);
}

/* Returns whether a message contains all checks, and asserts how many. */
static bool contains_all(const struct loop_checks_fixture *f, const struct loop_checks *loop_checks, uint64_t since, size_t count)
{
    json_t *message = loop_checks_message(loop_checks, f->plant, since, false);
    bool all = json_is_true(json_object_get(message, "all"));
    assert_int_equal(json_array_size(json_object_get(message, "tags")), count);
    json_decref(message);
    return all;
}

/* After the core's records were moved away, pages at a renderer must forget the checks too. */
TEST_ON(struct loop_checks_fixture *f, test_clients_of_a_mirror_forget_discarded_checks, set_up, tear_down)
{
    struct loop_checks *copy = loop_checks_open(f->log, f->plant, NULL, NULL);
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    mirror(f, copy);
    uint64_t sent = loop_checks_number(copy);
    assert_true(contains_all(f, copy, 0, 1));
    assert_false(contains_all(f, copy, sent, 0));
    assert_true(loop_checks_unproven(copy, 1));
    char *path = test_printf("%s/" LOOP_CHECKS_FILE, f->folder);
    assert_int_equal(unlink(path), 0);
    open_again(f);
    mirror(f, copy);
    assert_true(contains_all(f, copy, sent, 0));
    assert_false(loop_checks_begun(copy) || loop_checks_unproven(copy, 1));
    loop_checks_close(&copy);
}

TEST_ON(struct loop_checks_fixture *f, test_an_invalid_message_of_the_core_changes_nothing, set_up, tear_down)
{
    static const char *const wrong[] = { "{}", "{\"all\":true,\"begun\":true,\"tags\":[[1,\"pass\",5,1,1,1,\"Kim\",\"\"],[]]}",
                                         "{\"all\":true,\"begun\":true,\"tags\":[[3,\"pass\",5,1,1,1,\"Kim\",\"\"]]}" };
    struct loop_checks *copy = loop_checks_open(f->log, f->plant, NULL, NULL);
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    mirror(f, copy);
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        json_t *message = json_loads(wrong[i], 0, NULL);
        assert_false(loop_checks_take(copy, f->plant, message));
        json_decref(message);
        assert_true(!loop_checks_unproven(copy, 0) && loop_checks_unproven(copy, 1));
    }
    loop_checks_close(&copy);
}

/* A text that is too long never ends inside a character: JSON could not contain it. */
TEST_ON(struct loop_checks_fixture *f, test_long_texts_end_with_a_whole_character, set_up, tear_down)
{
    enum { HANGUL = 21, TOO_LONG = LOOP_CHECK_REMARK_BYTES - 2 };
    struct text unit = { 0 }, row = { 0 };
    text_add(&unit, "a");
    for (int i = 0; i < HANGUL; i++)
        text_add(&unit, "도");
    f->plant->tags[0].unit = mem_strdup(unit.at);
    assert_int_equal(loop_checks_add(f->loop_checks, 0, &passed), REFUSAL_NONE);
    text_add(&row, "2023-11-14T22:13:20Z,\"TI-2\",pass,1,\"\",1,1,\"Kim\",\"%0*dé\",%016" PRIx64 "\n", TOO_LONG, 0,
             loop_check_fingerprint(f->plant, 1));
    char *path = test_printf("%s/" LOOP_CHECKS_FILE, f->folder);
    FILE *file = fopen(path, "ab");
    assert_true(fputs(row.at, file) >= 0 && fclose(file) == 0);
    open_again(f);
    assert_int_equal(strlen(loop_checks_of(f->loop_checks, 0)->unit), unit.length - strlen("도"));
    assert_int_equal(strlen(loop_checks_of(f->loop_checks, 1)->remark), TOO_LONG);
    struct loop_checks *copy = loop_checks_open(f->log, f->plant, NULL, NULL);
    mirror(f, copy);
    expect_unproven(f, false, false);
    assert_false(loop_checks_unproven(copy, 0) || loop_checks_unproven(copy, 1));
    loop_checks_close(&copy);
    text_finish(&unit);
    text_finish(&row);
}
