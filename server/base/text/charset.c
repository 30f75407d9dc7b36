/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Knows the names of encodings, and converts texts with iconv. */
#include "base/text/charset.h"

#include <ctype.h>
#include <errno.h>
#include <iconv.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

static const char replacement[] = "\xef\xbf\xbd";

/* --- names ------------------------------------------------------------------------------------------------------------------ */

/* Encodings. `name`: our name of the encoding; `iconv_name`: its name in iconv; `written`: further names, in lower case without
   punctuation, separated by blanks. */
static const struct {
    const char *name, *iconv_name, *written;
} known[] = {
    { "UTF-8", "UTF-8", " utf8 unicodeutf8 unicode cp65001 65001 " },
    { "UTF-16LE", "UTF-16LE", " utf16le utf16 ucs2 ucs2le unicodelittleendian " },
    { "UTF-16BE", "UTF-16BE", " utf16be ucs2be unicodebigendian " },
    { "GB18030", "GB18030", " gb18030 gbk gb2312 euccn cp936 ms936 936 windows936 chinese simplifiedchinese chinesegbk " },
    { "Big5", "CP950", " big5 cp950 ms950 950 windows950 traditionalchinese " },
    { "Shift-JIS", "CP932", " shiftjis sjis cp932 ms932 932 windows932 windows31j japanese " },
    { "EUC-JP", "EUC-JP-MS", " eucjp eucjpms ujis " },
    { "EUC-KR", "CP949", " euckr cp949 ms949 949 windows949 uhc ksc5601 kscks5601 ksx1001 korean " },
    { "ISO-2022-JP", "ISO-2022-JP", " iso2022jp jis " },
    { "Windows-1250", "CP1250", " windows1250 win1250 cp1250 1250 ansi1250 centraleuropean " },
    { "Windows-1251", "CP1251", " windows1251 win1251 cp1251 1251 ansi1251 cyrillic russian " },
    { "Windows-1252", "CP1252", " windows1252 win1252 cp1252 1252 ansi1252 ansi latin1 isolatin1 iso88591 western " },
    { "Windows-1253", "CP1253", " windows1253 win1253 cp1253 1253 ansi1253 greek " },
    { "Windows-1254", "CP1254", " windows1254 win1254 cp1254 1254 ansi1254 turkish iso88599 latin5 " },
    { "KOI8-R", "KOI8-R", " koi8r koi8 " },
    { "CP866", "CP866", " cp866 ibm866 866 dos866 " },
    { "CP850", "CP850", " cp850 ibm850 850 dos850 " },
    { "Macintosh", "MACINTOSH", " macintosh macroman mac " },
};
enum { KNOWN = sizeof(known) / sizeof(*known) };

static const char *iconv_name_of(const char *name)
{
    for (int i = 0; i < KNOWN; i++)
        if (!strcmp(known[i].name, name))
            return known[i].iconv_name;
    return name;
}

static bool is_convertible(const char *iconv_name)
{
    iconv_t converter = iconv_open("UTF-8", iconv_name);
    if (converter == (iconv_t)-1)
        return false;
    iconv_close(converter);
    return true;
}

bool charset_resolve(const char *written, char name[CHARSET_NAME_BYTES])
{
    char key[CHARSET_NAME_BYTES + 2] = " ";
    size_t length = 1;
    bool good = false;
    for (const char *c = written; *c && length < CHARSET_NAME_BYTES; c++)
        if (isalnum((unsigned char)*c))
            key[length++] = (char)tolower((unsigned char)*c);
    key[length] = ' ';
    key[length + 1] = 0;
    for (int i = 0; i < KNOWN && !good; i++)
        if (length > 1 && strstr(known[i].written, key)) {
            snprintf(name, CHARSET_NAME_BYTES, "%s", known[i].name);
            good = true;
        }
    if (!good && length > 1 && strlen(written) < CHARSET_NAME_BYTES && !strpbrk(written, "/ ")) {
        snprintf(name, CHARSET_NAME_BYTES, "%s", written);
        good = true;
    }
    return good && is_convertible(iconv_name_of(name));
}

char *charset_describe(const struct charset_choice *choice)
{
    return *choice->other ? mem_printf("the file was read as %s, but its encoding may be %s: if so, set it with --encoding NAME",
                                       choice->name, choice->other)
                          : mem_printf("read as %s", choice->name);
}

/* --- conversion ------------------------------------------------------------------------------------------------------------- */

/* Appends text that iconv has converted. Drops zero bytes, which would end the text, and adds their number to *damaged. */
static void take_converted(struct text *out, const char *from, const char *to, size_t *damaged)
{
    for (; from < to; from++)
        if (*from)
            text_add_bytes(out, from, 1);
        else
            ++*damaged;
}

/* Converts bytes; each undecodable byte becomes one U+FFFD. In Windows-1258 and Windows-1255, an accent follows its letter, so
   iconv holds back a letter until it sees the next character. The last call of iconv() flushes such a letter. */
char *charset_convert(const char *bytes, size_t count, const char *encoding, size_t *damaged)
{
    struct text out = { 0 };
    size_t wrong = 0;
    char buffer[4096], *from = (char *)bytes;
    size_t left = count;
    iconv_t converter = iconv_open("UTF-8", iconv_name_of(encoding));
    while (left > 0) {
        char *to = buffer;
        size_t room = sizeof(buffer);
        size_t status = converter == (iconv_t)-1 ? (size_t)-1 : iconv(converter, &from, &left, &to, &room);
        int error = converter == (iconv_t)-1 ? EILSEQ : errno;
        take_converted(&out, buffer, to, &wrong);
        if (status == (size_t)-1 && error != E2BIG) {
            text_add_bytes(&out, replacement, sizeof(replacement) - 1);
            wrong++;
            from++;
            left--;
        }
    }
    if (converter != (iconv_t)-1) {
        char *to = buffer;
        size_t room = sizeof(buffer);
        iconv(converter, NULL, NULL, &to, &room);
        take_converted(&out, buffer, to, &wrong);
        iconv_close(converter);
    }
    text_add_bytes(&out, "", 0);
    if (damaged)
        *damaged += wrong;
    return out.at;
}

struct charset_encoder {
    iconv_t converter;
};

struct charset_encoder *charset_encoder_open(const char *encoding)
{
    struct charset_encoder *encoder = mem_new(sizeof(*encoder));
    encoder->converter = iconv_open(iconv_name_of(encoding), "UTF-8");
    return encoder;
}

void charset_encoder_close(struct charset_encoder *encoder)
{
    if (encoder->converter != (iconv_t)-1)
        iconv_close(encoder->converter);
    mem_free(encoder);
}

size_t charset_encode(struct charset_encoder *encoder, const char *utf8, size_t count, unsigned char *out, size_t out_bytes)
{
    char *from = (char *)utf8, *to = (char *)out;
    size_t room = out_bytes;
    if (encoder->converter == (iconv_t)-1)
        return 0;
    iconv(encoder->converter, NULL, NULL, NULL, NULL); /* resets the converter's shift state, which an earlier text may have left changed */
    bool good = iconv(encoder->converter, &from, &count, &to, &room) == 0 && count == 0;
    return good ? out_bytes - room : 0;
}

bool charset_fits(const char *bytes, size_t count, const char *encoding)
{
    size_t damaged = 0;
    mem_free(charset_convert(bytes, count, encoding, &damaged));
    return damaged == 0;
}
