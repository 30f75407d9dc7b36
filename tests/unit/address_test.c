/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parsing of Modbus addresses, data types, byte orders and numbers as tag lists write them. */
#include "plant/sources/address.h"

#include "tests/support/test.h"

#include "plant/parse/number.h"
#include "plant/parse/suggest.h"

TEST(good_addresses_are_read)
{
    static const struct {
        const char *text;
        int base;
        struct modbus_address is;
    } cases[] = {
        { "40001", 1, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_NONE } },
        { "400001", 1, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_NONE } },
        { "40000", 0, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_NONE } },
        { "40001", 0, { -1, TABLE_HOLDING, 1, -1, BYTE_ORDER_NONE } },
        { "49999", 1, { -1, TABLE_HOLDING, 9998, -1, BYTE_ORDER_NONE } },
        { "465536", 1, { -1, TABLE_HOLDING, 65535, -1, BYTE_ORDER_NONE } },
        { "465535", 0, { -1, TABLE_HOLDING, 65535, -1, BYTE_ORDER_NONE } },
        { "00001", 1, { -1, TABLE_COIL, 0, -1, BYTE_ORDER_NONE } },
        { "000010", 1, { -1, TABLE_COIL, 9, -1, BYTE_ORDER_NONE } },
        { "10001", 1, { -1, TABLE_DISCRETE, 0, -1, BYTE_ORDER_NONE } },
        { "165536", 1, { -1, TABLE_DISCRETE, 65535, -1, BYTE_ORDER_NONE } },
        { "30007", 1, { -1, TABLE_INPUT, 6, -1, BYTE_ORDER_NONE } },
        { "300007", 1, { -1, TABLE_INPUT, 6, -1, BYTE_ORDER_NONE } },
        { "hr:0", 1, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_NONE } },
        { "HR:65535", 0, { -1, TABLE_HOLDING, 65535, -1, BYTE_ORDER_NONE } },
        { "ir:12", 1, { -1, TABLE_INPUT, 12, -1, BYTE_ORDER_NONE } },
        { "co:3", 1, { -1, TABLE_COIL, 3, -1, BYTE_ORDER_NONE } },
        { "di:4", 1, { -1, TABLE_DISCRETE, 4, -1, BYTE_ORDER_NONE } },
        { "1!400001", 1, { 1, TABLE_HOLDING, 0, -1, BYTE_ORDER_NONE } },
        { "255!hr:7", 1, { 255, TABLE_HOLDING, 7, -1, BYTE_ORDER_NONE } },
        { "400011.3", 1, { -1, TABLE_HOLDING, 10, 3, BYTE_ORDER_NONE } },
        { "ir:0.15", 1, { -1, TABLE_INPUT, 0, 15, BYTE_ORDER_NONE } },
        { "400001#LL", 1, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_ABCD } },
        { "400001#BL", 1, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_CDAB } },
        { "400001#LB", 1, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_BADC } },
        { "400001#bb", 1, { -1, TABLE_HOLDING, 0, -1, BYTE_ORDER_DCBA } },
        { "2!hr:5.0#CDAB", 1, { 2, TABLE_HOLDING, 5, 0, BYTE_ORDER_CDAB } },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct modbus_address got;
        char why[200] = "";
        if (!address_parse(cases[i].text, cases[i].base, &got, why))
            fail_msg("%s: %s", cases[i].text, why);
        const struct modbus_address *is = &cases[i].is;
        bool same_place = got.unit == is->unit && got.table == is->table && got.index == is->index;
        if (!same_place || got.bit != is->bit || got.byte_order != is->byte_order)
            fail_msg("%s: unit %d table %d index %d bit %d order %d", cases[i].text, got.unit, got.table, got.index, got.bit,
                     got.byte_order);
    }
}

TEST(bad_addresses_are_explained)
{
    static const char *const cases[][2] = {
        { "", "of 5 or 6 digits such as 40001" },
        { "D100", "of 5 or 6 digits such as 40001" },
        { "-40001", "of 5 or 6 digits such as 40001" },
        { " 40001", "of 5 or 6 digits such as 40001" },
        { "4001", "4 digits; expected 5 or 6" },
        { "4000001", "6 and more digits; expected 5 or 6" },
        { "400000000000000000000000001", "6 and more digits" },
        { "50001", "this Modbus address begins with 5; expected 0 (coil)" },
        { "20001", "this Modbus address begins with 2; expected 0 (coil)" },
        { "40000", "expected a register number from 1 to 65536 after the first digit of this Modbus address (address_base is 1)" },
        { "465537", "expected a register number from 1 to 65536" },
        { "499999", "expected a register number from 1 to 65536" },
        { "hr:", "expected the number of a Modbus register or bit, 0 to 65535, after hr:" },
        { "hr:65536", "expected the number of a Modbus register or bit, 0 to 65535, after hr:" },
        { "ir:9999999999", "expected the number of a Modbus register or bit, 0 to 65535, after ir:" },
        { "hr:-1", "expected the number of a Modbus register or bit, 0 to 65535, after hr:" },
        { "256!40001", "expected a Modbus unit number from 0 to 255 before the character !" },
        { "!40001", "expected a Modbus unit number from 0 to 255 before the character !" },
        { "a!40001", "expected a Modbus unit number from 0 to 255 before the character !" },
        { "1!!40001", "of 5 or 6 digits such as 40001" },
        { "40001.16", "expected the number of a bit in the register, 0 to 15" },
        { "40001.", "expected the number of a bit in the register, 0 to 15" },
        { "00001.1", "a coil is a single bit" },
        { "10001.1", "a discrete input is a single bit" },
        { "40001#XX", "the byte order #LL (ABCD), #BL (CDAB), #LB (BADC) or #BB (DCBA)" },
        { "40001#", "the byte order #LL (ABCD)" },
        { "40001#BL.3", "the byte order #LL (ABCD)" },
        { "40001x", "this Modbus address is complete after '40001', but 'x' follows" },
        { "40001 ", "this Modbus address is complete after '40001'" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct modbus_address got;
        char why[200] = "";
        if (address_parse(cases[i][0], 1, &got, why) || !strstr(why, cases[i][1]))
            fail_msg("'%s' gave '%s', expected '%s'", cases[i][0], why, cases[i][1]);
    }
}

TEST(types_have_two_names)
{
    static const struct {
        const char *ours, *kepware;
        enum data_type type;
        int registers;
    } cases[] = {
        { "bool", "Boolean", DATA_BIT, 1 },      { "int16", "Short", DATA_INT16, 1 },     { "uint16", "Word", DATA_UINT16, 1 },
        { "int32", "Long", DATA_INT32, 2 },      { "uint32", "DWord", DATA_UINT32, 2 },   { "float32", "Float", DATA_FLOAT32, 2 },
        { "int64", "LLong", DATA_INT64, 4 },     { "uint64", "QWord", DATA_UINT64, 4 },   { "float64", "Double", DATA_FLOAT64, 4 },
        { "bcd", "BCD", DATA_BCD, 1 },           { "lbcd", "LBCD", DATA_LBCD, 2 },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        enum data_type ours = DATA_BIT, kepware = DATA_BIT;
        assert_true(data_type_parse(cases[i].ours, &ours));
        assert_true(data_type_parse(cases[i].kepware, &kepware));
        assert_int_equal(ours, cases[i].type);
        assert_int_equal(kepware, cases[i].type);
        assert_int_equal(data_type_registers(ours), cases[i].registers);
        assert_string_equal(data_type_name(ours), cases[i].ours);
    }
    enum data_type none;
    assert_false(data_type_parse("String", &none));
    assert_false(data_type_parse("", &none));
    assert_string_equal(data_type_suggest("Flot"), "float");
}

TEST(numbers_are_decimal)
{
    static const struct {
        const char *text;
        double is;
    } good[] = { { "0", 0 }, { "-1.5", -1.5 }, { "+.5", 0.5 }, { "5.", 5 }, { "1e3", 1000 }, { "1.25E-2", 0.0125 }, { "010", 10 } };
    static const char *const not_numbers[] = { "", "x", "1,5", "0x10", "1e", "1 ", " 1", "--1", ".", "-", "1.2.3", "1e+", "1_000" };
    static const char *const not_finite[] = { "nan", "NaN", "-inf", "+Infinity", ".nan", "-.INF", "1e999", "-1e309", "#NUM!" };
    double value;
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++) {
        value = 99;
        assert_int_equal(number_parse(good[i].text, &value), NUMBER_GOOD);
        assert_true(value == good[i].is);
    }
    value = 99;
    for (size_t i = 0; i < sizeof(not_numbers) / sizeof(*not_numbers); i++)
        if (number_parse(not_numbers[i], &value) != NUMBER_NOT_A_NUMBER)
            fail_msg("'%s' is taken for a number", not_numbers[i]);
    for (size_t i = 0; i < sizeof(not_finite) / sizeof(*not_finite); i++)
        if (number_parse(not_finite[i], &value) != NUMBER_NOT_FINITE)
            fail_msg("'%s' is taken for finite", not_finite[i]);
    assert_true(value == 99);
}

TEST(the_nearest_name_is_suggested)
{
    static const char *const names[] = { "min", "max", NULL, "limits", "interpolation", "temperature", "E-101A", "E-101B" };
    static const char *const cases[][2] = {
        { "mim", "min" },
        { "mxa", "max" },
        { "MAX", "max" },
        { "limit", "limits" },
        { "interpolaton", "interpolation" },
        { "temprature", "temperature" },
        { "E-101A", "E-101A" },
        { "E-110B", "E-101B" },
        { "zz", NULL },
        { "", NULL },
        { "pressure", NULL },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        const char *near = suggest_nearest(cases[i][0], names, 8, sizeof(*names));
        if (!cases[i][1])
            assert_null(near);
        else if (!near || strcmp(near, cases[i][1]) != 0)
            fail_msg("'%s' suggests '%s', expected '%s'", cases[i][0], near ? near : "nothing", cases[i][1]);
    }
    char long_name[200];
    memset(long_name, 'x', sizeof(long_name) - 1);
    long_name[sizeof(long_name) - 1] = 0;
    assert_null(suggest_nearest(long_name, names, 8, sizeof(*names)));
}
