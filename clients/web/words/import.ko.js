// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the import panel, in Korean.
export default `
[import]
drop: 모델과 태그 목록을 여기에 끌어다 놓거나 파일을 선택하세요
more: 파일을 더 끌어다 놓거나 선택하세요
formats: 모델: RVM(ATT 또는 TXT 포함), STEP, IGES, IFC, glTF, FBX, COLLADA, OBJ, STL, PLY, 3DS. 태그: CSV, XLSX, JSON
bytes: {mb} MB
files(other): 파일 {count}개
kind.model: 모델
kind.beside: 모델에 딸린 파일
kind.tags: 태그 목록
remove: 이 파일 제거
uploading: {name}: 올리는 중 …
phase.reading: 모델 읽는 중 …
phase.matching: 태그 연결 중 …
phase.preparing: 플랜트 준비 중 …
phase.loading: 플랜트 그리는 중 …
done: 플랜트 구성이 적용되었습니다
again: 다시 읽기
details: 읽기 결과
size: 크기
metres: {wide} × {deep} × {high} m
encoding: 이름과 단위의 문자 인코딩
encoding.found: 파일에 적힌 대로 또는 자동 판별
encoding.read: {file}: {name}(으)로 읽음
encoding.unsure: {file}: {name}(으)로 읽음, {other}일 수 있음
outside: 나머지와 멀리 떨어져 첫 화면에 없음: 삼각형 {triangles}개, 최대 {away_m} m.
report.lost(other): 삼각형이 빠진 요소 {count}개
report.errors(other): 읽기 오류 {count}개
report.left(other): 제외된 모델 항목 {count}개
unit.ask: {file}에 단위가 적혀 있지 않습니다. {unit}(으)로 보면 모델 길이는 {length} m입니다.
 어느 단위가 맞습니까?
unit.all: 답은 이 파일들 모두에 적용됩니다.
unit.length: 길이 {length} m
units: 모델의 단위
units.said: 파일대로
units.m: 미터
units.mm: 밀리미터
units.cm: 센티미터
units.in: 인치
units.ft: 피트
up: 모델의 위쪽 축
up.said: 파일대로
up.y: Y
up.z: Z
apply: 적용
person: 옆에 키 1.8 m인 사람 표시
person.label: 1.8 m
units.note: 적용하면 모델을 다시 읽습니다. plant.yaml과 tags.csv는 새로 만들어지고 이전 파일은 .1,
 .2, … 로 남으며, 태그에 대한 결정은 유지됩니다.
source: 측정값
source.none: 아직 없음
source.host: Modbus TCP 장치
source.port: 포트
source.unit: 유닛 ID
source.order: 바이트 순서
source.unstated: 지정 안 함
source.base: 첫 레지스터 번호
source.connect: 연결
source.live: 태그 {count}개 중 {good}개에 값이 있음
source.bad: {count} × {why}
source.note: 주소는 태그 목록에서 가져옵니다. 소스는 plant.yaml에 기록됩니다.
tags: 태그
filter: 표시
filter.all: 전체
filter.sure: 연결됨
filter.likely: 불확실
filter.none: 미연결
filter.unplaced: 위치 없음
sign.sure: ✓
sign.likely: ?
sign.none: –
sign.unplaced: ◎
find: 태그, 설비, 이유 검색
keys: ↑ ↓ 이동 · 1–8 후보 선택 · Enter 수락 · A 같은 형식 모두 · N 없음 · P 배치
byhand: 수동
decided(other): 결정 {count}개
undo: 버리기
selected: 선택한 설비에: {asset}
alike: {pattern} 형식 {count}개 모두 수락
off: 해당 설비 없음
place: 직접 배치
choose: 화면에서 설비를 클릭한 다음 여기에서 확인하세요.
`;
