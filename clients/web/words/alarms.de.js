// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the alarm list, the alarm journal and the replay of the time around an alarm, in German.
export default `
[alarms]
close: Alarme schließen
then: Das Bild zeigt die Vergangenheit, diese Liste die aktuellen Alarme.
quiet: Keine aktiven Alarme.
aside: Zurückgestellt oder unterdrückt ({count})
until: bis {time}
by: durch {who}
edge: Zum Ändern der Breite ziehen
held: Messung gestört: letzter Zustand gehalten
heldfrom: Messung gestört: Zustand gehalten seit {time}
fly: Zu {tag} fliegen
stale: Nicht aktuell: Stand {time}, als die Verbindung abbrach.
which: Angezeigte Alarme
search: Filtern
unfilter: Filter aufheben: {count} von {all}, {what}
filtered(one): Der einzige Alarm passt nicht zum Filter.
filtered(other): Keine Treffer unter {count} Alarmen.
choose: {tag} auswählen
chooseall: Alle auswählen
acknowledge: {count} quittieren
also: auch {what}
priorities: Alle Prioritäten
areas: Alle Bereiche
chosen(one): {count} ausgewählt
chosen(other): {count} ausgewählt
count(one): {count} Alarm
count(other): {count} Alarme
shelve: {count} zurückstellen …
unchoose: Auswahl aufheben

[which]
all: Alle
waiting: Unquittiert
active: Aktiv
gone: Gegangen

[action]
acknowledge: Quittieren
shelve: Zurückstellen …
reset: Zurücksetzen
unshelve: Zurückstellung aufheben
in_service: Wieder in Betrieb nehmen

[shelve]
title: {what} zurückstellen
for: Dauer
quarter: 15 Minuten
hour: 1 Stunde
reason: Grund
do: Zurückstellen

[short]
returned: Gegangen
suppressed: Unterdrückt

[column]
state: Zustand
priority: Prio
tag: Messstelle
kind: Alarm
area: Bereich
about: Benennung
us: Zeit
raised: Beginn
then: Wert damals
now: Jetzt
limit: Grenze
since: Alter
do: Aktionen
order: Reihenfolge
sort: Nach {what} sortieren

[journal]
title: Journal
csv: CSV
which: Angezeigte Änderungen
span: Zeitraum
all: Alle Änderungen
raised: Gekommen
cleared: Gegangen
acknowledged: Quittiert
shelved: Zurückgestellt, unterdrückt
shift: Letzte 8 Stunden
day: Letzte 24 Stunden
today: Heute
yesterday: Gestern
week: Letzte 7 Tage
chosen: Von – bis …
from: Von
to: Bis
count(one): {count} Änderung
count(other): {count} Änderungen
cut: {count} der neuesten {all} Änderungen, zurück bis {time}
older: Ältere laden
nounit: Einheit unbekannt

[change]
raise: Gekommen
clear: Gegangen
acknowledge: Quittiert
reset: Zurückgesetzt
shelve: Zurückgestellt
unshelve: Wieder gemeldet
suppress: Unterdrückt
unsuppress: Nicht mehr unterdrückt
out_of_service: Außer Betrieb
in_service: In Betrieb
carry: Durch Gerätealarm abgedeckt
call: Erneut gekommen

[moment]
show: 30 s vor dem Alarm zeigen
raised: gekommen {time}
early: {s} s davor
late: {s} s danach
now: Zeitpunkt des Alarms
before: 30 s davor
at: Zum Alarm
`;
