// SPDX-License-Identifier: GPL-3.0-or-later
// Refusals, in German. Keys before the first [section] are codes of the server, with the arguments of PROTOCOL.md.
export default `
role_operator: dafür ist die Rolle Operator nötig
role_engineer: dafür ist die Rolle Engineer nötig
no_group: in dieser Anlage gibt es „{name}“ nicht (Messgröße)
no_asset: in dieser Anlage gibt es „{name}“ nicht (Anlagenteil)
no_tag: in dieser Anlage gibt es „{name}“ nicht (Messstelle)
no_device: in dieser Anlage gibt es „{name}“ nicht (Gerät)
no_view: in dieser Anlage gibt es „{name}“ nicht (Ansicht)
unknown: „{name}“ ist hier nicht bekannt
uncut: „Paper“ wird nicht genau gezeichnet, wo {group} nur einen Sensor hat ({count} von {all} Anlagenteilen, zuerst {asset}). In
  der Anlagendatei hilft „singles: cut“ bei dieser Gruppe.
far_uncut: Abstände werden nicht genau gezeichnet, wo {group} nur einen Sensor hat, wie an {asset}.
  In der Anlagendatei hilft „singles: cut“ bei dieser
  Gruppe.
assumed: der Ort dieses Sensors an {asset} ist nicht angegeben: Abstände von ihm gibt es nicht
elsewhere: die Alarme verwaltet ein anderes System
anew: die Anlage wird neu geladen; bitte erneut versuchen
quiet: es gibt nichts zu quittieren
latched: er ist nicht gehalten, noch aktiv oder nicht quittiert
otherwise: sein Zustand hat sich inzwischen geändert
shelf: ein Alarm kann höchstens eine Woche zurückgestellt werden
tolerance: der Wert liegt außerhalb der Toleranz
reading: der Messwert ist nicht gut
failed: von Ihnen als durchgefallen gemeldet
disk: nicht gespeichert: der Server kann nicht auf seinen Datenträger schreiben
disk_full: nicht gespeichert: der Datenträger des Servers ist voll
disk_locked: nicht gespeichert: der Datenträger des Servers ist schreibgeschützt
disk_slow: nicht gespeichert: der Datenträger des Servers antwortet nicht
kept_unread: nicht gespeichert: der Server kann die Datei mit den früheren Einträgen nicht lesen; den Grund nennt sein Protokoll
not_utf8: nicht gespeichert: der Text ist kein UTF-8
fixed: diese Ansicht stammt aus der Anlagendatei: dort ändern
viewless: diese Ansicht wurde von jemand anderem entfernt
digits: kein Bildschirm zeigt diesen Code
guesses: zu viele falsche Codes; in einer Minute erneut versuchen
deviceless: unter diesem Namen ist kein Bildschirm mehr gekoppelt
devices: die Höchstzahl an Bildschirmen ist erreicht
views: die Höchstzahl an Ansichten ist erreicht: erst eine entfernen
notes: die Höchstzahl an Notizen ist erreicht: erst eine entfernen
note_ended: das Ende der Notiz ist schon vorbei
noteless: diese Notiz wurde von jemand anderem entfernt oder ist abgelaufen
note_others: nur wer diese Notiz geschrieben hat, kann sie ändern
computed: {tag} wird aus anderen Messstellen berechnet: diese prüfen
far: {tag}: dieser Ort ist zu weit von {asset} entfernt
groupless: {tag} gehört zu keiner Gruppe; nennen Sie eine in der Messstellenliste
twice: {tag} wird zweimal verschoben
busy: eine andere Liste wird gerade angewendet
unmoved: es wurde kein Sensor verschoben
unread: die Messstellenliste war beim Laden der Anlage nicht lesbar
unread_file: {file} ist nicht lesbar: {error}
unwritten: {file} ist nicht schreibbar: {error}
no_tag_column: die Messstellenliste hat keine Spalte „Tag Name“
unlisted: {tag} steht nicht in der Messstellenliste
folder_locked: der Dienst darf in den Ordner der Messstellenliste nicht schreiben ({file})
changed: {file} wurde inzwischen von anderen geändert
kept: es sind schon {count} Vergleichsstände gespeichert; bitte erst einen löschen
lines: ein Abstand von {step} ergibt mehr als {count} Linien
numbers: höchstens {count} Zahlen, jede größer als die vorige
log: eine logarithmische Skala braucht einen Bereich über 0
range: der Bereich muss unter seinem Ende beginnen
between: erwartet wird eine Zahl von {low} bis {high}
placeless: dieser Sensor hat keinen Ort in dieser Messgröße
narrow: das Bild ist zu schmal zum Teilen
memory: dem Server fehlt Speicher; das letzte Bild bleibt
gone: dieser Benutzer ist nicht mehr verbunden
linkless: dieser kurze Link ist unbekannt oder nicht mehr gespeichert: einen neuen erbitten
coreless: die Aufzeichnung ist nicht verfügbar: der Kern ist nicht erreichbar; bitte erneut versuchen
unrecorded: es wird nichts aufgezeichnet (history: record: no)
unreadable: die Aufzeichnung ist nicht lesbar; den Grund nennt das Protokoll des Servers

[class]
too_fast: zu viele Anfragen: Ihre wird verzögert
limit: das Bild ist größer, als dieser Server zeichnet
not_allowed: hier nicht erlaubt
core_lost: der Kern ist nicht erreichbar: vielleicht wurde nichts ausgeführt; prüfen Sie es, sobald er zurück ist

[page]
refused: Der Server hat abgelehnt: {text}
other: auf Englisch: „{text}“
blocked: Der Server antwortet über HTTP, aber {proxy} leitet den WebSocket nicht weiter. {needs}
blocked_proxy: ein Proxy dazwischen
blocked_lines: Nötig ist {lines} in seinem location-Block
blocked_page: Was er braucht, steht in PROXY.md, „WebSocket“
link: Dieser Link passt nicht: {why}. Er kann zu einer anderen Anlage gehören oder älter sein als eine Änderung der Anlage.
unkept: Angewendet, aber nach einem Neustart des Servers verloren ({text})
unaudited: Ausgeführt, fehlt aber im Audit-Trail ({text})
`;
