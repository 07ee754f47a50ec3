// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Makes one HTML page of these sources, which needs nothing else: page.html, and with a file's name as argument a C++
// source that holds it packed.
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

async function bundled(entry) {
  const made = await build({ entryPoints: [entry], bundle: true, minify: true, write: false, format: 'iife',
    target: 'es2022', charset: 'utf8', legalComments: 'inline', logLevel: 'warning' });
  // Nothing in it may end the element that it stands in.
  return made.outputFiles[0].text.replaceAll('</script', '<\\/script').trim();
}

const hashOf = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const script = await bundled('main.ts');
const style = await bundled('style.css');
const policy = `default-src 'none'; script-src ${hashOf(script)}; style-src ${hashOf(style)}; ` +
    "connect-src 'self'; img-src data: blob:; base-uri 'none'; form-action 'none'";
const page = readFileSync('index.html', 'utf8')
    .replace('@policy@', () => policy)
    .replace('@style@', () => style)
    .replace('@script@', () => script);
writeFileSync('page.html', page);

if (process.argv[2]) {
  const packed = gzipSync(page, { level: 9 });
  const rows = [];
  for (let at = 0; at < packed.length; at += 32) rows.push([...packed.subarray(at, at + 32)].join(','));
  writeFileSync(process.argv[2], `// Made of tools/viewer/page/ by its build.mjs.
#include "adit/tools/viewer/view_page.hpp"

namespace adit {
namespace {
constexpr unsigned char kPage[] = {
${rows.join(',\n')}};
}  // namespace

std::string_view view_page() {
  return {reinterpret_cast<const char*>(kPage), sizeof(kPage)};
}

}  // namespace adit
`);
}
