// SPDX-License-Identifier: GPL-3.0-or-later
// Refusals, in German. The first part is the server's too: by code, with the arguments of PROTOCOL.md.
export default `
role_operator: das darf nur die Rolle Bediener
role_engineer: das darf nur die Rolle Ingenieur
no_group: in dieser Anlage gibt es „{name}“ nicht (Messgröße)
no_asset: in dieser Anlage gibt es „{name}“ nicht (Ausrüstung)
no_tag: in dieser Anlage gibt es „{name}“ nicht (Messstelle)
no_device: in dieser Anlage gibt es „{name}“ nicht (Gerät)
unknown: „{name}“ ist hier nicht bekannt
uncut: Paper wird nicht richtig gezeichnet, wo {group} nur einen Sensor hat ({count} von {all} Anlagenteilen, zuerst {asset}).
  In der Anlagendatei hilft „singles: cut“ bei dieser Gruppe.
far_uncut: Abstände werden nicht richtig gezeichnet, wo {group} nur einen Sensor hat, wie an {asset}.
  In der Anlagendatei hilft „singles: cut“ bei dieser Gruppe.
assumed: es ist nicht angegeben, wo an {asset} dieser Sensor sitzt: Abstände von ihm gibt es nicht
elsewhere: die Alarme gehören einem anderen System
anew: die Anlage wird gerade neu geladen; bitte noch einmal
quiet: es gibt nichts zu quittieren
latched: er ist nicht gehalten, steht noch an oder ist nicht quittiert
otherwise: sein Zustand ist inzwischen ein anderer
shelf: ein Alarm kann höchstens eine Woche zurückgestellt werden
tolerance: der Wert liegt außerhalb der Toleranz
reading: der Messwert ist nicht gut
failed: als durchgefallen gemeldet
disk: nicht gespeichert: der Server kann nicht auf seinen Datenträger schreiben
disk_full: nicht gespeichert: der Datenträger des Servers ist voll
disk_locked: nicht gespeichert: der Datenträger des Servers ist schreibgeschützt
disk_slow: nicht gespeichert: der Datenträger des Servers antwortet nicht
kept_unread: nicht gespeichert: der Server kann die Datei mit den früheren Einträgen nicht lesen; den Grund nennt sein Protokoll
not_utf8: nicht gespeichert: der Text ist kein UTF-8
fixed: diese Ansicht steht in der Anlagendatei und wird dort geändert
viewless: jemand hat diese Ansicht entfernt
digits: kein Bildschirm zeigt diese Ziffern
guesses: zu viele falsche Ziffern; in einer Minute wieder versuchen
deviceless: jemand hat diesen Bildschirm schon entfernt
devices: es gibt so viele Bildschirme, wie es geben darf
views: mehr Ansichten können es nicht sein; bitte erst eine entfernen
notes: mehr Notizen können es nicht sein; bitte erst eine entfernen
note_ended: die Notiz wäre schon abgelaufen
noteless: jemand hat diese Notiz entfernt
computed: {tag} wird aus anderen Messstellen berechnet; diese sind zu prüfen
far: {tag}: diese Stelle liegt zu weit von {asset} weg
groupless: {tag} gehört zu keiner Gruppe; die Messstellenliste muss eine nennen
twice: {tag} wird zweimal verschoben
busy: eine andere Liste wird gerade in Kraft gesetzt
unmoved: es wurde kein Sensor verschoben
unread: die Messstellenliste war beim Laden der Anlage nicht lesbar
unread_file: {file} ist nicht lesbar: {error}
unwritten: {file} kann nicht geschrieben werden: {error}
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
narrow: das Bild ist zu schmal für zwei Hälften
memory: dem Server fehlt Speicher; das letzte Bild bleibt
gone: die Sitzung {session} ist nicht mehr verbunden
coreless: Aufzeichnungen hat der Kern, der nicht zu erreichen ist; noch einmal versuchen
unrecorded: hier wird nichts aufgezeichnet (history: record: no)
unreadable: die Aufzeichnung ist nicht lesbar; den Grund nennt das Protokoll des Servers

[class]
too_fast: es wurde zu viel auf einmal verlangt; es geschieht etwas später
limit: das Bild ist größer, als dieser Server zeichnet
not_allowed: das ist hier nicht erlaubt
core_lost: der Kern ist nicht erreichbar: nichts geschah, oder es ist ungewiss; sehen Sie nach, sobald er zurück ist

[page]
refused: Der Server hat abgelehnt: {text}
other: auf Englisch: „{text}“
blocked: Der Server antwortet über HTTP, aber {proxy} leitet den WebSocket nicht weiter. {needs}
blocked_proxy: ein Proxy dazwischen
blocked_lines: Nötig ist {lines} in seinem location-Block
blocked_page: Was er braucht, steht in INSTALL.md, „Behind a reverse proxy“
link: Dieser Link passt nicht: {why}. Er kann zu einer anderen Anlage gehören oder älter sein als eine Änderung der Anlage.
unkept: In Kraft, aber nach einem Neustart des Servers verloren ({text})
unaudited: Geschehen, fehlt aber im Prüfprotokoll ({text})
`;
