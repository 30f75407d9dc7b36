/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the file format of a film. An MP4 file consists of boxes: length, type and content, with big-endian numbers. A table
   lists the allowed boxes and their content. */
#include "film_boxes.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>

#include "base/mem.h"

#define FAIL(...) (snprintf(why, FILM_BOXES_WHY_BYTES, __VA_ARGS__), false)
enum { HEAD = 8 };
static const size_t MAX_MOOV_BYTES = (size_t)256 << 20;

/* One allowed box. Its content is given in hexadecimal digits; '?': any digit; 'W', 'H': the four digits of width and height in pixels; '*'
   at the end: any further bytes. `children`: offset of the child boxes in the content; 0: the box has no children. */
struct box_rule {
    const char *type, *parent, *content;
    size_t children;
    bool required;
};

#define ZEROS_8 "0000000000000000"
#define IDENTITY "00010000" ZEROS_8 "00000000" "00010000" ZEROS_8 "00000000" "40000000"
#define ANY_8 "????????????????"
#define ANY_32 ANY_8 ANY_8 ANY_8 ANY_8

static const struct box_rule rules[] = {
    { "ftyp", "", "*", 0, true },
    { "free", "", "", 0, false },
    { "wide", "", "", 0, false },
    { "mdat", "", NULL, 0, true }, /* samples: checked by film_units_plain() */
    { "moov", "", "*", HEAD, true },
    { "mvhd", "moov", "00000000" ANY_8 ANY_8 "00010000" "0100" "0000" ZEROS_8 IDENTITY ZEROS_8 ZEROS_8 ZEROS_8 "????????", 0, true },
    { "udta", "moov", "*", HEAD, true },
    { "meta", "udta", "00000000" "00000021" "68646c72" ZEROS_8 "6d647461" "*", 0, true }, /* named metadata texts: the statements */
    { "trak", "moov", "*", HEAD, true },
    { "tkhd", "trak", "00000003" ANY_8 ANY_8 "????????" ZEROS_8 "0000" "0000" "0000" "0000" IDENTITY "WWWW0000HHHH0000", 0, true },
    { "edts", "trak", "*", HEAD, false },
    { "elst", "edts", "00000000" "00000001" ANY_8 "00010000", 0, false },
    { "mdia", "trak", "*", HEAD, true },
    { "mdhd", "mdia", "00000000" ANY_8 ANY_8 "????????", 0, true },
    { "hdlr", "mdia", "00000000" "????????" "76696465" "*", 0, true },
    { "minf", "mdia", "*", HEAD, true },
    { "vmhd", "minf", "00000001" ZEROS_8, 0, true },
    { "hdlr", "minf", "00000000" "????????" "75726c20" "*", 0, false },
    { "dinf", "minf", "*", HEAD, true },
    { "dref", "dinf", "00000000" "00000001" "0000000c" "75726c20" "00000001", 0, true }, /* a data reference saying that the film's
                                                                                            samples are in this file */
    { "stbl", "minf", "*", HEAD, true },
    { "stsd", "stbl", "00000000" "00000001" "*", HEAD + 8, true },
    { "avc1", "stsd", "000000000000" "0001" "????????" ANY_8 "????????" "WWWWHHHH" "00480000" "00480000" "00000000" "0001" ANY_32
      "0018ffff" "*", HEAD + 78, true },
    { "avcC", "avc1", "01??????" "ff" "e1" "*", 0, true },
    /* colour information in one of two allowed forms: nclx in MP4 files, nclc in MOV files */
    { "colr", "avc1", "6e636c78" "0001" "000d" "0000" "80|" "6e636c63" "0001" "000d" "0000", 0, true },
    { "pasp", "avc1", "0000000100000001", 0, false },
    { "btrt", "avc1", "*", 0, false },
    { "stts", "stbl", "*", 0, true },
    { "ctts", "stbl", "*", 0, false },
    { "stss", "stbl", "*", 0, false },
    { "sdtp", "stbl", "*", 0, false },
    { "stsc", "stbl", "*", 0, true },
    { "stsz", "stbl", "*", 0, true },
    { "stco", "stbl", "*", 0, false },
    { "co64", "stbl", "*", 0, false },
};
enum { RULES = sizeof(rules) / sizeof(*rules) };

struct box_walk {
    struct film_size size;
    bool seen[RULES];
    char *why;
};

static uint64_t number(const uint8_t *at, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++)
        value = value << 8 | at[i];
    return value;
}

/* --- content ------------------------------------------------------------------------------------------------------------------- */

static unsigned nibble(const uint8_t *bytes, size_t i)
{
    return i % 2 ? bytes[i / 2] & 15 : bytes[i / 2] >> 4;
}

static bool digit_fits(const struct box_walk *walk, char expected, size_t run, unsigned value)
{
    unsigned size = (unsigned)(expected == 'W' ? walk->size.width_px : walk->size.height_px);
    if (expected == 'W' || expected == 'H')
        return value == (size >> (12 - 4 * (run % 4)) & 15);
    return expected == '?' || value == (unsigned)(isdigit((unsigned char)expected) ? expected - '0' : expected - 'a' + 10);
}

/* Returns true if the content equals one of the alternatives in `expected`, separated by '|'. */
static bool content_fits(const struct box_walk *walk, const char *expected, const uint8_t *bytes, size_t count)
{
    size_t i = 0, run = 0;
    for (; *expected && *expected != '*' && *expected != '|' && i < 2 * count; expected++, i++) {
        if (!digit_fits(walk, *expected, run, nibble(bytes, i)))
            break;
        run = *expected == 'W' || *expected == 'H' ? run + 1 : 0;
    }
    if (*expected == '*' || ((!*expected || *expected == '|') && i == 2 * count))
        return true;
    const char *other = strchr(expected, '|');
    return other && content_fits(walk, other + 1, bytes, count);
}

/* --- boxes --------------------------------------------------------------------------------------------------------------------- */

/* Returns the index in `rules` (table of allowed boxes) of the rule for a box of this type in this parent box; RULES: there is none, so the
   box is not allowed. */
static int find_rule(const char *parent, const uint8_t *type)
{
    int i = 0;
    while (i < RULES && !(memcmp(rules[i].type, type, 4) == 0 && strcmp(rules[i].parent, parent) == 0))
        i++;
    return i;
}

/* Returns true if an H.264 decoder configuration (ISO/IEC 14496-15, 5.3.3.1) has one sequence and one picture parameter set, and no
   extension of the sequence parameter set. */
static bool has_two_sets(const uint8_t *at, size_t count)
{
    enum { SETS = 6, FORMATS = 4 };
    size_t end = SETS + 2, picture = count >= end ? end + (size_t)number(at + SETS, 2) : count;
    if (picture + 3 > count || (at[5] & 31) != 1 || at[picture] != 1)
        return false;
    end = picture + 3 + (size_t)number(at + picture + 1, 2);
    return end == count || (end + FORMATS == count && at[count - 1] == 0);
}

/* Checks one box against rules[rule], its entry in the table of allowed boxes; RULES: the table has no entry, which is an error. Each box
   may occur once. content: the box's content of `count` bytes; NULL: not read. Returns false with the reason in walk->why. */
static bool take_box(struct box_walk *walk, int rule, const uint8_t *type, const char *parent, const uint8_t *content, size_t count)
{
    char *why = walk->why, name[5] = "";
    for (int i = 0; i < 4; i++)
        name[i] = type[i] > ' ' && type[i] < 0x7f ? (char)type[i] : '?';
    const char *place = *parent ? parent : "the file";
    if (rule == RULES)
        return FAIL("the clip was changed, or not made by `plantcast clip --signed`: unexpected MP4 box %s in %s", name, place);
    if (walk->seen[rule])
        return FAIL("the clip was changed after it was signed: MP4 box %s occurs twice in %s", name, place);
    walk->seen[rule] = true;
    if (memcmp(type, "avcC", 4) == 0 && !has_two_sets(content, count))
        return FAIL("the clip was changed after it was signed: MP4 box avcC has more than one sequence or picture parameter set");
    return !rules[rule].content || content_fits(walk, rules[rule].content, content, count) ||
           FAIL("the clip was changed after it was signed: MP4 box %s has contents that Plantcast never writes", name);
}

/* Reads the picture's size from the innermost box, avc1. All other boxes must have the same size. */
static void learn_size(struct box_walk *walk, const uint8_t *moov, size_t count)
{
    for (size_t i = 4; i + 32 <= count; i++)
        if (memcmp(moov + i, "avc1", 4) == 0) {
            walk->size.width_px = (int)number(moov + i + 28, 2);
            walk->size.height_px = (int)number(moov + i + 30, 2);
            return;
        }
}

static bool take_boxes(struct box_walk *walk, const char *parent, const uint8_t *bytes, size_t count)
{
    char *why = walk->why;
    while (count >= HEAD) {
        uint64_t length = number(bytes, 4);
        if (length < HEAD || length > count)
            return FAIL("the clip is damaged: a box within MP4 box %s has an invalid length", parent);
        int rule = find_rule(parent, bytes + 4);
        if (!take_box(walk, rule, bytes + 4, parent, bytes + HEAD, length - HEAD))
            return false;
        size_t children = rules[rule].children;
        if (children && (length < children || !take_boxes(walk, rules[rule].type, bytes + children, length - children)))
            return length >= children ? false : FAIL("the clip is damaged: MP4 box %s is too short", rules[rule].type);
        bytes += length;
        count -= length;
    }
    return count == 0 || FAIL("the clip is damaged: bytes follow the last box within MP4 box %s", parent);
}

static bool take_moov(struct box_walk *walk, FILE *file, uint64_t count)
{
    char *why = walk->why;
    uint8_t *moov = count <= MAX_MOOV_BYTES ? mem_try_array(count + 1, 1) : NULL;
    bool good = moov && fread(moov, 1, count, file) == count;
    if (good) {
        learn_size(walk, moov, count);
        good = take_boxes(walk, "moov", moov, count);
    } else {
        good = FAIL("the clip is damaged: MP4 box moov is truncated or too long");
    }
    mem_free(moov);
    return good;
}

/* Checks one top-level box of the file. Skips the content of the box mdat unread, because it may be as large as the disk.
   Returns false with the reason in walk->why. */
static bool take_outer(struct box_walk *walk, FILE *file, uint64_t *left)
{
    char *why = walk->why;
    uint8_t head[HEAD] = { 0 }, longer[HEAD];
    uint64_t head_bytes = HEAD, length = fread(head, 1, HEAD, file) == HEAD ? number(head, 4) : 0;
    if (length == 1 && fread(longer, 1, HEAD, file) == HEAD) {
        length = number(longer, 8);
        head_bytes = 2 * HEAD;
    }
    if (length < head_bytes || length > *left)
        return FAIL("the clip is damaged: an MP4 box is truncated, or bytes follow the last one");
    *left -= length;
    length -= head_bytes;
    int rule = find_rule("", head + 4);
    if (!take_box(walk, rule, head + 4, "", NULL, rule < RULES && rules[rule].content && !*rules[rule].content ? (size_t)length : 0))
        return false;
    if (memcmp(head + 4, "moov", 4) == 0)
        return take_moov(walk, file, length);
    return fseeko(file, (off_t)length, SEEK_CUR) == 0 || FAIL("cannot be read");
}

static bool has_all(const struct box_walk *walk)
{
    char *why = walk->why;
    for (int i = 0; i < RULES; i++)
        if (rules[i].required && !walk->seen[i])
            return FAIL("the clip is damaged, or not made by `plantcast clip --signed`: MP4 box %s is missing", rules[i].type);
    return true;
}

bool film_boxes_plain(const char *path, struct film_size *size, char why[FILM_BOXES_WHY_BYTES])
{
    struct box_walk walk = { .why = why };
    FILE *file = fopen(path, "rb");
    bool good = file && fseeko(file, 0, SEEK_END) == 0;
    if (!good)
        snprintf(why, FILM_BOXES_WHY_BYTES, "cannot be read: %m");
    uint64_t left = good ? (uint64_t)ftello(file) : 0;
    if (good)
        rewind(file);
    while (good && left > 0)
        good = take_outer(&walk, file, &left);
    if (file)
        fclose(file);
    *size = walk.size;
    return good && has_all(&walk);
}

/* --- units of H.264 ------------------------------------------------------------------------------------------------------------ */

enum { UNIT_SLICE = 1, UNIT_SLICE_OF_KEY = 5, UNIT_MESSAGE = 6, MESSAGE_TEXT = 5, MESSAGE_RECOVERY = 6 };

/* Returns true if a NAL unit has exactly one SEI message, of a type that does not change the picture. A message is its type,
   its length and its content. Type and length are each encoded as bytes of 255 and a last byte; the sum of these bytes is the
   number. Units with several messages are refused, because encoders write one message per unit. */
static bool is_plain_message(const uint8_t *unit, size_t count, char why[FILM_BOXES_WHY_BYTES])
{
    unsigned type = 0;
    size_t i = 1;
    while (i < count && unit[i] == 255)
        type += unit[i++];
    type += i < count ? unit[i++] : 0;
    size_t length = 0, zeros = 0, content = 0, last = 0;
    while (i < count && unit[i] == 255)
        length += unit[i++];
    length += i < count ? unit[i++] : 0;
    /* does not count a byte 3 after two zero bytes: H.264 inserts such bytes (emulation prevention), and they are not content */
    for (; i < count; i++) {
        bool is_filler = zeros >= 2 && unit[i] == 3;
        zeros = unit[i] == 0 ? zeros + 1 : 0;
        content += !is_filler;
        last = unit[i];
    }
    if (type != MESSAGE_TEXT && type != MESSAGE_RECOVERY)
        return FAIL("the clip was changed after it was signed: it has an H.264 message (SEI) of type %u, which Plantcast never writes",
                    type);
    return (content == length + 1 && last == 0x80) ||
           FAIL("the clip was changed after it was signed: an H.264 NAL unit has more than one message (SEI)");
}

bool film_units_plain(const uint8_t *sample, size_t count, char why[FILM_BOXES_WHY_BYTES])
{
    while (count > 4) {
        uint64_t length = number(sample, 4);
        if (length < 1 || length > count - 4)
            return FAIL("the clip is damaged: an H.264 NAL unit has an invalid length");
        int type = sample[4] & 31;
        if (type == UNIT_MESSAGE && !is_plain_message(sample + 4, length, why))
            return false;
        if (type != UNIT_SLICE && type != UNIT_SLICE_OF_KEY && type != UNIT_MESSAGE)
            return FAIL("the clip was changed, or not made by `plantcast clip --signed`: unexpected H.264 NAL unit of type %d", type);
        sample += 4 + length;
        count -= 4 + length;
    }
    return count == 0 || FAIL("the clip is damaged: an H.264 NAL unit has an invalid length");
}
