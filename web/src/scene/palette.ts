// SPDX-License-Identifier: Apache-2.0
/** Colours of the page, read from the style sheet so that scene and plots follow light and dark. */

export const colourNames = [
  'text',
  'muted',
  'grid',
  'surface',
  'intended',
  'induced',
  'master',
  'slave',
  'wall',
  'force',
  'good',
  'bad',
] as const;
export type ColourName = (typeof colourNames)[number];
export type Palette = Record<ColourName, string>;

function read(): Palette {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(colourNames.map((name) => [name, style.getPropertyValue(`--${name}`).trim()])) as Palette;
}

/** The colours in use. One object, filled anew when the scheme changes. */
export const palette: Palette = read();

/** Calls back after the scheme has changed between light and dark. */
export function onSchemeChange(listener: () => void): void {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    Object.assign(palette, read());
    listener();
  });
}
