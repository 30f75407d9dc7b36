// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of plantcast-video, in German. The build makes a C header from this file; {} is replaced by a value.
export default `
starting: STARTET
not_let_in: ZUGRIFF VERWEIGERT
no_view: DIESE ANSICHT GIBT ES NICHT
no_picture: KEIN BILD
too_slow: DER SERVER IST ZU LANGSAM
silent: DER SERVER ANTWORTET NICHT
no_connection: KEINE VERBINDUNG ZUM SERVER
no_values: KEINE AKTUELLEN WERTE
since: seit {}
nothing_yet: noch kein Bild empfangen
token: der Server nimmt dieses Token nicht an: {}
tokens: der Server prüft eine Weile keine Tokens dieser Adresse mehr
answers: der Server antwortet {}: {}
views: eine Ansicht „{}“ gibt es nicht; es gibt: {}
none: keine
took: ein Bild dauerte {} s; erlaubt sind {} s; ein kleineres --size hilft
past: die Ansicht zeigt einen Zeitpunkt in der Vergangenheit, das Video zeigt aber nur die Gegenwart
earlier: der Server meldet das Alter seiner Werte nicht: er ist älter
no_png: der Server sendete kein PNG von {}x{}
no_answer: keine Antwort
no_url: seine Parameter ergeben keine URL
no_value: der Server läuft, aber kein gezeigter Sensor liefert einen Wert
said: {}
age_s: Werte bis zu {} s alt
age_min: Werte bis zu {} min alt
`;
