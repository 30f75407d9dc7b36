// SPDX-License-Identifier: GPL-3.0-or-later
// Texts for the server's refusals, in Korean. Keys before the first [section] are the server's refusal codes, with the
// arguments of PROTOCOL.md.
export default `
role_operator: 운전원 권한이 필요합니다
role_engineer: 엔지니어 권한이 필요합니다
no_group: 이 플랜트에는 측정량 “{name}”이(가) 없습니다
no_asset: 이 플랜트에는 설비 “{name}”이(가) 없습니다
no_tag: 이 플랜트에는 태그 “{name}”이(가) 없습니다
no_device: 이 플랜트에는 장치 “{name}”이(가) 없습니다
no_view: 이 플랜트에는 뷰 “{name}”이(가) 없습니다
unknown: 여기에는 “{name}”이(가) 없습니다
uncut: {group}의 센서가 하나뿐인 설비({all}개 중 {count}개, 첫째 {asset})에서는 “Kim & Suh” 방식을
  정확히 그릴 수 없습니다. 플랜트 파일의 그 그룹에 “singles:
  cut”을 쓰면 됩니다.
far_uncut: {group}의 센서가 하나뿐인 설비({asset} 등)에서는 거리를 정확히 그릴 수 없습니다.
  플랜트 파일의 그 그룹에 “singles: cut”을 쓰면 됩니다.
assumed: 이 센서가 {asset}의 어디에 있는지 알려지지 않아 거리를 그릴 수 없습니다
elsewhere: 알람은 다른 시스템이 관리합니다
anew: 플랜트를 다시 불러오는 중입니다. 다시 시도하세요
quiet: 확인할 알람이 없습니다
latched: 래치되어 있고 확인되었으며 더 이상 활성이 아닌 알람만 리셋할 수 있습니다
otherwise: 그사이 상태가 바뀌었습니다
shelf: 알람은 최대 일주일까지 보류할 수 있습니다
tolerance: 값이 허용 오차를 벗어났습니다
reading: 측정값이 정상이 아닙니다
failed: 불합격으로 보고했습니다
disk: 저장되지 않음: 서버 디스크에 쓸 수 없습니다
disk_full: 저장되지 않음: 서버 디스크가 가득 찼습니다
disk_locked: 저장되지 않음: 서버 디스크가 읽기 전용입니다
disk_slow: 저장되지 않음: 서버 디스크가 응답하지 않습니다
kept_unread: 저장되지 않음: 서버가 이전 항목의 파일을 읽을 수 없습니다. 이유는 서버 로그에 있습니다
not_utf8: 저장되지 않음: 텍스트가 UTF-8이 아닙니다
fixed: 이 뷰는 플랜트 파일에 있습니다. 거기서 바꾸세요
viewless: 다른 사람이 이 뷰를 삭제했습니다
digits: 이 코드를 표시하는 디스플레이가 없습니다
guesses: 틀린 코드를 너무 많이 입력했습니다. 1분 뒤에 다시 시도하세요
deviceless: 이 이름으로 페어링된 디스플레이가 더 이상 없습니다
devices: 디스플레이 수가 한도에 도달했습니다
views: 뷰를 더 저장할 수 없습니다. 먼저 하나를 삭제하세요
notes: 메모를 더 저장할 수 없습니다. 먼저 하나를 삭제하세요
note_ended: 메모의 종료 시각이 이미 지났습니다
noteless: 다른 사람이 이 메모를 삭제했거나 메모가 만료되었습니다
note_others: 이 메모는 작성자({author})만 수정할 수 있습니다
note_not_own: 이 메모는 작성자({author}) 또는 엔지니어만 종료할 수 있습니다
computed: {tag}은(는) 다른 태그로 계산됩니다. 그 태그들을 검증하세요
far: {tag}: {asset}에서 너무 먼 위치입니다
groupless: {tag}이(가) 속한 그룹이 없습니다. 태그 목록에 그룹을 적으세요
twice: {tag}을(를) 두 번 옮겼습니다
busy: 다른 목록을 적용하는 중입니다
unmoved: 옮긴 센서가 없습니다
unread: 플랜트를 불러올 때 태그 목록을 읽을 수 없었습니다
unread_file: {file}을(를) 읽을 수 없습니다: {error}
unwritten: {file}을(를) 쓸 수 없습니다: {error}
no_tag_column: 태그 목록에 “Tag Name” 열이 없습니다
unlisted: {tag}이(가) 태그 목록에 없습니다
folder_locked: 데몬이 태그 목록 폴더에 쓸 수 없습니다({file})
changed: {file}을(를) 그사이 다른 사람이 바꾸었습니다
kept: 비교 기준이 이미 {count}개 저장되어 있습니다. 먼저 하나를 지우세요
lines: 간격이 {step}이면 선이 {count}개를 넘습니다
numbers: 최대 {count}개의 숫자를 작은 것부터 적으세요
log: 로그 눈금에는 1e-18 이상에서 시작하는 범위가 필요합니다
range: 범위의 끝은 시작보다 1e-18 이상, 그리고 더 큰 절댓값의 백만분의 1 이상 커야 합니다
between: {low}에서 {high}까지의 수가 필요합니다
placeless: 이 센서는 이 측정량에 대한 위치가 없습니다
narrow: 화면이 좁아 둘로 나눌 수 없습니다
memory: 서버 메모리가 부족하여 마지막 화면이 유지됩니다
gone: 이 사용자는 더 이상 연결되어 있지 않습니다
linkless: 이 짧은 링크는 알 수 없거나 더 이상 저장되어 있지 않습니다: 새 링크를 요청하세요
links_often: 짧은 링크를 너무 많이 만들었습니다. 1분 뒤에 다시 시도하세요
coreless: 사용할 수 없음: 코어에 연결할 수 없습니다. 다시 시도하세요
unrecorded: 이력을 기록하지 않습니다 (history: record: no)
core_checks: 루프체크는 코어에서만 기록합니다. 코어의 페이지를 여세요
unreadable: 기록을 읽을 수 없습니다. 이유는 서버 로그에 있습니다
token_needed: 토큰이 필요합니다. 로그인하거나 Authorization: Bearer TOKEN을 보내세요
token_unknown: 알 수 없거나 만료된 토큰입니다
token_ended: 토큰이 만료되었거나 취소되었습니다
signed_out: 로그아웃되었습니다
token_guesses: 이 주소에서 틀린 토큰이 너무 많이 왔습니다. 5초 뒤에 다시 시도하세요
token_node: 이 토큰은 사용자가 아니라 데몬(renderer 또는 standby 역할)의 것입니다
token_views: “{name}”은(는) 허용되지 않습니다. 이 토큰은 뷰 {views}에만 쓸 수 있습니다
token_display: 이 토큰은 상황판 {wall}의 디스플레이 {display}에만 쓸 수 있습니다
views_only: 이 토큰은 일부 뷰의 이미지에만 쓸 수 있습니다
display_only: 이 장치의 토큰은 해당 상황판 디스플레이에만 쓸 수 있습니다
pictures_only: 사용자 토큰이 없으면 이미지만 받을 수 있습니다
foreign: 다른 사이트의 페이지에서 온 요청입니다
connections: 이 주소의 연결 수가 한도에 도달했습니다. 나중에 다시 시도하세요
locked: 이 페이지에 {minutes}분 동안 입력이 없었습니다
pixels: 모든 뷰의 픽셀 합이 서버 한도에 도달했습니다. 나중에 또는 더 작은 화면으로 시도하세요
pixels_address: 이 주소의 뷰가 픽셀 한도에 도달했습니다. 더 작은 화면으로 시도하세요
pixels_view: 이 서버는 뷰 하나에 최대 {count}픽셀을 그립니다
movers: 움직이는 뷰가 하나 더 있으면 모두 너무 느려집니다. 나중에 시도하세요
late: 측정값 표시가 이미 지연되고 있습니다. 나중에 다시 시도하세요
tile_token: 상황판 {wall}의 디스플레이 {display} 토큰 또는 엔지니어 권한이 필요합니다
tileless: 상황판 {wall}에 디스플레이 {display} 타일이 없습니다
display_token: 상황판 디스플레이에는 토큰이 필요합니다
unpaired: 여기서는 디스플레이에 토큰이 필요하지 않습니다
signed_token: 서명된 이미지에는 측정값이 들어 있어 토큰이 필요합니다
signed_display: 디스플레이의 이미지와 일부 뷰용 토큰의 이미지는 서명되지 않습니다
signed_key: 이 서버에는 서명 키가 없습니다 (plantcastd --signing-key)
unsigned: 서버가 이미지에 서명하지 못했습니다
unsigned_trial: 센서를 다른 위치에 시험 배치한 상태입니다
unsigned_baseline: 비교 기준에 이름이 없습니다
unsigned_long: 뷰의 인수가 너무 많습니다
overrides: 설정을 바꿀 수 있는 센서는 한 번에 최대 {count}개입니다
breakless: 플랜트 파일에 {group}의 “{key}”이(가) 없습니다
name_expected: 제어 문자가 없는 1~{bytes}바이트의 이름이 필요합니다(“now” 제외)
text_expected: 제어 문자가 없는 {least}~{bytes}바이트의 텍스트가 필요합니다
pattern: *는 최대 네 개까지이며 [는 쓸 수 없습니다
instants: 첫 시각은 둘째 시각보다 앞서야 합니다
importing: 다른 가져오기가 실행 중입니다. 끝나기를 기다리거나 취소하세요
import_values: units와 mesh_units는 m, mm, cm, in 또는 ft, up은 y 또는 z, encoding은 GB18030 같은 이름, what은
  tags나 anew이거나 없어야 합니다
import_device: host는 이름 또는 IPv4 주소, port는 1~65535, unit은 0~255, order는 ABCD, CDAB, BADC 또는 DCBA, base는
  0 또는 1입니다
fileless: 이 이름으로 올린 파일이 없습니다
file_name: 허용되지 않는 파일 이름입니다. 최대 200바이트이고, 빗금과 제어 문자가 없어야 하며,
  점으로 시작할 수 없습니다
file_empty: 파일이 비어 있습니다
file_length: Content-Length 헤더가 없습니다
file_large: 파일이 2 GB보다 큽니다
files: 파일은 최대 64개까지 올릴 수 있습니다. 일부를 제거하세요
files_large: 모든 파일의 합이 8 GB를 넘게 됩니다
uploads: 업로드 네 개가 진행 중입니다. 하나가 끝날 때까지 기다리세요
upload_slow: 업로드가 너무 느립니다(10 kB/s 미만)
upload_cut: 파일이 모두 전송되기 전에 업로드가 중단되었습니다

[class]
too_fast: 요청이 너무 많아 처리가 지연됩니다
limit: 이 서버가 그릴 수 있는 크기보다 화면이 큽니다
not_allowed: 여기서는 허용되지 않습니다
core_lost: 코어에 연결할 수 없습니다. 요청이 처리되지 않았을 수 있으니 연결이 복구된 뒤 확인하세요

[page]
refused: 서버가 거부했습니다: {text}
other: 영어로 “{text}”
blocked: 서버는 HTTP로 응답하지만 {proxy}이(가) WebSocket을 전달하지 않습니다. {needs}
blocked_proxy: 중간 프록시
blocked_lines: location 블록에 {lines} 설정이 필요합니다
blocked_page: 필요한 설정은 PROXY.md의 “WebSocket”에 있습니다
link: 이 링크는 맞지 않습니다: {why}.
  다른 플랜트의 링크이거나 플랜트가 바뀌기 전의 링크일 수 있습니다.
unkept: 적용되었지만 서버를 다시 시작하면 사라집니다 ({text})
unaudited: 처리되었지만 감사 기록에 남지 않았습니다 ({text})
`;
