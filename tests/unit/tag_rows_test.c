/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows that `plantcast match` adds to the tag list (data types, scaling, ranges, alarm limits), and the names of tags whose values it
   leaves out. */
#include "preprocess/match/tag_rows.h"

#include "tests/support/test.h"

#include "preprocess/match/tag_export.h"

static char *folder;

struct rows_run {
    struct tag_rows rows;
    struct text list; /* the tag list after the run */
};

/* Adds the tags of an export to a tag list (NULL: a plant without one). */
static void put(struct rows_run *run, const char *tags, const char *export, const struct tag_source *source)
{
    char why[300], *path = tags ? temp_write(folder, "tags.csv", tags, strlen(tags)) : test_printf("%s/none.csv", folder);
    struct tag_export list = { 0 };
    *run = (struct rows_run){ 0 };
    if (!tag_export_read(&list, temp_write(folder, "export", export, strlen(export)), NULL, why, sizeof(why)) ||
        !tag_rows_read(&run->rows, path, why))
        fail_msg("%s", why);
    for (size_t i = 0; i < list.count; i++)
        tag_rows_put(&run->rows, &(struct tag_row_input){ .tag = &list.tags[i],
                                                          .match = &(struct match){ .asset = -1 },
                                                          .place = &(struct place_proposal){ .node = -1 },
                                                          .group = "",
                                                          .source = source });
    tag_rows_write(&run->rows, &run->list);
    tag_export_finish(&list);
}

static void finish(struct rows_run *run)
{
    tag_rows_finish(&run->rows);
    text_finish(&run->list);
}

/* Returns a cell of the list that the run has written; "" if the list has no such column or tag. */
static const char *cell_of(const struct rows_run *run, const char *tag, const char *column)
{
    const struct tag_rows *rows = &run->rows;
    for (size_t c = 0; c < rows->at[0].count; c++)
        for (size_t i = 1; i < rows->count && !strcmp(rows->at[0].cells[c], column); i++)
            if (!strcmp(table_cell(&rows->at[i], 0), tag))
                return table_cell(&rows->at[i], (int)c);
    return "";
}

static void expect_names(const char *kind, const struct tag_names *names, const char *want)
{
    const char *found = names->count > 0 ? names->names.at : "";
    if (strcmp(found, want) != 0)
        fail_msg("%s: '%s', expected '%s'", kind, found, want);
}

static void expect_cell(const char *kind, const struct rows_run *run, const char *column, const char *want)
{
    const char *found = cell_of(run, "T", column);
    if (strcmp(found, want) != 0)
        fail_msg("%s, %s: '%s', expected '%s'", kind, column, found, want);
}

static const struct tag_source modbus = { "plc", true, 1 }, opcua = { "dcs", false, 1 };

/* A scale is taken over exactly, or left out and named; raw values must never pass for engineering values without a word. */
TEST(test_scaling)
{
    static const struct {
        const char *kind, *row; /* row: Scaling, Raw Low, Raw High, Scaled Low, Scaled High, Negate Value */
        const char *scaling, *raw_low, *raw_high, *low, *high, *negate, *left_out;
    } cases[] = {
        { "linear", "Linear,0,4095,0,150,0", "Linear", "0", "4095", "0", "150", "", "" },
        { "square root", "Square Root,0,4095,0,150,", "Square Root", "0", "4095", "0", "150", "", "" },
        { "negated", "None,,,,,1", "", "", "", "", "", "1", "" },
        { "falling", "Linear,0,4095,100,0,0", "Linear", "0", "4095", "-100", "0", "1", "" },
        { "falling and negated", "Linear,0,4095,100,-20.5,1", "Linear", "0", "4095", "-100", "20.5", "", "" },
        { "raw values falling", "Linear,4095,0,100,0,", "Linear", "0", "4095", "0", "100", "", "" },
        { "raw values falling, scale rising", "Linear,4095,0,0,100,", "Linear", "0", "4095", "-100", "0", "1", "" },
        { "root of falling raw values", "Square Root,4095,0,0,100,", "", "", "", "0", "100", "", "T (Raw Low is above Raw High)" },
        { "a bound missing", "Linear,,4095,0,150,", "", "", "", "0", "150", "", "T (no Raw Low)" },
        { "a bound with a unit", "Linear,4 mA,20,0,150,", "", "", "", "0", "150", "", "T (no Raw Low)" },
        { "bounds equal", "Linear,0,0,0,150,", "", "", "", "0", "150", "", "T (Raw Low equals Raw High)" },
        { "scaled bounds equal", "Linear,0,10,5,5,", "", "", "", "", "", "", "T (Scaled Low equals Scaled High)" },
        { "another kind", "Polynomial,0,4095,0,150,", "", "", "", "0", "150", "", "T (Scaling 'Polynomial')" },
        { "none stated", ",0,4095,0,150,", "", "", "", "0", "150", "", "T (the export has a raw range, but does not state Scaling)" },
        { "none", "None,0,4095,0,150,", "", "", "", "0", "150", "", "" },
        { "a falling range without scaling", "None,,,150,0,", "", "", "", "0", "150", "", "" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct rows_run run;
        put(&run, NULL,
            test_printf("Tag Name,Address,Data Type,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Negate Value\nT,400001,Word,%s\n",
                        cases[i].row),
            &modbus);
        static const char *const columns[] = { "Scaling", "Raw Low", "Raw High", "Scaled Low", "Scaled High", "Negate Value" };
        const char *const want[] = { cases[i].scaling, cases[i].raw_low, cases[i].raw_high, cases[i].low, cases[i].high, cases[i].negate };
        for (size_t c = 0; c < sizeof(columns) / sizeof(*columns); c++)
            expect_cell(cases[i].kind, &run, columns[c], want[c]);
        expect_names(cases[i].kind, &run.rows.scalings, cases[i].left_out);
        finish(&run);
    }
}

TEST(test_long_names_are_named_whole)
{
    struct rows_run run;
    put(&run, NULL, test_printf("Tag Name,Address,Data Type\n%0150d/TIC101,400001,F99\n", 0), &modbus);
    expect_names("types", &run.rows.types, test_printf("%0150d/TIC101 (F99)", 0));
    finish(&run);
}

TEST(test_ranges_with_one_end_are_named)
{
    struct rows_run run;
    put(&run, NULL, "Tag Name,Scaled Low,Scaled High\nA,0,100\nB,,100\nC,0,\n", &(struct tag_source){ 0 });
    assert_string_equal(run.list.at,
                        "Tag Name,Address,Data Type,Scaled Low,Scaled High,Eng Units,Description,Source,Group,Asset,Place,Node,X,Y,Z\n"
                        "A,,,0,100,,,,,,,,,,\nB,,,,,,,,,,,,,,\nC,,,,,,,,,,,,,,\n");
    expect_names("ranges", &run.rows.ranges, "B (no Scaled Low), C (no Scaled High)");
    finish(&run);
}

/* Names of data types in exports: the type in the tag list, or NULL if the tag is left out and named. */
TEST(test_types)
{
    static const struct {
        const char *address, *type, *want;
    } cases[] = {
        { "400001", "", "" },
        { "400001", "Default", "" },
        { "400001", "Float", "Float" },
        { "400001", "Single", "Float" },
        { "400001", "F32", "Float" },
        { "400001", "32-bit float", "Float" },
        { "400001", "Floating-point number 32-bit IEEE 754", "Float" },
        { "400001", "Gleitkommazahl 64-Bit IEEE 754", "Double" },
        { "400001", "Unsigned 16-bit value", "Word" },
        { "400001", "Signed 32-bit value", "Long" },
        { "400001", "UDINT", "DWord" },
        { "400001", "ULInt", "QWord" },
        { "400001.3", "Binary Tag", "Boolean" },
        { "000001", "Bool", "Boolean" },
        { "000001", "Word", "" }, /* a coil has one bit, whatever its type in the export */
        { "000001", "Digital", "Boolean" },
        { "100005", "EBOOL", "Boolean" },
        { "400001.3", "DI", "Boolean" },
        { "400001", "DO", NULL },
        { "000001", "F99", "" },
        { "400001.3", "F99", "" },
        { "400001", "Boolean", NULL },
        { "400001", "Float Array", NULL },
        { "400001", "Signed 8-bit value", NULL },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct rows_run run;
        put(&run, NULL, test_printf("Tag Name,Address,Data Type\nT,%s,%s\n", cases[i].address, cases[i].type), &modbus);
        assert_int_equal(run.rows.count, cases[i].want ? 2 : 1);
        assert_int_equal(run.rows.types.count, cases[i].want ? 0 : 1);
        if (cases[i].want)
            expect_cell(cases[i].type, &run, "Data Type", cases[i].want);
        finish(&run);
    }
    struct rows_run run;
    put(&run, NULL, "Tag Name,Address,Data Type\nA,400001,F99\nB,400003,Boolean\nC,400005,String[80]\n", &modbus);
    expect_names("types", &run.rows.types, "A (F99), B (Boolean at 400003, not at a bit such as 400003.0)");
    finish(&run);
    put(&run, NULL, "Tag Name,Address,Data Type\nA,ns=2;s=A,F99\nB,ns=2;s=B,Boolean\nC,ns=2;s=C,Real\n", &opcua);
    assert_string_equal(cell_of(&run, "A", "Data Type"), ""); /* the server states the type */
    assert_string_equal(cell_of(&run, "B", "Data Type"), "Boolean");
    assert_string_equal(cell_of(&run, "C", "Data Type"), "Float");
    assert_int_equal(run.rows.types.count, 0);
    finish(&run);
}

/* The item of an InTouch tag states how many registers its value has. The section (IOReal, IOInt) is only InTouch's own type. */
TEST(test_intouch_items)
{
    static const struct {
        const char *section, *item, *address, *type; /* type: NULL: the tag is left out */
    } cases[] = {
        { "IOReal", "40001", "40001", "Word" },    { "IOInt", "300001", "300001", "Word" },    { "IOReal", "40001 F", "40001", "Float" },
        { "IOInt", "40001 f", "40001", "Float" },  { "IOReal", "400001 L", "400001", "Long" }, { "IOReal", "40001 I", "40001", "Long" },
        { "IOReal", "40001 S", "40001", "Short" }, { "IOInt", "40001 U", "40001", "DWord" },   { "IOInt", "10001", "10001", "" },
        { "IOReal", "40001.3", "40001.3", "" },    { "IODisc", "10001", "10001", "Boolean" },  { "IOReal", "40001 LF", "40001", NULL },
        { "IODisc", "40001", "40001", NULL },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct rows_run run;
        put(&run, NULL,
            test_printf(":mode=ask\n:%s,Group,Comment,ItemName\n\"T\",\"$System\",\"\",\"%s\"\n", cases[i].section, cases[i].item),
            &modbus);
        if (cases[i].type) {
            expect_cell(cases[i].item, &run, "Address", cases[i].address);
            expect_cell(cases[i].item, &run, "Data Type", cases[i].type);
        }
        assert_int_equal(run.rows.types.count, cases[i].type ? 0 : 1);
        if (!strcmp(cases[i].item, "40001 LF"))
            expect_names("types", &run.rows.types, "T (40001 LF)");
        finish(&run);
    }
}

TEST(test_limits)
{
    struct rows_run run;
    put(&run, NULL, "Tag Name,LL,L,H,HH\nA,,,90,110\nB,0,0,200,250\nC,10,,5,\nD,9,10,100,101\n", &(struct tag_source){ 0 });
    assert_string_equal(cell_of(&run, "A", "H"), "90");
    assert_string_equal(cell_of(&run, "B", "H"), "");
    assert_string_equal(cell_of(&run, "C", "LL"), "");
    assert_string_equal(cell_of(&run, "D", "L"), "10"); /* 9 is less than 10, though not as text */
    expect_names("limits", &run.rows.limits, "B (LL 0, L 0), C (LL 10, H 5)");
    finish(&run);
}

#define HEADER "Tag Name,Address,Data Type,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Negate Value,Eng Units,LL,L,H,HH\n"

/* An existing row keeps its values; a tag is named if the export states others. */
TEST(test_differing)
{
    static const struct {
        const char *kind, *ours, *theirs, *named;
    } cases[] = {
        { "the same", "T,400001,Float,Linear,0,4095,0,150,,degC,,,90,", "T,400001,Float,Linear,0,4095,0,150,0,degC,,,90,", "" },
        { "written otherwise", "T,hr:0,float32,linear,0.0,4095,0,150,0,°C,,,90.0,", "T,400001,Real,Linear,0,4095,0,150,,degC,,,90,", "" },
        { "blank in the export", "T,400001,Float,Linear,0,4095,0,150,1,degC,,,90,", "T,400001,,,,,,,,,,,,", "" },
        { "Word by default", "T,400001,,,,,,,,,,,,", "T,400001,Word,None,,,,,0,,,,,", "" },
        { "address", "T,400001,Float,,,,,,,,,,,", "T,400007,Float,,,,,,,,,,,", "T (Address 400001, in the export 400007)" },
        { "type", "T,400001,Word,,,,,,,,,,,", "T,400001,Float,,,,,,,,,,,", "T (Data Type Word, in the export Float)" },
        { "raw range", "T,400001,Word,Linear,0,4095,0,150,,,,,,", "T,400001,Word,Linear,0,27648,0,150,,,,,,",
          "T (Raw High 4095, in the export 27648)" },
        { "no scaling any more", "T,400001,Word,Linear,0,4095,0,150,,,,,,", "T,400001,Word,None,,,,,,,,,,",
          "T (Scaling Linear, in the export None)" },
        { "scaling that cannot be used", "T,400001,Word,Linear,0,4095,0,150,,,,,,", "T,400001,Word,Linear,,4095,0,150,,,,,,", "" },
        { "sign", "T,400001,Word,,,,,,,,,,,", "T,400001,Word,,,,,,1,,,,,", "T (Negate Value blank, in the export 1)" },
        { "sign taken away", "T,400001,Word,,,,,,1,,,,,", "T,400001,Word,,,,,,0,,,,,", "T (Negate Value 1, in the export 0)" },
        { "unit", "T,400001,Word,,,,,,,bar,,,,", "T,400001,Word,,,,,,,psi,,,,", "T (Eng Units bar, in the export psi)" },
        { "prefix of a unit", "T,400001,Word,,,,,,,mW,,,,", "T,400001,Word,,,,,,,MW,,,,", "T (Eng Units mW, in the export MW)" },
        { "capitals of a unit", "T,400001,Word,,,,,,,BAR,,,,", "T,400001,Word,,,,,,,bar,,,,", "" },
        { "an unknown type", "T,400001,,,,,,,,,,,,", "T,400001,F99,,,,,,,,,,,", "T (Data Type blank, in the export F99)" },
        { "a bit in a whole register", "T,400001,,,,,,,,,,,,", "T,400001,Bool,,,,,,,,,,,", "T (Data Type blank, in the export Bool)" },
        { "an unknown type and a limit", "T,400001,,,,,,,,,,,9,", "T,400001,F99,,,,,,,,,,8,", "T (H 9, in the export 8)" },
        { "limit", "T,400001,Word,,,,,,,,,,90,", "T,400001,Word,,,,,,,,,,95,", "T (H 90, in the export 95)" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct rows_run run;
        char *before = test_printf(HEADER "%s\n", cases[i].ours);
        put(&run, before, test_printf(HEADER "%s\n", cases[i].theirs), &modbus);
        expect_names(cases[i].kind, &run.rows.differing, cases[i].named);
        assert_string_equal(run.list.at, before);
        finish(&run);
    }
}

TEST(test_types_that_the_server_states_do_not_differ)
{
    struct rows_run run;
    put(&run, HEADER "T,ns=2;s=T,,,,,,,,,,,,\n", HEADER "T,ns=2;s=T,Boolean,,,,,,,,,,,\n", &opcua);
    expect_names("differing", &run.rows.differing, "");
    finish(&run);
}

/* Every run names the tags that still show raw values or lack range and limits, until somebody fills in their cells. */
TEST(test_unusable_values_are_named_again)
{
    struct rows_run run;
    const char *export =
        HEADER "A,400001,Word,Polynomial,0,4095,0,150,,,,,,\nB,400002,Word,None,,,,150,,,10,,5,\nC,400003,Word,,,,,,,,,,,\n"
               "D,400004,Word,Polynomial,0,4095,0,150,,,,,,\n";
    put(&run, HEADER "A,400001,Word,,,,0,150,,,,,,\nB,400002,Word,,,,,,,,,,,\nC,400003,Word,,,,,,,,,,,\nD,400004,Word,,,,0,150,,,,,,\n",
        export, &modbus);
    expect_names("scalings", &run.rows.scalings, "A (Scaling 'Polynomial'), D (Scaling 'Polynomial')");
    expect_names("ranges", &run.rows.ranges, "B (no Scaled Low)");
    expect_names("limits", &run.rows.limits, "B (LL 10, H 5)");
    assert_int_equal(run.rows.scalings.count, 2);
    finish(&run);
    put(&run,
        HEADER
        "A,400001,Word,None,,,0,150,,,,,,\nB,400002,Word,,,,0,150,,,,,4,\nC,400003,Word,,,,,,,,,,,\nD,400004,Word,None,,,0,150,,,,,,\n",
        export, &modbus);
    expect_names("scalings", &run.rows.scalings, "");
    expect_names("ranges", &run.rows.ranges, "");
    expect_names("limits", &run.rows.limits, "");
    finish(&run);
}

static int set_up(void **state)
{
    (void)state;
    folder = temp_folder();
    return 0;
}

TEST_GROUP(set_up, NULL)
