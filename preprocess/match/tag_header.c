/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognises column names of exported tag lists in English, German, French, Spanish, Portuguese, Italian, Korean, Chinese, Japanese and
 * Russian. */
#include "preprocess/match/tag_header.h"

#include <string.h>

#include "base/mem.h"
#include "preprocess/match/fold.h"

/* column names after fold_key(), by the field they denote; if several columns of a file fit a field, the name listed earlier wins */
static const struct {
    enum export_field field;
    const char *words;
} fields[] = {
    { EXPORT_NAME,
      " tagname pointname pntname pointid tag tagno tagnumber tagid 태그명 태그이름 태그 module modulename point "
      "objectname name itemname symbolname signalname kks kkscode messstelle messstellenname messstellennummer messstellennr "
      "pltstelle pltstellenname variablenname variable tagbezeichnung kennzeichen symbol kurzzeichen kurzbezeichnung plsname akz "
      "anlagenkennzeichen kksnr kksnummer emsrstelle messkreis loopname nomdeletiquette reperefonctionnel nomdupoint "
      "nombredelaetiqueta nombredelavariable 点号 测点编号 点位号 仪表编号 信号名称 nomdutag nomtag repere "
      "mnemonique "
      "nomdevariable nomvariable etiqueta nombredeltag nombredetag nombretag nombredevariable nometag nomedotag nomedatag "
      "位号 位号名 位号名称 仪表位号 设备位号 测点名 测点 测点名称 点名 变量名 变量名称 "
      "变量 标签名 标签 标签名称 标记名 計器番号 タグ名 タグ名称 タグno タグ番号 タグ 計器 "
      "変数名 信号名 点位 點位 位號 標籤名稱 標籤 測點 測點名稱 變數名稱 태그번호 "
      "계기번호 계기명 변수명 포인트명 имятега тег тэг имятэга имяпеременнои "
      "переменная позиция кипозиция обозначение itemid tagitem 名称 名稱 이름 "
      "имя nombre nom nome naam nazwa bezeichner instrumenttag " },
    { EXPORT_ADDRESS,
      " address opcitempath pvsourceaddress sourceaddress pvinputinputsource ioaddress plcaddress modbusaddress register ioin "
      "주소 logicaladdress logischeadresse adresselogique direccionlogica indirizzologico 逻辑地址 "
      "論理アドレス 논리주소 adresse spsadresse modbusadresse registeradresse ioadresse direccion direccionmodbus "
      "direccionplc endereco indirizzo adres 地址 寄存器地址 寄存器 plc地址 modbus地址 アドレス "
      "レジスタ 位址 暫存器 레지스터 адрес адресплк регистр nodeid signaladresse adr operand "
      "adresseautomate adresseapi direccionplc direcciondeplc plc어드레스 어드레스 plc주소 通道地址 plc寄存器 "
      "变量地址 opcitem opcaddress "
      "opcitemid topic tagaddress plctag instrumenttag " },
    { EXPORT_TYPE,
      " datatype pointtype type datentyp typ typededonnees typedonnees tipodedatos tipodedato tipodato tipodedados "
      "数据类型 資料類型 データ型 데이터타입 데이터유형 데이터형식 типданных тип "
      "typedevaleur 类型 型 자료형 " },
    { EXPORT_SCAN,
      " scanrate scanintervall abtastrate " },
    { EXPORT_SCALING,
      " scaling scalemode conversion skalierung " },
    { EXPORT_NEGATE,
      " negatevalue negate " },
    { EXPORT_RAW_LOW,
      " rawlow minraw rawmin rohmin rohwertmin raw0 " },
    { EXPORT_RAW_HIGH,
      " rawhigh maxraw rawmax rohmax rohwertmax " },
    { EXPORT_SCALED_LOW,
      " scaledlow mineu pveulo englow pvengunitsmin 0rangevalue eu0 rangelow rangemin lowrange lrv lowerrange lowscale 최소 "
      "minimum min zero messbereichanfang messbereichvon messanfang bereichmin bereichvon messbereichmin anfangswert "
      "untergrenze echellebasse messbereichsanfang mbanfang bereichsanfang skalenanfang von valeurmin valeurmini valeurminimale "
      "debutechelle debutdechelle debutdegamme valorminimo valormin inicioescala 低量程 量程下 量程起点 echellemin "
      "minechelle minimumechelle basechelle plagemin minimale rangoinferior rangomin "
      "rangominimo escalaminima minimo 量程下限 下限 量程低 量程低限 工程量下限 量程最小值 最小值 "
      "最小 レンジ下限 下限値 測定範囲下限 スケール下限 하한 최소값 범위하한 "
      "측정범위하한 레인지하한 нижниипредел нижняяграница минимум мин "
      "минзначение шкаламин минимальноезначение нижниипределшкалы "
      "engmin eumin mineng " },
    { EXPORT_SCALED_HIGH,
      " scaledhigh maxeu pveuhi enghigh pvengunitsmax 100rangevalue eu100 rangehigh rangemax highrange urv upperrange "
      "highscale 최대 maximum max messbereichende messbereichbis messende bereichmax bereichbis messbereichmax endwert "
      "obergrenze echellehaute messbereichsende mbende bereichsende skalenende bis valeurmax valeurmaxi valeurmaximale "
      "finechelle findechelle findegamme valormaximo valormax finescala 高量程 量程上 量程终点 echellemax maxechelle "
      "maximumechelle hautechelle plagemax maximale rangosuperior rangomax "
      "rangomaximo escalamaxima maximo 量程上限 上限 量程高 量程高限 工程量上限 量程最大值 最大值 "
      "最大 レンジ上限 上限値 測定範囲上限 スケール上限 상한 최대값 범위상한 "
      "측정범위상한 레인지상한 верхниипредел верхняяграница максимум макс "
      "максзначение шкаламакс максимальноезначение "
      "верхниипределшкалы engmax eumax maxeng " },
    { EXPORT_UNIT,
      " engunits engunit engineeringunits engineeringunit pvengunits eudesc eunits eu uom 단위 units unit einheit "
      "masseinheit physikalischeeinheit einh dimension messeinheit uniteingenierie unitedingenierie ud 量纲 计量单位 "
      "測定単位 측정범위단위 unite unites unitedemesure uniteingenieur unidad unidades unidaddemedida "
      "unidadesdeingenieria unidaddeingenieria unidade unitadimisura eenheid jednostka 单位 工程单位 單位 工程單位 単位 "
      "工学単位 工業単位 공학단위 측정단위 единицаизмерения единицы единица "
      "едизм едизмерения размерность " },
    { EXPORT_DESCRIPTION,
      " description tagdescription ptdesc desc shortdesc comment documentation tooltip service descriptor 설명 beschreibung "
      "bezeichnung benennung kommentar klartext text funktion bez funktionstext langtext langbezeichnung messstellenbezeichnung "
      "commentaires libellefonctionnel descripciondeltag servicio comentarios denominacion 测点描述 中文描述 "
      "中文说明 中文說明 位号描述 点描述 태그설명 서비스명 명칭 용도 계기명칭 designation libelle "
      "commentaire descriptif descripcion "
      "comentario denominacion descricao descrizione commento omschrijving opis 描述 说明 注释 备注 用途 "
      "名称描述 測点説明 説明 コメント 備考 サービス 用途名 説明文 註解 說明 備註 설명문 "
      "내용 비고 서비스 코멘트 описание наименование комментарии "
      "назначение примечание " },
    { EXPORT_AREA,
      " path area plantarea asset folder alarmgroup group 구역 pfad bereich anlage teilanlage anlagenteil chemin zone "
      "unitedeproduction ruta zona 区域 车间 装置 路径 エリア 区画 プラント 系統 區域 공정 영역 "
      "경로 участок зона путь цех установка scope " },
    { EXPORT_DEVICE,
      " accessname device devicename opcserver controller source steuerung geraet gerat automate dispositivo 设备 控制器 "
      "機器 設備 장치 장비 устроиство контроллер pointsource " },
    { EXPORT_LL,
      " ll lolo loloalarmvalue lololimit lololim pvlltp 低低报 低低限 下下限 하하한 llwert " },
    { EXPORT_L,
      " l lo loalarmvalue lolimit lolim pvlotp 低报 低限 下限警報 lwert " },
    { EXPORT_H,
      " h hi hialarmvalue hilimit hilim pvhitp 高报 高限 上限警報 hwert " },
    { EXPORT_SPAN,
      " span " },
    { EXPORT_HH,
      " hh hihi hihialarmvalue hihilimit hihilim pvhhtp 高高报 高高限 上上限 상상한 hhwert " },
};
enum { FIELDS = sizeof(fields) / sizeof(*fields) };

/* Returns the position of `key` in a list of words with a blank before and after each, or -1 if it is not in the list. */
static int rank_of(const char *words, const char *key)
{
    char *wanted = mem_printf(" %s ", key);
    const char *at = *key ? strstr(words, wanted) : NULL;
    mem_free(wanted);
    return at ? (int)(at - words) : -1;
}

/* Calls `each` with keys derived from a header cell's text until it returns true: the whole cell, then the parts around "/",
 * "(" and similar, then the ASCII part and the rest, for bilingual headers. */
static bool each_key(const char *cell, bool (*each)(const char *key, void *data), void *data)
{
    static const char separators[] = "/|()[]:;\n";
    char *text = fold_text(cell), *key = fold_key(text);
    bool taken = each(key, data);
    mem_free(key);
    for (char *at = text; *at && !taken;) {
        size_t length = strcspn(at, separators);
        for (int part = 0; part < 3 && !taken; part++) {
            char *piece = mem_printf("%.*s", (int)length, at), *to = piece;
            for (char *c = piece; *c; c++)
                if (part == 0 || (part == 1) == !((unsigned char)*c & 0x80))
                    *to++ = *c;
            *to = 0;
            key = fold_key(piece);
            taken = strlen(key) > 1 && each(key, data);
            mem_free(key);
            mem_free(piece);
        }
        at += length + (at[length] != 0);
    }
    mem_free(text);
    return taken;
}

struct header_reading {
    struct tag_header *header;
    int ranks[EXPORT_FIELDS], column;
};

static bool take_key(const char *key, void *data)
{
    struct header_reading *reading = data;
    struct tag_header *header = reading->header;
    static const char *const states[] = { "loloalarmstate", "loalarmstate", "hialarmstate", "hihialarmstate" };
    bool known = true;
    for (int i = 0; i < 4; i++)
        if (!strcmp(key, states[i]))
            header->limit_states[i] = reading->column;
    if (!strcmp(key, "tagtype"))
        header->tag_type = reading->column;
    else if (!strcmp(key, "specifier"))
        header->specifier = reading->column;
    else
        known = false;
    if (!strcmp(key, "type"))
        header->kind = reading->column;
    for (int i = 0; i < FIELDS; i++) {
        enum export_field field = fields[i].field;
        int rank = rank_of(fields[i].words, key);
        known |= rank >= 0;
        if (rank >= 0 && (header->columns[field] < 0 || rank < reading->ranks[field])) {
            header->columns[field] = reading->column;
            reading->ranks[field] = rank;
        }
    }
    return known;
}

int tag_header_read(const struct table_row *row, struct tag_header *header)
{
    struct header_reading reading = { .header = header };
    int known = 0;
    *header = (struct tag_header){ .tag_type = -1, .limit_states = { -1, -1, -1, -1 }, .kind = -1, .specifier = -1 };
    for (int f = 0; f < EXPORT_FIELDS; f++)
        header->columns[f] = -1;
    for (size_t c = 0; c < row->count; c++) {
        reading.column = (int)c;
        each_key(row->cells[c], take_key, &reading);
    }
    /* If one column fits both the name and the address of a tag, as "Instrument Tag" does, it is used only as the name. */
    if (header->columns[EXPORT_ADDRESS] == header->columns[EXPORT_NAME])
        header->columns[EXPORT_ADDRESS] = -1;
    for (int f = 0; f < EXPORT_FIELDS; f++)
        known += header->columns[f] >= 0;
    return known;
}

bool tag_header_has(const struct table_row *row, const char *word)
{
    bool found = false;
    for (size_t c = 0; c < row->count && !found; c++) {
        char *key = fold_key(row->cells[c]);
        found = !strcmp(key, word);
        mem_free(key);
    }
    return found;
}
