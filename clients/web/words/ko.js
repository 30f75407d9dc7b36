// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that the page needs immediately, in Korean. [section] prefixes the keys below it, then key: text. {name} is replaced,
// [X] is a key to press, (one) is a plural form.
export default `
none: 없음
novalue: 값 없음
viewport: 플랜트 3D 보기. 화살표 회전, +와 - 확대·축소, W A S D 이동, F 맞춤, 물음표 도움말.
legend: 범례
card: 태그
place: 위치
status: 상태
timings: 성능 측정

[part]
failed: 화면의 이 부분을 불러오지 못했습니다. 서버가 응답하면 저절로 나타납니다.

[age]
s: {n}초
min: {n}분
h: {n}시간
d: {n}일

[bar]
equipment: 설비 목록
quantity: 측정량
display: 표시 설정
colours: 색상표
ramp: 색 단계
lines: 등치선
look: 음영
show: 표시
views: 시점, 단면, 설비 표시
picture: 화면: 비교, 조명
split: 화면 분할
history: 이력
fit: 화면에 맞춤
home: 기본 시점
help: 도움말
hold: 값 정지
go: 실시간 값으로
unrecorded: 이력 기록이 없어 값을 정지할 수 없습니다
more: 더 보기
measure: 거리 측정
snapshot: 이미지 저장
share: 공유
theme: 밝은/어두운 화면 전환
engineer: 엔지니어링: 센서와 필드
import: 플랜트 가져오기
account: 내 계정

[show]
value: 값
operator: 한계
distance: 거리
difference: 차이

[look]
default: 정확한 색
glossy: 광택
flat: 음영 없음
materials: 재질

[lines]
none: 없음
every: {step} 간격
chosen: 직접 지정

[ramp]
smooth: 연속
group: 기본 구간
limits: 그룹 한계
chosen: 직접 지정

[quantity]
temperature: 온도
pressure: 압력
vibration: 진동
vibration velocity: 진동 속도
flow: 유량
level: 레벨
gas: 가스

[picture]
title: 화면

[views]
title: 시점

[assets]
title: 설비
close: 설비 목록 닫기
search: 설비와 태그 검색
nothing: 검색 결과가 없습니다.
sensors(other): 센서 {count}개
loose: 설비 미지정 태그
about: 선택한 설비 정보
worst: 가장 나쁜 품질: {quality}

[viewport]
waiting: 첫 화면 대기 중

[legend]
right: 오른쪽 범례
colours: {min}~{max}의 색
distance: {tag}에서의 거리
operator: 태그별 한계값 기준.
log: 로그 눈금.
unsafe: 잘못 읽기 쉬운 색상표.
glossy: 광택: 빛이 색을 바꿉니다. 값을 읽지 마세요.
nolimits: 한계 없음
nodata: 데이터 없음
uncertain: 불확실
drawn: 점: 오차 ≤ {off}

[following]
own: 따라 보기 종료

[alarms]
title: 알람
unheard: 알람: 데이터 대기 중
none: 활성 알람 없음
some(other): 활성 알람 {count}건
zero: 활성 0건
waiting: 미확인 {waiting}건
latched: 리셋 대기 {latched}건
asof: {time} 기준: {alarms}
gone: 우선순위 {priority}, 정상 복귀
now: 현재: {alarms}
value: 발생 {value}{now} (한계 {limit})
present: 현재 {now}
since: {time}부터 유지
priority: 우선순위 {priority}

[kind]
HH: 상상한
H: 상한
L: 하한
LL: 하하한
BAD: 계측 불량
ALM: 알람
LINK: 장치 통신 두절

[mode]
display: 표시 전용: 확인은 제어 시스템에서
mirror: 제어 시스템의 알람을 그대로 표시
local: Plantcast 자체 알람

[trends]
title: 추세

[time]
title: 이력

[status]
clock: 플랜트 시각
then: 표시 시각
unset: {clock}, 동기화 안 됨
unset.why: 서버 시계가 동기화되지 않았습니다. 시각은 틀릴 수 있으나 경과 시간은 맞습니다.
within: 서버 시계가 {n} ms 이내로 동기화되었습니다.
leap: 이번 달 말(UTC)에 윤초가 추가됩니다.
leap.less: 이번 달 말(UTC)에 음의 윤초로 1초가 빠집니다.
oldest: 가장 오래된 측정값
frames: 프레임
rate: {count}/s
still: 대기
latency: 지연
ms: {n} ms
behind: {n}초 늦음
config: 구성
picture: 화면
retry: 지금 시도

[health]
nothing: 해당 시각에 기록된 데이터가 없습니다
connecting: 연결 중
live: 실시간
partly: 실시간, 일부 모의값
simulated: 모의값
down: {live}, 소스 {all}개 중 {down}개 중단
unmeasured: 모의값 소스: {sources}.
nodata: 실시간 데이터 없음
nosensor: 값을 보내는 센서가 없습니다.
source: 소스 {source}이(가) 응답하지 않습니다.
sources: 소스 {sources}이(가) 응답하지 않습니다.
past: 과거 시점
returning: 실시간으로 복귀 중
playing: {instant}, {speed}× 재생
back: {instant}, {speed}× 역재생
noanswer: 응답 없음
silent: 서버가 {age} 동안 응답하지 않습니다.
old: 이 화면은 {age} 전의 것입니다.
barred: 접근 거부
disconnected: 연결 끊김
because: {reason}.
retry: {age} 뒤 다시 시도합니다.
retrying: 다시 시도하는 중입니다.

[reason]
down: 서버가 종료되었습니다
version: 이 페이지와 서버의 버전이 다릅니다
forbidden: 허용되지 않았습니다
long: 메시지가 너무 깁니다
full: 서버가 한도에 도달했습니다
slow: 이 브라우저가 너무 느렸습니다
unreachable: 서버에 연결할 수 없습니다
unanswered: 서버가 응답하지 않습니다
silent: 서버의 응답이 끊겼습니다
token_needed: 토큰이 필요합니다
bad_token: 토큰이 올바르지 않거나 만료되었습니다
locked: 한동안 사용이 없어 잠겼습니다

[quality]
good: 정상
uncertain: 불확실
bad: 불량
unknown: 알 수 없음

[simulated]
all: 모의값
partly: 일부 모의값

[proof]
none: 루프체크 안 됨
assumed: 위치 추정
`;
