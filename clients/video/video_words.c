/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "video_words.h"

#include <stdio.h>
#include <string.h>

#include "render/overlay/overlay_words.h"
#include "render/overlay/text_face.h"

static const char *const words[][3] = {
    [VIDEO_STARTING] = { "STARTING", "시작하는 중", "STARTET" },
    [VIDEO_NOT_LET_IN] = { "NOT LET IN", "접근이 허용되지 않음", "NICHT ZUGELASSEN" },
    [VIDEO_NO_VIEW] = { "NO SUCH VIEW", "그런 뷰가 없음", "DIESE ANSICHT GIBT ES NICHT" },
    [VIDEO_NO_PICTURE] = { "NO PICTURE", "화면 없음", "KEIN BILD" },
    [VIDEO_TOO_SLOW] = { "THE SERVER IS TOO SLOW", "서버가 너무 느림", "DER SERVER IST ZU LANGSAM" },
    [VIDEO_SILENT] = { "THE SERVER IS SILENT", "서버가 응답하지 않음", "DER SERVER SCHWEIGT" },
    [VIDEO_NO_CONNECTION] = { "NO CONNECTION TO THE SERVER", "서버에 연결되지 않음", "KEINE VERBINDUNG ZUM SERVER" },
    [VIDEO_NO_VALUES] = { "NO LIVE VALUES", "실시간 값 없음", "KEINE AKTUELLEN WERTE" },
    [VIDEO_SINCE] = { "since {}", "{}부터", "seit {}" },
    [VIDEO_NOTHING_YET] = { "no picture has come yet", "아직 받은 화면이 없습니다", "noch ist kein Bild gekommen" },
    [VIDEO_TOKEN] = { "the server does not take this token: {}", "서버가 이 토큰을 받지 않습니다: {}",
                      "der Server nimmt dieses Token nicht an: {}" },
    [VIDEO_TOKENS] = { "the server looks at no more tokens of this address for a while",
                       "서버가 이 주소의 토큰을 잠시 동안 확인하지 않습니다",
                       "der Server prüft eine Weile keine Tokens dieser Adresse mehr" },
    [VIDEO_ANSWERS] = { "the server answers {}: {}", "서버 응답 {}: {}", "der Server antwortet {}: {}" },
    [VIDEO_VIEWS] = { "there is no view '{}'; there are: {}", "뷰 '{}'이(가) 없습니다. 있는 뷰: {}",
                      "eine Ansicht „{}“ gibt es nicht; es gibt: {}" },
    [VIDEO_NONE] = { "none", "없음", "keine" },
    [VIDEO_TOOK] = { "a picture took it {} s, and may take {}; a smaller --size helps",
                     "화면 하나에 {}초가 걸렸으며 한도는 {}초입니다. --size를 줄이면 도움이 됩니다",
                     "ein Bild dauerte {} s und darf {} s dauern; ein kleineres --size hilft" },
    [VIDEO_EARLIER] = { "the server does not say how old its values are: it is of an earlier version",
                        "서버가 값의 경과 시간을 알리지 않습니다. 이전 버전의 서버입니다",
                        "der Server sagt nicht, wie alt seine Werte sind: er ist von einer früheren Version" },
    [VIDEO_NO_PNG] = { "what the server sent is no PNG of {}x{}", "서버가 보낸 것이 {}x{} PNG가 아닙니다",
                       "was der Server schickte, ist kein PNG von {}x{}" },
    [VIDEO_NO_ANSWER] = { "it does not answer", "응답이 없습니다", "er antwortet nicht" },
    [VIDEO_NO_URL] = { "its parameters make no URL",
                      "매개변수로 URL을 만들 수 없습니다", "aus ihren Parametern wird keine URL" },
    [VIDEO_NO_VALUE] = { "the server is there, and no sensor that is shown tells a value",
                         "서버는 연결되어 있으나 표시된 센서 중 값을 보내는 것이 없습니다",
                         "der Server ist da, aber kein gezeigter Sensor meldet einen Wert" },
    [VIDEO_SAID] = { "{}", "{}", "{}" },
    [VIDEO_AGE_S] = { "values up to {} s old", "값의 경과 시간 최대 {}초", "Werte bis zu {} s alt" },
    [VIDEO_AGE_MIN] = { "values up to {} min old", "값의 경과 시간 최대 {}분", "Werte bis zu {} min alt" },
};
G_STATIC_ASSERT(G_N_ELEMENTS(words) == VIDEO_WORDS && LANGUAGE_EN == 0 && LANGUAGE_KO == 1 && LANGUAGE_DE == 2);

static enum language chosen;

void video_choose_language(const char *language)
{
    overlay_language_find(language, &chosen);
    if (!text_face_has(overlay_word(chosen, WORD_NO_DATA)))
        fprintf(stderr, "no installed font has the letters of --language %s: boxes stand in their place (package fonts-nanum)\n", language);
}

enum language video_language(void)
{
    return chosen;
}

char *video_say(enum language language, enum video_word word, const char *a, const char *b)
{
    const char *values[] = { a, b };
    GString *out = g_string_new(NULL);
    const char *text = words[word][language];
    for (gsize i = 0; i < G_N_ELEMENTS(values); i++) {
        const char *blank = strstr(text, "{}");
        if (!blank || !values[i])
            break;
        g_string_append_len(out, text, blank - text);
        g_string_append(out, values[i]);
        text = blank + 2;
    }
    g_string_append(out, text);
    return g_string_free(out, FALSE);
}
