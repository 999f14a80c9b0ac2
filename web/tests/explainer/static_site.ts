// SPDX-License-Identifier: Apache-2.0
import { existsSync, readFileSync, statSync } from 'node:fs';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join, normalize } from 'node:path';

const types: Readonly<Record<string, string>> = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
  '.png': 'image/png',
  '.woff2': 'font/woff2',
  '.wasm': 'application/wasm',
};

/** Serves a folder from a sub-path, as where a project has its pages. */
export class StaticSite {
  private static readonly base = '/some/project/';

  private constructor(
    private readonly server: Server,
    readonly url: string,
  ) {}

  static async serve(folder: string, madeBy: string): Promise<StaticSite> {
    if (!existsSync(join(folder, 'index.html'))) throw new Error(`${folder} is missing: ${madeBy} makes it`);
    const server = createServer((request, response) => {
      const { pathname } = new URL(request.url ?? '/', 'http://host');
      const inside = pathname.startsWith(StaticSite.base) ? normalize(pathname.slice(StaticSite.base.length)) : '..';
      const asked = join(folder, inside);
      const file = existsSync(asked) && statSync(asked).isDirectory() ? join(asked, 'index.html') : asked;
      if (inside.startsWith('..') || !existsSync(file)) return void response.writeHead(404).end();
      response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' }).end(readFileSync(file));
    });
    await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
    return new StaticSite(server, `http://127.0.0.1:${(server.address() as AddressInfo).port}${StaticSite.base}`);
  }

  close(): void {
    this.server.close();
  }
}
