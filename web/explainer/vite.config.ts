// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { defineConfig, type Plugin } from 'vite';
import { settingsOf } from '../kernel/settings';

/** An experiment file becomes the list of its keys, so that the page needs no reader of TOML. */
const experiments: Plugin = {
  name: 'experiments',
  load(id) {
    if (!id.endsWith('.toml')) return null;
    return `export default ${JSON.stringify(settingsOf(readFileSync(id, 'utf8')))};`;
  },
};

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  base: './',
  publicDir: '../public',
  plugins: [experiments],
  worker: { format: 'es', plugins: () => [experiments] },
  build: {
    outDir: '../../build/explainer',
    emptyOutDir: true,
    target: 'es2022',
    // Everything is a file of its own: the content security policy of the page allows no `data:` address.
    assetsInlineLimit: 0,
    modulePreload: false,
  },
});
