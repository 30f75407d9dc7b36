/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page says the same in its own words (clients/web/words). */
#include "render/overlay/overlay_words.h"

#include <stdio.h>
#include <string.h>

enum language { ENGLISH, KOREAN, GERMAN, LANGUAGES };
static const char *const names[LANGUAGES] = { "en", "ko", "de" };
static enum language chosen;

static const char *const words[OVERLAY_WORDS][LANGUAGES] = {
    [WORD_NO_LIMITS] = { "no limits", "한계 없음", "ohne Grenzwerte" },
    [WORD_NO_DATA] = { "no data", "데이터 없음", "keine Daten" },
    [WORD_UNCERTAIN] = { "uncertain", "불확실", "unsicher" },
    [WORD_UNPROVEN] = { "unproven", "미확인", "ungeprüft" },
    [WORD_PLACE_ASSUMED] = { "place assumed", "위치 추정", "Ort angenommen" },
    [WORD_DIRECTION_UNKNOWN] = { "direction unknown", "방향 모름", "Richtung unbekannt" },
    [WORD_PRIORITY_1] = { "alarm, priority 1", "알람, 우선순위 1", "Alarm, Priorität 1" },
    [WORD_PRIORITY_2] = { "alarm, priority 2", "알람, 우선순위 2", "Alarm, Priorität 2" },
    [WORD_PRIORITY_3] = { "alarm, priority 3", "알람, 우선순위 3", "Alarm, Priorität 3" },
    [WORD_PRIORITY_4] = { "alarm, priority 4", "알람, 우선순위 4", "Alarm, Priorität 4" },
    [WORD_BY_LIMITS] = { "by each tag's limits", "태그마다 정해진 한계 기준", "nach Grenzwerten der Messstelle" },
    [WORD_LOGARITHMIC] = { "logarithmic scale", "로그 눈금", "logarithmische Skala" },
    [WORD_DEVIATION] = { "standard deviation", "표준 편차", "Standardabweichung" },
    [WORD_MISREAD] = { "may be misread", "잘못 읽기 쉬움", "kann täuschen" },
    [WORD_GLOSSY] = { "glossy: light changes", "광택: 빛이", "glänzend: Licht ändert" },
    [WORD_GLOSSY_2] = { "the colours", "색을 바꿈", "die Farben" },
    [WORD_BAD] = { "BAD", "불량", "SCHLECHT" },
    [WORD_UNKNOWN_THEN] = { "not known then", "당시에는 모름", "damals unbekannt" },
    [WORD_FROM] = { "From {}", "{}에서의 거리", "Abstand von {}" },
    [WORD_HOT_SPOT] = { "Hot spot seen: {}", "보이는 과열부: {}", "Erkannte Heißstelle: {}" },
    [WORD_HOT_SPOT_SIZE] = { "of {} m, as {} % of the range", "{} m 크기, 범위의 {} %", "von {} m, als {} % des Bereichs" },
    [WORD_SINCE] = { "since {}", "{} 이후", "seit {}" },
    [WORD_ALARMS] = { "{} alarms", "알람 {}건", "{} Alarme" },
    [WORD_WORST] = { "worst {}", "최고 {}", "schwerster {}" },
};

bool overlay_words_choose(const char *language)
{
    for (int i = 0; i < LANGUAGES; i++)
        if (!strcmp(language, names[i])) {
            chosen = (enum language)i;
            return true;
        }
    return false;
}

const char *overlay_word(enum overlay_word word)
{
    return words[word][chosen];
}

void overlay_say(enum overlay_word word, const char *a, const char *b, char *out, size_t size)
{
    const char *text = words[word][chosen], *one = strstr(text, "{}"), *two = one ? strstr(one + 2, "{}") : NULL;
    snprintf(out, size, "%.*s%s%.*s%s%s", (int)(one ? one - text : (long)strlen(text)), text, one ? a : "",
             (int)(two ? two - one - 2 : 0), one ? one + 2 : "", two && b ? b : "", two ? two + 2 : one ? one + 2 : "");
}
