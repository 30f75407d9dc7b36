/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tag lists in Kepware's format and in ours, and every kind of mistake, with its line, column and message. */
#include "tests/support/test.h"

#include "base/text/text.h"
#include "tests/support/plant_case.h"

#define CASE(name) TEST_ON(struct plant_case *c, name, plant_case_set_up, plant_case_tear_down)

#define YAML(source)                                                                                                                       \
    "plant: { name: P }\n"                                                                                                                 \
    "assets: [{ id: E-101, model: m.glb }, { id: E-102, model: m.glb }]\n"                                                                 \
    "groups: [{ id: temp, unit: °C, min: 0, max: 100, limits: { L: 10, H: 90 }, strength: 3, decay: 4 }]\n"                               \
    "sources: " source "\n"                                                                                                                \
    "tags: tags.csv\n"
static const char yaml[] = YAML("[{ id: plc, type: modbus, host: h, byte_order: CDAB, address_base: 1, poll_ms: 3000 }]");
static const char yaml_no_order[] = YAML("[{ id: plc, type: modbus, host: h }]");
static const char yaml_two_sources[] = YAML("[{ id: plc1, type: modbus, host: h, byte_order: ABCD, address_base: 1 }, "
                                            "{ id: plc2, type: modbus, host: h2, byte_order: DCBA, address_base: 0 }]");
static const char yaml_no_source[] = YAML("[]");

CASE(a_kepware_export_is_read)
{
    plant_case_load(c, yaml,
                    "\xEF\xBB\xBFTag Name,Address,Data Type,Respect Data Type,Client Access,Scan Rate,Scaling,Raw Low,Raw High,Scaled Low,"
                    "Scaled High,Scaled Data Type,Clamp Low,Clamp High,Eng. Units,Description,Negate Value\r\n"
                    "\"TT-101\",\"400001\",Float,1,RO,500,,,,,,,0,0,degC,\"Inlet, shell\",0\r\n"
                    "\"FT-1\",300005,Word,1,R/W,100,Linear,0,65535,0,120,Double,0,0,m3/h,,1\r\n"
                    "\"XS-1\",000017,Boolean,1,RO,100,None,,,,,,,,,,\r\n"
                    "\"XS-2\",100003,Default,1,RO,0,,,,,,,,,,,\r\n"
                    "\"LT-1\",400100,Default,1,RO,100,,,,,,,,,,,\r\n"
                    "\"QI-1\",400200,LLong,1,RO,100,,,,,,,,,,,\r\n"
                    "\"XB-1\",400300.07,,1,RO,100,,,,,,,,,,,\r\n");
    plant_case_assert_loaded(c, 0);
    const struct plant_tag *t = c->plant->tags;
    assert_int_equal(c->plant->tag_count, 7);
    assert_string_equal(t[0].description, "Inlet, shell");
    assert_string_equal(t[0].unit, "degC");
    assert_true(t[0].signal.type == DATA_FLOAT32 && t[0].signal.byte_order == BYTE_ORDER_CDAB && t[0].signal.scan_ms == 500 &&
                t[0].signal.table == TABLE_HOLDING);
    assert_true(t[1].signal.type == DATA_UINT16 && t[1].signal.byte_order == BYTE_ORDER_NONE && t[1].signal.table == TABLE_INPUT &&
                t[1].signal.register_index == 4);
    assert_true(t[1].scale.kind == SCALING_LINEAR && t[1].scale.raw_high == 65535 && t[1].scale.scaled_high == 120 && t[1].scale.negate);
    assert_true(t[2].signal.type == DATA_BIT && t[2].signal.table == TABLE_COIL && t[2].signal.register_index == 16 &&
                t[2].scale.kind == SCALING_NONE);
    assert_true(t[3].signal.type == DATA_BIT && t[3].signal.table == TABLE_DISCRETE && t[3].signal.scan_ms == 0 &&
                t[3].validity.stale_s == 9);
    assert_true(t[4].signal.type == DATA_UINT16 && t[5].signal.type == DATA_INT64 && t[5].signal.byte_order == BYTE_ORDER_CDAB);
    assert_true(t[6].signal.type == DATA_BIT && t[6].signal.bit == 7 && t[6].signal.byte_order == BYTE_ORDER_NONE);
}

CASE(blank_cells_take_the_group_s_values)
{
    plant_case_load(c, yaml,
                    "tag name;ADDRESS;group;asset;x;y;z;Strength;Decay;HH;Sim Kind;sim anything\n"
                    "A;40001;temp;E-101;1.5;-2;3e0;;;;ramp;1\n"
                    "B;40002;temp;E-102;0;0;0;1;2;95;;\n");
    plant_case_assert_loaded(c, 0);
    const struct plant_tag *t = c->plant->tags;
    assert_true(t[0].strength == 3 && t[0].decay == 4 && t[0].alarms.limits[LIMIT_L] == 10 && t[0].alarms.limits[LIMIT_H] == 90);
    assert_true(isnan(t[0].alarms.limits[LIMIT_HH]) && t[0].place.position_m[0] == 1.5 && t[0].place.position_m[1] == -2 &&
                t[0].place.position_m[2] == 3);
    assert_true(t[1].strength == 1 && t[1].decay == 2 && t[1].alarms.limits[LIMIT_HH] == 95 && t[1].asset == 1 && t[1].place.has_position);
    assert_string_equal(t[0].unit, "°C");
}

CASE(byte_orders_are_resolved)
{
    plant_case_load(c, yaml_two_sources,
                    "Tag Name,Address,Data Type,Byte Order,Source\n"
                    "A,400001,Float,,plc1\n"
                    "B,400001,Float,,plc2\n"
                    "C,400003,Float,BADC,plc2\n"
                    "D,400005#BL,DWord,,plc1\n"
                    "E,400005#BL,DWord,cdab,plc1\n"
                    "F,400007,Short,,plc2\n"
                    "G,400007,Short,DCBA,plc1\n"
                    "H,400009,LBCD,,plc1\n"
                    "I,400010.3,Boolean,BADC,plc2\n"
                    "J,400010.4,Boolean,,plc2\n");
    plant_case_assert_loaded(c, 0);
    static const enum byte_order orders[] = { BYTE_ORDER_ABCD, BYTE_ORDER_DCBA, BYTE_ORDER_BADC, BYTE_ORDER_CDAB,
                                              BYTE_ORDER_CDAB, BYTE_ORDER_NONE, BYTE_ORDER_DCBA, BYTE_ORDER_ABCD,
                                              BYTE_ORDER_BADC, BYTE_ORDER_NONE };
    for (int i = 0; i < 10; i++)
        assert_int_equal(c->plant->tags[i].signal.byte_order, orders[i]);
    assert_int_equal(c->plant->tags[0].signal.register_index, 0);
    assert_int_equal(c->plant->tags[1].signal.register_index, 1); /* address_base 0 */
    plant_case_load(c, yaml_no_order, "Tag Name,Address,Data Type,Byte Order\nA,hr:0,Float,\nB,ir:2,Double,\nC,400007,Word,\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 14, "Byte Order: float32 has 32 bits, so a byte order is required: ABCD, CDAB, BADC or DCBA" },
          { "tags.csv", 3, 15, "float64 has 64 bits" });
    plant_case_load(c, yaml_no_order, "Tag Name,Address,Data Type\nA,hr:0,Float\n");
    FOUND(c, { "tags.csv", 2, 8, "float32 has 32 bits, so a byte order is required" });
    plant_case_load(c, yaml, "Tag Name,Address,Data Type,Byte Order\nA,400001,Float,big\nB,400001#BB,Float,ABCD\n");
    FOUND(c, { "tags.csv", 2, 16, "Byte Order: expected ABCD, CDAB, BADC or DCBA, found 'big'" },
          { "tags.csv", 3, 19, "Byte Order: 'ABCD' contradicts the address '400001#BB'" });
}

/* Addresses of 32-bit values are refused if it is unclear whether registers count from 0 or 1: an address off by one would
   still give a plausible value, so the reader never guesses. */
CASE(where_long_values_begin_is_never_guessed)
{
    plant_case_load(c, yaml_no_order,
                    "Tag Name,Address,Data Type\nA,7!400001#BL,Float\nB,300003#LL,QWord\nC,400009,Word\nD,hr:9#BL,Float\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 3, "float32 has 32 bits, so state whether registers are counted from 0 or 1" },
          { "tags.csv", 3, 3,
            "by address_base in the source, or here by ir:2 (from 0, as on the wire; ir:3 if registers are counted from 0)" });
}

CASE(instruments_say_what_they_can_measure)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,NE 43,Open Circuit,Flatline s\n"
                    "A,40001,Linear,4000,20000,0,100,1,0x8000 | 32767 -1.5e3,60\n"
                    "B,40002,,,,-50,150,,,\n"
                    "C,40003,,,,,,,,\n");
    plant_case_assert_loaded(c, 0);
    const struct plant_tag *t = c->plant->tags;
    assert_true(t[0].scale.ne43 && t[0].scale.has_range && t[0].scale.sentinel_count == 3 && t[0].validity.flatline_s == 60);
    assert_true(t[0].scale.sentinels[0].is_bits && t[0].scale.sentinels[0].bits == 0x8000);
    assert_true(!t[0].scale.sentinels[1].is_bits && t[0].scale.sentinels[1].number == 32767 && t[0].scale.sentinels[2].number == -1500);
    assert_true(t[1].scale.has_range && t[1].scale.kind == SCALING_NONE && t[1].scale.scaled_low == -50 &&
                t[1].scale.scaled_high == 150);
    assert_true(!t[2].scale.has_range && !t[2].scale.ne43 && t[2].scale.sentinel_count == 0 && t[2].validity.flatline_s == 0);
    plant_case_load(c, yaml,
                    "Tag Name,Address,NE 43,Open Circuit,Flatline s\n"
                    "A,40001,yes,,0\n"
                    "B,40002,,0xZZ,\n"
                    "C,40003,,open,\n"
                    "D,40003,,1 2 3 4 5,\n"
                    "E,40003,,0x,\n");
    FOUND(c, { "tags.csv", 2, 9, "NE 43: requires Scaling to be Linear or Square Root" },
          { "tags.csv", 2, 14, "Flatline s: expected a number from 0.001" },
          { "tags.csv", 3, 10, "Open Circuit: expected at most 4 raw values such as 0x8000 or -32768, found '0xZZ'" },
          { "tags.csv", 4, 10, "found 'open'" }, { "tags.csv", 5, 10, "found '5'" }, { "tags.csv", 6, 10, "found '0x'" });
}

/* Values of derived and replayed tags are in engineering units already, so the columns for raw values do not affect them. */
CASE(raw_values_are_those_of_devices)
{
    temp_write_text(c->folder, "r.csv", "t_s,B,D\n0,1,1\n");
    plant_case_load(c, YAML("[{ id: plc, type: modbus, host: h, address_base: 1 }, { id: rec, type: replay, file: r.csv }]"),
                    "Tag Name,Source,Address,Negate Value,Open Circuit\n"
                    "A,plc,40001,1,0x8000\n"
                    "B,rec,,1,-1\n"
                    "C,,= [A] - [B],yes,0x8000 -1\n"
                    "D,rec,,0,\n");
    FOUND(c, { "tags.csv", 3, 8, "Negate Value has no effect on 'B': the value of a replayed tag is in engineering units" },
          { "tags.csv", 3, 10, "Open Circuit has no effect on 'B'" },
          { "tags.csv", 4, 16, "Negate Value has no effect on 'C': the value of a derived tag is in engineering units" },
          { "tags.csv", 4, 20, "Open Circuit has no effect on 'C': a derived tag has no raw value" });
    assert_non_null(c->plant);
}

/* By default, tags of MQTT publishers become stale when they send nothing for a while. Tags of Sparkplug nodes do not, because
   a node's loss is reported. */
CASE(silent_tags_are_stale_unless_their_loss_is_reported)
{
    plant_case_load(c, YAML("[{ id: n, type: mqtt, host: h, topic: \"a/{tag}\" },"
                            " { id: j, type: mqtt, host: h, payload: json, topic: \"a/{tag}\", poll_ms: 2000 },"
                            " { id: s, type: mqtt, host: h, payload: sparkplug }]"),
                    "Tag Name,Source,Address,Stale s\nA,n,,\nB,j,,\nC,j,,60\nD,s,G/N#D,\nE,s,G/N#E,9\n");
    plant_case_assert_loaded(c, 0);
    const double stale_s[] = { 5, 6, 60, PLANT_NEVER_STALE_S, 9 };
    for (size_t i = 0; i < sizeof(stale_s) / sizeof(*stale_s); i++)
        assert_true(c->plant->tags[i].validity.stale_s == stale_s[i]);
}

CASE(tags_vouch_for_other_tags)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Quality Tag\n"
                    "A,40001,OK\nB,40002,!OK\nC,40003,WORD & 0x0C = 0x04\nD,40004,WORD&3\nE,40005,!WORD&3=1\nOK,00001,\nWORD,40006,\n");
    plant_case_assert_loaded(c, 0);
    const struct plant_tag *t = c->plant->tags;
    const struct plant_quality_tag wanted[] = {
        { 5, UINT64_MAX, 0, true }, { 5, UINT64_MAX, 0, false }, { 6, 12, 4, false }, { 6, 3, 0, true }, { 6, 3, 1, true }
    };
    for (int i = 0; i < 5; i++)
        assert_true(t[i].validity.quality.tag == wanted[i].tag && t[i].validity.quality.mask == wanted[i].mask &&
                    t[i].validity.quality.want == wanted[i].want && t[i].validity.quality.negate == wanted[i].negate);
    assert_true(t[5].validity.quality.mask == 0);
    plant_case_load(c, yaml,
                    "Tag Name,Address,Quality Tag\n"
                    "TI-1,40001,TI-1\nB,40002,TI-11\nC,40003,B&\nD,40004,B&0\nE,40005,B&2=1\nF,40006,!\nG,40007,B&1=1x\nH,40008,B\n");
    FOUND(c, { "tags.csv", 2, 12, "Quality Tag: expected a tag other than 'TI-1' itself" },
          { "tags.csv", 3, 9, "Quality Tag: unknown tag 'TI-11'; did you mean 'TI-1'?" },
          { "tags.csv", 4, 9, "expected TAG, !TAG, TAG&MASK" }, { "tags.csv", 5, 9, "found 'B&0'" }, { "tags.csv", 6, 9, "found 'B&2=1'" },
          { "tags.csv", 7, 9, "found '!'" }, { "tags.csv", 8, 9, "found 'B&1=1x'" },
          { "tags.csv", 9, 9, "Quality Tag: 'B' has a quality tag of its own" });
}

CASE(directions_are_tags)
{
    static const char header[] = "Tag Name,Address,Group,Asset,X,Y,Z,Place,Direction\n";
    char *good = test_printf("%sU,40001,temp,E-101,0,0,0,,A B  C\nV,40002,temp,E-101,1,0,0,,D\nW,40003,temp,E-101,1,0,0,,\n"
                            "A,40004,,,,,,,\nB,40005,,,,,,,\nC,40006,,,,,,,\nD,40007,,,,,,,\n", header);
    plant_case_load(c, yaml, good);
    plant_case_assert_loaded(c, 0);
    const struct plant_tag *t = c->plant->tags;
    assert_true(t[0].direction.count == 3 && t[0].direction.tags[0] == 3 && t[0].direction.tags[1] == 4 && t[0].direction.tags[2] == 5);
    assert_true(t[1].direction.count == 1 && t[1].direction.tags[0] == 6 && t[2].direction.count == 0);
    assert_true(c->plant->groups[plant_find_group(c->plant, "temp")].directed);
    char *bad = test_printf("%sU,40001,temp,E-101,0,0,0,,A A\nV,40002,temp,E-101,1,0,0,,V\nW,40003,temp,E-101,1,0,0,,AA\n"
                           "A,40004,,,,,,,W\nB,40005,temp,E-101,,,,equipment,W\n", header);
    plant_case_load(c, yaml, bad);
    FOUND(c,
          { "tags.csv", 2, 27, "Direction: expected one tag (a bearing in degrees) or three tags (the components along X, Y and Z)" },
          { "tags.csv", 3, 27, "Direction: expected tags other than 'V' itself" },
          { "tags.csv", 4, 27, "Direction: unknown tag 'AA'" },
          { "tags.csv", 5, 15, "Direction: 'A' needs a group, an asset and a position (X, Y, Z or Node)" },
          { "tags.csv", 6, 33, "Direction: 'B' needs a group, an asset and a position" });
}

CASE(references_are_looked_up)
{
    plant_case_load(c, yaml_two_sources,
                    "Tag Name,Address,Source,Group,Asset,Node\n"
                    "A,40001,plc3,tmp,E-103,N\n"
                    "B,40001,,,Vessel,\n"
                    "C,40001,plc2,temp,E-101,N\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 9, "Source: unknown source 'plc3'; did you mean 'plc1'?" },
          { "tags.csv", 2, 14, "Group: unknown group 'tmp'; did you mean 'temp'?" },
          { "tags.csv", 2, 18, "Asset: unknown asset 'E-103'; did you mean 'E-101'?" },
          { "tags.csv", 3, 9, "Source: expected the id of one of the 2 sources" },
          { "tags.csv", 3, 11, "Asset: unknown asset 'Vessel'; the plant file has no such id" });
}

CASE(addresses_and_types_are_checked)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Data Type\n"
                    "A,4x1,Word\n"
                    "B,,Word\n"
                    "C,40001,String\n"
                    "D,40001,Flot\n"
                    "E,40001,Boolean\n"
                    "F,00001,Word\n"
                    "G,40001.3,Short\n"
                    "H,465536,Long\n"
                    "I,hr:65533,Double\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 3, "Address: '4x1': this Modbus address has 1 digit; expected 5 or 6 such as 40001 or 400001" },
          { "tags.csv", 3, 3, "Address: expected the address of a register, such as 400001 or hr:0" },
          { "tags.csv", 4, 9, "Data Type: unknown type 'String'; expected one of: bool, int16" },
          { "tags.csv", 5, 9, "Data Type: unknown type 'Flot'; did you mean 'float'?" },
          { "tags.csv", 6, 3, "Address: expected a bit such as 40001.0, because the type is Boolean" },
          { "tags.csv", 7, 9, "Data Type: expected Boolean, because '00001' is a single bit, found 'Word'" },
          { "tags.csv", 8, 11, "Data Type: expected Boolean, because '40001.3' is a single bit, found 'Short'" },
          { "tags.csv", 9, 3, "int32 needs 2 registers, but the last register is 65535" },
          { "tags.csv", 10, 3, "float64 needs 4 registers" });
    plant_case_load(c, yaml, "Tag Name,Data Type\nA,Word\n");
    FOUND(c, { "tags.csv", 1, 1, "the header of the tag list has no column 'Address'" });
    /* the plant file has no sources, so tags need no address: their values arrive by other means */
    plant_case_load(c, yaml_no_source, "Tag Name\nA\n");
    plant_case_assert_loaded(c, 0);
    assert_int_equal(c->plant->tags[0].source, -1);
}

CASE(places_are_whole)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Group,Asset,Node,X,Y,Z\n"
                    "A,40001,temp,E-101,,,,\n"
                    "B,40001,temp,E-101,,1,,3\n"
                    "C,40001,temp,E-101,,1,nan,3\n"
                    "D,40001,temp,E-101,,1,2,abc\n"
                    "E,40001,temp,E-101,,1,2,\"3,5\"\n"
                    "F,40001,temp,E-101,,1,2,2e7\n"
                    "G,40001,temp,E-101,N,1,2,3\n"
                    "H,40001,temp,,,,,\n"
                    "I,40001,,E-101,,,,\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 20, "'A' has a group and an asset but no place: expected Node, or X, Y and Z, or Place: equipment" },
          { "tags.csv", 3, 23, "Y: expected a number, because a position needs X, Y and Z" },
          { "tags.csv", 4, 23, "Y: expected a finite number, found 'nan'" }, { "tags.csv", 5, 25, "Z: expected a number, found 'abc'" },
          { "tags.csv", 6, 25, "Z: expected a number with a decimal point, found '3,5'" },
          { "tags.csv", 7, 25, "Z: expected a number from -10000000 to 10000000, found '2e7'" },
          { "tags.csv", 8, 20, "Node has no effect, because X, Y, Z are given" },
          { "tags.csv", 9, 14, "'H' has a group but no asset, so no field uses it" });
    plant_case_load(c, yaml, "Tag Name,Address,Group,Asset\nA,40001,temp,E-101\n");
    FOUND(c, { "tags.csv", 2, 14, "'A' has a group and an asset but no place" });
}

CASE(scaling_is_whole)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Negate Value,Clamp Low\n"
                    "A,40001,Cubic,0,1,0,1,,\n"
                    "B,40001,Linear,0,1,5,5,,\n"
                    "C,40001,Linear,2,1,0,1,,\n"
                    "D,40001,Square Root,,1,0,inf,,\n"
                    "E,40001,linear,0,1,0,1,maybe,\n"
                    "F,40001,,0,1,0,1,,1\n"
                    "G,40001,,,,,100,,\n"
                    "H,40001,,,,low,,,\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 9, "Scaling: expected None, Linear or Square Root, found 'Cubic'" },
          { "tags.csv", 3, 20, "Scaled Low: expected less than Scaled High, which is 5, found 5" },
          { "tags.csv", 4, 16, "Raw Low: expected less than Raw High, which is 1, found 2" },
          { "tags.csv", 5, 21, "Raw Low: expected a number, because Scaling is Square Root" },
          { "tags.csv", 5, 26, "Scaled High: expected a finite number, found 'inf'" },
          { "tags.csv", 6, 24, "Negate Value: expected 0 or 1, found 'maybe'" },
          { "tags.csv", 7, 10, "Scaling is blank, so the raw range has no effect" }, { "tags.csv", 7, 19, "Clamp Low has no effect" },
          { "tags.csv", 8, 12, "Scaled Low: expected a number, because Scaled High is given" },
          { "tags.csv", 9, 12, "Scaled Low: expected a number, found 'low'" });
}

CASE(numbers_have_ranges_and_limits_rise)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Group,Asset,Node,Scan Rate,Stale s,Strength,LL,L,H,HH\n"
                    "A,40001,temp,E-101,N,5,,,,,,\n"
                    "B,40001,temp,E-101,N,,0,-1,,,,\n"
                    "C,40001,temp,E-101,N,,,,50,40,,\n"
                    "D,40001,temp,E-101,N,,,,20,,,\n"
                    "E,40001,temp,E-101,N,,,,,,,80\n"
                    "F,40001,temp,E-101,N,,,,,,hot,\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 22, "Scan Rate: expected a number from 10 to 86400000, found '5'" },
          { "tags.csv", 3, 23, "Stale s: expected a number from 0.001" },
          { "tags.csv", 3, 25, "Strength: expected a number from 0 to 100" },
          { "tags.csv", 4, 28, "LL is 50, but L is 40; expected LL < L < H < HH" },
          { "tags.csv", 5, 25, "LL is 20, but L of the group is 10; expected" },
          { "tags.csv", 6, 28, "H of the group is 90, but HH is 80; expected" },
          { "tags.csv", 7, 27, "H: expected a number, found 'hot'" });
}

CASE(none_drops_a_limit_of_the_group)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Group,Asset,Node,L,H,HH\n"
                    "A,40001,temp,E-101,N,,none,80\n"
                    "B,40001,temp,E-101,N,None,,\n");
    assert_non_null(c->plant);
    const double *a = c->plant->tags[0].alarms.limits, *b = c->plant->tags[1].alarms.limits;
    assert_true(a[LIMIT_L] == 10 && isnan(a[LIMIT_H]) && a[LIMIT_HH] == 80);
    assert_true(isnan(b[LIMIT_L]) && b[LIMIT_H] == 90);
}

CASE(names_are_unique)
{
    plant_case_load(c, yaml, "Address,Tag Name\n40001,A\n40002,B\n40003,A\n40004,\n40005,A\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 4, 7, "Tag Name: 'A' is listed twice (first at line 2)" },
          { "tags.csv", 5, 7, "Tag Name: expected a name, found none" },
          { "tags.csv", 6, 7, "Tag Name: 'A' is listed twice (first at line 2)" });
    plant_case_load(c, yaml, "Name,Address\nA,40001\n");
    FOUND(c, { "tags.csv", 1, 1, "the header of the tag list has no column 'Tag Name'" },
          { "tags.csv", 1, 1, "unknown column 'Name' is ignored" });
}

/* Warnings for values that share registers: a float that begins one register too early, 16-bit values within larger ones, and
   an address with the source's own unit (1!hr:51), which means the same device. No warnings for equal addresses, bits, other
   tables and other units. */
CASE(values_that_share_some_registers_are_noticed)
{
    plant_case_load(c, yaml, "Tag Name,Address,Data Type\nA,hr:10,Float\nB,hr:11,Float\nC,hr:20,Float\nD,hr:21,Int16\n"
                             "E,hr:30,Float\nF,hr:30,Float\nG,hr:30,Int32\nH,hr:31.3,\nI,ir:31,Int16\nJ,hr:32,Float\n"
                             "K,hr:40,Double\nL,hr:41,Int16\nM,hr:43,Int16\nN,hr:50,Float\nO,1!hr:51,Int16\nP,2!hr:51,Int16\n");
    plant_case_assert_loaded(c, 5);
    FOUND(c,
          { "tags.csv", 3, 1, "Address: 'B' (float32) shares a register with 'A' (float32, line 2): check both addresses and data types" },
          { "tags.csv", 5, 1, "Address: 'D' (int16) shares a register with 'C' (float32, line 4): check both addresses and data types" },
          { "tags.csv", 13, 1, "Address: 'L' (int16) shares a register with 'K' (float64, line 12): check both addresses and data types" },
          { "tags.csv", 14, 1, "Address: 'M' (int16) shares a register with 'K' (float64, line 12): check both addresses and data types" },
          { "tags.csv", 16, 1, "Address: 'O' (int16) shares a register with 'N' (float32, line 15): check both addresses and data types" });
}

/* Warns if a reading becomes stale before the next one can arrive: the source reads each tag every second, or as often as the
   tag's Scan Rate (ms) says. */
CASE(readings_that_are_stale_before_the_next_are_noticed)
{
    plant_case_load(c, yaml_no_order,
                    "Tag Name,Address,Scan Rate,Stale s\nA,hr:1,,0.5\nB,hr:2,,1.5\nC,hr:3,5000,5\nD,hr:4,100,0.5\nE,= [A],,0.5\n");
    plant_case_assert_loaded(c, 2);
    FOUND(c, { "tags.csv", 2, 9, "Stale s: 'A' is read every 1 s, so each reading is stale before the next one arrives; write at least 3" },
          { "tags.csv", 4, 13, "Stale s: 'C' is read every 5 s, so each reading is stale before the next one arrives; write at least 15" });
}

CASE(columns_are_known)
{
    plant_case_load(c, yaml,
                    "Tag Name,Adress,Address,Sim Kind,,Colour,On Delay s,Eng Units\n"
                    "A,x,40001,ramp,,red,60,bar\n"
                    "B,x,40001,ramp,,red,60,\n");
    plant_case_assert_loaded(c, 3);
    FOUND(c, { "tags.csv", 1, 10, "unknown column 'Adress' is ignored; did you mean 'Address'?" },
          { "tags.csv", 1, 34, "a column without a name is ignored" }, { "tags.csv", 1, 35, "unknown column 'Colour' is ignored" });
    plant_case_load(c, yaml, "Tag Name,Address,Eng Units,Engineering Units\n");
    FOUND(c, { "tags.csv", 1, 28, "column 'Engineering Units' means the same as 'Eng Units' at column 18" });
    plant_case_load(c, yaml, "Tag Name,Address,Priority,Deadband\nA,40001,high,-1\n");
    FOUND(c, { "tags.csv", 2, 9, "Priority: expected a number, found 'high'" },
          { "tags.csv", 2, 14, "Deadband: expected a number from 0" });
}

CASE(alarms_are_of_the_tag_else_of_the_group)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Alarm Deadband,On Delay s,Off Delay s,Priority,Latch,Suppressed By\n"
                    "A,40001,1.5,2,3,1,yes,STOP\n"
                    "B,40002,,,,,,\n"
                    "STOP,10001,,,,,,\n");
    plant_case_assert_loaded(c, 0);
    const struct plant_alarm_settings *a = &c->plant->tags[0].alarms.settings, *b = &c->plant->tags[1].alarms.settings;
    assert_true(a->deadband == 1.5 && a->on_delay_s == 2 && a->off_delay_s == 3 && a->priority == 1 && a->latch);
    assert_int_equal(c->plant->tags[0].alarms.suppressed_by, 2);
    assert_true(b->deadband == 0 && b->on_delay_s == 0 && b->priority == ALARM_PRIORITY_DEFAULT && !b->latch);
    assert_int_equal(c->plant->tags[1].alarms.suppressed_by, -1);
    assert_int_equal(c->plant->alarms, ALARMS_DISPLAY);
    plant_case_load(c, yaml,
                    "Tag Name,Address,Priority,Suppressed By,Mirrors\n"
                    "A,40001,2.5,NONE,\n"
                    "B,40002,9,A,\n"
                    "C,10001,,,A HH\n");
    FOUND(c, { "tags.csv", 2, 9, "Priority: expected a whole number" }, { "tags.csv", 2, 13, "Suppressed By: there is no tag 'NONE'" },
          { "tags.csv", 3, 9, "Priority: expected a number from 1 to 4" }, { "tags.csv", 3, 11, "Suppressed By: 'A' is not a Boolean" },
          { "tags.csv", 4, 11, "Mirrors has no effect" });
}

CASE(bits_mirror_alarms)
{
    char *mirror = test_printf("%s\nalarms: mirror\n", yaml);
    plant_case_load(c, mirror,
                    "Tag Name,Address,Mirrors\n"
                    "TT 101,40001,\n"
                    "A1,10001,TT 101 HH\n"
                    "A2,10002,TT 101 hh Acknowledged\n"
                    "A3,10003,A3 ALM\n");
    plant_case_assert_loaded(c, 0);
    const struct plant_mirror *one = &c->plant->tags[1].alarms.mirror, *two = &c->plant->tags[2].alarms.mirror,
                              *three = &c->plant->tags[3].alarms.mirror;
    assert_true(one->tag == 0 && one->limit == LIMIT_HH && !one->acknowledged);
    assert_true(two->tag == 0 && two->limit == LIMIT_HH && two->acknowledged);
    assert_true(three->tag == 3 && three->limit == LIMIT_COUNT && c->plant->tags[0].alarms.mirror.tag == -1);
    plant_case_load(c, mirror,
                    "Tag Name,Address,Mirrors\n"
                    "TT,40001,TT H\n"
                    "A1,10001,TT\n"
                    "A2,10002,TI HH\n"
                    "A3,10003,TT LL\n"
                    "A4,10004,TT LL\n");
    FOUND(c, { "tags.csv", 2, 10, "Mirrors: 'TT' is not a Boolean" }, { "tags.csv", 3, 10, "Mirrors: expected a tag and LL" },
          { "tags.csv", 4, 10, "Mirrors: there is no tag 'TI'" }, { "tags.csv", 6, 10, "'TT LL' is already mirrored at line 5" });
}

CASE(units_agree_with_the_group)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Group,Asset,Node,Eng Units\n"
                    "A,40001,temp,E-101,N,degC\n"
                    "B,40001,temp,E-101,N,C\n"
                    "C,40001,temp,E-101,N,°c\n"
                    "D,40001,temp,E-101,N,°F\n"
                    "E,40001,temp,E-101,N,\n");
    /* this list is accepted; conversions of units, and units that are refused, are tested in units_test */
    plant_case_assert_loaded(c, 0);
}

/* A plant file without valid groups gives one error, not one per row. */
CASE(a_broken_plant_file_does_not_flood)
{
    plant_case_load(c,
                    "plant: { name: P }\nassets: [{ id: A, model: m.glb }]\ngroups: 5\nsources: [{ id: s, type: modbus, host: h }]\n"
                    "tags: tags.csv\n",
                    "Tag Name,Address,Group,Asset,Node\nT,40001,g,A,N\nU,40001,g,A,N\n");
    FOUND(c, { "plant.yaml", 3, 9, "groups: expected a list" });
}

CASE(long_lists_are_read)
{
    struct text *csv = test_text();
    text_add(csv, "Tag Name,Address,Data Type,Group,Asset,X,Y,Z\n");
    for (int i = 0; i < 20000; i++)
        text_add(csv, "TT-%05d,hr:%d,Float,temp,E-101,%d,2,3\n", i, i * 2, i % 100);
    plant_case_load(c, yaml, csv->at);
    plant_case_assert_loaded(c, 0);
    assert_int_equal(c->plant->tag_count, 20000);
}
