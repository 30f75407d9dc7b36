// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the warning over a page whose main thread hangs, in Korean.
export default `
hangs: 이 페이지가 응답하지 않습니다
hangs.reload: {n}초 전부터 화면이 멈춰 있습니다. 페이지를 새로 고치세요.
hangs.reloads: {n}초 전부터 화면이 멈춰 있습니다. 페이지를 다시 불러오는 중입니다.
`;
