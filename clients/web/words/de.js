// SPDX-License-Identifier: GPL-3.0-or-later
// The words of the page in German. [beginning] of keys, then key: text; {name} is put in, [X] is a key to press, (one) a plural.
export default `
close: Schließen
none: keine
novalue: kein Wert
sun: aus {wind}, {height}° hoch
viewport: Anlage, 3D-Ansicht. Pfeiltasten drehen, Plus und Minus zoomen, W A S D verschieben, F passt ein, Fragezeichen hilft.
legend: Legende
card: Messstelle
place: Stelle
status: Status
timings: Messungen

[part]
failed: Dieser Teil der Seite konnte nicht geladen werden. Er kommt von selbst, sobald der Server da ist.

[distance]
metres: {metres} m
geodesic: Geodätisch
geodesic.why: Abstand entlang der Oberfläche: Wärme springt nicht über einen Spalt
euclidean: Euklidisch
euclidean.why: Gerader Abstand durch den Raum

[age]
s: {n} s
min: {n} min
h: {n} h
d: {n} d

[bar]
equipment: Anlagenliste
quantity: Messgröße
display: Darstellung
distance: Abstand
interpolation: Interpolation
colours: Farben
ramp: Stufen
lines: Linien
look: Optik
show: Zeigen
views: Ansichten, Schnitt und gezeigte Anlagenteile
picture: Bild: Vergleich, Licht, geteilte Ansicht
history: Verlauf
fit: Einpassen
home: Grundansicht
help: Hilfe
hold: Anhalten: Werte stehen still
go: Weiter: aktuelle Werte
unrecorded: Hier wird nichts aufgezeichnet: Werte können nicht angehalten werden
more: Mehr
measure: Abstand messen
snapshot: Bild speichern
share: Teilen
theme: Dunkel oder hell
engineer: Ingenieur: Messstellen setzen und prüfen

[interpolation]
shepard: Shepard
shepard.why: Inverser Abstand: an jedem Messpunkt genau der Messwert
paper: Paper
paper.why: Algorithmus 1 von Kim & Suh 2025: glatter, erreicht die Messwerte nicht

[show]
value: Werte
operator: Grenzwerte
distance: Abstand
difference: Differenz

[look]
default: Messtreu
glossy: Glänzend
flat: Flach
materials: Werkstoffe

[lines]
none: Keine
every: Alle {step}
chosen: Gewählte

[ramp]
smooth: Stufenlos
group: Eigene Bänder
limits: Grenzwerte
chosen: Gewählte Bänder

[quantity]
temperature: Temperatur
pressure: Druck
vibration: Schwingung
flow: Durchfluss
level: Füllstand
gas: Gas

[picture]
title: Bild
from: Abstand von
tag: Messstelle
difference: Differenz zu
kept: Behaltene Messwerte
now: Jetzt
name: Name für die jetzigen Messwerte
keep: Behalten
scale: Skala
fill: Stellen ohne Daten
light: Licht: Sonne {where}
turn: Seite
turn.why: Seite der Sonne, Grad von Norden
height: Höhe
height.why: Höhe der Sonne, Grad
around: Umgebung
around.why: Umgebung
split: Geteilte Ansicht
right: Rechte Hälfte

[scale]
linear: Linear
log: Logarithmisch

[fill]
none: Schraffiert
none.why: Wo kein guter Messpunkt hinreicht, wird nichts gezeigt
neighbours: Aus Nachbarn
neighbours.why: Gefüllt und gepunktet

[split]
one: Ein Bild
two: Zwei Hälften

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

[views]
title: Ansichten
from: Blick von
projection: Projektion
cut: Wegschneiden
where: Lage des Schnitts
turn: Andere Seite
equipment: Anlagenteil: {what}
select: erst eines wählen
all: Alle zeigen
stays: {axis} {sign} {at} m bleibt
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
whole: Quader verschieben: Pfeiltasten entlang X und Y, Bildtasten entlang Z
oblique: schräg

[shown]
hide: Ausblenden
ghost: Durchsichtig
only: Nur dies

[assets]
title: Anlagenteile
close: Anlagenliste schließen
search: Teile, Messstellen suchen
nothing: Nichts heißt so.
sensors(one): {count} Sensor
sensors(other): {count} Sensoren
loose: Messstellen ohne Anlagenteil
about: Über das gewählte Anlagenteil
description: Beschreibung
area: Bereich
size: Größe
place: Mitte bei
sensors.name: Sensoren
worst: schlechteste Qualität: {quality}

[viewport]
waiting: Warten auf das erste Bild

[legend]
right: Legende der rechten Hälfte
colours: Farben von {min} bis {max}
distance: Abstand
operator: Nach den Grenzwerten jeder Messstelle.
log: Logarithmische Skala.
unsafe: Diese Farben können täuschen.
glossy: Glänzend: Licht ändert die Farben. Keine Werte ablesen.
nolimits: Ohne Grenzwerte
nodata: Keine Daten
uncertain: Unsicher

[card]
novalue: Kein Wert
quality: Qualität
age: Alter
on: An
trend: Trend
HH: über dem höchsten Grenzwert
H: über dem oberen Grenzwert
L: unter dem unteren Grenzwert
LL: unter dem tiefsten Grenzwert
BAD: Messung gestört
ALM: Alarm

[place]
measured: Hier gemessen
between: Zwischen Messpunkten
no data: Keine Daten: der nächste Sensor ist gestört, oder keiner reicht hin
context: Kein Sensor dieser Messgröße daran
inside: Inneres des Aufgeschnittenen
uncertain: {state}, unsicher
hide: Ausblenden
ghost: Durchsichtig
only: Nur dies

[following]
title: Dies ist die Ansicht von Sitzung {session}
own: Eigene Ansicht

[alarms]
title: Alarme
close: Alarme schließen
unheard: Alarme: noch nichts gehört
none: Keine aktiven Alarme
some(one): {count} aktiver Alarm
some(other): {count} aktive Alarme
waiting: {alarms}, {waiting} unquittiert
now: Jetzt: {alarms}
then: Gezeigt wird die Anlage von damals. Diese Alarme sind die von jetzt.
at: {alarm} bei {value}
value: {value} (Grenzwert {limit})
quiet: Keine aktiven Alarme.
aside: Zurückgestellt ({count})
more: und {count} weitere
since: seit {time}, {age}
until: bis {time}
by: durch {who}
held: Messung gestört: wie zuletzt
priority: Priorität {priority}
fly: Zu {tag} fliegen

[state]
active: Aktiv
unacknowledged: Nicht quittiert
acknowledged: Quittiert
returned: Gegangen, nicht quittiert
latched: Gehalten
shelved: Zurückgestellt
suppressed: Planmäßig unterdrückt
out_of_service: Außer Betrieb

[kind]
HH: Hoch hoch
H: Hoch
L: Tief
LL: Tief tief
BAD: Messung gestört
ALM: Alarm
LINK: Gerät liefert keine Werte

[action]
acknowledge: Quittieren
shelve: Zurückstellen …
reset: Zurücksetzen
unshelve: Wieder melden
in_service: In Betrieb nehmen

[mode]
display: Hier nur gezeigt, quittiert wird im Leitsystem
mirror: Wie das Leitsystem sie hat
local: Eigene Alarme dieses Standorts

[shelve]
title: {what} zurückstellen
for: Für
quarter: 15 Minuten
hour: 1 Stunde
shift: 8 Stunden
day: 1 Tag
reason: Grund
cancel: Abbrechen
do: Zurückstellen

[trends]
title: Trend
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
remove: {tag} entfernen
gaps: Schraffiert: kein Wert von {tags}
failed: Kein Trend: {why}
unsaved: Nicht exportiert: {why}
uncharted: dieser Server wurde ohne seine Diagramme gebaut (npm fehlte)

[time]
title: Verlauf
play: Abspielen
pause: Anhalten
speed: Geschwindigkeit
span: Zeitspanne des Schiebers
slider: Gezeigter Zeitpunkt
live: Zurück zu jetzt
now: Jetzt
ago: {instant} · vor {age}
unrecorded: nicht aufgezeichnet
raised(one): {count} Alarm gekommen
raised(other): {count} Alarme gekommen

[status]
clock: Anlagenzeit
then: Damals
unset: {clock}, nicht synchronisiert
unset.why: Nichts stellt die Uhr des Servers: Zeiten können falsch sein, Altersangaben nicht.
oldest: Ältester Messwert
frames: Bilder
rate: {count}/s
still: ruht
latency: Latenz
ms: {n} ms
config: Konfiguration
picture: Bild
retry: Jetzt versuchen

[health]
connecting: Verbinden
live: Live
partly: Live, teils simuliert
simulated: Simuliert
down: {live}, {down} von {all} Quellen gestört
unmeasured: Nicht in der Anlage gemessen: {sources}.
nodata: Keine Live-Daten
nosensor: Kein Sensor liefert Werte.
source: Quelle {source} antwortet nicht.
sources: Quellen {sources} antworten nicht.
past: Vergangenheit
returning: Zurück zu jetzt
playing: {instant}, Wiedergabe {speed}×
back: {instant}, Rücklauf {speed}×
noanswer: Keine Antwort
silent: Der Server schweigt seit {age}.
old: Dieses Bild ist {age} alt.
barred: Kein Zutritt
disconnected: Getrennt
because: {reason}.
retry: Nächster Versuch in {age}.
retrying: Neuer Versuch läuft.

[reason]
down: Der Server wurde beendet
version: Diese Seite und der Server haben verschiedene Versionen
forbidden: Nicht erlaubt
long: Eine Nachricht war zu lang
full: Der Server ist voll
slow: Diese Seite war zu langsam
unreachable: Der Server ist nicht erreichbar
unanswered: Der Server antwortet nicht
silent: Der Server ist verstummt
token_needed: Ein Token wird verlangt
bad_token: Dieses Token gilt nicht oder nicht mehr

[quality]
good: Gut
uncertain: Unsicher
bad: Schlecht
unknown: Unbekannt
because: {quality}: {detail}

[detail]
CommunicationError: Kommunikationsfehler
ConfigurationError: Konfigurationsfehler
DeviceFailure: Gerätefehler
NoCommunication: keine Kommunikation
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
follow: Sitzung {session}. Wer {link} öffnet, sieht diese Ansicht.

[token]
title: Token
needed: Dieser Server fragt, wer Sie sind.
bad: Dieses Token gilt nicht oder nicht mehr.
go: Weiter
note: Tokens macht, wer diesen Server betreibt: {command}. Es wird behalten, bis dieser Tab geschlossen wird.

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
from: Blick von
from.keys: [T] oben, [I] schräg, [O] parallel, [V] alle Ansichten, [P] Bild
what: Was dort ist
what.mouse: Klick
what.touch: Tippen
selected: Gewähltes
selected.keys: [X] ausblenden, [G] durchsichtig, [L] allein, [U] alle
quantity.keys: [1] bis [9]
equipment.keys: [B], suchen [/]
history.keys: [Y], zurück zu jetzt [N]
markers: Markierungen
mark.good: guter Messwert
mark.uncertain: unsicherer Messwert
mark.bad: gestört: kein Wert
mark.behind: verdeckt
mark.alarm: Alarm; die Farbe ist die Priorität
mark.acknowledged: quittierter Alarm
mark.returned: gegangen oder gehalten

[measure]
first: Ersten Punkt anklicken
second: Zweiten Punkt anklicken
done: Für eine neue Messung klicken
missed: Dort ist nichts: auf die Anlage klicken
end: Fertig
parts: waagrecht {level} m, Höhe {rise} m

[snapshot]
failed: Kein Bild: {why}
unnamed: ein Vergleich braucht Werte, die unter einem Namen behalten wurden

[share]
title: Teilen
what: Was sich öffnet
view: Ansicht
view.why: Öffnet diese Ansicht: Kamera, Größe, Farben, Zeitpunkt.
tag: Messstelle
tag.why: Öffnet sich an der Messstelle. Zum Ausdrucken und Anbringen.
asset: Apparat
asset.why: Öffnet sich am Apparat. Zum Ausdrucken und Anbringen.
follow: Mir folgen
follow.why: Wer ihn öffnet, sieht mit, solange Sie schauen.
link: Link
copy: Kopieren
copied: Kopiert
code: Der Link als Code zum Scannen
nocode: Dieser Server wurde ohne Codes zum Scannen gebaut (npm fehlte).
local: Öffnet sich nur auf diesem Rechner: seine Adresse hier ist eine lokale.
people: Wer mitschaut
followers(one): {count} folgt dieser Ansicht, Sitzung {session}.
followers(other): {count} folgen dieser Ansicht, Sitzung {session}.
lead: Sitzung {session} führen lassen

[simulated]
all: Simuliert
partly: Teilweise simuliert

[factor]
range: Bereich der Farben
min: Von
max: Bis
own: Der eigene der Größe
title: Wie das Feld berechnet wird
strength: Stärke
decay: Abfall
power: Exponent
radius_m: Radius m, 0: von selbst
reach_m: Reichweite m, leer: ohne
of: Nur von {tag}
choose: Eines Sensors: erst auswählen
reset(one): Wie eingestellt ({count} Sensor)
reset(other): Wie eingestellt ({count} Sensoren)

[proof]
none: Ungeprüft
fail: Ungeprüft: nicht bestanden
changed: Ungeprüft: seither geändert
pass: Geprüft

[eng]
title: Ingenieur
close: Feld des Ingenieurs schließen
place: Setzen
prove: Prüfen
what: Was zu tun ist
find: Messstelle suchen
nowhere: steht noch nirgends
on: an {asset}
choose: Eine Messstelle wählen, dann auf die Oberfläche klicken; oder ihr Zeichen ziehen.
click: {tag}: auf die Oberfläche klicken oder das Zeichen ziehen.
missed: Dort ist keine Oberfläche.
moves: Ausprobiert, nur für Sie
nomoves: Nichts ist versetzt. Was Sie ausprobieren, sehen nur Sie, bis es gespeichert ist.
off: {metres} m neben der Oberfläche
waiting: gerade Abstände, die entlang der Oberfläche folgen
straight: nur gerade Abstände
ready: entlang der Oberfläche
undo: Zurück
back: Alles zurück
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
diff.note: Die Liste, wie sie ist, bleibt daneben stehen. Danach gilt sie für alle; das dauert einige Sekunden.
diff.conflict: {file} wurde von jemand anderem geändert und ist noch nicht geladen. Nichts wurde gespeichert; das wurde geändert:
diff.more: … und {count} weitere Zeilen
cancel: Abbrechen
confirm: Speichern und in Kraft setzen
saving: Wird vorbereitet; alle sehen die Anlage noch, wie sie war.
saved: In Kraft. Die Liste davor ist {kept}.
unsaved: Nicht gespeichert: {text}
device: Gerät
proven: {done} von {count} geprüft
expected: Erwartet
tolerance: Toleranz ±
watch: Beobachten
watching: Jetzt den Messumformer verstellen.
still: Noch hat sich nichts bewegt.
moved: {tag} hat sich am meisten bewegt: um {by}.
swapped: {tag} hat sich bewegt, nicht {wanted}: sind sie vertauscht?
compare: Vergleichen
fails: Nicht bestanden
csv: Werte aus CSV …
csv.note: {count} erwartete Werte wurden gelesen.
csv.bad: Die Spalten Tag Name, Expected, Tolerance werden gebraucht.
export: Ergebnisse ausgeben
remark: Bemerkung
passed: {tag} bestanden: {value}.
failed: {tag} nicht bestanden: {why}.
now: jetzt {value}
`;
