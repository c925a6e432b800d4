/** Made by scripts/help.ts when the dashboard is built. */
declare module 'virtual:help' {
  export const topics: import('./help').Topic[];
  export const loadIndex: () => Promise<import('./help').Searched[]>;
}
