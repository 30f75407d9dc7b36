// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of parts of the page that are loaded on first use, in Korean.
export default `
accept: 추정 위치 확정
close: 닫기
cancel: 취소
sun: {wind}쪽, 고도 {height}°

[distance]
metres: {metres} m
geodesic: 표면 거리
geodesic.why: 표면을 따라 잰 거리: 열은 틈을 건너가지 않습니다
euclidean: 직선 거리
euclidean.why: 공간을 가로지르는 직선 거리
heat: 열확산 방식
heat.why: 비교용. Kim & Suh 2025처럼 표면의 표본점에서 계산: 약 0.5 % 어긋나고 얇은 벽을 통과합니다

[interpolation]
shepard: Shepard
shepard.why: 역거리 가중: 각 센서 위치에서 측정값과 정확히 일치
paper: Kim & Suh
paper.why: Kim & Suh 2025의 알고리즘 1: 더 부드럽지만 센서 위치에서 측정값과 다름
harmonic: 열전도
harmonic.why: 센서 사이 벽면의 정상 열전도. 유체나 공기가 열을 빼앗는 곳, 압력·유량에는 맞지 않음
fin: 열전도와 방열
fin.why: 열전도에 더해 벽이 공기로 열을 잃음. 센서의 몫이 10분의 1보다 작은 곳은 값 없음.
  단열되거나 가열되는 벽에는 맞지 않음
gp: 가장 확률 높은 값
gp.why: 가우스 과정: 가장 확률 높은 필드와 그 불확실성. 서로 무관한 부품이 맞닿은 곳에는 맞지 않음

[bar]
distance: 거리
interpolation: 보간

[neighbours]
say: 이웃 센서 예측
above: {predicted}; {by} 높음
below: {predicted}; {by} 낮음
title: 이웃 센서와 편차가 큰 센서
why: 각 측정값을 같은 설비의 다른 센서로 예측한 값과 비교. 입구처럼 원래 달라야 하는
  곳에는 맞지 않음

[drift]
week: 주간 드리프트
found: {by}: 드리프트 있음
none: {by}: 드리프트 없음
unknown: {by}: 판정 불가
why: 이웃 센서 예측과의 차이가 변한 크기(1시간 평균으로 계산). 공정 때문에 차이가 바뀐
  곳에는 맞지 않음

[coverage]
since: {when} 이후
title: 센서 감시 범위
none: 끔
uncertainty: 불확실성
uncertainty.note: 지금 정상인 센서로 계산한 표준편차.
uncertainty.why: 값이 가우스 과정의 가정대로 표면에서 변할 때 필드가 틀릴 수 있는 크기. 커널의
  범위가 추측이면 믿을 수 없음
blind: 사각지대
blind.of: 감지 가능한 과열점: {name}
blind.note: 크기 {size} m인 과열점이 가장 가까운 센서를 범위의 5 %만큼 움직이는 데 필요한 최소값.
blind.why: 작은 곳이 얼마나 뜨거워져야 센서에 나타나는지 표시. 다른 모양이나 다른 열
  경로에는 맞지 않음

[picture]
from: 거리의 기준
tag: 태그
difference: 차이의 기준
kept: 저장한 측정값
now: 현재 측정값
name: 현재 측정값의 이름
keep: 측정값 저장
scale: 눈금
fill: 데이터가 없는 곳
light: 조명: 태양 {where}
turn: 방위각
turn.why: 태양의 방위각(도), 북쪽 기준
height: 고도
height.why: 태양의 고도(도)
around: 배경
around.why: 배경

[arrows]
title: 방향
arrows: 화살표
arrows.why: 길이가 값을 나타냄. 센서 값을 보간한 것으로, 면 사이의 공간에는 맞지 않으며
  계산된 유동이 아님
strokes: 흐름선
strokes.why: 값이 클수록 빨리 흐르는 선. 센서 값을 보간한 것으로, 유체의 경로가 아님
none: 없음
none.why: 방향을 그리지 않음. 색은 값만 나타냄
unknown: 방향을 알 수 없음

[scale]
linear: 선형
log: 로그

[fill]
none: 빗금
none.why: 정상 센서가 닿지 않는 곳에는 아무 값도 표시하지 않음
neighbours: 주변 값
neighbours.why: 주변 값으로 채우고 점으로 표시

[split]
right: 오른쪽 화면에 표시할 것
end: 화면 분할 끝내기

[environment]
sky: 하늘

[wind]
N: 북
NE: 북동
E: 동
SE: 남동
S: 남
SW: 남서
W: 서
NW: 북서

[walls]
untrended: {tags} 값을 기다리는 중
untagged: 없는 태그
failed: 오류: 이 영역은 최신 상태가 아닙니다
unknown: 플랜트 파일에 상황판 '{id}'이(가) 없습니다. 있는 상황판: {known}
display: 상황판 '{id}'에는 디스플레이가 {count}개 있으며 {n}번은 없습니다
lost: {time}부터 플랜트와 연결이 끊겼습니다
never: 플랜트와 연결되지 않았습니다
self: {wall} 디스플레이 {display}, {time}부터 기다리는 중
denied: 이 디스플레이에는 전용 토큰이 필요합니다
digits: 페어링하려면 엔지니어가 '시점'에서 이 코드를 입력합니다
asks: 서버에 페어링 코드를 요청하는 중입니다
left: 코드 만료까지 {time}
place: {wall} 디스플레이 {display}
crowded: 페어링을 기다리는 디스플레이가 너무 많습니다. 다시 시도합니다
nowhere: 플랜트 파일에 상황판 '{wall}'의 디스플레이 {display}번이 없습니다
token: 토큰
enter: 입력
held: {who} 고정, {time}부터
sent: {who} 보냄, {time}
age: 데이터 {age} 경과
since: {time}부터
many(other): {worst}, 알람 {count}건
more(other): 외 {count}건
counts: 활성 {active}건, 미확인 {waiting}건
flood: 알람 폭주: 활성 {active}건, 미확인 {waiting}건
late: 이 디스플레이의 연결이 너무 느려 {time}부터 갱신되지 않음
missing: 디스플레이 {displays} 연결 안 됨

[others]
gone: {time}부터 {name} 화면이 없습니다
waiting: 해당 서버를 기다리는 중
unreachable: 해당 서버가 응답하지 않습니다
tls: 해당 서버의 인증서를 신뢰할 수 없습니다
token: 해당 서버의 토큰 파일을 읽을 수 없습니다
refused: 해당 서버가 토큰을 받아들이지 않습니다
busy: 해당 서버가 과부하 상태입니다
slow: 해당 서버의 응답이 너무 느립니다
large: 해당 서버가 보내는 데이터가 너무 큽니다
no_picture: 해당 서버가 화면을 보내지 않습니다
unheard: 이 플랜트의 서버에서 받은 정보가 없습니다

[notes]
legend: 메모
text: 근무조 메모
at: 대상
until: 표시 기한
save: 메모 추가
place: 이 위치
ends: {time}까지
handover: 교대 인수인계
plant: 플랜트 전체
edit: 수정
end: 종료
change: 수정 저장

[until]
shift: 8시간
day: 1일
week: 1주
ever: 삭제할 때까지

[remote]
legend: 상황판
pane: 상황판 화면
desk: 콘솔 이름
where: {wall} {display}: {area}
send: 이 화면 보내기
hold: 고정
back: 해제
point: 상황판에 내 포인터 표시
there: 연결됨
gone: 이 디스플레이는 연결되어 있지 않습니다
sent: {title}, {who} 보냄, {time}
held: {who} 고정, {time}
unread: 상황판을 읽을 수 없습니다: {why}

[devices]
legend: 디스플레이
digits: 페어링 코드
pair: 페어링
revoke: 페어링 해제
is: {wall} 디스플레이 {display}, 주소 {from}, {who} 페어링, {time}
unread: 디스플레이를 읽을 수 없습니다: {why}

[handover]
title: 교대 인수인계, {plant}
last: 최근
hours: {n}시간
print: 인쇄 또는 PDF 저장
notes: 메모
standing: 활성 또는 미확인
active: 현재 활성
waiting: 현재 미확인
about: 설명
value: 값 (한계)
asides: 현재 보류 또는 억제
raised: 발생한 알람
acknowledged: 확인됨
shelved: 보류 또는 사용 중지
time: 시각
where: 위치
what: 메모
who: 담당자
until: 기한
alarm: 알람
priority: 우선순위
state: 상태
count: 횟수
newest: 최근 발생
reason: 사유
ended: {who} 삭제, {time}
cut: 일부만 표시: 알람이 더 있었습니다
unread: 읽을 수 없습니다: {why}
gives: 인계자
takes: 인수자
denied: 인수인계는 운전원용입니다. 로그인하거나 토큰을 입력한 뒤 페이지에서 여세요

[named]
legend: 저장된 뷰
title: 이 뷰의 이름
save: 저장
unknown: '{id}' 뷰가 없습니다
wrong: 이 뷰를 표시할 수 없습니다: {why}
more: {title} 더 보기
by: {who}, {time}
update: 현재 화면으로 갱신
up: 위로
down: 아래로
remove: 삭제
look: 보기
back: 실행 취소

[views]
from: 보는 방향
extremes: 측정값으로 이동
projection: 투영
cut: 단면
where: 단면 위치
turn: 뒤집기
equipment: 설비: {what}
select: 먼저 설비를 선택하세요
all: 모두 표시
stays: {axis} {sign} {at} m 유지
part: {what}의 {percent} %
plant: 플랜트

[extreme]
highest: 가장 높은 값
lowest: 가장 낮은 값

[side]
top: 위
front: 앞
right: 오른쪽
back: 뒤
left: 왼쪽
iso: 대각선

[projection]
perspective: 원근
parallel: 평행

[cut]
off: 끔
box: 상자
move: 단면 옮기기: {axis}
whole: 상자 옮기기: 화살표 키는 X와 Y, Page Up/Down은 Z 방향
oblique: 비스듬히

[shown]
hide: 숨기기
ghost: 투명
only: 이것만
hidden: {all}개 중 {hidden}개 숨김
ghosts(other): {count}개 투명

[assets]
description: 설명
area: 구역
missing: 누락
size: 크기
place: 중심
sensors.name: 센서

[wall]
far: 이 화면에서는 글자를 {metres} m까지 읽을 수 있습니다({wanted} m는 불가).

[callout]
count: 알람 {count}건
worst: 최고

[card]
novalue: 값 없음
quality: 품질
age: 경과
on: 설비
trend: 추세
add: 추세에 추가
HH: 상상한 초과
H: 상한 초과
L: 하한 미만
LL: 하하한 미만
BAD: 계측 불량
ALM: 알람

[place]
measured: 이곳에서 측정함
between: 센서 사이
no data: 데이터 없음: 가장 가까운 센서가 불량이거나 닿는 센서가 없음
context: 이 측정량의 센서 없음
equipment: 센서 하나가 설비 전체를 나타냄: 위치는 추정
inside: 내부(절단면)
uncertain: {state}, 불확실
drawn: 이 지점의 값을 직접 계산함. 주변 색의 오차는 최대 {value}

[following]
title: {who}의 화면을 따라 보는 중
gone: {who}의 화면이 종료되었습니다: 마지막 화면입니다
awaited: 따라 볼 화면을 기다리는 중
someone: 다른 사용자

[outside]
title: 첫 화면 밖, 최대 {far} 거리: {names}
more: {names} 외 {count}개
all: 전체 보기
close: 알림 닫기

[alarms]
more: 외 {count}건

[state]
active: 활성
unacknowledged: 미확인
acknowledged: 확인됨
returned: 복귀, 미확인
latched: 래치됨
shelved: 보류
suppressed: 설계 억제
out_of_service: 사용 중지

[trends]
time: 시각
csv: CSV 내보내기
close: 추세 닫기
hour: 1시간
hour.why: 지난 1시간
shift: 8시간
shift.why: 지난 8시간
day: 하루
day.why: 지난 24시간
week: 일주일
week.why: 지난 7일
month: 30일
month.why: 지난 30일
range: 시간 범위
range.why: 범위를 입력하세요. 예: 최근 8시간, 어제 22:00 ~ 06:00, 2026-11-20 ~ 2026-11-21
last: 최근 {span}
between: {from} ~ {to}
example.minutes: 최근 15분
example.hours: 최근 8시간
example.today: 오늘
example.yesterday: 어제
example.night: 어제 22:00 ~ 06:00
unread: “{text}”은(는) 과거의 시간 범위가 아닙니다. 예: {example}
earlier: 이전
later: 이후
in: 확대
out: 축소
back: 직전 범위로
add: 태그 추가
none: “{text}”와(과) 일치하는 태그가 없습니다
full: 태그는 최대 {count}개입니다. 먼저 하나를 제거하세요
unknown: 이 플랜트에 없음: {tags}
undrawn: 표시하지 않음(태그는 최대 {count}개): {tags}
tag: 태그
at: 십자선
now: 현재
then: 표시 시각
min: 최소
mean: 평균
max: 최대
known: 유효
focus: 이 곡선을 강조하고 한계값 표시
which: 차트
chart: 차트. 화살표 키로 십자선 이동, 더하기와 빼기로 확대·축소, Page 키로 이동, Enter로 그 시각 표시.
table: 값과 통계
raised: {alarm}, {time} 발생
remove: {tag} 제거
gaps: 빗금: {tags} 값 없음
cut: {tags}의 알람이 너무 많아 가장 이른 알람은 표시되지 않습니다
failed: 추세를 표시할 수 없음: {why}
unsaved: 내보내지 못함: {why}
uncharted: 이 서버는 차트 없이 빌드되었습니다 (npm이 없었음)

[compare]
title: 두 시각 비교
why: 같은 카메라로 다른 시각의 화면을 나란히 표시
right: 이 화면의 시각
ago: 이 화면의 시각
at: 이 화면에서 시각으로 이동
chosen: 선택한 시각
earlier: {span} 전
end: 비교 끝내기

[time]
before: 이전 알람
after: 다음 알람
goto: 이동
first: 더 이른 알람 기록이 없습니다
last: 더 늦은 알람 기록이 없습니다
unread: 알람을 읽을 수 없습니다: {why}
unmarked: 표시가 빠졌거나 오래되었을 수 있음: {why}
play: 재생
pause: 일시 정지
speed: 재생 속도
span: 시간 범위
slider: 표시하는 시점
live: 실시간으로
now: 지금
ago: {instant} · {age} 전
lost: {source}: 연결 끊김
uncounted: 알람이 너무 많아 여기서는 세지 않습니다
unrecorded: 기록 없음
raised(other): 알람 {count}건 발생

[quality]
because: {quality}: {detail}

[detail]
CommunicationError: 통신 오류
ConfigurationError: 구성 오류
DeviceFailure: 장치 고장
NoCommunication: 통신 없음
NoMatch: 주소에 값 없음
TooManyMatches: 주소에 값이 여러 개
OutOfService: 사용 중지
SensorFailure: 센서 고장
WaitingForInitialData: 첫 데이터 대기
EngineeringUnitsExceeded: 측정 범위 초과
LastUsableValue: 마지막 유효값
NoCommunicationLastUsableValue: 통신 없음, 마지막 유효값
SensorNotAccurate: 센서 부정확

[timings]
ms: 밀리초
half: 중앙값
most: 95 %
input: 입력에서 화면까지
sensor: 측정값에서 화면까지
wait: 대기
field: 필드 계산
render: 그리기
encode: 인코딩
network: 네트워크
decode: 디코딩
rate: 화면 {pictures}/s, {kbit} kbit/s
follow: {link} 링크를 열면 이 화면을 함께 봅니다.

[account]
title: 내 계정
viewer: (조회 권한)
operator: (운전원)
engineer: (엔지니어)
open: (화면 조회만)
nobody: 로그인하지 않았습니다.
person: ID 공급자를 통해 로그인했습니다.
token: 토큰으로 접속했습니다.
here: 서버 본체에서 접속하여 로그인이 필요하지 않습니다.
in: 로그인: {provider}
out: 로그아웃

[token]
title: 토큰
needed: 로그인이 필요합니다.
bad: 토큰이 올바르지 않거나 만료되었습니다.
locked: 한동안 사용이 없어 잠겼습니다. 다시 로그인하세요.
go: 계속
note: 토큰은 서버 관리자가 만듭니다: {command}. 이 탭을 닫을 때까지 보관됩니다.

[help]
title: 조작 방법
close: 도움말 닫기
mouse: 마우스
touch: 터치
keys: 키보드
turn: 회전
turn.mouse: 왼쪽 버튼으로 끌기
turn.touch: 한 손가락
move: 이동
move.mouse: 오른쪽·가운데 버튼 또는 [Shift] 끌기
move.touch: 두 손가락
look: 둘러보기
look.mouse: [Ctrl] 끌기
look.touch: 세 손가락
zoom: 확대·축소
zoom.mouse: 휠
zoom.touch: 벌리기·오므리기
fit: 맞춤
fit.mouse: 두 번 클릭
fit.touch: 두 번 탭
home: 기본 시점
back: 이전 시점으로
from: 보는 방향
from.keys: [T] 위, [I] 대각선, [O] 평행 투영, [V] 모든 시점, [P] 화면
what: 정보 보기
what.mouse: 클릭
what.touch: 탭
selected: 선택한 설비
selected.keys: [X] 숨기기, [G] 투명, [L] 이것만, [U] 모두 표시
quantity.keys: [1]부터 [9]까지
equipment.keys: [B], 검색 [/]
history.keys: [Y], 실시간으로 [N]
markers: 표식
mark.good: 정상 측정값
mark.uncertain: 불확실한 측정값
mark.bad: 불량: 값 없음
mark.behind: 가려짐
mark.alarm: 알람, 색은 우선순위
mark.acknowledged: 확인된 알람
mark.returned: 정상 복귀 또는 래치
crowd: 몰린 표식은 일부 생략되며, 확대하면 모두 보입니다. 알람은 생략되지 않습니다.

[measure]
first: 첫 번째 지점을 누르세요
second: 두 번째 지점을 누르세요
done: 다시 측정하려면 누르세요
missed: 설비가 없는 곳입니다: 설비를 누르세요
end: 완료
parts: 수평 {level} m, 수직 {rise} m

[snapshot]
failed: 이미지 저장 실패: {why}
unnamed: 비교하려면 이름을 붙여 저장한 값이 필요합니다
shown: 화면 그대로 저장
shown.note: 화면에 보이는 값과 픽셀 그대로이며, 범례, 표식, 시계는 없습니다.
again: 범례와 표식을 넣어 저장
again.note: 서버가 다시 그립니다. 둘 다 서명되어 있어 “plantcast verify”가 모든 변경을 찾아냅니다.
late: 서명된 이미지를 받지 못했습니다

[share]
title: 공유
what: 링크로 열 대상
view: 이 화면
view.why: 이 화면을 엽니다: 카메라, 측정량, 색, 시각.
tag: 이 태그
tag.why: 이 코드는 태그 위치를 엽니다. 인쇄하여 설비에 붙이세요.
asset: 이 설비
asset.why: 이 코드는 설비 위치를 엽니다. 인쇄하여 그곳에 붙이세요.
follow: 내 화면 함께 보기
follow.why: 링크를 연 사람은 이 페이지가 열려 있는 동안 같은 화면을 봅니다.
link: 링크
copy: 복사
copied: 복사됨
code: 링크 QR 코드
nocode: 이 서버는 QR 코드 없이 빌드되었습니다 (npm이 없었음).
local: 이 컴퓨터에서만 열립니다: 주소가 로컬 주소입니다.
people: 함께 보는 사람
alone: 따라 보는 사람이 없습니다.
followers(other): {count}명이 따라 보고 있습니다.
lead: {who}에게 주도권 넘기기
viewer: 열람자

[factor]
range: 색 범위
min: 최소
max: 최대
own: 그룹 기본값
title: 필드 계산
strength: 세기
decay: 감쇠
power: 지수
radius_m: 반경(m), 0 = 자동
reach_m: 도달 거리(m), 비움 = 무제한
of: {tag} 하나만
choose: 센서 하나: 먼저 선택하세요
reset(other): 설정값으로 (센서 {count}개)

[proof]
fail: 루프체크 불합격
changed: 루프체크 이후 태그가 변경됨
pass: 루프체크 합격

[eng]
title: 엔지니어링
close: 엔지니어링 패널 닫기
place: 배치
prove: 루프체크
method: 필드 계산
what: 작업
find: 태그 찾기
nowhere: 위치 없음
on: {asset} 위
choose: 태그를 선택한 다음 표면을 클릭하거나 표식을 끌어다 놓으세요.
click: {tag}: 표면을 클릭하거나 표식을 끌어다 놓으세요.
missed: 그곳에는 표면이 없습니다.
moves: 초안 (본인만 보임)
nomoves: 옮긴 것이 없습니다. 변경은 저장할 때까지 본인에게만 보입니다.
off: 표면에서 {metres} m 떨어짐
left: 목록에 적힌 {asset} 위가 아님
waiting: 지금은 직선 거리, 표면 거리는 계산 중
straight: 직선 거리만
ready: 표면 거리
undo: 실행 취소
back: 모두 버리기
gaps: 감시 공백
save: 저장 …
gaps.of: 감시 공백: {quantity}
gap: 가장 가까운 센서까지 최대 {metres} m. 표면의 {far} %는 {limit} m보다 멀고, {lost} %는 지금
  데이터가 없습니다.
gap.assumed: 센서 위치가 추정된 것이어서 센서와의 거리를 알 수 없습니다.
gap.next: 다른 센서와 가장 떨어진 센서: {a}, {b}에서 {metres} m.
gap.off: {tag}은(는) {asset} 표면에서 {metres} m 떨어져 있습니다 (최대 {limit} m)
gap.none: 표면에서 벗어난 센서가 없습니다.
diff: {file}을(를) 저장할까요?
diff.before: 이전
diff.after: 이후
diff.line: {n}행
diff.note: 지금의 목록은 백업으로 보관됩니다. 새 목록은 몇 초 안에 모두에게 적용됩니다.
diff.conflict: {file}을(를) 다른 사람이 바꾸었고 아직 불러오지 않았습니다.
    저장하지 않았습니다. 바뀐 내용:
diff.left: {tag}의 위치가 {left}에서 {asset}(으)로 바뀌었습니다. 맞습니까?
diff.more: … 그 밖에 {count}행
confirm: 저장하고 적용
saving: 준비 중입니다. 아직 모두에게 이전 플랜트가 보입니다.
saved: 적용되었습니다. 이전 목록은 {kept}(으)로 보관됩니다.
unsaved: 저장하지 않음: {text}
device: 장치
proven: {count}개 중 {done}개 합격
expected: 기댓값
tolerance: 허용 오차 ±
watch: 변화 감시
watching: 지금 전송기 출력을 강제로 바꾸세요.
still: 아직 변한 측정값이 없습니다.
moved: {tag}이(가) 가장 많이 변함: {by}.
swapped: {wanted}이(가) 아니라 {tag}이(가) 변했습니다. 서로 바뀌었나요?
compare: 비교
fails: 불합격 처리
csv: CSV의 값 …
csv.note: 기댓값 {count}개를 읽었습니다.
csv.bad: Tag Name, Expected, Tolerance 열이 필요합니다.
export: 결과 내보내기
remark: 비고
passed: {tag} 합격: {value}.
failed: {tag} 불합격: {why}.
now: 현재 {value}

[accept]
asset: 설비
all: 전체 ({count})
tags: 태그
pattern: 이름 또는 설명, 이름에는 * 와 ?
within: 표면에서 최대 거리(m)
confidence: 최소 신뢰도, 0~1
count(other): {count}곳이 확정됩니다. 화면에 파란 고리로 표시됩니다.
none: 확정될 곳이 없습니다.
nowhere: {count}곳 제외: 목록에 노드와 위치가 없음
missing: {count}곳 제외: 설비에 모델이 없음
far: {count}곳 제외: 표면에서 더 멂
unsure: {count}곳 제외: 신뢰도가 낮거나 알 수 없음
go: {count}곳 확정
saved(other): {count}곳을 확정했습니다. 이전 목록은 {kept}(으)로 보관됩니다.
undo: 되돌리기: {kept} …
changed: 확정되지 않았습니다. 목록이 바뀌었습니다. 개수를 확인하고 다시 확정하세요.
undone: 되돌렸습니다. {kept}이(가) 다시 적용됩니다.

[unrecorded]
title: 기록 안 됨: {what}
why: 서버가 일부 파일을 사용할 수 없습니다. 이유는 서버 로그에 있습니다.
readings: 측정값
alarms: 알람 변경
actions: 감사 기록
lists: 뷰, 메모 및 기타 목록

[standby]
plant: 플랜트 파일
tags: 태그 목록
models: 모델
none: 연결된 예비 서버가 없습니다.
denied: 연결된 예비 서버가 없습니다. 이 서버가 {node}의 연결을 거부합니다: {why}
getting: 예비 서버 {node}에 아직 새 파일이 없습니다: {files}.
behind: 예비 서버 {node}이(가) 다음 파일을 받지 못했습니다({files}): {why}
refused: 예비 서버 {node}이(가) 넘겨받을 수 없습니다: {why}
warned: 예비 서버 {node}이(가) 넘겨받을 수 있지만 다음이 다릅니다: {why}
`;
