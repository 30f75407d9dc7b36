// SPDX-License-Identifier: GPL-3.0-or-later
// Words of parts of the page that are loaded on first use, in German.
export default `
accept: Angenommene Orte bestätigen
close: Schließen
sun: aus {wind}, {height}° Höhe

[distance]
metres: {metres} m
geodesic: Geodätisch
geodesic.why: Abstand entlang der Oberfläche: Wärme springt nicht über Spalte
euclidean: Euklidisch
euclidean.why: Gerader Abstand durch den Raum
heat: Wärmemethode
heat.why: Wie im Aufsatz, auf Punkten der Oberfläche, zum Vergleich: 0,5 % Fehler, geht durch dünne Wände

[interpolation]
shepard: Shepard
shepard.why: Inverse Distanzwichtung: an jedem Messpunkt gleich dem Messwert
paper: Paper
paper.why: Algorithmus 1 von Kim & Suh 2025: glatter, erreicht aber die Messwerte nicht
harmonic: Wärmeleitung
harmonic.why: Stationäre Wärmeleitung in der Wand zwischen Messpunkten.
  Nicht, wo Medium oder Luft die Wärme abführt, nicht für Druck oder Durchfluss
fin: Leitung und Verlust
fin.why: Wie Wärmeleitung, aber die Wand verliert Wärme an die Luft; unbekannt, wo Messpunkte unter ein Zehntel beitragen. Nicht für
  gedämmte oder beheizte Wände
gp: Am wahrscheinlichsten
gp.why: Gauß-Prozess: wahrscheinlichstes Feld mit seiner Unsicherheit. Nicht, wo sich unabhängige Teile berühren

[bar]
distance: Abstand
interpolation: Interpolation

[neighbours]
say: Laut Nachbarn
above: {predicted}; zeigt {by} mehr
below: {predicted}; zeigt {by} weniger
title: Größte Abweichungen von Nachbarn
why: Jeder Messwert und was die anderen Sensoren am Anlagenteil erwarten lassen. Nicht, wo einer abweichen soll, wie am Einlass.

[drift]
week: Drift in einer Woche
found: {by}: driftet
none: {by}: keine Drift erkannt
unknown: {by}: nicht bestimmbar
why: Änderung gegenüber den Nachbarn, nach Stundenmitteln. Nicht, wo der Prozess selbst die Unterschiede ändert.

[coverage]
since: seit {when}
title: Sensorabdeckung
none: Aus
uncertainty: Unsicherheit
uncertainty.note: Standardabweichung, aus den jetzt guten Sensoren.
uncertainty.why: So weit kann das Feld abweichen, wenn sich die Fläche verhält, wie gp annimmt. Nicht, wo die Reichweite geschätzt ist.
blind: Blinde Flecken
blind.of: Erkennbarer Hotspot: {name}
blind.note: Schwächster Hotspot von {size} m, der den nächsten Sensor um 5 % des Bereichs bewegt.
blind.why: So heiß muss eine kleine Stelle werden, bis ein Sensor sie zeigt. Nicht für andere Formen oder andere Wege der Wärme.

[picture]
from: Abstand von
tag: Messstelle
difference: Differenz zu
kept: Gespeicherte Messwerte
now: Jetzt
name: Name für aktuelle Messwerte
keep: Messwerte speichern
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
arrows.why: Die Länge zeigt den Wert. Aus Sensoren interpoliert: gilt nicht zwischen Flächen und nicht als berechnete Strömung.
strokes: Striche
strokes.why: Laufende Striche: schneller, wo der Wert größer ist. Aus Sensoren interpoliert: keine Bahnen eines Fluids.
none: Keine
none.why: Richtungen werden nicht gezeichnet; Farben zeigen nur den Wert.
unknown: Richtung unbekannt

[scale]
linear: Linear
log: Logarithmisch

[fill]
none: Schraffiert
none.why: Wo kein guter Messpunkt hinreicht, wird nichts gezeigt
neighbours: Aus Nachbarn
neighbours.why: Gefüllt und gepunktet

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
unknown: Die Anlagendatei hat keine Wand „{id}“. Es gibt: {known}
display: Die Wand „{id}“ hat {count} Bildschirme und keinen Bildschirm {n}
lost: Keine Verbindung zur Anlage seit {time}
never: Keine Verbindung zur Anlage
self: Bildschirm {display} von {wall}, wartet seit {time}
denied: Dieser Bildschirm braucht ein eigenes Token
digits: Zum Koppeln gibt die Rolle engineer diesen Code unter „Ansichten“ ein
asks: Kopplungscode wird vom Server angefordert
left: Code läuft in {time} ab
place: Bildschirm {display} von {wall}
crowded: Zu viele Bildschirme warten auf Kopplung; wird wiederholt
nowhere: Die Anlagendatei hat keinen Bildschirm {display} an Wand „{wall}“
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
late: Die Verbindung zu dieser Anzeige ist zu langsam; nicht aktualisiert seit {time}
missing: Anzeige {displays} nicht verbunden

[others]
gone: Kein Bild von {name} seit {time}
waiting: Warten auf den Server der Anlage
unreachable: Ihr Server antwortet nicht
tls: Dem Zertifikat ihres Servers wird nicht vertraut
token: Die Datei mit dem Token für sie ist nicht lesbar
refused: Ihr Server nimmt das Token nicht an
busy: Ihr Server ist überlastet
slow: Ihr Server antwortet zu langsam
large: Ihr Server sendet zu viel
no_picture: Ihr Server sendet kein Bild
unheard: Keine Angaben vom Server dieser Anlage

[notes]
legend: Notizen
text: Schichtnotiz
at: Anheften an
until: Sichtbar bis
save: Notiz anlegen
place: diese Stelle
ends: bis {time}
handover: Schichtübergabe
plant: Ganze Anlage
edit: Ändern
end: Beenden
change: Änderung speichern
cancel: Abbrechen

[until]
shift: 8 Stunden
day: 1 Tag
week: 1 Woche
ever: bis zum Entfernen

[remote]
legend: Bildwand
pane: Feld einer Bildwand
desk: Name des Platzes
where: {wall} {display}: {area}
send: Diese Ansicht senden
hold: Festhalten
back: Freigeben
point: Mit der Maus zeigen
there: verbunden
gone: dieser Schirm ist nicht verbunden
sent: {title}, gesendet von {who}, {time}
held: festgehalten von {who}, {time}

[devices]
legend: Bildschirme
digits: Kopplungscode
pair: Koppeln
revoke: Entkoppeln
is: Bildschirm {display} von {wall}, von {from}, gekoppelt von {who}, {time}

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
value: Wert (Grenze)
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
gives: Übergeben von
takes: Übernommen von
denied: Nur Operatoren dürfen die Übergabe öffnen: anmelden oder Token eingeben, dann auf der Seite öffnen

[named]
legend: Gespeicherte Ansichten
title: Name dieser Ansicht
save: Speichern
unknown: Eine Ansicht „{id}“ gibt es nicht
wrong: Diese Ansicht lässt sich nicht zeigen: {why}
more: Mehr zu {title}
by: {who}, {time}
update: Auf aktuelle Ansicht setzen
up: Nach oben
down: Nach unten
remove: Entfernen
look: Zeigen
back: Rückgängig

[views]
from: Blick von
projection: Projektion
cut: Schnitt
where: Lage des Schnitts
turn: Umdrehen
equipment: Anlagenteil: {what}
select: Erst Anlagenteil wählen
all: Alle zeigen
stays: {axis} {sign} {at} m behalten
part: {percent} % von {what}
plant: der Anlage

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
only: Nur dies
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
on: An
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
between: Zwischen Messpunkten
no data: Keine Daten: nächster Sensor gestört oder außer Reichweite
context: Kein Sensor für diese Messgröße
equipment: Ein Sensor gilt für das ganze Teil: sein Ort ist angenommen
inside: Inneres (Schnittfläche)
uncertain: {state}, unsicher
drawn: Für diesen Punkt berechnet. Das Bild ringsum kann um bis zu {value} abweichen
hide: Ausblenden
ghost: Transparent
only: Nur dies

[following]
title: Sie folgen der Ansicht von {who}
gone: Die Ansicht von {who} ist beendet: ihr letztes Bild
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
latched: Gehalten
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
add: Tag hinzufügen
none: Kein Tag passt zu „{text}“
full: Höchstens {count} Tags: zuerst einen entfernen
tag: Tag
at: Fadenkreuz
now: Jetzt
then: Gezeigt
min: Min
mean: Mittel
max: Max
known: Bekannt
focus: Diese Kurve hervorheben und ihre Grenzen zeigen
chart: Diagramme. Pfeiltasten bewegen das Fadenkreuz, Plus und Minus zoomen, Bildtasten verschieben, Enter zeigt den Zeitpunkt.
table: Werte und Statistik
raised: {alarm}, ausgelöst {time}
remove: {tag} entfernen
gaps: Schraffiert: kein Wert von {tags}
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
play: Abspielen
pause: Anhalten
speed: Wiedergabetempo
span: Zeitbereich
slider: Gezeigter Zeitpunkt
live: Zurück zu Live
now: Jetzt
ago: {instant} · vor {age}
lost: {source}: ausgefallen
uncounted: Zu viele Alarme, um sie hier zu zählen
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
field: Feld
render: Zeichnen
encode: Kodieren
network: Netz
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
here: Am Server selbst ist keine Anmeldung nötig.
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
turn.mouse: Links ziehen
turn.touch: Ein Finger
move: Verschieben
move.mouse: Rechts, Mitte oder [Shift] ziehen
move.touch: Zwei Finger
look: Umsehen
look.mouse: Ziehen mit [Ctrl]
look.touch: Drei Finger
zoom: Zoomen
zoom.mouse: Rad
zoom.touch: Spreizen
fit: Einpassen
fit.mouse: Doppelklick
fit.touch: Doppelt tippen
home: Grundansicht
back: Zurück zur vorigen Ansicht
from: Blick von
from.keys: [T] oben, [I] schräg, [O] parallel, [V] alle Ansichten, [P] Bild
what: Bestimmen
what.mouse: Klick
what.touch: Tippen
selected: Gewähltes
selected.keys: [X] ausblenden, [G] transparent, [L] allein, [U] alle
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
mark.returned: gegangen oder gehalten
crowd: Gedrängte Markierungen werden ausgedünnt; näher heranzoomen zeigt alle. Alarme fehlen nie.

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
shown.note: Pixel für Pixel, mit den Werten, die es zeigt; ohne Legende, Marken und Uhr.
again: Mit Legende und Marken speichern
again.note: Vom Server neu gezeichnet. Beide sind signiert: „plantcast verify“ erkennt jede Änderung.
late: kein signiertes Bild empfangen

[share]
title: Teilen
what: Was der Link öffnet
view: Ansicht
view.why: Öffnet diese Ansicht: Kamera, Größe, Farben, Zeitpunkt.
tag: Messstelle
tag.why: Der Code öffnet die Seite an der Messstelle. Ausdrucken und am Apparat anbringen.
asset: Apparat
asset.why: Der Code öffnet die Seite am Apparat. Ausdrucken und dort anbringen.
follow: Mir folgen
follow.why: Wer ihn öffnet, sieht mit, solange diese Seite offen ist.
link: Link
copy: Kopieren
copied: Kopiert
code: Der Link als QR-Code
nocode: Dieser Server wurde ohne QR-Codes gebaut (npm fehlte).
local: Funktioniert nur auf diesem Rechner: die Adresse ist lokal.
people: Mitschauende
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
reset(one): Wie eingestellt ({count} Sensor)
reset(other): Wie eingestellt ({count} Sensoren)

[proof]
fail: Loop-Check nicht bestanden
changed: Loop-Check veraltet: seither geändert
pass: Loop-Check bestanden

[eng]
title: Engineering
close: Engineering schließen
place: Platzieren
prove: Loop-Check
method: Feld
what: Aufgabe
find: Messstelle suchen
nowhere: nicht platziert
on: an {asset}
choose: Eine Messstelle wählen, dann auf die Oberfläche klicken; oder ihre Marke ziehen.
click: {tag}: auf die Oberfläche klicken oder die Marke ziehen.
missed: Hier ist keine Oberfläche.
moves: Entwurf (nur für Sie sichtbar)
nomoves: Nichts versetzt. Bis zum Speichern sehen nur Sie Ihre Änderungen.
off: {metres} m neben der Oberfläche
left: nicht an {asset}, anders als in der Liste
waiting: gerade Abstände; Abstände entlang der Oberfläche folgen
straight: nur gerade Abstände
ready: entlang der Oberfläche
undo: Rückgängig
back: Alles verwerfen
gaps: Lücken
save: Speichern …
gaps.of: Lücken: {quantity}
gap: Am weitesten von jeder Messstelle: {metres} m. {far} % der Oberfläche sind über {limit} m entfernt; {lost} % haben jetzt keine Daten.
gap.next: Am weitesten auseinander: {a} zu {b}, {metres} m.
gap.off: {tag} ist {metres} m neben der Oberfläche von {asset} (höchstens {limit} m)
gap.none: Keine Messstelle steht neben ihrer Oberfläche.
diff: {file} speichern?
diff.before: vorher
diff.after: nachher
diff.line: Zeile {n}
diff.note: Die bisherige Liste bleibt als Sicherung. Die neue gilt in wenigen Sekunden für alle.
diff.conflict: {file} wurde von jemand anderem geändert und ist noch nicht geladen. Nichts wurde gespeichert; die Änderungen:
diff.left: {tag} war an {left} und ist jetzt an {asset}: Ist das beabsichtigt?
diff.more: … und {count} weitere Zeilen
cancel: Abbrechen
confirm: Speichern und anwenden
saving: Wird vorbereitet; alle sehen noch die bisherige Anlage.
saved: Angewendet. Die vorige Liste ist als {kept} gesichert.
unsaved: Nicht gespeichert: {text}
device: Gerät
proven: {done} von {count} bestanden
expected: Erwartet
tolerance: Toleranz ±
watch: Beobachten
watching: Jetzt am Messumformer einen festen Wert vorgeben.
still: Noch hat sich kein Messwert geändert.
moved: {tag} hat sich am meisten geändert: um {by}.
swapped: {tag} hat sich geändert, nicht {wanted}: sind sie vertauscht?
compare: Vergleichen
fails: Nicht bestanden
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
count(one): {count} Ort würde bestätigt. Er ist im Bild blau umringt.
count(other): {count} Orte würden bestätigt. Sie sind im Bild blau umringt.
none: Kein Ort würde bestätigt.
nowhere: {count} ausgelassen: weder Knoten noch Position in der Liste
missing: {count} ausgelassen: das Anlagenteil hat kein Modell
far: {count} ausgelassen: weiter von der Fläche entfernt
unsure: {count} ausgelassen: geringere oder keine bekannte Sicherheit
go: {count} bestätigen
saved(one): {count} Ort bestätigt. Die vorige Liste ist als {kept} gesichert.
saved(other): {count} Orte bestätigt. Die vorige Liste ist als {kept} gesichert.
undo: Zurück zu {kept} …
changed: Nichts wurde bestätigt: die Liste hat sich geändert. Bitte die Zahl prüfen und noch einmal bestätigen.
undone: Zurückgenommen. {kept} gilt wieder.
`;
