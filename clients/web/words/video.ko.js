// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of plantcast-video, in Korean. The build makes a C header from this file; {} is replaced by a value.
export default `
starting: 시작하는 중
not_let_in: 접근 거부
no_view: 해당 뷰 없음
no_picture: 화면 없음
too_slow: 서버가 너무 느림
silent: 서버가 응답하지 않음
no_connection: 서버에 연결되지 않음
no_values: 실시간 값 없음
since: {}부터
nothing_yet: 아직 받은 화면이 없습니다
token: 서버가 이 토큰을 거부합니다: {}
tokens: 서버가 이 주소의 토큰을 잠시 동안 확인하지 않습니다
answers: 서버 응답 {}: {}
views: 뷰 '{}'이(가) 없습니다. 있는 뷰: {}
none: 없음
took: 화면 하나에 {}초가 걸렸으며 한도는 {}초입니다. --size를 줄이면 도움이 됩니다
past: 이 뷰는 과거 시점을 표시하지만 비디오는 현재만 표시합니다
earlier: 서버가 값의 경과 시간을 알리지 않습니다. 이전 버전의 서버입니다
no_png: 서버가 보낸 것이 {}x{} PNG가 아닙니다
no_answer: 응답 없음
no_url: 매개변수로 URL을 만들 수 없습니다
no_value: 서버는 연결되어 있으나 표시된 센서 중 값을 보내는 것이 없습니다
said: {}
age_s: 값의 경과 시간 최대 {}초
age_min: 값의 경과 시간 최대 {}분
`;
