/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Detects the encoding of a text by its byte order mark, by its validity as UTF-8, or else by the likelihood of its bytes under
   a statistical model of each encoding. The models use characters that are common in tag lists and drawings, the frequency
   levels of the encodings' standards, and the letters around a character. The encoding that the library uchardet proposes gets
   a higher score. */
#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <uchardet.h>

#include "base/mem.h"
#include "base/text/charset.h"
#include "base/text/utf8.h"

enum { SAMPLE_BYTES = 1 << 16, MAX_LINE = 512 };

/* --- statistical models of two-byte encodings ------------------------------------------------------------------------------- */

/* Frequent characters in texts about process plants: simplified and traditional Chinese, Japanese, Korean. The models assume
   that these characters make up half of a text. */
static const char simplified[] =
    "℃温度压力流量液位泵阀门罐塔炉汽水油气管线进出口入电机轴承高低报警设备单"
    "元号说明名称地址标签描述位置类型工程值反应器换热冷却循环"
    "风机压缩储槽站主副备用控制调节开关状态故障运行停止信号模拟数字输入输出报"
    "表时间上下限左右前后内外中总热给排蒸发干燥分离过滤混合"
    "搅拌速度转频率功率流体料仓车间区号线路系统装置仪表测点传感器变送器容器支"
    "架法兰弯头三通平台楼梯梁柱框架基础一二三四五六七八九十"
    "的在是有为和不人这大生产安全厂房组件零体箱柜板座盖环套杆轮带轨螺栓母钢筋"
    "的单位量程备注序原润滑密封氮氢氧硫酸碱盐灰渣煤磨锅炉"
    "振动差浓物重顶底部侧出力加送引除尘脱硝硫废污补软化净净凝结疏";
static const char traditional[] =
    "℃溫度壓力流量液位泵閥門罐塔爐汽水油氣管線進出口入電機軸承"
    "高低報警設備單元號說明名稱地址標籤描述位置類型"
    "工程值反應器換熱冷卻循環風機壓縮儲槽站主副備用控制調節開關狀態故障運行停"
    "止信號類比數位輸入輸出時間上下限"
                                  "的在是有為和不人這大生產安全廠房組件零體箱櫃板座蓋環套桿輪帶軌";
static const char japanese[] =
    "℃温度圧力流量液位弁槽塔炉蒸気水油管線入出口電機軸受高低警報設備機器番号"
    "説明名称配管位置種類工学値反応器熱交換冷却循環送風圧縮貯"
    "主副予備制御調節開閉状態故障運転停止信号入力出力時間上下限左右前後内外中"
    "総給排乾燥分離混合撹拌速度回転周波数電力室棟系統装置計測点"
    "単位表示アイウエオカキクケコサシスセソタチツテトナニヌネノハヒフヘホマミ"
    "ムメモヤユヨラリルレロワンーッャュョァィェォガギグゲゴザジズゼ"
    "ゾダデドバビブベボパピプペポのはをにがとでるいしたてなもあかきくけこさす"
    "せそちつとぬねのひふへほまみむめやゆよらりれろわん";
static const char korean[] =
    "℃온도압력유량레벨펌프탱크밸브입구출구전류전압모터베어링고저경보설비기기"
    "번호설명이름주소단위태그위치종류공학값반응기열교환냉각순환"
    "송풍압축저장조주부예비제어조절개폐상태고장운전정지신호아날로그디지털입력"
    "출력시간상하한좌우전후내외중총급배수증발건조분리혼합교반속"
    "도회전주파수전력실동계통장치계측점보일러터빈배관라인가스오일물공기스팀의"
    "에는을를이다고한하지서로인사나리자라대원제일선화학물질관로"
    "진동차농축중량상부하단측정센서발신기필터팬흡입토출윤활밀봉질소수소산황폐처리동작정상비상";

struct wide_model {
    const char *name, *frequent;
    double prior;
    /* Returns the log probability, in a text with this model's encoding, of the character with these two bytes, if it is not in
       `frequent`. second 0: a one-byte character. 0: the encoding has no such character. */
    double (*rate)(unsigned first, unsigned second);
};

/* Returns the log probability of one character of a class. The class has `cells` characters, which together make up the
   fraction `share` of a text. */
static double of_class(double share, double cells)
{
    return log(share / cells);
}

static bool in(unsigned byte, unsigned from, unsigned to)
{
    return byte >= from && byte <= to;
}

/* Returns the log probability of a byte pair in GBK. In GB 2312, rows 16 to 55 hold the common characters, rows 56 to 87 the
   others; GBK adds rare ones around them. */
static double rate_gb(unsigned first, unsigned second)
{
    bool gb2312 = in(second, 0xa1, 0xfe);
    if (!in(first, 0x81, 0xfe) || !in(second, 0x40, 0xfe) || second == 0x7f)
        return 0;
    if (in(first, 0xb0, 0xd7) && gb2312)
        return of_class(0.4, 3755);
    if (in(first, 0xd8, 0xf7) && gb2312)
        return of_class(0.03, 3008);
    if (in(first, 0xa1, 0xa3) && gb2312)
        return of_class(0.06, 250);
    return gb2312 && in(first, 0xa4, 0xa9) ? of_class(0.002, 500) : of_class(0.004, 14000);
}

/* Returns the log probability of a cp949 byte pair. KS X 1001 has 2,350 syllables and rare Chinese characters; cp949 adds rare ones. */
static double rate_ks(unsigned first, unsigned second)
{
    bool ks = in(second, 0xa1, 0xfe);
    bool added = in(first, 0x81, 0xc6) && (in(second, 0x41, 0x5a) || in(second, 0x61, 0x7a) || in(second, 0x81, 0xfe));
    if (in(first, 0xb0, 0xc8) && ks)
        return of_class(0.45, 2350);
    if (in(first, 0xca, 0xfd) && ks)
        return of_class(0.005, 4888);
    if (in(first, 0xa1, 0xac) && ks)
        return of_class(0.04, 900);
    return added ? of_class(0.003, 8822) : 0;
}

static double rate_big5(unsigned first, unsigned second)
{
    if (!in(second, 0x40, 0x7e) && !in(second, 0xa1, 0xfe))
        return 0;
    if (in(first, 0xa4, 0xc6))
        return of_class(0.4, 5401);
    if (in(first, 0xc9, 0xf9))
        return of_class(0.02, 7652);
    return in(first, 0xa1, 0xa3) ? of_class(0.06, 400) : 0;
}

/* Returns the log probability of a Shift JIS byte or byte pair. Half-width katakana are one byte; kanji have two frequency levels. */
static double rate_sjis(unsigned first, unsigned second)
{
    if (in(first, 0xa1, 0xdf))
        return second == 0 ? of_class(0.2, 63) : 0;
    if (!in(second, 0x40, 0xfc) || second == 0x7f)
        return 0;
    if (in(first, 0x89, 0x97) || (first == 0x88 && second >= 0x9f) || (first == 0x98 && second <= 0x72))
        return of_class(0.25, 2965);
    if (in(first, 0x82, 0x83))
        return of_class(0.1, 300);
    if (first == 0x81 || first == 0x87)
        return of_class(0.06, 200);
    if (in(first, 0x98, 0x9f) || in(first, 0xe0, 0xea))
        return of_class(0.01, 3390);
    return in(first, 0x84, 0x84) || in(first, 0xed, 0xee) || in(first, 0xfa, 0xfc) ? of_class(0.003, 900) : 0;
}

static double rate_eucjp(unsigned first, unsigned second)
{
    if (first == 0x8e)
        return in(second, 0xa1, 0xdf) ? of_class(0.02, 63) : 0;
    if (!in(second, 0xa1, 0xfe))
        return 0;
    if (in(first, 0xb0, 0xcf))
        return of_class(0.25, 2965);
    if (in(first, 0xa4, 0xa5))
        return of_class(0.1, 170);
    if (in(first, 0xa1, 0xa3))
        return of_class(0.06, 250);
    return in(first, 0xd0, 0xf4) ? of_class(0.01, 3390) : in(first, 0xa6, 0xad) ? of_class(0.003, 500) : 0;
}

static const struct wide_model wide_models[] = {
    { "GB18030", simplified, 0, rate_gb }, { "Shift-JIS", japanese, 0, rate_sjis },   { "EUC-KR", korean, 0, rate_ks },
    { "Big5", traditional, -2, rate_big5 }, { "EUC-JP", japanese, -2, rate_eucjp },
};

/* --- statistical models of one-byte encodings ------------------------------------------------------------------------------- */

struct narrow_model {
    /* letters of the languages that use this encoding: lower, upper: common letters, most frequent first; rare: letters that
       occur rarely */
    const char *name, *lower, *upper, *rare;
    double prior;
    bool latin; /* true: Latin script: words mix the encoding's own letters with ASCII letters */
};

static const char signs[] = "°³²µ«»–—·±№§“”„…’™®½×Ø";
static const char western[] = "üäéöèóíáàñçßêãõúâôåøæîûëïìòù",
                  western_upper[] = "ÄÖÜÉÑÇÅÁÓÍÀÈÊÚÃÕÂÔÎ";
static const char russian[] = "оеаинтсрвлкмдпуяыьгзбчйхжшюцщэфъё",
                  russian_upper[] = "ПНТДРКСВУОАЕИБМГЗЛЦЧЭФХШЩЮЯЖЙЁЬЫЪ";

static const struct narrow_model narrow_models[] = {
    { "Windows-1252", western, western_upper, "œýÿšžðþŒŠŽÝÞÐ¿¡ºª", 0, true },
    { "Windows-1251", russian, russian_upper, "іїєґўІЇЄҐЎђѓќћџљњ", 0, false },
    { "Windows-1250",
      "éáíóěčšžřýůúąęłśżźćńőűťďňöüäßțşăâîđ", "ČŠŽŘÚŁŚŻŹĆŐÁÉÍÓÖÜÄŇĚÝ",
      "ľĺŕôëçĎŤĹĽĄĘŃŰŮ", -2, true },
    { "Windows-1254", "ıüşğçöâîû", "İÜŞÖÇĞ", "éèàäß", -3, true },
    { "Windows-1253",
      "αοιετνσηρκπςμλύίόάήγωδχθέφβξώζψϊ", "ΑΘΠΡΣΔΕΚΛΜΝΟΤΦΓΧΒΗΙΥΩΖΞΨΆΈΉΊΌΎΏ",
      "", -3, false },
    { "KOI8-R", russian, russian_upper, "", -3, false },
    { "CP866", russian, russian_upper, "", -3, false },
    { "CP850", western, western_upper, "", -3, true },
    { "Macintosh", western, western_upper, "", -5, true },
};

enum byte_kind { ASCII_OTHER, ASCII_LOWER, ASCII_UPPER, HIGH_LOWER, HIGH_UPPER, HIGH_SIGN, HIGH_NONE };

struct narrow_table {
    double rate[256]; /* [byte]: log probability of the byte in a text with this encoding; 0 for ASCII bytes */
    enum byte_kind kind[256];
};

typedef void take_encoded(void *data, const unsigned char *bytes, size_t count, int rank);

/* Calls each() for every character of a UTF-8 text that the encoder can convert, with its bytes in the encoding and its index
   in the text (`rank`). */
static void each_encoded(const char *utf8, struct charset_encoder *encoder, take_encoded *each, void *data)
{
    for (int rank = 0; *utf8; rank++) {
        unsigned char bytes[8];
        size_t length = 1;
        while (((unsigned char)utf8[length] & 0xc0) == 0x80)
            length++;
        size_t count = charset_encode(encoder, utf8, length, bytes, sizeof(bytes));
        if (count > 0)
            each(data, bytes, count, rank);
        utf8 += length;
    }
}

struct rates {
    struct narrow_table *table;
    double most, slope;
    enum byte_kind kind;
};

static void set_rate(void *data, const unsigned char *bytes, size_t count, int rank)
{
    const struct rates *rates = data;
    if (count != 1 || bytes[0] < 0x80 || rates->table->kind[bytes[0]] != HIGH_NONE)
        return;
    rates->table->rate[bytes[0]] = rates->most - rates->slope * rank;
    rates->table->kind[bytes[0]] = rates->kind;
}

static void make_table(struct narrow_table *table, const struct narrow_model *model)
{
    double slope = model->latin ? 0.18 : 0.11;
    for (int c = 0; c < 256; c++) {
        table->rate[c] = c < 0x80 ? 0 : -11;
        table->kind[c] = c >= 0x80 ? HIGH_NONE : islower(c) ? ASCII_LOWER : isupper(c) ? ASCII_UPPER : ASCII_OTHER;
    }
    struct charset_encoder *encoder = charset_encoder_open(model->name);
    each_encoded(signs, encoder, set_rate, &(struct rates){ table, -3, 0.25, HIGH_SIGN });
    each_encoded(model->lower, encoder, set_rate, &(struct rates){ table, model->latin ? -1.7 : -2.2, slope, HIGH_LOWER });
    each_encoded(model->upper, encoder, set_rate, &(struct rates){ table, -4, slope, HIGH_UPPER });
    each_encoded(model->rare, encoder, set_rate, &(struct rates){ table, -7, 0.1, HIGH_LOWER });
    charset_encoder_close(encoder);
}

static bool is_letter(enum byte_kind kind)
{
    return kind != ASCII_OTHER && kind != HIGH_SIGN && kind != HIGH_NONE;
}

/* Returns the score that the bytes before and after a high byte (0x80 and above) add to an encoding. */
static double rate_around(const struct narrow_table *table, bool latin, const unsigned char *at, const unsigned char *from,
                          const unsigned char *to)
{
    enum byte_kind before = at > from ? table->kind[at[-1]] : ASCII_OTHER, kind = table->kind[*at],
                   after = at + 1 < to ? table->kind[at[1]] : ASCII_OTHER;
    bool ascii_before = before == ASCII_LOWER || before == ASCII_UPPER, ascii_after = after == ASCII_LOWER || after == ASCII_UPPER;
    double rate = 0;
    if (kind == HIGH_SIGN) {
        bool degrees = at + 1 < to && (at[1] == 'C' || at[1] == 'F');
        return is_letter(before) && is_letter(after) ? -3 : degrees ? 2 : 0;
    }
    if (!is_letter(kind))
        return 0;
    if (kind == HIGH_UPPER && (before == ASCII_LOWER || before == HIGH_LOWER))
        rate -= latin ? 3 : 5;
    if (kind == HIGH_UPPER && (before == HIGH_UPPER || after == HIGH_UPPER))
        rate += 2;
    if (before == HIGH_UPPER && after == HIGH_UPPER && kind == HIGH_LOWER)
        rate -= 3;
    if (latin) {
        rate -= before >= HIGH_LOWER && before <= HIGH_UPPER ? 2 : 0;
        rate -= !ascii_before && !ascii_after ? 1 : 0;
    } else {
        rate -= ascii_before || ascii_after ? 3 : 0;
    }
    return rate;
}

/* Returns the log probability of a text's high bytes (0x80 and above), if the text has the one-byte encoding of this model. */
static double score_narrow(const struct narrow_model *model, const unsigned char *at, size_t count)
{
    struct narrow_table table;
    const unsigned char *from = at, *to = at + count;
    double score = model->prior;
    size_t ascii_lower = 0;
    make_table(&table, model);
    for (; at < to; at++)
        if (*at >= 0x80)
            score += table.rate[*at] + rate_around(&table, model->latin, at, from, to);
        else
            ascii_lower += islower(*at) != 0;
    return model->latin ? score : score - fmin(5, 0.4 * (double)ascii_lower);
}

struct frequent {
    uint64_t pairs[65536 / 64];
    int count;
};

static void add_frequent(void *data, const unsigned char *bytes, size_t count, int rank)
{
    struct frequent *set = data;
    unsigned pair = count == 2 ? (unsigned)bytes[0] << 8 | bytes[1] : 0;
    (void)rank;
    if (count == 2 && !(set->pairs[pair / 64] >> pair % 64 & 1)) {
        set->pairs[pair / 64] |= (uint64_t)1 << pair % 64;
        set->count++;
    }
}

/* Returns a penalty for a two-byte character that stands next to lower-case ASCII letters: the two bytes are then more likely
   two letters of a one-byte encoding. */
static double rate_beside(unsigned before, unsigned after)
{
    return (islower(before) ? -2.5 : 0) + (islower(after) ? -2.5 : 0);
}

static double score_wide(const struct wide_model *model, const unsigned char *at, size_t count)
{
    enum { DAMAGED = -18 };
    const unsigned char *to = at + count;
    unsigned before = 0; /* value of the ASCII byte just before the current high bytes (0x80 and above); 0: there is none */
    struct frequent *set = mem_new(sizeof(*set));
    double score = model->prior;
    struct charset_encoder *encoder = charset_encoder_open(model->name);
    each_encoded(model->frequent, encoder, add_frequent, set);
    charset_encoder_close(encoder);
    double frequent = of_class(0.5, set->count);
    while (at < to) {
        unsigned first = *at, second = at + 1 < to ? at[1] : 0, pair = first << 8 | second;
        if (first < 0x80) {
            before = *at++;
            continue;
        }
        double alone = model->rate(first, 0), rate = alone < 0 ? alone : model->rate(first, second);
        size_t length = alone < 0 || rate >= 0 ? 1 : 2;
        if (length == 2 && set->pairs[pair / 64] >> pair % 64 & 1)
            rate = frequent;
        if (length == 2 && second < 0x80)
            /* A one-byte model scores only bytes from 0x80 on. The second byte here is below 0x80, so a one-byte model would
               score one byte and this model two. The constant compensates for that. */
            rate += 3;
        if (length == 1 && rate >= 0 && model->rate == rate_gb && in(second, 0x30, 0x39) && at + 3 < to && in(at[3], 0x30, 0x39)) {
            length = 4; /* GB 18030 encodes a character that GBK lacks in four bytes, of which the second and the fourth are digits */
            rate = -14;
        }
        score += rate < 0 ? rate + rate_beside(before, at + length < to ? at[length] : 0) : DAMAGED;
        at += length;
        before = 0;
    }
    mem_free(set);
    return score;
}

/* --- choosing an encoding ----------------------------------------------------------------------------------------------------- */

/* Copies the parts of the lines that contain high bytes (0x80 and above), at most SAMPLE_BYTES. Returns their length. */
static size_t take_sample(const char *bytes, size_t count, char sample[SAMPLE_BYTES])
{
    size_t taken = 0;
    for (size_t at = 0, end; at < count && taken + MAX_LINE < SAMPLE_BYTES; at = end + 1) {
        const char *found = memchr(bytes + at, '\n', count - at);
        end = found ? (size_t)(found - bytes) : count;
        size_t first = at, length;
        while (first < end && !((unsigned char)bytes[first] & 0x80))
            first++;
        if (first == end)
            continue;
        length = end - first < MAX_LINE - 2 ? end - first : MAX_LINE - 2;
        if (first > at) {
            first--; /* lets the sample begin with the letter before the high bytes */
            length++;
        }
        memcpy(sample + taken, bytes + first, length);
        taken += length;
        sample[taken++] = '\n';
    }
    return taken;
}

/* Writes our name of the encoding that uchardet proposes; "" if it proposes none or one that we do not know. */
static void ask_uchardet(const char *sample, size_t count, char name[CHARSET_NAME_BYTES])
{
    uchardet_t detector = uchardet_new();
    name[0] = 0;
    if (uchardet_handle_data(detector, sample, count) == 0) {
        uchardet_data_end(detector);
        const char *found = uchardet_get_charset(detector);
        if (!charset_resolve(!strcmp(found, "ISO-8859-2")   ? "Windows-1250"
                             : !strcmp(found, "ISO-8859-15") ? "Windows-1252"
                             : !strcmp(found, "ISO-8859-7")  ? "Windows-1253"
                             : !strcmp(found, "ISO-8859-5")  ? "Windows-1251"
                                                             : found,
                             name))
            name[0] = 0;
    }
    uchardet_delete(detector);
}

static bool says_the_same(const char *sample, size_t count, const char *a, const char *b)
{
    char *first = charset_convert(sample, count, a, NULL), *second = charset_convert(sample, count, b, NULL);
    bool same = !strcmp(first, second);
    mem_free(first);
    mem_free(second);
    return same;
}

static struct charset_choice find_legacy(const char *bytes, size_t count)
{
    enum { WIDE = sizeof(wide_models) / sizeof(*wide_models), NARROW = sizeof(narrow_models) / sizeof(*narrow_models) };
    static const double vote = 2.5, sure = 3;
    struct charset_choice choice = { "Windows-1252", "", false };
    char *sample = mem_array(SAMPLE_BYTES, 1), voted[CHARSET_NAME_BYTES];
    size_t length = take_sample(bytes, count, sample);
    const char *names[WIDE + NARROW];
    double scores[WIDE + NARROW];
    int best = 0, second = -1;
    ask_uchardet(sample, length, voted);
    for (int i = 0; i < WIDE + NARROW; i++) {
        const unsigned char *at = (const unsigned char *)sample;
        names[i] = i < WIDE ? wide_models[i].name : narrow_models[i - WIDE].name;
        scores[i] = i < WIDE ? score_wide(&wide_models[i], at, length) : score_narrow(&narrow_models[i - WIDE], at, length);
        scores[i] += !strcmp(names[i], voted) ? vote : 0;
        if (scores[i] > scores[best])
            best = i;
    }
    for (int i = 0; i < WIDE + NARROW; i++)
        if (i != best && scores[best] - scores[i] < sure && (second < 0 || scores[i] > scores[second]) &&
            !says_the_same(sample, length, names[best], names[i]))
            second = i;
    snprintf(choice.name, sizeof(choice.name), "%s", names[best]);
    if (second >= 0)
        snprintf(choice.other, sizeof(choice.other), "%s", names[second]);
    mem_free(sample);
    return choice;
}

/* --- detecting byte order marks, UTF-8 and UTF-16 ------------------------------------------------------------------------------ */

/* Returns the number of valid UTF-8 characters beyond ASCII, and sets *invalid to the number of invalid bytes. */
static size_t count_utf8(const char *bytes, size_t count, size_t *invalid)
{
    size_t characters = 0;
    *invalid = 0;
    for (size_t i = 0; i < count;) {
        size_t length = (unsigned char)bytes[i] < 0x80 ? 1 : utf8_length(bytes + i, count - i);
        characters += length > 1;
        *invalid += length == 0;
        i += length ? length : 1;
    }
    return characters;
}

/* Detects UTF-16 without a byte order mark: digits, separators and line ends contain a zero byte, either always at odd or
   always at even positions. Returns the name of the encoding, or NULL. */
static const char *find_utf16(const char *bytes, size_t count)
{
    size_t zeros[2] = { 0 }, looked_at = (count < 65536 ? count : 65536) & ~(size_t)1;
    for (size_t i = 0; i < looked_at; i++)
        zeros[i % 2] += bytes[i] == 0;
    for (int odd = 0; odd < 2; odd++)
        if (zeros[odd] * 40 > looked_at && zeros[odd] > 16 * zeros[!odd])
            return odd ? "UTF-16LE" : "UTF-16BE";
    return NULL;
}

static const char *find_mark(const char *bytes, size_t count, size_t *mark_bytes)
{
    static const struct {
        const char *name, *mark;
        size_t bytes;
    } marks[] = { { "UTF-8", "\xef\xbb\xbf", 3 }, { "UTF-16LE", "\xff\xfe", 2 }, { "UTF-16BE", "\xfe\xff", 2 } };
    for (size_t i = 0; i < sizeof(marks) / sizeof(*marks); i++)
        if (count >= marks[i].bytes && !memcmp(bytes, marks[i].mark, marks[i].bytes)) {
            *mark_bytes = marks[i].bytes;
            return marks[i].name;
        }
    *mark_bytes = 0;
    return NULL;
}

static bool has_escape(const char *bytes, size_t count)
{
    return memmem(bytes, count, "\x1b$B", 3) || memmem(bytes, count, "\x1b$@", 3);
}

struct charset_choice charset_find(const char *bytes, size_t count)
{
    struct charset_choice choice = { "UTF-8", "", false };
    size_t mark, invalid, characters;
    const char *name = find_mark(bytes, count, &mark);
    if (!name)
        name = find_utf16(bytes, count);
    if (!name) {
        characters = count_utf8(bytes, count, &invalid);
        choice.ascii = characters == 0 && invalid == 0;
        if (choice.ascii && has_escape(bytes, count))
            name = "ISO-2022-JP";
        /* treats a text with few invalid bytes as UTF-8, because it may be a damaged or truncated UTF-8 text */
        else if (invalid * 4 > characters)
            return find_legacy(bytes, count);
    }
    if (name) {
        snprintf(choice.name, sizeof(choice.name), "%s", name);
        choice.ascii = false;
    }
    return choice;
}

void charset_decode(const char *bytes, size_t count, const char *encoding, struct charset_text *out)
{
    size_t mark;
    const char *marked = find_mark(bytes, count, &mark);
    *out = (struct charset_text){ 0 };
    if (!encoding)
        out->encoding = charset_find(bytes, count);
    else
        charset_resolve(encoding, out->encoding.name);
    if (!marked || strcmp(marked, out->encoding.name) != 0)
        mark = 0;
    out->utf8 = charset_convert(bytes + mark, count - mark, out->encoding.name, &out->damaged);
    out->length = strlen(out->utf8);
}
