// SPDX-License-Identifier: GPL-3.0-or-later
// Words of plantcast-video, in English. The build makes a C header from it; a value takes the place of each {}.
export default `
starting: STARTING
not_let_in: NOT LET IN
no_view: NO SUCH VIEW
no_picture: NO PICTURE
too_slow: THE SERVER IS TOO SLOW
silent: THE SERVER IS SILENT
no_connection: NO CONNECTION TO THE SERVER
no_values: NO LIVE VALUES
since: since {}
nothing_yet: no picture has come yet
token: the server does not take this token: {}
tokens: the server looks at no more tokens of this address for a while
answers: the server answers {}: {}
views: there is no view '{}'; there are: {}
none: none
took: a picture took it {} s, and may take {}; a smaller --size helps
earlier: the server does not say how old its values are: it is of an earlier version
no_png: what the server sent is no PNG of {}x{}
no_answer: it does not answer
no_url: its parameters make no URL
no_value: the server is there, and no sensor that is shown tells a value
said: {}
age_s: values up to {} s old
age_min: values up to {} min old
`;
