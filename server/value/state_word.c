/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of state words, which historians and spreadsheets write instead of a value. It has digital states of PI, errors of
   PI DataLink and of spreadsheets, and quality codes of Ignition. */
#include "value/state_word.h"

#include <ctype.h>
#include <string.h>

#include "value/quality.h"

enum { LONGEST_WORD = 40 };

/* State words for each quality, separated by blanks; each consists of letters and digits only, in lower case. */
static const struct {
    uint32_t quality;
    const char *words;
} table[] = {
    { QUALITY_BAD,
      " nodata null none na nan qnan snan ind nil missing void invalid invaliddata unknown undefined noresult nosample nolabdata samplebad"
      " notavailable novalue unavailable nogooddata nogooddataforcalculation ptcreated pointcreated trace doubtful settobad notconverted"
      " error fault fail failed failure stale notfound datanotfound invalidfloat pointnotfound digitalstate notrust"
      " schlecht keinedaten ungültig 불량 무효 데이터없음 " },
    { QUALITY_BAD_COMMUNICATION_ERROR,
      " iotimeout timeout timedout scantimeout commfail commfailure commerror communicationfailure communicationerror notconnect"
      " notconnected disconnected nocomm nocommunication noconnection offline accessdenied archiveoffline arcoffline linkdown nolink " },
    { QUALITY_BAD_SENSOR_FAILURE,
      " overrange underrange outofrange sensorfailure sensorfail sensorfault equipfail greatermm lessmm opencircuit shortcircuit"
      " wirebreak overflow underflow " },
    { QUALITY_BAD_CONFIGURATION,
      " configure configerror configurationerror calcfailed calctimeout calccrash calcoverflow coercionfailed typeconversionerror"
      " expressionevalerror programmismatch " },
    { QUALITY_BAD_DEVICE_FAILURE, " devicefailure devicefail dcsfailed dcsfail filterfailed plcfail plcfailed " },
    { QUALITY_BAD_OUT_OF_SERVICE,
      " outofserv outofservice scanoff offscan shutdown intfshut intfpaused intfoffline interfaceshutdown disabled inactive calcoff"
      " unitdown notinservice " },
};

/* Returns true if the text begins with this word as a whole: "Bad", "Bad_NotConnected", "BadSensorFailure" and "BAD INPUT" begin with
   "bad", "badge" does not. */
static bool begins_as(const char *text, const char *word)
{
    size_t length = strlen(word);
    for (size_t i = 0; i < length; i++)
        if (tolower((unsigned char)text[i]) != word[i])
            return false;
    return !islower((unsigned char)text[length]);
}

/* Returns true for error values of spreadsheets, such as "#DIV/0!", "#NAME?" and "#N/A". */
static bool is_spreadsheet_error(const char *text)
{
    size_t length = strlen(text);
    return *text == '#' && length > 2 && length < 12 && strchr("!?A", text[length - 1]);
}

/* Reduces a text to letters and digits in lower case: "1.#QNAN" to "qnan", "-nan" to "nan". */
static void normalize(const char *text, char word[LONGEST_WORD + 1])
{
    size_t length = 0;
    const char *mark = strchr(text, '#');
    for (const unsigned char *p = (const unsigned char *)(mark ? mark : text); *p && length < LONGEST_WORD; p++)
        if (isalnum(*p) || *p >= 0x80)
            word[length++] = (char)tolower(*p);
    word[length] = 0;
}

bool state_word_is_bad(const char *text, uint32_t *quality)
{
    char word[LONGEST_WORD + 1], between[LONGEST_WORD + 3];
    text += strspn(text, " \t[(<\"'");
    normalize(text, word);
    memcpy(between, " ", 2);
    strcat(strcat(between, word), " ");
    for (size_t i = 0; *word && i < sizeof(table) / sizeof(table[0]); i++)
        if (strstr(table[i].words, between)) {
            *quality = table[i].quality;
            return true;
        }
    if (!begins_as(text, "bad") && !begins_as(text, "error") && !is_spreadsheet_error(text) && strspn(text, "-*?. _/>)]") != strlen(text))
        return false;
    *quality = QUALITY_BAD;
    return true;
}
