// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the fleet page, in Korean.
export default `
answer: 플랜트 {all}곳 중 {count}곳 응답
only: 조치가 필요한 곳만
stale: {time} 이후 갱신되지 않음
none: 알람 없음
priority: 우선순위 {priority}
since: {time}부터 응답 없음
never: 아직 응답 없음
first: 첫 조회 중
links: 데이터 소스
down: {all}개 중 {down}개 끊김
up: {all}개 정상
version: 버전
certificate: 인증서
disk: 디스크 여유
backup: 마지막 백업
unknown: 알 수 없음
off: 없음
recorded: 기록
broken: 기록할 수 없음
works: 정상
refused: 플랜트 파일에 오류가 있음
configuration: 구성
expired: 만료됨
acknowledge: 미확인 {count}건
`;
