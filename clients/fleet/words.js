// SPDX-License-Identifier: GPL-3.0-or-later
// The words of the fleet page, in English, Korean and German.
const WORDS = {
    en: {
        answer: '{count} of {all} plants answer', only: 'Only what needs attention', stale: 'No update since {time}',
        none: 'No alarms', priority: 'Priority {priority}', since: 'No answer since {time}', never: 'No answer yet',
        first: 'First request sent',
        links: 'Links', down: '{down} of {all} down', up: '{all} up', version: 'Version', certificate: 'Certificate', disk: 'Free disk',
        backup: 'Last backup', unknown: 'unknown', off: 'none', recorded: 'Recording', broken: 'not writable', works: 'works',
        refused: 'the plant file has errors', configuration: 'Configuration', expired: 'expired', acknowledge: '{count} unacknowledged',
    },
    ko: {
        answer: '설비 {all}곳 중 {count}곳 응답', only: '조치가 필요한 곳만',
        stale: '{time} 이후 갱신되지 않음',
        none: '알람 없음', priority: '우선순위 {priority}', since: '{time}부터 응답 없음', never: '아직 응답 없음',
        first: '첫 조회 중',
        links: '통신 연결', down: '{all}개 중 {down}개 끊김', up: '{all}개 정상', version: '버전',
        certificate: '인증서', disk: '디스크 여유',
        backup: '마지막 백업', unknown: '알 수 없음', off: '없음', recorded: '기록', broken: '기록할 수 없음',
        works: '정상',
        refused: '설비 파일에 오류가 있음', configuration: '설정', expired: '만료됨',
        acknowledge: '미확인 {count}건',
    },
    de: {
        answer: '{count} von {all} Anlagen antworten', only: 'Nur was Aufmerksamkeit braucht',
        stale: 'Keine Aktualisierung seit {time}',
        none: 'Keine Alarme', priority: 'Priorität {priority}', since: 'Keine Antwort seit {time}', never: 'Noch keine Antwort',
        first: 'Erste Abfrage läuft', links: 'Verbindungen', down: '{down} von {all} gestört', up: '{all} in Ordnung',
        version: 'Version',
        certificate: 'Zertifikat', disk: 'Freier Speicher', backup: 'Letzte Sicherung', unknown: 'unbekannt', off: 'keines',
        recorded: 'Aufzeichnung', broken: 'nicht schreibbar', works: 'in Ordnung', refused: 'die Anlagendatei hat Fehler',
        configuration: 'Konfiguration', expired: 'abgelaufen', acknowledge: '{count} unquittiert',
    },
};

// Returns the first requested language that the page has; `?lang=` takes precedence over the browser's list.
export function chooseLanguage(search, preferred) {
    const wished = [new URLSearchParams(search).get('lang'), ...preferred].filter(Boolean).map((tag) => tag.slice(0, 2).toLowerCase());
    return wished.find((tag) => tag in WORDS) ?? 'en';
}

export const languages = Object.keys(WORDS);
export const keys = (language) => Object.keys(WORDS[language]);

// Returns the function say(key, values), which returns the words for a key with the values inserted.
export const wordsOf = (language) => (key, values = {}) => WORDS[language][key].replace(/\{(\w+)\}/g, (_, name) => values[name]);
