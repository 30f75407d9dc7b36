/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tag lists exported by other systems: their encodings, separators and columns, and errors in them. */
#include "preprocess/match/tag_export.h"

#include "tests/support/test.h"
#include <minizip/zip.h>

#include "base/text/text.h"

static char *folder;
static char why[256];

static bool read_bytes(struct tag_export *list, const void *bytes, size_t count)
{
    char *path = temp_write(folder, "tags", bytes, count);
    *list = (struct tag_export){ 0 };
    bool good = tag_export_read(list, path, NULL, why, sizeof(why));
    return good;
}

static bool read_text(struct tag_export *list, const char *text)
{
    return read_bytes(list, text, strlen(text));
}

static void check(const struct tag_export *list, size_t tag, enum export_field field, const char *want)
{
    assert_true(tag < list->count);
    assert_string_equal(list->tags[tag].fields[field], want);
}

TEST(test_kepware)
{
    struct tag_export list;
    assert_true(
        read_text(&list,
                  "\"Tag Name\",\"Address\",\"Data Type\",\"Respect Data Type\",\"Client Access\",\"Scan Rate\",\"Scaling\",\"Raw Low\","
                  "\"Raw High\",\"Scaled Low\",\"Scaled High\",\"Scaled Data Type\",\"Clamp Low\",\"Clamp High\",\"Eng Units\","
                  "\"Description\",\"Negate Value\"\r\n"
                  "\"E101.TT-101\",\"400001\",\"Word\",1,\"R/W\",100,\"Linear\",0,27648,0,200,\"Double\",0,0,\"degC\",\"inlet, "
                  "\"\"hot\"\" side\",1\r\n"));
    assert_string_equal(list.format, "Kepware");
    assert_string_equal(list.encoding.name, "UTF-8");
    assert_int_equal(list.separator, ',');
    check(&list, 0, EXPORT_NAME, "E101.TT-101");
    check(&list, 0, EXPORT_RAW_HIGH, "27648");
    check(&list, 0, EXPORT_SCALED_HIGH, "200");
    check(&list, 0, EXPORT_UNIT, "degC");
    check(&list, 0, EXPORT_DESCRIPTION, "inlet, \"hot\" side");
    check(&list, 0, EXPORT_NEGATE, "1");
    assert_int_equal(list.tags[0].line, 2);
    tag_export_finish(&list);
}

TEST(test_ignition)
{
    struct tag_export list;
    assert_true(read_text(
        &list,
        "{\"name\":\"\",\"tagType\":\"Provider\",\"tags\":[{\"name\":\"Area1\",\"tagType\":\"Folder\",\"tags\":["
        "{\"name\":\"E-101\",\"tagType\":\"UdtInstance\",\"tags\":[{\"name\":\"TT\",\"tagType\":\"AtomicTag\",\"dataType\":\"Float4\","
        "\"opcItemPath\":{\"bindType\":\"parameter\",\"binding\":\"ns=1;s=[plc]HR1\"},"
        "\"engUnit\":\"°C\",\"engLow\":0,\"engHigh\":150.5}]},"
        "{\"name\":\"E-102\",\"tagType\":\"UdtInstance\",\"tags\":[{\"name\":\"TT\",\"tagType\":\"AtomicTag\"}]},"
        "{\"name\":\"PT-7\",\"tagType\":\"AtomicTag\",\"documentation\":\"feed\\u0007 pressure\"}]}]}"));
    assert_string_equal(list.format, "Ignition (JSON)");
    assert_int_equal(list.count, 3);
    assert_int_equal(list.renamed, 0); /* members of instances are named by their full path, so no name had to be made unique */
    check(&list, 0, EXPORT_NAME, "Area1/E-101/TT");
    check(&list, 0, EXPORT_ADDRESS, "ns=1;s=[plc]HR1");
    check(&list, 0, EXPORT_SCALED_HIGH, "150.5");
    check(&list, 1, EXPORT_NAME, "Area1/E-102/TT");
    check(&list, 2, EXPORT_NAME, "PT-7");
    check(&list, 2, EXPORT_AREA, "Area1");
    check(&list, 2, EXPORT_DESCRIPTION, "feed  pressure");
    assert_int_equal(list.control, 1);
    tag_export_finish(&list);
    assert_true(read_text(&list, "Path,Name,Owner,TagType,DataType,OPCServer,OPCItemPath,EngUnit,EngLow,EngHigh,Tooltip\n"
                                 ",Area1,,Folder,,,,,,,\n"
                                 "Area1,TT-1,,OPC,Float4,Ignition OPC,[plc]HR5,degC,0,90,Outlet\n"));
    assert_string_equal(list.format, "Ignition (CSV)");
    assert_int_equal(list.count, 1);
    check(&list, 0, EXPORT_ADDRESS, "[plc]HR5");
    check(&list, 0, EXPORT_AREA, "Area1");
    tag_export_finish(&list);
    /* the export omits properties that have their default values */
    assert_true(read_text(&list, "{\"tags\":[{\"name\":\"A\",\"scaleMode\":\"Linear\",\"rawHigh\":4095,\"scaledHigh\":150,\"engHigh\":1},"
                                 "{\"name\":\"B\",\"scaleMode\":\"SquareRoot\",\"engHigh\":7},"
                                 "{\"name\":\"C\",\"rawHigh\":4095,\"scaledHigh\":150,\"engHigh\":60},"
                                 "{\"name\":\"D\",\"scaleMode\":\"Linear\",\"rawHigh\":4095,\"engHigh\":60,"
                                 "\"scaledHigh\":{\"bindType\":\"parameter\",\"binding\":\"{Max}\"}}]}"));
    static const char *const scaled[][5] = {
        { "Linear", "0", "4095", "0", "150" },
        { "SquareRoot", "0", "10", "0", "10" },
        { "None", "", "", "0", "60" },
        { "Linear", "0", "4095", "0", "" } /* the upper end is unknown, not the default */
    };
    for (size_t i = 0; i < 4; i++) {
        check(&list, i, EXPORT_SCALING, scaled[i][0]);
        for (int f = 0; f < 4; f++)
            check(&list, i, EXPORT_RAW_LOW + f, scaled[i][1 + f]);
    }
    tag_export_finish(&list);
    assert_false(read_text(&list, "{\"tags\": [1, }"));
    assert_non_null(strstr(why, "line 1: not JSON"));
}

/* JSON export of the SCADA system Ignition: one tag provider with these data types and tags */
#define PROVIDER(types, tags)                                                                                                              \
    "{'name':'','tagType':'Provider','tags':[{'name':'_types_','tagType':'Folder','tags':[" types                                          \
    "]},{'name':'A','tagType':'Folder','tags':[" tags "]}]}"
#define TYPE(name, rest) "{'name':'" name "','tagType':'UdtType'," rest "}"
#define INSTANCE(name, type, rest) "{'name':'" name "','tagType':'UdtInstance','typeId':'" type "'" rest "}"
#define MEMBER(name, rest) "{'name':'" name "','tagType':'AtomicTag'" rest "}"
#define BOUND(text) "{'bindType':'parameter','binding':'" text "'}"
#define PUMP                                                                                                                               \
    TYPE("Pump", "'parameters':{'Dev':{'dataType':'String','value':'PLC1'},'No':{'dataType':'Integer','value':0}},'tags':[" MEMBER(        \
                     "T", ",'engUnit':'°C','engHigh':120,'opcItemPath':" BOUND("[{Dev}]HR{No}")) "]")

/* Ignition data types (UDT) with members: an instance may omit a member's fields, which then come from the type, or override
   them. */
TEST(test_udt_kinds)
{
    static const struct {
        const char *kind, *json;
        const char *name, *unit, *high, *address; /* expected fields of the first tag in the list */
        size_t count;
        const char *remark; /* NULL: none */
    } cases[] = {
        { "an instance without members", PROVIDER(PUMP, INSTANCE("P", "Pump", "")), "A/P/T", "°C", "120", "[PLC1]HR0", 1, NULL },
        { "a parameter of the instance", PROVIDER(PUMP, INSTANCE("P", "Pump", ",'parameters':{'No':{'value':7}}")), "A/P/T", "°C", "120",
          "[PLC1]HR7", 1, NULL },
        { "a parameter without an object", PROVIDER(PUMP, INSTANCE("P", "Pump", ",'parameters':{'No':7}")), "A/P/T", "°C", "120",
          "[PLC1]HR7", 1, NULL },
        { "members that say nothing", PROVIDER(PUMP, INSTANCE("P", "Pump", ",'tags':[" MEMBER("T", "") "]")), "A/P/T", "°C", "120",
          "[PLC1]HR0", 1, NULL },
        { "a property of the instance", PROVIDER(PUMP, INSTANCE("P", "Pump", ",'tags':[" MEMBER("T", ",'engHigh':90,'engUnit':'K'") "]")),
          "A/P/T", "K", "90", "[PLC1]HR0", 1, NULL },
        { "a member of the instance's own", PROVIDER(PUMP, INSTANCE("P", "Pump", ",'tags':[" MEMBER("X", ",'engUnit':'bar'") "]")), "A/P/X",
          "bar", "", "", 2, NULL },
        { "a parent type", PROVIDER(PUMP "," TYPE("Big", "'typeId':'Pump','parameters':{'Dev':{'value':'PLC9'}}"), INSTANCE("P", "Big",
          "")),
          "A/P/T", "°C", "120", "[PLC9]HR0", 1, NULL },
        { "a parent type's member, changed",
          PROVIDER(PUMP "," TYPE("Big", "'typeId':'Pump','tags':[" MEMBER("T", ",'engHigh':400") "]"), INSTANCE("P", "Big", "")), "A/P/T",
          "°C", "400", "[PLC1]HR0", 1, NULL },
        { "a type within a type",
          PROVIDER(PUMP "," TYPE("Skid", "'parameters':{'Plc':{'value':'S1'}},'tags':[" INSTANCE("M", "Pump",
            ",'parameters':{'Dev':{'value':" BOUND(
                                             "{Plc}") "},'No':{'value':3}}") "]"),
                   INSTANCE("P", "Skid", ",'parameters':{'Plc':{'value':'S2'}}")),
          "A/P/M/T", "°C", "120", "[S2]HR3", 1, NULL },
        { "the same name within and around",
          PROVIDER(PUMP "," TYPE("Skid", "'parameters':{'Dev':{'value':'S1'}},'tags':[" INSTANCE("M", "Pump",
            ",'parameters':{'Dev':{'value':" BOUND(
                                             "{Dev}-M") "}}") "]"),
                   INSTANCE("P", "Skid", "")),
          "A/P/M/T", "°C", "120", "[S1-M]HR0", 1, NULL },
        { "a member of a type within, changed",
          PROVIDER(PUMP "," TYPE("Skid", "'tags':[" INSTANCE("M", "Pump", "") "]"),
                   INSTANCE("P", "Skid", ",'tags':[{'name':'M','tagType':'UdtInstance','tags':[" MEMBER("T", ",'engUnit':'°F'") "]}]")),
          "A/P/M/T", "°F", "120", "[PLC1]HR0", 1, NULL },
        { "types in folders", PROVIDER("{'name':'F','tagType':'Folder','tags':[" PUMP "]}", INSTANCE("P", "F/Pump", "")), "A/P/T", "°C",
          "120",
          "[PLC1]HR0", 1, NULL },
        { "folders in types",
          PROVIDER(TYPE("Pump", "'tags':[{'name':'F','tagType':'Folder','tags':[" MEMBER("T", ",'engUnit':'bar'") "]}]"),
                   INSTANCE("P", "Pump", "")),
          "A/P/F/T", "bar", "", "", 1, NULL },
        { "built-in parameters",
          PROVIDER(TYPE("Pump", "'tags':[" MEMBER("T", ",'opcItemPath':"
            BOUND("{PathToParentFolder}|{InstanceName}|{TagName}|{PathToTag}")) "]"),
                   INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "A/P|P|T|A/P/T", 1, NULL },
        { "names of instances around",
          PROVIDER(TYPE("In", "'tags':[" MEMBER("T", ",'opcItemPath':" BOUND("{InstanceName}.{ParentInstanceName}.{RootInstanceName}"))
            "]") "," TYPE(
                       "Mid", "'tags':[" INSTANCE("I", "In", "") "]") "," TYPE("Out", "'tags':[" INSTANCE("M", "Mid", "") "]"),
                   INSTANCE("P", "Out", "")),
          "A/P/M/I/T", "", "", "I.M.P", 1, NULL },
        { "offsets and digits",
          PROVIDER(TYPE("Pump", "'parameters':{'B':{'value':40}},'tags':[" MEMBER("T", ",'opcItemPath':" BOUND("{B+2} {B - 1} {B|0000}"))
            "]"),
                   INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "42 39 0040", 1, NULL },
        { "a unit and a range by parameters",
          PROVIDER(TYPE("Pump", "'parameters':{'U':{'value':'bar'},'M':{'value':16}},'tags':[" MEMBER(
                                    "T", ",'engUnit':" BOUND("{U}") ",'engHigh':" BOUND("{M}")) "]"),
                   INSTANCE("P", "Pump", "")),
          "A/P/T", "bar", "16", "", 1, NULL },
        { "a parameter made of another",
          PROVIDER(TYPE("Pump", "'parameters':{'A':{'value':'x'},'B':{'value':" BOUND("{A}y") "}},'tags':[" MEMBER(
                                    "T", ",'opcItemPath':" BOUND("{B}z")) "]"),
                   INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "xyz", 1, NULL },
        { "a parameter without a value", PROVIDER(TYPE("Pump", "'tags':[" MEMBER("T", ",'opcItemPath':" BOUND("[{Dev}]1")) "]"),
          INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "[{Dev}]1", 1, "1 addresses refer to parameters of Ignition types (UDT) that have no value: A/P/T ([{Dev}]1)" },
        { "a parameter that is itself", PROVIDER(TYPE("Pump", "'parameters':{'D':{'value':" BOUND("{D}") "}},'tags':[" MEMBER("T",
          ",'opcItemPath':" BOUND("{D}")) "]"), INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "{D}", 1, "have no value: A/P/T" },
        { "an unknown type", PROVIDER("", INSTANCE("P", "Pump", ",'tags':[" MEMBER("T", ",'engUnit':'bar'") "]")), "A/P/T", "bar", "",
          "", 1,
          "1 instances of Ignition types (UDT) have a type that is not in the export; export the folder of types too: A/P (Pump)" },
        { "a type within itself", PROVIDER(TYPE("L", "'tags':[" INSTANCE("I", "L", "") "," MEMBER("T", "") "]"), INSTANCE("P", "L", "")),
          "A/P/T",
          "", "", "", 1, "1 instances of Ignition types (UDT) have a type that contains itself: its inner copies are left out: A/P/I (L)" },
        { "types that are each other's parents",
          PROVIDER(TYPE("X", "'typeId':'Y','tags':[" MEMBER("T", ",'engUnit':'bar'") "]") "," TYPE("Y", "'typeId':'X'"), INSTANCE("P",
            "X", "")),
          "A/P/T", "bar", "", "", 1, "contains itself: its inner copies are left out: A/P (X)" },
        { "types and instances in a list", "[" PUMP "," INSTANCE("P", "Pump", "") "]", "P/T", "°C", "120", "[PLC1]HR0", 1, NULL },
        { "arithmetic with precedence",
          PROVIDER(TYPE("Pump", "'parameters':{'N':{'value':3}},'tags':[" MEMBER("T", ",'opcItemPath':" BOUND("{N*10+2} {2+N*10} "
            "{(N+1)/2} {N%2} {N*2|000} {-N}")) "]"),
                   INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "32 32 2 1 006 -3", 1, NULL },
        { "a division by zero", PROVIDER(TYPE("Pump", "'parameters':{'N':{'value':3}},'tags':[" MEMBER("T", ",'opcItemPath':"
            BOUND("{N/0}")) "]"), INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "{N/0}", 1, "addresses refer to parameters of Ignition types (UDT) that have no value: A/P/T ({N/0})" },
        { "three types above each other, each with a default of its own",
          PROVIDER(PUMP "," TYPE("Mid", "'typeId':'Pump','parameters':{'No':{'value':5}}") "," TYPE("Top", "'typeId':'Mid','tags':["
            MEMBER("T", ",'engHigh':9") "," MEMBER("X", "") "]"),
                   INSTANCE("P", "Top", ",'parameters':{'Dev':{'value':'PLC7'}}")),
          "A/P/T", "°C", "9", "[PLC7]HR5", 2, NULL },
        { "instances in an array of names", PROVIDER(PUMP, INSTANCE("P[0]", "Pump", "") "," INSTANCE("P[1]", "Pump", "")), "A/P[1]/T",
          "°C", "120", "[PLC1]HR0", 2, NULL },
        { "a list within a list", "[" PUMP ",[" INSTANCE("P", "Pump", "") ",[" INSTANCE("Q", "Pump", "") "]]]", "Q/T", "°C", "120",
          "[PLC1]HR0", 2, NULL },
        { "a unit bound to another tag", PROVIDER(TYPE("Pump", "'tags':[" MEMBER("T", ",'engUnit':{'bindType':'tag','binding':'[.]U'}")
            "]"), INSTANCE("P", "Pump", "")),
          "A/P/T", "", "", "", 1,
          "1 units, ranges and descriptions refer to tags or parameters that have no value in this export: left out: A/P/T ([.]U)" },
        { "a type's path with the provider and another case", PROVIDER(PUMP, INSTANCE("P", "[default]_types_/pump", "")), "A/P/T", "°C",
          "120", "[PLC1]HR0", 1, NULL },
        { "one member of two overridden",
          PROVIDER(TYPE("Pump", "'tags':[" MEMBER("T", ",'engUnit':'bar','engHigh':4") "," MEMBER("S", ",'engUnit':'A'") "]"),
                   INSTANCE("P", "Pump", ",'tags':[" MEMBER("S", ",'engHigh':2") "]")),
          "A/P/S", "A", "2", "", 2, NULL },
        { "a tag outside of instances", PROVIDER(PUMP, MEMBER("L", ",'engUnit':'%','engLow':20")), "L", "%", "100", "", 1, NULL },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct tag_export list;
        char *json = test_memory(mem_strdup(cases[i].json));
        for (char *c = json; *c; c++)
            *c = *c == '\'' ? '"' : *c;
        if (!read_text(&list, json))
            fail_msg("%s: %s", cases[i].kind, why);
        size_t tag = 0;
        while (tag < list.count && strcmp(list.tags[tag].fields[EXPORT_NAME], cases[i].name) != 0)
            tag++;
        if (tag == list.count)
            fail_msg("%s: no tag '%s'", cases[i].kind, cases[i].name);
        check(&list, tag, EXPORT_UNIT, cases[i].unit);
        check(&list, tag, EXPORT_SCALED_HIGH, cases[i].high);
        check(&list, tag, EXPORT_ADDRESS, cases[i].address);
        assert_int_equal(list.count, cases[i].count);
        if (!cases[i].remark != !list.remarks.at || (cases[i].remark && !strstr(list.remarks.at, cases[i].remark)))
            fail_msg("%s: '%s'", cases[i].kind, list.remarks.at ? list.remarks.at : "");
        tag_export_finish(&list);
    }
    print_message("# %zu of %zu kinds of UDT\n", sizeof(cases) / sizeof(*cases), sizeof(cases) / sizeof(*cases));
}

/* Column headers of other systems and in other languages: the right columns must be recognised. */
TEST(test_header_kinds)
{
    static const struct {
        const char *kind, *text;
        const char *name, *address, *unit, *low, *high, *description; /* expected fields of the first tag in the list */
    } cases[] = {
        { "German", "Messstelle;Adresse;Einheit;Messbereich von;Messbereich bis;Bezeichnung\nT1;4001;°C;0;150;Lager\n", "T1", "4001",
          "°C",
          "0", "150", "Lager" },
        { "German, other words", "Variablenname;SPS-Adresse;Maßeinheit;Anfangswert;Endwert;Klartext\nT1;4001;bar;-1;9,5;Öl\n", "T1",
          "4001",
          "bar", "-1", "9.5", "Öl" },
        { "French", "Repère;Adresse;Unité;Échelle basse;Échelle haute;Désignation\nT1;4001;bar;0;10;Pompe\n", "T1", "4001", "bar",
          "0", "10",
          "Pompe" },
        { "French, other words", "Nom du tag;Adresse;Unité de mesure;Mini échelle;Maxi échelle;Libellé\nT1;4001;bar;;;Pompe\n", "T1",
          "4001",
          "bar", "", "", "Pompe" },
        { "Spanish", "Etiqueta;Dirección;Unidades;Rango mínimo;Rango máximo;Descripción\nT1;4001;bar;0;10;Bomba\n", "T1", "4001", "bar",
          "0", "10", "Bomba" },
        { "Korean", "태그명,주소,단위,하한,상한,설명\nT1,4001,℃,0,150,펌프\n", "T1", "4001", "℃", "0", "150", "펌프" },
        { "Korean, other words", "계기번호,PLC 주소,공학 단위,최소값,최대값,내용\nT1,4001,℃,0,150,펌프\n", "T1",
          "4001", "℃", "0", "150",
          "펌프" },
        { "Chinese", "位号,地址,单位,量程下限,量程上限,描述\nT1,4001,℃,0,150,泵\n", "T1", "4001", "℃", "0", "150",
          "泵" },
        { "Chinese, other words", "测点名称,寄存器地址,工程单位,下限,上限,说明\nT1,4001,℃,0,150,泵\n", "T1", "4001",
          "℃", "0", "150", "泵" },
        { "Chinese, traditional", "標籤名稱,位址,單位,下限,上限,說明\nT1,4001,℃,0,150,泵\n", "T1", "4001", "℃", "0",
          "150", "泵" },
        { "Japanese", "タグ名,アドレス,単位,下限値,上限値,説明\nT1,4001,℃,0,150,ポンプ\n", "T1", "4001", "℃", "0",
          "150", "ポンプ" },
        { "Japanese, half-width", "ﾀｸﾞ名,ｱﾄﾞﾚｽ,単位,下限,上限,ｺﾒﾝﾄ\nT1,4001,℃,0,150,ポンプ\n", "T1",
          "4001", "℃", "0", "150", "ポンプ" },
        { "Russian",
          "Тег;Адрес;Ед. изм.;Нижний предел;Верхний предел;Описание\n"
          "T1;4001;бар;0;10;Насос\n",
          "T1", "4001", "бар", "0",
          "10",
          "Насос" },
        { "full-width", "Ｔａｇ　Ｎａｍｅ,Ａｄｄｒｅｓｓ,Ｕｎｉｔ\nT1,4001,bar\n", "T1", "4001", "bar", "", "", "" },
        { "two languages", "位号 / Tag No.,地址 (Address),单位 Unit,描述 Description\nT1,4001,bar,泵\n", "T1", "4001", "bar", "",
          "", "泵" },
        { "units in the header", "Tag Name,Range Low [EU],Range High (EU),Unit\nT1,0,10,bar\n", "T1", "", "bar", "0", "10", "" },
        { "a header of two rows", "Tag Name;Range;;Unit;Description\n;Min;Max;;\nT1;0;10;bar;Pump\n", "T1", "", "bar", "0", "10", "Pump" },
        { "a title with a word of a header", "Name: plant 5,Unit: north\n\nTag,Address,Unit,Description\nT1,4001,bar,Pump\n", "T1", "4001",
          "bar", "", "", "Pump" },
        { "comments with other separators", "; list; of tags; made; today\n;\nTag Name,Address,Eng Units\nT1,4001,bar\n; T9,1,2\n", "T1",
          "4001",
          "bar", "", "", "" },
        { "PI",
          "Selected(x),Name,ObjectType,descriptor,pointsource,engunits,zero,span,instrumenttag\n,T1,PIPoint,Pump,OPC,bar,-1,11,PLC.T1\n",
          "T1", "PLC.T1", "bar", "-1", "10", "Pump" },
        { "PI, by its own names", "tag,descriptor,engunits,zero,span,instrumenttag,pointsource\nT1,Pump,bar,0,10,ns=2;s=T1,OPC\n", "T1",
          "ns=2;s=T1", "bar", "0", "10", "Pump" },
        { "an instrument index", "Instrument Tag,Service,Unit\nT1,Pump,bar\n", "T1", "", "bar", "", "", "Pump" },
        { "German, short", "AKZ;Adr.;Einh.;Min;Max;Bez.\nT1;4001;bar;0;10;Pumpe\n", "T1", "4001", "bar", "0", "10", "Pumpe" },
        { "German, of a control system", "Kurzzeichen;Signaladresse;Maßeinheit;Messbereichsanfang;Messbereichsende;Funktionstext\n"
          "T1;4001;bar;0;10;Pumpe\n", "T1", "4001", "bar", "0", "10", "Pumpe" },
        { "German, from and to", "PLS-Name;Adresse;Dimension;von;bis;Text\nT1;4001;bar;0;10;Pumpe\n", "T1", "4001", "bar", "0", "10",
          "Pumpe" },
        { "German, KKS", "KKS-Nr.;SPS-Adresse;Physikalische Einheit;MB-Anfang;MB-Ende;Langtext\nT1;4001;bar;0;10;Pumpe\n", "T1", "4001",
          "bar", "0", "10", "Pumpe" },
        { "French, label", "Nom de l'étiquette;Adresse automate;Unité d'ingénierie;Valeur min;Valeur max;Commentaires\n"
          "T1;4001;bar;0;10;Pompe\n", "T1", "4001", "bar", "0", "10", "Pompe" },
        { "French, scale",
          "Repère fonctionnel;Adresse;Unité;Début échelle;Fin d'échelle;Libellé\n"
          "T1;4001;bar;0;10;Pompe\n", "T1", "4001",
          "bar", "0", "10", "Pompe" },
        { "Spanish, other words",
          "Nombre de la etiqueta;Dirección PLC;Unidad de ingeniería;Valor mínimo;Valor máximo;Descripción del tag\n"
          ""
          "T1;4001;bar;0;10;Bomba\n", "T1", "4001", "bar", "0", "10", "Bomba" },
        { "Spanish, short", "Tag;Dirección Modbus;Ud.;Mín.;Máx.;Servicio\nT1;4001;bar;0;10;Bomba\n", "T1", "4001", "bar", "0", "10",
          "Bomba" },
        { "Korean, description",
          "태그 이름;PLC어드레스;공학단위;최소;최대;태그 설명\n"
          "T1;4001;bar;0;10;펌프\n", "T1", "4001", "bar", "0", "10", "펌프" },
        { "Korean, mixed",
          "TAG NO.;어드레스;UNIT;RANGE MIN;RANGE MAX;서비스명\n"
          "T1;4001;bar;0;10;펌프\n", "T1", "4001", "bar", "0", "10", "펌프" },
        { "Chinese, numbered",
          "序号;位号;通道地址;工程单位;量程低限;量程高限;测点描述\n"
          "1;T1;4001;bar;0;10;泵\n", "T1", "4001", "bar", "0", "10", "泵" },
        { "Chinese, short",
          "点号;地址;量纲;低量程;高量程;中文描述\n"
          "T1;4001;bar;0;10;泵\n", "T1", "4001", "bar", "0", "10", "泵" },
        { "TIA, tags of an operator panel",
          "Name;Path;Connection;PLC tag;DataType;Length;Coding;Access Method;Address;Comment [de-DE]\n"
          "T1;Default;HMI_1;\"DB1\".T1;Real;4;Binary;Absolute access;%DB1.DBD0;Pumpe\n", "T1", "%DB1.DBD0", "", "", "", "Pumpe" },
        { "TIA", "Name,Path,Data Type,Logical Address,Comment,Hmi Visible\nT1,Default tag table,Int,%IW64,Pump,True\n", "T1", "%IW64", "",
          "", "", "Pump" },
        { "TIA, German", "Name;Pfad;Datentyp;Logische Adresse;Kommentar\nT1;Standard;Real;%DB1.DBD0;Pumpe\n", "T1", "%DB1.DBD0", "", "", "",
          "Pumpe" },
        { "Studio 5000",
          "remark,\"CSV-Import-Export\"\n0.3\nTYPE,SCOPE,NAME,DESCRIPTION,DATATYPE,SPECIFIER,ATTRIBUTES\n"
          "TAG,,T1,\"Pump $QA$Q$N$'DE$' 5 $$\",\"REAL\",\"\",\"\"\nCOMMENT,,T1,\"step\",\"\",\"T1.3\",\n",
          "T1", "", "", "", "", "Pump \"A\" 'DE' 5 $" },
        { "Studio 5000, an alias",
          "TYPE,SCOPE,NAME,DESCRIPTION,DATATYPE,SPECIFIER,ATTRIBUTES\nALIAS,,T1,\"\",\"\",\"Rack:I.Ch0Data\",\"\"\n"
          "COMMENT,,Rack:I,\"Bearing$Ntemperature\",\"\",\"Rack:I.Ch0Data\",\n",
          "T1", "Rack:I.Ch0Data", "", "", "", "Bearing temperature" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct tag_export list;
        if (!read_text(&list, cases[i].text))
            fail_msg("%s: %s", cases[i].kind, why);
        const char *const wanted[] = { cases[i].name, cases[i].address, cases[i].unit, cases[i].low, cases[i].high, cases[i].description };
        static const enum export_field fields[] = { EXPORT_NAME,       EXPORT_ADDRESS,     EXPORT_UNIT,
                                                    EXPORT_SCALED_LOW, EXPORT_SCALED_HIGH, EXPORT_DESCRIPTION };
        for (size_t f = 0; f < sizeof(fields) / sizeof(*fields); f++)
            if (strcmp(list.tags[0].fields[fields[f]], wanted[f]) != 0)
                fail_msg("%s: '%s' for '%s'", cases[i].kind, list.tags[0].fields[fields[f]], wanted[f]);
        if (list.count != 1)
            fail_msg("%s: %zu tags", cases[i].kind, list.count);
        tag_export_finish(&list);
    }
    print_message("# %zu of %zu kinds of headers\n", sizeof(cases) / sizeof(*cases), sizeof(cases) / sizeof(*cases));
}

/* Names that differ only in characters that look alike, such as a hyphen and a dash: the list is read with a warning, and both tags
   are kept. */
TEST(test_alike)
{
    static const char *const others[] = { "PI–101", "PI‑101", "PI−101", "PI－101", "ＰＩ-101", "PI-101\u00a0", "\u200bPI-101",
      "PI-１０１" };
    for (size_t i = 0; i < sizeof(others) / sizeof(*others); i++) {
        struct tag_export list;
        char *text = test_printf("Tag,Address\nPI-101,1\n%s,2\nPI-102,3\n", others[i]);
        assert_true(read_text(&list, text));
        assert_int_equal(list.count, 3);
        check(&list, 1, EXPORT_NAME, others[i]);
        if (!list.remarks.at || !strstr(list.remarks.at, "1 tag differs") || !strstr(list.remarks.at, "PI-101 (lines 2 and 3)"))
            fail_msg("%s: %s", others[i], list.remarks.at ? list.remarks.at : "");
        tag_export_finish(&list);
    }
}

TEST(test_aveva)
{
    struct tag_export list;
    assert_true(
        read_text(&list,
                  ":mode=ask\n:IOAccess,Application,Topic,AdviseActive,DDEProtocol\n\"PLC1\",\"DASMBTCP\",\"PLC1\",Yes,No\n"
                  ":AlarmGroup,Group,Comment\n\"Unit10\",\"$System\",\"\"\n"
                  ":IODisc,Group,Comment,Logged,AccessName,ItemUseTagname,ItemName\n\"P101_RUN\",\"Unit10\",\"Pump runs\",No,\"PLC1\",No,"
                  "\"10001\"\n"
                  ":IOReal,Group,Comment,Logged,EngUnits,MinEU,MaxEU,HiAlarmValue,MinRaw,MaxRaw,Conversion,AccessName,ItemName\n"
                  "\"TI101\",\"Unit10\",\"E-101 outlet\",No,\"degC\",0,250,200,0,4095,Linear,\"PLC1\",\"40001 F\"\n"));
    assert_string_equal(list.format, "AVEVA InTouch DBDump");
    assert_int_equal(list.count, 2);
    check(&list, 0, EXPORT_TYPE, "Boolean");
    check(&list, 0, EXPORT_ADDRESS, "10001");
    check(&list, 1, EXPORT_NAME, "TI101");
    check(&list, 1, EXPORT_TYPE, "Float");
    check(&list, 1, EXPORT_ADDRESS, "40001");
    check(&list, 1, EXPORT_SCALED_HIGH, "250");
    check(&list, 1, EXPORT_H, "200");
    check(&list, 1, EXPORT_RAW_HIGH, "4095");
    check(&list, 1, EXPORT_DEVICE, "PLC1");
    tag_export_finish(&list);
    /* a limit that InTouch has switched off is exported as a number */
    assert_true(
        read_text(&list,
                  ":IOReal,Group,Comment,Logged,EventLogged,EventLoggingPriority,RetentiveValue,RetentiveAlarmParameters,"
                  "AlarmValueDeadband,AlarmDevDeadband,EngUnits,InitialValue,MinEU,MaxEU,Deadband,LogDeadband,LoLoAlarmState,"
                  "LoLoAlarmValue,LoLoAlarmPri,LoAlarmState,LoAlarmValue,LoAlarmPri,HiAlarmState,HiAlarmValue,HiAlarmPri,"
                  "HiHiAlarmState,HiHiAlarmValue,HiHiAlarmPri,MinorDevAlarmState,MinorDevAlarmValue,MinorDevAlarmPri,"
                  "MajorDevAlarmState,MajorDevAlarmValue,MajorDevAlarmPri,DevTarget,ROCAlarmState,ROCAlarmValue,ROCAlarmPri,"
                  "ROCTimeBase,MinRaw,MaxRaw,Conversion,AccessName,ItemUseTagname,ItemName,ReadOnly,AlarmComment\n"
                  "\"TI102\",\"Unit10\",\"\",No,No,0,No,No,0,0,\"degC\",0,0,250,0,0,Off,0,1,Off,0,1,On,200,1,Off,0,1,Off,0,1,Off,0,1,"
                  "0,Off,0,1,Min,0,4095,Linear,\"PLC1\",No,\"40003\",No,\"\"\n"));
    check(&list, 0, EXPORT_TYPE, "Word"); /* one register, although the section is IOReal */
    check(&list, 0, EXPORT_LL, "");
    check(&list, 0, EXPORT_L, "");
    check(&list, 0, EXPORT_H, "200");
    check(&list, 0, EXPORT_HH, "");
    tag_export_finish(&list);
    assert_true(read_text(&list, "; Created on: 3/4/2024\n\n:TEMPLATE=$AnalogDevice\n:Tagname,Area,ShortDesc,PV.EngUnits,PV.EngUnitsMin\n"
                                 "TT_101,Unit10,Outlet,bar,-1\n"));
    assert_string_equal(list.format, "AVEVA Galaxy dump");
    check(&list, 0, EXPORT_NAME, "TT_101");
    check(&list, 0, EXPORT_UNIT, "bar");
    check(&list, 0, EXPORT_SCALED_LOW, "-1");
    tag_export_finish(&list);
}

TEST(test_lists)
{
    struct tag_export list;
    assert_true(read_text(&list, "Site: north;;;;\n\nPoint ID;Description;EUDESC;PVEULO;PVEUHI\nTI101.DACA;Auslass;°C;0;1.250,5\n"));
    assert_string_equal(list.format, "Honeywell");
    assert_int_equal(list.separator, ';');
    check(&list, 0, EXPORT_SCALED_HIGH, "1250.5");
    tag_export_finish(&list);
    assert_true(read_text(&list, "Module\tDescription\tArea\tEU0\tEU100\tUnits\nTIC-101\tOutlet\tUNIT_10\t0\t200\tdegC\n"));
    assert_string_equal(list.format, "Emerson");
    assert_int_equal(list.separator, '\t');
    check(&list, 0, EXPORT_AREA, "UNIT_10");
    tag_export_finish(&list);
    assert_true(read_text(&list, "TT-101\nTT-102\n"));
    assert_int_equal(list.count, 2);
    tag_export_finish(&list);
}

/* Numbers with commas and dots. "1,500" and "1.500" alone do not say which of the two is the decimal separator. */
TEST(test_numbers)
{
    static const struct {
        const char *kind, *text, *high, *remark; /* high: Scaled High of the first tag; remark: NULL: none */
    } cases[] = {
        { "commas separate cells", "Tag,Low,Range High\nT,0,\"1,500\"\n", "1500", NULL },
        { "commas separate cells, a dot", "Tag,Low,Range High\nT,0,1.500\n", "1.500", NULL },
        { "decimal commas elsewhere", "Tag;Range Low;Range High\nT;0;1.500\nU;0,5;2\n", "1500", NULL },
        { "decimal commas elsewhere, a comma", "Tag;Range Low;Range High\nT;0;1,500\nU;0,5;2\n", "1.500", NULL },
        { "decimal points elsewhere", "Tag;Range Low;Range High\nT;0;1,500\nU;0.5;2\n", "1500", NULL },
        { "decimal points elsewhere, a dot", "Tag;Range Low;Range High\nT;0;1.500\nU;0.5;2\n", "1.500", NULL },
        { "nothing elsewhere", "Tag;Range High\nT;1.500\nU;2\n", "1.500",
          "1 number may have a decimal separator or a separator of thousands: T (Scaled High 1.500 read as 1.500)" },
        { "nothing elsewhere, a comma", "Tag;Range High\nT;1,500\nU;-2,250\n", "1.500",
          "2 numbers may have a decimal separator or a separator of thousands: T (Scaled High 1,500 read as 1.500), U (Scaled High "
          "-2,250 read as -2.250)" },
        { "both elsewhere", "Tag;Range Low;Range High\nT;0;1,500\nU;0.5;2,25\n", "1.500", "1 number may have" },
        { "a leading zero", "Tag;Range High\nT;0,125\nU;2\n", "0.125", NULL },
        { "four digits", "Tag;Range High\nT;1500,250\nU;2\n", "1500.250", NULL },
        { "both separators", "Tag;Range High\nT;1.234,5\nU;1.500\n", "1234.5", NULL },
        { "thousands twice", "Tag;Range High\nT;1,234,567\nU;2\n", "1234567", NULL },
        { "blanks and apostrophes", "Tag;Range High\nT;1 234,5\nU;2'000\n", "1234.5", NULL },
        { "another minus",
          "Tag;Range High\nT;\xe2\x88\x92"
          "40\nU;2\n",
          "-40", NULL },
        { "a unit",
          "Tag,Raw Low,Range High,HH\nT,4 mA,100,90 \xc2\xb0"
          "C\nU,0,20 mA,-\n",
          "100",
          "3 ranges, limits or Negate Values are not numbers, and are left out: T (Raw Low '4 mA'), T (HH '90 \xc2\xb0"
          "C'), U (Scaled "
          "High '20 mA')" },
        { "no number", "Tag,Range High\nT,n/a\nU,-\n", "", NULL },
        { "groups of other lengths", "Tag,Range High\nT,\"1,2,3\"\n", "", "1 range, limit or Negate Value is not a number" },
        { "a JSON text", "[{\"name\":\"T\",\"engHigh\":\"1,500\"},{\"name\":\"U\",\"engHigh\":2.5}]", "1500", NULL },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct tag_export list;
        if (!read_text(&list, cases[i].text))
            fail_msg("%s: %s", cases[i].kind, why);
        if (strcmp(list.tags[0].fields[EXPORT_SCALED_HIGH], cases[i].high) != 0)
            fail_msg("%s: '%s'", cases[i].kind, list.tags[0].fields[EXPORT_SCALED_HIGH]);
        const char *said = list.remarks.at ? list.remarks.at : "";
        if (cases[i].remark ? !strstr(said, cases[i].remark) : *said != 0)
            fail_msg("%s: '%s'", cases[i].kind, said);
        tag_export_finish(&list);
    }
}

TEST(test_encodings)
{
    static const char latin1[] = "Tag;Description;Unit\nTT-1;W\xe4rmetauscher f\xfcr \xd6l;\xb0"
                                 "C\n";
    static const char korean[] = "Tag,Description\nTT-1,\xbf\xad\xb1\xb3\xc8\xaf\xb1\xe2 \xc3\xe2\xb1\xb8\n"; /* heat exchanger outlet */
    static const char wide[] = "\xff\xfeT\0a\0g\0\t\0U\0n\0i\0t\0\n\0T\0T\0-\0\x31\0\t\0\xb0\0C\0\n\0";
    struct tag_export list;
    assert_true(read_bytes(&list, latin1, sizeof(latin1) - 1));
    assert_string_equal(list.encoding.name, "Windows-1252");
    check(&list, 0, EXPORT_DESCRIPTION, "Wärmetauscher für Öl");
    check(&list, 0, EXPORT_UNIT, "°C");
    tag_export_finish(&list);
    assert_true(read_bytes(&list, korean, sizeof(korean) - 1));
    assert_string_equal(list.encoding.name, "EUC-KR");
    check(&list, 0, EXPORT_DESCRIPTION, "열교환기 출구");
    tag_export_finish(&list);
    for (size_t mark = 0; mark <= 2; mark += 2) {
        assert_true(read_bytes(&list, wide + mark, sizeof(wide) - 1 - mark));
        assert_string_equal(list.encoding.name, "UTF-16LE");
        assert_int_equal(list.separator, '\t');
        check(&list, 0, EXPORT_UNIT, "°C");
        tag_export_finish(&list);
    }
    assert_true(read_text(&list, "\xef\xbb\xbfTag\nTT-\xff"
                                 /* the byte order mark says that the file is UTF-8, so an invalid byte is replaced instead of
                                    guessing another encoding */
                                 "1\n"));
    assert_int_equal(list.damaged, 1);
    check(&list, 0, EXPORT_NAME,
          "TT-\xef\xbf\xbd"
          "1");
    tag_export_finish(&list);
}

TEST(test_repeated)
{
    struct tag_export list;
    assert_true(read_text(&list, "Tag Name,Address\nTT-1,1\nTT-2,2\n TT-1 ,1\ntt-2,3\n,4\nTT\x01-3,5\n열/교환 기,6\n"));
    assert_int_equal(list.rows, 7);
    assert_int_equal(list.count, 4);
    assert_int_equal(list.same, 1);
    assert_int_equal(list.differing.count, 1);
    assert_string_equal(list.differing.names.at, "TT-2 (lines 3 and 5)");
    assert_int_equal(list.nameless, 1);
    assert_int_equal(list.control, 1);
    check(&list, 2, EXPORT_NAME, "TT -3");
    check(&list, 3, EXPORT_NAME, "열/교환 기");
    tag_export_finish(&list);
}

/* Remarks show the whole name of a tag in long folders, as it is in the export. */
TEST(test_alike_in_long_folders)
{
    struct tag_export list;
    const char *folder_name = "공장/구역/Boiler house 1 long folder name/and another folder with a long name";
    assert_true(read_text(&list, test_printf("Tag Name,Address\n%s/TIC\xe2\x80\x93"
                                             "101,1\n%s/TIC-101,2\n",
                                             folder_name, folder_name)));
    assert_int_equal(list.count, 2);
    assert_non_null(strstr(list.remarks.at, test_printf("%s/TIC\xe2\x80\x93"
                                                        "101 (lines 2 and 3)",
                                                        folder_name)));
    tag_export_finish(&list);
}

static void add_part(zipFile zip, const char *name, const char *text)
{
    assert_int_equal(zipOpenNewFileInZip(zip, name, NULL, NULL, 0, NULL, 0, NULL, Z_DEFLATED, 6), ZIP_OK);
    assert_int_equal(zipWriteInFileInZip(zip, text, (unsigned)strlen(text)), ZIP_OK);
    assert_int_equal(zipCloseFileInZip(zip), ZIP_OK);
}

static bool read_xlsx(struct tag_export *list, const char *strings, const char *sheet)
{
    char *path = temp_path(folder, "tags.xlsx");
    zipFile zip = zipOpen(path, APPEND_STATUS_CREATE);
    assert_non_null(zip);
    add_part(zip, "xl/sharedStrings.xml", strings);
    add_part(zip, "xl/worksheets/sheet1.xml", sheet);
    zipClose(zip, NULL);
    *list = (struct tag_export){ 0 };
    bool good = tag_export_read(list, path, NULL, why, sizeof(why));
    return good;
}

TEST(test_spreadsheet)
{
    static const char strings[] = "<sst><si><t>Tag Name</t></si><si><r><t>Eng </t></r><r><t>Units</t></r></si><si><t>TT-1</t></si></sst>";
    struct tag_export list;
    assert_true(
        read_xlsx(&list, strings,
                  "<worksheet><sheetData><row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c><c r=\"C1\" t=\"s\"><v>1</v></c></row>"
                  "<row r=\"4\"><c r=\"A4\" t=\"s\"><v>2</v></c><c r=\"C4\" t=\"inlineStr\"><is><t>°C</t></is></c></row></sheetData>"
                  "</worksheet>"));
    assert_string_equal(list.encoding.name, "");
    check(&list, 0, EXPORT_NAME, "TT-1");
    check(&list, 0, EXPORT_UNIT, "°C");
    assert_int_equal(list.tags[0].line, 4);
    tag_export_finish(&list);
    assert_false(read_xlsx(&list, strings, "<worksheet><sheetData><row>"));
    assert_non_null(strstr(why, "sheet1.xml, line 1"));
    assert_false(read_xlsx(&list, "<!DOCTYPE a [<!ENTITY b \"bb\">]><sst/>", "<worksheet/>"));
    assert_false(read_xlsx(&list, strings, "<worksheet><sheetData><row r=\"1\"><c r=\"ZZZZ1\"><v>1</v></c></row></sheetData></worksheet>"));
    assert_non_null(strstr(why, "too large"));
}

#define CELL(at, text) "<c r=\"" at "\" t=\"inlineStr\"><is><t>" text "</t></is></c>"
#define SHEET(rows) "<worksheet><sheetData>" rows "</sheetData></worksheet>"

TEST(test_checksum)
{
    static const char sheet[] = SHEET("<row>" CELL("A1", "Tag Name") "</row><row>" CELL("A2", "TT-1") "</row>");
    struct tag_export list = { 0 };
    size_t length;
    char *path = temp_path(folder, "changed.xlsx");
    zipFile zip = zipOpen(path, APPEND_STATUS_CREATE);
    assert_int_equal(zipOpenNewFileInZip(zip, "xl/worksheets/sheet1.xml", NULL, NULL, 0, NULL, 0, NULL, 0, 0), ZIP_OK); /* stored */
    assert_int_equal(zipWriteInFileInZip(zip, sheet, sizeof(sheet) - 1), ZIP_OK);
    assert_int_equal(zipCloseFileInZip(zip), ZIP_OK);
    zipClose(zip, NULL);
    char *bytes = test_memory(text_read_file(path, 10000, &length)), *name = memmem(bytes, length, "TT-1", 4);
    name[3] = '7';
    FILE *file = fopen(path, "wb");
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    fclose(file);
    assert_false(tag_export_read(&list, path, NULL, why, sizeof(why)));
    assert_non_null(strstr(why, "sheet1.xml is damaged: its checksum is wrong"));
}

/* An Excel workbook with a cover sheet, a hidden sheet and the list, in which the files of the package have unusual names. */
TEST(test_sheets)
{
    struct tag_export list;
    char *path = temp_path(folder, "book.xlsx");
    zipFile zip = zipOpen(path, APPEND_STATUS_CREATE);
    add_part(zip, "xl/workbook.xml",
             "<x:workbook xmlns:x=\"m\" xmlns:r=\"r\"><x:sheets><x:sheet name=\"Cover\" r:id=\"a\"/>"
             "<x:sheet name=\"Old\" state=\"hidden\" r:id=\"b\"/><x:sheet name=\"Tags\" r:id=\"c\"/></x:sheets></x:workbook>");
    add_part(zip, "xl/_rels/workbook.xml.rels",
             "<Relationships><Relationship Id=\"a\" Target=\"worksheets/one.xml\"/><Relationship Id=\"b\" "
             "Target=\"/xl/worksheets/two.xml\"/><Relationship Id=\"c\" Target=\"worksheets/three.xml\"/></Relationships>");
    add_part(zip, "xl/worksheets/one.xml", SHEET("<row>" CELL("A1", "Tag list") "</row><row>" CELL("A2", "Unit") CELL("B2", "5") "</row>"));
    add_part(zip, "xl/worksheets/two.xml",
             SHEET("<row>" CELL("A1", "Tag") CELL("B1", "Unit") "</row><row>" CELL("A2", "OLD-1") CELL("B2", "bar") "</row>"));
    add_part(zip, "xl/worksheets/three.xml",
             "<x:worksheet xmlns:x=\"m\"><x:sheetData><x:row r=\"7\"><x:c r=\"B7\" t=\"inlineStr\"><x:is><x:t>Tag</x:t></x:is></x:c>"
             "<x:c r=\"C7\" t=\"inlineStr\"><x:is><x:t>Unit</x:t></x:is></x:c><x:c r=\"D7\" t=\"inlineStr\"><x:is><x:t>Service</x:t>"
             "</x:is></x:c></x:row><x:row r=\"8\"><x:c r=\"B8\" t=\"inlineStr\"><x:is><x:t>T1</x:t></x:is></x:c></x:row></x:sheetData>"
             "</x:worksheet>");
    zipClose(zip, NULL);
    list = (struct tag_export){ 0 };
    if (!tag_export_read(&list, path, NULL, why, sizeof(why)))
        fail_msg("%s", why);
    assert_int_equal(list.count, 1);
    check(&list, 0, EXPORT_NAME, "T1");
    assert_non_null(strstr(list.remarks.at, "the tag list is sheet 'Tags' of 3 sheets"));
    assert_non_null(strstr(list.remarks.at, "not read: 'Old'"));
    tag_export_finish(&list);
}

/* Reads an Excel workbook with `count` sheets, all of which refer to the same file of the package. Returns whether it was
   accepted. */
static bool read_sheets(int count, struct tag_export *list)
{
    char *path = temp_path(folder, "sheets.xlsx");
    struct text *workbook = test_text();
    text_add(workbook, "<workbook xmlns:r=\"r\"><sheets>");
    for (int i = 1; i <= count; i++)
        text_add(workbook, "<sheet name=\"S%d\" r:id=\"a\"/>", i);
    text_add(workbook, "</sheets></workbook>");
    char *relations = test_printf("<Relationships><Relationship Id=\"a\" Target=\"worksheets/last.xml\"/></Relationships>");
    zipFile zip = zipOpen(path, APPEND_STATUS_CREATE);
    add_part(zip, "xl/workbook.xml", workbook->at);
    add_part(zip, "xl/_rels/workbook.xml.rels", relations);
    add_part(zip, "xl/worksheets/last.xml", SHEET("<row>" CELL("A1", "Tag") CELL("B1", "Unit") "</row><row>" CELL("A2", "TT-1") "</row>"));
    zipClose(zip, NULL);
    *list = (struct tag_export){ 0 };
    bool good = tag_export_read(list, path, NULL, why, sizeof(why));
    return good;
}

TEST(test_many_sheets)
{
    struct tag_export list;
    assert_true(read_sheets(70, &list));
    assert_non_null(strstr(list.remarks.at, "of 70"));
    tag_export_finish(&list);
    assert_false(read_sheets(1025, &list));
    assert_non_null(strstr(why, "more than 1024 sheets"));
}

TEST(test_refused)
{
    static const struct {
        const char *text, *why;
    } cases[] = {
        { "", "no header" },
        { "a,b\n1,2\n", "no header" },
        { "Tag,Unit\n\"TT-1,2\n", "line 2 of the table: a quote is never closed" },
        { "Tag,Unit\n", "no tags" },
        { "PK\3\4rest", "not a spreadsheet" },
        { "\xd0\xcf\x11\xe0", "save the sheet as .xlsx" },
        { "[1, 2]", "no tags" },
        { "<Tags><Tag name=\"T1\"/></Tags>", "XML is not supported" },
        { "{\"tags\":[{\"name\":\"P\",\"tagType\":\"UdtInstance\",\"typeId\":\"Pump\"}]}",
          "the file contains no tags: 1 instances of Ignition types (UDT) have a type" },
    };
    struct tag_export list;
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        assert_false(read_text(&list, cases[i].text));
        if (!strstr(why, cases[i].why))
            fail_msg("'%s' for '%s'", why, cases[i].text);
        assert_null(list.tags);
    }
}

static int set_up(void **state)
{
    (void)state;
    folder = temp_folder();
    return 0;
}

TEST_GROUP(set_up, NULL)
