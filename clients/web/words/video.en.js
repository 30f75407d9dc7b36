// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of plantcast-video, in English. The build makes a C header from this file; {} is replaced by a value.
export default `
starting: STARTING
not_let_in: ACCESS DENIED
no_view: NO SUCH VIEW
no_picture: NO PICTURE
too_slow: THE SERVER IS TOO SLOW
silent: THE SERVER DOES NOT RESPOND
no_connection: NO CONNECTION TO THE SERVER
no_values: NO LIVE VALUES
since: since {}
nothing_yet: no picture received yet
token: the server rejects this token: {}
tokens: the server checks no more tokens from this address for a while
answers: the server answers {}: {}
views: there is no view '{}'; the views are: {}
none: none
took: a picture took {} s; the limit is {} s; a smaller --size helps
past: the view shows a time in the past, but the video shows only the present
earlier: the server does not report the age of its values: it is an older version
no_png: the server did not send a PNG of {}x{}
no_answer: no answer
no_url: its parameters do not form a URL
no_value: the server is up, but no sensor shown delivers a value
said: {}
age_s: values up to {} s old
age_min: values up to {} min old
`;
