/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matching of tags to equipment: each matching rule, parsing of names, and edits to plant files that keep their formatting. */
#include "preprocess/match/matcher.h"

#include "tests/support/test.h"

#include "preprocess/match/isa.h"
#include "preprocess/match/plant_edit.h"
#include "preprocess/match/quantities.h"

static const char model[] = "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
                            "{\"name\":\"plant\",\"children\":[1,2,3,4,5,6,7,8]},{\"name\":\"/"
                            "E-101\",\"children\":[9,10]},{\"name\":\"P-101\"},{\"name\":\"P-205A\"},"
                            "{\"name\":\"P-205B\"},{\"name\":\"-ART1105BA-\"},{\"name\":\"/"
                            "20-V-330\"},{\"name\":\"StorageTank\"},{\"name\":\"M_Radiator:25:583216\"},"
                            "{\"name\":\"TT-1011\"},{\"name\":\"/E-101/N1\",\"extras\":{\"Tag\":\"10-FT-7788\"}}]}";
static const char plant_text[] =
    "plant: { name: P }\nassets:\n- { id: E-101, description: Feed preheater, model: m.gltf, nodes: /E-101 }\n- { id: P-101, model: "
    "m.gltf, nodes: P-101 }\n"
    "- { id: P-205A, model: m.gltf, nodes: P-205A }\n- { id: P-205B, model: m.gltf, nodes: P-205B }\n"
    "- { id: -ART1105BA-, model: m.gltf, nodes: -ART1105BA- }\n- { id: 20-V-330, model: m.gltf, nodes: /20-V-330 }\n"
    "- { id: StorageTank, model: m.gltf, nodes: StorageTank }\n- { id: \"M_Radiator:25:583216\", model: m.gltf, nodes: "
    "\"M_Radiator:25:583216\" }\n"
    "groups: [{ id: g, unit: K, min: 0, max: 1 }]\ntags: tags.csv\n";

struct match_fixture {
    char *folder;
    struct plant *plant;
    struct model_index site;
    struct matcher matcher;
};

static void begin(struct match_fixture *f)
{
    char why[MODEL_INDEX_WHY_BYTES] = "";
    f->folder = temp_folder();
    temp_write_text(f->folder, "m.gltf", model);
    temp_write_text(f->folder, "tags.csv", "Tag Name\n");
    char *path = temp_write_text(f->folder, "plant.yaml", plant_text);
    f->plant = plant_load_or_print(path);
    assert_true(f->plant && model_index_read(&f->site, f->plant, why));
    f->matcher.site = &f->site;
}

static void end(struct match_fixture *f)
{
    matcher_finish(&f->matcher);
    model_index_finish(&f->site);
    plant_destroy(&f->plant);
}

TEST_FIXTURE(struct match_fixture, begin, end)

#define CASE(name) TEST_ON(struct match_fixture *f, name, set_up, tear_down)

/* Matches one tag, with this name and description, to the plant's equipment. Asserts the status, the asset (NULL: none) and
   that the reason given contains `why`. */
static void expect(struct match_fixture *f, const char *name, const char *description, enum match_status status, const char *asset,
                   const char *why)
{
    struct tag_export list = { 0 };
    struct export_tag *tag = tag_export_add(&list, 1);
    export_tag_set(tag, EXPORT_NAME, name);
    export_tag_set(tag, EXPORT_DESCRIPTION, description);
    tag_export_join(&list);
    struct match *match = matcher_run(&f->matcher, &list);
    const char *got = match->asset < 0 ? "none" : f->plant->assets[match->asset].id;
    if (match->status != status || strcmp(got, asset ? asset : "none") != 0 || !strstr(match->reason, why))
        fail_msg("%s: %s, %s, %s", name, match_status_names[match->status], got, match->reason);
    matches_free(match, 1);
    tag_export_finish(&list);
}

CASE(test_by_name)
{
    expect(f, "TT-1011.PV", "", MATCH_SURE, "E-101", "node 'TT-1011' has the tag's name");
    expect(f, "E101_TIC_01", "", MATCH_SURE, "E-101", "the tag's name contains 'E-101'");
    expect(f, "Plant/e_101/PT-7", "", MATCH_SURE, "E-101", "the tag's name contains 'E-101'");
    expect(f, "P-205-A.PV", "", MATCH_SURE, "P-205A", "has the tag's name");
    expect(f, "E-101-B_TT01", "", MATCH_LIKELY, "E-101", "without separators");
    expect(f, "TT_Radiator-583216", "", MATCH_SURE, "M_Radiator:25:583216", "number and other parts");
    expect(f, "ART11O5BA-TT01", "", MATCH_SURE, "-ART1105BA-", "O for 0");
    expect(f, "ARTT1105BA.TT01", "", MATCH_SURE, "-ART1105BA-", "");
    expect(f, "ATR1105BA.PV", "", MATCH_SURE, "-ART1105BA-", "one letter wrong");
    expect(f, "1105BA_LT", "", MATCH_SURE, "-ART1105BA-", "");
}

CASE(test_by_number)
{
    expect(f, "TE-330A", "", MATCH_SURE, "20-V-330", "loop 330: equipment number 330");
    expect(f, "20-LT-3302", "", MATCH_SURE, "20-V-330", "loop 3302: equipment number 330");
    expect(f, "40-LT-330", "", MATCH_LIKELY, "20-V-330", "the tag's area prefix differs from the equipment's");
    expect(f, "PT-205B", "", MATCH_SURE, "P-205B", "");
    expect(f, "PT-205C", "", MATCH_NONE, NULL, "no node of the model");
    expect(f, "PT-205", "", MATCH_NONE, NULL, "P-205A or P-205B");
    expect(f, "TT-101", "", MATCH_NONE, NULL, "E-101 or P-101");
    expect(f, "TT-101", "pump bearing temperature", MATCH_SURE, "P-101", "");
    expect(f, "TT-101", "Outlet of E-101", MATCH_SURE, "E-101", "the description names E-101; loop 101");
    expect(f, "TT-330", "Outlet of E-101", MATCH_LIKELY, "20-V-330", ", but the description names E-101");
    /* ART1705BA is an equipment number that the plant lacks, so the tag matches nothing, although its instrument number 330
       would match 20-V-330 */
    expect(f, "ART1705BA_TT330", "", MATCH_NONE, NULL, "");
}

CASE(test_by_text)
{
    char *path, why[MATCH_WHY_BYTES];
    expect(f, "10-FT-7788", "", MATCH_SURE, "E-101", "an attribute of 'E-101'");
    expect(f, "XT_9", "from P-101 to E-101", MATCH_NONE, NULL, "P-101 or E-101");
    expect(f, "XT_9", "Level of storage tank", MATCH_SURE, "StorageTank", "2 words");
    expect(f, "XT_9", "preheater of feed, shell", MATCH_SURE, "E-101", "2 words");
    expect(f, "PLC1.Heartbeat", "", MATCH_NONE, NULL, "no match: no node of the model has the name, number or words of the tag");
    path = temp_write_text(f->folder, "aliases.csv", "Alias;Equipment\nThe big one;V-330\n");
    assert_false(matcher_read_aliases(&f->matcher, path, why));
    assert_string_equal(why, "line 2: column Equipment: no asset of the plant is called 'V-330'");
    path = temp_write_text(f->folder, "aliases.csv", "Alias;Equipment\nThe big one;20-V-330\n");
    assert_true(matcher_read_aliases(&f->matcher, path, why));
    expect(f, "XT_9", "top of the big one", MATCH_SURE, "20-V-330", "alias 'The big one'");
    path = temp_write_text(f->folder, "rules.csv", "Tag,Equipment\n^XT_([0-9])$,P-20\\1A\n^XT_.*,E-101\n");
    assert_true(matcher_read_rules(&f->matcher, path, why));
    expect(f, "xt_5", "", MATCH_SURE, "P-205A", "rule 1 maps the tag to 'P-205A'");
    expect(f, "XT_77", "", MATCH_SURE, "E-101", "rule 2");
}

TEST(test_isa_names)
{
    static const struct {
        const char *name, *letters, *number, *suffix;
        char variable;
        enum isa_role role;
    } cases[] = {
        { "TE-101A", "TE", "101", "A", 'T', ISA_MEASURED },      { "10-PDT-1012", "PDT", "1012", "", 'd', ISA_MEASURED },
        { "TIC0101.SP", "TIC", "101", "", 'T', ISA_SETTING },    { "LSHH-330", "LSHH", "330", "", 'L', ISA_STATE },
        { "FI101.DACA.PV", "FI", "101", "", 'F', ISA_MEASURED }, { "TAH-101", "TAH", "101", "", 'T', ISA_STATE },
        { "E101_TT_07", "TT", "7", "", 'T', ISA_MEASURED },      { "FV-101", "FV", "101", "", 'F', ISA_SETTING },
        { "P-101.RUN", NULL, NULL, "", 0, ISA_STATE },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct isa_name name;
        isa_read(&name, cases[i].name);
        assert_int_equal(name.letters >= 0, cases[i].letters != NULL);
        if (cases[i].letters) {
            assert_string_equal(name.tokens.at[name.letters].text, cases[i].letters);
            assert_string_equal(name.tokens.at[name.number].text, cases[i].number);
            assert_string_equal(name.suffix, cases[i].suffix);
        }
        assert_int_equal(name.variable, cases[i].variable);
        assert_int_equal(name.role, cases[i].role);
    }
}

/* A tag's quantity is derived from its unit or, in this order, from its description, words in its name, letters in its name. A
   guess that contradicts the unit is dropped. */
TEST(test_quantities)
{
    static const struct {
        const char *name, *unit, *description, *quantity; /* "": none */
    } cases[] = {
        { "P101.TI", "°C", "Bearing", "Temperature" },
        { "P101.TI", "s", "Integral time", "" },
        { "P101.TI", "", "", "" },
        { "P101.TI", "", "Lagertemperatur", "Temperature" },
        { "TIC-101.SP", "°C", "Set point", "" },
        { "P101.PI", "bar", "Discharge", "Pressure" },
        { "TI_PRESS", "bar", "", "Pressure" },
        { "TI-101", "bar", "", "Pressure" },
        { "PI-201", "rpm", "", "Speed" },
        { "TI-101", "", "Discharge pressure", "Pressure" },
        { "XX-1", "%", "Füllstand", "Level" },
        { "XX-1", "℃", "", "Temperature" },
        { "XX-1", "mbar", "Differenzdruck Filter", "Differential pressure" },
        { "PDI-101", "mbar", "", "Differential pressure" },
        { "TI-101", "бар", "Давление на входе", "Pressure" },
        { "TT-101", "", "泵轴承温度", "Temperature" },
        { "XX-1", "", "软化水流量", "Flow" },
        { "XX-1", "", "펌프 압력", "Pressure" },
        { "XX-1", "", "タンク圧力", "Pressure" },
        { "XX-1", "", "Débit eau", "Flow" },
        { "XX-1", "", "Caudal de agua", "Flow" },
        { "XX-1", "", "Saugdruck", "Pressure" },
        { "AI-101", "", "Composition", "Analysis" },
        { "TI-101", "", "Temperatur Druckbehälter, Druck", "Temperature" }, /* two: the letters decide */
        { "TI-101", "", "Entspannungsbehälter", "Temperature" },
        { "P_101/Level", "%", "", "Level" },
        { "FI-101", "m³/h", "", "Flow" },
        { "LI-101", "m", "", "Level" },
        { "VI-101", "mm/s", "", "Vibration" },
    };
    struct plant plant = { 0 };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct export_tag tag = { 0 };
        struct tag_export list = { .tags = &tag, .count = 1 };
        struct quantities found = { 0 };
        for (int f = 0; f < EXPORT_FIELDS; f++)
            tag.fields[f] = (char *)"";
        tag.fields[EXPORT_NAME] = (char *)cases[i].name;
        tag.fields[EXPORT_UNIT] = (char *)cases[i].unit;
        tag.fields[EXPORT_DESCRIPTION] = (char *)cases[i].description;
        quantities_find(&found, &plant, NULL, &list, &(struct match){ .status = MATCH_SURE });
        const char *name = found.of_tag[0] < 0 ? "" : found.at[found.of_tag[0]].name;
        if (strcmp(name, cases[i].quantity) != 0)
            fail_msg("%s, '%s', '%s': '%s' for '%s'", cases[i].name, cases[i].unit, cases[i].description, name, cases[i].quantity);
        quantities_finish(&found);
    }
    print_message("# %zu of %zu quantities\n", sizeof(cases) / sizeof(*cases), sizeof(cases) / sizeof(*cases));
}

/* Different dashes, full-width characters and blanks do not prevent a match of tag and equipment. */
TEST(test_folded_names)
{
    static const char *const written[] = { "TI–101", "TI‑101", "TI−101", "TI－101", "ＴＩ-101", "TI-１０１",
                                          "TI\u00a0101", "\u200bTI-101" };
    struct name_tokens plain, tokens;
    char want[NAME_KEY_BYTES], key[NAME_KEY_BYTES];
    name_tokens_read(&plain, "TI-101");
    name_tokens_key(&plain, 0, plain.count, want);
    for (size_t i = 0; i < sizeof(written) / sizeof(*written); i++) {
        name_tokens_read(&tokens, written[i]);
        name_tokens_key(&tokens, 0, tokens.count, key);
        assert_string_equal(key, want);
    }
}

TEST(test_slips)
{
    assert_int_equal(name_slip("ARTBA", "ARTBA"), NAME_SAME);
    assert_int_equal(name_slip("ARRTBA", "ARTBA"), NAME_SLIP);
    assert_int_equal(name_slip("ATBA", "ARTBA"), NAME_SLIP);
    assert_int_equal(name_slip("ATRBA", "ARTBA"), NAME_SLIP);
    assert_int_equal(name_slip("ARTBB", "ARTBA"), NAME_OTHER_LETTER);
    assert_int_equal(name_slip("ARTB", "BARTBA"), NAME_DIFFERENT);
}

static void expect_text(char *got, const char *want)
{
    assert_non_null(got);
    assert_string_equal(got, want);
    mem_free(got);
}

TEST(test_plant_files_keep_what_people_wrote)
{
    static const char before[] =
        "# mine\ngroups: # all\n    - { id: a }   # first\n\n    # second\n    - { id: b }\n\n# then\ntags: t.csv\n";
    expect_text(
        plant_edit_append(before, "groups", "", "  - { id: c }\n"),
        "# mine\ngroups: # all\n    - { id: a }   # first\n\n    # second\n    - { id: b }\n    - { id: c }\n\n# then\ntags: t.csv\n");
    expect_text(plant_edit_replace(before, "groups", "- { id: c }\n- { id: d }\n"),
                "# mine\ngroups: # all\n    - { id: c }\n    - { id: d }\n\n# then\ntags: t.csv\n");
    expect_text(plant_edit_append("tags: t.csv\n", "sources", "# From where.\n", "  - { id: s }\n"),
                "# From where.\nsources:\n  - { id: s }\n\ntags: t.csv\n");
    assert_null(plant_edit_append("groups: [{ id: a }]\n", "groups", "", "- { id: c }\n"));
    expect_text(plant_edit_remove_line("a\n  - b\nc\n", "  - b"), "a\nc\n");
}
