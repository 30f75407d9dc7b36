/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans for reading Modbus registers: which registers are read with one request. Plans of random tag lists are checked against
   each rule. */
#include "tests/support/test.h"

#include "tests/support/plant_by_hand.h"
#include "value/backoff.h"
#include "value/decode.h"
#include "value/read_plan.h"
#include "value/read_plan_text.h"

static struct plant *plant_of_registers(const int *registers, size_t count, enum register_table table, enum data_type type)
{
    struct plant *plant = plant_by_hand_create(count);
    plant_by_hand_source(plant, "a", 1);
    for (size_t i = 0; i < count; i++)
        plant_by_hand_tag(plant, test_printf("t%zu", i), table, registers[i], type);
    return plant;
}

static void assert_block(const struct read_plan *plan, size_t index, int first, int count, size_t tags)
{
    assert_true(index < plan->block_count);
    assert_int_equal(plan->blocks[index].first, first);
    assert_int_equal(plan->blocks[index].count, count);
    assert_int_equal(plan->blocks[index].tag_count, tags);
}

TEST(neighbours_go_together_and_gaps_part)
{
    struct read_plan plan;
    struct plant *plant = plant_of_registers((int[]){ 14, 10, 12, 20, 22, 18 }, 6, TABLE_HOLDING, DATA_FLOAT32);
    read_plan_init(&plan, plant, 0);
    assert_int_equal(plan.block_count, 2);
    assert_block(&plan, 0, 10, 6, 3);
    assert_block(&plan, 1, 18, 6, 3);
    assert_int_equal(plan.tags[0], 1); /* plan.tags contains indices of tags, sorted by register */
    assert_int_equal(plan.tags[5], 4);
    read_plan_finish(&plan);
}

TEST(units_tables_scans_and_sources_part)
{
    struct read_plan plan;
    struct plant *plant = plant_of_registers((int[]){ 0, 1, 2, 3, 4 }, 5, TABLE_HOLDING, DATA_INT16);
    plant->tags[1].signal.modbus_unit = 7;
    plant->tags[2].signal.table = TABLE_INPUT;
    plant->tags[3].signal.scan_ms = 5000;
    plant_by_hand_source(plant, "b", 2);
    plant->tags[4].source = 1;
    read_plan_init(&plan, plant, 0);
    assert_int_equal(plan.block_count, 4);
    assert_int_equal(plan.tag_count, 4);
    assert_int_equal(plan.unit_count, 2);
    assert_int_equal(plan.units[0], 1);
    assert_int_equal(plan.units[1], 7);
    read_plan_finish(&plan);
    read_plan_init(&plan, plant, 1);
    assert_int_equal(plan.block_count, 1);
    assert_block(&plan, 0, 4, 1, 1);
    read_plan_finish(&plan);
}

static void many(enum register_table table, enum data_type type, int width, int count, const int *block_counts, size_t blocks)
{
    struct read_plan plan;
    int *registers = mem_array((size_t)count, sizeof(*registers));
    for (int i = 0; i < count; i++)
        registers[i] = 100 + i * width;
    struct plant *plant = plant_of_registers(registers, (size_t)count, table, type);
    read_plan_init(&plan, plant, 0);
    assert_int_equal(plan.block_count, blocks);
    for (size_t i = 0; i < blocks; i++)
        assert_int_equal(plan.blocks[i].count, block_counts[i]);
    read_plan_finish(&plan);
    mem_free(registers);
}

TEST(a_request_is_full_at_its_limit_and_splits_no_value)
{
    many(TABLE_HOLDING, DATA_INT16, 1, 125, (int[]){ 125 }, 1);
    many(TABLE_HOLDING, DATA_INT16, 1, 126, (int[]){ 125, 1 }, 2);
    many(TABLE_INPUT, DATA_INT16, 1, 251, (int[]){ 125, 125, 1 }, 3);
    many(TABLE_HOLDING, DATA_FLOAT32, 2, 63, (int[]){ 124, 2 }, 2);
    many(TABLE_HOLDING, DATA_FLOAT64, 4, 32, (int[]){ 124, 4 }, 2);
    many(TABLE_COIL, DATA_BIT, 1, 2000, (int[]){ 2000 }, 1);
    many(TABLE_DISCRETE, DATA_BIT, 1, 2001, (int[]){ 2000, 1 }, 2);
}

TEST(gaps_are_bridged_up_to_the_device_s_limit)
{
    struct read_plan plan;
    struct plant *plant = plant_of_registers((int[]){ 0, 6, 13, 23 }, 4, TABLE_HOLDING, DATA_FLOAT32);
    plant->sources[0].max_gap = 5;
    read_plan_init(&plan, plant, 0);
    /* registers 0, 6 and 13 are in one block (one request), across gaps of 4 and 5 registers that no tag uses */
    assert_block(&plan, 0, 0, 15, 3);
    assert_block(&plan, 1, 23, 2, 1); /* register 23 is in a block of its own: the gap of 8 registers before it exceeds the limit */
    read_plan_split(&plan, plant, 0);
    /* after the device has refused a block, it is split at its first gap, so that the unused registers are no longer read */
    assert_block(&plan, 0, 0, 2, 1);
    assert_block(&plan, 1, 6, 9, 2);
    read_plan_finish(&plan);
    plant->sources[0].max_registers = 8;
    read_plan_init(&plan, plant, 0);
    assert_block(&plan, 0, 0, 8, 2);
    assert_block(&plan, 1, 13, 2, 1);
    assert_block(&plan, 2, 23, 2, 1);
    read_plan_finish(&plan);
}

TEST(two_tags_may_share_registers)
{
    struct read_plan plan;
    struct plant *plant = plant_of_registers((int[]){ 10, 10, 11, 10 }, 4, TABLE_HOLDING, DATA_FLOAT32);
    plant->tags[1].signal.type = DATA_BIT; /* bits of one register */
    plant->tags[1].signal.bit = 3;
    plant->tags[3].signal.type = DATA_BIT;
    plant->tags[3].signal.bit = 4;
    read_plan_init(&plan, plant, 0);
    assert_int_equal(plan.block_count, 1);
    assert_block(&plan, 0, 10, 3, 4);
    read_plan_split(&plan, plant, 0);
    assert_block(&plan, 0, 10, 1, 2);
    assert_block(&plan, 1, 10, 3, 2);
    read_plan_finish(&plan);
}

TEST(splitting_ends_at_single_tags)
{
    struct read_plan plan;
    struct plant *plant = plant_of_registers((int[]){ 0, 2, 4, 6, 8 }, 5, TABLE_HOLDING, DATA_FLOAT32);
    read_plan_init(&plan, plant, 0);
    plan.blocks[0].due_ns = 77;
    for (size_t i = 0; i < plan.block_count;)
        if (plan.blocks[i].tag_count > 1)
            read_plan_split(&plan, plant, i);
        else
            i++;
    assert_int_equal(plan.block_count, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_block(&plan, i, (int)i * 2, 2, 1);
        assert_int_equal(plan.tags[plan.blocks[i].first_tag], i);
        assert_true(plan.blocks[i].due_ns == 77);
    }
    read_plan_finish(&plan);
}

enum { REGISTERS = 1000 };

/* Asserts that every tag is in exactly one block, that blocks keep the size limits, and that no block contains a gap of unused
   registers above the limit. */
static void check_rules(const struct plant *plant, const struct read_plan *plan)
{
    char wanted[2][REGISTERS + 4] = { { 0 } };
    size_t seen = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        for (int r = 0; r < decode_width(&plant->tags[i]); r++)
            wanted[plant->tags[i].signal.table == TABLE_COIL][plant->tags[i].signal.register_index + r] = 1;
    for (size_t b = 0; b < plan->block_count; b++) {
        const struct read_plan_block *block = &plan->blocks[b];
        int gap = 0;
        int most = block->table == TABLE_COIL ? plant->sources->max_bits : plant->sources->max_registers;
        assert_in_range(block->count, 1, most);
        assert_int_equal(block->first_tag, seen);
        for (size_t t = 0; t < block->tag_count; t++, seen++) {
            const struct plant_tag *tag = &plant->tags[plan->tags[seen]];
            int offset = tag->signal.register_index - block->first;
            assert_int_equal(tag->signal.table, block->table);
            assert_true(offset >= 0 && offset + decode_width(tag) <= block->count);
        }
        for (int i = 0; i < block->count; i++) {
            gap = wanted[block->table == TABLE_COIL][block->first + i] ? 0 : gap + 1;
            assert_true(gap <= plant->sources->max_gap);
        }
        assert_int_equal(gap, 0);
    }
    assert_int_equal(seen, plan->tag_count);
}

TEST(random_tag_lists_obey_the_rules)
{
    const enum data_type types[] = { DATA_INT16, DATA_FLOAT32, DATA_FLOAT64 };
    unsigned seed = 20240617;
    print_message("# seed %u\n", seed);
    srand(seed);
    for (int round = 0; round < 200; round++) {
        struct read_plan plan;
        size_t count = 1 + (size_t)rand() % 400;
        struct plant *plant = plant_by_hand_create(count);
        struct plant_source *source = plant_by_hand_source(plant, "a", 1);
        source->max_gap = round % 2 ? rand() % 20 : 0;
        source->max_registers = round % 3 ? 4 + rand() % 122 : 125;
        source->max_bits = round % 5 ? 4 + rand() % 1997 : 2000;
        for (size_t i = 0; i < count; i++) {
            char *name = test_printf("t%zu", i);
            enum register_table table = rand() % 4 ? TABLE_HOLDING : TABLE_COIL;
            plant_by_hand_tag(plant, name, table, rand() % REGISTERS, types[rand() % 3]);
        }
        read_plan_init(&plan, plant, 0);
        assert_int_equal(plan.tag_count, count);
        check_rules(plant, &plan);
        for (int i = 0; i < 20; i++) {
            size_t b = (size_t)rand() % plan.block_count;
            if (plan.blocks[b].tag_count > 1)
                read_plan_split(&plan, plant, b);
        }
        check_rules(plant, &plan);
        read_plan_finish(&plan);
    }
}

TEST(a_plan_is_put_in_words)
{
    struct text text = { 0 };
    struct plant *plant = plant_of_registers((int[]){ 0, 2, 10, 7 }, 4, TABLE_HOLDING, DATA_FLOAT32);
    plant->tags[3].signal.table = TABLE_INPUT;
    plant->tags[3].signal.type = DATA_BIT;
    plant->tags[3].signal.byte_order = BYTE_ORDER_NONE;
    plant->tags[3].signal.bit = 3;
    plant->sources[0].poll_ms = 500;
    plant->sources[0].pause_ms = 10;
    read_plan_text(&text, plant, 0);
    assert_string_equal(text.at, "source a: 127.0.0.1:1: 4 tags in 3 requests\n"
                                 "  unit 1, function 4, ir:7 to 7: 1 register every 500 ms, 1 tag\n"
                                 "    ir:7.3 bool t3\n"
                                 "  unit 1, function 3, hr:0 to 3: 4 registers every 500 ms, 2 tags\n"
                                 "    hr:0 float32 ABCD t0\n"
                                 "    hr:2 float32 ABCD t1\n"
                                 "  unit 1, function 3, hr:10 to 11: 2 registers every 500 ms, 1 tag\n"
                                 "    hr:10 float32 ABCD t2\n"
                                 "  load: 6 requests, 8 values and 154 bytes per second; waiting `pause_ms` after each answer takes 6 % "
                                 "of the time\n");
    text_finish(&text);
    plant->sources[0].transport = TRANSPORT_RTU;
    plant->sources[0].host_count = 0;
    plant->sources[0].device = "/dev/ttyS0";
    plant->sources[0].baud = 1200;
    read_plan_text(&text, plant, 0);
    /* Expected load of the serial line: (3 requests x 13 + 14 bytes of values) x 2 per second = 106 bytes of 10 bits each. The
       pauses that Modbus demands take as long as 7 bytes per request. */
    assert_non_null(strstr(text.at, "source a: /dev/ttyS0, 1200 baud, parity N, 1 stop bit: 4 tags"));
    assert_non_null(strstr(text.at,
                           "106 bytes per second; waiting `pause_ms` after each answer takes 6 % of the time; 123 % of the serial line's "
                           "capacity: TOO MUCH"));
    text_finish(&text);
    mem_free(plant->sources[0].kind);
    plant->sources[0].kind = mem_strdup("replay");
    plant->sources[0].transport = TRANSPORT_TCP;
    read_plan_text(&text, plant, 0);
    assert_string_equal(text.at, "source a: replay: no requests, replays 4 tags\n");
    text_finish(&text);
    mem_free(plant->sources[0].kind);
    plant->sources[0].kind = mem_strdup("opcua");
    plant->sources[0].host_count = 1;
    read_plan_text(&text, plant, 0);
    assert_string_equal(text.at, "source a: 127.0.0.1:1: opcua: subscribes to 4 tags\n");
    text_finish(&text);
    plant->sources[0].host_count = 0;
    mem_free(plant->sources[0].hosts[0]);
}

TEST(backoff_grows_from_half_a_second_to_ten)
{
    struct backoff backoff = { 0 };
    int64_t first_ns = backoff_next_ns(&backoff, 1), spread_ns = 0, last_ns = 0;
    assert_true(first_ns >= 500000000 && first_ns <= 750000000);
    for (int i = 0; i < 100; i++) {
        int64_t next_ns = backoff_next_ns(&backoff, (uint64_t)i);
        assert_true(next_ns >= 500000000 && next_ns <= 10000000000);
        if (i > 10) {
            assert_true(next_ns >= 9000000000);
            spread_ns += llabs(next_ns - last_ns);
        }
        last_ns = next_ns;
    }
    assert_true(spread_ns > 1000000000); /* jitter */
    backoff = (struct backoff){ 0 };
    assert_true(backoff_next_ns(&backoff, 5) <= 750000000);
}
