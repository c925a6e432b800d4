/** Made by scripts/land.ts when the dashboard is built. */
declare module 'virtual:land' {
  /** An SVG path in tenths of the map's units. */
  export const land: string;
}
