// SPDX-License-Identifier: Apache-2.0
import { spawn, spawnSync, type ChildProcess } from 'node:child_process';
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';

/** `tactus serve` itself, as `make live` builds it, or as the variable TACTUS names it; TACTUS=none leaves it out. */
export const leftOut = process.env.TACTUS === 'none';
const program = resolve(process.env.TACTUS ?? '../build/release/bin/tactus');

/** Without the program these tests would show nothing, so that it is missing is a failure. */
export function demandProgram(): void {
  if (existsSync(program) && spawnSync(program, ['serve', '--help']).status === 0) return;
  throw new Error(
    `${program} does not run: build it (make live), name another with the variable TACTUS, ` +
      'or leave the tests against it out with TACTUS=none',
  );
}

export class TactusServer {
  private constructor(
    private readonly child: ChildProcess,
    readonly url: string,
  ) {}

  /** Serves the built page on any free port; the first line it prints is its address. */
  static start(...more: string[]): Promise<TactusServer> {
    const child = spawn(program, ['serve', '--port', '0', '--page', 'dist', '--allow-tuning', ...more]);
    return new Promise((done, failed) => {
      let text = '';
      child.stdout.on('data', (piece: Buffer) => {
        text += piece.toString();
        const url = /http:\/\/\S+/.exec(text);
        if (url) done(new TactusServer(child, url[0]));
      });
      child.stderr.on('data', (piece: Buffer) => (text += piece.toString()));
      child.on('exit', () => failed(new Error(`tactus serve has ended: ${text}`)));
    });
  }

  stop(): Promise<void> {
    if (this.child.exitCode !== null || this.child.signalCode !== null) return Promise.resolve();
    return new Promise((done) => {
      this.child.removeAllListeners('exit').on('exit', () => done());
      this.child.kill('SIGTERM');
    });
  }
}
