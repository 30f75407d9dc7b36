// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that the server draws over pictures, in Korean. The build makes a C header from this file; {} is replaced by a value.
export default `
no_limits: 한계 없음
no_data: 데이터 없음
uncertain: 불확실
drawn_error: 불확실: 그린 값의
drawn_error_2: 오차 최대 {}
unproven: 루프체크 안 됨
place_assumed: 위치 추정
direction_unknown: 방향 알 수 없음
priority_1: 알람, 우선순위 1
priority_2: 알람, 우선순위 2
priority_3: 알람, 우선순위 3
priority_4: 알람, 우선순위 4
by_limits: 태그별 한계값 기준
logarithmic: 로그 눈금
deviation: 표준 편차
misread: 잘못 읽기 쉬움
glossy: 광택: 빛이
glossy_2: 색을 바꿈
bad: 불량
held_since: {}부터 유지
unknown_then: 당시 값 알 수 없음
from: {}에서의 거리
hot_spot: 감지 가능한 과열점: {}
hot_spot_size: 크기 {} m, 범위의 {} %로 감지
since: {} 이후
alarms: 알람 {}건
worst: 최고 {}
no_values: 값 없음
old_s: {}초 전 값
old_min: {}분 전 값
old_h: {}시간 전 값
configuration: 구성 {}
clock_unset: 시계 동기화 안 됨
simulated: 모의값
no_live_data: 실시간 데이터 없음
history: 과거 시점
no_data_then: 데이터 없음
unseen_one: 보이지 않는 알람 {}건
unseen: 보이지 않는 알람 {}건
unseen_such_as: 보이지 않는 알람 {}건 중
look_default: 정확한 색
look_glossy: 광택
look_flat: 음영 없음
look_materials: 재질
interpolation_shepard: Shepard
interpolation_paper: Kim & Suh 알고리즘 1
interpolation_harmonic: 벽면 열전도
interpolation_fin: 벽면 열전도와 공기로 방열
interpolation_gp: 가장 확률 높은 값
distance_geodesic: 표면 거리
distance_euclidean: 직선 거리
distance_heat: 표면 거리, 열확산 방식
power: 지수 {}
strength: 세기 {}
decay: 감쇠 {}
radius: 반경 {} m
radius_automatic: 반경 자동
reach: 도달 거리 {} m
reach_unlimited: 도달 거리 무제한
not_filled: 채우지 않음
filled: 주변 값으로 채움
weighted: 수동으로 가중치를 준 센서: {}
as_configured: 센서 설정 그대로
`;
