// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the alarm list, the alarm journal and the replay of the time around an alarm, in Korean.
export default `
[alarms]
close: 알람 닫기
then: 화면은 과거이고, 이 목록은 현재 알람입니다.
quiet: 활성 알람이 없습니다.
aside: 보류 또는 억제 ({count})
until: {time}까지
by: 처리: {who}
edge: 끌어서 너비 조절
held: 계측 불량: 마지막 상태 유지
heldfrom: 계측 불량: {time}부터 상태 유지
fly: {tag}(으)로 이동
stale: 현재 값 아님: 연결이 끊긴 {time} 기준입니다.
which: 알람 상태
search: 필터
unfilter: 필터 해제: {all}건 중 {count}건, {what}
filtered(other): {count}건 중 필터에 맞는 것이 없습니다.
choose: {tag} 선택
chooseall: 모두 선택
acknowledge: {count}건 확인
also: 그 밖에 {what}
priorities: 모든 우선순위
areas: 모든 구역
chosen(other): {count}건 선택됨
count(other): 알람 {count}건
shelve: {count}건 보류…
unchoose: 선택 해제

[which]
all: 전체
waiting: 미확인
active: 활성
gone: 정상 복귀

[action]
acknowledge: 확인
shelve: 보류…
reset: 리셋
unshelve: 보류 해제
in_service: 사용 재개

[shelve]
title: {what} 보류
for: 기간
quarter: 15분
hour: 1시간
reason: 사유
do: 보류

[short]
returned: 복귀
suppressed: 억제

[column]
state: 상태
priority: 순위
tag: 태그
kind: 알람
area: 구역
about: 설명
us: 시각
raised: 발생 시각
then: 당시 값
now: 현재값
limit: 한계
since: 경과
do: 조작
order: 정렬
sort: {what} 기준으로 정렬

[journal]
title: 이력
csv: CSV
which: 변경 종류
span: 기간
all: 모든 변경
raised: 발생
cleared: 해제
acknowledged: 확인
shelved: 보류, 억제
shift: 최근 8시간
day: 최근 24시간
today: 오늘
yesterday: 어제
week: 최근 7일
chosen: 직접 지정…
from: 시작
to: 끝
count(other): 변경 {count}건
cut: 최신 변경 {all}건 중 {count}건, {time}까지
older: 이전 변경 더 보기
nounit: 단위 알 수 없음

[change]
raise: 발생
clear: 해제
acknowledge: 확인
reset: 리셋
shelve: 보류
unshelve: 보류 해제
suppress: 억제
unsuppress: 억제 해제
out_of_service: 사용 중지
in_service: 사용 재개
carry: 장치 알람으로 대체
call: 다시 발생

[moment]
show: 발생 30초 전 보기
raised: {time} 발생
early: {s}초 전
late: {s}초 후
now: 발생 시점
before: 30초 전
at: 발생 시점으로
`;
