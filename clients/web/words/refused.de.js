// SPDX-License-Identifier: GPL-3.0-or-later
// Texts for the server's refusals, in German. Keys before the first [section] are the server's refusal codes, with the
// arguments of PROTOCOL.md.
export default `
role_operator: dafür ist die Rolle Operator nötig
role_engineer: dafür ist die Rolle Engineer nötig
no_group: diese Anlage hat keine Messgröße „{name}“
no_asset: diese Anlage hat kein Anlagenteil „{name}“
no_tag: diese Anlage hat keine Messstelle „{name}“
no_device: diese Anlage hat kein Gerät „{name}“
no_view: diese Anlage hat keine Ansicht „{name}“
unknown: „{name}“ ist hier nicht bekannt
uncut: „Kim & Suh“ lässt sich nicht genau zeichnen, wo {group} nur einen Sensor hat ({count} von {all} Anlagenteilen,
  zuerst {asset}). Abhilfe: in der Anlagendatei bei dieser Gruppe „singles: cut“ setzen.
far_uncut: Abstände lassen sich nicht genau zeichnen, wo {group} nur einen Sensor hat, wie an {asset}. Abhilfe: in der
  Anlagendatei bei dieser Gruppe „singles: cut“ setzen.
assumed: der Ort dieses Sensors an {asset} ist nicht angegeben: Abstände von ihm gibt es nicht
elsewhere: die Alarme verwaltet ein anderes System
anew: die Anlage wird neu geladen; bitte erneut versuchen
quiet: es gibt nichts zu quittieren
latched: zurücksetzen lässt sich nur ein quittierter Alarm mit Selbsthaltung, der nicht mehr aktiv ist
otherwise: sein Zustand hat sich inzwischen geändert
shelf: ein Alarm kann höchstens eine Woche zurückgestellt werden
tolerance: der Wert liegt außerhalb der Toleranz
reading: der Messwert ist nicht gut
failed: als nicht bestanden gemeldet
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
note_others: nur wer diese Notiz geschrieben hat, {author}, kann sie ändern
note_not_own: nur wer diese Notiz geschrieben hat, {author}, oder jemand mit der Rolle Engineer kann sie beenden
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
log: eine logarithmische Skala braucht einen Bereich, der bei 1e-18 oder darüber beginnt
range: das Ende des Bereichs muss seinen Anfang um mindestens 1e-18 und ein Millionstel des größeren Betrags übertreffen
between: erwartet wird eine Zahl von {low} bis {high}
placeless: dieser Sensor hat für diese Messgröße keinen Ort
narrow: das Bild ist zu schmal zum Teilen
memory: dem Server fehlt Speicher; das letzte Bild bleibt
gone: dieser Benutzer ist nicht mehr verbunden
linkless: dieser Kurzlink ist unbekannt oder nicht mehr gespeichert: einen neuen anfordern
links_often: es wurden zu viele Kurzlinks erstellt; bitte in einer Minute erneut versuchen
coreless: nicht verfügbar: der Kernserver ist nicht erreichbar; bitte erneut versuchen
unrecorded: es wird nichts aufgezeichnet (history: record: no)
core_checks: Loop-Checks zeichnet nur der Kernserver auf: bitte dessen Seite öffnen
unreadable: die Aufzeichnung ist nicht lesbar; den Grund nennt das Protokoll des Servers
token_needed: ein Token ist nötig: melden Sie sich an, oder senden Sie Authorization: Bearer TOKEN
token_unknown: dieses Token ist unbekannt oder abgelaufen
token_ended: dieses Token ist abgelaufen oder wurde widerrufen
signed_out: Sie sind abgemeldet
token_guesses: von dieser Adresse kamen zu viele falsche Tokens; in 5 s erneut versuchen
token_node: dieses Token gehört einem Dienst (Rolle renderer oder standby), keinem Benutzer
token_views: „{name}“ ist nicht erlaubt: dieses Token gilt für die Ansichten {views}
token_display: dieses Token gehört zu Bildschirm {display} der Videowand {wall}
views_only: dieses Token gilt nur für Bilder einiger Ansichten
display_only: das Token dieses Geräts gilt nur für seinen Bildschirm der Videowand
pictures_only: ohne das Token eines Benutzers sind nur Bilder verfügbar
foreign: die Anfrage kommt von einer Seite einer anderen Website
connections: diese Adresse hat ihre Höchstzahl an Verbindungen erreicht; später erneut versuchen
locked: seit {minutes} min keine Eingabe auf dieser Seite
pixels: alle Ansichten zusammen haben die Pixelgrenze dieses Servers erreicht; später oder mit kleinerem Bild versuchen
pixels_address: diese Adresse hat die Höchstzahl an Pixeln erreicht; mit kleinerem Bild noch einmal versuchen
pixels_view: dieser Server zeichnet höchstens {count} Pixel für eine Ansicht
movers: eine weitere bewegte Ansicht würde alle zu langsam machen; später versuchen
late: Messwerte erscheinen schon verspätet; später noch einmal versuchen
tile_token: dafür ist das Token von Bildschirm {display} der Videowand {wall} oder die Rolle Engineer nötig
tileless: Bildschirm {display} der Videowand {wall} ist keine ihrer Kacheln
display_token: ein Bildschirm einer Videowand braucht ein Token
unpaired: Bildschirme brauchen hier kein Token
signed_token: signierte Bilder enthalten Messwerte: dafür ist ein Token nötig
signed_display: Bilder von Bildschirmen und Bilder für Tokens, die nur für einige Ansichten gelten, werden nicht
  signiert
signed_key: dieser Server hat keinen Schlüssel zum Signieren (plantcastd --signing-key)
unsigned: der Server konnte ein Bild nicht signieren
unsigned_trial: Sensoren sind probeweise an andere Orte versetzt
unsigned_baseline: der Vergleichsstand hat keinen Namen
unsigned_long: die Ansicht hat zu viele Argumente
overrides: höchstens {count} Sensoren lassen sich zugleich übersteuern
breakless: die Anlagendatei nennt für {group} kein „{key}“
name_expected: erwartet wird ein Name von 1 bis {bytes} Bytes ohne Steuerzeichen, nicht „now“
text_expected: erwartet wird ein Text von {least} bis {bytes} Bytes ohne Steuerzeichen
pattern: höchstens vier * sind erlaubt, und kein [
instants: der erste Zeitpunkt muss vor dem zweiten liegen
importing: ein anderer Import läuft; warten Sie auf sein Ende, oder brechen Sie ihn ab
import_values: units und mesh_units sind m, mm, cm, in oder ft; up ist y oder z; encoding ist ein Name wie GB18030; what ist
  tags, anew oder fehlt
import_device: host ist ein Name oder eine IPv4-Adresse, port 1 bis 65535, unit 0 bis 255, order ABCD, CDAB, BADC oder DCBA,
  base 0 oder 1
fileless: keine hochgeladene Datei heißt so
file_name: dieser Dateiname ist nicht erlaubt: höchstens 200 Bytes, kein Schrägstrich, kein Steuerzeichen, kein Punkt am Anfang
file_empty: die Datei ist leer
file_length: die Kopfzeile Content-Length fehlt
file_large: die Datei ist größer als 2 GB
files: höchstens 64 Dateien können hochgeladen sein; entfernen Sie einige
files_large: alle Dateien zusammen wären größer als 8 GB
uploads: vier Uploads laufen; warten Sie, bis einer fertig ist
upload_slow: der Upload ist zu langsam: weniger als 10 kB/s
upload_cut: der Upload endete, bevor die Datei vollständig war

[class]
too_fast: zu viele Anfragen: Ihre wird verzögert
limit: das Bild ist zu groß für diesen Server
not_allowed: hier nicht erlaubt
core_lost: der Kernserver ist nicht erreichbar: vielleicht wurde nichts ausgeführt; bitte prüfen, sobald er zurück ist

[page]
refused: Der Server hat abgelehnt: {text}
other: auf Englisch: „{text}“
blocked: Der Server antwortet über HTTP, aber {proxy} leitet den WebSocket nicht weiter. {needs}
blocked_proxy: ein Proxy zwischen Browser und Server
blocked_lines: Nötig ist {lines} in seinem location-Block
blocked_page: Was er braucht, steht in PROXY.md, „WebSocket“
link: Dieser Link passt nicht: {why}. Er kann zu einer anderen Anlage gehören oder älter sein als eine Änderung der Anlage.
unkept: Angewendet, aber nach einem Neustart des Servers verloren ({text})
unaudited: Ausgeführt, fehlt aber im Audit-Trail ({text})
`;
