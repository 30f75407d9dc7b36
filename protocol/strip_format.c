/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes and decodes the description of the colour scale that the legend strip contains as a code of dark and light cells,
   with Reed-Solomon over GF(256) (polynomial 0x11d, first root alpha^0). */
#include "protocol/strip_format.h"

#include <math.h>
#include <string.h>

enum { VERSION = 1, AT_FLAGS = 1, AT_MIN = 2, AT_MAX = 6, AT_GROUP = 10, AT_UNIT = AT_GROUP + STRIP_GROUP, AT_CRC = AT_UNIT + STRIP_UNIT };
enum { FLAG_LOG = 1, SHOW_SHIFT = 1, SHOW_MASK = 7 };
enum { FIELD = 255, POLYNOMIAL = 0x11d };

/* --- arithmetic in the finite field of 256 elements, GF(256) ------------------------------------------------------------------ */

static uint8_t times(uint8_t a, uint8_t b)
{
    unsigned product = 0;
    for (int bit = 7; bit >= 0; bit--) {
        product = product << 1 ^ (product & 0x80 ? POLYNOMIAL : 0);
        product ^= b >> bit & 1 ? a : 0;
    }
    return (uint8_t)product;
}

static uint8_t power(int exponent)
{
    uint8_t x = 1;
    for (exponent %= FIELD; exponent > 0; exponent--)
        x = times(x, 2);
    return x;
}

static uint8_t inverse(uint8_t a)
{
    uint8_t x = 1;
    for (int i = 0; i < FIELD - 1; i++)
        x = times(x, a);
    return x;
}

/* Evaluates a polynomial of `count` coefficients over GF(256) at x; polynomial[0] is the constant term. */
static uint8_t value_at(const uint8_t *polynomial, int count, uint8_t x)
{
    uint8_t sum = 0;
    for (int i = count - 1; i >= 0; i--)
        sum = times(sum, x) ^ polynomial[i];
    return sum;
}

/* --- Reed-Solomon ------------------------------------------------------------------------------------------------------------- */

/* Computes the Reed-Solomon parity bytes: the remainder when the contents, as a polynomial, are divided by the generator polynomial.
   code[0] is the coefficient of the highest power. */
static void add_parity(uint8_t code[STRIP_BYTES])
{
    uint8_t generator[STRIP_PARITY + 1] = { 1 }, rest[STRIP_PARITY] = { 0 }; /* highest coefficient first */
    for (int i = 0; i < STRIP_PARITY; i++)
        for (int j = i + 1; j > 0; j--)
            generator[j] ^= times(generator[j - 1], power(i));
    for (int i = 0; i < STRIP_DATA; i++) {
        uint8_t lead = code[i] ^ rest[0];
        memmove(rest, rest + 1, STRIP_PARITY - 1);
        rest[STRIP_PARITY - 1] = 0;
        for (int j = 0; j < STRIP_PARITY; j++)
            rest[j] ^= times(generator[j + 1], lead);
    }
    memcpy(code + STRIP_DATA, rest, STRIP_PARITY);
}

static bool find_syndromes(const uint8_t code[STRIP_BYTES], uint8_t syndromes[STRIP_PARITY])
{
    bool wrong = false;
    for (int i = 0; i < STRIP_PARITY; i++) {
        uint8_t sum = 0, x = power(i);
        for (int j = 0; j < STRIP_BYTES; j++)
            sum = times(sum, x) ^ code[j];
        syndromes[i] = sum;
        wrong |= sum != 0;
    }
    return wrong;
}

/* Finds the error locator, the polynomial whose roots give the positions of wrong bytes (Berlekamp-Massey). Returns its degree. */
static int find_locator(const uint8_t syndromes[STRIP_PARITY], uint8_t locator[STRIP_PARITY + 1])
{
    uint8_t before[STRIP_PARITY + 1] = { 1 }, kept[STRIP_PARITY + 1], last = 1;
    int degree = 0, gap = 1;
    memset(locator, 0, STRIP_PARITY + 1);
    locator[0] = 1;
    for (int n = 0; n < STRIP_PARITY; n++) {
        uint8_t off = syndromes[n];
        for (int i = 1; i <= degree; i++)
            off ^= times(locator[i], syndromes[n - i]);
        if (off == 0) {
            gap++;
            continue;
        }
        memcpy(kept, locator, sizeof(kept));
        uint8_t factor = times(off, inverse(last));
        for (int i = gap; i <= STRIP_PARITY; i++)
            locator[i] ^= times(factor, before[i - gap]);
        if (2 * degree <= n) {
            degree = n + 1 - degree;
            memcpy(before, kept, sizeof(before));
            last = off;
            gap = 1;
        } else {
            gap++;
        }
    }
    return degree;
}

/* Corrects wrong bytes in a code that was read from a picture's legend strip. Returns their number; -1: too many are wrong, and
   the code may have been changed. */
static int correct_errors(uint8_t code[STRIP_BYTES])
{
    uint8_t syndromes[STRIP_PARITY], locator[STRIP_PARITY + 1], evaluator[STRIP_PARITY] = { 0 }, slope[STRIP_PARITY] = { 0 };
    if (!find_syndromes(code, syndromes))
        return 0;
    int degree = find_locator(syndromes, locator), found = 0;
    if (degree > STRIP_PARITY / 2)
        return -1;
    for (int i = 0; i < STRIP_PARITY; i++)
        for (int j = 0; j <= i && j <= degree; j++)
            evaluator[i] ^= times(syndromes[i - j], locator[j]);
    for (int i = 1; i <= degree; i += 2)
        slope[i - 1] = locator[i];
    for (int i = 0; i < STRIP_BYTES; i++) { /* Chien search for the wrong positions, and Forney's formula for the right values */
        int exponent = STRIP_BYTES - 1 - i;
        uint8_t x = power(exponent), back = power(FIELD - exponent);
        if (value_at(locator, degree + 1, back) != 0)
            continue;
        uint8_t below = value_at(slope, STRIP_PARITY, back);
        if (below == 0)
            return -1;
        code[i] ^= times(x, times(value_at(evaluator, STRIP_PARITY, back), inverse(below)));
        found++;
    }
    return found == degree && !find_syndromes(code, syndromes) ? found : -1;
}

/* --- contents ----------------------------------------------------------------------------------------------------------------- */

static uint16_t crc16(const uint8_t *bytes, int count) /* CRC-16/CCITT */
{
    unsigned crc = 0xffff;
    for (int i = 0; i < count; i++) {
        crc ^= (unsigned)bytes[i] << 8;
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1;
    }
    return (uint16_t)crc;
}

static void put_float(uint8_t *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(bits >> 8 * i);
}

static float get_float(const uint8_t *from)
{
    float value;
    uint32_t bits = (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

/* Copies as many whole UTF-8 characters of the text as fit into `room` bytes. */
static void put_text(uint8_t *to, int room, const char *text)
{
    int length = (int)strnlen(text, (size_t)room + 1);
    if (length > room)
        for (length = room; length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80;)
            length--;
    memcpy(to, text, (size_t)length);
}

void strip_encode(const struct strip *strip, uint8_t code[STRIP_BYTES])
{
    memset(code, 0, STRIP_BYTES);
    code[0] = VERSION;
    code[AT_FLAGS] = (uint8_t)((strip->log ? FLAG_LOG : 0) | (strip->show & SHOW_MASK) << SHOW_SHIFT);
    put_float(code + AT_MIN, strip->min);
    put_float(code + AT_MAX, strip->max);
    put_text(code + AT_GROUP, STRIP_GROUP, strip->group);
    put_text(code + AT_UNIT, STRIP_UNIT, strip->unit);
    uint16_t crc = crc16(code, AT_CRC);
    code[AT_CRC] = (uint8_t)crc;
    code[AT_CRC + 1] = (uint8_t)(crc >> 8);
    add_parity(code);
}

bool strip_decode(const uint8_t code[STRIP_BYTES], struct strip *strip, int *mended)
{
    uint8_t own[STRIP_BYTES];
    memcpy(own, code, sizeof(own));
    *mended = correct_errors(own);
    uint16_t crc = crc16(own, AT_CRC);
    if (*mended < 0 || own[0] != VERSION || own[AT_CRC] != (uint8_t)crc || own[AT_CRC + 1] != (uint8_t)(crc >> 8))
        return false;
    *strip = (struct strip){ .min = get_float(own + AT_MIN),
                             .max = get_float(own + AT_MAX),
                             .log = own[AT_FLAGS] & FLAG_LOG,
                             .show = own[AT_FLAGS] >> SHOW_SHIFT & SHOW_MASK };
    memcpy(strip->group, own + AT_GROUP, STRIP_GROUP);
    memcpy(strip->unit, own + AT_UNIT, STRIP_UNIT);
    return isfinite(strip->min) && isfinite(strip->max) && strip->min < strip->max && (!strip->log || strip->min > 0);
}

/* --- cells -------------------------------------------------------------------------------------------------------------------- */

bool strip_finder_dark(int column)
{
    return column == 1 || (column >= 3 && column <= 5) || column == 7;
}

bool strip_cell_dark(const uint8_t code[STRIP_BYTES], int row, int column)
{
    int bit = row * STRIP_INNER + column;
    return bit < 8 * STRIP_BYTES ? code[bit / 8] >> (7 - bit % 8) & 1 : (row + column) % 2; /* unused cells form a chequerboard */
}

void strip_set_cell(uint8_t code[STRIP_BYTES], int row, int column, bool dark)
{
    int bit = row * STRIP_INNER + column;
    if (bit < 8 * STRIP_BYTES && dark)
        code[bit / 8] |= (uint8_t)(1 << (7 - bit % 8));
}
