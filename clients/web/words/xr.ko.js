// SPDX-License-Identifier: GPL-3.0-or-later
// Texts shown on headsets, in Korean.
export default `
[xr]
enter: VR 시작
leave: VR 종료
back: −{n}분
live: 현재
waiting: 서버의 화면을 기다리는 중
flat: 오래된 화면
flat.why: 화면에 깊이 정보가 없거나 너무 늦게 도착합니다.
gone: 헤드셋이 세션을 종료했습니다
failed: 헤드셋에 플랜트를 표시할 수 없습니다: {why}
`;
