/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page says the same in its own words (clients/web/words). */
#include "render/overlay/overlay_words.h"

#include <stdio.h>
#include <string.h>

static const char *const names[LANGUAGES] = { "en", "ko", "de" };

static const char *const words[OVERLAY_WORDS][LANGUAGES] = {
    [WORD_NO_LIMITS] = { "no limits", "한계 없음", "ohne Grenzwerte" },
    [WORD_NO_DATA] = { "no data", "데이터 없음", "keine Daten" },
    [WORD_UNCERTAIN] = { "uncertain", "불확실", "unsicher" },
    [WORD_DRAWN_ERROR] = { "uncertain: drawn with", "불확실: 그린 값의", "unsicher: gezeichnet" },
    [WORD_DRAWN_ERROR_2] = { "up to {} of error", "오차 최대 {}", "mit bis zu {} Fehler" },
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
    [WORD_HELD_SINCE] = { "held since {}", "{}부터 유지", "gehalten seit {}" },
    [WORD_UNKNOWN_THEN] = { "not known then", "당시에는 모름", "damals unbekannt" },
    [WORD_FROM] = { "From {}", "{}에서의 거리", "Abstand von {}" },
    [WORD_HOT_SPOT] = { "Hot spot seen: {}", "보이는 과열부: {}", "Erkannte Heißstelle: {}" },
    [WORD_HOT_SPOT_SIZE] = { "of {} m, as {} % of the range", "{} m 크기, 범위의 {} %", "von {} m, als {} % des Bereichs" },
    [WORD_SINCE] = { "since {}", "{} 이후", "seit {}" },
    [WORD_ALARMS] = { "{} alarms", "알람 {}건", "{} Alarme" },
    [WORD_WORST] = { "worst {}", "최고 {}", "schwerster {}" },
    [WORD_NO_VALUES] = { "no values", "값 없음", "keine Werte" },
    [WORD_OLD_S] = { "{} s old", "{}초 전 값", "{} s alt" },
    [WORD_OLD_MIN] = { "{} min old", "{}분 전 값", "{} min alt" },
    [WORD_OLD_H] = { "{} h old", "{}시간 전 값", "{} h alt" },
    [WORD_CONFIGURATION] = { "configuration {}", "구성 {}", "Konfiguration {}" },
    [WORD_CLOCK_UNSET] = { "CLOCK NOT SYNCHRONISED", "시계 동기화 안 됨", "UHR NICHT SYNCHRONISIERT" },
    [WORD_SIMULATED] = { "SIMULATED", "모의값", "SIMULIERT" },
    [WORD_NO_LIVE_DATA] = { "NO LIVE DATA", "실시간 데이터 없음", "KEINE LIVE-DATEN" },
    [WORD_HISTORY] = { "HISTORY", "이력", "VERLAUF" },
    [WORD_NO_DATA_THEN] = { "NO DATA", "데이터 없음", "KEINE DATEN" },
    [WORD_UNSEEN_ONE] = { "{} alarm out of sight", "보이지 않는 알람 {}건", "{} nicht sichtbarer Alarm" },
    [WORD_UNSEEN] = { "{} alarms out of sight", "보이지 않는 알람 {}건", "{} nicht sichtbare Alarme" },
    [WORD_UNSEEN_SUCH_AS] = { "{} alarms out of sight, such as", "보이지 않는 알람 {}건 중", "{} nicht sichtbare Alarme, wie" },
    [WORD_LOOKS + LOOK_DEFAULT] = { "Default look", "계측 모양", "Messtreu" },
    [WORD_LOOKS + LOOK_GLOSSY] = { "Glossy look", "광택 모양", "Glänzend" },
    [WORD_LOOKS + LOOK_FLAT] = { "Flat look", "평면 모양", "Flach" },
    [WORD_LOOKS + LOOK_MATERIALS] = { "Materials", "재질", "Werkstoffe" },
    [WORD_INTERPOLATIONS + INTERPOLATION_SHEPARD] = { "Shepard", "Shepard", "Shepard" },
    [WORD_INTERPOLATIONS + INTERPOLATION_PAPER] = { "Algorithm 1 of the paper", "논문의 알고리즘 1", "Algorithmus 1 des Aufsatzes" },
    [WORD_INTERPOLATIONS + INTERPOLATION_HARMONIC] = { "Conduction along the wall", "벽면 열전도", "Wärmeleitung in der Wand" },
    [WORD_INTERPOLATIONS +
        INTERPOLATION_FIN] = { "Conduction and loss to the air", "열전도와 공기로의 손실", "Leitung und Verlust an die Luft" },
    [WORD_INTERPOLATIONS + INTERPOLATION_GP] = { "Most likely field", "가장 그럴듯한 값", "Wahrscheinlichstes Feld" },
    [WORD_DISTANCES + DISTANCE_GEODESIC] = { "Geodesic distance", "측지 거리", "Geodätischer Abstand" },
    [WORD_DISTANCES + DISTANCE_EUCLIDEAN] = { "Euclidean distance", "직선 거리", "Euklidischer Abstand" },
    [WORD_DISTANCES + DISTANCE_HEAT] = { "Geodesic distance by heat", "열에 의한 측지 거리", "Geodätisch aus Wärme" },
    [WORD_POWER] = { "Power {}", "지수 {}", "Exponent {}" },
    [WORD_STRENGTH] = { "Strength {}", "세기 {}", "Stärke {}" },
    [WORD_DECAY] = { "Decay {}", "감쇠 {}", "Abfall {}" },
    [WORD_RADIUS] = { "Radius {} m", "반경 {} m", "Radius {} m" },
    [WORD_RADIUS_AUTOMATIC] = { "Radius automatic", "반경 자동", "Radius automatisch" },
    [WORD_REACH] = { "Reach {} m", "도달 거리 {} m", "Reichweite {} m" },
    [WORD_REACH_UNLIMITED] = { "Reach without limit", "도달 거리 무제한", "Reichweite unbegrenzt" },
    [WORD_NOT_FILLED] = { "Not filled", "채우지 않음", "Nicht gefüllt" },
    [WORD_FILLED] = { "Filled by neighbours", "이웃 값으로 채움", "Aus Nachbarn gefüllt" },
    [WORD_WEIGHTED] = { "Sensors weighted by hand: {}", "직접 가중한 센서: {}", "Von Hand gewichtete Messpunkte: {}" },
    [WORD_AS_CONFIGURED] = { "Sensors as configured", "설정대로의 센서", "Messpunkte wie konfiguriert" },
};

bool overlay_language_find(const char *name, enum language *out)
{
    for (int i = 0; i < LANGUAGES; i++)
        if (!strcmp(name, names[i])) {
            *out = (enum language)i;
            return true;
        }
    return false;
}

const char *overlay_word(enum language language, enum overlay_word word)
{
    return words[word][language];
}

void overlay_say(enum language language, enum overlay_word word, const char *a, const char *b, char *out, size_t size)
{
    const char *text = words[word][language], *one = strstr(text, "{}"), *two = one ? strstr(one + 2, "{}") : NULL;
    snprintf(out, size, "%.*s%s%.*s%s%s", (int)(one ? one - text : (long)strlen(text)), text, one ? a : "",
             (int)(two ? two - one - 2 : 0), one ? one + 2 : "", two && b ? b : "", two ? two + 2 : one ? one + 2 : "");
}
