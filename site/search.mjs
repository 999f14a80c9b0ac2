#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Asks the search of the built site questions that people have, and fails where the page that answers is not among the first
// results. It runs the site's own search, scripts and index, as a browser does.
//
//   node site/search.mjs FOLDER [QUESTION...]
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { exit, argv } from 'node:process';
import { createContext, runInContext } from 'node:vm';

// A question, and the pages of which one must be among the first five results.
const questions = [
  ['my arm buzzes', ['how-to/my-arm-buzzes']],
  ['SO-101', ['how-to/so101', 'how-to/feetech-servos']],
  ['which gain', ['how-to/how-much-gain-is-safe', 'how-to/advise']],
  ['no force sensor', ['theory/sensorless-teleoperation', 'how-to/compare-methods']],
  ['record for LeRobot', ['how-to/logs']],
];
const first = 5;

const [folder, ...asked] = argv.slice(2);
if (!folder) {
  console.error('use: node site/search.mjs FOLDER [QUESTION...]');
  exit(2);
}

// What the scripts want of a page: every property and every call gives the same nothing.
const nothing = new Proxy(function () {}, {
  get: (_, key) => (key === Symbol.toPrimitive ? () => '' : nothing),
  apply: () => nothing,
  set: () => true,
});
const context = createContext({
  document: nothing,
  window: nothing,
  localStorage: nothing,
  DOCUMENTATION_OPTIONS: {},
  SPHINX_HIGHLIGHT_ENABLED: false,
  _: (text) => text,
  _ready() {},
});
const run = (code) => runInContext(code, context);
const file = (name) => readFileSync(join(folder, name), 'utf8');
run(file('_static/language_data.js'));
run(file('_static/searchtools.js').replace(/^const (_displayNextItem|_removeChildren) =/gm, 'var $1 ='));
run(file('searchindex.js').replace(/^Search\.setIndex/, 'Search._index = '));
// Instead of showing results one after another.
let found = [];
context.keep = (results) => (found = results);
run('_displayNextItem = keep; _removeChildren = () => {};');

/** The pages that a search shows, the first first. */
function pagesFor(question) {
  found = [];
  context.question = question;
  run('Search.query(question)');
  return [...new Set(found.map(([page]) => page).reverse())];
}

let failed = false;
for (const question of asked) console.log(`${question}: ${pagesFor(question).slice(0, 10).join(', ') || 'nothing'}`);
if (asked.length === 0) {
  for (const [question, answers] of questions) {
    const pages = pagesFor(question);
    const place = pages.findIndex((page) => answers.includes(page));
    const good = place >= 0 && place < first;
    failed ||= !good;
    console.log(`${good ? 'answered' : 'NOT ANSWERED'}: "${question}" → ${pages.slice(0, first).join(', ') || 'nothing'}`);
  }
}
exit(failed ? 1 : 0);
