// SPDX-License-Identifier: Apache-2.0
declare module '*.toml' {
  const settings: readonly import('../kernel/settings').Setting[];
  export default settings;
}
