// SPDX-License-Identifier: GPL-3.0-or-later
// Refusals, in Korean. Keys before the first [section] are codes of the server, with the arguments of PROTOCOL.md.
export default `
role_operator: 운전원 권한이 필요합니다
role_engineer: 엔지니어 권한이 필요합니다
no_group: 이 플랜트에는 “{name}” 물리량 항목이 없습니다
no_asset: 이 플랜트에는 “{name}” 설비 항목이 없습니다
no_tag: 이 플랜트에는 “{name}” 태그 항목이 없습니다
no_device: 이 플랜트에는 “{name}” 장치 항목이 없습니다
no_view: 이 플랜트에는 “{name}” 뷰 항목이 없습니다
unknown: “{name}”은(는) 여기서 알 수 없습니다
uncut: {group}의 센서가 하나뿐인 설비({all}개 중 {count}개, 첫째 {asset})에서는
  논문식을 정확히 그릴 수 없습니다.
  플랜트 파일의 그 그룹에 “singles: cut”을 쓰면 됩니다.
far_uncut: {group}의 센서가 하나뿐인 설비({asset} 등)에서는 거리를 정확히 그릴 수 없습니다.
  플랜트 파일의 그 그룹에 “singles: cut”을 쓰면 됩니다.
assumed: 이 센서가 {asset}의 어디에 있는지 알려지지 않아 거리를 그릴 수 없습니다
elsewhere: 알람은 다른 시스템이 관리합니다
anew: 플랜트를 다시 불러오는 중입니다. 다시 시도하세요
quiet: 확인할 알람이 없습니다
latched: 래치된 알람이 아니거나, 아직 활성이거나, 확인되지 않았습니다
otherwise: 그사이 상태가 바뀌었습니다
shelf: 알람은 최대 일주일까지 보류할 수 있습니다
tolerance: 값이 허용 오차를 벗어났습니다
reading: 측정값이 정상이 아닙니다
failed: 점검자가 불합격으로 보고했습니다
disk: 저장되지 않음: 서버 디스크에 쓸 수 없습니다
disk_full: 저장되지 않음: 서버 디스크가 가득 찼습니다
disk_locked: 저장되지 않음: 서버 디스크가 읽기 전용입니다
disk_slow: 저장되지 않음: 서버 디스크가 응답하지 않습니다
kept_unread: 저장되지 않음: 서버가 이전 항목의 파일을 읽을 수 없습니다. 이유는 서버 로그에 있습니다
not_utf8: 저장되지 않음: 글이 UTF-8이 아닙니다
fixed: 이 뷰는 플랜트 파일에 있습니다. 거기서 바꾸십시오
viewless: 다른 사람이 이 뷰를 삭제했습니다
digits: 이 코드를 표시하는 디스플레이가 없습니다
guesses: 틀린 코드를 너무 많이 입력했습니다. 1분 뒤에 다시 시도하세요
deviceless: 이 이름으로 페어링된 디스플레이가 더 이상 없습니다
devices: 디스플레이 수가 한도에 도달했습니다
views: 뷰를 더 저장할 수 없습니다. 먼저 하나를 삭제하세요
notes: 메모를 더 저장할 수 없습니다. 먼저 하나를 삭제하세요
note_ended: 메모의 종료 시각이 이미 지났습니다
noteless: 다른 사람이 이 메모를 삭제했거나 메모가 만료되었습니다
note_others: 이 메모는 작성자만 수정할 수 있습니다
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
log: 로그 눈금에는 0보다 큰 범위가 필요합니다
range: 범위의 시작은 끝보다 작아야 합니다
between: {low}에서 {high}까지의 수가 필요합니다
placeless: 이 센서는 이 물리량에 위치가 없습니다
narrow: 그림이 좁아 둘로 나눌 수 없습니다
memory: 서버 메모리가 부족하여 마지막 그림이 유지됩니다
gone: 이 사용자는 더 이상 연결되어 있지 않습니다
linkless: 이 짧은 링크는 알 수 없거나 더 이상 저장되어 있지 않습니다: 새 링크를 요청하세요
coreless: 이력을 쓸 수 없음: 코어에 연결할 수 없습니다. 다시 시도하십시오
unrecorded: 이력을 기록하지 않습니다 (history: record: no)
unreadable: 기록을 읽을 수 없습니다. 이유는 서버 로그에 있습니다

[class]
too_fast: 요청이 너무 많아 처리가 지연됩니다
limit: 이 서버가 그릴 수 있는 크기보다 그림이 큽니다
not_allowed: 여기서는 허용되지 않습니다
core_lost: 코어에 연결할 수 없습니다. 실행되지 않았을 수 있으니 복구 후 확인하십시오

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
