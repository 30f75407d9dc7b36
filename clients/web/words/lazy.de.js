// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of parts of the page that are loaded on first use, in German.
export default `
accept: Angenommene Orte bestätigen
close: Schließen
cancel: Abbrechen
sun: aus {wind}, {height}° Höhe

[distance]
metres: {metres} m
geodesic: Oberfläche
geodesic.why: Abstand entlang der Oberfläche: Wärme springt nicht über Spalte
euclidean: Luftlinie
euclidean.why: Gerader Abstand durch den Raum
heat: Wärmemethode
heat.why: Wie in Kim & Suh 2025, an Stichprobenpunkten der Oberfläche, zum Vergleich: 0,5 % Fehler, geht durch dünne
  Wände

[interpolation]
shepard: Shepard
shepard.why: Inverse Distanzgewichtung: an jedem Sensor gleich dem Messwert
paper: Kim & Suh
paper.why: Algorithmus 1 von Kim & Suh 2025: glatter, weicht aber an den Sensoren von den Messwerten ab
harmonic: Wärmeleitung
harmonic.why: Stationäre Wärmeleitung in der Wand zwischen den Sensoren. Ungeeignet, wo Medium oder Luft die Wärme
  abführt, und für Druck oder Durchfluss
fin: Wärmeleitung mit Verlust
fin.why: Wie Wärmeleitung, aber die Wand verliert Wärme an die Luft. Kein Wert, wo Sensoren unter ein Zehntel beitragen.
  Ungeeignet für gedämmte oder beheizte Wände
gp: Am wahrscheinlichsten
gp.why: Gauß-Prozess: wahrscheinlichstes Feld mit seiner Unsicherheit. Ungeeignet, wo sich Teile berühren, die nichts
  miteinander zu tun haben

[bar]
distance: Abstand
interpolation: Interpolation

[neighbours]
say: Laut Nachbarsensoren
above: {predicted}; zeigt {by} mehr
below: {predicted}; zeigt {by} weniger
title: Größte Abweichungen gegenüber Nachbarsensoren
why: Vergleicht jeden Messwert mit dem, was die anderen Sensoren am Anlagenteil erwarten lassen. Gilt nicht, wo ein
  Sensor abweichen soll, etwa am Einlass.

[drift]
week: Drift in einer Woche
found: {by}: driftet
none: {by}: keine Drift erkannt
unknown: {by}: nicht bestimmbar
why: Änderung gegenüber den Nachbarsensoren, aus Stundenmitteln. Gilt nicht, wenn der Prozess selbst die Unterschiede
  geändert hat.

[coverage]
since: seit {when}
title: Sensorabdeckung
none: Aus
uncertainty: Unsicherheit
uncertainty.note: Standardabweichung, berechnet aus den Sensoren, die jetzt gut sind.
uncertainty.why: Möglicher Fehler des Felds, wenn sich die Werte auf der Fläche so ändern, wie der Gauß-Prozess annimmt.
  Unzuverlässig, wenn dessen Reichweite nur geschätzt ist.
blind: Blinde Flecken
blind.of: Erkennbarer Hotspot: {name}
blind.note: Schwächster Hotspot von {size} m, der den nächsten Sensor um 5 % des Bereichs bewegt.
blind.why: So heiß muss eine kleine Stelle werden, bis ein Sensor sie zeigt. Gilt nicht für andere Formen oder andere
  Wege der Wärme.

[picture]
from: Abstand von
tag: Messstelle
difference: Differenz zu
kept: Gespeicherte Werte
now: Aktuelle Werte
name: Name für aktuelle Werte
keep: Werte speichern
scale: Skala
fill: Flächen ohne Daten
light: Licht: Sonne {where}
turn: Azimut
turn.why: Azimut der Sonne, Grad von Norden
height: Höhe
height.why: Höhenwinkel der Sonne, Grad
around: Umgebung
around.why: Umgebung

[arrows]
title: Richtungen
arrows: Pfeile
arrows.why: Die Länge zeigt den Wert. Aus Sensoren interpoliert: gilt nicht im Raum zwischen Flächen und ist keine
  berechnete Strömung.
strokes: Laufende Striche
strokes.why: Je größer der Wert, desto schneller. Aus Sensoren interpoliert: keine Bahnen eines Fluids.
none: Keine
none.why: Richtungen werden nicht gezeichnet; Farben zeigen nur den Wert.
unknown: Richtung unbekannt

[scale]
linear: Linear
log: Logarithmisch

[fill]
none: Schraffiert
none.why: Wo kein guter Sensor hinreicht, wird kein Wert gezeigt
neighbours: Aus der Umgebung
neighbours.why: Mit Werten der Umgebung gefüllt und gepunktet

[split]
right: Was die rechte Hälfte zeigt
end: Geteilte Ansicht beenden

[environment]
sky: Himmel

[wind]
N: N
NE: NO
E: O
SE: SO
S: S
SW: SW
W: W
NW: NW

[walls]
untrended: Wartet auf die Werte von {tags}
untagged: unbekannt
failed: Fehler: Dieses Feld ist nicht aktuell
unknown: Die Anlagendatei hat keine Videowand „{id}“. Es gibt: {known}
display: Videowand „{id}“ hat {count} Bildschirme, aber keinen Bildschirm {n}
lost: Keine Verbindung zur Anlage seit {time}
never: Keine Verbindung zur Anlage
self: Bildschirm {display} von {wall}, wartet seit {time}
denied: Dieser Bildschirm braucht ein eigenes Token
digits: Zum Koppeln gibt ein Engineer diesen Code unter „Ansichten“ ein
asks: Kopplungscode wird vom Server angefordert
left: Code läuft in {time} ab
place: Bildschirm {display} von {wall}
crowded: Zu viele Bildschirme warten auf Kopplung; neuer Versuch folgt
nowhere: Die Anlagendatei hat keinen Bildschirm {display} an Videowand „{wall}“
token: Token
enter: Eingeben
held: festgehalten von {who} seit {time}
sent: gesendet von {who}, {time}
age: Daten {age} alt
since: seit {time}
many(one): {worst}, {count} Alarm
many(other): {worst}, {count} Alarme
more(one): und {count} weiterer
more(other): und {count} weitere
counts: {active} aktiv, {waiting} unquittiert
flood: Alarmschwall: {active} aktiv, {waiting} unquittiert
late: Die Verbindung zu diesem Bildschirm ist zu langsam; nicht aktualisiert seit {time}
missing: Bildschirm {displays} nicht verbunden

[others]
gone: Kein Bild von {name} seit {time}
waiting: Warten auf den Server der Anlage
unreachable: Der Server der Anlage antwortet nicht
tls: Dem Zertifikat des Servers dieser Anlage wird nicht vertraut
token: Die Token-Datei für den Server dieser Anlage ist nicht lesbar
refused: Der Server der Anlage nimmt das Token nicht an
busy: Der Server der Anlage ist überlastet
slow: Der Server der Anlage antwortet zu langsam
large: Der Server der Anlage sendet zu viele Daten
no_picture: Der Server der Anlage sendet kein Bild
unheard: Keine Angaben vom Server dieser Anlage

[notes]
legend: Notizen
text: Schichtnotiz
at: Anheften an
until: Sichtbar bis
save: Notiz hinzufügen
place: diese Stelle
ends: bis {time}
handover: Schichtübergabe
plant: Ganze Anlage
edit: Ändern
end: Beenden
change: Änderung speichern

[until]
shift: 8 Stunden
day: 1 Tag
week: 1 Woche
ever: bis zum Entfernen

[remote]
legend: Videowand
pane: Feld der Videowand
desk: Name des Arbeitsplatzes
where: {wall} {display}: {area}
send: Diese Ansicht senden
hold: Festhalten
back: Freigeben
point: Meinen Mauszeiger auf der Videowand zeigen
there: verbunden
gone: dieser Bildschirm ist nicht verbunden
sent: {title}, gesendet von {who}, {time}
held: festgehalten von {who}, {time}
unread: Videowände konnten nicht gelesen werden: {why}

[devices]
legend: Bildschirme
digits: Kopplungscode
pair: Koppeln
revoke: Entkoppeln
is: Bildschirm {display} von {wall}, Adresse {from}, gekoppelt von {who}, {time}
unread: Bildschirme konnten nicht gelesen werden: {why}

[handover]
title: Schichtübergabe, {plant}
last: Die letzten
hours: {n} Stunden
print: Drucken oder als PDF speichern
notes: Notizen
standing: Aktiv oder unquittiert
active: Jetzt aktiv
waiting: Jetzt unquittiert
about: Beschreibung
value: Wert (Grenzwert)
asides: Jetzt zurückgestellt oder unterdrückt
raised: Gekommene Alarme
acknowledged: Quittiert
shelved: Zurückgestellt oder außer Betrieb
time: Zeit
where: Wo
what: Notiz
who: Wer
until: Bis
alarm: Alarm
priority: Priorität
state: Zustand
count: Anzahl
newest: Zuletzt
reason: Grund
ended: entfernt von {who}, {time}
cut: Liste gekürzt: es gab mehr Alarme
unread: konnte nicht gelesen werden: {why}
gives: Übergeben von
takes: Übernommen von
denied: Die Übergabe ist für Operatoren: anmelden oder Token eingeben, dann von der Seite aus öffnen

[named]
legend: Gespeicherte Ansichten
title: Name dieser Ansicht
save: Speichern
unknown: Eine Ansicht „{id}“ gibt es nicht
wrong: Diese Ansicht lässt sich nicht zeigen: {why}
more: Mehr zu {title}
by: {who}, {time}
update: Durch aktuelle Ansicht ersetzen
up: Nach oben
down: Nach unten
remove: Entfernen
look: Zeigen
back: Rückgängig

[views]
from: Blick von
extremes: Zu einem Messwert
projection: Projektion
cut: Schnitt
where: Lage des Schnitts
turn: Umdrehen
equipment: Anlagenteil: {what}
select: Erst ein Anlagenteil wählen
all: Alle zeigen
stays: {axis} {sign} {at} m behalten
part: {percent} % von {what}
plant: der Anlage

[extreme]
highest: Höchster
lowest: Niedrigster

[side]
top: Oben
front: Vorn
right: Rechts
back: Hinten
left: Links
iso: Schräg

[projection]
perspective: Perspektive
parallel: Parallel

[cut]
off: Aus
box: Quader
move: Schnitt verschieben: {axis}
whole: Quader verschieben: Pfeiltasten entlang X und Y, Bild auf/ab entlang Z
oblique: schräg

[shown]
hide: Ausblenden
ghost: Transparent
only: Nur dieses
hidden: {hidden} von {all} ausgeblendet
ghosts(one): {count} transparent
ghosts(other): {count} transparent

[assets]
description: Beschreibung
area: Bereich
missing: Fehlt
size: Größe
place: Mitte
sensors.name: Sensoren

[wall]
far: Text auf diesem Bildschirm ist bis {metres} m lesbar, nicht bis {wanted} m.

[callout]
count: {count} Alarme
worst: höchster

[card]
novalue: Kein Wert
quality: Qualität
age: Alter
on: Anlagenteil
trend: Trend
add: Zum Trend hinzufügen
HH: über Grenzwert Hoch-Hoch
H: über Grenzwert Hoch
L: unter Grenzwert Tief
LL: unter Grenzwert Tief-Tief
BAD: Messung gestört
ALM: Alarm

[place]
measured: Hier gemessen
between: Zwischen Sensoren
no data: Keine Daten: nächster Sensor gestört oder außer Reichweite
context: Kein Sensor für diese Messgröße
equipment: Ein Sensor gilt für das ganze Teil: sein Ort ist angenommen
inside: Inneres (Schnittfläche)
uncertain: {state}, unsicher
drawn: Für diesen Punkt berechnet. Das Bild ringsum kann um bis zu {value} abweichen

[following]
title: Sie folgen der Ansicht von {who}
gone: Die Sitzung von {who} ist beendet: dies ist die letzte Ansicht
awaited: Warten auf die Ansicht, der diese Seite folgt
someone: jemand anderem

[outside]
title: Außerhalb der ersten Ansicht, bis {far} entfernt: {names}
more: {names} und {count} weitere
all: Alles zeigen
close: Hinweis schließen

[alarms]
more: und {count} weitere

[state]
active: Aktiv
unacknowledged: Unquittiert
acknowledged: Quittiert
returned: Gegangen, unquittiert
latched: Selbsthaltend
shelved: Zurückgestellt
suppressed: Planmäßig unterdrückt
out_of_service: Außer Betrieb

[trends]
time: Zeit
csv: CSV exportieren
close: Trends schließen
hour: 1 h
hour.why: Letzte Stunde
shift: Schicht
shift.why: Letzte 8 Stunden
day: Tag
day.why: Letzte 24 Stunden
week: Woche
week.why: Letzte 7 Tage
month: 30 Tage
month.why: Letzte 30 Tage
range: Zeitraum
range.why: Zeitraum eingeben, zum Beispiel: letzte 8 h, gestern 22:00 bis 06:00, 2026-11-20 bis 2026-11-21
last: letzte {span}
between: {from} bis {to}
example.minutes: letzte 15 min
example.hours: letzte 8 h
example.today: heute
example.yesterday: gestern
example.night: gestern 22:00 bis 06:00
unread: „{text}“ ist kein Zeitraum in der Vergangenheit. Zum Beispiel: {example}
earlier: Früher
later: Später
in: Vergrößern
out: Verkleinern
back: Voriger Zeitraum
add: Messstelle hinzufügen
none: Keine Messstelle passt zu „{text}“
full: Höchstens {count} Messstellen: zuerst eine entfernen
unknown: Nicht in dieser Anlage: {tags}
undrawn: Nicht gezeichnet, höchstens {count} Messstellen: {tags}
tag: Messstelle
at: Fadenkreuz
now: Jetzt
then: Gezeigte Zeit
min: Min
mean: Mittel
max: Max
known: Gültig
focus: Diese Kurve hervorheben und ihre Grenzwerte zeigen
which: Diagramm
chart: Diagramme. Pfeiltasten bewegen das Fadenkreuz, Plus und Minus zoomen, Bildtasten verschieben, Enter zeigt den Zeitpunkt.
table: Werte und Statistik
raised: {alarm}, gekommen {time}
remove: {tag} entfernen
gaps: Schraffiert: kein Wert von {tags}
cut: Zu viele Alarme von {tags}: die frühesten sind nicht markiert
failed: Kein Trend: {why}
unsaved: Nicht exportiert: {why}
uncharted: dieser Server wurde ohne Diagramme gebaut (npm fehlte)

[compare]
title: Zwei Zeiten vergleichen
why: Ansicht teilen: die zweite Hälfte zeigt eine andere Zeit mit derselben Kamera
right: Diese Hälfte zeigt
ago: Zeit dieser Hälfte
at: In dieser Hälfte zu einer Zeit gehen
chosen: gewählte Zeit
earlier: {span} früher
end: Vergleich beenden

[time]
before: Vorheriger Alarm
after: Nächster Alarm
goto: Gehe zu
first: Kein früherer Alarm ist aufgezeichnet
last: Kein späterer Alarm ist aufgezeichnet
unread: Alarme konnten nicht gelesen werden: {why}
unmarked: Markierungen fehlen vielleicht oder sind alt: {why}
play: Abspielen
pause: Anhalten
speed: Wiedergabetempo
span: Zeitbereich
slider: Gezeigter Zeitpunkt
live: Zurück zu Live
now: Jetzt
ago: {instant} · vor {age}
lost: {source}: keine Verbindung
uncounted: Zu viele Alarme zum Zählen
unrecorded: nicht aufgezeichnet
raised(one): {count} Alarm gekommen
raised(other): {count} Alarme gekommen

[quality]
because: {quality}: {detail}

[detail]
CommunicationError: Kommunikationsfehler
ConfigurationError: Konfigurationsfehler
DeviceFailure: Gerätefehler
NoCommunication: keine Kommunikation
NoMatch: kein Wert an der Adresse
TooManyMatches: mehrere Werte an der Adresse
OutOfService: außer Betrieb
SensorFailure: Sensorfehler
WaitingForInitialData: wartet auf erste Daten
EngineeringUnitsExceeded: außerhalb des Messbereichs
LastUsableValue: letzter brauchbarer Wert
NoCommunicationLastUsableValue: keine Kommunikation, letzter brauchbarer Wert
SensorNotAccurate: Sensor ungenau

[timings]
ms: Millisekunden
half: Median
most: 95 %
input: Eingabe bis Bild
sensor: Messwert bis Bild
wait: Warten
field: Feldberechnung
render: Zeichnen
encode: Kodieren
network: Netzwerk
decode: Dekodieren
rate: {pictures} Bilder/s, {kbit} kbit/s
follow: Wer {link} öffnet, sieht diese Ansicht.

[account]
title: Konto
viewer: (Betrachter)
operator: (Operator)
engineer: (Engineer)
open: (nur ansehen)
nobody: Nicht angemeldet.
person: Über den Identitätsanbieter angemeldet.
token: Mit Token angemeldet.
here: Sie arbeiten am Server selbst: keine Anmeldung nötig.
in: Anmelden: {provider}
out: Abmelden

[token]
title: Token
needed: Anmeldung erforderlich.
bad: Das Token ist ungültig oder abgelaufen.
locked: Nach Inaktivität gesperrt. Bitte erneut anmelden.
go: Weiter
note: Tokens erstellt, wer den Server verwaltet: {command}. Das Token bleibt bis zum Schließen dieses Tabs gespeichert.

[help]
title: Bedienung
close: Hilfe schließen
mouse: Maus
touch: Berühren
keys: Tasten
turn: Drehen
turn.mouse: Ziehen mit linker Taste
turn.touch: Ein Finger
move: Verschieben
move.mouse: Ziehen mit rechter oder mittlerer Taste oder [Shift]
move.touch: Zwei Finger
look: Umsehen
look.mouse: Ziehen mit [Ctrl]
look.touch: Drei Finger
zoom: Zoomen
zoom.mouse: Mausrad
zoom.touch: Zwei Finger spreizen
fit: Einpassen
fit.mouse: Doppelklick
fit.touch: Doppelt tippen
home: Grundansicht
back: Zurück zur vorigen Ansicht
from: Blick von
from.keys: [T] oben, [I] schräg, [O] parallel, [V] alle Ansichten, [P] Bild
what: Information zeigen
what.mouse: Klick
what.touch: Tippen
selected: Gewähltes Anlagenteil
selected.keys: [X] ausblenden, [G] transparent, [L] nur dieses, [U] alle zeigen
quantity.keys: [1] bis [9]
equipment.keys: [B], suchen [/]
history.keys: [Y], zurück zu Live [N]
markers: Markierungen
mark.good: guter Messwert
mark.uncertain: unsicherer Messwert
mark.bad: gestört: kein Wert
mark.behind: verdeckt
mark.alarm: Alarm; die Farbe zeigt die Priorität
mark.acknowledged: quittierter Alarm
mark.returned: gegangen oder selbsthaltend
crowd: Wo Markierungen zu dicht liegen, fehlen einige; näher heranzoomen zeigt alle. Alarme fehlen nie.

[measure]
first: Ersten Punkt anklicken
second: Zweiten Punkt anklicken
done: Für eine neue Messung klicken
missed: Hier ist nichts: auf die Anlage klicken
end: Fertig
parts: horizontal {level} m, vertikal {rise} m

[snapshot]
failed: Kein Bild: {why}
unnamed: ein Vergleich braucht unter einem Namen gespeicherte Werte
shown: Speichern, was zu sehen ist
shown.note: Pixel für Pixel, mit den gezeigten Werten; ohne Legende, Markierungen und Uhr.
again: Mit Legende und Markierungen speichern
again.note: Vom Server neu gezeichnet. Beide sind signiert: „plantcast verify“ erkennt jede Änderung.
late: kein signiertes Bild empfangen

[share]
title: Teilen
what: Was der Link öffnet
view: Diese Ansicht
view.why: Öffnet diese Ansicht: Kamera, Messgröße, Farben, Zeitpunkt.
tag: Messstelle
tag.why: Öffnet die Seite an dieser Messstelle. Ausdrucken und am Anlagenteil anbringen.
asset: Anlagenteil
asset.why: Öffnet die Seite an diesem Anlagenteil. Ausdrucken und dort anbringen.
follow: Mir folgen
follow.why: Wer ihn öffnet, sieht mit, solange diese Seite offen ist.
link: Link
copy: Kopieren
copied: Kopiert
code: Der Link als QR-Code
nocode: Dieser Server wurde ohne QR-Codes gebaut (npm fehlte).
local: Funktioniert nur auf diesem Rechner: die Adresse ist lokal.
people: Zuschauer
alone: Niemand folgt Ihnen.
followers(one): {count} Person folgt Ihnen.
followers(other): {count} Personen folgen Ihnen.
lead: An {who} übergeben
viewer: Betrachter

[factor]
range: Farbbereich
min: Von
max: Bis
own: Vorgabe der Gruppe
title: Feldberechnung
strength: Stärke
decay: Abfall
power: Exponent
radius_m: Radius (m), 0 = automatisch
reach_m: Reichweite (m), leer = unbegrenzt
of: Nur für {tag}
choose: Für einen Sensor: erst auswählen
reset(one): Wie konfiguriert ({count} Sensor)
reset(other): Wie konfiguriert ({count} Sensoren)

[proof]
fail: Loop-Check nicht bestanden
changed: Loop-Check veraltet: Messstelle seither geändert
pass: Loop-Check bestanden

[eng]
title: Engineering
close: Engineering schließen
place: Platzieren
prove: Loop-Check
method: Berechnung
what: Aufgabe
find: Messstelle suchen
nowhere: nicht platziert
on: an {asset}
choose: Eine Messstelle wählen, dann auf die Oberfläche klicken; oder ihre Markierung ziehen.
click: {tag}: auf die Oberfläche klicken oder die Markierung ziehen.
missed: Hier ist keine Oberfläche.
moves: Entwurf (nur für Sie sichtbar)
nomoves: Nichts versetzt. Bis zum Speichern sehen nur Sie Ihre Änderungen.
off: {metres} m neben der Oberfläche
left: nicht an {asset}, anders als in der Liste
waiting: vorerst Luftlinie; Abstände entlang der Oberfläche folgen
straight: nur Luftlinie
ready: Abstände entlang der Oberfläche
undo: Rückgängig
back: Alles verwerfen
gaps: Messlücken
save: Speichern …
gaps.of: Messlücken: {quantity}
gap: Größter Abstand zum nächsten Sensor: {metres} m. {far} % der Oberfläche sind über {limit} m entfernt; {lost} %
  haben jetzt keine Daten.
gap.assumed: Die Orte der Sensoren sind angenommen, ihre Abstände daher unbekannt.
gap.next: Am weitesten von anderen Sensoren entfernt: {a}, {metres} m von {b}.
gap.off: {tag} liegt {metres} m neben der Oberfläche von {asset} (höchstens {limit} m)
gap.none: Kein Sensor liegt neben der Oberfläche.
diff: {file} speichern?
diff.before: vorher
diff.after: nachher
diff.line: Zeile {n}
diff.note: Die bisherige Liste bleibt als Sicherung. Die neue gilt in wenigen Sekunden für alle.
diff.conflict: {file} wurde von jemand anderem geändert und ist noch nicht geladen. Nichts wurde gespeichert; die Änderungen:
diff.left: {tag} war an {left} und ist jetzt an {asset}: Ist das beabsichtigt?
diff.more: … und {count} weitere Zeilen
confirm: Speichern und anwenden
saving: Wird vorbereitet; alle sehen noch die bisherige Anlage.
saved: Angewendet. Die vorige Liste ist als {kept} gesichert.
unsaved: Nicht gespeichert: {text}
device: Gerät
proven: {done} von {count} bestanden
expected: Erwarteter Wert
tolerance: Toleranz ±
watch: Änderungen beobachten
watching: Jetzt am Messumformer einen festen Wert vorgeben.
still: Noch hat sich kein Messwert geändert.
moved: {tag} hat sich am meisten geändert: um {by}.
swapped: {tag} hat sich geändert, nicht {wanted}: sind sie vertauscht?
compare: Vergleichen
fails: Als nicht bestanden melden
csv: Werte aus CSV …
csv.note: {count} erwartete Werte wurden gelesen.
csv.bad: Die Spalten Tag Name, Expected, Tolerance sind nötig.
export: Ergebnisse exportieren
remark: Bemerkung
passed: {tag} bestanden: {value}.
failed: {tag} nicht bestanden: {why}.
now: jetzt {value}

[accept]
asset: Anlagenteil
all: alle ({count})
tags: Messstellen
pattern: Name oder Beschreibung; * und ? in Namen
within: Höchster Abstand zur Fläche (m)
confidence: Mindestsicherheit (0 bis 1)
count(one): {count} Ort würde bestätigt. Er hat im Bild einen blauen Ring.
count(other): {count} Orte würden bestätigt. Sie haben im Bild blaue Ringe.
none: Kein Ort würde bestätigt.
nowhere: {count} ausgelassen: weder Knoten noch Position in der Liste
missing: {count} ausgelassen: das Anlagenteil hat kein Modell
far: {count} ausgelassen: weiter von der Fläche entfernt
unsure: {count} ausgelassen: Sicherheit geringer oder unbekannt
go: {count} bestätigen
saved(one): {count} Ort bestätigt. Die vorige Liste ist als {kept} gesichert.
saved(other): {count} Orte bestätigt. Die vorige Liste ist als {kept} gesichert.
undo: Zurück zu {kept} …
changed: Nichts wurde bestätigt: die Liste hat sich geändert. Bitte die Zahl prüfen und noch einmal bestätigen.
undone: Zurückgenommen. {kept} gilt wieder.

[unrecorded]
title: Nicht aufgezeichnet: {what}
why: Der Server kann einige seiner Dateien nicht verwenden; den Grund nennt sein Protokoll.
readings: Messwerte
alarms: Alarmänderungen
actions: Audit-Trail
lists: Ansichten, Notizen und andere Listen

[standby]
plant: Anlagendatei
tags: Messstellenliste
models: Modelle
none: Kein Reserveserver ist verbunden.
denied: Kein Reserveserver ist verbunden. Dieser Server lehnt die Verbindung von {node} ab: {why}
getting: Der Reserveserver {node} hat diese Dateien noch nicht: {files}.
behind: Der Reserveserver {node} hat diese Dateien nicht erhalten ({files}): {why}
refused: Der Reserveserver {node} kann nicht übernehmen: {why}
warned: Der Reserveserver {node} kann übernehmen, weicht aber ab: {why}
`;
