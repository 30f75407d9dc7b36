// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of the page say that are loaded when they are first used, in German.
export default `
accept: Angenommene Plätze bestätigen
close: Schließen
sun: aus {wind}, {height}° hoch

[distance]
metres: {metres} m
geodesic: Geodätisch
geodesic.why: Abstand entlang der Oberfläche: Wärme springt nicht über einen Spalt
euclidean: Euklidisch
euclidean.why: Gerader Abstand durch den Raum
heat: Wärme auf Punkten
heat.why: Wie der Aufsatz sie findet, auf Punkten der Oberfläche, zum Vergleich: irrt um ein halbes Prozent, geht durch dünne Wände

[interpolation]
shepard: Shepard
shepard.why: Inverser Abstand: an jedem Messpunkt genau der Messwert
paper: Paper
paper.why: Algorithmus 1 von Kim & Suh 2025: glatter, erreicht die Messwerte nicht
harmonic: Wärmeleitung
harmonic.why: Stationäre Wärmeleitung in der Wand zwischen Messpunkten.
  Nicht, wo Medium oder Luft die Wärme abführt, nicht für Druck oder Durchfluss
fin: Leitung und Verlust
fin.why: Wie Wärmeleitung, aber die Wand verliert Wärme an die Luft; unbekannt, wo Messpunkte unter ein Zehntel sagen.
  Nicht für gedämmte oder beheizte Wände
gp: Am wahrscheinlichsten
gp.why: Gauß-Prozess: wahrscheinlichstes Feld mit seiner Unsicherheit. Nicht, wo Teile sich berühren, die nichts miteinander zu tun haben

[bar]
distance: Abstand
interpolation: Interpolation

[neighbours]
say: Andere sagen
above: {predicted}; zeigt {by} mehr
below: {predicted}; zeigt {by} weniger
title: Sensoren mit größter Abweichung
why: Was jeder zeigt, und was die anderen seiner Anlage ohne ihn sagen. Nicht, wo einer abweichen soll, wie am Einlass.

[drift]
week: Drift in einer Woche
found: {by}: driftet
none: {by}: keine Drift zu sehen
unknown: {by}: nicht feststellbar
why: Weg von dem, was die anderen sagen, nach Stundenmitteln. Nicht, wo die Anlage selbst die Unterschiede ändert.

[coverage]
since: seit {when}
title: Was Sensoren abdecken
none: Aus
uncertainty: Unsicherheit
uncertainty.note: Standardabweichung nach den Sensoren, die jetzt gut sind.
uncertainty.why: So weit kann das Feld irren, wenn sich die Fläche verhält, wie gp es erwartet. Nicht, wo die Reichweite geraten ist.
blind: Blinde Stellen
blind.of: Sichtbarer Hotspot: {name}
blind.note: Kleinster Hotspot von {size} m, von dem der nächste Sensor 5 % des Bereichs anzeigt.
blind.why: So heiß muss eine kleine Stelle werden, bis ein Sensor sie zeigt. Nicht für andere Formen oder andere Wege der Wärme.

[picture]
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

[arrows]
title: Richtungen
arrows: Pfeile
arrows.why: So lang wie der Wert. Nicht zwischen Flächen und nicht als berechnete Strömung: sie interpolieren, was Sensoren sagen.
strokes: Striche
strokes.why: Wohin es geht; sie laufen schneller, wo der Wert größer ist. Nicht als Bahnen eines Fluids: sie interpolieren Sensoren.
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

[walls]
unknown: Eine Wand „{id}“ steht nicht in der Anlagendatei. Es gibt: {known}
display: Die Wand „{id}“ hat {count} Bildschirme und keinen Bildschirm {n}
lost: Keine Verbindung zur Anlage seit {time}
never: Keine Verbindung zur Anlage
self: Bildschirm {display} von {wall}, wartet seit {time}
denied: Dieser Bildschirm braucht ein eigenes Token
digits: Wer die Rolle engineer hat, gibt diese Ziffern auf der Seite unter „Ansichten“ ein
asks: Dieser Bildschirm fragt den Server nach den Ziffern, mit denen er eingelassen wird
left: Diese Ziffern gelten noch {time}
place: Bildschirm {display} von {wall}
crowded: Zu viele Bildschirme warten darauf, eingelassen zu werden; dieser fragt wieder
nowhere: In der Anlagendatei gibt es keinen Bildschirm {display} einer Wand „{wall}“
token: Token
enter: Eingeben
held: festgehalten von {who} seit {time}
sent: gesendet von {who}, {time}
age: Daten {age} alt
since: seit {time}
many: {count} Alarme, schwerster {worst}
more(one): und {count} weiterer
more(other): und {count} weitere
counts: {active} aktiv, {waiting} zu quittieren
flood: Alarmschwall: {active} aktiv, {waiting} zu quittieren
late: Die Verbindung zu dieser Anzeige ist zu langsam; ausgelassen seit {time}
missing: Fehlt: Anzeige {displays}

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
unheard: Der Server dieser Anlage sagt nichts über sie

[notes]
legend: Notizen
text: Notiz für die Schicht
at: Woran
until: Bis wann
save: Notieren
place: diese Stelle
choose: Apparat oder Messstelle wählen
ends: bis {time}
handover: Schichtübergabe

[until]
shift: 8 Stunden
day: ein Tag
week: eine Woche
ever: bis zum Entfernen

[remote]
legend: Großbild
pane: Feld einer Bildwand
desk: Name dieses Platzes
where: {wall} {display}: {area}
send: Gezeigtes senden
hold: Festhalten
back: Zurückgeben
point: Mit der Maus zeigen
there: verbunden
gone: dieser Schirm ist nicht verbunden
sent: {title}, gesendet von {who}, {time}
held: festgehalten von {who}, {time}

[devices]
legend: Bildschirme
digits: Sechs Ziffern eines Bildschirms
pair: Einlassen
revoke: Widerrufen
is: Bildschirm {display} von {wall}, von {from}, eingelassen von {who}, {time}

[handover]
title: Schichtübergabe, {plant}
last: Die letzten
hours: {n} Stunden
print: Drucken oder als PDF sichern
notes: Notizen
standing: Steht jetzt an
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
cut: Es gab mehr Alarme, als hier stehen
gives: Übergeben von
takes: Übernommen von
denied: Die Übergabe ist für Operatoren: aus der Seite öffnen, angemeldet oder mit Token

[named]
legend: Benannte Ansichten
title: Name für das Gezeigte
save: Speichern
unknown: Eine Ansicht „{id}“ gibt es hier nicht
wrong: Diese Ansicht lässt sich nicht zeigen: {why}
more: Mehr zu {title}
by: {who}, {time}
update: Gezeigtes hier speichern
up: Nach oben
down: Nach unten
remove: Entfernen
look: Zeigen
back: Zurückholen

[views]
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
hidden: {hidden} von {all} ausgeblendet
ghosts(one): {count} durchsichtig
ghosts(other): {count} durchsichtig

[assets]
description: Beschreibung
area: Bereich
missing: Fehlt
size: Größe
place: Mitte bei
sensors.name: Sensoren

[wall]
far: Auf diesem Bildschirm sind die Buchstaben bis {metres} m groß genug, nicht bis {wanted} m.

[callout]
held: gehalten seit {time}
count: {count} Alarme
worst: schwerster

[card]
novalue: Kein Wert
quality: Qualität
age: Alter
on: An
trend: Trend
add: Zum Trend dazu
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
equipment: Ein Sensor steht für das Ganze: sein Ort ist angenommen
inside: Inneres des Aufgeschnittenen
uncertain: {state}, unsicher
drawn: Für diesen Punkt berechnet. Das Bild ringsum kann um bis zu {value} abweichen
hide: Ausblenden
ghost: Durchsichtig
only: Nur dies

[following]
title: Dies ist die Ansicht von Sitzung {session}
gone: Sitzung {session} ist gegangen: dies ist ihre letzte Ansicht
awaited: Sitzung {session} ist nicht da: es wird auf sie gewartet

[outside]
title: Nicht in der ersten Ansicht, bis {far} entfernt: {names}
more: {names} und {count} weitere
all: Alles zeigen
close: Hinweis schließen

[alarms]
close: Alarme schließen
then: Gezeigt wird die Anlage von damals. Diese Alarme sind die von jetzt.
quiet: Keine aktiven Alarme.
aside: Zurückgestellt ({count})
more: und {count} weitere
since: seit {time}, {age}
until: bis {time}
by: durch {who}
held: Messung gestört: wie zuletzt
fly: Zu {tag} fliegen
stale: Nicht von jetzt: Stand {time}, als die Verbindung abbrach.
which: Welche Alarme
search: Filtern
filtered: Der Filter lässt keinen von {count} durch.
choose: {tag} auswählen
chooseall: Alle gezeigten
acknowledge: {count} quittieren
also: auch {what}

[which]
all: Alle
waiting: Zu quittieren
active: Aktiv
gone: Ursache gegangen

[state]
active: Aktiv
unacknowledged: Nicht quittiert
acknowledged: Quittiert
returned: Gegangen, nicht quittiert
latched: Gehalten
shelved: Zurückgestellt
suppressed: Planmäßig unterdrückt
out_of_service: Außer Betrieb

[action]
acknowledge: Quittieren
shelve: Zurückstellen …
reset: Zurücksetzen
unshelve: Wieder melden
in_service: In Betrieb nehmen

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
before: Voriger Alarm
after: Nächster Alarm
goto: Gehe zu
first: Kein früherer Alarm ist aufgezeichnet
last: Kein späterer Alarm ist aufgezeichnet
play: Abspielen
pause: Anhalten
speed: Geschwindigkeit
span: Zeitspanne des Schiebers
slider: Gezeigter Zeitpunkt
live: Zurück zu jetzt
now: Jetzt
ago: {instant} · vor {age}
lost: {source}: ausgefallen
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
follow: Sitzung {session}. Wer {link} öffnet, sieht diese Ansicht.

[account]
title: Wer Sie sind
viewer: darf ansehen
operator: ist Operator
engineer: ist Engineer
open: darf das Bild ansehen
nobody: Hier kennt Sie niemand.
person: Sie haben sich beim Identitätsanbieter angemeldet.
token: Sie sind mit einem Token hier.
here: Sie sind am Server selbst, wo niemand gefragt wird.
in: Anmelden: {provider}
out: Abmelden

[token]
title: Token
needed: Dieser Server fragt, wer Sie sind.
bad: Dieses Token gilt nicht oder nicht mehr.
locked: Eine Zeit lang war niemand an dieser Seite. Weisen Sie sich erneut aus.
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
back: Zurück vor den letzten Flug
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
crowd: Wo sich Markierungen drängen, fehlen einige; aus der Nähe sind alle da. Alarme fehlen nie.

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
shown: Speichern, was zu sehen ist
shown.note: Pixel für Pixel, mit den Werten, die es zeigt; ohne Legende, Marken und Uhr.
again: Mit Legende und Marken speichern
again.note: Vom Server noch einmal gezeichnet. Beide sind signiert: „plantcast verify“ findet, was daran geändert wurde.
late: es kam kein signiertes Bild

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
alone: Niemand folgt dieser Ansicht, Sitzung {session}.
followers(one): {count} folgt dieser Ansicht, Sitzung {session}.
followers(other): {count} folgen dieser Ansicht, Sitzung {session}.
lead: Sitzung {session} führen lassen

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
fail: Ungeprüft: nicht bestanden
changed: Ungeprüft: seither geändert
pass: Geprüft

[eng]
title: Ingenieur
close: Feld des Ingenieurs schließen
place: Setzen
prove: Prüfen
method: Feld
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
left: nicht an {asset}, wie die Liste sagt
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
diff.left: {tag} war an {left} und ist jetzt an {asset}: Ist das gewollt?
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

[accept]
asset: Anlagenteil
all: alle ({count})
tags: Messstellen
pattern: Name oder Beschreibung; * und ? in Namen
within: Abstand zur Fläche, höchstens (m)
confidence: Sicherheit, mindestens (0 bis 1)
count(one): {count} Platz würde bestätigt. Er ist im Bild blau umringt.
count(other): {count} Plätze würden bestätigt. Sie sind im Bild blau umringt.
none: Kein Platz würde bestätigt.
nowhere: {count} ausgelassen: weder Knoten noch Position in der Liste
missing: {count} ausgelassen: das Anlagenteil hat kein Modell
far: {count} ausgelassen: weiter von der Fläche entfernt
unsure: {count} ausgelassen: geringere oder keine bekannte Sicherheit
go: {count} bestätigen
saved(one): {count} Platz bestätigt. Die vorige Liste ist als {kept} aufgehoben.
saved(other): {count} Plätze bestätigt. Die vorige Liste ist als {kept} aufgehoben.
undo: Zurück zu {kept} …
changed: Nichts wurde bestätigt: die Liste hat sich geändert. Bitte die Zahl prüfen und noch einmal bestätigen.
undone: Zurückgenommen. {kept} gilt wieder.
`;
