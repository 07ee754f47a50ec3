// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The page's elements, and small texts.

export function element<T extends HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

export const input = (id: string): HTMLInputElement => element<HTMLInputElement>(id);
export const select = (id: string): HTMLSelectElement => element<HTMLSelectElement>(id);

export function swatch(hex: string): HTMLElement {
  const mark = document.createElement('i');
  mark.style.background = hex;
  return mark;
}

export function labelled(kind: string, text: string, mark?: string): { label: HTMLLabelElement; box: HTMLInputElement } {
  const label = document.createElement('label');
  const box = document.createElement('input');
  box.type = kind;
  label.append(box, ' ');
  if (mark) label.append(swatch(mark));
  label.append(text);
  return { label, box };
}

/** "1.25 M", "640 k", "12". */
export function many(count: number): string {
  return count >= 1e6 ? `${(count / 1e6).toFixed(2)} M` : count >= 1e4 ? `${(count / 1e3).toFixed(0)} k` : String(count);
}

export const metres = (value: number | null): string => (value === null ? '–' : `${value.toFixed(3)} m`);
export const plain = (value: number | null, digits: number): string => (value === null ? '–' : value.toFixed(digits));

/** "1:02:03.4" of seconds. */
export function clock(seconds: number): string {
  const whole = Math.floor(seconds / 60), rest = (seconds - 60 * whole).toFixed(1).padStart(4, '0');
  return whole >= 60 ? `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}:${rest}` : `${whole}:${rest}`;
}

let noticeTimer = 0;

/** Says something that stays for some seconds. */
export function notice(text: string, problem = false): void {
  const place = element('notice');
  place.textContent = text;
  place.classList.toggle('problem', problem);
  place.hidden = text === '';
  clearTimeout(noticeTimer);
  noticeTimer = setTimeout(() => { place.hidden = true; }, problem ? 12000 : 6000);
}
