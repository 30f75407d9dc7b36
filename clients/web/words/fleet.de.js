// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the fleet page, in German.
export default `
answer: {count} von {all} Anlagen antworten
only: Nur was Aufmerksamkeit braucht
stale: Keine Aktualisierung seit {time}
none: Keine Alarme
priority: Priorität {priority}
since: Keine Antwort seit {time}
never: Noch keine Antwort
first: Erste Abfrage läuft
links: Datenquellen
down: {down} von {all} gestört
up: {all} in Ordnung
version: Version
certificate: Zertifikat
disk: Freier Speicher
backup: Letzte Sicherung
unknown: unbekannt
off: keines
recorded: Aufzeichnung
broken: nicht schreibbar
works: in Ordnung
refused: die Anlagendatei hat Fehler
configuration: Konfiguration
expired: abgelaufen
acknowledge: {count} unquittiert
`;
