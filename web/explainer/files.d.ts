declare module '*.toml' {
  const settings: readonly import('../kernel/settings').Setting[];
  export default settings;
}
