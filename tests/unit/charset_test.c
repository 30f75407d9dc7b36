/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognition of the encoding of short texts, such as those in tag lists and drawings. Counts the texts of each encoding that
   are recognised correctly. */
#include "base/text/charset.h"

#include "tests/support/test.h"

enum { MOST = 24 };

static const struct encoded_sample {
    const char *encoding, *texts[MOST];
} kinds[] = {
    { "UTF-8", { "°C", "泵", "Füllstand Behälter", "Насос;бар", "ポンプ", "펌프 ℃" } },
    { "GB18030",
      { "℃", "泵", "泵轴承温度", "名称,地址,单位,说明", "位号;描述;量程下限;量程上限", "冷却水流量",
      "反应釜搅拌器电流 A", "一号锅炉主蒸汽压力",
        "离心泵P-101出口压力", "原料罐区", "精馏塔塔顶温度", "TI-101,400001,℃,泵轴承", "换热器E-101",
        "鼓风机", "脱硫塔浆液pH", "循环水泵房",
        "电动阀门开度", "空压机排气温度" } },
    { "Big5", { "泵浦軸承溫度", "冷卻水流量", "名稱,位址,單位,說明", "鍋爐主蒸汽壓力", "儲槽液位",
    "壓縮機出口壓力" } },
    { "Shift-JIS",
      { "ポンプP-101軸受温度", "℃", "表示タンクV-201圧力", "タグ名,アドレス,単位,説明", "冷却水流量",
      "ﾎﾟﾝﾌﾟ温度", "反応器ジャケット温度",
        "モータ電流", "ベース;ソケット", "熱交換器入口", "ボイラー給水流量", "攪拌機", "バルブ開度 %",
        "ｺﾝﾌﾟﾚｯｻ" } },
    { "EUC-JP", { "ポンプP-101軸受温度", "タグ名,アドレス,単位,説明", "冷却水流量計", "タンク圧力",
    "熱交換器出口温度" } },
    { "EUC-KR",
      { "열교환기 출구", "온도", "펌프", "태그명,주소,단위,설명", "℃", "보일러 급수 유량", "탱크 레벨",
      "모터 전류", "원료 탱크 하부 압력",
        "주증기 압력", "냉각탑 팬 진동", "TI-101,400001,℃,펌프 베어링", "공기압축기 토출온도" } },
    { "Windows-1251",
      { "Температура подшипника насоса P-101", "бар", "Имя;Адрес;Ед. изм.;Описание",
      "Давление в ёмкости", "Насос", "°C;Температура",
        "Задвижка", "НАСОС ПИТАТЕЛЬНЫЙ", "Расход воды, м3/ч", "Уровень", "Площадка",
        "Зона 1", "Котёл", "тиск у котлі, витрата",
        "Вибрация двигателя", "Теплообменник Т-101" } },
    { "KOI8-R", { "Температура подшипника насоса", "Давление в ёмкости",
    "Насос питательный", "Расход воды" } },
    { "CP866", { "Температура подшипника насоса", "Давление в ёмкости",
    "Насос питательный", "Расход воды" } },
    { "Windows-1252",
      { "°C", "Wärmetauscher für Öl", "m³/h", "Füllstand Behälter", "Débit eau de chaudière", "Presión bomba", "µS/cm",
      "Größe",
        "Pompe à eau", "Código;Descripción;Dirección", "Unité;Désignation;Adresse", "CHAUDIÈRE À VAPEUR", "KÜHLWASSER",
        "Vazão de água",
        "Smøreolje trykk", "Pääsäiliö lämpötila", "± 5 %", "A – B", "é", "TT-1;40001;°C;Vorlauf", "Temperatura saída",
        "Ångtryck" } },
    { "Windows-1250",
      { "Ciśnienie pary świeżej", "Teplota čerpadla", "Ložisko čerpadla", "Przepływ wody chłodzącej", "Hőmérséklet",
      "Wężownica",
        "Přehřívák" } },
    { "Windows-1254", { "Sıcaklık", "Basınç", "Besleme suyu debisi çıkışı", "Yağ soğutucu giriş" } },
    { "Windows-1253", { "Θερμοκρασία αντλίας", "Πίεση λέβητα", "Στάθμη δεξαμενής" } },
    { "CP850", { "Füllstand Behälter", "Kühlwasser Rücklauf", "Druck vor Ölkühler Außen" } },
    { "UTF-16LE", { "Tag,Unit\nTT-1,°C\n", "Имя;Адрес\nНасос;40001\n", "名称,地址,单位\n泵,400001,℃\n" } },
    { "UTF-16BE", { "Tag,Unit\nTT-1,°C\n", "Имя;Адрес\nНасос;40001\n", "名称,地址,单位\n泵,400001,℃\n" } },
};

/* Counts right, uncertain and wrong results. A wrong result is worse than one that is reported as uncertain. */
TEST(test_kinds)
{
    size_t texts = 0, right = 0, unsure = 0, wrong = 0;
    for (size_t k = 0; k < sizeof(kinds) / sizeof(*kinds); k++) {
        size_t of_kind = 0, right_of_kind = 0;
        struct charset_encoder *encoder = charset_encoder_open(kinds[k].encoding);
        for (const char *const *text = kinds[k].texts; text < kinds[k].texts + MOST && *text; text++, of_kind++) {
            unsigned char bytes[256];
            struct charset_text found;
            size_t count = charset_encode(encoder, *text, strlen(*text), bytes, sizeof(bytes));
            assert_true(count > 0);
            charset_decode((const char *)bytes, count, NULL, &found);
            bool same = !strcmp(found.utf8, *text);
            right_of_kind += same;
            unsure += *found.encoding.other != 0;
            if (!same) {
                print_message("# %s '%s' is read as %s '%s'%s%s\n", kinds[k].encoding, *text, found.encoding.name, found.utf8,
                              *found.encoding.other ? ", unsure: " : "", found.encoding.other);
                wrong++;
            }
            mem_free(found.utf8);
        }
        charset_encoder_close(encoder);
        print_message("# %-13s %2zu of %2zu\n", kinds[k].encoding, right_of_kind, of_kind);
        texts += of_kind;
        right += right_of_kind;
    }
    print_message("# %zu of %zu texts in %zu encodings; %zu unsure\n", right, texts, sizeof(kinds) / sizeof(*kinds), unsure);
    assert_int_equal(wrong, 0);
}

TEST(test_marks_and_damage)
{
    static const struct {
        const char *bytes;
        size_t count;
        const char *name, *utf8;
        size_t damaged;
    } cases[] = {
        { "\xef\xbb\xbfTT-\xb0", 7, "UTF-8", "TT-\xef\xbf\xbd", 1 },
        { "\xff\xfe\xb0\0C\0", 6, "UTF-16LE", "°C", 0 },
        { "\xfe\xff\0\xb0\0C", 6, "UTF-16BE", "°C", 0 },
        { "\xff\xfe\x6f\x82\x35\x6e", 6, "UTF-16LE", "良渵", 0 },
        { "\x1b$B%]%s%W\x1b(B", 12, "ISO-2022-JP", "ポンプ", 0 },
        { "\xc3\xa4\xc3\xb6\xc3\xbc \xe6\xb3\xb5 \xc3\xa4\xc3", 14, "UTF-8", "äöü 泵 ä\xef\xbf\xbd", 1 }, /* cut off */
        { "plain", 5, "UTF-8", "plain", 0 },
        { "PT\0\0-101", 8, "UTF-8", "PT-101", 2 },
        { "", 0, "UTF-8", "", 0 },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct charset_text found;
        charset_decode(cases[i].bytes, cases[i].count, NULL, &found);
        assert_string_equal(found.encoding.name, cases[i].name);
        assert_string_equal(found.utf8, cases[i].utf8);
        assert_int_equal(found.length, strlen(cases[i].utf8));
        assert_int_equal(found.damaged, cases[i].damaged);
        mem_free(found.utf8);
    }
}

TEST(test_names)
{
    static const char *const written[][2] = { { "Windows 1251", "Windows-1251" }, { "GBK", "GB18030" },         { "gb2312", "GB18030" },
                                              { "Latin-1", "Windows-1252" },      { "ISO 8859-1", "Windows-1252" }, { "sjis", "Shift-JIS" },
                                              { "Unicode UTF-8", "UTF-8" },       { "CP949", "EUC-KR" },        { "ISO-8859-5",
                                              "ISO-8859-5" },
                                              { "koi8-r", "KOI8-R" },             { "IBM866", "CP866" },        { "1250",
                                              "Windows-1250" } };
    char name[CHARSET_NAME_BYTES];
    for (size_t i = 0; i < sizeof(written) / sizeof(*written); i++) {
        assert_true(charset_resolve(written[i][0], name));
        assert_string_equal(name, written[i][1]);
    }
    static const char *const unknown[] = { "", "-", "klingon", "UTF-8//IGNORE", "a name that is far longer than any encoding has" };
    for (size_t i = 0; i < sizeof(unknown) / sizeof(*unknown); i++)
        assert_false(charset_resolve(unknown[i], name));
    struct charset_text text;
    charset_decode("\xcd\xe0\xf1\xee\xf1", 5, "KOI8-R", &text);
    assert_string_equal(text.utf8, "мЮЯНЯ");
    mem_free(text.utf8);
}

/* The text contains a byte that two encodings explain equally well: the result must name both and the option --encoding. */
TEST(test_unsure)
{
    struct charset_choice choice = charset_find("Gr\x94\xe1"
                                                "e",
                                                5);
    assert_string_not_equal(choice.other, "");
    char *said = test_memory(charset_describe(&choice));
    assert_non_null(strstr(said, "--encoding NAME"));
}

/* In some encodings an accent follows its letter, so the decoder delays each letter until the next byte. The last letter must
   not be lost: it would turn the tag PT-10A into PT-10, which is another tag. */
TEST(test_last_letter)
{
    static const struct {
        const char *encoding, *bytes, *utf8;
    } cases[] = {
        { "CP1258", "PT-10A", "PT-10A" },
        { "windows-1258", "PT-10A", "PT-10A" },
        { "CP1258", "b\xec", "b\xcc\x81" },
        { "CP1258", "to\xec", "t\xc3\xb3" }, /* o followed by a combining acute accent gives ó */
        { "CP1255", "\xf9", "\xd7\xa9" },
        { "Windows-1251", "\xcd\xc0", "НА" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        size_t damaged = 0;
        char *text = test_memory(charset_convert(cases[i].bytes, strlen(cases[i].bytes), cases[i].encoding, &damaged));
        assert_string_equal(text, cases[i].utf8);
        assert_int_equal(damaged, 0);
    }
}
