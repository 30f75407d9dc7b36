/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words for quantities in English, German, French, Spanish, Portuguese, Italian, Russian, Korean, Chinese and Japanese. */
#include "preprocess/match/quantity_words.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/match/fold.h"

/* Words for each quantity: lower case, without accents, separated by bars. Short words, phrases and words ending in "=" must match whole
 * words. Words ending in "~" may also match the end of a word, as in "Saugdruck". Other words match any part of a word, as in
 * "Lagertemperatur". A word that contains another one must come earlier in the table. */
static const struct {
    const char *quantity, *words;
} quantities[] = {
    { "Differential pressure",
      "|differential pressure|diff press|pressure drop|pressure difference|delta p|differenzdruck|druckdifferenz|druckverlust|"
      "pression differentielle|perte de charge|presion diferencial|pressao diferencial|pressione differenziale|"
      "перепад давления|"
      "дифференциальное давление|차압|压差|差压|壓差|差壓|差圧|" },
    { "Temperature",
      "|temperature|temperatur|temperatura|temp|tmp|температура|температуры|темп|온도|"
      "温度|溫度|水温|油温|气温|" },
    { "Pressure",
      "|pressure|press|druck~|pression|presion|pressao|pressione|давление|давления|압력|压力|"
      "壓力|圧力|油压|油圧|真空度|" },
    { "Flow",
      "|flow|flowrate|volumenstrom|massenstrom|durchfluss|durchsatz|debit|caudal|vazao|portata|расход|"
      "расхода|유량|流量|" },
    { "Level",
      "|level|lvl|fullstand|fuellstand|fuellhohe|fullhohe|niveau|nivel|livello|уровень|уровня|레벨|"
      "수위|액위|液位|料位|水位|油位|"
      "レベル|液面|" },
    { "Speed",
      "|speed|rpm|drehzahl|vitesse|velocidad|velocidade|velocita|частота вращения|обороты|"
      "скорость|회전수|속도|转速|轉速|"
               "回転数|回転速度|速度|" },
    { "Vibration",
      "|vibration|vibrations|schwingung|vibracion|vibracao|vibrazione|вибрация|вибрации|진동|"
      "振动|振動|" },
    { "Conductivity",
      "|conductivity|leitfahigkeit|conductivite|conductividad|condutividade|conducibilita|"
      "электропроводность|전도도|"
                      "电导率|電導度|導電率|" },
    { "Moisture",
      "|moisture|humidity|feuchte|feuchtigkeit|humidite|humedad|umidade|umidita|влажность|"
      "влажности|습도|수분|湿度|濕度|"
                  "水分|" },
    { "Density",
      "|density|dichte|densite|masse volumique|densidad|densidade|densita|плотность|плотности|"
      "밀도|密度|" },
    { "Position",
      "|position=|stellung=|ventilstellung|posicion|posicao|posizione|ouverture|положение|"
      "положения|개도|위치|开度|開度|位置|" },
    { "Weight", "|weight|gewicht|poids|peso|вес|масса|중량|무게|重量|" },
    { "Voltage", "|voltage|spannung=|voltaje|voltagem|tensione|напряжение|напряжения|전압|电压|電壓|電圧|" },
    { "Current",
      "|motor current|motorstrom|stromaufnahme|courant|intensite|corriente|corrente|ток двигателя|전류|"
      "电流|電流|" },
    { "Power", "|active power|leistung=|wirkleistung|puissance|potencia|potenza|мощность|мощности|전력|功率|電力|" },
};
enum { QUANTITIES = sizeof(quantities) / sizeof(*quantities) };

/* Returns the letters and digits of a text as words, with one blank before and after each word. The caller frees the text. */
static char *words_of(const char *text)
{
    char *folded = fold_text(text), *out = mem_array(strlen(folded) * 4 + 3, 1);
    size_t length = 0;
    out[length++] = ' ';
    for (const char *at = folded; *at;) {
        size_t count = 0;
        while (isalpha((unsigned char)at[count]) || ((unsigned char)at[count] & 0x80))
            count++;
        if (count > 0) {
            char *part = mem_printf("%.*s", (int)count, at), *key = fold_key(part);
            length += (size_t)sprintf(out + length, "%.*s ", (int)(count * 3), key);
            mem_free(part);
            mem_free(key);
        }
        at += count + (at[count] != 0);
    }
    out[length] = 0;
    mem_free(folded);
    return out;
}

/* Returns whether a word of the table must match a whole word. False for Chinese, Japanese and Korean words, because these
 * languages do not separate words. */
static bool is_whole(const char *word, char mark)
{
    bool cyrillic = (unsigned char)*word == 0xd0 || (unsigned char)*word == 0xd1, ascii = !((unsigned char)*word & 0x80);
    return mark == '=' || strchr(word, ' ') || (ascii && strlen(word) <= 5) || (cyrillic && strlen(word) <= 10);
}

/* Finds a word in the text and overwrites it with blanks, so that "pressure" is not found again in "differential pressure". */
static bool take_word(char *text, const char *word, char mark)
{
    bool found = false, whole = mark != '~' && is_whole(word, mark);
    size_t length = strlen(word);
    for (char *at = text; (at = strstr(at, word)) != NULL; at += length)
        if ((!whole || at[-1] == ' ') && ((!whole && mark != '~') || at[length] == ' ')) {
            memset(at, '.', length);
            found = true;
        }
    return found;
}

const char *quantity_words_find(const char *text)
{
    const char *found = NULL;
    char *words = words_of(text);
    bool several = false;
    for (int i = 0; i < QUANTITIES; i++)
        for (const char *at = quantities[i].words + 1; *at; at += strcspn(at, "|") + 1) {
            char *word = mem_printf("%.*s", (int)strcspn(at, "|"), at), *key = words_of(word);
            size_t length = strlen(key);
            if (length > 1)
                key[length - 1] = 0;
            if (length > 2 && take_word(words, key + 1, word[strlen(word) - 1])) {
                several |= found && found != quantities[i].quantity;
                found = quantities[i].quantity;
            }
            mem_free(key);
            mem_free(word);
        }
    mem_free(words);
    return several ? NULL : found;
}
